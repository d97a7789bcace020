"""A bond that only opens, with a mode I law that has no counterpart for sliding."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from verify.theory.law import Polyline
from verify.theory.mixed_law import MixedBond


@dataclass(frozen=True)
class OpeningBond(MixedBond):
    """A bond whose damage is that of a mode I law of straight lines and depends on the opening alone.

    Strength, toughness and stiffness are pairs as for any bond; both entries are the value of opening.
    """

    of: Polyline | None = None

    def __post_init__(self) -> None:
        """No check: the mode I law has been checked already."""

    @property
    def envelope(self) -> Polyline:
        """The mode I law."""
        assert self.of is not None
        return self.of

    @property
    def kinks(self) -> tuple[float, ...]:
        """Openings at which the slope of the law jumps."""
        return tuple(float(one) for one in self.envelope.corners[:, 0])

    def driving(self, g: ArrayLike, s: ArrayLike) -> np.ndarray:
        """Damage on first loading to openings g (n,)."""
        return self.envelope.damage(np.maximum(np.asarray(g, dtype=float), 0.0))

    def critical(self, B: ArrayLike) -> np.ndarray:
        """The toughness of opening, whatever the mode ratio."""
        return np.full_like(np.asarray(B, dtype=float), self.toughness[0])


def opening_bond(of: Polyline) -> OpeningBond:
    """The bond of a mode I law."""
    strength, toughness, stiffness = ((one, one) for one in (of.strength, of.toughness, of.stiffness))
    return OpeningBond("tabular", strength, toughness, stiffness, of.penalty, contact=of.contact, of=of)
