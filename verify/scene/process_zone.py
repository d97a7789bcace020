"""Estimate of the length of the process zone before a run, from material and bending of the arms.

A mesh with fewer than three elements in the zone overestimates the strength, and its curve snaps back at every element
(Turon, Davila, Camanho, Costa 2007; Harper and Hallett 2008). The length has two limits. In a *bulky* body it is
``l = M E' G_Ic / p_max^2`` of the material, with M = 1 (Hillerborg, Modeer, Petersson 1976; factors in use go from 0.2
to 1, Turon et al. 2007, table 1). In a *slender* one the bending of the arms determines the length,
``l = M (E' G_Ic / p_max^2)^(1/4) h^(3/4)`` (Williams and Hadavinia 2002; Yang and Cox 2005). An arm between the limits
deforms in both ways, and its zone is shorter than either length: 0.52 mm against 1.43 and 1.08 mm in alfano-crisfield.
``1 / l = 1 / l_slender + 1 / l_bulky`` is an interpolation with both limits; measured zones are 0.84 to 1.16 of it, but
0.48 to 1.14 of the smaller limit.

A bond that slides has ``l = E'_II G_IIc / t_max^2`` in a bulky body, and ``(E' h G_IIc / t_max^2)^(1/2)`` times a
number in a slender one (Yang and Cox 2005; Harper and Hallett 2008, Eng. Fract. Mech. 75). For mixed modes the
inverse of each limit is interpolated between opening and sliding, with the mode ratio of beam theory: 0.82 to 0.91 of
that was measured on mixed-mode bending and single-leg specimens, 0.71 to 0.81 of a linear interpolation of lengths.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import numpy as np
from numpy import cos, cosh, sin, sinh

from verify.scene.materials import Material, axial_modulus, plane_compliance
from verify.scene.schema import Scene
from verify.scene.specimens.bending import mode_ratios

#: First root of cosh(x) cos(x) = -1, that of a cantilever's first mode.
CANTILEVER = 1.8751040687119611


def zone_length(scene: Scene) -> float:
    """Length of the process zone of a scene, from both limits."""
    return between(slender_length(scene), bulk_length(scene))


def between(slender: float, bulk: float) -> float:
    """Length between both limits, shorter than either."""
    return 1.0 / (1.0 / slender + 1.0 / bulk)


def bulk_length(scene: Scene) -> float:
    """``E' G_c / strength^2`` of the softer body, for the expected mode ratio."""
    law, plane = scene.interface, scene.specimen.plane

    def length(sliding: bool, toughness: float, strength: float) -> float:
        return min(crack_modulus(body, plane, sliding) for body, _ in _bodies(scene)) * toughness / strength**2

    return _of_mode(scene, length(False, law.toughness, law.strength), lambda: length(True, *_shear(scene)))


def slender_length(scene: Scene) -> float:
    """`opening_length`, or where the bond slides a value between it and `sliding_length` by the expected mode ratio."""
    return _of_mode(scene, opening_length(scene), lambda: sliding_length(scene))


def steepness(scene: Scene) -> float:
    """How steeply the traction falls where the bond fails, over a straight line with as much toughness; at least 1.

    Errors of the load curve grow with it: with cubic splines and 3.6 to 5 elements in the zone of a dcb they were 2.6
    to 3.6 times those of straight softening for a plateau of 0.4 (2.3 here), 9 to 10 times for one of 0.8 (9), and 0.6
    to 1.3 times for exponential softening (1). More elements by its square root resolve it, as the length of the fall
    in `sliding_length` says.
    """
    from verify.scene.bond.bond import bond_of
    from verify.theory.shapes import KNOWN_SHAPES

    shape = KNOWN_SHAPES.get(scene.interface.law)
    bond = bond_of(scene, {"shear": False, "contact": True, "irreversible": True})
    return 1.0 if shape is None else shape(bond).at_failure


def _of_mode(scene: Scene, opening: float, sliding: Callable[[], float]) -> float:
    """Harmonic interpolation between the lengths of opening and of sliding, by the expected mode ratio; the shorter one
    of both ways in which the programme bends the arms."""
    if not scene.specimen.slides:
        return opening
    return min(1.0 / ((1.0 - B) / opening + B / sliding()) for B in mode_ratios(scene))


def sliding_length(scene: Scene) -> float:
    """``l = atan((d - 1)^(1/2)) / w`` with ``w^2 = b t_max / (s_u - s_0)`` and ``d = s_u / s_0``, all per unit width.

    A shear traction t bends and stretches two arms, which slide by ``s'' = b t``, ``b = 4/(E_1 h_1) + 4/(E_2 h_2)``. On
    the softening line from t_max at s_0 to 0 at s_u this is ``phi'' = -w^2 phi`` for ``phi = s_u - s``; it joins the
    decaying solution on the elastic part. For an infinite initial stiffness (d to infinity) and equal arms the length
    is ``pi/4 (E h G_IIc / t_max^2)^(1/2)``.
    """
    law = scene.interface
    toughness, strength = _shear(scene)
    s_u, s_0 = 2.0 * toughness / strength, strength / (law.shear_stiffness or 1.0)
    drop = max(s_u - s_0, np.finfo(float).eps * s_u)
    return float(np.arctan(np.sqrt(drop / s_0)) * np.sqrt(drop / (_softness(scene) * strength)))


