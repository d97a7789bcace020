"""Solutions of a scene with something changed, as loads at equal openings: on few unknowns, on all cores, kept."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache, partial
from pathlib import Path

import numpy as np

from verify.curves.curve import envelope, from_origin, samples
from verify.curves.of_run import cubics
from verify.methods.method import Unsuitable
from verify.methods.solve import prepare, require, solve_prepared
from verify.runs.estimate import seconds
from verify.runs.fingerprint import fingerprint
from verify.runs.store import opened
from verify.scene.parse import SceneError, parse_scene
from verify.scene.schema import Scene
from verify.support.at_once import at_once
from verify.support.progress import duration
from verify.support.refusal import NotRun

#: Points of the bond in an element of degree 2, and the distance from the tangent that steps may have.
POINTS, BEND = 5, 0.02
#: Rows of a leg of the beam: the least that it takes.
BEAM_ROWS = 75
#: The file of a solution in its folder: opening and load (2, n), none where there is no solution.
CURVE_FILE = "curve.npy"

#: How an override begins that is none of the scene, but a defect of its law (`verify.diagnosis.law_defects`).
OF_LAW = "law."

Curve = tuple[np.ndarray, np.ndarray]
#: A scene, and the defects of its law.
Asked = tuple[Scene, tuple[str, ...]]


def _nurbs(elements: float) -> list[str]:
    """Overrides of a coarse mesh with that many elements in the process zone."""
    degree = ["discretization.degree=2", f"discretization.interface_points={POINTS}", "discretization.adaptive=false"]
    steps = ["discretization.steps=auto", f"discretization.bend={BEND}"]
    return [*degree, *steps, "discretization.dofs=auto", f"discretization.in_a_zone={elements}"]


#: Solvers with the overrides of their meshes, the cheaper first. Four elements leave 0.1 % of the curve on ``dcb-czm1``
#: and 0.7 % on ``dcb-as4peek``, whose zone is short for the thickness of its arms, where the beam takes half the time
#: and leaves 0.5 %; it has no waves of elements, which move as the scene changes.
SOLVERS = (
    ("nurbs", _nurbs(4.0)),
    ("beam", [f"discretization.steps={BEAM_ROWS}", "beam.in_a_zone=2.5"]),
    ("nurbs", _nurbs(8.0)),
    ("nurbs", _nurbs(16.0)),
)
#: Place of the beam among them, and the distance of its curve from the reference up to which causes are searched on it.
BY_BEAM, NEAR_BEAM = 1, 0.05


def sampled(curve: Curve, at: np.ndarray) -> np.ndarray:
    """Load (n,) of the envelope at openings (n,), the last load beyond its end."""
    return np.interp(at, *envelope(*from_origin(*curve)))


class Solutions:
    """Loads (SAMPLES,) of a scene with overrides at openings up to ``end``, each solved once and kept in ``out``.

    A curve that goes further than half of the programme needs the solutions of the whole one, which others then share.
    """

    def __init__(self, scene: Scene, end: float, out: Path | None = None, solver: int = 0) -> None:
        self.scene, self.end, self.out, self.solver = scene, end, out, solver
        self.method, mesh = SOLVERS[solver]
        whole = max(scene.load.opening)
        self._table = {**scene.model_dump(), "published": [], "uncertainty": {}}
        self._settings = [f"load.opening={whole if end > 0.5 * whole else end!r}", *mesh]
        self._grid = samples(0.0, end)
        self._known: dict[tuple[str, ...], np.ndarray | None] = {}

    @property
    def possible(self) -> bool:
        """Whether the solver takes this scene."""
        try:
            require(prepare(self._changed(()), self.method))
        except (NotRun, Unsuitable, SceneError):
            return False
        return True

    def seconds(self) -> float:
        """Estimated time of one."""
        return seconds(self._changed(()), self.method)

    @property
    def base(self) -> np.ndarray:
        """Load of the scene as it is, which has a solution."""
        load = self.load()
        assert load is not None
        return load

    def load(self, overrides: Sequence[str] = ()) -> np.ndarray | None:
        """Load at the openings of the grid; None where that scene has no solution."""
        return self.loads([overrides])[0]

    def loads(self, several: Sequence[Sequence[str]]) -> list[np.ndarray | None]:
        """The same of several scenes, those that are not known at once."""
        keys = [tuple(overrides) for overrides in several]
        missing = list(dict.fromkeys(key for key in keys if key not in self._known))
        for key, curve in zip(missing, self._curves([self._asked(key) for key in missing]), strict=True):
            self._known[key] = None if curve is None else sampled(curve, self._grid)
        return [self._known[key] for key in keys]

    def _changed(self, overrides: Sequence[str]) -> Scene:
        return parse_scene(self._table, [*self._settings, *overrides])

    def _asked(self, overrides: Sequence[str]) -> Asked | None:
        laws = tuple(one for one in overrides if one.startswith(OF_LAW))
        try:
            return self._changed([one for one in overrides if one not in laws]), laws
        except SceneError:
            return None

    def _curves(self, asked: Sequence[Asked | None]) -> list[Curve | None]:
        """Curves of scenes, those that are not kept at once."""
        work = partial(_solved, method=self.method)
        if self.out is None:
            return list(at_once(work, asked))
        with opened(self.out) as store:
            keys = [one and fingerprint(one[0], self.method, "diagnosis", *one[1]) for one in asked]
            pairs = [(key, one) for key, one in zip(keys, asked, strict=True) if key and not store.whole(key)]
            for (key, _), curve in zip(pairs, at_once(work, [one for _, one in pairs]), strict=True):
                folder = store.begin(key)
                np.save(folder / CURVE_FILE, np.zeros((2, 0)) if curve is None else np.stack(curve))
                store.keep(folder, key)
            kept = [np.zeros((2, 0)) if key is None else np.load(store.folder(key) / CURVE_FILE) for key in keys]
            return [(opening, load) if opening.size else None for opening, load in kept]


def _solved(asked: Asked | None, method: str) -> Curve | None:
    if asked is None:
        return None
    scene, laws = asked
    revised = {}
    if laws:
        from verify.diagnosis.law_defects import defective  # imports the laws of two solvers

        revised = {"revised": partial(defective, overrides=laws)}
    try:
        result = solve_prepared(prepare(scene, method, **revised))
    except (SceneError, NotRun, Unsuitable, ValueError, ArithmeticError, np.linalg.LinAlgError):
        return None
    d, P = cubics(result)
    return (np.asarray(d), np.asarray(P)) if result.complete else None


def solutions(scene: Scene, end: float, reference: Curve, enough: float, out: Path | None = None) -> Solutions | None:
    """Of the cheapest solver that is ``enough`` near the reference (relative L2), or the nearest; None without any."""
    found: list[tuple[float, Solutions]] = []
    for number in range(len(SOLVERS)):
        found += _at_a_distance(scene, end, reference, out, number)
        if found and found[-1][0] <= enough:
            break
    return min(found, key=lambda one: one[0])[1] if found else None


def searching(scene: Scene, end: float, reference: Curve, out: Path | None = None) -> Solutions | None:
    """The beam, whose changes are those of the specimen, where it has the scene and is near the reference; else None.

    Its curve is off by a part of what it neglects; the change of that by a cause is far less.
    """
    return next((one for off, one in _at_a_distance(scene, end, reference, out, BY_BEAM) if off <= NEAR_BEAM), None)


def _at_a_distance(
    scene: Scene, end: float, reference: Curve, out: Path | None, solver: int
) -> list[tuple[float, Solutions]]:
    """A solver with the distance of its curve from the reference (relative L2); empty without a curve."""
    one = _of(scene.model_dump_json(), end, out, solver)
    load, right = one.load() if one.possible else None, sampled(reference, samples(0.0, end))
    return [] if load is None else [(float(np.linalg.norm(load - right) / np.linalg.norm(right)), one)]


def first_solutions(scene: Scene, out: Path) -> str:
    """What a look at a curve solves, in words."""
    end = max(scene.load.opening)
    one, beam = (_of(scene.model_dump_json(), end, out, solver) for solver in (0, BY_BEAM))
    if not one.possible:
        return "causes in the curve alone"
    solved = f"{one.method} on few unknowns, about {duration(one.seconds())} each on one core"
    if scene.specimen.slides and beam.possible:
        return f"a search on a beam, and where one cause explains at most three solutions by {solved}"
    return f"about twenty solutions by {solved}"


@lru_cache(maxsize=8)
def _of(scene: str, end: float, out: Path | None, solver: int) -> Solutions:
    """Several curves of one scene share them."""
    return Solutions(Scene.model_validate_json(scene), end, out, solver)
