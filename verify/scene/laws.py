"""Names of the traction laws that a scene may ask for: those that any solver has in its own table."""

from __future__ import annotations

#: The law that every method has.
PLAIN = "bilinear"

#: Laws with parameters of their own among the keys of a scene.
TRAPEZOIDAL, TABULAR, EXPONENTIAL = "trapezoidal", "tabular", "exponential"


def known() -> tuple[str, ...]:
    """Names of the laws that any solver has, for opening or for opening and sliding."""
    from fem_reference.problem.law import MODELLED_LAWS
    from iga.laws.opening import LAWS

    return tuple(dict.fromkeys((*LAWS, *MODELLED_LAWS, *mixed())))


def mixed() -> tuple[str, ...]:
    """Names of the laws for opening and sliding."""
    from fem_reference.problem.mixed_laws import MODELLED_MIXED_LAWS
    from iga.laws.mixed_laws import MIXED_LAWS

    return tuple(dict.fromkeys((*MIXED_LAWS, *MODELLED_MIXED_LAWS)))
