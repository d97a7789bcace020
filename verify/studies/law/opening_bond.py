"""A bond that only opens, with a mode I law that has no counterpart for sliding."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike

from verify.theory.law import Polyline
from verify.theory.mixed_law import MixedBond


@dataclass(frozen=True)
class OpeningBond(MixedBond):
    """A bond whose damage is that of a mode I law ``of`` straight lines and depends on the opening alone.

    Strength, toughness and stiffness are pairs as for any bond; both entries are the value of opening.
    """

    of: Polyline = field(kw_only=True)

    def __post_init__(self) -> None:
        """No check: the mode I law has been checked already."""

    def corners(self, B: ArrayLike, pressure: ArrayLike = 0.0) -> tuple[np.ndarray, ...]:
        """Sizes lambda of the jumps at the corners of the law."""
        return tuple(self.stiffness[0] ** 0.5 * self.of.corners[:, 0])

    def driving(self, g: ArrayLike, s: ArrayLike) -> np.ndarray:
        """Damage on first loading to openings g (n,)."""
        return self.of.damage(np.maximum(g, 0.0))
