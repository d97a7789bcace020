"""Data reduction of one test: corrections, initiation, every scheme, and the interval of every value."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from math import nan

import numpy as np
from scipy.special import stdtrit

from verify.reduction.corrections import LinearPart, corrected, line, linear_rows, smooth
from verify.reduction.coupon import Coupon
from verify.reduction.data import Measured
from verify.reduction.initiation import NL, ONSET, growing, initiation, unloading
from verify.reduction.r_curve import RCurve, r_curve, rise, rises
from verify.reduction.scheme import FEWEST, CannotReduce, Fitted, Setting, Settings
from verify.reduction.schemes import SCHEMES, cbbm
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
#: Rounding of a file, and the error of a run, in parts of G.
ROUNDED_G, SOLVED_G = 1e-5, 5e-3


@dataclass(frozen=True)
class Value:
    """A value and the half width of its 95 % interval, NaN of a run, which has no noise."""

    value: float
    half_width: float = nan


@dataclass(frozen=True)
class Reduced:
    """What one scheme says; ``missing`` says why where it says nothing.

    Parameters
    ----------
    constants : numbers of the scheme: Delta, n, A1, A, m, E, E_f
    initiation : point -> G
    propagation : mean of G while the crack grows; ``scatter`` its standard deviation over ``count`` rows
    growth, G, sliding : (k,) the R-curve, with G_II / G, NaN where the parts are not known
    grown : (k,) which of its points count as propagation
    mixture : mean of G_II / G over the rows of the propagation value
    """

    name: str
    what: str = ""
    missing: str = ""
    constants: Mapping[str, Value] = field(default_factory=dict)
    initiation: Mapping[str, Value] = field(default_factory=dict)
    propagation: Value = Value(nan)
    scatter: float = nan
    count: int = 0
    mixture: float = nan
    growth: np.ndarray = field(default_factory=lambda: np.zeros(0))
    G: np.ndarray = field(default_factory=lambda: np.zeros(0))
    sliding: np.ndarray = field(default_factory=lambda: np.zeros(0))
    grown: np.ndarray = field(default_factory=lambda: np.zeros(0, dtype=bool))

    def at(self, point: str) -> Value:
        """G at an initiation point, or while the crack grows: "propagation"."""
        return self.propagation if point == "propagation" else self.initiation.get(point, Value(nan))


@dataclass(frozen=True)
class Reduction:
    """A test, reduced: its corrected rows, its linear part, the initiation points (index), and every scheme.

    Rows (n,) on which the crack has ``grown``, and on which the specimen ``unloads``; ``equivalent`` are the crack
    lengths (n,) by the compliance.
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
    equivalent: np.ndarray
    schemes: tuple[Reduced, ...]

    @property
    def by_name(self) -> dict[str, Reduced]:
        return {one.name: one for one in self.schemes}

    @property
    def leading(self) -> Reduced | None:
        """The first scheme with a value while the crack grows, whose R-curve is told."""
        return next((one for one in self.schemes if one.grown.any()), None)

    @property
    def r_curve(self) -> RCurve | None:
        """The R-curve of the leading scheme where G rises by all schemes, beyond noise and intervals; else None."""
        found = [(one, rise(one.growth[one.grown], one.G[one.grown])) for one in self.schemes if one.grown.any()]
        least = SOLVED_G if self.rows.virtual else ROUNDED_G
        within = [R for one, (R, _) in found if R <= np.fmax(one.propagation.half_width, least * one.propagation.value)]
        if within or not found or not rises([one for _, one in found]):
            return None
        return r_curve(found[0][0].growth[found[0][0].grown], found[0][0].G[found[0][0].grown])


@dataclass(frozen=True)
class _Estimate:
    """What a scheme says of a part of the rows: its constants, G at the points and the mean of G; G and G_II (k,)."""

    fitted: Fitted
    numbers: Mapping[str, float]
    G: np.ndarray
    slid: np.ndarray


