"""The elastica: a clamped, inextensible, unshearable arm under a dead force across its undeformed axis.

Everything is a function of S, the sine of the rotation of the loaded end, or of t, its logit.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.special import elliprd, elliprf


@dataclass(frozen=True)
class Arms:
    """Points (n,) of the load curve of one or two such arms: load, crack length, S, and dP/d(opening)."""

    load: np.ndarray
    crack: np.ndarray
    sine: np.ndarray
    load_slope: np.ndarray


def sine(t: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """S and 1 - S for t from -inf (straight) to inf (upright), both to full relative accuracy."""
    return 1.0 / (1.0 + np.exp(-t)), 1.0 / (1.0 + np.exp(t))


def shape(t: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Length and end deflection (n,) of an arm in units of sqrt(E I / 2 P).

    E I phi'^2 / 2 = P (S - sin phi) from the moment-free end (Bisshopp and Drucker 1945, Q. Appl. Math. 3, 272-275).
    With sin phi = S (1 - x) the length is S^(1/2) int_0^1 x^(-1/2) (1 - S + S x)^(-1/2) (1 + S - S x)^(-1/2) dx, the
    deflection the same with S (1 - x) more; x = 1 / (1 + t) turns them into Carlson's R_F and R_D (Carlson 1995,
    Numer. Algorithms 10, 13-26), without the cancellation at small S of Legendre's integrals.
    """
    S, rest = sine(t)
    square = rest * (1.0 + S)
    rf = elliprf(square, 1.0 + S, rest)
    rd = elliprd(1.0 + S, rest, square)
    return 2.0 * np.sqrt(S) * rf, 2.0 * S**1.5 * (rf - square * rd / 3.0)


def onset(EI: float, Gw: float, crack: float, arms: int) -> float:
    """Opening at which a crack starts to grow: n P S = G w."""
    t = _root(lambda t: _growing(EI, Gw, t, arms)[2] - crack, 1)
    return float(_growing(EI, Gw, t, arms)[1][0])


def fixed_crack(EI: float, crack: float, opening: np.ndarray, arms: int) -> Arms:
    """Arms of the length ``crack`` at openings (n,) >= 0, the sum of their deflections."""
    bent = opening > 0.0
    S, P = np.zeros_like(opening), np.zeros_like(opening)
    slope = np.full_like(opening, 3.0 * EI / (arms * crack**3))
    t = _root(lambda t: _fixed(EI, crack, t, arms)[1] - opening[bent], int(np.count_nonzero(bent)))
    S[bent], P[bent] = sine(t)[0], _fixed(EI, crack, t, arms)[0]
    slope[bent] = _slope(lambda t: _fixed(EI, crack, t, arms), t)
    return Arms(P, np.full_like(opening, crack), S, slope)


def growing_crack(EI: float, Gw: float, opening: np.ndarray, arms: int) -> Arms:
    """Arms with a growing crack, n P S = G w, at openings (n,) > 0."""
    t = _root(lambda t: _growing(EI, Gw, t, arms)[1] - opening, len(opening))
    P, _, crack = _growing(EI, Gw, t, arms)
    return Arms(P, crack, sine(t)[0], _slope(lambda t: _growing(EI, Gw, t, arms)[:2], t))


def _fixed(EI: float, crack: float, t: np.ndarray, arms: int) -> tuple[np.ndarray, np.ndarray]:
    """Load and opening (n,) for a given crack length."""
    length, deflection = shape(t)
    return EI * length**2 / (2.0 * crack**2), arms * crack * deflection / length


def _growing(EI: float, Gw: float, t: np.ndarray, arms: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Load, opening and length (n,) of a growing crack."""
    S, (length, deflection) = sine(t)[0], shape(t)
    unit = np.sqrt(0.5 * arms * EI * S / Gw)
    return Gw / (arms * S), arms * unit * deflection, unit * length


def _root(function: Callable[[np.ndarray], np.ndarray], n: int) -> np.ndarray:
    """Roots (n,) of functions that increase with t, by bisection to rounding."""
    low: np.ndarray = np.full(n, -300.0)
    high: np.ndarray = np.full(n, 300.0)
    for _ in range(100):
        middle = 0.5 * (low + high)
        above = function(middle) > 0.0
        low, high = np.where(above, low, middle), np.where(above, middle, high)
    return low


def _slope(curve: Callable, t: np.ndarray) -> np.ndarray:
    """dP/d(opening) of a curve (P, opening) of t, to rounding, by the complex step (Squire and Trapp 1998)."""
    load, opening = curve(t + 1e-30j)
    return load.imag / opening.imag
