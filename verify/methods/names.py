"""The built-in methods by name."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from importlib import import_module
from pkgutil import iter_modules

from verify.methods.method import Method, Unsuitable
from verify.scene.schema import Scene
from verify.support.refusal import one_of

__all__ = ["METHODS", "WITH_DOFS", "Unsuitable", "refuse_arms", "refuse_law"]


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


def refuse_law(scene: Scene, who: str, has: Sequence[str]) -> None:
    """Raise Unsuitable where ``who`` does not have the law of a scene, naming the built-in methods that do."""
    law = scene.interface.law
    if law not in has:
        able = have_it(name for name, other in METHODS.items() if law in other.laws())
        raise Unsuitable(f"interface.law: must be {one_of(has)} for {who}, got {law!r}; {able}")


def refuse_arms(scene: Scene, method: Method) -> None:
    """Raise Unsuitable where the arms of a scene differ and the method needs equal ones."""
    specimen = scene.specimen
    slides = method.slides and specimen.slides  # then the method itself refuses unequal arms
    if method.equal_arms and specimen.arms == 2 and not specimen.symmetric and not slides:
        able = have_it(name for name, other in METHODS.items() if not other.equal_arms)
        raise Unsuitable(f"specimen: must have equal arms for {method.name}, got kind {specimen.kind!r}; {able}")


def have_it(names: Iterable[str]) -> str:
    """Words that name the methods which have what another method lacks."""
    *head, last = names
    return f"{', '.join(head)} and {last} have it" if head else f"{last} has it"
