"""Onset and toughness of a bond that opens and slides, as functions of the mode ratio.

The mode ratio by energy is ``B = Ks s^2 / (K g^2 + Ks s^2)``: 0 in pure opening, 1 in pure sliding; with the jump
``lambda`` in the energy norm, ``lambda^2 = K g^2 + Ks s^2``.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

#: A function of the mode ratio (n,): its value and its slope.
OfRatio = tuple[np.ndarray, np.ndarray]

#: Names of the failure criteria and of the onset criteria in a scene.
CRITERIA = ("bk", "power")
ONSETS = ("turon", "quadratic")


@dataclass(frozen=True)
class ModeRatio:
    """Toughness by Benzeggagh and Kenane (1996, "bk") or by a power law ("power"), each with its ``exponent`` >= 1;
    onset by Turon et al. (2006, "turon", with the exponent of BK) or by the quadratic criterion of the tractions
    ("quadratic"; Ye 1988).

    ``toughness`` and ``strength`` are pairs (opening, sliding), ``stiffness`` the pair (K, Ks); where the bond opens
    alone they have the number of opening only.

    Raises
    ------
    ValueError : an unknown name, Turon's onset with a power law, an exponent below 1, or a mode ratio at which the
        energy stored at onset is not below the toughness.
    """

    toughness: tuple[float, ...]
    strength: tuple[float, ...]
    stiffness: tuple[float, ...]
    criterion: str = "bk"
    exponent: float = 2.0
    onset: str = "turon"

    def __post_init__(self) -> None:
        if self.criterion not in CRITERIA or self.onset not in ONSETS:
            raise ValueError(
                f"criterion must be in {CRITERIA} and onset in {ONSETS}, got {self.criterion!r}, {self.onset!r}"
            )
        if self.onset == "turon" and self.criterion != "bk":
            raise ValueError('onset "turon" takes the exponent of criterion "bk"; take onset "quadratic"')
        if not self.exponent >= 1.0:
            raise ValueError(f"exponent must be >= 1, got {self.exponent}")
        ratios = np.linspace(0.0, 1.0, 101)
        (m, _), (G, _) = self.at(ratios)
        if not np.all(m < 2.0 * G):
            worst = ratios[np.argmax(m / G)]
            raise ValueError(
                f"the energy stored at the onset of damage must be below the toughness; it is not at mode "
                f"ratio {worst:.2f}: raise the stiffness or the toughness, or lower the strength"
            )

    def at(self, B: np.ndarray) -> tuple[OfRatio, OfRatio]:
        """``lambda0^2``, twice the energy at onset, and toughness ``G_c`` at mode ratios (n,), with their slopes."""
        if len(self.strength) == 1:
            (p,), (K,), (only,), none = self.strength, self.stiffness, self.toughness, np.zeros_like(B)
            return (p * p / K + none, none), (only + none, none)
        (p, t), (K, Ks), (first, second) = self.strength, self.stiffness, self.toughness
        if self.criterion == "bk":
            before = B ** (self.exponent - 1.0)
            part, slope = B * before, self.exponent * before
            G = first + (second - first) * part, (second - first) * slope
            if self.onset == "turon":
                jump = t * t / Ks - p * p / K
                return (p * p / K + jump * part, jump * slope), G
        else:
            G = self._power(B)
        softness = (1.0 - B) * (K / p**2) + B * (Ks / t**2)
        return (1.0 / softness, (K / p**2 - Ks / t**2) / softness**2), G

    def _power(self, B: np.ndarray) -> OfRatio:
        """``1 / G_c = [((1 - B) / G_I)^a + (B / G_II)^a]^(1 / a)``."""
        a, least = self.exponent, min(self.toughness)
        first, second = (G / least for G in self.toughness)  # powers of numbers below 1 do not overflow
        opening, sliding = (1.0 - B) / first, B / second
        summed = opening**a + sliding**a
        G = least * summed ** (-1.0 / a)
        change = sliding ** (a - 1.0) / second - opening ** (a - 1.0) / first
        return G, -G * change / summed