def fading_length(scene: Scene) -> float:
    """Length over which the slip on an intact bond falls to 1 / e: ``(b K_s)^(-1/2)``, see `sliding_length`."""
    return float((_softness(scene) * (scene.interface.shear_stiffness or 1.0)) ** -0.5)


def _softness(scene: Scene) -> float:
    """``b = 4/(E_1 h_1) + 4/(E_2 h_2)`` of arms that slide by ``s'' = b t``."""
    plane = scene.specimen.plane
    return sum(4.0 / (axial_modulus(body, plane) * height) for body, height in _bodies(scene))


def _shear(scene: Scene) -> tuple[float, float]:
    """Toughness and strength of sliding, which a scene must have for a specimen that slides."""
    law = scene.interface
    assert law.shear_toughness is not None and law.shear_strength is not None
    return law.shear_toughness, law.shear_strength


def opening_length(scene: Scene) -> float:
    """``l = x (E I (g_u - g_max) / p_max)^(1/4)`` with x of `slender_factor`, all per unit width.

    ``1 / E I`` is the sum over the bodies that bend: both arms of a dcb, the strip of a peel. For an infinite initial
    stiffness (infinite ductility) it is ``1.0075 (E' G_Ic / p_max^2)^(1/4) h^(3/4)`` in a dcb.
    """
    law, plane, bending = scene.interface, scene.specimen.plane, _bodies(scene)[: scene.specimen.arms]
    softness = sum(12.0 / (axial_modulus(body, plane) * height**3) for body, height in bending)
    g_u = 2.0 * law.toughness / law.strength
    return slender_factor(law.ductility) * (g_u * (1.0 - 1.0 / law.ductility) / (law.strength * softness)) ** 0.25


@cache
def slender_factor(ductility: float) -> float:
    """Length x of the softening part in ``xi = X (p_max / (E I (g_u - g_max)))^(1/4)``, from the beam on its law.

    With phi = 1 - g/g_u the softening part is ``phi'''' = phi``. At xi = 0 (g = g_max) it joins the decaying solution
    on the elastic part; at xi = x (g = g_u) the far load causes a moment but no shear force. These are two conditions
    for x and the one free constant. For infinite ductility: cosh x cos x = -1.
    """
    m, k = 1.0 / ductility, ((ductility - 1.0) / 4.0) ** 0.25  # on the elastic part g'''' = -4 k^4 g
    fixed = np.array([1.0 - m, -k * m, 0.0, 2.0 * k**3 * m])  # phi and its derivatives at 0
    free = np.array([0.0, -k, -2.0 * k**2, -2.0 * k**3])

    def mismatch(x: np.ndarray) -> np.ndarray:
        K = 0.5 * np.array([cosh(x) + cos(x), sinh(x) + sin(x), cosh(x) - cos(x), sinh(x) - sin(x)])  # phi(x)
        K_shear = K[[1, 2, 3, 0]]  # phi'''(x)
        return (fixed @ K) * (free @ K_shear) - (fixed @ K_shear) * (free @ K)

    grid = np.geomspace(1e-9, 1.01 * CANTILEVER, 400)
    for _ in range(6):  # down to rounding; SciPy's root finders would take most of the start of a short run
        end = max(int(np.argmax(mismatch(grid) > 0.0)), 1)
        grid = np.linspace(grid[end - 1], grid[end], 400)
    return float(grid[-1])


def across_modulus(material: Material, plane: str) -> float:
    """Modulus of stretching across the specimen, E2 or its plane-strain value."""
    return 1.0 / float(plane_compliance(material, plane)[1, 1])


def confined_modulus(material: Material, plane: str) -> float:
    """Larger modulus of stretching along or across the specimen where it cannot contract in the other direction.

    Of an isotropic solid in plane strain ``E (1 - nu) / ((1 + nu) (1 - 2 nu))``, which has no bound as nu goes to 1/2.
    """
    return float(np.max(np.diag(np.linalg.inv(plane_compliance(material, plane)))[:2]))


def poisson(material: Material, plane: str) -> float:
    """Contraction across the specimen over the stretch along it, nu12 or its plane-strain value."""
    a = plane_compliance(material, plane)
    return -float(a[0, 1] / a[0, 0])


def crack_modulus(material: Material, plane: str, sliding: bool = False) -> float:
    """E' of G = K^2 / E' for a crack along axis 1 of an orthotropic solid, in mode I or II (Sih, Paris, Irwin 1965)."""
    a = plane_compliance(material, plane)
    bracket = (a[1, 1] / a[0, 0]) ** 0.5 + (2.0 * a[0, 1] + a[2, 2]) / (2.0 * a[0, 0])
    across = a[0, 0] if sliding else a[1, 1]
    return 1.0 / float((0.5 * a[0, 0] * across) ** 0.5 * bracket**0.5)


def _bodies(scene: Scene) -> tuple[tuple[Material, float], ...]:
    """Material and thickness of both bodies, those that bend away from the interface first."""
    return tuple(zip(scene.materials, scene.specimen.thicknesses, strict=True))
