"""From a dictionary and overrides to a valid scene, or one sentence for every fault."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Mapping, Sequence
from typing import Any

from pydantic import ValidationError

from verify.scene.complaints import complaints
from verify.scene.magnitudes import too_large
from verify.scene.schema import Scene
from verify.support.refusal import Refusal

_KEY = re.compile(r"[A-Za-z_][A-Za-z0-9_-]*(\.[A-Za-z_][A-Za-z0-9_-]*)*")
#: Largest number of parts of a dotted key; keys of scenes have up to three.
DEEPEST = 20
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
        wrong += sizes or _of_the_bond(scene)
    except ValidationError as error:
        found = complaints(error, raw)
        named = {sentence.partition(":")[0] for sentence in found}
        wrong += found + [sentence for sentence in sizes if sentence.partition(":")[0] not in named]
    except ArithmeticError:  # a rule overflows with numbers of such sizes
        wrong += sizes
    if wrong:
        raise SceneError(source, wrong)
    return scene


def _of_the_bond(scene: Scene) -> list[str]:
    """A sentence for a bond that slides and stores too much at the onset of damage; computed last, as this imports
    NumPy."""
    if scene.interface.slides:
        from verify.scene.bond.mixed import mixed_bond

        try:
            mixed_bond(scene)
        except Refusal as error:
            return [f"interface.{error}"]
    return []


def _override(raw: Mapping[str, Any], override: str) -> dict[str, Any]:
    """``raw`` with one key replaced; missing tables are created."""
    key, (_, equals, text) = _key_of(override), (part.strip() for part in override.partition("="))
    if not equals or not _KEY.fullmatch(key):
        raise ValueError(f'--set {override}: must be KEY=VALUE with a dotted key, like "interface.strength=6"')
    if key.count(".") >= DEEPEST:
        raise ValueError(f"--set {key[:30]}...: the key must be of at most {DEEPEST} parts, got {key.count('.') + 1}")
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
        from verify.scene.keys import text_keys  # imported here, as few overrides need it

        if text and text[0] not in "\"'[{" and _key_of(override) in text_keys():
            return text
        raise ValueError(f"--set {override}: the value must be TOML, like 6, true or [1.0, 0.2], got {text!r}")
    return table["value"]
