"""How onset and toughness of a bond depend on the mix of opening and sliding, with derivatives.

The mix is B = Ks s^2 / lambda^2 with lambda^2 = K g+^2 + Ks s^2, the part of sliding in the elastic energy.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

#: Criterion of the toughness -> onsets that go with it, the default first.
ONSET_WITH = {"bk": ("turon", "quadratic"), "power": ("quadratic",)}


@dataclass(frozen=True)
class Mix:
    """Norm lambda (n_q,) and mode ratio B (n_q,) of jumps, with derivatives (n_q, 2) by (g, s)."""

    norm_q: np.ndarray
    B_q: np.ndarray
    dnorm_qj: np.ndarray
    dB_qj: np.ndarray


def mix_of(g_q: np.ndarray, s_q: np.ndarray, slope_j: np.ndarray) -> Mix:
    """The mix of the jumps with the initial stiffness (K, Ks); zero, with its derivatives, where nothing has moved."""
    jump_qj = np.stack([np.maximum(g_q, 0.0), s_q], -1)
    force_qj = slope_j * jump_qj
    square_qj = force_qj * jump_qj
    square_q = square_qj.sum(-1)
    moved_q = square_q > 0.0
    norm_q = np.sqrt(square_q)
    per_square_q = np.divide(1.0, square_q, out=np.zeros_like(square_q), where=moved_q)
    B_q = square_qj[:, 1] * per_square_q
    other_qj = np.stack([-B_q, 1.0 - B_q], -1)
    return Mix(
        norm_q, B_q, force_qj * (norm_q * per_square_q)[:, None], 2.0 * force_qj * other_qj * per_square_q[:, None]
    )


@dataclass(frozen=True)
class Criterion:
    """Toughness and onset of damage as functions of B (n_q,).

    ``normal`` and ``shear`` are strength, toughness and stiffness of modes I and II. Toughness: "bk", G_c = G_I +
    (G_II - G_I) B^a (Benzeggagh and Kenane 1996, Compos. Sci. Technol. 56, 439-449), or "power", 1/G_c =
    [((1-B)/G_I)^a + (B/G_II)^a]^(1/a). Onset: "turon", lambda0^2 = p_max^2/K + (t_max^2/Ks - p_max^2/K) B^a (Turon et
    al. 2006, eq. 31), or "quadratic", the ellipse of the stresses, 1/lambda0^2 = (1-B) K/p_max^2 + B Ks/t_max^2.
    """

    normal: tuple[float, float, float]
    shear: tuple[float, float, float]
    toughness: str
    onset: str
    exponent: float

    def critical(self, B_q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """G_c (n_q,) and dG_c/dB."""
        a, G_I, G_II = self.exponent, self.normal[1], self.shear[1]
        if self.toughness == "bk":
            return G_I + (G_II - G_I) * B_q**a, (G_II - G_I) * a * B_q ** (a - 1.0)
        opening_q, sliding_q = (1.0 - B_q) / G_I, B_q / G_II
        sum_q = opening_q**a + sliding_q**a
        G_q = sum_q ** (-1.0 / a)
        return G_q, G_q / sum_q * (opening_q ** (a - 1.0) / G_I - sliding_q ** (a - 1.0) / G_II)

    def begins(self, B_q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Lambda0 (n_q,) and dlambda0/dB."""
        (p_max, _, K), (t_max, _, Ks), a = self.normal, self.shear, self.exponent
        square_I, square_II = p_max**2 / K, t_max**2 / Ks
        if self.onset == "turon":
            norm_q = np.sqrt(square_I + (square_II - square_I) * B_q**a)
            return norm_q, (square_II - square_I) * a * B_q ** (a - 1.0) / (2.0 * norm_q)
        norm_q = ((1.0 - B_q) / square_I + B_q / square_II) ** -0.5
        return norm_q, 0.5 * norm_q**3 * (1.0 / square_I - 1.0 / square_II)

    def brittle_at(self) -> float | None:
        """A mode ratio at which the bond stores its toughness before damage begins, lambda0^2 >= 2 G_c; or None."""
        B_q = np.linspace(0.0, 1.0, 1001)
        excess_q = self.begins(B_q)[0] ** 2 / (2.0 * self.critical(B_q)[0])
        return float(B_q[np.argmax(excess_q)]) if np.max(excess_q) >= 1.0 else None
