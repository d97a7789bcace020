"""The laws of opening and sliding by name, with their damage on first loading."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fem_reference.problem.law import Shaped, of_all_shapes
from fem_reference.problem.mixed_law import MixedLaw
from fem_reference.problem.mode_mix import ONSET_WITH, Criterion, mix_of


@dataclass(frozen=True, kw_only=True)
class ByCriterion(MixedLaw, Shaped):
    """Tractions fall from lambda0 to lambda_f as the shape r says, on a way with which the area is G_c.

    D = 1 - r lambda0 / lambda; bilinear: lambda_f = 2 G_c / lambda0.
    """

    def __post_init__(self) -> None:
        super().__post_init__()
        assert self.shape  # refuses parameters out of their range
        if (B := self.by_mode.brittle_at()) is not None:
            raise ValueError(
                f"stiffness: must be so large that the bond stores less than its toughness before damage begins, "
                f"got {self.stiffness}, {self.shear_stiffness} in shear, which is too low at the mode ratio {B:g}"
            )

    @property
    def by_mode(self) -> Criterion:
        """Onset and toughness of all mode ratios."""
        normal = self.strength, self.toughness, self.stiffness
        shear = self.shear_strength, self.shear_toughness, self.shear_stiffness
        return Criterion(normal, shear, self.criterion, self.onset or ONSET_WITH[self.criterion][0], self.exponent)

    def reach(self, g_q: np.ndarray, s_q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """See `MixedLaw.reach`: lambda / lambda0, beyond the onset 1 + (lambda - lambda0) / (lambda_f - lambda0)."""
        mix = mix_of(g_q, s_q, self.slope_j)
        rise_q = 1.0 + self.pressure_strength / self.shear_strength * self._pressure(g_q)
        G_q = self.by_mode.critical(mix.B_q)[0]
        onset_q = np.minimum(rise_q * self.by_mode.begins(mix.B_q)[0], (1.0 - 1e-6) * np.sqrt(2.0 * G_q))
        beyond_q = mix.norm_q > onset_q
        per_norm_q = np.where(beyond_q, 1.0 / self.softening_way(onset_q, G_q), 1.0 / onset_q)
        r_q = np.where(beyond_q, 1.0, 0.0) + (mix.norm_q - np.where(beyond_q, onset_q, 0.0)) * per_norm_q
        return r_q, per_norm_q[:, None] * mix.dnorm_qj

    def softening_way(self, onset_q: np.ndarray, G_q: np.ndarray) -> np.ndarray:
        """Lambda_f - lambda0 (n_q,)."""
        return (G_q / onset_q - 0.5 * onset_q) / self.shape.area

    def driving(self, g_q: np.ndarray, s_q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """See `MixedLaw.driving`."""
        mix, by_mode = mix_of(g_q, s_q, self.slope_j), self.by_mode
        (G_q, dG_q), (begins_q, dbegins_q) = by_mode.critical(mix.B_q), by_mode.begins(mix.B_q)
        dG_qj = dG_q[:, None] * mix.dB_qj
        rise_q = 1.0 + self.pressure_strength / self.shear_strength * self._pressure(g_q)
        onset_q, donset_qj = rise_q * begins_q, (rise_q * dbegins_q)[:, None] * mix.dB_qj
        steepness = self.pressure_strength / self.shear_strength * self.penalty
        donset_qj[:, 0] -= np.where(self._closed(g_q), steepness * begins_q, 0.0)
        whole_q = np.sqrt(2.0 * G_q)
        brittle_q = onset_q >= whole_q  # only under pressure: the stored energy reaches the toughness before the onset
        grows_q = (mix.norm_q > onset_q) & ~brittle_q
        D_q, dD_qj = ((brittle_q & (mix.norm_q > whole_q)).astype(float), np.zeros_like(dG_qj))
        D_q[grows_q], part_qk = self.softening(mix.norm_q[grows_q], onset_q[grows_q], G_q[grows_q])
        along_qkj = np.stack([mix.dnorm_qj, donset_qj, dG_qj], 1)[grows_q]
        dD_qj[grows_q] = np.einsum("qk,qkj->qj", part_qk, along_qkj)
        return D_q, dD_qj

    def softening(self, norm_q: np.ndarray, onset_q: np.ndarray, G_q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """D (n_q,) at points with lambda > lambda0, and its derivatives (n_q, 3) by lambda, lambda0 and G_c."""
        way_q = self.softening_way(onset_q, G_q)
        x_q = (norm_q - onset_q) / way_q
        r_q, dr_q = self.shape.left(x_q)
        along_q = np.where(x_q < 1.0, dr_q / way_q, 0.0)
        dway_qk = -(G_q / onset_q**2 + 0.5) / self.shape.area, 1.0 / (onset_q * self.shape.area)
        dr_qk = np.stack([along_q, -along_q * (1.0 + x_q * dway_qk[0]), -along_q * x_q * dway_qk[1]], -1)
        part_qk = -(onset_q / norm_q)[:, None] * dr_qk
        part_qk[:, 0] += r_q * onset_q / norm_q**2
        part_qk[:, 1] -= r_q / norm_q
        return 1.0 - r_q * onset_q / norm_q, part_qk


@dataclass(frozen=True, kw_only=True)
class MixedExponential(MixedLaw):
    """Tractions of one exponential without onset or criterion (Salehani and Irani 2018).

    p = e p_max x exp(-x - y^2), t = sqrt(2 e) t_max y exp(-x - y^2), with x = g+ / g0, y = s / s0, g0 = G_I / (e p_max)
    and s0 = sqrt(2 / e) G_II / t_max. That is D = 1 - exp(-x - y^2) with the stiffness of `slope_j`; ``stiffness`` and
    ``shear_stiffness`` are not used.
    """

    stiffness: float = 0.0
    shear_stiffness: float = 0.0

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.pressure_strength != 0.0:
            raise ValueError(f"pressure_strength: must be 0 with the exponential law, got {self.pressure_strength}")
        if self.rubs != "damage":
            raise ValueError(f"rubs: must be damage with the exponential law, got {self.rubs}")

    @property
    def slope_j(self) -> np.ndarray:
        """K = (e p_max)^2 / G_I and Ks = e t_max^2 / G_II."""
        return np.array(
            [np.e**2 * self.strength**2 / self.toughness, np.e * self.shear_strength**2 / self.shear_toughness]
        )

    def reach(self, g_q: np.ndarray, s_q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """See `MixedLaw.reach`; in place of onset and failure stand the largest traction and seven times its jump.

        Up to the onset r^2 = x^2 + 2 y^2.
        """
        g_0 = self.toughness / (np.e * self.strength)
        s_0 = np.sqrt(2.0 / np.e) * self.shear_toughness / self.shear_strength
        x_q, y_q = np.maximum(g_q, 0.0) / g_0, s_q / s_0
        near_q = np.sqrt(x_q**2 + 2.0 * y_q**2)
        share_q = np.where(near_q > 1.0, 1.0 / 6.0, 1.0)
        per_near_q = share_q * np.divide(1.0, near_q, out=np.zeros_like(near_q), where=near_q > 0.0)
        r_q = np.where(near_q > 1.0, 1.0 + (near_q - 1.0) / 6.0, near_q)
        return r_q, np.stack([x_q / g_0, 2.0 * y_q / s_0], -1) * per_near_q[:, None]

    def driving(self, g_q: np.ndarray, s_q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """See `MixedLaw.driving`."""
        g_0 = self.toughness / (np.e * self.strength)
        s_0 = np.sqrt(2.0 / np.e) * self.shear_toughness / self.shear_strength
        x_q, y_q = np.maximum(g_q, 0.0) / g_0, s_q / s_0
        intact_q = np.exp(-x_q - y_q**2)
        return 1.0 - intact_q, np.stack([np.where(g_q >= 0.0, intact_q / g_0, 0.0), 2.0 * y_q / s_0 * intact_q], -1)


#: Name in a scene -> law, a class with the fields and methods of `MixedLaw`.
MODELLED_MIXED_LAWS: dict[str, type[MixedLaw]] = {**of_all_shapes(ByCriterion), "exponential": MixedExponential}
