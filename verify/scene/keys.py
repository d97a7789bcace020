"""Every key that a scene may have, from the schema."""

from __future__ import annotations

import ast
import inspect
import re
import textwrap
from collections.abc import Iterator, Mapping
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
    if not issubclass(declared, Section):
        return {}
    (body,) = ast.parse(textwrap.dedent(inspect.getsource(declared))).body
    blocks = [
        (part.body, part.orelse) if isinstance(part, ast.If) else (part.body,)
        for part in ast.walk(body)
        if isinstance(part, ast.ClassDef | ast.If)
    ]
    found = {}
    for node, below in (pair for parts in blocks for block in parts for pair in pairwise(block)):
        match node, below:
            case ast.AnnAssign(target=ast.Name(id=name)), ast.Expr(value=ast.Constant(value=str(text))):
                found[name] = " ".join(text.split())
    return found


def tables(kind: str, material: type[Section] = Isotropic) -> Iterator[tuple[str, type[Section]]]:
    """Name and type of the tables of a scene with a specimen of this kind, in the order of the schema."""
    for name, field in Scene.model_fields.items():
        if name == "specimen":
            yield name, SPECIMENS[kind]
        elif name in SPECIMENS[kind].materials:
            yield name, material
        elif isinstance(field.annotation, type) and issubclass(field.annotation, Section):
            yield name, field.annotation


def keys(kind: str) -> tuple[Key, ...]:
    """The keys of a scene with isotropic materials; tables that may occur more than once are left out."""
    known = dict(tables(kind))
    several = {name for specimen in SPECIMENS.values() for name in specimen.materials} | {"published"}
    top = [key for key in keys_of("", Scene) if key.name not in {*known, *several}]
    return (*top, *(key for name, table in known.items() for key in keys_of(name, table)))


def keys_of(name: str, table: type[Section]) -> tuple[Key, ...]:
    return tuple(Key(name, key, table) for key in table.model_fields)


def dotted_keys() -> tuple[str, ...]:
    """The keys that are allowed before the equals sign of ``--set``, for any specimen and material."""
    found = [key for kind in SPECIMENS for key in keys(kind)]
    for kind in SPECIMENS:
        found += [key for name in SPECIMENS[kind].materials for key in keys_of(name, Orthotropic)]
    uncertain = [*DATA_KEYS, *(key.dotted for key in found if key.table in UNCERTAIN_TABLES and _is_number(key))]
    return tuple(sorted({*(key.dotted for key in found), *(f"uncertainty.{name}" for name in uncertain)}))


def text_keys() -> frozenset[str]:
    """The keys whose value is any text, or a list of texts."""
    return frozenset(key.dotted for kind in SPECIMENS for key in keys(kind) if _takes_text(key.field.annotation))


def _takes_text(annotation: object) -> bool:
    return annotation is str or any(_takes_text(one) for one in get_args(annotation))


def _is_number(key: Key) -> bool:
    return key.field.annotation in (float, float | None)
