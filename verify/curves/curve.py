"""Load-opening curves: envelope, distance to a reference, oscillation, peak, and resampling.

A curve is a pair (opening (n,), load (n,)) in the order in which the path went.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

Curve = tuple[ArrayLike, ArrayLike]

#: Samples of a curve over its opening where two curves are compared.
SAMPLES = 400

#: The propagation branch begins at this multiple of the opening at the peak.
PROPAGATION = 1.3

#: The least opening and load that a distance is relative to, in parts of the largest ones: where a load passes through
#: zero, or nothing is open yet, only the size of the whole curve is left as a measure.
LEAST_OPENING, LEAST_LOAD = 0.02, 0.1

#: Difference of two loads, in parts of the load, that only a steep fall makes of a small difference of the openings.
OF_A_FALL = 0.1

#: Points that are looked at together.
CHUNK = 64

#: Opening and load, of a whole curve or (n,) of each point.
Size = tuple[float, float] | np.ndarray


def envelope(opening: ArrayLike, load: ArrayLike) -> tuple[np.ndarray, np.ndarray]:
    """The curve that a test under displacement control would show: points whose opening exceeds all before.

    At a snap-back, and where a programme unloads, the load jumps vertically to where the path comes back through the
    largest opening so far.

    Returns
    -------
    opening, load : (m,) openings that do not decrease, two equal ones where the load jumps
    """
    d, P = np.asarray(opening, dtype=float), np.asarray(load, dtype=float)
    top = np.maximum.accumulate(d)[:-1]
    new = np.flatnonzero(d[1:] > top) + 1
    start, before = d[new - 1], top[new - 1]
    kept = np.append(0, new[:-1])
    back = (start < before) | (P[new - 1] != P[kept])  # a jump at the very largest opening is one as well
    share = np.where(back, (before - start) / np.where(back, d[new] - start, 1.0), 0.0)
    landing = P[new - 1] + share * (P[new] - P[new - 1])
    keep = np.stack((back, np.ones_like(back)), axis=1).ravel()
    x = np.stack((before, d[new]), axis=1).ravel()[keep]
    y = np.stack((landing, P[new]), axis=1).ravel()[keep]
    return np.append(d[:1], x), np.append(P[:1], y)


def from_origin(opening: ArrayLike, load: ArrayLike, ahead: float = 1.0) -> tuple[np.ndarray, np.ndarray]:
    """The curve, joined to the origin by a straight line where it begins beyond 0.

    ``ahead`` has the sign of the first goal. The specimen bears nothing at the origin, and what is left out between
    shows as an error unless the curve is straight there.
    """
    d, P = np.asarray(opening, dtype=float), np.asarray(load, dtype=float)
    return (np.append(0.0, d), np.append(0.0, P)) if d[0] * ahead > 0.0 else (d, P)


def dense(
    opening: ArrayLike,
    load: ArrayLike,
    slope: ArrayLike,
    heading: ArrayLike,
    per_step: int = 10,
    size: np.ndarray | None = None,
    energy: ArrayLike | None = None,
) -> tuple[np.ndarray, np.ndarray]:
    """The path between converged points, through snap-backs as well: ``per_step`` points on every step.

    A geometric Hermite cubic in the plane of opening and load, each over its largest ``size``: unit tangents
    heading (1, slope), as long as the chord of the step. A chord falls short of its arc by the third power of the step,
    which shifts points along the curve and not off it: the curve is of fourth order all the same.

    A point where the path turns round, as at the end of a leg of the programme, has the tangent of its arrival. A step
    that sets out against its tangent has a kink there, and leaves it as the parabola does that ends with the other one.

    A step on which many integration points of the interface break has the slopes of a ripple at its ends, which say
    nothing of the curve between. The area under it is known: the change of the ``energy``. The cubic bulges as far as
    gives that area: at most as its slopes say, and not at all where the area lies on the other side.

    Parameters
    ----------
    opening, load, slope, heading : (n,) converged points, d load / d opening (infinite where the path turns), and +1
        or -1 where the opening grows or falls along the path.
    size : (2,) what opening and load are measured in, where that is not the largest of these points
    energy : (n,) stored and dissipated; left out, every step is a cubic

    Returns
    -------
    opening, load : ((n - 1) per_step + 1,)
    """
    points = np.stack([np.asarray(opening, dtype=float), np.asarray(load, dtype=float)], axis=1)
    if len(points) < 2:
        return points[:, 0], points[:, 1]
    size = np.max(np.abs(points), axis=0) if size is None else size
    size = np.where(size == 0.0, 1.0, size)
    start, chord = points[:-1] / size, np.diff(points / size, axis=0)
    angle = np.arctan(np.asarray(slope, dtype=float) * size[0] / size[1])
    unit = np.asarray(heading, dtype=float)[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    length = np.linalg.norm(chord, axis=1, keepdims=True)
    first, last = length * unit[:-1], length * unit[1:]
    against = np.sum(first * chord, axis=1, keepdims=True) < 0.0
    first = np.where(against, 2.0 * chord - last, first)
    t = np.linspace(0.0, 1.0, per_step + 1)[1:, None, None]
    bulge = t * t * (1.0 - t) * (chord - last) + t * (1.0 - t) ** 2 * (first - chord)  # beside the straight line
    if energy is not None:
        spent = np.diff(np.asarray(energy, dtype=float)) / np.prod(size)
        area = spent - (start[:, 1] + 0.5 * chord[:, 1]) * chord[:, 0]  # between path and straight line
        x, y = np.moveaxis(np.concatenate([np.zeros((1, *start.shape)), t * chord + bulge]), 2, 0)
        drawn = np.trapezoid(y, x, axis=0) - 0.5 * chord[:, 0] * chord[:, 1]
        bulge *= np.clip(np.divide(area, drawn, out=np.zeros_like(area), where=drawn != 0.0), 0.0, 1.0)[:, None]
    between = start + t * chord + bulge
    d, P = np.concatenate([points[:1], size * between.swapaxes(0, 1).reshape(-1, 2)]).T
    return d, P


def load_at(curve: Curve, opening: ArrayLike) -> np.ndarray:
    """Load of the envelope at openings; NaN outside it. At a jump the load before it."""
    d, P = envelope(*curve)
    at = np.asarray(opening, dtype=float)
    if len(d) < 2:
        return np.full(at.shape, np.nan)
    i = np.clip(np.searchsorted(d, at, side="left"), 1, len(d) - 1)
    width = d[i] - d[i - 1]
    load = P[i - 1] + (P[i] - P[i - 1]) * (at - d[i - 1]) / np.where(width > 0.0, width, 1.0)
    return np.where((at >= d[0]) & (at <= d[-1]), load, np.nan)


def curve_error(
    curve: Curve, reference: Curve, end: float | None = None, begin: float = 0.0, drops: bool = False
) -> float:
    """The distance of two curves: relative L2 of their envelopes over `SAMPLES` equal openings in (begin, end].

    ``end`` is at most the last opening of the reference. NaN where ``curve`` does not reach it.

    With ``drops`` the distance along the opening counts where the loads differ by more than `OF_A_FALL` behind a peak,
    if that is smaller: of a steep or vertical fall that comes a little earlier or later the difference of the loads is
    its height, and counts where a sample happens to be between. There a fall that is off by a part s of its opening
    counts with s times the load before it.
    """
    shown = envelope(*reference)
    last = float(shown[0][-1])
    end = last if end is None else min(end, last)
    grid = samples(begin, end)
    mine, other = load_at(curve, grid), load_at(reference, grid)
    off = np.abs(mine - other)
    if drops:
        falls = (grid >= min(float(d[np.argmax(P)]) for d, P in (envelope(*curve), shown))) & np.isfinite(off)
        near = point_distances((grid[falls], mine[falls]), shown, (end, float(np.nanmax(np.abs(other)))), OF_A_FALL)
        off[falls] = np.minimum(off[falls], near * np.maximum(np.abs(mine), np.abs(other))[falls])
    return float(np.sqrt(np.sum(off**2) / np.sum(other**2)))


def samples(begin: float, end: float) -> np.ndarray:
    """`SAMPLES` equal openings in (begin, end], of which none is beyond the end by rounding."""
    return np.minimum(begin + (end - begin) * (np.arange(1, SAMPLES + 1) / SAMPLES), end)


def point_distances(
    points: Curve,
    graph: Curve,
    size: Size,
    near: float = 0.0,
    enough: float = np.inf,
    least: float | np.ndarray = LEAST_LOAD,
) -> np.ndarray:
    """Distance (n,) of every point of a path from the graph of another one, in parts of its own opening and load.

    ``min over (x, y) of the graph of |d - x| / max(|d|, least) + |P - y| / max(|P|, least)``: a steep drop may lie that
    much earlier or later, a load be that much larger or smaller. The graph has the path, with its snap-backs, its
    envelope, with vertical drops, and the kinks that its chords may cut. Openings grow in the envelopes of both.

    Parameters
    ----------
    size : largest opening and load, of the whole curve or (n,) of each point
    near : a point whose load alone is no more than that off counts with this
    enough : once a point of a chunk of `CHUNK` points is farther, the remaining chunks count as 0
    least : the least load that a distance is relative to, in parts of the largest one
    """
    d, P = (np.asarray(values, dtype=float) for values in points)
    scale = np.stack((np.maximum(np.abs(d), LEAST_OPENING * size[0]), np.maximum(np.abs(P), least * size[1])))
    whole, shown = np.stack([np.asarray(values, dtype=float) for values in graph]), np.stack(envelope(*graph))
    x, y = shown
    found = np.where((d >= x[0]) & (d <= x[-1]), np.abs(P - np.interp(d, x, y)) / scale[1], np.inf)
    far = np.flatnonzero(found > near)
    far = far[np.argsort(-found[far], kind="stable")]
    start, tip, end = _kinks(whole)
    starts = np.hstack((whole[:, :-1], shown[:, :-1], start, tip))
    ends = np.hstack((whole[:, 1:], shown[:, 1:], tip, end))
    for first in range(0, len(far), CHUNK):
        n = far[first : first + CHUNK]
        found[n] = _to_segments(np.stack((d[n], P[n])), starts, ends, scale[:, n])
        if np.max(found[n]) > enough:
            found[far[first + CHUNK :]] = 0.0
            break
    return found


def _kinks(points: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Where the chords before and behind a chord would meet over it: its beginning, that point and its end (2, m).

    A step over a kink, as at the end of a reloading or where faces begin to touch, cuts it; the chords on both sides
    point at it.
    """
    before, here, after = points[:, 1:-2] - points[:, :-3], np.diff(points)[:, 1:-1], points[:, 3:] - points[:, 2:-1]
    area = before[0] * after[1] - before[1] * after[0]
    with np.errstate(all="ignore"):
        on = (here[0] * after[1] - here[1] * after[0]) / area
        back = (before[0] * here[1] - before[1] * here[0]) / area
        tip = points[:, 1:-2] + on * before
    meet = (area != 0.0) & (on > 0.0) & (back > 0.0) & (here[0] * before[0] > 0.0) & (here[0] * after[0] > 0.0)
    meet &= np.all(np.isfinite(tip), axis=0)
    return points[:, 1:-2][:, meet], tip[:, meet], points[:, 2:-1][:, meet]


