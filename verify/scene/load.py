"""Scenes by name, by seed, or from a TOML file."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Mapping, Sequence
from importlib import import_module
from pathlib import Path
from typing import Any

from verify.scene.parse import DEEPEST, SceneError, _key_of, parse_scene
from verify.scene.schema import Scene
from verify.scene.stated.certified import problem_key
from verify.support.limited import read_at_most
from verify.support.refusal import suggestion

_FOLDER = Path(__file__).with_name("scenes")
_MANY_PARTS = re.compile(rf"^[\s\[]*(?:[\w-]+[ \t]*\.[ \t]*){{{DEEPEST}}}", re.MULTILINE)
_TOO_DEEP = f"must have keys of at most {DEEPEST} parts, like interface.strength of two"
_BY_SEED = re.compile(r"(random|plain)-(\d{1,9})")


def packaged_scenes() -> tuple[str, ...]:
    """Names of the scenes that come with the project."""
    return tuple(sorted(path.stem for path in _FOLDER.glob("*.toml")))


def verified_scenes(full: bool = False) -> tuple[str, ...]:
    """The scenes of the paper, which are verified by default; ``full``: with every bond length of the peel test."""
    bonds = ("peel-60", "peel-80", "peel-100", "peel-120")
    return ("dcb-czm1", "dcb-czm1-linear", "dcb-czm2", "dcb-czm2-linear", *(bonds if full else bonds[-1:]))


def load_scene(name_or_path: str | Path, overrides: str | Sequence[str] = ()) -> Scene:
    """Read, override and validate a scene.

    Parameters
    ----------
    name_or_path : a packaged name, ``random-SEED`` (`verify.scene.by_seed.random_scenes`), ``plain-SEED``
        (`verify.scene.by_seed.plain_scenes`), or the path of a TOML file
    overrides : ``dotted.key=value`` with a TOML value, one or several; a bare word is taken as text, and so is what is
        no TOML where the key is one of text, like ``specimen.mesh=arms.msh``. Mesh files that are named here are
        found from the working directory and may lie anywhere; those of a scene file lie in its folder or below. Where
        overrides change the problem, the published values of the scene do not apply to it and are dropped.

    Raises
    ------
    SceneError
        With one sentence for every thing that is wrong.
    """
    source, overrides = str(name_or_path), [overrides] if isinstance(overrides, str) else overrides
    if made := _BY_SEED.fullmatch(source):
        family = import_module(f"verify.scene.by_seed.{made[1]}_scenes")
        scene: Scene = getattr(family, f"{made[1]}_scene")(int(made[2]))
        return parse_scene(scene.model_dump(), overrides, source)
    path = _FOLDER / f"{source}.toml" if source in packaged_scenes() else Path(name_or_path)
    raw = _read(path, source)
    if not any(_key_of(override) in ("specimen", "specimen.mesh") for override in overrides):
        raw = _beside(path, raw, source)
    name = re.sub(r"[^A-Za-z0-9._-]+", "-", path.stem).lstrip("._-")[:80] or "scene"  # a part of names of folders
    raw = {"name": name, **raw}
    if not raw.get("published") or not overrides or any(_key_of(one).startswith("published") for one in overrides):
        return parse_scene(raw, overrides, source)
    varied = parse_scene({**raw, "published": []}, overrides, source)
    same = problem_key(varied) == problem_key(parse_scene({**raw, "published": []}, (), source))
    return parse_scene(raw, overrides, source) if same else varied


def _read(path: Path, source: str) -> dict[str, Any]:
    text = ""
    try:
        text = read_at_most(path).decode("utf-8-sig")  # some editors begin with a byte order mark
        deep = _MANY_PARTS.search(text)
        raw = {} if deep else tomllib.loads(text)  # which takes minutes for keys of many parts
    except FileNotFoundError:
        hint = suggestion(source, packaged_scenes(), "the packaged scenes")
        raise SceneError(source, [f"is neither a packaged scene nor a file; {hint}"]) from None
    except UnicodeDecodeError as error:
        raise SceneError(source, [f"is not a text in UTF-8 (byte {error.start})"]) from None
    except tomllib.TOMLDecodeError as error:
        line = re.search(r"at line (\d+)", str(error))
        place = f"{source}:{line[1] if line else text.count(chr(10)) + 1}"
        raise SceneError(place, [f"is not TOML: {error}"]) from None
    except (OSError, ValueError, RecursionError) as error:  # a NUL in the path, an integer of thousands of digits
        raise SceneError(source, [f"cannot be read: {getattr(error, 'strerror', None) or str(error)[:100]}"]) from None
    if deep or _is_deep(raw):
        raise SceneError(source, [_TOO_DEEP])
    return raw


def _is_deep(raw: object) -> bool:
    """Whether tables are nested deeper than any key of a scene has parts."""
    level = [raw]
    for _ in range(DEEPEST):
        level = [inner for table in level if isinstance(table, Mapping) for inner in table.values()]
    return any(isinstance(inner, Mapping) for inner in level)


def _beside(path: Path, raw: dict[str, Any], source: str) -> dict[str, Any]:
    """The scene with the paths of its mesh files relative to the folder of the scene file, and only below it.

    A scene file may come from other people: it must not cause files to be read that did not come with it.
    """
    specimen = raw.get("specimen")
    names = specimen.get("mesh") if isinstance(specimen, Mapping) else None
    if not isinstance(names, str | list):
        return raw
    listed = [names] if isinstance(names, str) else names
    outside = [name for name in listed if isinstance(name, str) and not _is_below(path.parent, name)]
    if outside:
        rule = "must name files in the folder of the scene or below it; --set specimen.mesh=... may name any other"
        raise SceneError(source, [f"specimen.mesh: {rule}, got {name!r}" for name in outside])
    found = [str(path.parent / name) if isinstance(name, str) else name for name in listed]
    return {**raw, "specimen": {**raw["specimen"], "mesh": found}}


def _is_below(folder: Path, name: str) -> bool:
    """Whether a path, links followed, stays in a folder."""
    try:
        return (folder / name).resolve().is_relative_to(folder.resolve())
    except (OSError, ValueError, RuntimeError):  # a NUL, links in a circle
        return False
