"""One arm as a shear-flexible beam: derivatives of its four states along the undeformed axis, and its energy.

States, in units of the arm thickness h and of the bending stiffness EI (force EI / h^2, moment EI / h):
deflection v, rotation of the section phi, vertical section force V, moment M. There is no horizontal section force,
since the supports carry no load and the tractions stay vertical.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

V, PHI, FORCE, MOMENT = range(4)

#: Shear correction factor of a rectangle that is free to warp; it gives the exact shear energy of the parabolic stress
#: (Reissner 1945). Cowper's 10 (1 + nu) / (12 + 11 nu) differs by 1.5 % in a term of 0.1 %.
SHEAR_CORRECTION = 5.0 / 6.0


@dataclass(frozen=True)
class Arm:
    """An arm: stiffness ratios ``shear`` = EI / (kappa G A h^2), ``stretch`` = EI / (E A h^2), and kinematics."""

    shear: float
    stretch: float
    finite: bool

    @property
    def states(self) -> int:
        return 4

    def linear(self) -> Arm:
        return replace(self, finite=False)

    def gap(self, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The gap over the number of arms, here the deflection, (...,), and its derivative (..., 4)."""
        d = np.zeros_like(y)
        d[..., V] = 1.0
        return y[..., V], d

    def rates(self, y: np.ndarray, on: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Rates (..., 4) and their derivative (..., 4, 4) at states ``y`` (..., 4) on a foundation of force c + k v,
        ``on`` (..., 3) with k and c first.

        Linear: Timoshenko, v' = phi + V / (kappa G A). Finite: geometrically exact, r' = (1 + eps) t + gamma n
        (Reissner 1972, eqs. 1-9), with N = V sin(phi) = EA eps and Q = V cos(phi) = kappa G A gamma.
        """
        k, c = on[..., 0], on[..., 1]
        d = np.zeros((*y.shape, 4))
        d[..., PHI, MOMENT] = 1.0
        d[..., FORCE, V] = k
        if self.finite:
            v, m = self._finite(y, d)
        else:
            v, m = y[..., PHI] + self.shear * y[..., FORCE], -y[..., FORCE]
            d[..., V, PHI], d[..., V, FORCE], d[..., MOMENT, FORCE] = 1.0, self.shear, -1.0
        return np.stack((v, y[..., MOMENT], c + k * y[..., V], m), axis=-1), d

    def _finite(self, y: np.ndarray, d: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        force, sin, cos = y[..., FORCE], np.sin(y[..., PHI]), np.cos(y[..., PHI])
        soft = self.stretch - self.shear
        along = cos + soft * force * sin * cos
        d[..., V, PHI] = cos + 2.0 * soft * force * sin * cos
        d[..., V, FORCE] = self.stretch * sin**2 + self.shear * cos**2
        d[..., MOMENT, PHI] = -force * (-sin + soft * force * (cos**2 - sin**2))
        d[..., MOMENT, FORCE] = -along - force * soft * sin * cos
        return sin + force * d[..., V, FORCE], -force * along

    def energy(self, y: np.ndarray, on: np.ndarray) -> np.ndarray:
        """Strain energy per unit length (...,), in units of EI / h^2."""
        force, phi = y[..., FORCE], y[..., PHI]
        axial, shear = (force * np.sin(phi), force * np.cos(phi)) if self.finite else (0.0, force)
        return 0.5 * (y[..., MOMENT] ** 2 + self.stretch * axial**2 + self.shear * shear**2)

    def decay(self, on: np.ndarray, force: float) -> float:
        """Largest rate r of the solutions exp(r x) on the foundation ``on`` (3,) under the section force ``force``."""
        roots = np.roots([1.0, -on[0] * self.shear, on[0]])
        return float(np.sqrt(max(np.abs(roots).max(), abs(force) if self.finite else 0.0)))
