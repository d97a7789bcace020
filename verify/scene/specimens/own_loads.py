"""Two arms with loads and supports that the user defines."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import AfterValidator, BeforeValidator, Field, PlainSerializer

from verify.scene.specimens.delamination import Load, Side, Support
from verify.scene.specimens.two_arms import TwoArms
from verify.scene.tables import MISSING, Broken, Section, as_list, as_two

#: Names and numbers of the bodies that a load or a support may act on.
BODIES: dict[str, int | None] = {"upper": 0, "lower": 1, "both": None}

#: Loads balance if their resultant over their sizes is at most this.
BALANCED = 1e-9


class Patch(Section):
    """A patch of a side of a specimen."""

    body: Literal["upper", "lower", "both"]
    """Of which arm the side is; both for an end face of both as one."""
    side: Side
    """Which side."""
    at: Annotated[tuple[float, float] | None, BeforeValidator(lambda at: at if at is None else as_two(at))] = None
    """Of the top or the bottom: where the patch begins and ends along X [length]."""
    couple: bool = False
    """On an end face: whether a moment acts there, or a rotation is held, in place of a force and a displacement."""

    def _broken(self) -> Iterator[Broken]:
        end, at = self.side in ("left", "right"), self.at
        outside = ("left", "right", *{"upper": ("top",), "lower": ("bottom",)}.get(self.body, ()))
        if self.side not in outside:
            text = " or ".join(f'"{one}"' for one in outside)
            yield ("side",), f"{text} for the body {self.body!r}", self.side
        elif end and at is not None:
            yield ("at",), "left out on an end face", at
        elif not end and (at is None or not 0.0 <= at[0] < at[1]):
            yield ("at",), "a list of two numbers, where it begins, >= 0, and ends", at or MISSING
        if self.couple and not end:
            yield ("couple",), "false but on an end face", True


class OwnLoad(Patch):
    """A part of the load."""

    share: float
    """Force upwards for a load of 1, or anticlockwise moment."""

    def _broken(self) -> Iterator[Broken]:
        yield from super()._broken()
        if self.share == 0.0:
            yield ("share",), "different from 0", self.share


def _patches(tables: tuple[Patch, ...]) -> tuple[Load | Support, ...]:
    return tuple(
        Load(BODIES[one.body], one.side, one.share, one.at, one.couple)
        if isinstance(one, OwnLoad)
        else Support(BODIES[one.body], one.side, one.at, one.couple)
        for one in tables
    )


def _tables(patches: tuple[Load | Support, ...]) -> list[dict[str, Any]]:
    """Loads or supports as a scene file has them."""
    names = {number: name for name, number in BODIES.items()}
    found = []
    for one in patches:
        share = {"share": one.share} if isinstance(one, Load) else {}
        at = {} if one.extent is None else {"at": list(one.extent)}
        found.append({"body": names[one.body], "side": one.side, **share, **at, "couple": one.couple})
    return found


_AS_TABLES = BeforeValidator(as_list), AfterValidator(_patches), PlainSerializer(_tables)


class OwnLoads(TwoArms):
    """Two arms, bonded from the precrack to the far end, with loads and supports as the scene lists them."""

    sentence = (
        "A specimen of two arms of {length} by {arm_thickness} with a precrack of {precrack} is loaded and held as the "
        "scene lists"
    )

    kind: Literal["delamination"]
    """Two arms with loads and supports of your own."""
    if TYPE_CHECKING:
        loads: tuple[Load, ...]
        supports: tuple[Support, ...]
    else:
        loads: Annotated[tuple[OwnLoad, ...], *_AS_TABLES] = Field(
            examples=[[{"body": "upper", "side": "left", "share": 1.0}]]
        )
        """What loads it, a table each: body, side, share of the load, and where it begins and ends on a top or bottom
        (at); a couple on an end face is a moment."""
        supports: Annotated[tuple[Patch, ...], *_AS_TABLES] = Field(
            examples=[[{"body": "both", "side": "right"}, {"body": "both", "side": "right", "couple": True}]]
        )
        """What holds it, as a load without a share: the mean displacement there, or rotation, is 0."""

    def _broken(self) -> Iterator[Broken]:
        """Patches beyond the specimen, and one that is not held: by two supports that are not both couples, or by loads
        that balance."""
        if not self.loads:
            yield ("loads",), "a list of one table at least", []
        for key in ("loads", "supports"):
            for i, one in enumerate(getattr(self, key)):
                if one.extent is not None and one.extent[1] > self.length:
                    yield (key, i, "at"), f"a range that ends <= specimen.length = {self.length:g}", one.extent
        held = self.supports
        if held and (len(held) < 2 or all(one.couple for one in held)):
            yield ("supports",), "two at least, not couples alone, or none where the loads balance", _tables(held)
        resultant = sum(one.share for one in self.loads if not one.couple)
        moment = sum(one.share * (1.0 if one.couple else self.middle(one)) for one in self.loads)  # about X = 0
        size = BALANCED * sum(abs(one.share) for one in self.loads)
        if not held and (abs(resultant) > size or abs(moment) > size * self.length):
            yield ("supports",), "given where the loads do not balance each other", []
