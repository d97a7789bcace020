"""The strip of a peel test: an arm (``verify.theory.beam.arm``) on an interface on a substrate, a foundation of two
parameters.

Six states: those of the arm, the deflection w of the substrate's surface, and the shear force T = g w' of the layer.
The pressure on the layer is k_w w - T', and where the strip is bonded it equals the traction of the interface.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from verify.theory.beam.arm import MOMENT, PHI, Arm, V

SURFACE, LAYER_SHEAR = 4, 5


@dataclass(frozen=True)
class Strip:
    """``arm`` and, in its units, the layer under it: ``bed`` (k_w) and ``coupling`` (g).

    The tractions act on the lower face, half a thickness below the axis. In finite kinematics a rotation phi raises
    that face by (1 - cos phi) / 2 relative to the axis, and a traction p has the moment p sin(phi) / 2 about the axis.
    Tractions stay vertical: they follow the normal of the substrate's surface, which hardly rotates.
    """

    arm: Arm
    bed: float
    coupling: float

    @property
    def states(self) -> int:
        return 6

    def linear(self) -> Strip:
        return replace(self, arm=self.arm.linear())

    def gap(self, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Gap (...,) of the interface at states (..., 6), in thicknesses, and its derivative (..., 6)."""
        d = np.zeros_like(y)
        d[..., V], d[..., SURFACE] = 1.0, -1.0
        gap = y[..., V] - y[..., SURFACE]
        if self.arm.finite:
            gap = gap + np.sin(0.5 * y[..., PHI]) ** 2
            d[..., PHI] = 0.5 * np.sin(y[..., PHI])
        return gap, d

    def rates(self, y: np.ndarray, on: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Rates (..., 6) and their derivative (..., 6, 6); ``on`` (..., 3) as `Foundation.on` has it."""
        gap, dgap = self.gap(y)
        k, c, beneath = on[..., 0], on[..., 1], on[..., 2]
        pull = c + k * gap
        bonded = np.stack((np.zeros_like(pull), pull, np.zeros_like(pull)), axis=-1)
        rate, d_arm = self.arm.rates(y[..., :SURFACE], bonded)
        f = np.concatenate((rate, np.zeros((*rate.shape[:-1], 2))), axis=-1)
        d = np.zeros((*f.shape, 6))
        d[..., :SURFACE, :SURFACE] = d_arm
        d_pull = k[..., None] * dgap
        d[..., 2, :] += d_pull
        f[..., MOMENT] += pull * dgap[..., PHI]
        d[..., MOMENT, :] += dgap[..., PHI, None] * d_pull
        if self.arm.finite:
            d[..., MOMENT, PHI] += 0.5 * pull * np.cos(y[..., PHI])
        f[..., SURFACE] = y[..., LAYER_SHEAR] / self.coupling
        d[..., SURFACE, LAYER_SHEAR] = 1.0 / self.coupling
        f[..., LAYER_SHEAR] = beneath * self.bed * y[..., SURFACE] - pull
        d[..., LAYER_SHEAR, :] = -d_pull
        d[..., LAYER_SHEAR, SURFACE] += beneath * self.bed
        return f, d

    def energy(self, y: np.ndarray, on: np.ndarray) -> np.ndarray:
        """Strain energy per unit length (...,) of strip and layer, in units of EI / h^2."""
        layer = on[..., 2] * self.bed * y[..., SURFACE] ** 2 + y[..., LAYER_SHEAR] ** 2 / self.coupling
        return self.arm.energy(y[..., :SURFACE], on) + 0.5 * layer

    def decay(self, on: np.ndarray, force: float) -> float:
        """Largest rate r of the solutions exp(r x) on the foundation ``on`` (3,) under the section force ``force``."""
        roots = np.linalg.eigvals(self.linear().rates(np.zeros(6), on)[1])
        return float(np.sqrt(max(np.abs(roots).max() ** 2, abs(force) if self.arm.finite else 0.0)))
