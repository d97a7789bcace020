"""Traction laws that no scene has, for tests of what is to hold of any law: one of lines, one curved."""

from dataclasses import dataclass
from functools import cached_property
from types import SimpleNamespace

import numpy as np

from iga.laws.law import History
from iga.laws.laws import ShapedLaw
from iga.laws.shapes import Lines, Shape


@dataclass(frozen=True)
class BridgedLaw(ShapedLaw):
    """A steep line down to a quarter of the strength, as of a matrix, and a flat one, as of fibres that bridge it."""

    @cached_property
    def shape(self):
        return Lines(((0.0, 1.0), (1.0 / 6.0, 0.25), (1.0, 0.0)))


class Parabola(Shape):
    """``(1 - x)^2``, without a kink at failure."""

    def at(self, left):
        left = np.clip(left, 0.0, 1.0)
        return left**2, 2.0 * left

    def rest(self, left):
        return np.clip(left, 0.0, 1.0) ** 3 / 3.0

    def reached(self, kept, slender):
        half = 0.5 * kept * slender
        left = np.sqrt(half**2 + kept * (1.0 + slender)) - half
        x = 1.0 + slender * (1.0 - left)
        return x, slender * x / (2.0 * left + kept * slender)


@dataclass(frozen=True)
class ParabolicLaw(ShapedLaw):
    """The law of a `Parabola`."""

    @cached_property
    def shape(self):
        return Parabola()


MADE_UP = {"bridged": BridgedLaw, "a-parabola": ParabolicLaw}


def answer(law, g, k):
    """Tractions, slopes and histories (n,) of a law that opens alone, at gaps and histories (n,)."""
    f_qc, slope_qcc, after = law.respond(g[:, None], History(k))
    return f_qc[:, 0], slope_qcc[:, 0, 0], after.d


def energies(law, g, k):
    """Energies (n,) in cohesion and contact, and dissipated, of a law that opens alone."""
    found = law.stored(g, History(k))
    return found.cohesion, found.contact, found.dissipated


def both(law, g, s, past, dt=0.0, bonded=None):
    """Tractions p, t and their slopes (n,) by opening and slip of a law that slides, and its history."""
    f_qc, slope_qcc, after = law.respond(np.stack([g, s], axis=1), past, dt, bonded_q=bonded)
    names = ("p", "t", "dp_dg", "dp_ds", "dt_dg", "dt_ds")
    return SimpleNamespace(**dict(zip(names, [*f_qc.T, *slope_qcc.reshape(-1, 4).T], strict=True)), history=after)
