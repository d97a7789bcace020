"""A template of a scene file: every key with its meaning, dimension, range and default."""

from __future__ import annotations

import re
import textwrap
from collections.abc import Iterator, Mapping
from datetime import date
from typing import Any

from verify.scene import toml
from verify.scene.keys import SPECIMENS, Key, keys, keys_of
from verify.scene.load import load_scene
from verify.scene.materials import Orthotropic
from verify.scene.parse import SceneError, parse_scene
from verify.scene.schema import Scene
from verify.scene.stated.published import Published
from verify.scene.stated.uncertainty import DATA_KEYS, MOST_UNCERTAIN, numbers_in
from verify.support.refusal import Refusal, suggestion

#: A TOML value that no key accepts; its refusal contains the accepted values.
_OUT_OF_PLACE = date(1, 1, 1)


def allowed(raw: Mapping[str, Any], key: Key) -> str:
    """The values that a key accepts, in the words of a refusal. ``raw`` is a valid scene."""
    odd: dict[str, Any] = {key.name: _OUT_OF_PLACE}
    if key.table == "published":
        odd = {"published": [odd]}
    elif key.table:
        odd = {key.table: {**raw.get(key.table, {}), **odd}}
    place = f"{key.dotted.replace('published.', 'published[0].')}: must be "
    try:
        parse_scene({**raw, **odd})
    except SceneError as error:
        rules = [one.removeprefix(place) for one in error.sentences if one.startswith(place)]
        return rules[0].removesuffix(f", got {_OUT_OF_PLACE!r}") if rules else ""
    return ""


_LINE_WIDTH = 100

#: Keys that the bond of a specimen that slides needs.
SHEAR_KEYS = ("shear_strength", "shear_toughness")

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
ISOTROPIC = {"young": 120e3, "poisson": 0.2}
ORTHOTROPIC = {"E1": 120e3, "E2": 10e3, "G12": 5e3, "nu12": 0.3, "nu23": 0.4}
PUBLISHED: Mapping[str, Any] = {
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
        raise Refusal(f"{kind}: is no kind of specimen; {suggestion(kind, SPECIMENS, 'the kinds')}")
    raw = _least(kind)
    lines = [
        f"# A {kind} for debond. The numbers are an example, all others the defaults and can be left out.",
        "# Solve it: debond solve FILE; by every method, with a report: debond verify FILE",
    ]
    table = ""
    for key in keys(kind):
        if key.table != table:
            if table in SPECIMENS[kind].materials:
                other = {**raw, table: ORTHOTROPIC}  # without the constants of solids
                lines += _commented("or, orthotropic:", other, keys_of(table, Orthotropic), ORTHOTROPIC)
            table = key.table
            lines += ["", f"[{table}]"]
        lines += [*_comment(raw, key), _assigned(raw, key)]
    lines += _uncertain(kind, parse_scene(raw))
    lines += ["", "# What others have found, as often as there are values; `debond verify` holds every method to them."]
    return (
        "\n".join([*lines, *_commented("[[published]]", raw, keys_of("published", Published), published(raw))]) + "\n"
    )


def from_scene(scene: Scene) -> str:
    """The text of a TOML file with the numbers of a scene, each key with what it is.

    Raises
    ------
    Refusal : its elements are those of a file
    """
    if scene.specimen.mesh:
        raise Refusal(f"--from: must be a scene without mesh files, got {scene.specimen.mesh[0]}")
    raw = scene.model_dump(exclude_none=True)
    known = {key.dotted: key for key in keys(scene.specimen.kind)}
    for table in SPECIMENS[scene.specimen.kind].materials:
        known |= {key.dotted: key for key in keys_of(table, Orthotropic)}

    def note(table: str, name: str) -> Iterator[str]:
        key = known.get(f"{table}.{name}" if table else name)
        return _comment(raw, key) if key else iter(())

    return toml.scene_file(scene, note)


def _uncertain(kind: str, scene: Scene) -> list[str]:
    """Examples of relative standard uncertainties as comments, in the table that has begun."""
    text = (
        "How well a number is known: its key once more, with its relative standard uncertainty. Any number of "
        f"specimen, materials and interface; takes a number > 0 and <= {MOST_UNCERTAIN:g}, for `debond validate`."
    )
    of_scene = numbers_in(scene)
    thickness = f"specimen.{SPECIMENS[kind].thickness_keys[0]}"
    shown = [key for key in of_scene if key == thickness or key.endswith(("young", "E1", ".toughness"))]
    return [
        *(f"# {line}" for line in textwrap.wrap(text, _LINE_WIDTH - 2)),
        *(f"# {key} = 0.02" for key in shown),
        *(f"# {key} = 0.005  # {what}" for key, what in DATA_KEYS.items()),
    ]


def published(raw: Mapping[str, Any]) -> dict[str, Any]:
    """An example of a published value, on the way of a scene."""
    return {**PUBLISHED, "opening": min(PUBLISHED["opening"], *raw["load"]["opening"])}


def _least(kind: str) -> dict[str, Any]:
    """The example with its required keys, and defaults for all others."""
    example = load_scene(SPECIMENS[kind].example).model_dump()
    own = {key.name: key.field.examples[0] for key in keys_of("specimen", SPECIMENS[kind]) if key.field.examples}
    example["specimen"] |= {"kind": kind} | own
    tables: dict[str, dict[str, Any]] = {}
    for key in keys(kind):
        if key.table and key.field.is_required():
            value = example[key.table].get(key.name, ISOTROPIC.get(key.name))
            tables.setdefault(key.table, {})[key.name] = value
    if SPECIMENS[kind].slides:
        tables["interface"] |= {key: example["interface"][key] for key in SHEAR_KEYS}
    scene = parse_scene({"name": f"my-{kind}", "units": example["units"], **tables})
    raw = scene.model_dump(exclude_none=True)
    if SPECIMENS[kind].slides:  # a value that goes with the others
        raw["interface"]["shear_stiffness"] = scene.interface.shear_stiffness
    return raw


def _assigned(raw: Mapping[str, Any], key: Key) -> str:
    """The key with its value; as a comment where the default depends on the scene, or where others must be there, and
    with an example where there is none."""
    table, field = raw[key.table] if key.table else raw, key.field
    found = table.get(key.name, field.examples[0] if field.examples else field.default)
    if key.name in table and isinstance(found, list | tuple) and len(found) == 1:
        found = found[0]
    given = key.name in table and field.default_factory is None and field.default != ()
    return f"{'# ' * (not given)}{key.name} = {toml.value(found)}"


def _commented(head: str, raw: Mapping[str, Any], these: tuple[Key, ...], values: Mapping[str, Any]) -> list[str]:
    lines = [f"# {head}"]
    for key in (key for key in these if key.name in values):
        note = " ".join(line.removeprefix("# ") for line in _comment(raw, key, width=10_000))
        lines.append(f"# {key.name} = {toml.value(values[key.name])}  # {note}")
    return lines


def _comment(raw: Mapping[str, Any], key: Key, width: int = _LINE_WIDTH) -> Iterator[str]:
    """Meaning, unit and range of a key."""
    what = re.sub(r"\[([a-z ]+)\]", lambda found: f"[{UNITS[found[1]]}]", key.meaning)
    takes = allowed(raw, key)
    text = " ".join(filter(None, (what, takes and f"Takes {takes}.")))
    return (f"# {line}" for line in textwrap.wrap(text, width - 2, break_long_words=False, break_on_hyphens=False))
