"""The peel test."""

from __future__ import annotations

from typing import ClassVar, Literal

from pydantic import Field, field_validator

from verify.scene.specimens.delamination import Clamp, Delamination, Files, Load, Plane, Ratio, Support
from verify.scene.tables import Positive, refuse


class Peel(Delamination):
    """A strip peeled off a substrate: left ends flush at X = 0, bonded on X in [0, bond_length], strip pulled up at its
    right end, substrate clamped at its base."""

    materials = ("strip", "substrate")
    bodies = ("strip", "substrate")
    body = "strip"
    length_keys = ("strip_length", "substrate_length")
    thickness_keys = ("strip_thickness", "substrate_thickness")
    tip_key, bond_key = "bond_length", "bond_length"
    loads: ClassVar[tuple[Load, ...]] = (Load(0, "right", 1.0),)
    supports: ClassVar[tuple[Support, ...]] = ()
    clamps = (Clamp(1, "bottom"),)
    pressed = 2, "-2 strip_thickness"
    ratios = (
        Ratio("strip_thickness", 1e-6, 1e3, "strip_length"),
        Ratio("substrate_thickness", 1e-6, 1e3, "substrate_length"),
        Ratio("bond_length", 1e-6, 0.999999, "strip_length"),
        Ratio("bond_length", 0.0, 1.0, "substrate_length"),
        Ratio("width", 1e-9, 1e9, "strip_length"),
        Ratio("substrate_length", 1e-6, 1e6, "strip_length"),
    )
    example = "peel-60"
    sentence = (
        "A strip of {strip_length} by {strip_thickness}, bonded over {bond_length} to a clamped substrate of "
        "{substrate_length} by {substrate_thickness}, is peeled off by lifting its free end"
    )

    kind: Literal["peel"]
    """A strip peeled off a substrate that is fixed at its base, pulled up at its free end."""
    strip_length: Positive
    """The strip begins above the end of the substrate at X = 0 [length]."""
    strip_thickness: Positive
    """Of the strip [length]."""
    substrate_length: Positive
    """Of the substrate [length]."""
    substrate_thickness: Positive
    """Of the substrate [length]."""
    bond_length: Positive
    """From X = 0 on [length]; less than the strip, at most the substrate."""
    width: Positive = 1.0
    """Out of the plane [length]."""
    plane: Plane = "stress"
    """Plane stress or plane strain."""
    mesh: Files = Field(default=(), description="a file name, or a list of two")
    """`.iga` files of strip and substrate for tspline; none: meshes are made."""

    @field_validator("mesh")
    @classmethod
    def _both_meshes(cls, mesh: tuple[str, ...]) -> tuple[str, ...]:
        if len(mesh) not in (0, 2):
            raise refuse("two files, of strip and substrate", ((), list(mesh)))
        return mesh
