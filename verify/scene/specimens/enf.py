"""The end-notched flexure test."""

from __future__ import annotations

from typing import Literal

from verify.scene.specimens.delamination import Load, Support
from verify.scene.specimens.two_arms import OnRollers


class Enf(OnRollers):
    """Three-point bending of two arms with a precrack at the left support, pressed down at mid-span."""

    sentence = (
        "An end-notched flexure specimen of {arm_thickness} thick arms on supports {length} apart, with a precrack of "
        "{precrack}, is pressed down at mid-span"
    )

    kind: Literal["enf"]
    """Three-point bending of two arms, whose bond slides."""

    @property
    def loads(self) -> tuple[Load, ...]:
        return (self.pushed(self.length / 2, -1.0),)

    @property
    def supports(self) -> tuple[Support, ...]:
        return self.ends_carried
