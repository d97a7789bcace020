"""What every table of a scene file is made of."""

from __future__ import annotations

from typing import Annotated, TypeAlias

from pydantic import BaseModel, ConfigDict, Field
from pydantic_core import PydanticCustomError

Positive: TypeAlias = Annotated[float, Field(gt=0)]


def refuse(text: str, *found: tuple[tuple[str | int, ...], object]) -> PydanticCustomError:
    """The error for a broken rule between keys: ``text`` completes "must be ...", ``found`` has the key paths, without
    the table, and values."""
    return PydanticCustomError("rule", "{text}", {"text": text, "found": found})


def as_two(value: object) -> object:
    """TOML has no tuples; anything but two things is refused here, what they are afterwards."""
    if not isinstance(value, list | tuple) or len(value) != 2:
        raise refuse("a list of two numbers", ((), value))
    return tuple(value)


class Section(BaseModel):
    """A table of the scene file: nothing is coerced, nothing unknown is let through, nothing changes afterwards.

    The text below a key says what it is, for ``debond new``, with its dimension in brackets; `verify.scene.keys` reads
    it, as pydantic would at every start, which takes a fifth of the time of the schema.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True, allow_inf_nan=False)
