"""The double cantilever beam."""

from __future__ import annotations

from typing import ClassVar, Literal

from pydantic import Field

from verify.scene.specimens.delamination import PULLED_APART, Arms, Files, Load, Support
from verify.scene.tables import Positive


class Dcb(Arms):
    """Two arms, bonded on X in [precrack, length], loaded at X = 0.

    ``mesh``: `.iga` files of the upper and the lower arm for T-splines; with one file the lower arm is its mirror
    image. Or one file with both arms for lagrange and dolfinx, in a format of `verify.meshes.read`.
    """

    loads: ClassVar[tuple[Load, ...]] = PULLED_APART
    supports: ClassVar[tuple[Support, ...]] = ()
    pressed = 1, "-arm_thickness, at which both loaded faces would be in one place"
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
    mesh: Files = Field(default=(), max_length=2, description="a file name, or a list of two")
    """One .msh, .inp, .vtu, .e or .med file of both arms for lagrange and dolfinx; or `.iga` files of the upper and the
    lower arm for tspline, one stands for both; none: a mesh is made."""
