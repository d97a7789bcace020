"""Scenes and their values as TOML."""

from __future__ import annotations

import json
import re
import shutil
from collections.abc import Callable, Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any

from verify.scene.schema import Scene

#: Name of a file that a deck of Abaqus includes.
INCLUDED = re.compile(r"""INPUT\s*=\s*["']?([^,"'\r\n]+)""", re.IGNORECASE)


def value(found: object) -> str:
    """One value as TOML; tables are inline tables."""
    if isinstance(found, list | tuple):
        return "[" + ", ".join(map(value, found)) + "]"
    if isinstance(found, Mapping):
        return "{ " + ", ".join(f"{key} = {value(one)}" for key, one in found.items()) + " }"
    if isinstance(found, bool | str):
        return json.dumps(found, ensure_ascii=False).replace("\x7f", "\\u007f")
    return repr(found)


def scene_file(scene: Scene, note: Callable[[str, str], Iterable[str]] = lambda table, key: ()) -> str:
    """The text of a file from which `verify.scene.load.load_scene` reads an equal scene.

    ``note`` returns comment lines on a key of a table, "" at the top.
    """
    return "\n".join(_lines(scene.model_dump(exclude_none=True), note)) + "\n"


def mesh_files(scene: Scene) -> dict[str, Path]:
    """The mesh files of a scene by name, and those that a deck of Abaqus includes, which lie beside it or below."""
    found = {Path(name).name: Path(name) for name in scene.specimen.mesh}
    for deck in [file for file in found.values() if file.suffix.lower() == ".inp"]:
        names = [deck.name]
        for name in names:  # which grows
            found[name] = deck.parent / name
            more = INCLUDED.findall(found[name].read_text(errors="replace"))
            inside = (one for one in map(Path, more) if not one.is_absolute() and ".." not in one.parts)
            names += [str(one) for one in inside if str(one) not in names and (deck.parent / one).is_file()]
    return found


def keep_scene(scene: Scene, path: Path) -> None:
    """Write the scene to a file, with copies of its mesh files in the same folder."""
    names = [Path(name).name for name in scene.specimen.mesh]
    for name, file in mesh_files(scene).items():
        copy = path.parent / name
        copy.parent.mkdir(parents=True, exist_ok=True)
        if not copy.exists() or not copy.samefile(file):
            shutil.copy(file, copy)
    path.parent.mkdir(parents=True, exist_ok=True)
    specimen = scene.specimen.model_copy(update={"mesh": tuple(names)} if names else {})
    path.write_text(scene_file(scene.model_copy(update={"specimen": specimen})), encoding="utf-8")


def _lines(raw: Mapping[str, Any], note: Callable[[str, str], Iterable[str]]) -> Iterator[str]:
    tables = {name: table for name, table in raw.items() if isinstance(table, Mapping)}
    top = {key: one for key, one in raw.items() if key not in tables and key != "published"}
    for name, table in {"": top, **tables}.items():  # keys outside of tables come first
        if name and table:
            yield from ("", f"[{name}]")
        for key, one in table.items():
            yield from note(name, key)
            yield f"{key} = {value(one)}"
    for table in raw.get("published", ()):
        yield from ("", "[[published]]", *(f"{key} = {value(one)}" for key, one in table.items()))
