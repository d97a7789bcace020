"""Names of the traction laws that a scene may ask for: those that any solver has in its own table."""

from __future__ import annotations

#: The law that every method has.
PLAIN = "bilinear"

#: Laws with numbers of their own.
TABULAR, EXPONENTIAL = "tabular", "exponential"
#: Law -> its own keys in a scene.
OWN_KEYS = {
    "trapezoidal": ("plateau",),
    "trilinear": ("knee", "knee_traction"),
    TABULAR: ("table",),
    "exponential-softening": ("decay",),
}


def known() -> tuple[str, ...]:
    """Names of the laws that any solver has, for opening or for opening and sliding."""
    from fem_reference.problem.law import MODELLED_LAWS
    from iga.laws.laws import LAWS

    return tuple(dict.fromkeys((*LAWS, *MODELLED_LAWS, *mixed())))


def mixed() -> tuple[str, ...]:
    """Names of the laws for opening and sliding."""
    from fem_reference.problem.mixed_laws import MODELLED_MIXED_LAWS
    from iga.laws.laws import LAWS

    return tuple(dict.fromkeys((*LAWS, *MODELLED_MIXED_LAWS)))
