"""Toughness, strength and modulus of a curve by least squares on solutions of the cohesive beam."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.optimize import least_squares
from scipy.special import stdtrit

from verify.curves.curve import load_at
from verify.curves.of_run import cubics
from verify.methods.solve import solve
from verify.reduction.reduce import LEVEL, Reduction, Value
from verify.scene.parse import parse_scene
from verify.scene.schema import Scene
from verify.studies.reduce.wording import with_interval
from verify.support.progress import Progress
from verify.support.refusal import Refusal


@dataclass(frozen=True)
class FitSettings:
    """How a curve is fitted.

    ``points``: number of openings at which the curve of a run is compared; a test is compared at all its rows.
    ``step``: relative change of a parameter for its derivative; a smaller one is disturbed by the steps of the solver,
    a larger one by the curvature. ``steps`` of a solution and the largest number of ``solutions`` bound the time.
    ``in_a_zone``: elements of the beam in a process zone; the teeth of the usual 5, of 4e-4 of the load, stopped the
    descent 2 % off the strength. ``slack``: unit of the toe, in parts of the opening at the largest load. The toe of
    the linear part may be too large by no more than that.
    """

    points: int = 120
    step: float = 0.02
    steps: int = 150
    solutions: int = 60
    in_a_zone: int = 12
    slack: float = 0.1
    method: str = "beam"


FITTING = FitSettings()
#: A parameter is not identified if the half width of its interval over its value is larger than this.
VAGUE = 0.25
#: Kind -> keys of strength and toughness that its curve depends on.
FITTED_KEYS = {
    "dcb": ("strength", "toughness"),
    "enf": ("shear_strength", "shear_toughness"),
    "els": ("shear_strength", "shear_toughness"),
    "4enf": ("shear_strength", "shear_toughness"),
}


@dataclass(frozen=True)
class Fit:
    """The best fit, with 95 % intervals and its curve.

    ``misfit`` is the standard deviation of the residual loads over the largest load; ``felt`` the root mean square of
    the change of the load by 10 % more strength, likewise. ``toe`` is that of the test, None where no toe is taken off.
    Openings are those of the corrected rows.
    """

    strength: Value
    toughness: Value
    modulus: Value
    toe: Value | None
    misfit: float
    felt: float
    solutions: int
    opening: np.ndarray
    load: np.ndarray

    @property
    def values(self) -> dict[str, Value]:
        """What was fitted, by its name."""
        found = {"toughness": self.toughness, "strength": self.strength, "modulus": self.modulus}
        return found if self.toe is None else {**found, "toe": self.toe}

    @property
    def sentences(self) -> tuple[str, ...]:
        """The parameters, and which of them the curve does not determine."""
        off = f"{100 * self.misfit:.2g} % of the peak"
        said = [
            ", ".join(f"{name} {with_interval(value)}" for name, value in self.values.items()),
            f"the curve is {off} off, root mean square, after {self.solutions} solutions",
        ]
        part = self.strength.half / abs(self.strength.value)
        if not part <= VAGUE:
            said.append(
                f"the strength cannot be identified from this curve, its interval is ± {100 * part:.0f} %: a tenth "
                f"more of it changes the load by {100 * self.felt:.2g} % of the peak, and {off} is noise"
            )
        return tuple(said)


def fitted(found: Reduction, scene: Scene) -> Fit:
    """Fit strength, toughness and modulus, from those of the scene and the toughness of the reduction, and the toe.

    Loads are compared at equal openings of the corrected curve, up to the last row of growth and without unloading; a
    snap-back is a drop. Where the bond gives way in the linear part, its line meets the axis below 0: the toe of that
    line is a start, and no more.
    Intervals are ``t s sqrt(diag (J^T J)^-1)``, with s^2 the residual sum of squares per degree of freedom; the
    residual is taken as noise.

    Raises
    ------
    Refusal : a kind that fits no single toughness, or a curve without growth.
    """
    if found.coupon.kind not in FITTED_KEYS:
        raise Refusal(f"--fit: must be for {', '.join(FITTED_KEYS)}, got the kind {found.coupon.kind!r}")
    if not found.grown.any():
        raise Refusal("--fit: needs rows on which the crack grows, got none")
    data = _data(found)
    with Progress("fit", FITTING.solutions) as progress:
        return _fitted(_Solver(scene, found, data, progress), data[0].size)


def _fitted(solver: _Solver, rows: int) -> Fit:
    unknowns = 4 if solver.has_toe else 3
    bounds = [0.05, 0.2, 0.3, 0.0][:unknowns], [20.0, 5.0, 3.0, 6.0][:unknowns]
    best = least_squares(
        solver.left, np.ones(unknowns), bounds=bounds, diff_step=FITTING.step, xtol=1e-4, ftol=1e-6,
        max_nfev=FITTING.solutions // 4,
    )  # fmt: skip
    free = rows - unknowns
    s2 = 2.0 * best.cost / free
    spread = np.linalg.pinv(best.jac.T @ best.jac)
    half = stdtrit(free, 0.5 + LEVEL / 2.0) * np.sqrt(s2 * np.diag(spread))
    scaled = zip(solver.base, best.x, half, strict=False)
    strength, toughness, modulus = (Value(base * float(x), base * float(h)) for base, x, h in scaled)
    toe = Value(solver.toe(best.x), solver.slack * float(half[3])) if solver.has_toe else None
    felt = 0.1 * best.x[0] * float(np.sqrt(np.mean(best.jac[:, 0] ** 2)))
    d, P = solver.curve(best.x)
    shown = d + solver.shift(best.x)
    return Fit(strength, toughness, modulus, toe, float(np.sqrt(s2)), felt, solver.count, shown, P)


def _data(found: Reduction) -> tuple[np.ndarray, np.ndarray]:
    """Openings and loads from the linear part on: the rows of a test, or equally spaced points of a run."""
    first, last = int(found.part.rows[0]), int(np.flatnonzero(found.grown)[-1])
    within = np.arange(first, last + 1)
    if not found.rows.virtual:
        within = within[~found.unloads[within]]
    d, P = found.rows.opening[within], found.rows.load[within]
    if not found.rows.virtual:
        return d, P
    at = d[0] + (float(d.max()) - d[0]) * np.arange(1, FITTING.points + 1) / FITTING.points
    at[-1] = d.max()
    return at, load_at((d, P), at)


class _Solver:
    """Solutions of the scene with strength, toughness and modulus times ``x`` (3,), or (4,) with the toe behind them:
    1 is that of the linear part, and 1 more is one of ``slack`` more."""

    def __init__(self, scene: Scene, found: Reduction, data: tuple[np.ndarray, np.ndarray], progress: Progress) -> None:
        self._at, self._load = data
        self._peak = float(self._load.max())
        self._keys = FITTED_KEYS[found.coupon.kind]
        self._table = scene.model_dump()
        self._table["published"] = []
        bond = self._table["interface"]
        start = next(one.propagation.value for one in found.schemes if one.name == "CBBM")
        self.base = (float(bond[self._keys[0]]), start, found.coupon.young)
        self.has_toe, self._toe = found.settings.toe, found.toe
        self.slack = FITTING.slack * float(self._at[np.argmax(self._load)])
        self._end = 1.001 * float(self._at.max()) + self.slack * self.has_toe
        self._solved: dict[tuple[float, ...], tuple[np.ndarray, np.ndarray]] = {}
        self._progress = progress

    @property
    def count(self) -> int:
        """Solutions so far."""
        return len(self._solved)

    def shift(self, x: np.ndarray) -> float:
        """Toe beyond that of the linear part."""
        return self.slack * (float(x[3]) - 1.0) if self.has_toe else 0.0

    def toe(self, x: np.ndarray) -> float:
        return self._toe + self.shift(x)

    def curve(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Opening and load, with points between the steps."""
        key = tuple(float(part) for part in x[:3])
        if key not in self._solved:
            self._solved[key] = self._solution(*key)
            self._progress.advance(min(self.count, FITTING.solutions), f"{self.count} solutions")
        return self._solved[key]

    def _solution(self, strength: float, toughness: float, modulus: float) -> tuple[np.ndarray, np.ndarray]:
        bond = zip(self._keys, (strength * self.base[0], toughness * self.base[1]), strict=True)
        names = [f"interface.{key}={value!r}" for key, value in bond]
        moduli = [f"material.{key}={modulus * value!r}" for key, value in _moduli(self._table["material"]).items()]
        settings = [f"load.opening={self._end!r}", f"discretization.steps={FITTING.steps}"]
        settings.append(f"{FITTING.method}.in_a_zone={FITTING.in_a_zone}")
        scene = parse_scene(self._table, [*names, *moduli, *settings])
        d, P = cubics(solve(scene, FITTING.method))
        return np.asarray(d), np.asarray(P)

    def left(self, x: np.ndarray) -> np.ndarray:
        """Load minus that of the data, over its largest; 0 beyond the end of a run that has separated."""
        return (np.nan_to_num(load_at(self.curve(x), self._at - self.shift(x))) - self._load) / self._peak


def _moduli(material: Any) -> dict[str, float]:
    """The modulus along the arms, by its key."""
    return {key: float(material[key]) for key in ("young", "E1") if material.get(key) is not None}
