"""The traction laws of opening and sliding: their parameters, friction, and the scaled jump."""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from fem_reference.problem.bond_law import DAMAGE, HELD, BondLaw
from fem_reference.problem.mode_mix import ONSET_WITH


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
    def begun(self) -> float:
        """The measure of a jump is scaled, see `reach`."""
        return 1.0

    @property
    def failed(self) -> float:
        return 2.0

    @property
    def unit(self) -> float:
        return 1.0

    def measure(self, jump_qj: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return self.reach(*jump_qj.T)

    def kept(self, jump_qj: np.ndarray, k_qh: np.ndarray, d_q: np.ndarray) -> np.ndarray:
        """Before damage has grown it is 0."""
        (r_q, _), held_q = self.measure(jump_qj), k_qh[:, HELD]
        return np.where(d_q > k_qh[:, DAMAGE], r_q, np.where(d_q < 1.0, held_q, np.maximum(held_q, r_q)))

    @abstractmethod
    def reach(self, g_q: np.ndarray, s_q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The scaled jump r (n_q,), 1 at the onset and 2 at failure, and its derivative (n_q, 2) at constant B."""

    def release(self, g_q: np.ndarray, s_q: np.ndarray, d_q: np.ndarray, slip_q: np.ndarray) -> np.ndarray:
        """Energy per area (n_q,) released per unit of d: minus the derivative of the stored energy."""
        return self._elastic(g_q, s_q) - self.rubbing_part(d_q)[1] * self._held(s_q, slip_q)

    def rubbing(self, g_q: np.ndarray, d_q: np.ndarray) -> np.ndarray:
        """Energy per area and unit of slip (n_q,) dissipated by friction: a mu q."""
        return self.rubbing_part(d_q)[0] * self.friction * self._pressure(g_q)

    def rubbing_part(self, d_q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        if self.rubs == "damage":
            return super().rubbing_part(d_q)
        stretch = 2.0 * self.shear_toughness * self.shear_stiffness / self.shear_strength**2  # s_f / s_0
        whole_q = d_q + (1.0 - d_q) * stretch
        return d_q / whole_q, stretch / whole_q**2
