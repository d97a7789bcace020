"""The four-point end-notched flexure test."""

from __future__ import annotations

from typing import Literal

from pydantic import ValidationInfo, field_validator

from verify.scene.specimens.delamination import Load, Ratio, Support
from verify.scene.specimens.two_arms import OnRollers
from verify.scene.tables import Positive, refuse


class FourPointEnf(OnRollers):
    """Four-point bending of two arms, half of the load at the distance ``offset`` from each support."""

    ratios = (*OnRollers.ratios, Ratio("offset", 1e-6, 0.5, "length"))
    example = "4enf"
    sentence = (
        "An end-notched flexure specimen of {arm_thickness} thick arms on supports {length} apart, with a precrack of "
        "{precrack}, is pressed down at two places, {offset} from the supports"
    )

    kind: Literal["4enf"]
    """Four-point bending of two arms, whose bond slides under a bending moment that stays the same."""
    offset: Positive
    """From a load to the nearer support [length]; less than half the length."""

    @field_validator("offset")
    @classmethod
    def _two_places(cls, offset: float, info: ValidationInfo) -> float:
        length = info.data.get("length")
        if length is not None and offset >= length / 2:
            raise refuse(f"< specimen.length / 2 = {length / 2:g}", ((), offset))
        return offset

    @property
    def loads(self) -> tuple[Load, ...]:
        return self.pushed(self.offset, -0.5), self.pushed(self.length - self.offset, -0.5)

    @property
    def supports(self) -> tuple[Support, ...]:
        return self.ends_carried
