"""The traction laws of opening and sliding, for all points of the interface at once, from step to step.

A point has the jump (g, s), the damage d and the irreversible slip s_p of friction. Components of arrays:
``i`` are the tractions (p, t), ``j`` the jumps (g, s).
"""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from fem_reference.problem.bond_law import BondLaw
from fem_reference.problem.mode_mix import ONSET_WITH

#: Columns of the history: damage d, slip of friction, and the scaled jump beyond which damage grows again.
DAMAGE, SLIP, HELD = range(3)


@dataclass(frozen=True, kw_only=True)
class MixedLaw(BondLaw):
    """Tractions with one damage for both directions, contact, friction and viscosity.

    p = (1 - d) K g for g >= 0, penalty g for g < 0; t = (1 - d) Ks s + a t_f. Damage is the largest D(g, s) so far,
    with lambda^2 = K g+^2 + Ks s^2, B = Ks s^2 / lambda^2 (Camanho and Davila 2002, NASA/TM-2002-211737; Turon et al.
    2006, Mech. Mater. 38, 1072-1089). Friction acts on the part a of the bond (Alfano and Sacco 2006, Int. J. Numer.
    Methods Eng. 68, 542-582): t_f = clip(Ks (s - s_p), -mu q, mu q) under the contact pressure q = penalty <-g>.

    Parameters
    ----------
    strength, shear_strength, toughness, shear_toughness : p_max, t_max [stress], G_I, G_II [energy per area].
    stiffness, shear_stiffness, penalty : K, Ks, stiffness against closing [stress per length].
    criterion, exponent, onset : see `fem_reference.problem.mode_mix`; an empty ``onset`` is that of the criterion.
    contact : if False, (1 - d) K continues into closing, which causes no damage.
    irreversible : if False, d = D(g, s).
    friction : mu.
    rubs : "damage", a = d, or "area", a = d / (d + (1 - d) s_f / s_0) with onset s_0 and failure s_f in pure sliding:
        the part of the way between them, as in NASA's CompDam.
    viscosity : v, a time; d_new = d + dt / (dt + v) <D - d>, implicit Euler of d' = <D - d> / v.
    pressure_strength : c; under the pressure q the strength in shear is t_max + c q with the same toughness, at most
        the strength at which the energy stored at onset is all of the toughness.

    Raises
    ------
    ValueError : an unknown name, an exponent below 1, a negative friction, viscosity or
        pressure_strength, or a bond that stores its toughness before damage; the message names the parameter.
    """

    strength: float
    shear_strength: float
    toughness: float
    shear_toughness: float
    stiffness: float
    shear_stiffness: float
    penalty: float
    criterion: str = "bk"
    exponent: float = 2.0
    onset: str = ""
    contact: bool = True
    irreversible: bool = True
    friction: float = 0.0
    viscosity: float = 0.0
    pressure_strength: float = 0.0
    rubs: str = "damage"
    slides: ClassVar[bool] = True

    def __post_init__(self) -> None:
        if self.criterion not in ONSET_WITH:
            raise ValueError(f"criterion: must be one of {', '.join(ONSET_WITH)}, got {self.criterion}")
        if self.onset and self.onset not in ONSET_WITH[self.criterion]:
            wish = " or ".join(ONSET_WITH[self.criterion])
            raise ValueError(f"onset: must be {wish} with the criterion {self.criterion}, got {self.onset}")
        if self.rubs not in ("damage", "area"):
            raise ValueError(f"rubs: must be damage or area, got {self.rubs}")
        if not self.exponent >= 1:
            raise ValueError(f"exponent: must be >= 1, got {self.exponent}")
        for name in ("friction", "viscosity", "pressure_strength"):
            if not getattr(self, name) >= 0:
                raise ValueError(f"{name}: must be >= 0, got {getattr(self, name)}")

    @property
    def slope_j(self) -> np.ndarray:
        """Initial stiffness (2,): K, Ks."""
        return np.array([self.stiffness, self.shear_stiffness])

    @property
    def K0(self) -> float:
        return float(self.slope_j[0])

    @property
    def begun(self) -> float:
        """The measure of a jump is scaled, see `reach`."""
        return 1.0

    @property
    def failed(self) -> float:
        return 2.0

    @property
    def unit(self) -> float:
        return 1.0

    def intact(self, bonded_q: np.ndarray) -> np.ndarray:
        """Where nothing is bonded damage is 1 from the start, so that only contact and friction act."""
        k_qh = np.zeros((bonded_q.size, 3))
        k_qh[~bonded_q, DAMAGE] = 1.0
        return k_qh

    def respond(
        self, jump_qj: np.ndarray, k_qh: np.ndarray, bonded_q: np.ndarray, dt: float
    ) -> tuple[np.ndarray, np.ndarray]:
        p_q, t_q, slope_qij, _, _ = self._response(jump_qj, k_qh, bonded_q, dt)
        return np.stack([p_q, t_q], -1), slope_qij

    def committed(self, jump_qj: np.ndarray, k_qh: np.ndarray, bonded_q: np.ndarray, dt: float) -> np.ndarray:
        *_, d_q, slip_q = self._response(jump_qj, k_qh, bonded_q, dt)
        (r_q, _), held_q = self.measure(jump_qj), k_qh[:, HELD]
        held_q = np.where(d_q > k_qh[:, DAMAGE], r_q, np.where(d_q < 1.0, held_q, np.maximum(held_q, r_q)))
        return np.column_stack([d_q, slip_q, np.where(bonded_q, held_q, 0.0)])

    def _response(
        self, jump_qj: np.ndarray, k_qh: np.ndarray, bonded_q: np.ndarray, dt: float
    ) -> tuple[np.ndarray, ...]:
        """See `traction`; what is not bonded stays open also where damage heals."""
        arguments = *jump_qj.T, k_qh[:, DAMAGE], k_qh[:, SLIP], dt
        found = self.traction(*arguments)
        if self.irreversible:
            return found
        stays = replace(self, irreversible=True).traction(*arguments)
        return tuple(
            np.where(bonded_q.reshape(-1, *[1] * (one.ndim - 1)), one, other)
            for one, other in zip(found, stays, strict=True)
        )

    def damaged(self, k_qh: np.ndarray, bonded_q: np.ndarray) -> np.ndarray:
        return k_qh[:, DAMAGE]

    def held(self, k_qh: np.ndarray) -> np.ndarray:
        return k_qh[:, HELD]

    def measure(self, jump_qj: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return self.reach(*jump_qj.T)

    def balance(self, jump_qj: np.ndarray, k_qh: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray | None]:
        cohesive_q, contact_q, stuck_q = self.energies(*jump_qj.T, *k_qh.T[:HELD])
        return cohesive_q, contact_q + stuck_q, None

    @abstractmethod
    def reach(self, g_q: np.ndarray, s_q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The scaled jump r (n_q,), 1 at the onset and 2 at failure, and its derivative (n_q, 2) at constant B."""

    @abstractmethod
    def driving(self, g_q: np.ndarray, s_q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Damage on first loading to the jumps, D (n_q,), and dD_qj (n_q, 2)."""

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

    def release(self, g_q: np.ndarray, s_q: np.ndarray, d_q: np.ndarray, slip_q: np.ndarray) -> np.ndarray:
        """Energy per area (n_q,) released per unit of d: minus the derivative of the stored energy."""
        return self._elastic(g_q, s_q) - self.rubbing_part(d_q)[1] * self._held(s_q, slip_q)

    def rubbing(self, g_q: np.ndarray, d_q: np.ndarray) -> np.ndarray:
        """Energy per area and unit of slip (n_q,) dissipated by friction: a mu q."""
        return self.rubbing_part(d_q)[0] * self.friction * self._pressure(g_q)

    def rubbing_part(self, d_q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The part a (n_q,) of the bond that friction acts on, and da/dd."""
        if self.rubs == "damage":
            return d_q, np.ones_like(d_q)
        stretch = 2.0 * self.shear_toughness * self.shear_stiffness / self.shear_strength**2  # s_f / s_0
        whole_q = d_q + (1.0 - d_q) * stretch
        return d_q / whole_q, stretch / whole_q**2

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
