"""The bases by name: every `Basis` of a module of this folder."""

from __future__ import annotations

from collections.abc import Mapping
from importlib import import_module
from pkgutil import iter_modules

from iga import bases
from iga.bases.basis import Basis


def _found() -> Mapping[str, Basis]:
    modules = [import_module(f"{bases.__name__}.{one.name}") for one in iter_modules(bases.__path__)]
    found = {value.name: value for module in modules for value in vars(module).values() if isinstance(value, Basis)}
    return dict(sorted(found.items(), key=lambda one: (one[1].place, one[0])))


BASES = _found()


def find(name: str) -> Basis:
    """The basis of a name. Raises ValueError where there is none."""
    if name not in BASES:
        *head, last = [f'"{known}"' for known in BASES]
        raise ValueError(f"basis must be {', '.join(head)} or {last}, got {name!r}")
    return BASES[name]
