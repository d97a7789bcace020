"""Solutions of a scene with something changed, as loads at equal openings."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

import numpy as np

from verify.curves.curve import SAMPLES, envelope, from_origin
from verify.curves.of_run import cubics
from verify.methods.method import Unsuitable
from verify.methods.solve import prepare, require, solve
from verify.methods.zone_resolution import expected
from verify.scene.parse import SceneError, parse_scene
from verify.scene.schema import Scene
from verify.support.refusal import NotRun

#: The solver: it solves every scene, and on few unknowns in a tenth of a second.
METHOD = "nurbs"
#: Elements of degree 2 in the process zone, which leave 0.2 to 0.3 % of the curve on ``dcb-czm1``, with points in each,
#: and the distance from the tangent that steps may have. A change of the scene changes these errors but little.
ELEMENTS, POINTS, BEND = 4.0, 5, 0.02


def sampled(curve: tuple[np.ndarray, np.ndarray], at: np.ndarray) -> np.ndarray:
    """Load (n,) of the envelope at openings (n,), the last load beyond its end."""
    return np.interp(at, *envelope(*from_origin(*curve)))


class Solutions:
    """Loads of the scene with overrides, each solved once; ``end``: the opening up to which they are wanted."""

    def __init__(self, scene: Scene, end: float) -> None:
        self.scene, self.grid = scene, end * np.arange(1, SAMPLES + 1) / SAMPLES
        self._table = {**scene.model_dump(), "published": [], "uncertainty": {}}
        self._settings = [f"load.opening={end!r}"]
        self._known: dict[tuple[str, ...], np.ndarray | None] = {}

    @property
    def possible(self) -> bool:
        """Whether the solver takes this scene."""
        try:
            self._settings = [*self._settings[:1], *_mesh(self.scene)]
            require(prepare(parse_scene(self._table, self._settings), METHOD))
        except (NotRun, Unsuitable, SceneError):
            return False
        return True

    def load(self, overrides: Sequence[str] = ()) -> np.ndarray | None:
        """Load (SAMPLES,) at the openings of the grid; None where that scene has no solution."""
        key = tuple(overrides)
        if key not in self._known:
            self._known[key] = self._solved(key)
        return self._known[key]

    def change(self, overrides: Sequence[str]) -> np.ndarray | None:
        """What the overrides change of the load."""
        base, other = self.load(), self.load(overrides)
        return None if base is None or other is None else other - base

    def _solved(self, overrides: tuple[str, ...]) -> np.ndarray | None:
        try:
            result = solve(parse_scene(self._table, [*self._settings, *overrides]), METHOD)
        except (SceneError, NotRun, Unsuitable, ValueError, ArithmeticError, np.linalg.LinAlgError):
            return None
        d, P = cubics(result)
        return sampled((np.asarray(d), np.asarray(P)), self.grid) if result.complete else None


def _mesh(scene: Scene) -> list[str]:
    """Overrides of a coarse mesh."""
    degree = ["discretization.degree=2", f"discretization.interface_points={POINTS}"]
    given = parse_scene(scene.model_dump(), degree)
    dofs = round(given.discretization.dofs * ELEMENTS / expected(given, METHOD).elements)
    paced = ["discretization.steps=auto", f"discretization.bend={BEND}"]
    return [*degree, *paced, "discretization.adaptive=false", f"discretization.dofs={max(dofs, 40)}"]


def solutions(scene: Scene, end: float) -> Solutions:
    """Of a scene up to an opening; several curves of one scene share them."""
    return _of(scene.model_dump_json(), end)


@lru_cache(maxsize=4)
def _of(scene: str, end: float) -> Solutions:
    return Solutions(Scene.model_validate_json(scene), end)