def _to_segments(points: np.ndarray, starts: np.ndarray, ends: np.ndarray, scale: np.ndarray) -> np.ndarray:
    """Distance (n,): the sum of those in both coordinates, each in parts of its ``scale`` (2, n).

    On a segment that is least at an end, or where one of both is zero.
    """
    a, b = ((side[:, None, :] - points[:, :, None]) / scale[:, :, None] for side in (starts, ends))
    best = np.minimum(np.sum(np.abs(a), axis=0), np.sum(np.abs(b), axis=0))
    for i, j in ((0, 1), (1, 0)):
        crosses = a[i] * b[i] < 0.0
        t = a[i] / np.where(crosses, a[i] - b[i], 1.0)
        best = np.where(crosses, np.minimum(best, np.abs(a[j] + t * (b[j] - a[j]))), best)
    return np.min(best, axis=1)


def peak(curve: Curve, slope: ArrayLike | None = None, energy: ArrayLike | None = None) -> tuple[float, float]:
    """Opening and load at the largest load of the path; with the exact ``slope`` the peak of its Hermite cubics.

    A step whose ``energy`` is closer to the area under its straight line, as in `dense`, has its largest load at an
    end.
    """
    d, P = (np.asarray(values, dtype=float) for values in curve)
    i = int(np.argmax(P))
    best = float(d[i]), float(P[i])
    if slope is None:
        return best
    from scipy.interpolate import CubicHermiteSpline  # here, as curves without slopes do not need it

    s = np.asarray(slope, dtype=float)
    for a, b in ((i - 1, i), (i, i + 1)):
        if a < 0 or b == len(d) or not (d[b] > d[a] and s[a] > 0.0 > s[b]):
            continue
        cubic, line = CubicHermiteSpline(d[[a, b]], P[[a, b]], s[[a, b]]), 0.5 * (d[b] - d[a]) * (P[a] + P[b])
        spent = np.nan if energy is None else float(np.diff(np.asarray(energy, dtype=float)[[a, b]])[0])
        if abs(spent - line) < abs(spent - cubic.integrate(d[a], d[b])):
            continue
        at = cubic.derivative().roots(extrapolate=False)
        best = max(best, *zip(at.tolist(), cubic(at).tolist(), strict=True), key=lambda point: point[1])
    return best


def oscillation(curve: Curve, reference: Curve, end: float | None = None) -> dict[str, float]:
    """How much a curve wiggles on the propagation branch, opening > 1.3 x the reference's opening at its peak.

    Returns
    -------
    rms : root mean square of load / reference - 1 after its mean is removed
    excess_variation : total variation of the load over that of a monotone curve between the same ends, minus 1
    """
    begin = PROPAGATION * peak(envelope(*reference))[0]
    last = min(float(np.max(curve[0])), float(np.max(reference[0])))
    end = last if end is None else min(end, last)
    if not end > begin:
        return {"rms": np.nan, "excess_variation": np.nan}
    grid = samples(begin, end)
    load = load_at(curve, grid)
    ratio = load / load_at(reference, grid) - 1.0
    variation, net = np.sum(np.abs(np.diff(load))), abs(load[-1] - load[0])
    return {
        "rms": float(np.sqrt(np.mean((ratio - ratio.mean()) ** 2))),
        "excess_variation": float(variation / net - 1.0) if net > 0.0 else np.nan,
    }
