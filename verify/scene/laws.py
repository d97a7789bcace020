"""Which method has which traction law: each solver's own table says, and a scene takes what any of them has."""

from __future__ import annotations

from collections.abc import Iterable

from verify.scene.tables import one_of

#: The law that every method has.
PLAIN = "bilinear"


def known() -> tuple[str, ...]:
    """Names of the laws that any solver has."""
    return tuple(dict.fromkeys((*_iga(), *_dolfinx())))


def laws_of(method: str) -> tuple[str, ...]:
    """Names of the laws of a built-in method. The beam solves zones of linear springs; LEFM asks for no law."""
    return {"dolfinx": _dolfinx(), "beam": (PLAIN,), "lefm": known()}.get(method, _iga())


def refusal(law: str, method: str, has: Iterable[str], methods: Iterable[str]) -> str:
    """Why a method that ``has`` other laws cannot solve with this one; empty where it can.

    ``methods`` are the built-in ones, of which those with the law are named.
    """
    has = tuple(has)
    if law in has:
        return ""
    others = [other for other in methods if law in laws_of(other)]
    *head, last = others
    able = f"{', '.join(head)} and {last} have it" if head else f"{last} has it"
    return f"interface.law: must be {one_of(has)} for {method}, got {law!r}; {able}"


def _iga() -> tuple[str, ...]:
    from iga.interface.laws import LAWS

    return tuple(LAWS)


def _dolfinx() -> tuple[str, ...]:
    from fem_reference.problem.law import MODELLED_LAWS

    return tuple(MODELLED_LAWS)
