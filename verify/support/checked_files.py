"""JSON and CSV files of this toolkit, checked against a layout when they are read."""

from __future__ import annotations

import csv
import json
import math
from collections.abc import Callable, Mapping
from dataclasses import fields
from functools import reduce
from operator import or_
from pathlib import Path
from typing import Any

from pydantic import FiniteFloat, TypeAdapter, ValidationError, create_model

from verify.support.limited import read_at_most
from verify.support.refusal import Refusal

#: Matches every key of a mapping whose keys are free; a key with a trailing ? is optional.
ANY = "*"

#: A number or null, which stands for NaN.
NUMBER = (float, type(None))

#: Layout of a value: a type (``float`` means finite), a tuple of types, ``{key: layout}``, or ``[layout]`` for items.
Shape = Any

#: Layout of a field of a dataclass, by its annotation.
_OF_FIELDS: Mapping[str, Shape] = {
    "float": NUMBER,
    "float | None": NUMBER,
    "int": int,
    "str": str,
    "bool": bool,
    "Kind": str,
}


_FROM_TEXT: Mapping[str, Callable[[str], Any]] = {
    "float": float,
    "int": int,
    "str": str,
    "bool": {"True": True, "False": False}.__getitem__,
}


class Damaged(Refusal):
    """A file without the expected layout; ``path`` is the file."""

    def __init__(self, path: Path, why: object) -> None:
        self.path = path
        text = " ".join(str(why).split()) or type(why).__name__
        super().__init__(f"{path}: must be as debond has written it, got: {text}")


def read_json(path: Path, shape: Shape) -> dict[str, Any]:
    """The content of a JSON file.

    Raises
    ------
    Damaged : the file cannot be read, is no JSON, or has another layout.
    """
    try:
        content = json.loads(read_at_most(path))
    except (OSError, ValueError, RecursionError) as error:
        raise Damaged(path, _why(error)) from None
    if why := wrong(content, shape):
        raise Damaged(path, why)
    return content


def read_table(path: Path, kind: type) -> list[Any]:
    """Rows of a CSV file as objects of a dataclass, whose fields are the columns.

    Raises
    ------
    Damaged : the file cannot be read, has other columns, or a cell of another type.
    """
    types = {field.name: _FROM_TEXT[str(field.type)] for field in fields(kind)}
    try:
        with path.open(newline="", encoding="utf-8") as stream:
            lines = csv.DictReader(stream)
            if list(lines.fieldnames or []) != list(types):
                raise Damaged(path, f"the columns {', '.join(lines.fieldnames or []) or 'of an empty file'}"[:200])
            return [kind(**{name: types[name](text) for name, text in line.items()}) for line in lines]
    except (OSError, ValueError, KeyError, TypeError, csv.Error) as error:
        raise (error if isinstance(error, Damaged) else Damaged(path, _why(error))) from None


def shape_of(kind: type) -> Shape:
    """Layout of a dataclass with fields of plain types."""
    return {field.name: _OF_FIELDS[str(field.type)] for field in fields(kind)}


def wrong(value: Any, shape: Shape) -> str:
    """The first difference of a value from its layout, in words; empty if there is none."""
    try:
        TypeAdapter(_type(shape)).validate_python(value, strict=True)
    except ValidationError as error:
        first = error.errors()[0]
        place = ".".join(str(part) for part in first["loc"] if str(part) not in ("float", "none")) or "the whole"
        if first["type"] == "missing":
            return f"no {place}"
        rule = first["msg"].removesuffix(" or instance of Keys").replace("Input should", "must", 1)
        return f"{place} {rule}, got {str(first['input'])[:30]!r}"
    return ""


def _type(shape: Shape) -> Any:
    """The type of a layout."""
    if isinstance(shape, list):
        return list[_type(shape[0])]  # type: ignore[misc]
    if isinstance(shape, tuple):
        return reduce(or_, map(_type, shape))
    if not isinstance(shape, Mapping):
        return {float: FiniteFloat, object: Any}.get(shape, shape)
    if ANY in shape:
        return dict[str, _type(shape[ANY])]  # type: ignore[misc]
    keys: dict[str, Any] = {key.removesuffix("?"): (_type(one), None) for key, one in shape.items()}
    keys |= {key: (one, ...) for key, (one, _) in keys.items() if key in shape}
    return create_model("Keys", **keys)


def number(value: float | None) -> float:
    """A number of a file: null becomes NaN."""
    return math.nan if value is None else value


def _why(error: Exception) -> str:
    if isinstance(error, OSError):
        return error.strerror or type(error).__name__
    return f"a cell {error}" if isinstance(error, KeyError) else str(error)
