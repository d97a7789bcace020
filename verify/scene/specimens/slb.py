"""The single-leg bending test."""

from __future__ import annotations

from typing import Literal

from verify.scene.specimens.delamination import Load, Support
from verify.scene.specimens.two_arms import OnRollers


class Slb(OnRollers):
    """Three-point bending of two arms; on the left only the upper one is supported, the lower one hangs free."""

    example = "slb"
    sentence = (
        "A single-leg bending specimen of {arm_thickness} thick arms on supports {length} apart, with a precrack of "
        "{precrack}, is pressed down at mid-span"
    )

    kind: Literal["slb"]
    """Three-point bending in which the upper arm alone is carried at the cracked end."""

    @property
    def loads(self) -> tuple[Load, ...]:
        return (self.pushed(self.length / 2, -1.0),)

    @property
    def supports(self) -> tuple[Support, ...]:
        return self.carried(0, 0.0), self.carried(1, self.length)