@np.errstate(all="ignore")  # what a file brings about comes out as NaN, and is left out
def reduce(measured: Measured, coupon: Coupon, settings: Settings | None = None) -> Reduction:
    """Toughness of a test by every scheme of its kind.

    Raises
    ------
    Refusal : no linear part, a machine as compliant as the specimen, or a curve that ends while it is linear.
    """
    settings = settings or Settings()
    correction = settings.toe, settings.machine
    if coupon.kind == "peel":
        return _of_readings(measured, coupon, settings)
    smoothed = smooth(measured)
    try:
        window = linear_rows(smoothed.rows.load, settings.window, measured.source)
    except Refusal:
        if not readings_alone(measured):
            raise
        return _of_readings(measured, coupon, settings)
    first = line(measured, window)
    rows, part = corrected(measured, first, *correction)
    steady, _ = corrected(smoothed.rows, first, *correction)
    points = initiation(steady, part, smoothed.uncertainty, coupon.precrack)
    try:
        unloads, setting = unloading(steady), Setting(coupon, settings, part, steady)
        equivalent = cbbm(setting).crack(steady)
        grown = growing(setting, equivalent, points, unloads)
    except CannotReduce as error:
        raise Refusal(f"{measured.source}: the linear part says that {error}; moduli, lengths, units?") from None
    if points[NL] == steady.load.size - 1:
        raise Refusal(f"{measured.source}: must go on until the crack grows, got a curve that is linear to its end")

    def estimates(kept: np.ndarray) -> dict[str, _Estimate | str]:
        """Every scheme from the rows ``kept`` (n,) alone, or why it says nothing; the choice of rows is made once."""
        first = line(measured, window[kept[window]])
        of_rows, part = corrected(measured, first, *correction)
        at, _ = corrected(smoothed.rows.at(np.array(list(points.values()))), first, *correction)
        at = replace(at, crack=np.fmax(at.crack, coupon.precrack))
        return _estimates(Setting(coupon, settings, part, of_rows.at(grown & kept)), at, tuple(points))

    drawn = (np.arange(steady.load.size) > window[-1]) & ~unloads & np.isfinite(rows.compliance) & (rows.load > 0.0)
    shown = rows.at(drawn)
    # the noise that is left in the load of a single point: G goes with its square
    load = {name: max(float(smoothed.rows.load[i]), 1e-300) for name, i in points.items()}
    noise = {name: 2.0 * NORMAL * smoothed.uncertainty / value for name, value in load.items()}
    found = map(estimates, _kept(measured, window, grown))
    schemes = tuple(_reduced(found, noise, shown, grown[drawn], coupon.precrack))
    return Reduction(coupon, settings, rows, steady, part, first.toe, points, grown, unloads, equivalent, schemes)


def readings_alone(measured: Measured) -> bool:
    """Whether every row is a reading of the crack while it grows, as in the data sheets of the standards."""
    return not measured.virtual and bool(np.isfinite(measured.crack).all()) and np.unique(measured.crack).size >= FEWEST


def _of_readings(measured: Measured, coupon: Coupon, settings: Settings) -> Reduction:
    """The reduction of `readings_alone`, and of peel tests: without a linear part there is no toe, no initiation and no
    scheme of both."""
    rows = replace(measured, opening=measured.opening - settings.machine * measured.load)
    part, none = LinearPart(nan, 0.0, 0.0, np.zeros(0, int)), np.zeros(rows.load.size, dtype=bool)
    begin = -np.inf
    if coupon.kind == "peel":  # its first growth does not count, as of other specimens
        if not rows.has_cracks:  # it grows by the opening over 1 - cos(theta), from the first median load on
            first = int(np.argmax(rows.load >= np.median(rows.load)))
            grown = np.maximum(rows.opening - rows.opening[first], 0.0) / (1.0 - np.cos(coupon.angle))
            rows = replace(rows, crack=coupon.precrack + grown)
        begin = ONSET.settled * float(np.nanmax(rows.crack) - coupon.precrack)
    growth = rows.crack - coupon.precrack
    begin = begin if settings.begin is None else settings.begin
    grown = (rows.load > 0.0) & (growth >= begin) & (growth <= (settings.end or np.inf))
    if rows.front is not None:
        grown &= rows.front < ONSET.reach * coupon.length

    def estimates(kept: np.ndarray) -> dict[str, _Estimate | str]:
        return _estimates(Setting(coupon, settings, part, rows.at(grown & kept)), rows.at(none), ())

    schemes = tuple(_reduced(map(estimates, _kept(rows, part.rows, grown)), {}, rows, grown, coupon.precrack))
    return Reduction(coupon, settings, rows, rows, part, 0.0, {}, grown, none, np.full(none.size, nan), schemes)


