"""Exact fields of plane elasticity without body forces, displacements and stresses, from two analytic functions.

With z = x + iy, shear modulus mu and kappa = 3 - 4 nu in plane strain, (3 - nu)/(1 + nu) in plane stress:

    2 mu (u + i v) = kappa phi - z conj(phi') - conj(psi)
    s_xx + s_yy = 4 Re phi',   s_yy - s_xx + 2 i s_xy = 2 (conj(z) phi'' + psi')

(Muskhelishvili 1953, sec. 32 and 41).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

Analytic = Callable[[np.ndarray], np.ndarray]


@dataclass(frozen=True)
class PlaneField:
    """One exact solution: ``phi`` with its first two derivatives, ``psi`` with its first, and the isotropic solid."""

    phi: tuple[Analytic, Analytic, Analytic]
    psi: tuple[Analytic, Analytic]
    young: float
    poisson: float
    plane: str  # "stress" or "strain"

    @property
    def kappa(self) -> float:
        nu = self.poisson
        return 3.0 - 4.0 * nu if self.plane == "strain" else (3.0 - nu) / (1.0 + nu)

    def displacement(self, X: np.ndarray) -> np.ndarray:
        """Displacement (..., 2) at positions (..., 2)."""
        z = X[..., 0] + 1j * X[..., 1]
        twice_mu = self.young / (1.0 + self.poisson)
        w = (self.kappa * self.phi[0](z) - z * np.conj(self.phi[1](z)) - np.conj(self.psi[0](z))) / twice_mu
        return np.stack([w.real, w.imag], -1)

    def stress(self, X: np.ndarray) -> np.ndarray:
        """Stress (..., 2, 2) at positions (..., 2)."""
        z = X[..., 0] + 1j * X[..., 1]
        total = 4.0 * self.phi[1](z).real
        deviator = 2.0 * (np.conj(z) * self.phi[2](z) + self.psi[1](z))
        xx, yy, xy = 0.5 * (total - deviator.real), 0.5 * (total + deviator.real), 0.5 * deviator.imag
        return np.stack([np.stack([xx, xy], -1), np.stack([xy, yy], -1)], -2)

    def traction(self, X: np.ndarray, normal: np.ndarray) -> np.ndarray:
        """Traction (..., 2) on a surface with a unit normal (..., 2)."""
        return np.einsum("...ij,...j->...i", self.stress(X), normal)


def uniform(s_xx: float, s_yy: float, s_xy: float, young: float, poisson: float, plane: str) -> PlaneField:
    """Constant stress: the patch test."""
    a, b = 0.25 * (s_xx + s_yy), 0.5 * (s_yy - s_xx) + 1j * s_xy
    phi = (lambda z: a * z, lambda z: a + 0.0 * z, lambda z: 0.0 * z)
    return PlaneField(phi, (lambda z: b * z, lambda z: b + 0.0 * z), young, poisson, plane)


def smooth(centre: complex, size: float, stress: float, young: float, poisson: float, plane: str) -> PlaneField:
    """Entire functions, phi = s L exp(zeta)/4 and psi = s L sin(2 zeta)/4 with zeta = (z - centre)/L, L = size/2."""
    L = 0.5 * size
    a = 0.25 * stress
    phi = (
        lambda z: a * L * np.exp((z - centre) / L),
        lambda z: a * np.exp((z - centre) / L),
        lambda z: a / L * np.exp((z - centre) / L),
    )
    psi = (lambda z: a * L * np.sin(2.0 * (z - centre) / L), lambda z: 2.0 * a * np.cos(2.0 * (z - centre) / L))
    return PlaneField(phi, psi, young, poisson, plane)


def kirsch(radius: float, stress: float, young: float, poisson: float, plane: str) -> PlaneField:
    """Infinite plate with a free circular hole about the origin under tension along x (Kirsch 1898).

    phi = s/4 (z + 2 a^2/z), psi = -s/2 (z + a^2/z - a^4/z^3) (Muskhelishvili 1953, sec. 56).
    """
    s, a2 = stress, radius**2
    phi = (
        lambda z: s / 4.0 * (z + 2.0 * a2 / z),
        lambda z: s / 4.0 * (1.0 - 2.0 * a2 / z**2),
        lambda z: s * a2 / z**3,
    )
    psi = (
        lambda z: -s / 2.0 * (z + a2 / z - a2**2 / z**3),
        lambda z: -s / 2.0 * (1.0 - a2 / z**2 + 3.0 * a2**2 / z**4),
    )
    return PlaneField(phi, psi, young, poisson, plane)
