"""What is wrong with a scene, as sentences: key path, allowed range, value."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Literal, get_args, get_origin

from pydantic import ValidationError
from pydantic.fields import FieldInfo
from pydantic_core import ErrorDetails

from verify.scene.bond.corners import CORNERS
from verify.scene.materials import Isotropic, Orthotropic
from verify.scene.schema import Scene
from verify.scene.specimens import SPECIMENS
from verify.scene.tables import Section
from verify.support.refusal import one_of, suggestion

_MATERIALS: Mapping[str, type[Section]] = {"isotropic": Isotropic, "orthotropic": Orthotropic}
_ALTERNATIVES: Mapping[str, Mapping[str, type[Section]]] = {
    "specimen": SPECIMENS,
    **dict.fromkeys(("material", "strip", "substrate"), _MATERIALS),
}
#: The tag of a list of two materials in an error.
_PAIR = "pair"
_BOUNDS = (("gt", ">"), ("ge", ">="), ("lt", "<"), ("le", "<="))
_KINDS = {float: "a number", int: "an integer", bool: "true or false", str: "a text"}


def complaints(error: ValidationError, raw: Mapping[str, Any]) -> list[str]:
    """One sentence for every error, in the order of the schema."""
    details = [e for e in error.errors() if e["type"] != "default_factory_not_called"]
    kind = ("specimen", "dcb", "kind")
    if any(e["loc"] == kind for e in details):
        # with an unknown kind of specimen its keys cannot be judged, as each kind has other keys
        details = [e for e in details if e["loc"] == kind or e["loc"][0] not in _ALTERNATIVES]
    sentences = (sentence for e in details for sentence in _sentences(e, raw))
    return list(dict.fromkeys(sentences))  # a number that is used for two keys is reported once


def _sentences(e: ErrorDetails, raw: Mapping[str, Any]) -> list[str]:
    if e["type"] != "rule":
        return [_sentence(e, raw)]
    text, found = e["ctx"]["text"], e["ctx"]["found"]
    keys = [_dotted(_place((*e["loc"], *rest))[2], raw) for rest, _ in found]
    return [f"{key}: must be {text}, got {_shown(_plain(v))}" for key, (_, v) in zip(keys, found, strict=True)]


def _sentence(e: ErrorDetails, raw: Mapping[str, Any]) -> str:
    model, field, path = _place(e["loc"])
    if e["type"] == "missing" and isinstance(path[-1], int):  # said of the list, which is too short
        path = path[:-1]
        return f"{_dotted(path, raw)}: must be {_expected(field, path, full=True)}, got {_shown(e['input'])}"
    key = _dotted(path, raw)
    if e["type"] == "extra_forbidden":
        known = list(model.model_fields)
        name = str(path[-1])
        other = "" if path[0] in _ALTERNATIVES else _elsewhere(name)  # bodies of one kind lack keys of the others
        hint = other or suggestion(name, known) or f"the keys here are {', '.join(known)}"
        return f"{key}: is not a key of a scene, got {_shown(e['input'])}; {hint}"
    if e["type"] == "missing":
        return f"{key}: is missing, must be {_expected(field, path, full=True)}"
    outside = e["type"].startswith(("greater_than", "less_than"))
    return f"{key}: must be {_expected(field, path, full=not outside)}, got {_shown(e['input'])}"


def _elsewhere(name: str) -> str:
    """The tables that have a key of this name, if it has been put into the wrong table."""
    from verify.scene.keys import dotted_keys  # imported here, as it imports this module

    places = [key for key in dotted_keys() if key.count(".") == 1 and key.rpartition(".")[2] == name]
    return f"did you mean {one_of(places)}?" if places else ""


def _place(loc: tuple[str | int, ...]) -> tuple[type[Section], FieldInfo | None, tuple[str | int, ...]]:
    """The table that an error is in, the key's definition, and its path without the names of alternatives."""
    model: type[Section] = Scene
    here: type[Section] | None = Scene
    field: FieldInfo | None = None
    path: list[str | int] = []
    for part in loc:
        if part == _PAIR and len(path) == 1:
            continue
        bare = here is None and all(isinstance(step, int) for step in path[1:])  # of which kind is not known yet
        if bare and part in _ALTERNATIVES.get("".join(map(str, path[:1])), ()):
            here = _ALTERNATIVES[str(path[0])][str(part)]
            continue
        path.append(part)
        if here is not None and isinstance(part, str):
            model, field = here, here.model_fields.get(part)
            here = _table(field.annotation if field else None)
    return model, field, tuple(path)


