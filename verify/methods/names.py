"""The built-in methods by name."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from importlib import import_module
from pkgutil import iter_modules

from verify.methods.method import Method, NotRun, Unsuitable
from verify.scene.schema import Scene
from verify.scene.tables import one_of

__all__ = ["METHODS", "WITH_DOFS", "NotRun", "Unsuitable", "refuse_law"]


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

#: Those whose mesh ``discretization.dofs`` sets.
WITH_DOFS = tuple(method.name for method in METHODS.values() if method.with_dofs)


def refuse_law(scene: Scene, who: str, has: Sequence[str]) -> None:
    """Raise Unsuitable where ``who`` does not have the law of a scene, naming the built-in methods that do."""
    law = scene.interface.law
    if law in has:
        return
    *head, last = [name for name, other in METHODS.items() if law in other.laws()]
    able = f"{', '.join(head)} and {last} have it" if head else f"{last} has it"
    raise Unsuitable(f"interface.law: must be {one_of(has)} for {who}, got {law!r}; {able}")
