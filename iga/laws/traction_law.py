"""What all traction laws in mode I share: history, secant, contact and energies, for all points at once."""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import dataclass
from functools import cached_property
from typing import Any, ClassVar

import numpy as np

from iga.laws.law import History, Law, Scaled, Stored

#: What the numbers of a law are greater than.
LEAST = {"strength": 0.0, "toughness": 0.0, "ductility": 1.0, "penalty": 0.0}


@dataclass(frozen=True)
class TractionLaw(Law):
    """A mode I law: linear up to g_max, where damage begins, then an envelope that falls to zero at g_u.

    ``strength`` p_max [stress], ``toughness`` G_Ic [force/length], ``ductility`` 2 G_Ic / (p_max g_max) > 1,
    ``penalty`` [stress/length]. Without ``contact`` the secant stiffness of the opening side continues to negative
    gaps; without ``irreversible`` the damage follows the present gap down as well as up, and nothing is dissipated.

    A law is a frozen dataclass that defines `g_u`, `envelope`, `softening` and `work`, and `kinks` where it has more
    than two; its own parameters have defaults.

    Raises
    ------
    ValueError : a number out of its range; the message has key, range and value.
    """

    strength: float
    toughness: float
    ductility: float
    penalty: float
    contact: bool = True
    irreversible: bool = True

    slides: ClassVar[bool] = False
    unbonded: ClassVar[float] = 0.0

    def __post_init__(self) -> None:
        for key, least in LEAST.items():
            value = getattr(self, key)
            if not least < value < np.inf:
                raise ValueError(f"{key}: must be > {least:g} and finite, got {value!r}")

    @property
    @abstractmethod
    def g_u(self) -> float:
        """Opening from which there is no traction, finite."""

    @abstractmethod
    def envelope(self, k: np.ndarray) -> np.ndarray:
        """Traction on first loading to the opening k >= 0, `stiffness` times k up to g_max."""

    @abstractmethod
    def softening(self, k: np.ndarray) -> np.ndarray | float:
        """Slope of the envelope at g_max <= k < g_u; at a kink that of the branch that begins there.

        It may be called with any k; values outside of that range are not used.
        """

    @abstractmethod
    def work(self, k: np.ndarray) -> np.ndarray:
        """Integral of the envelope from 0 to k >= 0; G_Ic from g_u on."""

    @cached_property
    def g_max(self) -> float:
        """Opening at which damage begins."""
        return 2.0 * self.toughness / self.strength / self.ductility

    @property
    def kinks(self) -> tuple[float, ...]:
        """Openings, rising from g_max to g_u, at which the slope of the envelope jumps; g_max and g_u in any case."""
        return self.g_max, self.g_u

    @property
    def pure_modes(self) -> tuple[tuple[float, float], ...]:
        return ((self.strength, self.toughness),)

    def critical(self, B: np.ndarray) -> np.ndarray:
        return np.full_like(B, self.toughness)

    @property
    def begun(self) -> float:
        """History beyond which a point is damaged."""
        return self.g_max

    @property
    def failed(self) -> float:
        """History from which a point has no cohesion left."""
        return self.g_u

    @property
    def span(self) -> float:
        """The opening over which a point goes from whole to failed."""
        return self.g_u

    def nudged(self, d: np.ndarray, driven: np.ndarray, grows: np.ndarray, keeps: np.ndarray) -> np.ndarray:
        k = np.where(keeps, d * (1.0 + 1e-12), d)
        return np.where(grows, np.minimum(k, driven) * (1.0 - 1e-12), k)

    def start(self, n: int) -> History:
        return History(np.zeros(n))

    def scaled(self, *jump_and_history: np.ndarray) -> Scaled:
        g, k = jump_and_history
        return Scaled(g, np.ones_like(g), None, k)

    def driven(self, *jump: np.ndarray) -> np.ndarray:
        return jump[0]

    def respond(
        self, jump_qc: np.ndarray, past: History, dt: float, closed_q: np.ndarray | None, bonded_q: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray, History]:
        g = jump_qc[:, 0]
        p, dp, k = self.traction(g, past.d, closed_q)
        if bonded_q is not None:
            carries_q = bonded_q | (((g < 0.0) if closed_q is None else closed_q) & self.contact)
            p, dp, k = np.where(carries_q, p, 0.0), np.where(carries_q, dp, 0.0), np.where(bonded_q, k, past.d)
        return p[:, None], dp[:, None, None], History(k)

    def stored(self, *jump_and_history: Any) -> Stored:
        g, history = jump_and_history
        cohesion, contact, dissipated = self.energies(g, history.d)
        return Stored(cohesion, contact, 0.0, dissipated)

    @cached_property
    def stiffness(self) -> float:
        """Initial slope p_max / g_max."""
        return self.strength / self.g_max

    @property
    def stiffest(self) -> float:
        """Largest slope of the traction."""
        return max(self.penalty, self.stiffness)

    def secant(self, k: np.ndarray) -> np.ndarray:
        """Secant stiffness (1 - d) K0 after the largest opening k."""
        k = np.maximum(k, self.g_max)
        return self.envelope(k) / k

    def damage(self, k: np.ndarray) -> np.ndarray:
        """d = 1 - secant / stiffness: 0 up to g_max, 1 from g_u on."""
        return 1.0 - self.secant(k) / self.stiffness

    def traction(
        self, g: np.ndarray, k: np.ndarray, closed: np.ndarray | None = None
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Traction, consistent tangent and new history.

        Parameters
        ----------
        g : (...,) normal gap, positive when open.
        k : (...,) largest gap of all converged states so far, the history.
        closed : (...,) which points are in contact; those with a negative gap if left out.

        Returns
        -------
        p, dp_dg, k_new : (...,) each.
        """
        closed = g < 0.0 if closed is None else closed
        closed = closed if self.contact else np.zeros_like(closed)
        k_new = np.maximum(k, g) if self.irreversible else np.maximum(g, 0.0)
        secant = self.secant(k_new)
        softening = (g >= k_new) & (g > self.g_max) & (g < self.g_u)
        slope = np.where(softening, self.softening(g), secant)
        return np.where(closed, self.penalty, secant) * g, np.where(closed, self.penalty, slope), k_new

    def energies(self, g: np.ndarray, k: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Energies per area: stored in cohesion, stored in contact, dissipated; k includes the present gap."""
        work = self.work(k)
        if self.irreversible:
            secant = self.secant(k)
            recoverable, lost = 0.5 * secant * g**2, work - 0.5 * secant * k**2
            dissipated = np.where(k > self.g_max, lost, 0.0)  # exactly nothing before damage, whatever is rounded
        else:
            secant = np.full_like(g, self.stiffness)
            recoverable, dissipated = np.where(g > 0.0, work, 0.5 * secant * g**2), np.zeros_like(g)
        closed = (g < 0.0) & self.contact
        return np.where(closed, 0.0, recoverable), np.where(closed, 0.5 * self.penalty * g**2, 0.0), dissipated
