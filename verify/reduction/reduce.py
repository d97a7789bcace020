"""Data reduction of one test: corrections, initiation, every scheme, and the interval of every value."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np
from scipy.special import stdtrit

from verify.reduction.corrections import LinearPart, Smoothed, corrected, line, linear_rows, smooth
from verify.reduction.coupon import Coupon
from verify.reduction.data import Measured
from verify.reduction.equivalent_crack import cbbm
from verify.reduction.initiation import NL, growing, initiation
from verify.reduction.names import SCHEMES
from verify.reduction.scheme import CannotReduce, Fitted, Setting, Settings
from verify.reduction.unloading import unloading
from verify.support.refusal import Refusal


@dataclass(frozen=True)
class Jackknife:
    """Groups of rows that are left out one after the other for the intervals.

    Each group takes short runs of neighbouring rows from all over the curve, ``cycles`` of them, so that it keeps what
    neighbours have in common and every group is like every other one. More groups cost time; fewer widen intervals.
    """

    groups: int = 20
    cycles: int = 10


JACKKNIFE = Jackknife()
#: Probability with which intervals are to contain the value.
LEVEL = 0.95
#: Standard deviations of its half width.
NORMAL = 1.96


@dataclass(frozen=True)
class Value:
    """A value and the half width of its 95 % interval, NaN of a run, which has no noise."""

    value: float
    half: float = float("nan")


@dataclass(frozen=True)
class Reduced:
    """What one scheme says; ``missing`` says why where it says nothing.

    Parameters
    ----------
    constants : numbers of the scheme: Delta, n, A1, A, m, E, E_f
    initiation : point -> G
    propagation : mean of G while the crack grows; ``scatter`` its standard deviation over ``count`` rows
    growth, G, sliding : (k,) the R-curve, with G_II / G, NaN where the parts are not known
    mixture : mean of G_II / G over the rows of the propagation value
    """

    name: str
    what: str = ""
    missing: str = ""
    constants: Mapping[str, Value] = field(default_factory=dict)
    initiation: Mapping[str, Value] = field(default_factory=dict)
    propagation: Value = Value(float("nan"))
    scatter: float = float("nan")
    count: int = 0
    mixture: float = float("nan")
    growth: np.ndarray = field(default_factory=lambda: np.zeros(0))
    G: np.ndarray = field(default_factory=lambda: np.zeros(0))
    sliding: np.ndarray = field(default_factory=lambda: np.zeros(0))


@dataclass(frozen=True)
class Reduction:
    """A test, reduced: its corrected rows, its linear part, the initiation points (index), and every scheme.

    Rows (n,) on which the crack has ``grown``, and on which the specimen ``unloads``.
    """

    coupon: Coupon
    settings: Settings
    rows: Measured
    smoothed: Measured
    part: LinearPart
    toe: float  # by which the origin was found to be off
    points: Mapping[str, int]
    grown: np.ndarray
    unloads: np.ndarray
    schemes: tuple[Reduced, ...]


@np.errstate(all="ignore")  # what a file brings about comes out as NaN, and is left out
def reduce(measured: Measured, coupon: Coupon, settings: Settings | None = None) -> Reduction:
    """Toughness of a test by every scheme of its kind.

    Raises
    ------
    Refusal : no linear part, a machine as compliant as the specimen, or a curve that ends while it is linear.
    """
    settings = settings or Settings()
    smoothed = smooth(measured)
    window = linear_rows(smoothed.rows.load, settings.window, measured.source)
    first = line(measured, window)
    rows, part = corrected(measured, first, settings.toe, settings.machine)
    steady, _ = corrected(smoothed.rows, first, settings.toe, settings.machine)
    points = initiation(steady, part, smoothed.uncertainty, coupon.precrack)
    try:
        unloads = unloading(steady)
        setting = Setting(coupon, settings, part, steady)
        grown = growing(setting, cbbm(setting).crack(steady), points, unloads)
    except CannotReduce as error:
        raise Refusal(f"{measured.source}: the linear part says that {error}; moduli, lengths, units?") from None
    end = steady.load.size - 1
    if points[NL] == end:
        raise Refusal(f"{measured.source}: must go on until the crack grows, got a curve that is linear to its end")
    test = _Test(measured, coupon, settings, window, smoothed, points, grown)
    whole = test.estimates(np.ones(end + 1, dtype=bool))
    left_out = [] if measured.virtual else _left_out(measured, window, grown)
    parts = [test.estimates(kept) for kept in left_out]
    loading = np.arange(end + 1) > window[-1]
    shown = rows.at(loading & ~unloads)
    schemes = tuple(_reduced(test, shown, name, whole, parts) for name in SCHEMES[coupon.kind])
    return Reduction(coupon, settings, rows, steady, part, first.toe, points, grown, unloads, schemes)


@dataclass(frozen=True)
class _Estimate:
    """What a scheme says of a part of the rows, in numbers."""

    fitted: Fitted
    numbers: Mapping[str, float]  # constants, and G at the points
    propagation: float
    scatter: float
    count: int
    mixture: float


@dataclass(frozen=True)
class _Test:
    """A test with the choice of its rows, which is made once for all estimates."""

    measured: Measured
    coupon: Coupon
    settings: Settings
    window: np.ndarray
    smoothed: Smoothed
    points: Mapping[str, int]
    grown: np.ndarray

    def estimates(self, kept: np.ndarray) -> dict[str, _Estimate | str]:
        """Every scheme from the rows ``kept`` (n,) alone, or why it says nothing."""
        first = line(self.measured, self.window[kept[self.window]])
        rows, part = corrected(self.measured, first, self.settings.toe, self.settings.machine)
        setting = Setting(self.coupon, self.settings, part, rows.at(self.grown & kept))
        at = np.array(list(self.points.values()))
        points, _ = corrected(self.smoothed.rows.at(at), first, self.settings.toe, self.settings.machine)
        points = replace(points, crack=np.fmax(points.crack, self.coupon.precrack))
        found: dict[str, _Estimate | str] = {}
        for name, scheme in SCHEMES[self.coupon.kind].items():
            try:
                found[name] = _estimate(scheme(setting), setting.grown, points, tuple(self.points))
            except CannotReduce as error:
                found[name] = str(error)
        return found


def _estimate(fitted: Fitted, grown: Measured, points: Measured, names: tuple[str, ...]) -> _Estimate:
    numbers = {**fitted.constants, **dict(zip(names, map(float, fitted.release(points)[0]), strict=True))}
    G, slid = fitted.release(grown)
    known = np.isfinite(G)
    G, slid = G[known], slid[known]
    mean = float(G.mean()) if G.size else float("nan")
    mixture = float(np.mean(slid / G)) if G.size else float("nan")
    scatter = float(G.std(ddof=1)) if G.size > 1 else float("nan")
    return _Estimate(fitted, numbers, mean, scatter, G.size, mixture)


def _left_out(measured: Measured, window: np.ndarray, grown: np.ndarray) -> list[np.ndarray]:
    """Rows (n,) kept when each group is left out.

    Rows with a crack length, of the linear part, and of the rest are dealt out for themselves, so that each group has
    its share of all.
    """
    group = np.full(measured.load.size, -1)
    in_window = np.zeros(group.size, dtype=bool)
    in_window[window] = True
    read = np.isfinite(measured.crack) & grown
    for rows in (in_window, read, grown & ~read & ~in_window):
        at = np.flatnonzero(rows)
        run = max(1, at.size // (JACKKNIFE.groups * JACKKNIFE.cycles))
        group[at] = np.arange(at.size) // run % JACKKNIFE.groups
    return [group != one for one in range(JACKKNIFE.groups) if (group == one).any()]


def _reduced(
    test: _Test,
    shown: Measured,
    name: str,
    whole: Mapping[str, _Estimate | str],
    parts: list[dict[str, _Estimate | str]],
) -> Reduced:
    found = whole[name]
    if isinstance(found, str):
        return Reduced(name, missing=found)
    others = [other for one in parts if not isinstance(other := one[name], str)]

    def value(key: str) -> Value:
        return _interval(found.numbers[key], [one.numbers[key] for one in others])

    shown = shown.at(np.isfinite(shown.compliance) & (shown.load > 0.0))
    G, slid = found.fitted.release(shown)
    growth = found.fitted.crack(shown) - test.coupon.precrack
    drawn = np.isfinite(G) & np.isfinite(growth)
    with np.errstate(invalid="ignore", divide="ignore"):
        sliding = (slid / G)[drawn]
    return Reduced(
        name,
        found.fitted.what,
        constants={key: value(key) for key in found.fitted.constants},
        initiation={key: _with_noise(value(key), test, i) for key, i in test.points.items()},
        propagation=_interval(found.propagation, [one.propagation for one in others], found.count),
        scatter=found.scatter,
        count=found.count,
        mixture=found.mixture,
        growth=growth[drawn],
        G=G[drawn],
        sliding=sliding,
    )


def _with_noise(found: Value, test: _Test, i: int) -> Value:
    """The interval of a single point, with the noise that is left in its load: G goes with its square."""
    own = 2.0 * NORMAL * test.smoothed.uncertainty / max(float(test.smoothed.rows.load[i]), 1e-300) * found.value
    return Value(found.value, float(np.hypot(found.half, own)))


def _interval(value: float, others: list[float], count: int | None = None) -> Value:
    """The value with t times the standard error of the grouped jackknife: se^2 = (g - 1)/g sum (v_i - mean v)^2.

    Quenouille and Tukey; Efron and Stein (1981), Ann. Statist. 9, 586-596. Degrees of freedom: groups less one, of at
    most ``count`` rows.
    """
    found = np.array(others)
    found = found[np.isfinite(found)]
    free = min(found.size, count or found.size) - 1
    if free < 1:
        return Value(value)
    spread = (found.size - 1) / found.size * float(np.sum((found - found.mean()) ** 2))
    return Value(value, float(stdtrit(free, 0.5 + LEVEL / 2.0)) * spread**0.5)
