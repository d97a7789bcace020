"""Every key that a scene may have, from the schema."""

from __future__ import annotations

import ast
import inspect
import re
import textwrap
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from itertools import pairwise
from typing import get_args

from pydantic.fields import FieldInfo

from verify.scene.materials import Isotropic, Orthotropic
from verify.scene.schema import Scene
from verify.scene.specimens import SPECIMENS
from verify.scene.stated.uncertainty import DATA_KEYS, UNCERTAIN_TABLES
from verify.scene.tables import Section

MATERIAL_TABLES = ("material", "strip", "substrate")


@dataclass(frozen=True)
class Key:
    """One key of a table of a scene, and the type that declares it; ``table`` is empty at the top."""

    table: str
    name: str
    of: type[Section]

    @property
    def dotted(self) -> str:
        return f"{self.table}.{self.name}" if self.table else self.name

    @property
    def field(self) -> FieldInfo:
        return self.of.model_fields[self.name]

    @property
    def meaning(self) -> str:
        """The text below the key in its type or in a type that this one extends; empty without one."""
        return next((texts[self.name] for base in self.of.__mro__ if self.name in (texts := _texts(base))), "")

    @property
    def dimension(self) -> str:
        """The text in brackets in its meaning, like "stress per length"; empty for a pure number."""
        found = re.search(r"\[([a-z ]+)\]", self.meaning)
        return found[1] if found else ""


@cache
def _texts(declared: type) -> Mapping[str, str]:
    """Name -> text of the annotated names in the body of a type that have a text below them, in one line."""
    found = {}
    source = (
        ast.parse(textwrap.dedent(inspect.getsource(declared))) if issubclass(declared, Section) else ast.Module([], [])
    )
    for part in ast.walk(source):
        for block in (getattr(part, "body", ()), getattr(part, "orelse", ())):
            for node, below in pairwise(block if isinstance(block, list) else ()):
                match node, below:
                    case ast.AnnAssign(target=ast.Name(id=name)), ast.Expr(value=ast.Constant(value=str(text))):
                        found[name] = " ".join(text.split())
    return found


def keys(kind: str) -> tuple[Key, ...]:
    """The keys of a scene with a specimen of this kind and isotropic materials, in the order of the schema; tables that
    may occur more than once are left out."""
    top: list[Key] = []
    inside: list[Key] = []
    for name, field in Scene.model_fields.items():
        table = field.annotation
        if name == "specimen":
            table = SPECIMENS[kind]
        elif name in MATERIAL_TABLES:
            table = Isotropic if name in SPECIMENS[kind].materials else None
        if isinstance(table, type) and issubclass(table, Section):
            inside += keys_of(name, table)
        elif table is not None and name != "published":
            top.append(Key("", name, Scene))
    return (*top, *inside)


def keys_of(name: str, table: type[Section]) -> tuple[Key, ...]:
    return tuple(Key(name, key, table) for key in table.model_fields)


@cache
def _all_keys() -> tuple[Key, ...]:
    """The keys for any specimen and material."""
    several = (keys_of(name, Orthotropic) for name in MATERIAL_TABLES)
    return tuple(dict.fromkeys(key for some in (*map(keys, SPECIMENS), *several) for key in some))


def dotted_keys() -> tuple[str, ...]:
    """The keys that are allowed before the equals sign of ``--set``, for any specimen and material."""
    numbers = (
        key.dotted
        for key in _all_keys()
        if key.table in UNCERTAIN_TABLES and key.field.annotation in (float, float | None)
    )
    uncertain = (f"uncertainty.{name}" for name in (*DATA_KEYS, *numbers))
    return tuple(sorted({*(key.dotted for key in _all_keys()), *uncertain}))


def text_keys() -> frozenset[str]:
    """The keys whose value is any text, or a list of texts."""
    return frozenset(key.dotted for key in _all_keys() if _takes_text(key.field.annotation))


def _takes_text(annotation: object) -> bool:
    return annotation is str or any(map(_takes_text, get_args(annotation)))
