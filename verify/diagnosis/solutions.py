"""Solutions of a scene with something changed, as loads at equal openings."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property, lru_cache

import numpy as np

from verify.curves.curve import envelope, from_origin, samples
from verify.curves.of_run import cubics
from verify.methods.method import Unsuitable
from verify.methods.solve import prepare, require, solve
from verify.scene.parse import SceneError, parse_scene
from verify.scene.schema import Scene
from verify.support.refusal import NotRun

#: The solver: it solves every scene, and on few unknowns in a tenth of a second.
METHOD = "nurbs"
#: Elements of degree 2 in the process zone, with points in each, and the distance from the tangent that steps may have.
#: Four leave 0.1 % of the curve on ``dcb-czm1``, and 2 % where the zone is short for the thickness of the arms. The
#: first mesh is taken that the next one confirms to ``MESH_NOISE``: waves of the elements move as the scene changes.
ELEMENTS, POINTS, BEND, MESH_NOISE = (4.0, 8.0, 16.0), 5, 0.02, 0.002


Curve = tuple[np.ndarray, np.ndarray]


def sampled(curve: Curve, at: np.ndarray) -> np.ndarray:
    """Load (n,) of the envelope at openings (n,), the last load beyond its end."""
    return np.interp(at, *envelope(*from_origin(*curve)))


class Solutions:
    """Loads of the scene with overrides, each solved once; ``end``: the opening up to which they are wanted."""

    def __init__(self, scene: Scene, end: float) -> None:
        self.scene, self.grid = scene, samples(0.0, end)
        self._table = {**scene.model_dump(), "published": [], "uncertainty": {}}
        self._settings = [f"load.opening={end!r}"]
        self._known: dict[tuple[str, ...], np.ndarray | None] = {}

    @cached_property
    def possible(self) -> bool:
        """Whether the solver takes this scene; then its mesh is chosen."""
        try:
            meshes = [[*self._settings, *_mesh(elements)] for elements in ELEMENTS]
            require(prepare(parse_scene(self._table, meshes[0]), METHOD))
        except (NotRun, Unsuitable, SceneError):
            return False
        self._settings = meshes[0]
        for finer in meshes[1:]:
            coarse, fine = self.load(), self._solved((), finer)
            if fine is None:
                break
            if coarse is not None and np.linalg.norm(fine - coarse) <= MESH_NOISE * np.linalg.norm(fine):
                break
            self._settings, self._known = finer, {(): fine}
        return True

    def load(self, overrides: Sequence[str] = ()) -> np.ndarray | None:
        """Load (SAMPLES,) at the openings of the grid; None where that scene has no solution."""
        key = tuple(overrides)
        if key not in self._known:
            self._known[key] = self._solved(key, self._settings)
        return self._known[key]

    def change(self, overrides: Sequence[str]) -> np.ndarray | None:
        """What the overrides change of the load."""
        base, other = self.load(), self.load(overrides)
        return None if base is None or other is None else other - base

    def _solved(self, overrides: tuple[str, ...], settings: list[str]) -> np.ndarray | None:
        try:
            result = solve(parse_scene(self._table, [*settings, *overrides]), METHOD)
        except (SceneError, NotRun, Unsuitable, ValueError, ArithmeticError, np.linalg.LinAlgError):
            return None
        d, P = cubics(result)
        return sampled((np.asarray(d), np.asarray(P)), self.grid) if result.complete else None


def _mesh(elements: float) -> list[str]:
    """Overrides of a coarse mesh with that many elements in the process zone."""
    degree = ["discretization.degree=2", f"discretization.interface_points={POINTS}"]
    size = ["discretization.dofs=auto", f"discretization.in_a_zone={elements}"]
    paced = ["discretization.steps=auto", f"discretization.bend={BEND}"]
    return [*degree, *paced, "discretization.adaptive=false", *size]


def solutions(scene: Scene, end: float) -> Solutions:
    """Of a scene up to an opening; several curves of one scene share them."""
    return _of(scene.model_dump_json(), end)


@lru_cache(maxsize=4)
def _of(scene: str, end: float) -> Solutions:
    return Solutions(Scene.model_validate_json(scene), end)