def _estimates(setting: Setting, points: Measured, names: tuple[str, ...]) -> dict[str, _Estimate | str]:
    found: dict[str, _Estimate | str] = {}
    for name, scheme in SCHEMES[setting.coupon.kind].items():
        try:
            fitted = scheme(setting)
        except CannotReduce as error:
            found[name] = str(error)
            continue
        G, slid = fitted.release(setting.grown)
        known = np.isfinite(G)
        G, slid = G[known], slid[known]
        at = dict(zip(names, map(float, fitted.release(points)[0]), strict=True)) if names else {}
        mean = float(G.mean()) if G.size else nan
        found[name] = _Estimate(fitted, {**fitted.constants, **at, "propagation": mean}, G, slid)
    return found


def _kept(measured: Measured, window: np.ndarray, grown: np.ndarray) -> list[np.ndarray]:
    """All rows (n,), and those kept when each group is left out, none of which a run has.

    Rows with a crack length, of the linear part, and of the rest are dealt out for themselves, so that each group has
    its share of all.
    """
    group = np.full(measured.load.size, -1)
    in_window = np.isin(np.arange(group.size), window)
    read = np.isfinite(measured.crack) & grown
    for rows in (in_window, read, grown & ~read & ~in_window):
        at = np.flatnonzero(rows)
        run = max(1, at.size // (JACKKNIFE.groups * JACKKNIFE.cycles))
        group[at] = np.arange(at.size) // run % JACKKNIFE.groups
    groups = () if measured.virtual else range(JACKKNIFE.groups)
    return [np.ones(group.size, dtype=bool), *(group != one for one in groups if (group == one).any())]


def _reduced(
    estimates: Iterable[dict[str, _Estimate | str]],
    noise: Mapping[str, float],
    shown: Measured,
    grown: np.ndarray,
    precrack: float,
) -> Iterator[Reduced]:
    """Every scheme of all rows with its intervals, and its R-curve over the rows ``shown``, of which ``grown`` (n,)
    count."""
    whole, *parts = estimates
    for name, found in whole.items():
        if isinstance(found, str):
            yield Reduced(name, missing=found)
            continue
        count = found.G.size
        others = [one.numbers for part in parts if not isinstance(one := part[name], str)]
        values = {
            key: _interval(value, [one[key] for one in others], count if key == "propagation" else None)
            for key, value in found.numbers.items()
        }
        single = {
            key: Value(values[key].value, float(np.hypot(values[key].half_width, part * values[key].value)))
            for key, part in noise.items()
        }
        G, slid = found.fitted.release(shown)
        growth = found.fitted.crack(shown) - precrack
        drawn = np.isfinite(G) & np.isfinite(growth)
        yield Reduced(
            name,
            found.fitted.what,
            constants={key: values[key] for key in found.fitted.constants},
            initiation=single,
            propagation=values["propagation"],
            scatter=float(found.G.std(ddof=1)) if count > 1 else nan,
            count=count,
            mixture=float(np.mean(found.slid / found.G)) if count else nan,
            growth=growth[drawn],
            G=G[drawn],
            sliding=(slid / G)[drawn],
            grown=grown[drawn],
        )


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
