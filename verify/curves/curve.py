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

    A step on which many interface points break has the slopes of single teeth at its ends, which say nothing of the
    curve between. The area under it is known: the change of the ``energy``. A step whose straight line is closer to
    that area than its cubic is straight.

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
    away = t * t * (1.0 - t) * (chord - last) + t * (1.0 - t) ** 2 * (first - chord)  # of the straight line
    if energy is not None:
        spent = np.diff(np.asarray(energy, dtype=float)) / np.prod(size)
        unseen = spent - (start[:, 1] + 0.5 * chord[:, 1]) * chord[:, 0]  # between path and straight line
        x, y = np.moveaxis(np.concatenate([np.zeros((1, *start.shape)), start + t * chord + away - start]), 2, 0)
        drawn = np.trapezoid(y, x, axis=0) - 0.5 * chord[:, 0] * chord[:, 1]
        away = np.where((np.abs(unseen - drawn) <= np.abs(unseen))[:, None], away, 0.0)
    between = start + t * chord + away
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


def curve_error(curve: Curve, reference: Curve, end: float | None = None, n: int = SAMPLES) -> float:
    """Relative L2 distance of two envelopes over ``n`` equal openings in (0, end].

    ``end`` is at most the last opening of the reference. NaN where ``curve`` does not reach it.
    """
    last = float(envelope(*reference)[0][-1])
    end = last if end is None else min(end, last)
    grid = end * (np.arange(1, n + 1) / n)  # the last is the end itself; times n, over n it may round beyond
    wanted = load_at(reference, grid)
    return float(np.sqrt(np.sum((load_at(curve, grid) - wanted) ** 2) / np.sum(wanted**2)))


def peak(curve: Curve, slope: ArrayLike | None = None, energy: ArrayLike | None = None) -> tuple[float, float]:
    """Opening and load at the largest load of the path; with the exact ``slope`` the peak of its Hermite cubics.

    A step that is straight by its ``energy``, as in `dense`, has its largest load at an end.
    """
    d, P = (np.asarray(values, dtype=float) for values in curve)
    i = int(np.argmax(P))
    best = float(d[i]), float(P[i])
    if slope is None:
        return best
    s = np.asarray(slope, dtype=float)
    for a, b in ((i - 1, i), (i, i + 1)):
        if a >= 0 and b < len(d) and d[b] > d[a] and s[a] > 0.0 > s[b]:
            spent = None if energy is None else float(np.diff(np.asarray(energy, dtype=float)[[a, b]])[0])
            if spent is not None and _straight(d[[a, b]], P[[a, b]], s[[a, b]], spent):
                continue
            at = _stationary(d[[a, b]], P[[a, b]], s[[a, b]])
            top = float(hermite(d, P, s, np.array([at]))[0])
            best = (at, top) if top > best[1] else best
    return best


def _straight(d: np.ndarray, P: np.ndarray, s: np.ndarray, spent: float) -> bool:
    """Whether the energy spent on a step is nearer to the area under its straight line than to that of its cubic."""
    h = d[1] - d[0]
    unseen, drawn = spent - 0.5 * h * (P[0] + P[1]), h * h * (s[0] - s[1]) / 12.0
    return not abs(unseen - drawn) <= abs(unseen)


def _stationary(d: np.ndarray, P: np.ndarray, s: np.ndarray) -> float:
    """Where the Hermite cubic of one step, rising at its start and falling at its end, has its maximum."""
    h = d[1] - d[0]
    secant = (P[1] - P[0]) / h
    a, b, c = 3.0 * (s[0] + s[1] - 2.0 * secant), 2.0 * (3.0 * secant - 2.0 * s[0] - s[1]), s[0]
    t = 2.0 * c / (-b + np.sqrt(b * b - 4.0 * a * c))  # the root at which the slope falls, safe for a -> 0
    return float(d[0] + h * t)


def hermite(opening: ArrayLike, load: ArrayLike, slope: ArrayLike, at: ArrayLike) -> np.ndarray:
    """Load at openings ``at`` of the cubic through values and exact slopes, along the envelope; NaN outside it.

    Steps that come back through the largest opening so far (snap-back, unloading) are entered where they do.
    """
    d, P, s = (np.asarray(values, dtype=float) for values in (opening, load, slope))
    x = np.asarray(at, dtype=float)
    top = np.maximum.accumulate(d)
    inside = (x >= d[0]) & (x <= top[-1])
    i = np.clip(np.searchsorted(top, x, side="left"), 1, len(d) - 1)
    h = np.where(d[i] > d[i - 1], d[i] - d[i - 1], 1.0)
    t = (x - d[i - 1]) / h
    value = (
        (1.0 + 2.0 * t) * (1.0 - t) ** 2 * P[i - 1]
        + t * (1.0 - t) ** 2 * h * s[i - 1]
        + t**2 * (3.0 - 2.0 * t) * P[i]
        + t**2 * (t - 1.0) * h * s[i]
    )
    return np.where(inside, value, np.nan)


def oscillation(curve: Curve, reference: Curve, end: float | None = None, n: int = SAMPLES) -> dict[str, float]:
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
    grid = np.minimum(begin + (end - begin) * (np.arange(1, n + 1) / n), end)
    load = load_at(curve, grid)
    ratio = load / load_at(reference, grid) - 1.0
    variation, net = np.sum(np.abs(np.diff(load))), abs(load[-1] - load[0])
    return {
        "rms": float(np.sqrt(np.mean((ratio - ratio.mean()) ** 2))),
        "excess_variation": float(variation / net - 1.0) if net > 0.0 else np.nan,
    }
