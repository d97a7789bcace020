"""A template of a scene file: every key with its meaning, dimension, range and default."""

from __future__ import annotations

import json
import re
import textwrap
from collections.abc import Iterator, Mapping
from datetime import date
from typing import Any

from verify.scene.complaints import suggestion
from verify.scene.keys import SPECIMENS, Key, keys, keys_of
from verify.scene.load import load_scene
from verify.scene.materials import Orthotropic
from verify.scene.parse import SceneError, parse_scene
from verify.scene.published import Published
from verify.support.refusal import Refusal

#: A TOML value that no key accepts; its refusal contains the accepted values.
_OUT_OF_PLACE = date(1, 1, 1)


def allowed(raw: Mapping[str, Any], key: Key) -> str:
    """The values that a key accepts, in the words of a refusal. ``raw`` is a valid scene."""
    table = {key.name: _OUT_OF_PLACE}
    if key.table == "published":
        wrong = {**raw, "published": [table]}
    elif key.table:
        wrong = {**raw, key.table: {**raw.get(key.table, {}), **table}}
    else:
        wrong = {**raw, **table}
    try:
        parse_scene(wrong)
    except SceneError as error:
        place = key.dotted.replace("published.", "published[0].")
        rules = [one for one in error.sentences if one.startswith(f"{place}: must be ")]
        return rules[0].removeprefix(f"{place}: must be ").removesuffix(f", got {_OUT_OF_PLACE!r}") if rules else ""
    return ""


_LINE_WIDTH = 100

#: Names of dimensions in the schema, and how they are written in the units of the specimens' examples.
UNITS: Mapping[str, str] = {
    "length": "mm",
    "stress": "MPa",
    "force": "N",
    "energy per area": "N/mm",
    "stress per length": "MPa/mm",
    "degrees": "degrees",
}

#: Example values of alternative and optional keys.
ORTHOTROPIC = {"E1": 120e3, "E2": 10e3, "G12": 5e3, "nu12": 0.3}
PUBLISHED = {
    "quantity": "load_at",
    "opening": 2.0,
    "leg": 1,
    "value": 1.0,
    "tolerance": 0.03,
    "kind": "cross-code",
    "source": "",
}


def new_scene(kind: str) -> str:
    """The text of a TOML file.

    Raises
    ------
    Refusal : an unknown kind of specimen
    """
    if kind not in SPECIMENS:
        hint = suggestion(kind, SPECIMENS) or f"the kinds are {', '.join(SPECIMENS)}"
        raise Refusal(f"{kind}: is no kind of specimen; {hint}")
    raw = _least(kind)
    lines = [
        f"# A {kind} for debond. The numbers are an example, all others the defaults and can be left out.",
        "# Solve it: debond solve FILE; by every method, with a report: debond verify FILE",
    ]
    table = ""
    for key in keys(kind):
        if key.table != table:
            if table in SPECIMENS[kind].materials:
                lines += _instead(raw, table)
            table = key.table
            lines += ["", f"[{table}]"]
        lines += [*_comment(raw, key), *_assigned(raw, key)]
    lines += ["", "# What others have found, as often as there are values; `debond verify` holds every method to them."]
    return "\n".join([*lines, *_commented("[[published]]", raw, keys_of("published", Published), PUBLISHED)]) + "\n"


def _least(kind: str) -> dict[str, Any]:
    """The example with its required keys, and defaults for all others."""
    example = load_scene(SPECIMENS[kind].example).model_dump()
    own = {key.name: key.field.examples[0] for key in keys_of("specimen", SPECIMENS[kind]) if key.field.examples}
    example["specimen"] |= {"kind": kind} | own
    tables: dict[str, dict[str, Any]] = {}
    for key in keys(kind):
        if key.table and key.field.is_required():
            tables.setdefault(key.table, {})[key.name] = example[key.table][key.name]
    scene = parse_scene({"name": f"my-{kind}", "units": example["units"], **tables})
    return scene.model_dump(exclude_none=True)


def _assigned(raw: Mapping[str, Any], key: Key) -> list[str]:
    """The key with its value, as a comment where the default depends on the scene, or where others must be there."""
    table = raw[key.table] if key.table else raw
    if key.name not in table:
        return [f"# {key.name} = {_toml(_example(key))}"]
    own = key.field.default_factory is not None or key.field.default == ()
    return [f"{'# ' * own}{key.name} = {_toml(table[key.name])}"]


def _example(key: Key) -> object:
    """A value of a key that a scene need not have: an example, where its default is none or depends on others."""
    return key.field.examples[0] if key.field.examples else key.field.default


def _instead(raw: Mapping[str, Any], table: str) -> list[str]:
    """The orthotropic alternative as comments."""
    other = {**raw, table: ORTHOTROPIC}
    return ["# or, orthotropic:", *_commented("", other, keys_of(table, Orthotropic), ORTHOTROPIC)]


def _commented(head: str, raw: Mapping[str, Any], these: tuple[Key, ...], values: Mapping[str, Any]) -> list[str]:
    lines = [f"# {head}"] if head else []
    for key in these:
        note = " ".join(line.removeprefix("# ") for line in _comment(raw, key, width=10_000))
        lines.append(f"# {key.name} = {_toml(values[key.name])}  # {note}")
    return lines


def _comment(raw: Mapping[str, Any], key: Key, width: int = _LINE_WIDTH) -> Iterator[str]:
    """Meaning, unit and range of a key."""
    what = re.sub(
        r"\[([a-z ]+)\]", lambda found: f"[{UNITS[found[1]]}]", " ".join((key.field.description or "").split())
    )
    takes = allowed(raw, key)
    text = " ".join(filter(None, (what, takes and f"Takes {takes}.")))
    return (f"# {line}" for line in textwrap.wrap(text, width - 2, break_long_words=False, break_on_hyphens=False))


def _toml(value: object) -> str:
    if isinstance(value, list | tuple):
        return "[" + ", ".join(_toml(one) for one in value) + "]" if len(value) != 1 else _toml(value[0])
    if isinstance(value, bool | str):
        return json.dumps(value)
    return repr(value)
