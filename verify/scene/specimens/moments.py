"""Two arms bent by end moments."""

from __future__ import annotations

from typing import Annotated, ClassVar, Literal

from pydantic import BeforeValidator, field_validator

from verify.scene.specimens.delamination import Load, Support
from verify.scene.specimens.two_arms import GUIDED, TwoArms
from verify.scene.tables import as_two, refuse


class Moments(TwoArms):
    """Two arms bent by couples on their end faces at X = 0; the far end is held against deflection and rotation.

    A moment that bends its arm upwards is clockwise on the face at X = 0, but a couple of a `Load` counts
    anticlockwise: the signs differ (Soerensen, Joergensen, Jacobsen and Oestergaard 2006, Int. J. Fract. 141: a DCB
    with uneven bending moments).
    """

    supports: ClassVar[tuple[Support, ...]] = GUIDED
    example = "moments"
    sentence = (
        "Two arms of {length} by {arm_thickness} with a precrack of {precrack}, held at the far end, are bent by end "
        "moments of {moments} for a load of 1"
    )

    kind: Literal["moments"]
    """Two arms bent by end moments: the J-integral is known from the load alone."""
    moments: Annotated[tuple[float, float], BeforeValidator(as_two)]
    """Moments on the upper and the lower arm for a load of 1, above 0 where they bend it upwards: [1, -1] opens the
    bond, [1, 1] makes it slide."""

    @field_validator("moments")
    @classmethod
    def _bends_something(cls, moments: tuple[float, float]) -> tuple[float, float]:
        if not any(moments):
            raise refuse("different from 0, one at least", ((), list(moments)))
        return moments

    @property
    def loads(self) -> tuple[Load, ...]:
        return tuple(Load(body, "left", -share, couple=True) for body, share in enumerate(self.moments) if share)
