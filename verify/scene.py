"""From a TOML file, or the name of a packaged one, to a valid ``Scene``; every reason why not, at once."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from verify.complaints import complaints, suggestion
from verify.magnitudes import out_of_proportion, too_large
from verify.refusal import Refusal
from verify.schema import Discretization, Dolfinx, Effects, Interface, Load, Pose, Scene
from verify.specimen import Dcb, Isotropic, Orthotropic, Peel

__all__ = [
    "Dcb",
    "Discretization",
    "Dolfinx",
    "Effects",
    "Interface",
    "Isotropic",
    "Load",
    "Orthotropic",
    "Peel",
    "Pose",
    "Scene",
    "SceneError",
    "load_scene",
    "packaged_scenes",
    "parse_scene",
    "verified_scenes",
]

_FOLDER = Path(__file__).with_name("scenes")
_KEY = re.compile(r"[A-Za-z_][A-Za-z0-9_-]*(\.[A-Za-z_][A-Za-z0-9_-]*)*")
_RANDOM = re.compile(r"random-(\d{1,9})")
_BARE_WORD = re.compile(r"[A-Za-z][A-Za-z0-9_-]*")


class SceneError(Refusal):
    """A scene that cannot be used.

    Attributes
    ----------
    sentences : one for each thing that is wrong
    """

    def __init__(self, source: str, sentences: Sequence[str]) -> None:
        super().__init__("\n".join([f"{source}:", *(f"  {s}" for s in sentences)]))
        self.sentences = tuple(sentences)


def packaged_scenes() -> tuple[str, ...]:
    """Names of the scenes that come with the project."""
    return tuple(sorted(path.stem for path in _FOLDER.glob("*.toml")))


def verified_scenes(full: bool = False) -> tuple[str, ...]:
    """The scenes of the paper that are verified where none is named; ``full``: with every bond of the peel test."""
    bonds = ("peel-60", "peel-80", "peel-100", "peel-120")
    return ("dcb-czm1", "dcb-czm1-linear", "dcb-czm2", "dcb-czm2-linear", *(bonds if full else bonds[-1:]))


def load_scene(name_or_path: str | Path, overrides: Sequence[str] = ()) -> Scene:
    """Read, override and validate a scene.

    Parameters
    ----------
    name_or_path : a packaged name, ``random-SEED`` (`verify.hard.random_scenes`), or the path of a TOML file
    overrides : ``dotted.key=value`` with a TOML value; a bare word is taken as text. Mesh files that are named here are
        found from the working directory and may lie anywhere; those of a scene file lie in its folder or below.

    Raises
    ------
    SceneError
        With one sentence for every thing that is wrong.
    """
    source = str(name_or_path)
    if seed := _RANDOM.fullmatch(source):
        from verify.hard.random_scenes import random_scene

        return parse_scene(random_scene(int(seed[1])).model_dump(), overrides, source)
    path = _FOLDER / f"{source}.toml" if source in packaged_scenes() else Path(name_or_path)
    raw = _read(path, source)
    if not any(_key_of(override) in ("specimen", "specimen.mesh") for override in overrides):
        raw = _beside(path, raw, source)
    return parse_scene({"name": _as_name(path.stem), **raw}, overrides, source)


def parse_scene(raw: Mapping[str, Any], overrides: Sequence[str] = (), source: str = "scene") -> Scene:
    """Validate a scene that is already a dictionary (see ``load_scene``)."""
    wrong: list[str] = []
    for override in overrides:
        try:
            raw = _override(raw, override)
        except ValueError as error:
            wrong.append(str(error))
    sizes = too_large(raw)
    try:
        scene = Scene.model_validate(raw)
        wrong += sizes or out_of_proportion(scene)
    except ValidationError as error:
        found = complaints(error, raw)
        named = {sentence.partition(":")[0] for sentence in found}
        wrong += found + [sentence for sentence in sizes if sentence.partition(":")[0] not in named]
    except ArithmeticError:  # a rule between numbers of such sizes
        wrong += sizes
    if wrong:
        raise SceneError(source, wrong)
    return scene


def _read(path: Path, source: str) -> dict[str, Any]:
    try:
        text = path.read_bytes().decode("utf-8-sig")  # some editors begin with a byte order mark
    except FileNotFoundError:
        known = packaged_scenes()
        hint = suggestion(source, known) or f"the packaged scenes are {', '.join(known)}"
        raise SceneError(source, [f"is neither a packaged scene nor a file; {hint}"]) from None
    except UnicodeDecodeError as error:
        raise SceneError(source, [f"is not a text in UTF-8 (byte {error.start})"]) from None
    except (OSError, ValueError) as error:  # ValueError: a NUL in the path
        raise SceneError(source, [f"cannot be read: {getattr(error, 'strerror', None) or error}"]) from None
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise SceneError(_file_and_line(source, text, str(error)), [f"is not TOML: {error}"]) from None
    except (ValueError, RecursionError) as error:  # an integer of thousands of digits, arrays nested without end
        raise SceneError(source, [f"is not a usable TOML file: {str(error)[:100]}"]) from None


def _beside(path: Path, raw: dict[str, Any], source: str) -> dict[str, Any]:
    """The scene with its mesh files found from where the scene file is, and not from elsewhere.

    A scene comes from others more often than a command line: it must not have files read that it was not sent with.
    """
    specimen = raw.get("specimen")
    if not isinstance(specimen, Mapping) or "mesh" not in specimen:
        return raw
    names = specimen["mesh"]
    if not isinstance(names, str | list):
        return raw
    listed = [names] if isinstance(names, str) else names
    outside = [name for name in listed if isinstance(name, str) and not _is_below(path.parent, name)]
    if outside:
        rule = "must name files in the folder of the scene or below it; --set specimen.mesh=... may name any other"
        raise SceneError(source, [f"specimen.mesh: {rule}, got {name!r}" for name in outside])
    found = [str(path.parent / name) if isinstance(name, str) else name for name in listed]
    return {**raw, "specimen": {**specimen, "mesh": found}}


def _is_below(folder: Path, name: str) -> bool:
    """Whether a path, links followed, stays in a folder."""
    try:
        return (folder / name).resolve().is_relative_to(folder.resolve())
    except (OSError, ValueError, RuntimeError):  # a NUL, links in a circle
        return False


def _file_and_line(source: str, text: str, message: str) -> str:
    line = re.search(r"at line (\d+)", message)
    return f"{source}:{line[1] if line else text.count(chr(10)) + 1}"


def _as_name(stem: str) -> str:
    """A usable default for ``name``: it becomes part of folder names."""
    return re.sub(r"[^A-Za-z0-9._-]+", "-", stem).lstrip("._-")[:80] or "scene"


def _override(raw: Mapping[str, Any], override: str) -> dict[str, Any]:
    """``raw`` with one key replaced; tables on the way are made."""
    key, (_, equals, text) = _key_of(override), (part.strip() for part in override.partition("="))
    if not equals or not _KEY.fullmatch(key):
        raise ValueError(f'--set {override}: must be KEY=VALUE with a dotted key, like "interface.strength=6"')
    return _replaced(raw, key.split("."), _toml_value(text, override))


def _key_of(override: str) -> str:
    return override.partition("=")[0].strip()


def _replaced(table: object, path: list[str], value: object) -> dict[str, Any]:
    old = dict(table) if isinstance(table, Mapping) else {}
    head, *rest = path
    return {**old, head: _replaced(old.get(head), rest, value) if rest else value}


def _toml_value(text: str, override: str) -> object:
    if _BARE_WORD.fullmatch(text) and text not in ("true", "false", "inf", "nan"):
        return text
    try:
        table = tomllib.loads(f"value = {text}")
    except (ValueError, RecursionError):
        table = {}
    if set(table) != {"value"}:
        raise ValueError(f"--set {override}: the value must be TOML, like 6, true or [1.0, 0.2], got {text!r}")
    return table["value"]
