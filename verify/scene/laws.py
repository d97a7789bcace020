"""Names of the traction laws that a scene may ask for: those that any solver has in its own table."""

from __future__ import annotations

#: The law that every method has.
PLAIN = "bilinear"


def known() -> tuple[str, ...]:
    """Names of the laws that any solver has."""
    from fem_reference.problem.law import MODELLED_LAWS
    from iga.interface.laws import LAWS

    return tuple(dict.fromkeys((*LAWS, *MODELLED_LAWS)))
