"""Laws with a defect that codes of others have, by which NURBS solve a scene: an override ``law.NAME=NUMBER``."""

from __future__ import annotations

from collections.abc import Mapping
from copy import copy
from dataclasses import fields, replace
from typing import Any

import numpy as np

from iga.delamination.problem import Problem
from iga.laws.law import History, Law
from iga.laws.mixed_law import Driving, MixedLaw
from iga.laws.traction_law import TractionLaw


def defective(problem: Problem, override: str) -> Problem:
    """The problem with the law that an override names."""
    name, _, number = override.removeprefix("law.").partition("=")
    law, steps = problem.bond, problem.steps
    for one in name.split("+"):
        if one == "triangle":
            law = _without_triangle(law)
        else:
            law = _of_kind(KINDS[law.slides, one], law, part=float(number or 0.0))
        steps = int(number) if one == "lagged" else steps
    return replace(problem, bond=law, steps=steps)


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


class TougherClosed(MixedLaw):
    """Sliding takes sqrt(2) of the toughness where faces do not open, as in BiLinearMixedModeTraction of MOOSE."""

    def driving(self, g: np.ndarray, s: np.ndarray, stronger: np.ndarray | None) -> Driving:
        open_, modes = super().driving(g, s, stronger), self.modes
        tougher = replace(self, modes=replace(modes, toughness=tuple(2.0**0.5 * G for G in modes.toughness)))
        closed = super(TougherClosed, tougher).driving(g, s, stronger)
        return Driving(*(np.where(g > 0.0, a, b) for a, b in zip(open_, closed, strict=True)))


class Lagged(MixedLaw):
    """The mode ratio is that at the end of the step before, which the history keeps in place of a slip."""

    before: np.ndarray | None = None

    def start(self, n: int) -> History:
        return History(np.zeros(n), np.zeros(n))

    def stored(self, *jump_and_history: Any) -> Any:
        g, s, history = jump_and_history
        return super().stored(g, s, History(history.d))

    def released(self, g: np.ndarray, s: np.ndarray, history: History) -> np.ndarray:
        return super().released(g, s, History(history.d))

    def _traction(self, *given: Any) -> Any:
        (g, s, history, *rest), law = given, copy(self)
        object.__setattr__(law, "before", history.slip)
        found = super(Lagged, law)._traction(g, s, History(history.d), *rest)
        (opening, sliding), _ = self._energies(g, s)
        ratio = sliding / np.maximum(opening + sliding, np.finfo(float).tiny)
        return found._replace(history=History(found.history.d, ratio))

    def _driven(self, g: np.ndarray, s: np.ndarray, pressure: np.ndarray) -> Driving:
        if self.before is None:
            return super()._driven(g, s, pressure)
        (opening, sliding), (by_g, by_s) = self._energies(g, s)
        size, (K, Ks) = np.maximum(np.sqrt(opening + sliding), np.finfo(float).tiny), self.stiffness
        open_, slid = np.sqrt((1.0 - self.before) / K), np.sqrt(self.before / Ks)
        found = super()._driven(size * open_, size * slid, pressure)
        slope = (found.by_g * open_ + found.by_s * slid) / size
        return Driving(found.d, slope * by_g, slope * by_s)

    def _energies(self, g: np.ndarray, s: np.ndarray) -> tuple[tuple[np.ndarray, ...], tuple[np.ndarray, ...]]:
        """Twice the elastic energies (n,) of opening and sliding, and half their slopes."""
        (K, Ks), opened = self.stiffness, np.maximum(g, 0.0)
        return (K * opened**2, Ks * s**2), (K * opened, Ks * s)


#: Whether a bond slides, and the name of an override -> methods of the law.
KINDS: Mapping[tuple[bool, str], type[Law]] = {
    (False, "kept"): KeptOpening,
    (True, "kept"): KeptSliding,
    (True, "sqrt2"): TougherClosed,
    (True, "lagged"): Lagged,
}