def _table(annotation: object) -> type[Section] | None:
    """The table type of a key whose value is a table or a list of tables."""
    inner = get_args(annotation)[0] if get_origin(annotation) is tuple else annotation
    return inner if isinstance(inner, type) and issubclass(inner, Section) else None


def _dotted(path: tuple[str | int, ...], raw: Mapping[str, Any]) -> str:
    """``load.opening[1]``; without the index where the file has a single value."""
    text = ""
    value: object = raw
    for part in path:
        if isinstance(part, str):
            text += f".{part}" if text else part
            value = value.get(part) if isinstance(value, Mapping) else None
        elif isinstance(value, list):
            text += f"[{part}]"
            value = value[part]
    return text


def _expected(field: FieldInfo | None, path: tuple[str | int, ...], full: bool) -> str:
    """The range of a key; with its type in front where ``full``."""
    annotation = _without_none(field.annotation if field else None)
    if path == ("specimen", "kind"):
        return one_of(SPECIMENS)
    if get_origin(annotation) is Literal:
        return one_of(get_args(annotation))
    if get_origin(annotation) is tuple and _table(annotation) is None:
        if path[-1] == "table":
            return CORNERS
        if "mesh" in path:
            return "a file name" if isinstance(path[-1], int) else "a file name, or a list of two"
        how_many = "at least one number" if get_args(annotation)[-1] is ... else "two"
        one = " ".join(["a number", *_each(annotation)])
        return one if isinstance(path[-1], int) else f"{one}, or a list of {how_many}"
    if annotation not in _KINDS:
        table = _table(annotation)
        tables = [table] if table is not None else list(_ALTERNATIVES[str(path[0])].values())
        return "a table of " + ", or of ".join(", ".join(table.model_fields) for table in tables)
    if annotation is str and field is not None and field.metadata:
        return "1 to 80 letters, digits, dots, dashes and underscores, a letter or digit first"
    bounds = [f"{sign} {limit:g}" for limit, sign in (_bounds(field) if field is not None else ())]
    return " ".join([_KINDS[annotation]] * (full or not bounds) + [" and ".join(bounds)] * bool(bounds))


def _without_none(annotation: object) -> object:
    """The type of a number, or of a list of numbers, whose key may be left out."""
    kinds = [kind for kind in get_args(annotation) if kind in _KINDS or get_origin(kind) is tuple]
    return kinds[0] if type(None) in get_args(annotation) and kinds else annotation


def _each(annotation: object) -> list[str]:
    """The range of each number of a tuple."""
    inner = getattr(get_args(annotation)[0], "__metadata__", ())
    limits = [limit for field in inner if isinstance(field, FieldInfo) for limit in _bounds(field)]
    return [" and ".join(f"{sign} {limit:g}" for limit, sign in limits)] if limits else []


def _bounds(field: FieldInfo) -> list[tuple[float, str]]:
    return [(getattr(m, name), sign) for m in field.metadata for name, sign in _BOUNDS if hasattr(m, name)]


def _plain(value: object) -> object:
    """An integer that a valid number key turned into a float is shown as it was written."""
    return int(value) if isinstance(value, float) and value.is_integer() else value


def _shown(value: object) -> str:
    """A value as the user would write it, shortened."""
    if isinstance(value, bool):
        return str(value).lower()
    try:
        text = repr(list(value) if isinstance(value, tuple) else value)
    except ValueError:  # an integer of more digits than Python prints
        return "an integer of thousands of digits"
    return text if len(text) <= 60 else text[:57] + "..."
