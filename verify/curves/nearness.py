"""Distance of the points of a curve from the graph of another curve."""

from __future__ import annotations

import numpy as np

from verify.curves.curve import SAMPLES, Curve, envelope, load_at

#: The least opening and load that a distance is relative to, in parts of the largest ones: where a load passes through
#: zero, or nothing is open yet, only the size of the whole curve is left as a measure.
LEAST_OPENING, LEAST_LOAD = 0.02, 0.1

#: Difference of two loads, in parts of the load, that only a steep fall makes of a small difference of the openings.
OF_A_FALL = 0.1

#: Points that are looked at together.
CHUNK = 64

#: Opening and load, of a whole curve or (n,) of each point.
Size = tuple[float, float] | np.ndarray


def apart(curve: Curve, reference: Curve, end: float, begin: float = 0.0) -> float:
    """Relative L2 distance of two envelopes over `SAMPLES` equal openings in (begin, end]; NaN where ``curve`` ends
    before.

    Where the loads differ by more than `OF_A_FALL` behind a peak, the distance along the opening may be the smaller
    one: of a steep or vertical fall that comes a little earlier or later the difference of the loads is its height,
    and counts where a sample happens to be between. There a fall that is off by a part s of its opening counts with s
    times the load before it.
    """
    grid = np.minimum(begin + (end - begin) * (np.arange(1, SAMPLES + 1) / SAMPLES), end)
    mine, other = load_at(curve, grid), load_at(reference, grid)
    size, off = (end, float(np.nanmax(np.abs(other)))), np.abs(mine - other)
    shown = envelope(*reference)
    falls = (grid >= min(float(d[np.argmax(P)]) for d, P in (envelope(*curve), shown))) & np.isfinite(off)
    near = distances((grid[falls], mine[falls]), shown, size, OF_A_FALL)
    off[falls] = np.minimum(off[falls], near * np.maximum(np.abs(mine), np.abs(other))[falls])
    return float(np.sqrt(np.sum(off**2) / np.sum(other**2)))


def distances_along_load(points: Curve, graph: Curve, size: Size, least: float | np.ndarray = LEAST_LOAD) -> np.ndarray:
    """|P - P_graph| (n,) at the opening of every point, relative to its own load; infinite where the graph has none.

    The graph is taken as its envelope. ``size``: largest opening and load.
    """
    d, P = (np.asarray(values, dtype=float) for values in points)
    x, y = envelope(*graph)
    off = np.abs(P - np.interp(d, x, y)) / np.maximum(np.abs(P), least * size[1])
    return np.where((d >= x[0]) & (d <= x[-1]), off, np.inf)


def distances(
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
    near : a point whose load alone is no more than that off counts with this.
    enough : once a point of a chunk of `CHUNK` points is farther, the remaining chunks count as 0
    least : the least load that a distance is relative to, in parts of the largest one
    """
    d, P = (np.asarray(values, dtype=float) for values in points)
    found = distances_along_load(points, graph, size, least)
    far = np.flatnonzero(found > near)
    far = far[np.argsort(-found[far], kind="stable")]
    starts, ends = _segments(graph)
    scale = np.maximum(np.abs(d), LEAST_OPENING * size[0]), np.maximum(np.abs(P), least * size[1])
    for first in range(0, len(far), CHUNK):
        n = far[first : first + CHUNK]
        found[n] = _to_segments(np.stack((d[n], P[n])), starts, ends, np.stack((scale[0][n], scale[1][n])))
        if np.max(found[n]) > enough:
            found[far[first + CHUNK :]] = 0.0
            break
    return found


def _segments(graph: Curve) -> tuple[np.ndarray, np.ndarray]:
    """Beginnings and ends (2, m) of the straight pieces of a path and of its envelope, and of its kinks."""
    whole = np.stack([np.asarray(values, dtype=float) for values in graph])
    start, tip, end = _kinks(whole)
    parts = [(line[:, :-1], line[:, 1:]) for line in (whole, np.stack(envelope(*graph)))] + [(start, tip), (tip, end)]
    starts, ends = zip(*parts, strict=True)
    return np.hstack(starts), np.hstack(ends)


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
