"""The built-in methods by name."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from importlib import import_module
from pkgutil import iter_modules

from verify.methods.method import Method, Unsuitable

__all__ = ["METHODS", "WITH_DOFS", "Unsuitable"]


def _found() -> Iterator[Method]:
    """Every `Method` that a module of the folder of built-in ones holds by itself or in a tuple."""
    folder = import_module("verify.methods.built_in")
    for one in iter_modules(folder.__path__):
        for value in vars(import_module(f"{folder.__name__}.{one.name}")).values():
            held = value if isinstance(value, tuple) else (value,)
            yield from (method for method in held if isinstance(method, Method))


METHODS: Mapping[str, Method] = {
    method.name: method for method in sorted(_found(), key=lambda method: (method.place, method.name))
}

#: Methods whose mesh size ``discretization.dofs`` sets.
WITH_DOFS = tuple(method.name for method in METHODS.values() if method.with_dofs)
