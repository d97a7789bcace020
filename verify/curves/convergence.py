"""Observed order, Richardson's limit and the grid convergence index of three or more meshes, and their error."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np

#: Safety factor of the index for three or more meshes (Roache 1994).
GCI_SAFETY = 1.25

#: Successive triples whose orders differ by more than this part are not in the asymptotic range.
STEADY = 0.1

#: Orders that are looked for.
ORDERS_SOUGHT = 1e-3, 200.0

#: Of some meshes, finest first.
Values: TypeAlias = Sequence[float] | np.ndarray


@dataclass(frozen=True)
class Convergence:
    """The limit of a sequence of meshes, with its uncertainty.

    order : observed order of the three finest meshes, NaN where there is none
    limit : Richardson's extrapolation from the two finest, (r^p f1 - f2) / (r^p - 1) (Celik et al. 2008, eq. 6)
    error : estimated relative error of the finest, |f1 - limit| / |limit|
    gci : grid convergence index of the finest, relative: GCI_SAFETY |(f1 - f2) / f1| / (r^p - 1) (eq. 7)
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

    Celik, Ghia, Roache, Freitas (2008), J. Fluids Eng. 130, 078001, eqs. 5a-5c: p = |ln|e32 / e21| + q(p)| / ln r21,
    q(p) = ln((r21^p - s) / (r32^p - s)), s = sign(e32 / e21); the least root; NaN where the differences vanish or no
    such p in `ORDERS_SOUGHT` is found.
    """
    r21, r32 = size[1] / size[0], size[2] / size[1]
    e21, e32 = value[1] - value[0], value[2] - value[1]
    if e21 == 0.0 or e32 == 0.0 or not (r21 > 1.0 and r32 > 1.0):
        return float("nan")
    s, level = np.sign(e32 / e21), np.log(abs(e32 / e21))

    def off(p: Any) -> Any:
        q = np.log((r21**p - s) / (r32**p - s)) if r21 != r32 else 0.0
        return abs(level + q) / np.log(r21) - p

    from scipy.optimize import brentq  # here, as few commands need it

    with np.errstate(all="ignore"):
        p = np.geomspace(*ORDERS_SOUGHT, 400)
        signs = np.sign(off(p))
        at = np.flatnonzero(signs[:-1] * signs[1:] < 0.0)
        return float(brentq(off, p[at[0]], p[at[0] + 1], xtol=1e-14)) if at.size else float("nan")


def assess(size: Values, value: Values) -> Convergence:
    """Judge a sequence of meshes.

    Parameters
    ----------
    size : (n,) typical element sizes, n >= 3, in any order
    value : (n,) computed on them

    Raises
    ------
    ValueError : fewer than three meshes, or two of the same size
    """
    order = np.argsort(np.asarray(size, dtype=float), kind="stable")
    h, f = np.asarray(size, dtype=float)[order], np.asarray(value, dtype=float)[order]
    if len(h) < 3 or np.any(np.diff(h) <= 0.0) or h[0] <= 0.0:
        raise ValueError(f"size: must hold at least three different positive numbers, got {list(size)}")
    p = observed_order(h[:3], f[:3])
    reason = _doubt(h, f, p)
    factor = (h[1] / h[0]) ** p  # NaN without an order
    limit = float((factor * f[0] - f[1]) / (factor - 1.0))
    with np.errstate(all="ignore"):
        error = float(abs((f[0] - limit) / limit)) if limit else np.nan
        gci = float(GCI_SAFETY * abs((f[0] - f[1]) / f[0]) / (factor - 1.0)) if f[0] else np.nan
    verdict = f"not in the asymptotic range: {reason}" if reason else f"in the asymptotic range, observed order {p:.2f}"
    return Convergence(p, limit, error, gci, not reason, verdict)


def _doubt(h: np.ndarray, f: np.ndarray, p: float) -> str:
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
    if len(h) > 3:
        coarser = observed_order(h[1:4], f[1:4])
        if not abs(coarser - p) <= STEADY * p:
            return f"observed order {coarser:.2f} on the coarser meshes, {p:.2f} on the finer"
    return ""


@dataclass(frozen=True)
class MeshEstimate:
    """What is taken for the error of a mesh where its index cannot be trusted.

    most_order : the load of a cohesive front has no higher order. A higher observed one is that of two fine meshes that
        agree by chance: the error is then that of this order over the range of all values, range / ((h_coarsest /
        h_finest)^order - 1), times the safety factor of the index
    spread : safety factor on the error of meshes that are not in the asymptotic range, which is then that of a first
        order over the range of all values, range / (h_coarsest / h_finest - 1) (Eca and Hoekstra 2014, J. Comput. Phys.
        262, 104)
    """

    most_order: float = 2.0
    spread: float = 3.0


MESH_ESTIMATE = MeshEstimate()


@dataclass(frozen=True)
class MeshError:
    """Of the finest mesh: ``index`` bounds the error with 95 % [unit of the value], ``verdict`` says how, ``order`` is
    that which is observed, NaN for meshes that are not in the asymptotic range."""

    index: float
    verdict: str
    doubtful: bool
    order: float = float("nan")


def mesh_error(sizes: Sequence[float], values: Sequence[float]) -> MeshError:
    """The grid convergence index of the finest of three or more meshes.

    Observed orders of more than `MeshEstimate.most_order`, and meshes that are not in the asymptotic range, have an
    error over the range of their values in its place. NaN where two meshes are of one size.
    """
    if len(set(sizes)) < len(sizes):
        return MeshError(float("nan"), "two meshes are of one size", True)
    found, ratio, width = assess(sizes, values), float(max(sizes) / min(sizes)), float(np.ptp(values))
    if not found.asymptotic:
        index = MESH_ESTIMATE.spread * width / (ratio - 1.0)
    elif found.order > MESH_ESTIMATE.most_order:
        index = GCI_SAFETY * width / (ratio**MESH_ESTIMATE.most_order - 1.0)
    else:
        index = float(abs(values[int(np.argmin(sizes))])) * found.gci
    return MeshError(index, found.verdict, not found.asymptotic, found.order if found.asymptotic else float("nan"))
