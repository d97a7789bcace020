"""Traction laws that no scene has, for tests of what is to hold of any law: one of lines, one curved."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from iga.laws.opening import SofteningLaw
from iga.laws.shapes import Lines
from iga.laws.traction_law import TractionLaw


@dataclass(frozen=True)
class BridgedLaw(SofteningLaw):
    """A steep line down to a quarter of the strength, as of a matrix, and a flat one, as of fibres that bridge it."""

    @cached_property
    def shape(self):
        return Lines(((0.0, 1.0), (1.0 / 6.0, 0.25), (1.0, 0.0)))


@dataclass(frozen=True)
class ParabolicLaw(TractionLaw):
    """``p_max (1 - s)^2`` with s from 0 at g_max to 1 at g_u, where there is no kink."""

    @property
    def g_u(self):
        return self.g_max + 3.0 * (self.toughness / self.strength - 0.5 * self.g_max)

    def left(self, k):
        """1 - s."""
        return np.clip((self.g_u - k) / (self.g_u - self.g_max), 0.0, 1.0)

    def envelope(self, k):
        return np.where(k <= self.g_max, self.stiffness * k, self.strength * self.left(k) ** 2)

    def softening(self, k):
        return -2.0 * self.strength * self.left(k) / (self.g_u - self.g_max)

    def work(self, k):
        rising = 0.5 * self.stiffness * np.minimum(k, self.g_max) ** 2
        return rising + self.strength * (self.g_u - self.g_max) * (1.0 - self.left(k) ** 3) / 3.0


MADE_UP = {"bridged": BridgedLaw, "a-parabola": ParabolicLaw}
