"""Observed order, Richardson's limit and the grid convergence index from three or more meshes."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

#: Safety factor of the index for three or more meshes (Roache 1994).
GCI_SAFETY = 1.25

#: Successive triples whose orders differ by more than this part are not in the asymptotic range.
STEADY = 0.1

#: Of some meshes, finest first.
Values: TypeAlias = Sequence[float] | np.ndarray


@dataclass(frozen=True)
class Convergence:
    """The limit of a sequence of meshes, with its uncertainty.

    order : observed order of the three finest meshes, NaN where there is none
    limit : Richardson's extrapolation from the two finest
    error : estimated relative error of the finest, |f1 - limit| / |limit|
    gci : grid convergence index of the finest, relative; GCI_SAFETY times the relative error that the order implies
    asymptotic : whether ``limit`` and ``gci`` can be trusted
    verdict : a sentence: converged, or the reason why not
    """

    order: float
    limit: float
    error: float
    gci: float
    asymptotic: bool
    verdict: str


def observed_order(size: Values, value: Values) -> float:
    """Order p of three meshes, finest first, whatever their ratios.

    Celik, Ghia, Roache, Freitas (2008), J. Fluids Eng. 130, 078001, eqs. 5a-5c, in the fixed-point form
    p = |ln|e32 / e21| + q(p)| / ln r21, q(p) = ln((r21^p - s) / (r32^p - s)), s = sign(e32 / e21); NaN where the
    differences vanish or no such p > 0 is found.
    """
    r21, r32 = size[1] / size[0], size[2] / size[1]
    e21, e32 = value[1] - value[0], value[2] - value[1]
    if e21 == 0.0 or e32 == 0.0 or not (r21 > 1.0 and r32 > 1.0):
        return float("nan")
    s, level = np.sign(e32 / e21), np.log(abs(e32 / e21))

    def step(p: float) -> float:
        q = np.log((r21**p - s) / (r32**p - s)) if r21 != r32 else 0.0
        return abs(level + q) / np.log(r21)

    with np.errstate(all="ignore"):  # the iteration may wander far before it is given up
        return _fixed_point(step, abs(level) / np.log(r21))


def _fixed_point(step: Callable[[float], float], p: float) -> float:
    """Fixed point of ``step`` from ``p``; where the iteration wanders, the bracketed root of step(p) - p."""
    for _ in range(200):
        new = step(p) if p > 0.0 else float("nan")
        if not np.isfinite(new):
            break
        if abs(new - p) <= 1e-14 * new:
            return float(new)
        p = new
    grid = np.geomspace(1e-3, 50.0, 400)
    off = np.array([step(x) - x for x in grid])
    change = np.flatnonzero((off[:-1] * off[1:] < 0.0) & np.isfinite(off[:-1]) & np.isfinite(off[1:]))
    if len(change) == 0:
        return float("nan")
    from scipy.optimize import brentq  # here, as few sequences need it

    return float(brentq(lambda x: step(x) - x, grid[change[0]], grid[change[0] + 1], xtol=1e-14))


def richardson(size: Values, value: Values, order: float) -> float:
    """Limit from the two finest meshes and an order: (r^p f1 - f2) / (r^p - 1) (Celik et al. 2008, eq. 6)."""
    factor = (size[1] / size[0]) ** order
    return float((factor * value[0] - value[1]) / (factor - 1.0))


def grid_convergence_index(size: Values, value: Values, order: float) -> float:
    """SAFETY |(f1 - f2) / f1| / (r^p - 1), relative (Celik et al. 2008, eq. 7)."""
    return float(GCI_SAFETY * abs((value[0] - value[1]) / value[0]) / ((size[1] / size[0]) ** order - 1.0))


def assess(size: Values, value: Values, expected: float | None = None) -> Convergence:
    """Judge a sequence of meshes.

    Parameters
    ----------
    size : (n,) typical element sizes, n >= 3, in any order
    value : (n,) computed on them
    expected : the order that the discretisation states, if it does

    Raises
    ------
    ValueError : fewer than three meshes, or two of the same size
    """
    by_size = np.argsort(np.asarray(size, dtype=float), kind="stable")
    h, f = np.asarray(size, dtype=float)[by_size], np.asarray(value, dtype=float)[by_size]
    if len(h) < 3 or np.any(np.diff(h) <= 0.0) or h[0] <= 0.0:
        raise ValueError(f"size: must hold at least three different positive numbers, got {list(size)}")
    p = observed_order(h[:3], f[:3])
    reason = _doubt(h, f, p, expected)
    if not np.isfinite(p):
        return Convergence(p, float("nan"), float("nan"), float("nan"), False, f"not in the asymptotic range: {reason}")
    limit = richardson(h, f, p)
    error = abs((f[0] - limit) / limit) if limit != 0.0 else float("nan")
    gci = grid_convergence_index(h, f, p) if f[0] != 0.0 else float("nan")
    verdict = f"not in the asymptotic range: {reason}" if reason else f"in the asymptotic range, observed order {p:.2f}"
    return Convergence(p, limit, float(error), gci, not reason, verdict)


def _doubt(h: np.ndarray, f: np.ndarray, p: float, expected: float | None) -> str:
    """Why a sequence, finest first, is not in the asymptotic range; empty where nothing speaks against it."""
    difference = np.diff(f)
    if np.all(difference == 0.0):
        return "the values do not change"
    if not np.isfinite(p):
        return "no order is found"
    if difference[0] * difference[1] < 0.0:
        return "the values oscillate"
    rate = np.abs(difference[:2]) / np.log(h[1:3] / h[:2])  # p > 0 needs it to fall; the absolute value in p hides that
    if rate[0] >= rate[1]:
        return "the values do not settle"
    if expected is not None and abs(p - expected) > 0.25 * expected:
        return f"observed order {p:.2f}, expected {expected:g}"
    if len(h) > 3:
        coarser = observed_order(h[1:4], f[1:4])
        if not abs(coarser - p) <= STEADY * p:
            return f"observed order {coarser:.2f} on the coarser meshes, {p:.2f} on the finer"
    return ""
