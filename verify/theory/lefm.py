"""DCB and peel test by linear elastic fracture mechanics: no process zone, the crack grows once G reaches G_Ic.

Five theories, each a compliance and a condition of growth, for n arms: two of a DCB, one (the strip) of a peel test.

simple     opening = n P a^3 / (3 E I), P_c = sqrt(2 w G E I / n) / a: the arms are clamped at the crack tip
corrected  the same with a + chi h for a: the tip rotates, the arms shear (DCB)
factors    corrected, with the factors F and N for moderately large openings (DCB)
elastica   n P sin(theta) = G w: exact for inextensible clamped arms, however far they bend
kendall    P + P^2 / (2 E A) = G w: a strip with axial stiffness alone, peeled at 90 degrees (peel)

LEFM is the limit of cohesive solutions for infinite strength, not a reference for those of finite strength.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple, Protocol

import numpy as np

from verify.theory import elastica
from verify.theory.solution import Solution, rows_of

#: Available theories by the number of arms.
LEFM_THEORIES = {2: ("simple", "corrected", "factors", "elastica"), 1: ("simple", "elastica", "kendall")}

#: Largest step of the opening of a growing crack, over the opening: of P ~ opening^(-1/2) the trapezoidal rule misses
#: 1/16 of its square, 0.06 %, and the cubic Hermite rule 1e-6.
MOST_GROWTH = 0.1

#: Coefficients of the factors without load blocks: F = 1 - F2 (opening / a)^2, N = 1 - N2 (opening / a)^2.
F2, N2 = 3.0 / 10.0, 9.0 / 35.0


@dataclass(frozen=True)
class LefmProblem:
    """A double cantilever beam, or with one of ``arms`` a strip on a rigid base, under a monotone opening.

    A strip has the length and the thickness of an arm; its precrack is the length that is not bonded.

    ``young``, ``transverse``, ``shear``: moduli along and across the arm (plane strain: E / (1 - nu^2)) and in shear.
    ``theory`` is one of `LEFM_THEORIES` or ``auto``: corrected for linear, factors for finite kinematics; for a strip
    simple and elastica. ``points`` is the number of rows after the first, and there are more where the crack begins to
    grow so early that their equal steps would miss the shape of the curve (see `MOST_GROWTH`).
    """

    length: float
    arm_thickness: float
    precrack: float
    width: float
    young: float
    transverse: float
    shear: float
    toughness: float
    opening: float | Sequence[float] = 1.0
    kinematics: str = "linear"
    theory: str = "auto"
    points: int = 150
    arms: int = 2

    @property
    def bending(self) -> float:
        """Bending stiffness E I of an arm."""
        return self.young * self.width * self.arm_thickness**3 / 12.0

    @property
    def resistance(self) -> float:
        """Energy per unit crack length, G_Ic w."""
        return self.toughness * self.width

    @property
    def named_theory(self) -> str:
        """The theory, with ``auto`` resolved."""
        usual = {2: ("corrected", "factors"), 1: ("simple", "elastica")}[self.arms]
        return self.theory if self.theory != "auto" else usual[self.kinematics == "finite"]


class Branch(NamedTuple):
    """Points of a curve (n,): load, opening, crack length, slope dP/d(opening), stored energy, slope of an end face."""

    opening: np.ndarray
    load: np.ndarray
    crack: np.ndarray
    load_slope: np.ndarray
    stored: np.ndarray
    face_slope: np.ndarray


class Moduli(Protocol):
    """Moduli of an arm along it, across it, and in shear."""

    @property
    def young(self) -> float: ...
    @property
    def transverse(self) -> float: ...
    @property
    def shear(self) -> float: ...


def chi(arm: Moduli) -> float:
    """Correction of the crack length, in arm thicknesses.

    chi^2 = E1 / (11 G12) [3 - 2 (Gamma / (1 + Gamma))^2], Gamma = 1.18 sqrt(E1 E2) / G12
    (Williams 1989, Compos. Sci. Technol. 35, 367-376; Hashemi, Kinloch, Williams 1990, Proc. R. Soc. A 427, 173-199).
    """
    gamma = 1.18 * np.sqrt(arm.young * arm.transverse) / arm.shear
    return float(np.sqrt(arm.young / (11.0 * arm.shear) * (3.0 - 2.0 * (gamma / (1.0 + gamma)) ** 2)))


def solve(problem: LefmProblem, on_step: Callable[[Mapping[str, float]], None] | None = None) -> Solution:
    """Load curve: the arms bend with the crack at the precrack, then the crack grows to the end of the programme.

    The columns are those of a run. At the onset of growth the path has a kink; ``load_slope`` there is that before it.
    The integral of the load equals stored plus dissipated energy exactly, except for ``factors``, whose F and N are
    consistent to the order (opening / a)^2 only; there ``external_work`` is the integral of the load.

    Raises
    ------
    ValueError : the programme unloads, or the theory is not available for the specimen
    """
    programme = np.append(0.0, problem.opening)
    if np.any(np.diff(programme) <= 0.0):
        raise ValueError(f"load.opening: must only increase for the method lefm, got {programme[1:].tolist()}")
    end, theory = float(programme[-1]), problem.named_theory
    if theory not in LEFM_THEORIES[problem.arms]:
        raise ValueError(f"theory: must be one of {', '.join(LEFM_THEORIES[problem.arms])}, got {theory}")
    solvers = {"elastica": _elastica, "factors": _factors, "kendall": _kendall}
    loading, growth = solvers.get(theory, _beam)(problem, end)
    beyond = growth.crack > problem.length
    rows = _rows(problem, loading, Branch(*(column[~beyond] for column in growth)))
    if on_step is not None:
        for row in rows:
            on_step(row)
    return Solution(rows, ending=f"separated at opening {rows[-1]['opening']:.6g}" if beyond.any() else "")


def _split(problem: LefmProblem, onset: float, end: float) -> tuple[np.ndarray, np.ndarray]:
    """Openings of the loading branch, from 0, and of the growing crack (empty if the programme ends before)."""
    if end <= onset:
        return np.linspace(0.0, end, problem.points + 1), np.zeros(0)
    before = int(np.clip(problem.points * onset / end, 2, problem.points - 2))
    return np.linspace(0.0, onset, before + 1), _growing(onset, end, problem.points - before)


def _growing(onset: float, end: float, steps: int) -> np.ndarray:
    """Openings behind the onset, by equal steps, and before these by such in proportion to the opening."""
    step = (end - onset) / steps
    early = max(0.0, np.ceil(np.log(step / (MOST_GROWTH * onset)) / np.log1p(MOST_GROWTH)))
    graded = onset * (1.0 + MOST_GROWTH) ** np.arange(early + 1.0)
    graded = graded[graded < end]
    equal = max(1, round((end - graded[-1]) / step))
    return np.append(graded[1:], np.linspace(graded[-1], end, equal + 1)[1:])


def _beam(problem: LefmProblem, end: float) -> tuple[Branch, Branch]:
    """Simple and corrected beam theory; ``A`` is the effective crack length.

    Growth: opening = A^2 / 3 sqrt(2 n G w / E I), so P ~ opening^(-1/2).
    """
    EI, Gw, arms = problem.bending, problem.resistance, problem.arms
    more = chi(problem) * problem.arm_thickness if problem.named_theory == "corrected" else 0.0
    reach = np.sqrt(2.0 * arms * Gw / EI) / 3.0
    first, then = _split(problem, reach * (problem.precrack + more) ** 2, end)
    A = np.full_like(first, problem.precrack + more)
    stiffness = 3.0 * EI / (arms * A**3)
    loading = Branch(
        first,
        stiffness * first,
        np.full_like(first, problem.precrack),
        stiffness,
        0.5 * stiffness * first**2,
        -stiffness * first * A**2 / (2.0 * EI),
    )
    A = np.sqrt(then / reach)
    P = np.sqrt(2.0 / arms * Gw * EI) / A
    growth = Branch(then, P, A - more, -0.5 * P / then, 0.5 * P * then, -P * A**2 / (2.0 * EI))
    return loading, growth


def _factors(problem: LefmProblem, end: float) -> tuple[Branch, Branch]:
    """Corrected beam theory with the factors for large displacement, of r = opening / a without load blocks.

    opening = 2 P A^3 N / (3 E I) and G w = 3 P opening F / (2 A N), A = a + chi h, F = 1 - 3/10 r^2, N = 1 - 9/35 r^2
    (Williams 1987, J. Strain Anal. 22, 243; ISO 15024:2001, annexes; Hashemi, Kinloch, Williams 1990). Hence on growth
    opening = 2/3 A^2 N sqrt(G w / (E I F)). Stored at a fixed crack: the integral of the load over the opening.
    """
    EI, Gw, a0 = problem.bending, problem.resistance, problem.precrack
    more = chi(problem) * problem.arm_thickness
    reach = 2.0 / 3.0 * np.sqrt(Gw / EI)
    simple = reach * (a0 + more) ** 2
    onset = np.inf
    if end**2 * _F(end / a0) >= (simple * _N(end / a0)) ** 2 or _F(end / a0) <= 0.0:  # G reaches G_Ic before the end
        onset = float(_fixed_point(lambda d: simple * _N(d / a0) / np.sqrt(_F(d / a0)), simple))
    first, then = _split(problem, onset, end)

    def stored(opening: np.ndarray, a: Any) -> np.ndarray:
        r = opening / a
        return -0.75 * EI * a**2 / (a + more) ** 3 * np.log1p(-N2 * r**2) / N2

    def load(opening: np.ndarray, a: Any) -> np.ndarray:
        return 3.0 * EI * opening / (2.0 * (a + more) ** 3 * _N(opening / a))

    r = first / a0
    loading = Branch(
        first,
        load(first, a0),
        np.full_like(first, a0),
        3.0 * EI / (2.0 * (a0 + more) ** 3) * (1.0 + N2 * r**2) / _N(r) ** 2,
        stored(first, a0),
        np.full_like(first, np.nan),
    )
    a = _fixed_point(
        lambda a: np.sqrt(then / reach * np.sqrt(_F(then / a)) / _N(then / a)) - more,
        np.maximum(np.sqrt(then / reach) - more, a0),
    )
    P = load(then, a)
    slope = _slope_of_growth(P, then, a, more)
    growth = Branch(then, P, a, slope, stored(then, a), np.full_like(then, np.nan))
    return loading, growth


def _slope_of_growth(P: Any, opening: Any, a: Any, more: float) -> Any:
    """dP/d(opening) along r a = const (a + more)^2 N / sqrt(F), by the logarithmic derivatives of F and N in r."""
    r = opening / a
    dF, dN = -2.0 * F2 * r**2 / _F(r), -2.0 * N2 * r**2 / _N(r)
    grow = (1.0 - dN + 0.5 * dF) / (2.0 * a / (a + more) - dN + 0.5 * dF)  # d(log a) / d(log opening)
    return P / opening * (1.0 - 3.0 * grow * a / (a + more) - dN * (1.0 - grow))


def _work(problem: LefmProblem, loading: Branch, growth: Branch) -> np.ndarray:
    """Integral of the load: stored energy up to the onset, then the cubic Hermite rule with the slopes of growth."""
    opening, P = loading.opening[-1], loading.load[-1]
    slope = _slope_of_growth(P, opening, problem.precrack, chi(problem) * problem.arm_thickness)
    if not growth.opening.size:
        return loading.stored
    nodes = (
        np.append(first, rest)
        for first, rest in ((opening, growth.opening), (P, growth.load), (slope, growth.load_slope))
    )
    from scipy.interpolate import CubicHermiteSpline  # here, as LEFM is a part of few runs

    work = CubicHermiteSpline(*nodes).antiderivative()
    return np.append(loading.stored, loading.stored[-1] + work(growth.opening))


def _F(r: Any) -> Any:
    return 1.0 - F2 * r**2


def _N(r: Any) -> Any:
    return 1.0 - N2 * r**2


def _fixed_point(step: Callable[[Any], Any], value: Any) -> Any:
    """Damped fixed-point iteration to rounding; it contracts, since the factors change slowly.

    Raises
    ------
    ValueError : no convergence; the opening is beyond the range of the factors
    """
    for _ in range(200):
        with np.errstate(invalid="ignore"):
            new = step(value)
        if not np.all(np.isfinite(new)):
            break
        if np.all(np.abs(new - value) <= 4e-16 * np.abs(new)):
            return new
        value = 0.5 * (new + value)
    if np.all(np.isfinite(new)) and np.all(np.abs(new - value) <= 1e-12 * np.abs(new)):
        return new
    raise ValueError("load.opening: too large for the factors F and N, take the theory elastica")


def _elastica(problem: LefmProblem, end: float) -> tuple[Branch, Branch]:
    """n P sin(theta) = G w on growth; before it, the elastica of the length of the precrack."""
    EI, Gw, a0, arms = problem.bending, problem.resistance, problem.precrack, problem.arms
    first, then = _split(problem, elastica.onset(EI, Gw, a0, arms), end)
    both = (first, elastica.fixed_crack(EI, a0, first, arms)), (then, elastica.growing_crack(EI, Gw, then, arms))
    parts = []
    for opening, arm in both:
        stored = arm.load * (arms * arm.sine * arm.crack - opening)  # E I phi'^2 / 2 = P (S - sin phi), of each arm
        parts.append(Branch(opening, arm.load, arm.crack, arm.load_slope, stored, -arm.sine))
    return parts[0], parts[1]


def _kendall(problem: LefmProblem, end: float) -> tuple[Branch, Branch]:
    """A strip without bending stiffness: slack until it is upright, then stretched, then peeled at a constant load.

    (P / w) (1 - cos(theta)) + (P / w)^2 / (2 E h) = G at an angle theta of 90 degrees (Kendall 1975, J. Phys. D 8,
    1449-1452, eq. 2). The slope of its end face is not defined.
    """
    a0, Gw, EA = problem.precrack, problem.resistance, problem.young * problem.width * problem.arm_thickness
    load = 2.0 * Gw / (1.0 + np.sqrt(1.0 + 2.0 * Gw / EA))  # not EA (sqrt(1 + 2 Gw / EA) - 1), which cancels
    first, then = _split(problem, a0 * (1.0 + load / EA), end)
    P = EA * np.maximum(first / a0 - 1.0, 0.0)
    loading = Branch(
        first,
        P,
        np.full_like(first, a0),
        np.where(first > a0, EA / a0, 0.0),
        0.5 * P**2 * a0 / EA,
        np.full_like(first, np.nan),
    )
    crack = then / (1.0 + load / EA)
    constant = np.full_like(then, load)
    growth = Branch(then, constant, crack, np.zeros_like(then), 0.5 * load**2 * crack / EA, np.full_like(then, np.nan))
    return loading, growth


def _rows(problem: LefmProblem, loading: Branch, growth: Branch) -> tuple[dict[str, float], ...]:
    both = Branch(*map(np.append, loading, growth))
    dissipated, none = problem.resistance * (both.crack - problem.precrack), np.zeros_like(both.crack)
    columns = {
        "opening": both.opening,
        "load": both.load,
        "crack_length": both.crack,
        "stored_energy": both.stored,
        "dissipated_energy": dissipated,
        "external_work": both.stored + dissipated,
        "newton_iterations": none,
        "load_slope": both.load_slope,
    }
    if problem.named_theory == "factors":
        columns["external_work"] = _work(problem, loading, growth)
    elif problem.named_theory != "kendall":
        other = -both.face_slope if problem.arms == 2 else none
        columns |= {"face_slope_top": both.face_slope, "face_slope_bottom": other, "face_energy": none}
    return rows_of(columns)
