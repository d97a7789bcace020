"""A problem whose bond opens alone, in the numbers of its traction law."""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np

from iga.laws.law import Law
from iga.laws.laws import LAWS
from iga.laws.shapes import Softening
from iga.specimen.problem import Debonding
from iga.specimen.ranges import require, require_positive

#: Stiffness of the contact over that of the intact bond, where a problem does not state its penalty.
CONTACT_RATIO = 100.0


@dataclass(frozen=True, kw_only=True)
class OpeningProblem(Debonding, Softening):
    """``law_name`` is one of `iga.laws.laws.LAWS`. ``ductility`` is 2 toughness / (strength g_max), with g_max the
    gap at which damage begins; for the bilinear law it is the gap at separation over g_max. ``penalty`` is the
    stiffness of the contact, `CONTACT_RATIO` times that of the bond where left out. Keys of a shape are those of
    `iga.laws.shapes.Softening`; ``strength``, ``toughness`` and ``ductility`` become those of a table.
    """

    strength: float
    toughness: float
    ductility: float = 12.5
    penalty: float | None = None
    law_name: str = "bilinear"
    contact: bool = True
    irreversible: bool = True

    def __post_init__(self) -> None:
        super().__post_init__()
        require(self, "law_name", self.law_name in LAWS, f"one of {', '.join(LAWS)}")
        for key in ("contact", "irreversible"):
            require(self, key, isinstance(getattr(self, key), bool | np.bool_), "True or False")
        require_positive(self, "strength", "toughness", "penalty")
        require(self, "ductility", 1.0 < self.ductility < np.inf, "> 1 and finite")
        law = self.law  # refuses parameters out of their range
        if self.table:
            ((p, G),) = law.pure_modes
            for key, value in (("strength", p), ("toughness", G), ("ductility", 2.0 * G / p / law.g_max)):
                object.__setattr__(self, key, float(value))

    @property
    def law(self) -> Law:
        shape, stiffness = LAWS[self.law_name], 0.5 * self.strength**2 * self.ductility / self.toughness
        penalty = CONTACT_RATIO * stiffness if self.penalty is None else self.penalty
        own = {one.name: getattr(self, one.name) for one in fields(Softening) if one in fields(shape)}
        return shape.opening(
            self.strength, self.toughness, self.ductility, penalty, self.contact, self.irreversible, **own
        )
