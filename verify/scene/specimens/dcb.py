"""The double cantilever beam."""

from __future__ import annotations

from typing import ClassVar, Literal

from pydantic import Field, ValidationInfo, field_validator

from verify.scene.specimens.delamination import PULLED_APART, Delamination, Files, Groups, Load, Plane, Ratio, Support
from verify.scene.tables import Positive, refuse


class Dcb(Delamination):
    """Two arms, bonded on X in [precrack, length], loaded at X = 0.

    ``mesh``: `.iga` files of the upper and the lower arm for T-splines; with one file the lower arm is its mirror
    image. Or one file with both arms for lagrange and dolfinx, in a format of `verify.meshes.read`.
    """

    loads: ClassVar[tuple[Load, ...]] = PULLED_APART
    supports: ClassVar[tuple[Support, ...]] = ()
    length_keys, thickness_keys = ("length", "length"), ("arm_thickness", "arm_thickness")
    tip_key, bond_key = "precrack", "length"
    pressed = 1, "-arm_thickness, at which both loaded faces would be in one place"
    ratios = (
        Ratio("arm_thickness", 1e-6, 1e3, "length"),
        Ratio("precrack", 1e-6, 0.999999, "length"),
        Ratio("width", 1e-9, 1e9, "length"),
    )
    sentence = (
        "A double cantilever beam with arms of {length} by {arm_thickness} and a precrack of {precrack} is opened"
    )

    kind: Literal["dcb"]
    """Two arms, bonded from the precrack to the far end, pulled apart at X = 0."""
    length: Positive
    """From the loaded end to the far end of the bond [length]."""
    arm_thickness: Positive
    """Of one arm [length]."""
    precrack: Positive
    """From the loaded end to the bond [length]; less than the length."""
    width: Positive = 1.0
    """Out of the plane [length]."""
    plane: Plane = "stress"
    """Plane stress or plane strain."""
    mesh: Files = Field(default=(), max_length=2)
    """One .msh, .inp, .vtu, .e or .med file of both arms for lagrange and dolfinx; or `.iga` files of the upper and the
    lower arm for tspline, one stands for both; none: a mesh is made."""
    groups: Groups = Groups()
    """Names of the groups of the mesh file."""

    @field_validator("precrack")
    @classmethod
    def _bonded_part_is_left(cls, precrack: float, info: ValidationInfo) -> float:
        length = info.data.get("length")
        if length is not None and precrack >= length:
            raise refuse(f"< specimen.length = {length:g}", ((), precrack))
        return precrack
