"""The elastica: a clamped, inextensible, unshearable arm under a dead force across its undeformed axis.

Everything is a function of S, the sine of the rotation of the loaded end.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.special import elliprd, elliprf


@dataclass(frozen=True)
class Arms:
    """Points (n,) of the curve of two such arms: load, crack length, S, and dP/d(opening)."""

    load: np.ndarray
    crack: np.ndarray
    sine: np.ndarray
    load_slope: np.ndarray


def shape(S: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Length and end deflection of an arm in units of sqrt(E I / 2 P).

    E I phi'^2 / 2 = P (S - sin phi) from the moment-free end (Bisshopp and Drucker 1945, Q. Appl. Math. 3, 272-275).
    With sin phi = S (1 - x) the length is S^(1/2) int_0^1 x^(-1/2) (1 - S + S x)^(-1/2) (1 + S - S x)^(-1/2) dx, the
    deflection the same with S (1 - x) more; x = 1 / (1 + t) makes them Carlson's R_F and R_D (Carlson 1995, Numer.
    Algorithms 10, 13-26), free of the cancellation at small S that Legendre's integrals have.
    """
    rf = elliprf(1.0 - S**2, 1.0 + S, 1.0 - S)
    rd = elliprd(1.0 + S, 1.0 - S, 1.0 - S**2)
    return 2.0 * np.sqrt(S) * rf, 2.0 * S**1.5 * (rf - (1.0 - S**2) * rd / 3.0)


def onset(EI: float, Gw: float, crack: float) -> float:
    """Opening at which a crack begins to run: 2 P S = G w."""
    S = _root(lambda S: _growing(EI, Gw, S)[2] - crack, 1)
    return float(_growing(EI, Gw, S)[1][0])


def fixed_crack(EI: float, crack: float, opening: np.ndarray) -> Arms:
    """Arms of the length ``crack`` at openings (n,) >= 0."""
    bent = opening > 0.0
    S, P = np.zeros_like(opening), np.zeros_like(opening)
    slope = np.full_like(opening, 1.5 * EI / crack**3)
    S[bent] = _root(lambda S: _fixed(EI, crack, S)[1] - opening[bent], np.count_nonzero(bent))
    P[bent] = _fixed(EI, crack, S[bent])[0]
    slope[bent] = _slope(lambda S: _fixed(EI, crack, S), S[bent])
    return Arms(P, np.full_like(opening, crack), S, slope)


def growing_crack(EI: float, Gw: float, opening: np.ndarray) -> Arms:
    """Arms whose crack is in equilibrium, 2 P S = G w, at openings (n,) > 0."""
    S = _root(lambda S: _growing(EI, Gw, S)[1] - opening, len(opening))
    P, _, crack = _growing(EI, Gw, S)
    return Arms(P, crack, S, _slope(lambda S: _growing(EI, Gw, S)[:2], S))


def _fixed(EI: float, crack: float, S: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Load and opening of a crack of given length."""
    length, deflection = shape(S)
    return EI * length**2 / (2.0 * crack**2), 2.0 * crack * deflection / length


def _growing(EI: float, Gw: float, S: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Load, opening and length of a crack in equilibrium."""
    length, deflection = shape(S)
    unit = np.sqrt(EI * S / Gw)
    return Gw / (2.0 * S), 2.0 * unit * deflection, unit * length


def _root(function: Callable[[np.ndarray], np.ndarray], n: int) -> np.ndarray:
    """Roots (n,) in (0, 1) of functions that increase with S, by bisection to rounding."""
    low, high = np.zeros(n), np.ones(n)
    for _ in range(100):
        middle = 0.5 * (low + high)
        above = function(middle) > 0.0
        low, high = np.where(above, low, middle), np.where(above, middle, high)
    return low


def _slope(curve: Callable, S: np.ndarray) -> np.ndarray:
    """dP/d(opening) of a curve (P, opening) of S, by the complex step: to rounding (Squire and Trapp 1998)."""
    load, opening = curve(S + 1e-30j)
    return load.imag / opening.imag
