"""Laws with a defect that codes of others have, by which NURBS and beam solve a scene: an override ``law.NAME=NUMBER``.

The laws of both stay two: each has its defects by itself.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import fields, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from iga.laws.law import Driving, Law
from iga.laws.laws import ShapedLaw
from iga.laws.mode_ratio import ModeRatio, OfRatio
from verify.theory.law import KnownLaw
from verify.theory.mixed_law import MixedBond

#: Part of the square of a sum below which a product counts as this part.
NEARLY_PURE = 1e-12


def defective(problem: Any, overrides: Sequence[str]) -> Any:
    """The problem of either solver with the law that the overrides name."""
    if isinstance(problem, tuple):  # NURBS: the module that solves, and its problem
        return problem[0], defective(problem[1], overrides)
    law = problem.bond
    for override in overrides:
        name, _, part = override.removeprefix("law.").partition("=")
        if name == "summed" and isinstance(law, ShapedLaw):
            modes = SummedRatio(*(getattr(law.modes, field.name) for field in fields(law.modes)))
            law = replace(law, modes=modes)
            continue
        kind = next(kind for kind in KINDS[name] if isinstance(law, kind.__mro__[1]))
        values = {"part": float(part)} if part else {}
        made = type(kind.__name__, (kind, type(law)), values)
        law = made(**{field.name: getattr(law, field.name) for field in fields(law)})
    return replace(problem, bond=law)


class KeptPart(Law):
    """A broken bond keeps a ``part`` of its stiffness, as where a code limits damage to 0.999999."""

    part: float

    def kept(self, d: np.ndarray) -> tuple[np.ndarray, np.ndarray | float]:
        left, slope = super().kept(d)
        return np.maximum(left, self.part), np.where(left > self.part, slope, 0.0)


class TougherClosed(ShapedLaw):
    """Sliding takes sqrt(2) of the toughness where faces do not open, as in BiLinearMixedModeTraction of MOOSE."""

    def driving(self, g: np.ndarray, s: np.ndarray, stronger: np.ndarray | None) -> Driving:
        open_, modes = super().driving(g, s, stronger), self.modes
        tougher = replace(self, modes=replace(modes, toughness=tuple(2.0**0.5 * G for G in modes.toughness)))
        closed = super(TougherClosed, tougher).driving(g, s, stronger)
        return Driving(*(np.where(g > 0.0, a, b) for a, b in zip(open_, closed, strict=True)))


class SummedRatio(ModeRatio):
    """The toughness has (1 + s/g)^2 in place of 1 + (s/g)^2, as in CohesiveLaw of fedoo 1.1."""

    def at(self, B: np.ndarray) -> tuple[OfRatio, OfRatio]:
        onset, (G, slope) = super().at(B)
        K, Ks = self.stiffness
        opening, sliding = (1.0 - B) * Ks, B * K
        both = opening + sliding
        mean = np.sqrt(np.maximum(opening * sliding, NEARLY_PURE * both**2))  # no slope without bound
        more = 1.0 + 2.0 * mean / both
        change = (sliding * -Ks + opening * K) / (mean * both) - 2.0 * mean * (K - Ks) / both**2
        return onset, (G * more, slope * more + G * change)


class SummedOfBeam(MixedBond):
    """The same of the beam, with ``(s/g)^2 = B/(1 - B) K/Ks``."""

    def by_criterion(self, B: ArrayLike) -> np.ndarray:
        (K, Ks), B = self.slopes, np.asarray(B, dtype=float)
        opening, sliding = (1.0 - B) * Ks, B * K
        return super().by_criterion(B) * (1.0 + 2.0 * np.sqrt(opening * sliding) / (opening + sliding))


class KeptOfBeam(KnownLaw):
    """The same of the beam."""

    part: float

    def driving(self, g: ArrayLike, s: ArrayLike) -> np.ndarray:
        return np.minimum(super().driving(g, s), 1.0 - self.part)


class KeptSlidingOfBeam(MixedBond):
    """The same of the beam."""

    part: float

    def driving(self, g: ArrayLike, s: ArrayLike) -> np.ndarray:
        return np.minimum(super().driving(g, s), 1.0 - self.part)


class TougherClosedOfBeam(MixedBond):
    """The same of the beam."""

    def _where_open(self, of: str, g: ArrayLike, s: ArrayLike) -> np.ndarray:
        G_I, G_II = self.toughness
        tougher = replace(self, toughness=(2.0**0.5 * G_I, 2.0**0.5 * G_II))
        opened, closed = (getattr(super(TougherClosedOfBeam, one), of)(g, s) for one in (self, tougher))
        return np.where(np.asarray(g) > 0.0, opened, closed)

    def driving(self, g: ArrayLike, s: ArrayLike) -> np.ndarray:
        return self._where_open("driving", g, s)

    def progress(self, g: ArrayLike, s: ArrayLike) -> np.ndarray:
        return self._where_open("progress", g, s)


#: Name of an override -> methods that come before those of a law, by what the law is.
KINDS: Mapping[str, tuple[type, ...]] = {
    "kept": (KeptPart, KeptOfBeam, KeptSlidingOfBeam),
    "sqrt2": (TougherClosed, TougherClosedOfBeam),
    "summed": (SummedOfBeam,),
}
