"""A traction law at the points of the interface, as model and path need it, whether it opens alone or slides as well.

A point has the jump (g, s), the damage d and the irreversible slip s_p of friction. Components of arrays: ``i`` are the
tractions (p, t), ``j`` the jumps (g, s); where the bond opens alone there is no slip, and no traction along it.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import replace
from typing import Any, ClassVar

import numpy as np

#: Columns of the history: damage d, slip of friction, and the measure of a jump beyond which damage grows again.
DAMAGE, SLIP, HELD = range(3)


class BondLaw(ABC):
    """p = (1 - d) K g for g >= 0, penalty g for g < 0; t = (1 - d) Ks s + a t_f, with one damage d for both.

    A law is a frozen dataclass for the points q of the interface, with jumps (n_q, n_j): the gap and, where it
    ``slides``, the slip. Tractions are (n_q, n_j), histories (n_q, 3). Where ``bonded_q`` (n_q,) is False the faces can
    only touch. The measure of a jump is a scalar that is compared with `begun` and `failed`.
    """

    slides: ClassVar[bool]
    penalty: float
    contact: bool
    irreversible: bool
    friction: float = 0.0
    viscosity: float = 0.0

    @property
    @abstractmethod
    def slope_j(self) -> np.ndarray:
        """Initial stiffness (2,): K, Ks [stress per length]."""

    @property
    @abstractmethod
    def begun(self) -> float:
        """The measure of a jump at which damage begins."""

    @property
    @abstractmethod
    def failed(self) -> float:
        """The measure of a jump from which a point is open."""

    @property
    @abstractmethod
    def unit(self) -> float:
        """Unit in which steps of the front's measure are measured."""

    @abstractmethod
    def driving(self, g_q: np.ndarray, s_q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Damage on first loading to the jumps, D (n_q,), and dD_qj (n_q, 2)."""

    @abstractmethod
    def measure(self, jump_qj: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The measure (n_q,) of the jumps, and its derivative (n_q, n_j) at a constant mode ratio."""

    @abstractmethod
    def kept(self, jump_qj: np.ndarray, k_qh: np.ndarray, d_q: np.ndarray) -> np.ndarray:
        """The measure (n_q,) beyond which damage grows again after a step to the jumps and the damage d."""

    @property
    def K0(self) -> float:
        """Initial stiffness against opening [stress per length]."""
        return float(self.slope_j[0])

    def intact(self, bonded_q: np.ndarray) -> np.ndarray:
        """The history before anything has moved. Where nothing is bonded damage is 1 from the start, so that only
        contact and friction act."""
        k_qh = np.zeros((bonded_q.size, 3))
        k_qh[~bonded_q, DAMAGE] = 1.0
        return k_qh

    def respond(
        self, jump_qj: np.ndarray, k_qh: np.ndarray, bonded_q: np.ndarray, dt: float
    ) -> tuple[np.ndarray, np.ndarray]:
        """Tractions (n_q, n_j) and their slopes (n_q, n_j, n_j) after a step of the time ``dt`` from the history."""
        p_q, t_q, slope_qij, _, _ = self._response(jump_qj, k_qh, bonded_q, dt)
        n = jump_qj.shape[1]
        return np.stack([p_q, t_q], -1)[:, :n], slope_qij[:, :n, :n]

    def committed(self, jump_qj: np.ndarray, k_qh: np.ndarray, bonded_q: np.ndarray, dt: float) -> np.ndarray:
        """The history (n_q, 3) after a step to the jumps."""
        *_, d_q, slip_q = self._response(jump_qj, k_qh, bonded_q, dt)
        return np.column_stack([d_q, slip_q, np.where(bonded_q, self.kept(jump_qj, k_qh, d_q), 0.0)])

    def held(self, k_qh: np.ndarray) -> np.ndarray:
        """The measure (n_q,) beyond which damage grows again."""
        return k_qh[:, HELD]

    def damaged(self, k_qh: np.ndarray, bonded_q: np.ndarray) -> np.ndarray:
        """d (n_q,); 1 where nothing is bonded."""
        return k_qh[:, DAMAGE]

    def balance(self, jump_qj: np.ndarray, k_qh: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray | None]:
        """Energies per area (n_q,): recoverable from cohesion, stored in contact and friction, and dissipated; None for
        the last where it depends on the path. The history is that after the step that led to the jumps."""
        cohesive_q, contact_q, stuck_q = self.energies(*both(jump_qj), *k_qh.T[:HELD])
        return cohesive_q, contact_q + stuck_q, None

    def damage(self, g_q: np.ndarray, s_q: np.ndarray, d_q: np.ndarray, dt: float) -> tuple[np.ndarray, np.ndarray]:
        """Damage (n_q,) after a step of the time ``dt`` from the committed ``d_q``, and its derivative (n_q, 2)."""
        D_q, dD_qj = self.driving(g_q, s_q)
        if not self.irreversible:
            return D_q, dD_qj
        grows_q = d_q < D_q
        if self.viscosity == 0.0:
            return np.where(grows_q, D_q, d_q), dD_qj * grows_q[:, None]
        share = dt / (dt + self.viscosity)
        return d_q + share * np.where(grows_q, D_q - d_q, 0.0), share * dD_qj * grows_q[:, None]

    def traction(
        self, g_q: np.ndarray, s_q: np.ndarray, d_q: np.ndarray, slip_q: np.ndarray, dt: float = 0.0
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """Tractions p, t (n_q,), tangent_qij (n_q, 2, 2), and the histories d, s_p (n_q,) after the step.

        ``d_q`` and ``slip_q`` are the histories committed before it, ``dt`` its time, which only viscosity needs.
        """
        d_new_q, dd_qj = self.damage(g_q, s_q, d_q, dt)
        K, Ks = self.slope_j
        closed_q = self._closed(g_q)
        p_q = np.where(closed_q, self.penalty, (1.0 - d_new_q) * K) * g_q
        t_f_q, dt_f_qj, slip_new_q = self._friction(g_q, s_q, slip_q)
        a_q, da_q = self.rubbing_part(d_new_q)
        t_q = (1.0 - d_new_q) * Ks * s_q + a_q * t_f_q
        tangent_qij = np.zeros((g_q.size, 2, 2))
        tangent_qij[:, 0] = np.where(closed_q, 0.0, -K * g_q)[:, None] * dd_qj
        tangent_qij[:, 0, 0] += np.where(closed_q, self.penalty, (1.0 - d_new_q) * K)
        tangent_qij[:, 1] = (da_q * t_f_q - Ks * s_q)[:, None] * dd_qj + a_q[:, None] * dt_f_qj
        tangent_qij[:, 1, 1] += (1.0 - d_new_q) * Ks
        return p_q, t_q, tangent_qij, d_new_q, slip_new_q

    def energies(
        self, g_q: np.ndarray, s_q: np.ndarray, d_q: np.ndarray, slip_q: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Energies per area, (n_q,) each: recoverable from cohesion, stored in contact, stored in friction.

        The histories ``d_q`` and ``slip_q`` are those after the step that led to the jumps.
        """
        closed_q = self._closed(g_q)
        contact_q = np.where(closed_q, 0.5 * self.penalty * g_q**2, 0.0)
        return (1.0 - d_q) * self._elastic(g_q, s_q), contact_q, self.rubbing_part(d_q)[0] * self._held(s_q, slip_q)

    def rubbing_part(self, d_q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The part a (n_q,) of the bond that friction acts on, and da/dd."""
        return d_q, np.ones_like(d_q)

    def _response(
        self, jump_qj: np.ndarray, k_qh: np.ndarray, bonded_q: np.ndarray, dt: float
    ) -> tuple[np.ndarray, ...]:
        """See `traction`; what is not bonded stays open also where damage heals."""
        arguments = *both(jump_qj), k_qh[:, DAMAGE], k_qh[:, SLIP], dt
        found = self.traction(*arguments)
        if self.irreversible:
            return found
        law: Any = self  # a frozen dataclass
        stays = replace(law, irreversible=True).traction(*arguments)
        return tuple(
            np.where(bonded_q.reshape(-1, *[1] * (one.ndim - 1)), one, other)
            for one, other in zip(found, stays, strict=True)
        )

    def _friction(
        self, g_q: np.ndarray, s_q: np.ndarray, slip_q: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Traction t_f (n_q,) of the damaged part, its derivative (n_q, 2), and the slip (n_q,) after the step."""
        dt_f_qj = np.zeros((g_q.size, 2))
        if self.friction == 0.0:
            return np.zeros_like(s_q), dt_f_qj, slip_q
        Ks, limit_q = self.slope_j[1], self.friction * self._pressure(g_q)
        trial_q = Ks * (s_q - slip_q)
        sticks_q = np.abs(trial_q) < limit_q
        t_f_q = np.where(sticks_q, trial_q, np.sign(trial_q) * limit_q)
        dt_f_qj[:, 0] = np.where(sticks_q | ~self._closed(g_q), 0.0, -np.sign(trial_q) * self.friction * self.penalty)
        dt_f_qj[:, 1] = np.where(sticks_q, Ks, 0.0)
        return t_f_q, dt_f_qj, np.where(sticks_q, slip_q, s_q - t_f_q / Ks)

    def _elastic(self, g_q: np.ndarray, s_q: np.ndarray) -> np.ndarray:
        K, Ks = self.slope_j
        return 0.5 * (K * np.where(self._closed(g_q), 0.0, g_q) ** 2 + Ks * s_q**2)

    def _held(self, s_q: np.ndarray, slip_q: np.ndarray) -> np.ndarray:
        if self.friction == 0.0:
            return np.zeros_like(s_q)
        return 0.5 * self.slope_j[1] * (s_q - slip_q) ** 2

    def _pressure(self, g_q: np.ndarray) -> np.ndarray:
        return np.where(self._closed(g_q), -self.penalty * g_q, 0.0)

    def _closed(self, g_q: np.ndarray) -> np.ndarray:
        return (g_q < 0.0) & self.contact


def both(jump_qj: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Gap and slip (n_q,) of jumps (n_q, n_j); the slip is 0 where the bond opens alone."""
    return jump_qj[:, 0], jump_qj[:, 1] if jump_qj.shape[1] > 1 else np.zeros(len(jump_qj))
