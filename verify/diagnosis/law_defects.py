"""Laws with a defect that codes of others have, by which NURBS solve a scene: an override ``law.NAME=NUMBER``."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields, replace
from typing import Any

import numpy as np

from iga.delamination.problem import Problem
from iga.laws.law import Law
from iga.laws.mixed_law import Driving, MixedLaw
from iga.laws.mixed_laws import SofteningMixed
from iga.laws.mode_ratio import ModeRatio, OfRatio
from iga.laws.traction_law import TractionLaw

#: Part of the square of a sum below which a product counts as this part.
NEARLY_PURE = 1e-12


def defective(problem: Problem, override: str) -> Problem:
    """The problem with the law that an override names."""
    name, _, part = override.removeprefix("law.").partition("=")
    law: Any = problem.bond
    if name == "triangle":
        return replace(problem, bond=_without_triangle(law))
    if name == "summed":
        return replace(problem, bond=_summed(law))
    return replace(problem, bond=_of_kind(KINDS[law.slides, name], law, part=float(part or 0.0)))


def _without_triangle(law: Any) -> Law:
    """With a toughness that is the area beyond the onset: the elastic energy at the onset, S^2 / (2 K), comes on top;
    stiffness and strength stay."""
    if not law.slides:
        more = 1.0 + 1.0 / law.ductility
        found: Law = replace(law, toughness=law.toughness * more, ductility=law.ductility * more)
        return found
    modes = law.modes
    rows = zip(modes.toughness, modes.strength, modes.stiffness, strict=True)
    return replace(law, modes=replace(modes, toughness=tuple(G + 0.5 * S**2 / K for G, S, K in rows)))


def _summed(law: Any) -> Law:
    """With the toughness of `SummedRatio`."""
    modes = SummedRatio(*(getattr(law.modes, field.name) for field in fields(law.modes)))
    found: Law = replace(law, modes=modes)
    return found


def _of_kind(kind: type, law: Any, **values: float) -> Law:
    """The law with the methods of a kind before its own."""
    made: Law = type(kind.__name__, (kind, type(law)), values)(
        **{field.name: getattr(law, field.name) for field in fields(law)}
    )
    return made


class KeptOpening(TractionLaw):
    """A broken bond keeps a ``part`` of its stiffness, as where a code limits damage to 0.999999."""

    part: float

    def secant(self, k: np.ndarray) -> np.ndarray:
        return np.maximum(super().secant(k), self.part * self.stiffness)


class KeptSliding(MixedLaw):
    """The same of a bond that slides as well."""

    part: float

    def _follows(self, driven: np.ndarray, d: np.ndarray, dt: float) -> tuple[np.ndarray, np.ndarray | float]:
        follows, slope = super()._follows(driven, d, dt)
        most = 1.0 - self.part
        return np.minimum(follows, most), np.where(follows < most, slope, 0.0)


class TougherClosed(SofteningMixed):
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


#: Whether a bond slides, and the name of an override -> methods of the law.
KINDS: Mapping[tuple[bool, str], type] = {
    (False, "kept"): KeptOpening,
    (True, "kept"): KeptSliding,
    (True, "sqrt2"): TougherClosed,
}
