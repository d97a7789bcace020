"""Exact fields of plane elasticity without body forces, from two analytic functions, and errors against them.

With z = x + iy, shear modulus mu and kappa = 3 - 4 nu in plane strain, (3 - nu)/(1 + nu) in plane stress:

    2 mu (u + i v) = kappa phi - z conj(phi') - conj(psi)
    s_xx + s_yy = 4 Re phi',   s_yy - s_xx + 2 i s_xy = 2 (conj(z) phi'' + psi')

(Muskhelishvili 1953, sec. 32 and 41).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from plane_elasticity import bulk_bases

from iga.elements.bulk import gradient
from iga.elements.kinematics import small_stress
from iga.mesh.extraction import Mesh

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


@dataclass(frozen=True)
class Errors:
    """Relative errors: displacement in L2, stress in the energy norm, largest stress error over largest stress."""

    displacement: float
    energy: float
    stress: float


def errors(mesh: Mesh, D: np.ndarray, u_Ai: np.ndarray, exact: PlaneField, up_to_rigid: bool = False) -> Errors:
    """Errors by p + 3 or more Gauss points per direction.

    Parameters
    ----------
    D : (3, 3) elasticity matrix of the numerical solution.
    u_Ai : (n_A, 2) its control displacements.
    up_to_rigid : subtract the rigid motion from the difference, as tractions alone do not determine it.
    """
    parts: list[tuple[np.ndarray, ...]] = []
    for basis in bulk_bases(mesh, 2):
        sigma_ijeq = small_stress(D, gradient(basis, u_Ai))[0]
        exact_ijeq = np.moveaxis(exact.stress(basis.X_eqI), (2, 3), (0, 1))
        u_eqi = exact.displacement(basis.X_eqI)
        miss_eqi = np.einsum("eqa,eai->eqi", basis.N_eqa, u_Ai[basis.conn_ea]) - u_eqi
        vectors = (v.reshape(-1, 2) for v in (u_eqi, miss_eqi, basis.X_eqI))
        tensors = (t.reshape(4, -1).T for t in (exact_ijeq, sigma_ijeq - exact_ijeq))
        parts.append((*vectors, *tensors, basis.dV_eq.ravel()))
    u, miss, X, stress_qk, gap_qk, dV = (np.concatenate(part) for part in zip(*parts, strict=True))
    stress, gap = stress_qk.T, gap_qk.T
    if up_to_rigid:
        u, miss = (_without_rigid_motion(v, X, dV) for v in (u, miss))
    return Errors(
        float(np.sqrt(np.sum(miss**2 * dV[:, None]) / np.sum(u**2 * dV[:, None]))),
        float(np.sqrt(_energy(gap, D, dV) / _energy(stress, D, dV))),
        float(np.max(np.abs(gap)) / np.max(np.abs(stress))),
    )


def _energy(stress_kq: np.ndarray, D: np.ndarray, dV: np.ndarray) -> float:
    voigt = stress_kq[[0, 3, 1]]
    return float(np.sum(voigt * np.linalg.solve(D, voigt) * dV))


def _without_rigid_motion(u: np.ndarray, X: np.ndarray, dV: np.ndarray) -> np.ndarray:
    """The field minus its L2 projection onto translations and the rotation about the centre."""
    x = X - dV @ X / dV.sum()
    turn = np.stack([-x[:, 1], x[:, 0]], -1)
    return u - dV @ u / dV.sum() - turn * (np.sum(turn * u, 1) @ dV) / (np.sum(turn**2, 1) @ dV)
