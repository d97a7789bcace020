"""Bending tests: two arms on rollers and under rollers, whose bond slides."""

from __future__ import annotations

from typing import Annotated, Literal, TypeAlias

from pydantic import BeforeValidator, Field

from verify.scene.specimens.delamination import Load, Ratio, Support
from verify.scene.specimens.two_arms import TwoArms
from verify.scene.tables import Positive, as_pair

NotNegative: TypeAlias = Annotated[float, Field(ge=0)]


class OnRollers(TwoArms):
    """Two arms with overhangs beyond the outer supports, which carry both ends of the lower arm."""

    ratios = (*TwoArms.ratios, Ratio("roller", 0.0, 0.25, "length"))
    roller: float | None = Field(default=None, gt=0, examples=[0.5])
    """Half the length of the patch on which a roller or a load acts [length]; left out: half the thickness of the arm
    that it touches."""
    overhang: Annotated[tuple[NotNegative, NotNegative], BeforeValidator(as_pair)] = (0.0, 0.0)
    """From the left support to the left end and from the right one to the right end [length]."""

    @property
    def start(self) -> float:
        return self.overhang[0]

    @property
    def lengths(self) -> tuple[float, float]:
        total = sum(self.overhang) + self.length
        return total, total

    def patch(self, body: int, s: float) -> tuple[float, float]:
        """Range of X of a roller on an arm, ``s`` from the left support, cut off at the ends of the specimen."""
        half = self.arm_thickness[body] / 2 if self.roller is None else self.roller
        return max(self.start + s - half, 0.0), min(self.start + s + half, self.lengths[0])

    def pushed(self, s: float, share: float) -> Load:
        """A load on the top, upwards, ``s`` from the left support."""
        return Load(0, "top", share, self.patch(0, s))

    def carried(self, body: int, s: float) -> Support:
        """A support below an arm, ``s`` from the left one."""
        return Support(body, "bottom", self.patch(body, s))

    @property
    def loads(self) -> tuple[Load, ...]:
        """The middle pressed down."""
        return (self.pushed(self.length / 2, -1.0),)

    @property
    def supports(self) -> tuple[Support, ...]:
        return self.carried(1, 0.0), self.carried(1, self.length)


class Enf(OnRollers):
    """The end-notched flexure test: three-point bending with a precrack at the left support."""

    sentence = (
        "An end-notched flexure specimen of {arm_thickness} thick arms on supports {length} apart, with a precrack of "
        "{precrack}, is pressed down at mid-span"
    )

    kind: Literal["enf"]
    """Three-point bending of two arms, whose bond slides."""


class Slb(OnRollers):
    """The single-leg bending test: on the left only the upper arm is supported, the lower one hangs free."""

    example = "slb"
    sentence = (
        "A single-leg bending specimen of {arm_thickness} thick arms on supports {length} apart, with a precrack of "
        "{precrack}, is pressed down at mid-span"
    )

    kind: Literal["slb"]
    """Three-point bending in which the upper arm alone is carried at the cracked end."""

    @property
    def supports(self) -> tuple[Support, ...]:
        return self.carried(0, 0.0), self.carried(1, self.length)


class Mmb(OnRollers):
    """The mixed-mode bending test: a lever presses the middle down and pulls the upper arm up.

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


class FourPointEnf(OnRollers):
    """The four-point end-notched flexure test: half of the load at the distance ``offset`` from each support."""

    ratios = (*OnRollers.ratios, Ratio("offset", 1e-6, 0.499999, "length"))
    example = "4enf"
    sentence = (
        "An end-notched flexure specimen of {arm_thickness} thick arms on supports {length} apart, with a precrack of "
        "{precrack}, is pressed down at two places, {offset} from the supports"
    )

    kind: Literal["4enf"]
    """Four-point bending of two arms, whose bond slides under a bending moment that stays the same."""
    offset: Positive
    """From a load to the nearer support [length]; less than half the length."""

    @property
    def loads(self) -> tuple[Load, ...]:
        return self.pushed(self.offset, -0.5), self.pushed(self.length - self.offset, -0.5)
