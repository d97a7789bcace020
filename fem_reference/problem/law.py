"""The traction laws in mode I, for all points of the interface at once: lines between corners, and an exponential."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import numpy as np

from fem_reference.problem.bond_law import BondLaw

#: Openings and tractions (n_c,) of the corners of a law, the origin first.
Corners = tuple[np.ndarray, np.ndarray]


@dataclass(frozen=True)
class Law(BondLaw):
    """Traction against opening with damage on opening and a penalty on closing.

    p = (1 - d) K0 g, with the damage d(k) for which p follows the lines between the `corners` while the largest gap k
    grows; damage begins at the first corner, at g_max. g < 0: p = penalty g. This class is the bilinear law with
    corners at p_max and g_u (Alfano and Crisfield 2001, Int. J. Numer. Methods Eng. 50, 1701-1736).

    Parameters
    ----------
    strength, toughness, ductility, penalty : p_max [stress], G_Ic [energy per area], g_u / g_max, stiffness against
        closing [stress per length].
    contact : if False, (1 - d) K0 continues into closing.
    irreversible : if False, k is the present gap: nonlinear elastic.
    """

    strength: float
    toughness: float
    ductility: float
    penalty: float
    contact: bool = True
    irreversible: bool = True
    slides: ClassVar[bool] = False

    @cached_property
    def corners(self) -> Corners:
        """Openings and tractions (n_c,) of the corners, the origin first."""
        g_open = 2.0 * self.toughness / self.strength
        return np.array([0.0, g_open / self.ductility, g_open]), np.array([0.0, self.strength, 0.0])

    @property
    def g_open(self) -> float:
        """Opening g_u from which the traction is zero."""
        return float(self.corners[0][-1])

    @property
    def g_peak(self) -> float:
        """Opening g_max at which damage begins."""
        return float(self.corners[0][1])

    @property
    def begun(self) -> float:
        """The measure of a jump is the gap."""
        return self.g_peak

    @property
    def failed(self) -> float:
        return self.g_open

    @property
    def unit(self) -> float:
        return self.g_open

    @property
    def K0(self) -> float:
        return float(self.corners[1][1] / self.corners[0][1])

    def intact(self, bonded_q: np.ndarray) -> np.ndarray:
        return np.zeros((bonded_q.size, 1))

    def respond(
        self, jump_qj: np.ndarray, k_qh: np.ndarray, bonded_q: np.ndarray, dt: float
    ) -> tuple[np.ndarray, np.ndarray]:
        g_q = jump_qj[:, 0]
        carries_q = bonded_q | self._closed(g_q)
        p_q, dp_q = (np.where(carries_q, one_q, 0.0) for one_q in self.traction(g_q, k_qh[:, 0]))
        return p_q[:, None], dp_q[:, None, None]

    def committed(self, jump_qj: np.ndarray, k_qh: np.ndarray, bonded_q: np.ndarray, dt: float) -> np.ndarray:
        """Largest gap so far, 0 where nothing is bonded."""
        return np.where(bonded_q[:, None], self.history(jump_qj, k_qh), 0.0)

    def damaged(self, k_qh: np.ndarray, bonded_q: np.ndarray) -> np.ndarray:
        return np.where(bonded_q, self.damage(k_qh[:, 0]), 1.0)

    def held(self, k_qh: np.ndarray) -> np.ndarray:
        return k_qh[:, 0]

    def measure(self, jump_qj: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return jump_qj[:, 0], np.ones_like(jump_qj)

    def balance(self, jump_qj: np.ndarray, k_qh: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray | None]:
        return self.energies(jump_qj[:, 0], k_qh[:, 0])

    def history(self, g_q: np.ndarray, k_q: np.ndarray) -> np.ndarray:
        """Largest gap (...,) so far, the present gap included."""
        return np.maximum(g_q, k_q if self.irreversible else 0.0)

    def damage(self, k_q: np.ndarray) -> np.ndarray:
        """d (n_q,), 0 intact to 1 open."""
        k_q = np.clip(k_q, self.g_peak, self.g_open)
        return np.maximum(1.0 - np.interp(k_q, *self.corners) / (self.K0 * k_q), 0.0)

    def softening(self, k_q: np.ndarray) -> np.ndarray:
        """Slope (n_q,) of the envelope between g_max and g_u."""
        g_c, p_c = self.corners
        return (np.diff(p_c) / np.diff(g_c))[self._line(k_q)]

    def traction(self, g_q: np.ndarray, k_q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Traction p and slope dp/dg, (n_q,) each, from the present gap and the history committed before it."""
        k_new_q = self.history(g_q, k_q)
        secant_q = (1.0 - self.damage(k_new_q)) * self.K0
        softens_q = (g_q >= k_new_q) & (g_q > self.g_peak) & (g_q < self.g_open)
        slope_q = np.where(softens_q, self.softening(k_new_q), secant_q)
        closed_q = self._closed(g_q)
        return np.where(closed_q, self.penalty, secant_q) * g_q, np.where(closed_q, self.penalty, slope_q)

    def energies(self, g_q: np.ndarray, k_q: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Energies per area, (n_q,) each: recoverable from cohesion, stored in contact, dissipated.

        The history ``k_q`` includes the present gap ``g_q``.
        """
        secant_q = (1.0 - self.damage(k_q)) * self.K0
        recoverable_q = 0.5 * secant_q * g_q**2
        lost_q = self.area(k_q) - 0.5 * secant_q * k_q**2
        if not self.irreversible:
            recoverable_q, lost_q = recoverable_q + lost_q, np.zeros_like(g_q)
        closed_q = self._closed(g_q)
        return np.where(closed_q, 0.0, recoverable_q), np.where(closed_q, 0.5 * self.penalty * g_q**2, 0.0), lost_q

    def area(self, k_q: np.ndarray) -> np.ndarray:
        """Integral (n_q,) of the envelope from 0 to k >= 0; G_Ic from g_u on."""
        g_c, p_c = self.corners
        before_c = np.cumsum(np.concatenate([[0.0], 0.5 * (p_c[1:] + p_c[:-1]) * np.diff(g_c)]))
        line_q, k_q = self._line(k_q), np.minimum(k_q, g_c[-1])
        return before_c[line_q] + 0.5 * (p_c[line_q] + np.interp(k_q, g_c, p_c)) * (k_q - g_c[line_q])

    def _line(self, k_q: np.ndarray) -> np.ndarray:
        """Number (n_q,) of the line that k >= 0 is on; at a corner of the one that begins there."""
        g_c = self.corners[0]
        return np.clip(np.searchsorted(g_c, k_q, side="right") - 1, 0, g_c.size - 2)

    def _closed(self, g_q: np.ndarray) -> np.ndarray:
        return (g_q < 0.0) & self.contact


@dataclass(frozen=True)
class TrapezoidalLaw(Law):
    """Bilinear with a level top: p = p_max for the part ``plateau`` of the way w from g_max to g_u, then a line to 0.

    w = (2 G_Ic - p_max g_max) / ((1 + plateau) p_max). Raises ValueError for a ``plateau`` outside [0, 1).
    """

    plateau: float = 0.5

    def __post_init__(self) -> None:
        if not 0.0 <= self.plateau < 1.0:
            raise ValueError(f"plateau: must be in [0, 1), got {self.plateau}")

    @cached_property
    def corners(self) -> Corners:
        """Openings and tractions (n_c,) of the corners, the origin first; a level top of no length is left out."""
        (_, g_peak, g_bilinear), p_c = super().corners
        way = (g_bilinear - g_peak) / (1.0 + self.plateau)
        if self.plateau == 0.0:
            return np.array([0.0, g_peak, g_peak + way]), p_c
        g_c = np.array([0.0, g_peak, g_peak + self.plateau * way, g_peak + way])
        return g_c, np.array([0.0, self.strength, self.strength, 0.0])


@dataclass(frozen=True)
class TabularLaw(Law):
    """Lines from the origin through the openings and tractions of ``table``; damage begins at the first.

    Strength, toughness and ductility, 2 G_Ic / (p_max g_max), are computed from the table; given values are ignored.
    Raises ValueError for less than two pairs, openings that do not rise from above 0, a last traction other than 0,
    another one that is not > 0, or a secant p / g that does not fall.
    """

    table: tuple[tuple[float, float], ...] = ()

    def __post_init__(self) -> None:
        if np.shape(self.table)[1:] != (2,) or len(self.table) < 2 or not np.all(np.isfinite(self.table)):
            raise ValueError(f"table: must be two or more pairs of opening and traction, got {self.table}")
        g_c, p_c = self.corners
        if not np.all(np.diff(g_c) > 0.0):
            raise ValueError(f"table: must have openings that rise from above 0, got {g_c[1:].tolist()}")
        if not np.all(p_c[1:-1] > 0.0) or p_c[-1] != 0.0:
            raise ValueError(f"table: must have tractions > 0 and a last one of 0, got {p_c[1:].tolist()}")
        secant_c = p_c[1:] / g_c[1:]
        if not np.all(np.diff(secant_c) < 0.0):
            raise ValueError(f"table: must have a falling traction / opening, got {secant_c.tolist()}")
        toughness = float(np.sum(0.5 * (p_c[1:] + p_c[:-1]) * np.diff(g_c)))
        object.__setattr__(self, "strength", float(np.max(p_c)))
        object.__setattr__(self, "toughness", toughness)
        object.__setattr__(self, "ductility", 2.0 * toughness / (self.strength * g_c[1]))

    @cached_property
    def corners(self) -> Corners:
        """Openings and tractions (n_c,) of the corners, the origin first."""
        g_c, p_c = np.array([(0.0, 0.0), *self.table], dtype=float).T
        return g_c, p_c


@dataclass(frozen=True)
class ExponentialLaw(Law):
    """p = e p_max x exp(-x) with x = g / g0, g0 = G_Ic / (e p_max) (Salehani and Irani 2018, in mode I).

    The damage of this formula begins at once and never ends, but a path needs g_max > 0 and a finite g_u. Here damage
    begins at x = ``begins``, below which p follows the chord, and p is zero from x = ``ends`` on; the missing area,
    2e-10 of G_Ic, is lost there. ``ductility`` is not used.
    """

    begins: float = 1e-3
    ends: float = 40.0

    @property
    def g_0(self) -> float:
        """Opening at the strength."""
        return self.toughness / (np.e * self.strength)

    @property
    def g_peak(self) -> float:
        """Opening at which damage begins."""
        return self.begins * self.g_0

    @property
    def g_open(self) -> float:
        """Opening from which the traction is zero."""
        return self.ends * self.g_0

    @property
    def K0(self) -> float:
        """Initial stiffness [stress per length], of the chord."""
        return (np.e * self.strength) ** 2 / self.toughness * float(np.exp(-self.begins))

    def damage(self, k_q: np.ndarray) -> np.ndarray:
        """d (n_q,), 0 intact to 1 open."""
        beyond_q = np.maximum(k_q - self.g_peak, 0.0) / self.g_0
        return np.where(k_q < self.g_open, 1.0 - np.exp(-beyond_q), 1.0)

    def softening(self, k_q: np.ndarray) -> np.ndarray:
        """Slope (n_q,) of the envelope beyond the chord; it rises up to g0."""
        x_q = k_q / self.g_0
        return np.e * self.strength / self.g_0 * (1.0 - x_q) * np.exp(-x_q)

    def area(self, k_q: np.ndarray) -> np.ndarray:
        """Integral (n_q,) of the envelope from 0 to k >= 0; G_Ic from g_u on."""
        rising_q, x_q = np.minimum(k_q, self.g_peak), np.clip(k_q / self.g_0, self.begins, self.ends)
        left, left_q = (1.0 + self.begins) * np.exp(-self.begins), (1.0 + x_q) * np.exp(-x_q)
        spent_q = 0.5 * self.K0 * rising_q**2 + self.toughness * (left - left_q)
        return np.where(k_q < self.g_open, spent_q, self.toughness)


#: Name in a scene -> law, a class with the fields, properties and methods of `Law`.
MODELLED_LAWS: dict[str, type[Law]] = {
    "bilinear": Law,
    "trapezoidal": TrapezoidalLaw,
    "tabular": TabularLaw,
    "exponential": ExponentialLaw,
}
