"""The length of the process zone, from the material and from how the arms bend, before anything is solved.

A mesh with fewer than three elements in the zone overestimates the strength, and its curve snaps back at every element
(Turon, Davila, Camanho, Costa 2007; Harper and Hallett 2008). The length has two limits. In a *bulky* body it is
``l = M E' G_Ic / p_max^2`` of the material, with M = 1 (Hillerborg, Modeer, Petersson 1976; factors in use go from 0.2
to 1, Turon et al. 2007, table 1). In a *slender* one the arms bend out of the way first, and
``l = M (E' G_Ic / p_max^2)^(1/4) h^(3/4)`` (Williams and Hadavinia 2002; Yang and Cox 2005). An arm that is neither
yields in both ways, and its zone is shorter than either: 0.52 mm where they are 1.43 and 1.08 in alfano-crisfield.
``1 / l = 1 / l_slender + 1 / l_bulky`` is no more than a choice that comes to both limits; the zones that were measured
are 0.84 to 1.16 of it, but 0.48 to 1.14 of the smaller limit.
"""

from __future__ import annotations

import numpy as np
from numpy import cos, cosh, sin, sinh
from scipy.optimize import brentq

from verify.scene.materials import Material, elastic_constants
from verify.scene.schema import Scene

#: First root of cosh(x) cos(x) = -1, that of a cantilever's first mode.
CANTILEVER = 1.8751040687119611


def bulk_length(scene: Scene) -> float:
    """``E' G_Ic / p_max^2`` of the softer body."""
    law, specimen = scene.interface, scene.specimen
    return min(crack_modulus(body, specimen.plane) for body, _ in _bodies(scene)) * law.toughness / law.strength**2


def slender_length(scene: Scene) -> float:
    """``l = x (E I (g_u - g_max) / p_max)^(1/4)`` with x of `slender_factor`, all per unit width.

    ``1 / E I`` is the sum over the bodies that bend: both arms of a dcb, the strip of a peel. For a traction that drops
    from the start (ductility without bound) it is ``1.0075 (E' G_Ic / p_max^2)^(1/4) h^(3/4)`` in a dcb.
    """
    law, plane, bending = scene.interface, scene.specimen.plane, _bodies(scene)[: scene.specimen.arms]
    softness = sum(12.0 / (bending_modulus(body, plane) * height**3) for body, height in bending)
    g_u = 2.0 * law.toughness / law.strength
    return slender_factor(law.ductility) * (g_u * (1.0 - 1.0 / law.ductility) / (law.strength * softness)) ** 0.25


def slender_factor(ductility: float) -> float:
    """Length x of the softening part in ``xi = X (p_max / (E I (g_u - g_max)))^(1/4)``, from the beam on its law.

    With phi = 1 - g/g_u the softening part is ``phi'''' = phi``, from xi = 0 (g = g_max), where it joins the decaying
    solution on the elastic part, to xi = x (g = g_u), where a moment but no shear force comes from the far load: two
    conditions for x and for the one free constant there. Ductility to infinity: cosh x cos x = -1.
    """
    m, k = 1.0 / ductility, ((ductility - 1.0) / 4.0) ** 0.25  # on the elastic part g'''' = -4 k^4 g
    fixed = np.array([1.0 - m, -k * m, 0.0, 2.0 * k**3 * m])  # phi and its derivatives at 0
    free = np.array([0.0, -k, -2.0 * k**2, -2.0 * k**3])

    def mismatch(x: np.ndarray) -> np.ndarray:
        K = 0.5 * np.array([cosh(x) + cos(x), sinh(x) + sin(x), cosh(x) - cos(x), sinh(x) - sin(x)])  # phi(x)
        K_shear = K[[1, 2, 3, 0]]  # phi'''(x)
        return (fixed @ K) * (free @ K_shear) - (fixed @ K_shear) * (free @ K)

    grid = np.geomspace(1e-9, 1.01 * CANTILEVER, 400)
    end = int(np.argmax(mismatch(grid) > 0.0))
    return float(brentq(mismatch, grid[end - 1], grid[end], rtol=1e-12))


def bending_modulus(material: Material, plane: str) -> float:
    """Modulus of stretching along the specimen, E1 or its plane-strain value."""
    return 1.0 / float(_compliance(material, plane)[0, 0])


def across_modulus(material: Material, plane: str) -> float:
    """Modulus of stretching across the specimen, E2 or its plane-strain value."""
    return 1.0 / float(_compliance(material, plane)[1, 1])


def poisson(material: Material, plane: str) -> float:
    """Contraction across the specimen over the stretch along it, nu12 or its plane-strain value."""
    a = _compliance(material, plane)
    return -float(a[0, 1] / a[0, 0])


def crack_modulus(material: Material, plane: str) -> float:
    """E' of G = K^2 / E' for a crack along axis 1 of an orthotropic solid (Sih, Paris, Irwin 1965)."""
    a = _compliance(material, plane)
    bracket = (a[1, 1] / a[0, 0]) ** 0.5 + (2.0 * a[0, 1] + a[2, 2]) / (2.0 * a[0, 0])
    return 1.0 / float((0.5 * a[0, 0] * a[1, 1]) ** 0.5 * bracket**0.5)


def _bodies(scene: Scene) -> tuple[tuple[Material, float], ...]:
    """Material and thickness of both bodies, those that bend away from the interface first."""
    return tuple(zip(scene.materials, scene.specimen.thicknesses, strict=True))


def _compliance(material: Material, plane: str) -> np.ndarray:
    """In-plane compliance (3, 3), Voigt order."""
    from iga.elements.elasticity import orthotropic

    return np.linalg.inv(orthotropic(**elastic_constants(material), plane=plane))
