"""Toughness, strength and modulus of a curve by least squares on solutions of the cohesive beam."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from scipy.optimize import least_squares
from scipy.special import stdtrit

from verify.curves.curve import Curve, load_at
from verify.curves.of_run import cubics
from verify.methods.solve import solve
from verify.reduction.corrections import smooth
from verify.reduction.initiation import ONSET
from verify.reduction.reduce import LEVEL, Reduction, Value
from verify.reduction.schemes import ALL_SLIDES
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
    ``in_a_zone``: elements of the beam in a process zone; the ripple of the usual 5, of 4e-4 of the load, stopped the
    descent 2 % off the strength. ``slack``: unit of the toe, in parts of the opening at the largest load. The toe of
    the linear part may be too large by no more than that.
    """

    points: int = 120
    step: float = 0.02
    steps: int = 150
    solutions: int = 60
    in_a_zone: int = 12
    slack: float = 0.1


FITTING, FITTED_BY = FitSettings(), "beam"
#: Standard deviation, times the root of the number of rows, of the variance of a residual that is noise over that of
#: the noise by second differences (`smooth`): of both estimates together, by 3000 draws of 150 to 4000 rows each.
OF_VARIANCES = 2.5
#: Safety factor of an error by two meshes (Roache 1994, J. Fluids Eng. 116, 405-413).
OF_TWO_MESHES = 3.0
#: A parameter is not identified if the half width of its interval over its value is larger than this.
VAGUE = 0.25
#: Kind -> beginning of the keys of strength and toughness that its curve depends on.
FITTED_KEYS = {"dcb": "", **dict.fromkeys(ALL_SLIDES, "shear_")}
#: Least and largest strength, toughness and modulus, over those at the beginning, and toe.
BOUNDS = np.array([(0.05, 20.0), (0.2, 5.0), (0.3, 3.0), (0.0, 6.0)]).T


@dataclass(frozen=True)
class Fit:
    """The best fit, with 95 % intervals and its curve.

    ``misfit`` is the standard deviation of the residual loads over the largest load; ``effect`` the root mean square of
    the change of the load by 10 % more strength, likewise, and ``explained`` what the noise of the test and the error
    of the solver may leave. ``values`` are toughness, strength, modulus, and the toe of a test, unless no toe is taken
    off; they have no interval where the misfit is more. Openings are those of the corrected rows.
    """

    values: dict[str, Value]
    misfit: float
    explained: float
    effect: float
    solutions: int
    opening: np.ndarray
    load: np.ndarray
    name = "fit"
    title = "Fit by a solver"

    @property
    def content(self) -> dict[str, Any]:
        """For reduce.json."""
        values = {name: asdict(value) for name, value in self.values.items()}
        return {**values, "misfit": self.misfit, "explained": self.explained, "solutions": self.solutions}

    @property
    def sentences(self) -> tuple[str, ...]:
        """The parameters, and which of them the curve does not determine."""
        off, strength = f"{100 * self.misfit:.2g} % of the peak", self.values["strength"]
        said = [
            ", ".join(f"{name} {with_interval(value)}" for name, value in self.values.items()),
            f"the curve is {off} off, root mean square, after {self.solutions} solutions",
        ]
        if self.misfit > self.explained:
            return (
                *said,
                f"this law does not describe the test, and no interval is given: noise and the solver leave at most "
                f"{100 * self.explained:.2g} % of the peak",
            )
        part = strength.half_width / abs(strength.value)
        if not part <= VAGUE:
            said.append(
                f"the strength cannot be identified from this curve, its interval is ± {100 * part:.0f} %: a tenth "
                f"more of it changes the load by {100 * self.effect:.2g} % of the peak, and {off} is noise"
            )
        return tuple(said)


