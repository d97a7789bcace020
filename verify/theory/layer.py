"""The elastic layer under a peeled strip, reduced to a two-parameter foundation: pressure = k w - g w''.

The reduction is exact for one wave number. The surface of an infinite layer of thickness t, clamped at its base, moves
by p cos(q x) / K(q) under the pressure p cos(q x) without shear; K follows from four linear equations across the
thickness. The two parameters are those of the tangent of K over q^2 at the wave number of the strip, K = k + g q^2. For
long waves (q t -> 0) the layer is that of Winkler, k = C22 / t. Vlasov and Leont'ev (1966) suppress displacements along
the layer, which gives k = C22 / t and g = C66 t / 3, four times too much shear coupling at nu = 0.2.

Neglected: an edge of the substrate relaxes like the foundation, not like a corner, and other wave numbers than q see
the tangent only (isotropic, nu = 0.2: error within 4 % for q t up to 6).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import expm

#: Least shear coupling as a part of k / (1/t^2 + q^2): for a layer that hardly contracts along its length the tangent
#: gives a negative coupling, with which the foundation would be unstable.
LEAST_COUPLING = 0.01


@dataclass(frozen=True)
class Layer:
    """A substrate clamped at its base: ``length`` from the far end of the bond, ``thickness``, and its stiffnesses
    ``C11``, ``C12``, ``C22``, ``C66`` in the plane, axis 1 along it."""

    length: float
    thickness: float
    C11: float
    C12: float
    C22: float
    C66: float

    @classmethod
    def of(
        cls,
        size: tuple[float, float],
        E1: float,
        E2: float,
        G12: float,
        nu12: float,
        plane: str = "stress",
        nu23: float | None = None,
    ) -> Layer:
        """From (length, thickness) and elastic constants; in plane strain E3 = E2, nu13 = nu12, as nu23 if left out.

        Plane strain reduces the compliances 1 / E1, -nu12 / E1 and 1 / E2 by the effect of the stress across the plane.
        """
        nu23, across = nu12 if nu23 is None else nu23, E2 if plane == "strain" else 0.0
        s11 = 1.0 / E1 - across * (nu12 / E1) ** 2
        s12 = -nu12 / E1 - across * nu12 * nu23 / (E1 * E2)
        s22 = 1.0 / E2 - across * (nu23 / E2) ** 2
        rest = s11 * s22 - s12**2
        return cls(*size, s22 / rest, -s12 / rest, s11 / rest, G12)

    def stiffness(self, q: complex) -> complex:
        """Pressure over deflection K [force per volume] at the wave number ``q`` > 0 [1 / length]."""
        c11, c12, c66 = (c / self.C22 for c in (self.C11, self.C12, self.C66))
        across = np.array(  # of u sin, v cos, shear sin, stress cos; stresses over C22 q, depth over 1 / q
            [[0.0, 1.0, 1.0 / c66, 0.0], [-c12, 0.0, 0.0, 1.0], [c11 - c12**2, 0.0, 0.0, c12], [0.0, 0.0, -1.0, 0.0]]
        )
        depth = q * self.thickness
        growth = abs(depth) * np.max(np.abs(np.linalg.eigvals(across)))  # exponent of the fastest growing wave
        halvings = max(0, int(np.ceil(np.log2(growth))))
        surface = _stiffness_of_surface(expm(across * (depth / 2**halvings)), halvings)
        free = surface[1, 1] - surface[1, 0] * surface[0, 1] / surface[0, 0]  # no shear at the surface
        return self.C22 * q * free

    def parameters(self, q: float) -> tuple[float, float]:
        """k [force per volume] and g [force per length] of the tangent at ``q``, by the complex step."""
        step = 1e-20 * q
        K, rate = self.stiffness(complex(q)).real, self.stiffness(q + 1j * step).imag / step / (2.0 * q)
        g = max(rate, LEAST_COUPLING * K / (self.thickness**-2 + q**2))
        return K - g * q**2, g

    def beneath(self, bending: float, stiffness: float) -> tuple[float, float]:
        """k and g under a strip of bending stiffness ``bending`` = E I / w on an interface of ``stiffness`` in series.

        The strip's wave number is that of ``E I v'''' + K v = 0``, (K / (E I / w))^(1/4), with Winkler's K.
        """
        winkler = self.C22 / self.thickness
        return self.parameters((1.0 / (1.0 / winkler + 1.0 / stiffness) / bending) ** 0.25)


def _stiffness_of_surface(transfer: np.ndarray, doublings: int) -> np.ndarray:
    """Tractions at the surface by its displacements, shape (2, 2), of 2^``doublings`` equal sheets on a clamped base.

    ``transfer`` (4, 4) takes displacements and tractions through one sheet. In transfer matrices of thick layers
    rounding of the growing waves hides the decaying ones; stiffnesses of sheets tied at a common face lose no digits.
    """
    b = np.linalg.inv(transfer[:2, 2:])
    a = -b @ transfer[:2, :2]  # with b: tractions at the lower face, by displacements of the lower and the upper one
    c, d = transfer[2:, :2] + transfer[2:, 2:] @ a, transfer[2:, 2:] @ b  # at the upper face
    for _ in range(doublings):
        middle = np.linalg.inv(d - a)
        a, b, c, d = a - b @ middle @ c, b @ middle @ b, -c @ middle @ c, d + c @ middle @ b
    return d
