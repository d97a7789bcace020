"""JSON and CSV files of this toolkit, checked against a layout when they are read."""

from __future__ import annotations

import csv
import errno
import json
import math
from collections.abc import Callable, Mapping
from dataclasses import fields
from pathlib import Path
from typing import Any

from verify.support.refusal import Refusal

#: Bytes beyond which a file is refused, like a device that never ends.
LARGEST_FILE = 2**28

#: Matches every key of a mapping whose keys are free; a key with a trailing ? is optional.
ANY = "*"

#: A number or null, which stands for NaN.
NUMBER = (float, type(None))

#: Layout of a value: a type (``float`` means finite), a tuple of types, ``{key: layout}``, or ``[layout]`` for items.
Shape = Any

_WORDS = {
    str: "a text",
    int: "an integer",
    float: "a number",
    bool: "true or false",
    type(None): "null",
    dict: "a table",
}

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


def read_at_most(path: Path, most: int = LARGEST_FILE) -> bytes:
    """The content of a file.

    Raises
    ------
    OSError : the file cannot be read, or has more than ``most`` bytes.
    """
    with path.open("rb") as stream:
        content = stream.read(most + 1)
    if len(content) > most:
        raise OSError(errno.EFBIG, f"it has more than {most / 1e6:.0f} MB", str(path))
    return content


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


def wrong(value: Any, shape: Shape, place: str = "") -> str:
    """The first difference of a value from its layout, in words; empty if there is none."""
    if isinstance(shape, Mapping):
        if not isinstance(value, dict):
            return _not(value, (dict,), place)
        missing = [key for key in shape if key != ANY and not key.endswith("?") and key not in value]
        if missing:
            return f"no {'.'.join(filter(None, [place, missing[0]]))}"
        known = {key.removesuffix("?"): inner for key, inner in shape.items()}
        inside = ((key, item, known.get(key, shape.get(ANY))) for key, item in value.items())
        pairs = [(f"{place}.{key}".lstrip("."), item, inner) for key, item, inner in inside if inner is not None]
    elif isinstance(shape, list):
        if not isinstance(value, list):
            return f"{place or 'the whole'} must be a list, got {str(value)[:30]!r}"
        pairs = [(f"{place}[{i}]", item, shape[0]) for i, item in enumerate(value)]
    else:
        types = shape if isinstance(shape, tuple) else (shape,)
        return "" if any(_is(value, kind) for kind in types) else _not(value, types, place)
    return next(filter(None, (wrong(item, inner, at) for at, item, inner in pairs)), "")


def number(value: float | None) -> float:
    """A number of a file: null becomes NaN."""
    return math.nan if value is None else value


def _is(value: Any, kind: type) -> bool:
    if kind is float:
        return isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)
    return isinstance(value, kind) and not (kind is int and isinstance(value, bool))


def _not(value: Any, kinds: tuple[type, ...], place: str) -> str:
    return f"{place or 'the whole'} must be {' or '.join(_WORDS[kind] for kind in kinds)}, got {str(value)[:30]!r}"


def _why(error: Exception) -> str:
    if isinstance(error, OSError):
        return error.strerror or type(error).__name__
    return f"a cell {error}" if isinstance(error, KeyError) else str(error)
