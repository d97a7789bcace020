"""Quantities that are compared with the data: peak load, initial stiffness, loads of the propagation branch.

Each is one function of a curve, applied to simulation and data alike. Its window is fixed by the curve of the scene and
the data, and does not move with the inputs or the mesh. The window of the stiffness is one of loads, as slack moves all
openings.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import TypeAlias

import numpy as np

from verify.curves.curve import PROPAGATION, SAMPLES, Curve, envelope, from_origin, load_at, peak


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
    """

    stiff: tuple[float, float] = (0.1, 0.4)
    whole: float = 0.98
    least: float = 0.05
    narrow: float = 1e-3
    inside: float = 1e-3
    missed: float = 0.05
    close: float = 0.02


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
    found = (_of_peak(S, D), _of_stiffness(S, D), _of_propagation(S, D, last), *(_of_load(x, last) for x in at))
    checked = [_positive(one, S, D) if isinstance(one, Quantity) else one for one in found]
    return tuple(one for one in checked if isinstance(one, Quantity)), [one for one in checked if isinstance(one, str)]


def _positive(one: Quantity, S: Pair, D: Pair) -> Quantity | str:
    """The quantity, or a sentence where it is not positive, as errors are relative to it."""
    simulated, measured = one.of(S), one.of(D)
    if simulated > 0.0 and measured > 0.0:
        return one
    return f"{one.name}: left out: must be > 0, got {simulated:.4g} of the simulation and {measured:.4g} of the data"


def _of_peak(S: Pair, D: Pair) -> Quantity | str:
    names = {"the simulation": S, "the data": D}
    growing = [name for name, curve in names.items() if not has_peak(curve)]
    if growing:
        return f"peak load: left out: the load of {' and of '.join(growing)} still grows at the end"
    most, top = _above_rows(D), peak(D)[1]
    if most > (1.0 + WINDOWS.missed) * max(top, 0.0):
        return f"peak load: left out: that of the data may go up to {most:.4g} between its rows: too few rows"
    return Quantity("peak load", f"that of the simulation at the opening {peak(S)[0]:.4g}", _peak)


def _of_stiffness(S: Pair, D: Pair) -> Quantity | str:
    top = min(peak(S)[1], peak(D)[1])
    low, high = WINDOWS.stiff[0] * top, WINDOWS.stiff[1] * top
    for name, curve in {"the data": D, "the simulation": S}.items():
        begin, end = _reached(curve, low), _reached(curve, high)
        if not end - begin > WINDOWS.narrow * peak(curve)[0]:
            ends = f"the openings {begin:.4g} and {end:.4g}"
            return f"initial stiffness: left out: the load of {name} rises to {high:.4g} between {ends}"
    if (gap := _largest_step(D, low, high)) > high - low:
        ends = f"{low:.4g} and {high:.4g}"
        return f"initial stiffness: left out: the data have steps of {gap:.4g} between the loads {ends}: too few rows"
    where = f"slope of a straight line between the loads {low:.4g} and {high:.4g}"
    return Quantity("initial stiffness", where, partial(slope, (low, high)))


def _largest_step(curve: Pair, low: float, high: float) -> float:
    """Largest rise of the load from row to row between two loads, from the row before them to the one behind."""
    first, last = int(np.argmax(curve[1] >= low)), int(np.argmax(curve[1] >= high))
    return float(np.max(np.diff(curve[1][max(first - 1, 0) : last + 1]), initial=0.0))


def _of_propagation(S: Pair, D: Pair, last: float) -> Quantity | str:
    begin = PROPAGATION * max(peak(S)[0], peak(D)[0])
    if not (has_peak(S) and has_peak(D)) or last < (1 + WINDOWS.least) * begin:
        return f"propagation load: left out: the curves go to {last:.4g}, and it would begin at {begin:.4g}"
    where = f"mean over openings {begin:.4g} to {last:.4g}"
    return Quantity("propagation load", where, partial(_mean, np.linspace(begin, last, SAMPLES)))


def _above_rows(curve: Pair) -> float:
    """Upper bound of the load of a concave curve beside its highest row: the lines through the two rows before and the
    two rows behind an interval."""
    d, P = curve
    highest, found = int(np.argmax(P)), float(np.max(P))
    for i in range(max(highest - 1, 0), min(highest + 1, d.size - 1)):
        at = np.linspace(d[i], d[i + 1], SAMPLES)
        before, behind = _line(curve, i - 1, at), _line(curve, i + 1, at)
        if d[i + 1] - d[i] > WINDOWS.close * d[highest]:
            found = max(found, float(np.max(np.minimum(before, behind))))
    return found


def _line(curve: Pair, i: int, at: np.ndarray) -> np.ndarray:
    """Load at openings (n,) on the line through the rows ``i`` and ``i + 1``; infinite where there is no such line."""
    d, P = curve
    if i < 0 or i + 1 >= d.size or not d[i + 1] > d[i]:
        return np.full(at.shape, np.inf)
    return P[i] + (P[i + 1] - P[i]) / (d[i + 1] - d[i]) * (at - d[i])


def _of_load(opening: float, last: float) -> Quantity | str:
    if 0.0 < opening <= last:
        return Quantity(f"load at {opening:g}", "", partial(_mean, np.array([opening])))
    return f"load at {opening:g}: left out: must be > 0 and <= {last:.4g}, short of where a curve ends"


def has_peak(curve: Pair) -> bool:
    """Whether the load has fallen before the curve ends."""
    return peak(curve)[0] < (1 - WINDOWS.inside) * curve[0][-1]


def _peak(curve: Curve) -> float:
    return float(np.max(envelope(*curve)[1]))


def _reached(curve: Pair, load: float) -> float:
    """Opening at which the load is first reached, along straight lines; NaN where it is not."""
    d, P = curve
    i = int(np.argmax(P >= load))
    if i == 0:
        return float(d[0]) if P[0] >= load else float("nan")
    return float(d[i - 1] + (load - P[i - 1]) / (P[i] - P[i - 1]) * (d[i] - d[i - 1]))


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


def _mean(grid: np.ndarray, curve: Curve) -> float:
    return float(np.mean(loads(curve, grid)))


def loads(curve: Curve, grid: np.ndarray) -> np.ndarray:
    """Loads of the envelope, 0 after its end, where the specimen is separated."""
    d, P = from_origin(*curve)
    return np.where(grid > np.max(d), 0.0, load_at((d, P), np.minimum(grid, np.max(d))))
