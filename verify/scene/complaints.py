"""What is wrong with a scene, as sentences: key path, allowed range, value."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from types import NoneType
from typing import Annotated, Any, Literal, get_args, get_origin

from pydantic import ValidationError
from pydantic.fields import FieldInfo
from pydantic_core import ErrorDetails

from verify.scene.materials import MATERIALS
from verify.scene.schema import Scene
from verify.scene.specimens import SPECIMENS
from verify.scene.tables import MISSING, Section
from verify.support.refusal import one_of, suggestion

#: Tables that are of one of several types, by the tag that an error names.
_TAGGED: Mapping[str, type[Section]] = {**SPECIMENS, **MATERIALS}
_BOUNDS = (("gt", ">"), ("ge", ">="), ("lt", "<"), ("le", "<="))
_KINDS = {float: "a number", int: "an integer", bool: "true or false", str: "a text"}


def complaints(error: ValidationError, raw: Mapping[str, Any]) -> list[str]:
    """One sentence for every error, in the order of the schema."""
    details = (e for e in error.errors() if e["type"] != "default_factory_not_called")
    found = [sentence for e in details for sentence in _sentences(e, raw)]
    return list(dict.fromkeys(found))  # what several alternatives of a key say is said once


def _sentences(e: ErrorDetails, raw: Mapping[str, Any]) -> Iterator[str]:
    if e["type"] != "rules":
        yield _sentence(e, raw)
        return
    for rest, text, value in e["ctx"]["broken"]:
        key = dotted(_as_written((*_place(e["loc"])[2], *rest), raw))
        if isinstance(value, float) and value.is_integer() and abs(value) < 1e15:
            value = int(value)  # as it was written
        yield _must(key, text, value)


def _must(key: str, text: str, value: object) -> str:
    """What a key must be, and is, or that it is missing."""
    return f"{key}: is missing, must be {text}" if value is MISSING else f"{key}: must be {text}, got {shown(value)}"


def _sentence(e: ErrorDetails, raw: Mapping[str, Any]) -> str:
    table, field, path = _place(e["loc"])
    path = _as_written(path, raw)
    if e["type"].startswith("union_tag") and isinstance(e["input"], Mapping):  # an unknown kind of specimen
        return _must("specimen.kind", one_of(SPECIMENS), e["input"].get("kind", MISSING))
    if e["type"] == "extra_forbidden":
        hint = _elsewhere(path) or suggestion(str(path[-1]), table.model_fields, "the keys here")
        return f"{dotted(path)}: is not a key of a scene, got {shown(e['input'])}; {hint}"
    if e["type"] == "missing" and not isinstance(path[-1], int):
        return _must(dotted(path), _expected(field, path), MISSING)
    if e["type"] == "missing":  # said of the list, which is too short
        path = path[:-1]
    text = _expected(field, path)
    if e["type"].startswith(("greater_than", "less_than")) and " or " not in text:
        text = text.removeprefix("a number ").removeprefix("an integer ")
    return _must(dotted(path), text, e["input"])


def _elsewhere(path: tuple[str | int, ...]) -> str:
    """The tables that have a key of this name, if it has been put into the wrong table."""
    from verify.scene.keys import dotted_keys  # imported here, as it imports this module

    if path[0] in ("specimen", "material", "strip", "substrate"):  # bodies of one kind lack keys of the others
        return ""
    places = [key for key in dotted_keys() if key.count(".") == 1 and key.endswith(f".{path[-1]}")]
    return f"did you mean {one_of(places)}?" if places else ""


def _place(loc: tuple[str | int, ...]) -> tuple[type[Section], FieldInfo | None, tuple[str | int, ...]]:
    """The table that an error is in, the key's definition, and its path without the names of alternatives."""
    table: type[Section] = Scene
    here: tuple[type[Section], ...] = (Scene,)
    field: FieldInfo | None = None
    path: list[str | int] = []
    for part in loc:
        if isinstance(part, int):
            path.append(part)
        elif part.startswith("<"):  # the tag of an alternative
            here = (_TAGGED[part[1:-1]],) if part[1:-1] in _TAGGED else here
        elif here:
            table, field = here[0], here[0].model_fields.get(part)
            here = _tables(field.annotation if field else None)
            path.append(part)
    return table, field, tuple(path)


def _tables(annotation: object) -> tuple[type[Section], ...]:
    """The types of table in an annotation, each once."""
    if isinstance(annotation, type) and issubclass(annotation, Section):
        return (annotation,)
    return tuple(dict.fromkeys(table for one in get_args(annotation) for table in _tables(one)))


def _as_written(path: tuple[str | int, ...], raw: Mapping[str, Any]) -> tuple[str | int, ...]:
    """A path without the index where the file has a single value."""
    value: Any = raw
    for i, part in enumerate(path):
        listed = isinstance(value, list | tuple)
        if isinstance(part, int) and not listed:
            return path[:i]
        known = dict(enumerate(value)) if listed else value if isinstance(value, Mapping) else {}
        value = known.get(part)
    return path


def dotted(path: tuple[str | int, ...]) -> str:
    """``load.opening[1]``."""
    return "".join(f"[{part}]" if isinstance(part, int) else f".{part}" for part in path).removeprefix(".")


def _expected(field: FieldInfo | None, path: tuple[str | int, ...]) -> str:
    """What a key must be, or one of its numbers."""
    if field is None:
        return "a value"
    if not isinstance(path[-1], int):
        return field.description or rule(field.annotation, *field.metadata)
    annotation: object = field.annotation
    while isinstance(path[-1], int):
        annotation, path = (get_args(annotation) or (annotation,))[0], path[:-1]
    return rule(annotation)


def rule(annotation: object, *limits: Any) -> str:
    """The values that a type with limits takes, in words."""
    inside, origin = get_args(annotation), get_origin(annotation)
    if origin is Annotated:
        return rule(inside[0], *(one for more in inside[1:] for one in getattr(more, "metadata", ())), *limits)
    if annotation in _KINDS:
        bounds = [f"{sign} {getattr(one, name):.10g}" for one in limits for name, sign in _BOUNDS if hasattr(one, name)]
        return " ".join([_KINDS[annotation], *([" and ".join(bounds)] if bounds else [])])
    if origin is Literal:
        return one_of(inside)
    if tables := _tables(annotation):
        return "a table of " + ", or of ".join(", ".join(table.model_fields) for table in tables)
    if origin is tuple:
        return f"{rule(inside[0])}, or a list of {'at least one number' if inside[-1] is ... else 'two'}"
    return ", or ".join(rule(one, *limits) for one in inside if one is not NoneType)


def shown(value: object) -> str:
    """A value as the user would write it, shortened."""
    if isinstance(value, bool):
        return str(value).lower()
    try:
        text = repr(list(value) if isinstance(value, tuple) else value)
    except ValueError:  # an integer of more digits than Python prints
        return "an integer of thousands of digits"
    return text if len(text) <= 60 else text[:57] + "..."
