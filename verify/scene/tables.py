"""What every table of a scene file is made of, and the rules that pydantic has no words for."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Annotated, Literal, Self, TypeAlias

from pydantic import BaseModel, ConfigDict, Field, model_validator
from pydantic_core import PydanticCustomError

Positive: TypeAlias = Annotated[float, Field(gt=0)]
Auto: TypeAlias = Literal["auto"]

#: A broken rule: the path of its key without the table, what completes "must be ...", and the value.
Broken: TypeAlias = tuple[tuple[str | int, ...], str, object]

#: The value of a key that is not there and must be.
MISSING = object()


def refusal(broken: Iterable[Broken]) -> PydanticCustomError:
    """The error for broken rules."""
    return PydanticCustomError("rules", "rules", {"broken": list(broken)})


def refuse(text: str, *found: tuple[tuple[str | int, ...], object]) -> PydanticCustomError:
    """The error for a rule that the values of some keys break."""
    return refusal((path, text, value) for path, value in found)


def as_two(value: object) -> object:
    """TOML has no tuples; anything but two things is refused here, what they are afterwards."""
    if not isinstance(value, list | tuple) or len(value) != 2:
        raise refuse("a list of two numbers", ((), value))
    return tuple(value)


def as_list(value: object) -> object:
    """One value, or one table, is a list of one."""
    return tuple(value) if isinstance(value, list | tuple) else (value,)


def as_pair(value: object) -> object:
    """One value stands for both."""
    return tuple(value) if isinstance(value, list | tuple) else (value, value)


class Section(BaseModel):
    """A table of the scene file: nothing is coerced, nothing unknown is let through, nothing changes afterwards.

    The text below a key says what it is, for ``debond new``, with its dimension in brackets; `verify.scene.keys` reads
    it, as pydantic would at every start, which takes a fifth of the time of the schema. What a key must be is said by
    its type, or by a ``description`` where that says it badly; see `verify.scene.complaints`.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True, allow_inf_nan=False)

    def _broken(self) -> Iterator[Broken]:
        """Rules between its keys that are broken."""
        return iter(())

    @model_validator(mode="after")
    def _agreed(self) -> Self:
        if found := list(self._broken()):
            raise refusal(found)
        return self
