"""Quantities that are compared with the data: peak load, initial stiffness, loads of the propagation branch.

Each is one function of a curve, applied to simulation and data alike. Its window is fixed by the curve of the scene and
the data, and does not move with the inputs or the mesh. The window of the stiffness is one of loads, as slack moves all
openings.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from typing import TypeAlias

import numpy as np

from verify.curves.curve import PROPAGATION, SAMPLES, Curve, envelope, from_origin, load_at, peak
from verify.reduction.corrections import line, linear_rows
from verify.reduction.data import Measured
from verify.reduction.scheme import Settings
from verify.support.refusal import Refusal


@dataclass(frozen=True)
class Windows:
    """Which part of a curve counts.

    stiff : loads, over the smaller of both largest loads, between which the stiffness is the slope of a straight line:
        above the slack of a test, below its first damage
    whole : part of the last opening of the shorter curve up to which loads count, so that runs with other inputs and
        openings reach it, too
    least : shortest propagation branch, over its first opening
    narrow : least width of the window of the stiffness, over the opening at the peak of each curve
    inside : least distance of a peak from the last opening, over the last opening
    missed : largest part of the peak load of the data that may lie above it, between its rows
    close : distance of rows beside the peak, over the opening there, below which noise decides between them
    toe : part of the opening at the largest load up to which a toe is not worth a word
    units : factor of a stiffness or of a peak load beyond which the data are in other units: these differ by 1000 or
        25.4. A factor of 4.45, of pounds and newtons, is below it and appears in the statement
    """

    stiff: tuple[float, float] = (0.1, 0.4)
    whole: float = 0.98
    least: float = 0.05
    narrow: float = 1e-3
    inside: float = 1e-3
    missed: float = 0.05
    close: float = 0.02
    toe: float = 0.02
    units: float = 10.0


WINDOWS = Windows()

#: Opening and load (n,) of an envelope.
Pair: TypeAlias = tuple[np.ndarray, np.ndarray]


@dataclass(frozen=True)
class Quantity:
    """A number of a load-opening curve; ``of`` computes it from opening (n,) and load (n,), NaN if it is undefined."""

    name: str
    where: str
    of: Callable[[Curve], float]


def quantities(simulated: Curve, data: Curve, at: Sequence[float] = ()) -> tuple[tuple[Quantity, ...], list[str]]:
    """The quantities that both curves have, and a sentence for each that one of them lacks.

    Parameters
    ----------
    simulated, data : opening (n,) and load (n,)
    at : openings at which the load is a quantity, too
    """
    S, D = (envelope(*from_origin(*curve)) for curve in (simulated, data))
    last = WINDOWS.whole * min(float(S[0][-1]), float(D[0][-1]))
    named: dict[str, Quantity | str] = {
        "peak load": _of_peak(S, D),
        "initial stiffness": _of_stiffness(S, D),
        "propagation load": _of_propagation(S, D, last),
    }
    for opening in at:
        short = f"must be > 0 and <= {last:.4g}, short of where a curve ends"
        named[f"load at {opening:g}"] = mean_load(np.array([opening])) if 0.0 < opening <= last else short
    for name, one in named.items():  # errors are relative to the values
        if isinstance(one, Quantity) and not (one.of(S) > 0.0 and one.of(D) > 0.0):
            named[name] = f"must be > 0, got {one.of(S):.4g} of the simulation and {one.of(D):.4g} of the data"
    found = tuple(one for one in named.values() if isinstance(one, Quantity))
    return found, [f"{name}: left out: {one}" for name, one in named.items() if isinstance(one, str)]


def slack(data: Curve) -> list[str]:
    """A sentence on the toe of the data, as `debond reduce` finds it, where it is more than `Windows.toe`."""
    d, P = (np.asarray(column, dtype=float) for column in data)
    measured = Measured("data", d, P, np.full(d.size, np.nan))
    try:
        toe = line(measured, linear_rows(P, Settings().window, "data")).toe
    except Refusal:
        return []
    part = toe / d[int(np.argmax(P))]
    taken = (
        f"toe of the data: {toe:.4g}, {part:.1%} of the opening at its largest load, by the straight part of its rise"
    )
    return [f"{taken}; debond reduce takes it off, and here it counts in every load"] * bool(abs(part) > WINDOWS.toe)


def mean_load(grid: np.ndarray, name: str = "", where: str = "") -> Quantity:
    """Mean of the loads of the envelope at openings (n,), 0 after its end, where the specimen is separated."""
    name = name or f"load at {grid[0]:g}"
    return Quantity(name, where, lambda curve: float(np.mean(np.nan_to_num(load_at(from_origin(*curve), grid)))))


def other_units(simulated: Curve, data: Curve) -> str:
    """A sentence where stiffness or peak load differ by more than `Windows.units`; empty where they do not.

    Openings of another unit change the stiffness, loads of another unit the peak load as well. The opening at the peak
    does not count: on a branch of constant load, as of a peel test, the peak is anywhere. A rise of two points tells no
    stiffness: it is that of the whole curve.
    """
    told, extents = [], []
    for name, curve in {"the data": data, "the simulation": simulated}.items():
        d, P = envelope(*from_origin(*curve))
        opening, top = peak((d, P))
        rises = np.any(P[1 : int(np.argmax(P))] > 0.0)
        stiffness = slope((WINDOWS.stiff[0] * top, WINDOWS.stiff[1] * top), (d, P)) if rises else np.nan
        told.append((stiffness, top if _has_peak((d, P)) and top > 0.0 else np.nan))
        extents.append(f"{name} open to {d[-1]:.4g}, with the largest load, {top:.4g}, at the opening {opening:.4g}")
    off = np.abs(np.log(np.divide(told[0], told[1])))
    return f"no statement: {', and '.join(extents)}: units?" if np.any(off > np.log(WINDOWS.units)) else ""


def slope(between: tuple[float, float], curve: Curve) -> float:
    """Slope by least squares over equally spaced openings, with an intercept, between the openings at which the curve
    first bears two loads; NaN where the load jumps from one to the other."""
    own = envelope(*from_origin(*curve))
    begin, end = (_reached(own, load) for load in between)
    if not end > begin:
        return float("nan")
    grid = np.linspace(begin, end, SAMPLES)
    load, x = load_at(own, grid), grid - grid.mean()
    return float(x @ load / (x @ x))


def _of_peak(S: Pair, D: Pair) -> Quantity | str:
    growing = [name for name, curve in (("the simulation", S), ("the data", D)) if not _has_peak(curve)]
    if growing:
        return f"the load of {' and of '.join(growing)} still grows at the end"
    most = max([peak(D)[1], *_between_rows(D)])
    if most > (1.0 + WINDOWS.missed) * max(peak(D)[1], 0.0):
        return f"that of the data may go up to {most:.4g} between its rows: too few rows"
    where = f"that of the simulation at the opening {peak(S)[0]:.4g}"
    return Quantity("peak load", where, lambda curve: float(np.max(envelope(*curve)[1])))


def _between_rows(curve: Pair) -> Iterator[float]:
    """Upper bounds of the load of a concave curve in the intervals beside its highest row: the lines through the two
    rows before and the two rows behind an interval; infinite where there are none."""
    d, P = curve
    highest = int(np.argmax(P))
    for i in range(max(highest - 1, 0), min(highest + 1, d.size - 1)):
        if d[i + 1] - d[i] > WINDOWS.close * d[highest]:
            at, pairs = np.linspace(d[i], d[i + 1], SAMPLES), [slice(j, j + 2) for j in (i - 1, i + 1) if j >= 0]
            lines = [np.polyfit(d[pair], P[pair], 1) for pair in pairs if np.ptp(d[pair]) > 0.0]
            yield float(np.max(np.min([np.polyval(line, at) for line in lines] or [np.full(1, np.inf)], axis=0)))


def _of_stiffness(S: Pair, D: Pair) -> Quantity | str:
    low, high = (part * min(peak(S)[1], peak(D)[1]) for part in WINDOWS.stiff)
    for name, curve in {"the data": D, "the simulation": S}.items():
        begin, end = _reached(curve, low), _reached(curve, high)
        if not end - begin > WINDOWS.narrow * peak(curve)[0]:
            ends = f"the openings {begin:.4g} and {end:.4g}"
            return f"the load of {name} rises to {high:.4g} between {ends}"
    first, last = int(np.argmax(D[1] >= low)), int(np.argmax(D[1] >= high))
    gap = float(np.max(np.diff(D[1][max(first - 1, 0) : last + 1]), initial=0.0))
    if gap > high - low:
        return f"the data have steps of {gap:.4g} between the loads {low:.4g} and {high:.4g}: too few rows"
    where = f"slope of a straight line between the loads {low:.4g} and {high:.4g}"
    return Quantity("initial stiffness", where, partial(slope, (low, high)))


def _of_propagation(S: Pair, D: Pair, last: float) -> Quantity | str:
    begin = PROPAGATION * max(peak(S)[0], peak(D)[0])
    if not (_has_peak(S) and _has_peak(D)) or last < (1 + WINDOWS.least) * begin:
        return f"the curves go to {last:.4g}, and it would begin at {begin:.4g}"
    grid = np.linspace(begin, last, SAMPLES)
    return mean_load(grid, "propagation load", f"mean over openings {begin:.4g} to {last:.4g}")


def _has_peak(curve: Pair) -> bool:
    """Whether the load has fallen before the curve ends."""
    return peak(curve)[0] < (1 - WINDOWS.inside) * curve[0][-1]


def _reached(curve: Pair, load: float) -> float:
    """Opening at which the load is first reached, along straight lines; NaN where it is not."""
    d, P = curve
    i = int(np.argmax(P >= load))
    rows = slice(max(i - 1, 0), i + 1)
    return float(np.interp(load, P[rows], d[rows])) if P[i] >= load else float("nan")
