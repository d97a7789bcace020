"""Two arms of one length whose bond slides, and may differ: the specimens without rollers."""

from __future__ import annotations

from typing import Annotated, ClassVar, Literal, TypeAlias

from pydantic import BeforeValidator, Field, field_validator

from verify.scene.specimens.delamination import PULLED_APART, Arms, Files, Load, Ratio, Support
from verify.scene.tables import Positive, as_pair, as_two, refuse

Both: TypeAlias = Annotated[tuple[Positive, Positive], BeforeValidator(as_pair)]

#: The far end of both arms as one, held against deflection and rotation.
GUIDED = Support(None, "right"), Support(None, "right", couple=True)


class TwoArms(Arms):
    """Two arms from X = 0 to the end of the overhang on the right, bonded from the precrack on.

    Distances count from ``start``: the left support, or X = 0 where there is none.
    """

    slides = True
    example: ClassVar[str] = "enf-as4peek"
    arm_thickness: Both
    """Of one arm, or of the upper and the lower one [length], like [1.5, 5.1]."""
    mesh: Files = Field(default=(), max_length=1, description="a file name, or a list of two")
    """One .msh, .inp, .vtu, .e or .med file of both arms for lagrange and dolfinx; none: a mesh is made."""

    @field_validator("mesh")
    @classmethod
    def _of_elements(cls, mesh: Files) -> Files:
        if any(name.lower().endswith(".iga") for name in mesh):
            raise refuse("a .msh, .inp, .vtu, .e or .med file of both arms", ((), list(mesh)))
        return mesh

    @property
    def start(self) -> float:
        """Coordinate X from which lengths count."""
        return 0.0

    @property
    def thicknesses(self) -> tuple[float, float]:
        return self.arm_thickness

    @property
    def tip(self) -> float:
        return self.start + self.precrack

    @property
    def loaded_at(self) -> float:
        return self.start

    @property
    def extent(self) -> float:
        return self.lengths[0] - self.start

    @property
    def most(self) -> tuple[tuple[float, str], tuple[float, str]]:
        """The deflection of every load is less than the length, its rotation less than half a turn."""
        couples = all(load.couple for load in self.loads)
        size = (3.0 if couples else self.length) * sum(abs(load.share) for load in self.loads)
        why = "3 radians" if couples else "length"
        return (-size, f"-{why} for every load"), (size, f"{why} for every load")


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


class Els(TwoArms):
    """The end-loaded split test: pressed down at the cracked end; the far end is held against deflection and
    rotation."""

    supports: ClassVar[tuple[Support, ...]] = GUIDED
    ratios = (*TwoArms.ratios, Ratio("roller", 0.0, 0.25, "length"))
    sentence = (
        "An end-loaded split specimen with arms of {length} by {arm_thickness} and a precrack of {precrack}, held at "
        "the far end, is pressed down at the cracked one"
    )

    kind: Literal["els"]
    """Two arms held at the far end and pressed down at the cracked one, whose bond slides."""
    roller: float | None = Field(default=None, gt=0, examples=[0.5])
    """Length of the patch at X = 0 on which the load acts [length]; left out: half the thickness of the upper arm."""

    @property
    def loads(self) -> tuple[Load, ...]:
        end = self.arm_thickness[0] / 2 if self.roller is None else self.roller
        return (Load(0, "top", -1.0, (0.0, min(end, self.length))),)


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
