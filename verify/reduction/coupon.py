"""The specimen of a test in plain numbers."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi

from verify.scene.materials import axial_modulus, elastic_constants
from verify.scene.schema import Scene
from verify.support.refusal import Refusal, one_of
from verify.theory.lefm import chi

#: Kinds of specimen whose tests are reduced.
REDUCED = ("dcb", "adcb", "enf", "els", "4enf", "slb", "mmb", "peel")


@dataclass(frozen=True)
class Coupon:
    """Two arms, or a strip that is peeled from what does not move.

    Parameters
    ----------
    length : to the far end (dcb, adcb, els, peel), or between the outer supports
    thickness : of the upper and the lower arm
    moduli : of both along them, in plane strain E / (1 - nu^2); ``transverse`` and ``shear`` of the upper one
    lever, offset : of an mmb, of a 4enf
    friction : coefficient of the faces, of the bond of the scene
    angle : of the load of a peel test to the bond
    """

    kind: str
    length: float
    width: float
    thickness: tuple[float, float]
    precrack: float
    moduli: tuple[float, float]
    transverse: float
    shear: float
    lever: float = 0.0
    offset: float = 0.0
    friction: float = 0.0
    angle: float = 0.5 * pi

    @property
    def h(self) -> float:
        """Thickness of the upper arm."""
        return self.thickness[0]

    @property
    def young(self) -> float:
        """Modulus along the upper arm."""
        return self.moduli[0]

    @property
    def stretching(self) -> float:
        """Stiffness E b h of the upper arm along it."""
        return self.young * self.width * self.h

    @property
    def correction(self) -> float:
        """What the rotation at the tip adds to the crack length in opening, chi h (`verify.theory.lefm.chi`)."""
        return chi(self) * sum(self.thickness) / 2.0


def coupon(scene: Scene) -> Coupon:
    """The specimen of a scene.

    Raises
    ------
    Refusal : a kind without data reduction, or arms that differ where its formulas take equal ones.
    """
    body, (upper, lower) = scene.specimen, scene.materials
    if body.kind not in REDUCED:
        raise Refusal(f"specimen.kind: must be {one_of(REDUCED)} for debond reduce, got {body.kind!r}")
    first, second = body.thicknesses
    moduli = axial_modulus(upper, body.plane), axial_modulus(lower, body.plane)
    if body.kind not in ("adcb", "peel") and (first != second or moduli[0] != moduli[1]):
        got = f"{first:g} and {second:g} thick, of {moduli[0]:g} and {moduli[1]:g}"
        raise Refusal(f"specimen.arm_thickness: arms must be alike for the formulas of the kind {body.kind}, got {got}")
    constants, keys = elastic_constants(upper), body.model_dump()
    return Coupon(
        kind=body.kind,
        length=keys.get("length", body.lengths[0]),  # of a peel, that of its strip
        width=body.width,
        thickness=(first, second),
        precrack=body.free_length,
        moduli=moduli,
        transverse=constants["E2"],
        shear=constants["G12"],
        lever=keys.get("lever", 0.0),
        offset=keys.get("offset", 0.0),
        friction=scene.interface.friction,
    )
