"""Histories and energies along a whole displacement path at one point of a bond."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from verify.support.refusal import Refusal


@dataclass(frozen=True)
class Path:
    """What a bond does at the n points of a path, arrays (n,) each.

    Parameters
    ----------
    p, t : tractions along normal and tangent (stress)
    d : damage, 0 intact to 1 open
    slip : slip s_p that friction does not give back (length); zero without friction
    stored, contact, friction_stored : energies recoverable from cohesion, from contact and from the elastic part of
        friction (energy per area)
    released, rubbed : energies lost to damage and to friction since the start (energy per area), see `accumulated`
    """

    p: np.ndarray
    t: np.ndarray
    d: np.ndarray
    slip: np.ndarray
    stored: np.ndarray
    contact: np.ndarray
    friction_stored: np.ndarray
    released: np.ndarray
    rubbed: np.ndarray


def steps_in_time(time: np.ndarray | None, n: int) -> np.ndarray:
    """Time steps (n,) that lead to the points, 0 to the first; without times, n equal ones in the unit of time.

    Raises `Refusal` for times that decrease or are no numbers.
    """
    if time is None:
        return np.full(n, 1.0 / max(n - 1, 1)) * (np.arange(n) > 0)
    time = np.asarray(time, dtype=float)
    dt = np.diff(time, prepend=time[:1])
    if time.shape != (n,) or not np.all(np.isfinite(time)):
        raise Refusal(f"time: must be {n} finite numbers, one for each point, got shape {time.shape}")
    if np.any(dt < 0.0):
        raise Refusal(f"time: must not decrease along the path, got a step of {dt.min():g}")
    return dt


def damage_history(D: np.ndarray, dt: np.ndarray, viscosity: float, irreversible: bool) -> np.ndarray:
    """Damage (n,) from what the jumps ask for, D (n,): their largest so far, or behind it by the viscosity v.

    With v > 0 implicit Euler of d' = <D - d> / v: d_new = d + dt / (dt + v) <D - d>. A reversible bond has d = D.
    """
    if not irreversible:
        return D.copy()
    if viscosity == 0.0:
        return np.maximum.accumulate(D)
    share = dt / (dt + viscosity)
    d, reached = np.empty_like(D), 0.0
    for i, (goal, part) in enumerate(zip(D, share, strict=True)):
        reached += part * max(goal - reached, 0.0)
        d[i] = reached
    return d


def slip_history(s: np.ndarray, reach: np.ndarray) -> np.ndarray:
    """Slip s_p (n,), which stays while |s - s_p| <= ``reach`` (n,), the elastic slip that friction bears.

    This is Coulomb's law t_f = clip(Ks (s - s_p), -mu q, mu q) with reach = mu q / Ks, started at s_p = 0.
    """
    if not np.any(reach > 0.0):
        return s.copy()
    slip, held = np.empty_like(s), 0.0
    for i, (low, high) in enumerate(zip(s - reach, s + reach, strict=True)):
        held = min(max(held, low), high)
        slip[i] = held
    return slip


def accumulated(rate: np.ndarray, x: np.ndarray) -> np.ndarray:
    """Integral (n,) of ``rate`` dx from the start by the trapezoidal rule between points.

    Before its first point a path stands at rest, with nothing stored and x = 0. The rule is of second order: halving
    the steps of a path divides the error by four, within a step on which damage begins as well.
    """
    from scipy.integrate import cumulative_trapezoid  # here, as a bond that opens alone does not need it

    return cumulative_trapezoid(np.append(0.0, rate), np.append(0.0, x))
