"""Solutions of a scene with something changed, as loads at equal openings."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

import numpy as np

from verify.curves.curve import SAMPLES, envelope, from_origin
from verify.curves.of_run import cubics
from verify.methods.method import NotRun, Unsuitable
from verify.methods.solve import prepare, require, solve
from verify.scene.parse import SceneError, parse_scene
from verify.scene.schema import Scene

#: The solver: seconds, no mesh of its own, and no code shared with most of those that are diagnosed.
METHOD = "beam"
#: Steps of a solution; cubics through their slopes make a smooth curve of them.
SOLUTION_STEPS = 30


def sampled(curve: tuple[np.ndarray, np.ndarray], at: np.ndarray) -> np.ndarray:
    """Load (n,) of the envelope at openings (n,), the last load beyond its end."""
    return np.interp(at, *envelope(*from_origin(*curve)))


class Solutions:
    """Loads of the scene with overrides, each solved once; ``end``: the opening up to which they are wanted."""

    def __init__(self, scene: Scene, end: float) -> None:
        self.scene, self.grid = scene, end * np.arange(1, SAMPLES + 1) / SAMPLES
        self._table = {**scene.model_dump(), "published": [], "uncertainty": {}}
        self._settings = [f"load.opening={end!r}", f"discretization.steps={SOLUTION_STEPS}"]
        self._known: dict[tuple[str, ...], np.ndarray | None] = {}

    @property
    def possible(self) -> bool:
        """Whether the beam solves this scene."""
        try:
            require(prepare(self.scene, METHOD))
        except (NotRun, Unsuitable):
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


def solutions(scene: Scene, end: float) -> Solutions:
    """Of a scene up to an opening; several curves of one scene share them."""
    return _of(scene.model_dump_json(), end)


@lru_cache(maxsize=4)
def _of(scene: str, end: float) -> Solutions:
    return Solutions(Scene.model_validate_json(scene), end)
