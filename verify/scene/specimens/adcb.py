"""The asymmetric double cantilever beam."""

from __future__ import annotations

from typing import ClassVar, Literal

from verify.scene.specimens.delamination import PULLED_APART, Load, Support
from verify.scene.specimens.two_arms import TwoArms


class Adcb(TwoArms):
    """Two arms that differ, pulled apart at X = 0: the bond opens and slides."""

    loads: ClassVar[tuple[Load, ...]] = PULLED_APART
    supports: ClassVar[tuple[Support, ...]] = ()
    example = "adcb-czmtestkit-a"
    sentence = (
        "A double cantilever beam of arms that differ, {length} long and {arm_thickness} thick, with a precrack of "
        "{precrack}, is opened"
    )

    kind: Literal["adcb"]
    """Two arms that may differ, pulled apart at X = 0, whose bond opens and slides."""
