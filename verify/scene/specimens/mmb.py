"""The mixed-mode bending test."""

from __future__ import annotations

from typing import Literal

from verify.scene.specimens.delamination import Load, Ratio, Support
from verify.scene.specimens.two_arms import OnRollers
from verify.scene.tables import Positive


class Mmb(OnRollers):
    """Three-point bending and opening in one: a lever presses the middle down and pulls the upper arm up.

    The load P acts on the lever at the distance ``lever`` = c from mid-span, L half the length: P c / L upwards on the
    left end of the upper arm, P (c + L) / L downwards at mid-span (Reeder and Crews 1990, AIAA J. 28).
    """

    ratios = (*OnRollers.ratios, Ratio("lever", 1e-6, 1e3, "length"))
    example = "mmb50-as4peek"
    sentence = (
        "A mixed-mode bending specimen of {arm_thickness} thick arms on supports {length} apart, with a precrack of "
        "{precrack}, is loaded by a lever of {lever}"
    )

    kind: Literal["mmb"]
    """Two arms that a lever pulls apart at the end and presses down at mid-span."""
    lever: Positive
    """From the load on the lever to mid-span [length]."""

    @property
    def loads(self) -> tuple[Load, ...]:
        up = 2 * self.lever / self.length
        return self.pushed(0.0, up), self.pushed(self.length / 2, -1.0 - up)

    @property
    def supports(self) -> tuple[Support, ...]:
        return self.ends_carried