def fitted(found: Reduction, scene: Scene) -> Fit:
    """Fit strength, toughness and modulus, from those of the scene and the toughness of the reduction, and the toe.

    Loads are compared at equal openings of the corrected curve, up to the last row of growth and without unloading; a
    snap-back is a drop. Where the bond gives way in the linear part, its line meets the axis below 0: the toe of that
    line is a start, and no more.
    Intervals are ``t s sqrt(diag (J^T J)^-1)``, with s^2 the residual sum of squares per degree of freedom. The
    residual is taken as noise if s^2 is at most that of the noise of the test by its second differences, five standard
    deviations of both included, and the square of the solver's error: three times what half as many elements change.

    Raises
    ------
    Refusal : a kind that fits no single toughness, or a curve without growth.
    """
    if found.coupon.kind not in FITTED_KEYS:
        raise Refusal(f"--fit: must be for {', '.join(FITTED_KEYS)}, got the kind {found.coupon.kind!r}")
    if not found.grown.any():
        raise Refusal("--fit: needs rows on which the crack grows, got none")
    at, load = _data(found)
    peak, unknowns = float(load.max()), 4 if found.settings.toe else 3
    slack = FITTING.slack * float(at[np.argmax(load)])
    end, solved = 1.001 * float(at.max()) + slack * found.settings.toe, dict[tuple[float, ...], Curve]()
    raw = {**scene.model_dump(), "published": []}
    keys = [f"{FITTED_KEYS[found.coupon.kind]}{name}" for name in ("strength", "toughness")]
    start = float(raw["interface"][keys[0]]), found.by_name["CBBM"].propagation.value, found.coupon.young

    def curve(x: np.ndarray, elements: float = FITTING.in_a_zone) -> Curve:
        """Of the scene with strength, toughness and modulus times ``x``, with points between the steps."""
        key = (*map(float, x[:3]), elements)
        if key not in solved:
            bond = [f"interface.{name}={part * base!r}" for name, part, base in zip(keys, key, start, strict=False)]
            settings = (
                f"load.opening={end!r}",
                f"discretization.steps={FITTING.steps}",
                f"{FITTED_BY}.in_a_zone={elements}",
            )
            solved[key] = cubics(solve(parse_scene(raw, [*bond, *moduli(raw, key[2]), *settings]), FITTED_BY))
            progress.advance(min(len(solved), FITTING.solutions), f"{len(solved)} solutions")
        return solved[key]

    def shift(x: np.ndarray) -> float:
        """Toe beyond that of the linear part, which is at 1."""
        return slack * (float(x[3]) - 1.0) if unknowns == 4 else 0.0

    def left(x: np.ndarray, elements: float = FITTING.in_a_zone) -> np.ndarray:
        """Load minus that of the data, over its largest; 0 beyond the end of a run that has separated."""
        return (np.nan_to_num(load_at(curve(x, elements), at - shift(x))) - load) / peak

    with Progress("fit", FITTING.solutions) as progress:
        best = least_squares(
            left, np.ones(unknowns), bounds=BOUNDS[:, :unknowns], diff_step=FITTING.step, xtol=1e-4, ftol=1e-6,
            max_nfev=FITTING.solutions // 4,
        )  # fmt: skip
        d, P = map(np.asarray, curve(best.x))
        rough = left(best.x) - left(best.x, FITTING.in_a_zone / 2.0)
    free = at.size - unknowns
    s2 = 2.0 * best.cost / free
    noise2 = (smooth(found.rows).noise / peak) ** 2 * (1.0 + ONSET.sigmas * OF_VARIANCES / at.size**0.5)
    explained = float(np.sqrt(noise2 + OF_TWO_MESHES**2 * np.mean(rough**2)))
    half = stdtrit(free, 0.5 + LEVEL / 2.0) * np.sqrt(s2 * np.diag(np.linalg.pinv(best.jac.T @ best.jac)))
    half = np.where(s2 > explained**2, np.nan, half)
    scaled = zip(("strength", "toughness", "modulus"), start, best.x, half, strict=False)
    values = {name: Value(base * float(x), base * float(h)) for name, base, x, h in scaled}
    if unknowns == 4:
        values["toe"] = Value(found.toe + shift(best.x), slack * float(half[3]))
    effect = 0.1 * best.x[0] * float(np.sqrt(np.mean(best.jac[:, 0] ** 2)))
    return Fit(values, float(np.sqrt(s2)), explained, effect, len(solved), d + shift(best.x), P)


def _data(found: Reduction) -> tuple[np.ndarray, np.ndarray]:
    """Openings and loads from the linear part on: the rows of a test, or equally spaced points of a run."""
    within = np.arange(found.part.rows[0], np.flatnonzero(found.grown)[-1] + 1)
    if not found.rows.virtual:
        within = within[~found.unloads[within]]
        return found.rows.opening[within], found.rows.load[within]
    d, P = found.rows.at(within).opening, found.rows.at(within).load
    at = np.linspace(d[0], d.max(), FITTING.points + 1)[1:]
    return at, load_at((d, P), at)


def moduli(raw: Mapping[str, Any], times: float) -> list[str]:
    """Overrides of a scene whose arms are so many times as stiff."""
    given = {name: raw["material"].get(name) for name in ("young", "E1")}
    return [f"material.{name}={times * float(one)!r}" for name, one in given.items() if one is not None]
