"""Traction laws that no scene has, for tests of what is to hold of any law: one of lines with a plateau, one curved."""

from dataclasses import dataclass

import numpy as np

from iga.interface.laws import TractionLaw


@dataclass(frozen=True)
class TrapezoidalLaw(TractionLaw):
    """A plateau over a part of what is left after g_max, then a line; its area says where it ends."""

    plateau: float = 0.5

    @property
    def g_u(self):
        return self.g_max + (2.0 * self.toughness / self.strength - self.g_max) / (1.0 + self.plateau)

    @property
    def g_2(self):
        """Opening at the end of the plateau."""
        return self.g_max + self.plateau * (self.g_u - self.g_max)

    @property
    def kinks(self):
        return self.g_max, self.g_2, self.g_u

    def envelope(self, k):
        return np.interp(k, [0.0, *self.kinks], [0.0, self.strength, self.strength, 0.0])

    def softening(self, k):
        return np.where(k < self.g_2, 0.0, -self.strength / (self.g_u - self.g_2))

    def work(self, k):
        rising = 0.5 * self.stiffness * np.minimum(k, self.g_max) ** 2
        flat = self.strength * (np.clip(k, self.g_max, self.g_2) - self.g_max)
        k = np.clip(k, self.g_2, self.g_u)
        return rising + flat + 0.5 * (self.strength + self.envelope(k)) * (k - self.g_2)


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


MADE_UP = {"a-trapezoid": TrapezoidalLaw, "a-parabola": ParabolicLaw}
