"""The end-loaded split test."""

from __future__ import annotations

from typing import ClassVar, Literal

from pydantic import Field, ValidationInfo, field_validator

from verify.scene.specimens.delamination import Load, Support
from verify.scene.specimens.two_arms import GUIDED, TwoArms
from verify.scene.tables import refuse


class Els(TwoArms):
    """Two arms pressed down at the cracked end; the far end is held against deflection and rotation."""

    supports: ClassVar[tuple[Support, ...]] = GUIDED
    sentence = (
        "An end-loaded split specimen with arms of {length} by {arm_thickness} and a precrack of {precrack}, held at "
        "the far end, is pressed down at the cracked one"
    )

    kind: Literal["els"]
    """Two arms held at the far end and pressed down at the cracked one, whose bond slides."""
    roller: float | None = Field(default=None, gt=0, examples=[0.5])
    """Length of the patch at X = 0 on which the load acts [length]; left out: half the thickness of the upper arm."""

    @field_validator("roller")
    @classmethod
    def _on_the_specimen(cls, roller: float | None, info: ValidationInfo) -> float | None:
        length = info.data.get("length")
        if roller is not None and length is not None and roller > length / 4:
            raise refuse(f"<= specimen.length / 4 = {length / 4:g}", ((), roller))
        return roller

    @property
    def loads(self) -> tuple[Load, ...]:
        end = self.arm_thickness[0] / 2 if self.roller is None else self.roller
        return (Load(0, "top", -1.0, (0.0, min(end, self.length))),)
