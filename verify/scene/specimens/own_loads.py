"""Two arms with loads and supports that the user defines."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import AfterValidator, BeforeValidator, Field, PlainSerializer, ValidationInfo, field_validator

from verify.scene.specimens.delamination import Load, Side, Support
from verify.scene.specimens.two_arms import TwoArms
from verify.scene.tables import Section, as_two, refuse

#: Names and numbers of the bodies that a load or a support may act on.
BODIES: dict[str, int | None] = {"upper": 0, "lower": 1, "both": None}


def _as_range(value: object) -> object:
    """A range in a list; nothing for a whole side."""
    return value if value is None else as_two(value)


class Patch(Section):
    """A patch of a side of a specimen."""

    body: Literal["upper", "lower", "both"]
    """Of which arm the side is; both for an end face of both as one."""
    side: Side
    """Which side."""
    at: Annotated[tuple[float, float] | None, BeforeValidator(_as_range)] = Field(default=None, validate_default=True)
    """Of the top or the bottom: where the patch begins and ends along X [length]."""
    couple: bool = False
    """On an end face: whether a moment acts there, or a rotation is held, in place of a force and a displacement."""

    @field_validator("side")
    @classmethod
    def _outside(cls, side: str, info: ValidationInfo) -> str:
        free = {"upper": ("top",), "lower": ("bottom",)}.get(info.data.get("body", ""), ())
        if "body" in info.data and side not in ("left", "right", *free):
            text = " or ".join(f'"{one}"' for one in ("left", "right", *free))
            raise refuse(f"{text} for the body {info.data['body']!r}", ((), side))
        return side

    @field_validator("at")
    @classmethod
    def _on_its_side(cls, at: tuple[float, float] | None, info: ValidationInfo) -> tuple[float, float] | None:
        end = info.data.get("side") in ("left", "right")
        if end and at is not None:
            raise refuse("left out on an end face", ((), list(at)))
        if not end and "side" in info.data and (at is None or not 0.0 <= at[0] < at[1]):
            raise refuse("a list of two numbers, where it begins, >= 0, and ends", ((), at and list(at)))
        return at

    @field_validator("couple")
    @classmethod
    def _on_an_end(cls, couple: bool, info: ValidationInfo) -> bool:
        if couple and info.data.get("side") in ("top", "bottom"):
            raise refuse("false but on an end face", ((), couple))
        return couple


class OwnLoad(Patch):
    """A part of the load."""

    share: float
    """Force upwards for a load of 1, or anticlockwise moment."""

    @field_validator("share")
    @classmethod
    def _some(cls, share: float) -> float:
        if share == 0.0:
            raise refuse("different from 0", ((), share))
        return share


def _loads(tables: tuple[OwnLoad, ...]) -> tuple[Load, ...]:
    return tuple(Load(BODIES[one.body], one.side, one.share, one.at, one.couple) for one in tables)


def _supports(tables: tuple[Patch, ...]) -> tuple[Support, ...]:
    return tuple(Support(BODIES[one.body], one.side, one.at, one.couple) for one in tables)


def _tables(patches: tuple[Load | Support, ...]) -> list[dict[str, Any]]:
    """Loads or supports as a scene file has them."""
    names = {number: name for name, number in BODIES.items()}
    found = []
    for one in patches:
        share = {"share": one.share} if isinstance(one, Load) else {}
        at = {} if one.extent is None else {"at": list(one.extent)}
        found.append({"body": names[one.body], "side": one.side, **share, **at, "couple": one.couple})
    return found


def _as_tuple(value: object) -> object:
    """One table is a list of one."""
    return (value,) if isinstance(value, dict) else tuple(value) if isinstance(value, list) else value


_AS_TABLES = PlainSerializer(_tables)


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
        loads: Annotated[tuple[OwnLoad, ...], BeforeValidator(_as_tuple), AfterValidator(_loads), _AS_TABLES] = Field(
            examples=[[{"body": "upper", "side": "left", "share": 1.0}]]
        )
        """What loads it, a table each: body, side, share of the load, and where it begins and ends on a top or bottom
        (at); a couple on an end face is a moment."""
        supports: Annotated[tuple[Patch, ...], BeforeValidator(_as_tuple), AfterValidator(_supports), _AS_TABLES] = (
            Field(examples=[[{"body": "both", "side": "right"}, {"body": "both", "side": "right", "couple": True}]])
        )
        """What holds it, as a load without a share: the mean displacement there, or rotation, is 0."""

    @field_validator("loads", "supports")
    @classmethod
    def _on_the_specimen(cls, patches: tuple[Any, ...], info: ValidationInfo) -> tuple[Any, ...]:
        length = info.data.get("length")
        if not patches and info.field_name == "loads":
            raise refuse("a list of one table at least", ((), []))
        ends = [((i, "at"), one.extent) for i, one in enumerate(patches) if one.extent is not None]
        beyond = [(place, list(ends)) for place, ends in ends if length is not None and ends[1] > length]
        if beyond:
            raise refuse(f"a range that ends <= specimen.length = {length:g}", *beyond)
        return patches

    @field_validator("supports")
    @classmethod
    def _held(cls, supports: tuple[Support, ...], info: ValidationInfo) -> tuple[Support, ...]:
        """Require that the specimen is held: by two supports that are not both couples, or by loads that balance."""
        if supports and (len(supports) < 2 or all(one.couple for one in supports)):
            raise refuse("two at least, not couples alone, or none where the loads balance", ((), _tables(supports)))
        loads, length = info.data.get("loads"), info.data.get("length")
        if supports or not loads or length is None:
            return supports
        resultant = sum(one.share for one in loads if not one.couple)
        moment, size = sum(_moment(one, length) for one in loads), sum(abs(one.share) for one in loads)
        if abs(resultant) > BALANCED * size or abs(moment) > BALANCED * size * length:
            raise refuse("given where the loads do not balance each other", ((), []))
        return supports


#: Loads balance if their resultant over their sizes is at most this.
BALANCED = 1e-9


def _moment(load: Load, length: float) -> float:
    """Moment about X = 0, anticlockwise."""
    if load.couple:
        return load.share
    place = sum(load.extent) / 2 if load.extent is not None else 0.0 if load.side == "left" else length
    return load.share * place
