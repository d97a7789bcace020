"""Point laws as a user would write them, step by step, right or with one known defect; and the bonds they are made for.

Written from the definition alone: nothing of the product is in them but the numbers of a bond.
"""

from __future__ import annotations

from collections.abc import Callable
from math import sqrt

from verify.theory.mixed_law import MixedBond


def consistent(K: float, toughness: tuple[float, float], strength: tuple[float, float]) -> tuple[float, float]:
    """(K, Ks) of Turon et al. (2010)."""
    return K, K * toughness[0] / toughness[1] * (strength[1] / strength[0]) ** 2


def _made(strength: tuple[float, float], toughness: tuple[float, float], K: float, exponent: float) -> MixedBond:
    stiffness = consistent(K, toughness, strength)
    return MixedBond("bilinear", strength, toughness, stiffness, 10.0 * K, exponent=exponent)


#: MOOSE's regression test; AS4/PEEK of Camanho and Davila (2003); CompDam's element tests.
BONDS = {
    "moose": _made((1.0, 1.0), (1.0, 2.0), 100.0, 2.0),
    "as4-peek": _made((80.0, 100.0), (0.969, 1.719), 1e5, 2.284),
    "compdam": _made((62.3, 92.3), (0.277, 0.788), 1e6, 1.634),
}

#: How the law below may be changed.
DEFECTS = (
    "sqrt2-compressed-shear", "lagged-mode-ratio", "displacement-mode-ratio", "onset", "viscosity", "stiffness-unit",
    "half-area", "damaged-contact", "no-contact", "healing", "slip-sign", "penalty", "exponent", "toughness",
    "shear-toughness", "strength", "shear-strength", "stiffness", "shear-stiffness", "summed-ratio",
)  # fmt: skip


def law_of(bond: MixedBond, defect: str = "", amount: float = 1.0) -> Callable:
    """A bilinear law with BK's toughness and contact, called step by step; two defects are joined by "and".

    Of sqrt2-compressed-shear and lagged-mode-ratio closed faces take the mode ratio 1, as MOOSE has it.

    ``amount`` is the viscosity of a viscous one, the factor of a wrong number, the part of the damage that a step keeps
    where it heals, and the factor of the traction of negative slip where its sign is wrong.
    """

    def times(*names: str) -> float:
        return amount if defect in names else 1.0

    area = 0.5 if defect == "half-area" else 1.0
    (K, Ks), (p_max, t_max), (G1, G2), eta = bond.stiffness, bond.strength, bond.toughness, bond.exponent
    K, Ks = K * times("stiffness", "stiffness-unit"), Ks * times("shear-stiffness", "stiffness-unit")
    p_max, t_max = p_max * times("strength"), t_max * times("shear-strength")
    G1, G2 = area * G1 * times("toughness"), area * G2 * times("shear-toughness")
    eta, penalty = eta * times("exponent"), bond.penalty * times("penalty")

    def law(g: float, s: float, state: tuple | None, dt: float) -> tuple:
        d, before = state if state else (0.0, 0.0)
        opened = max(g, 0.0)
        size = sqrt(K * opened**2 + Ks * s**2)
        now = B = Ks * s**2 / size**2 if size > 1e-150 else 0.0
        if defect == "displacement-mode-ratio" and size > 1e-150:
            B = s**2 / (opened**2 + s**2)
        if defect == "lagged-mode-ratio" or ("lagged-mode-ratio" in defect and g > 0.0):
            B = before
        begin = sqrt(p_max**2 / K + (t_max**2 / Ks - p_max**2 / K) * B**eta)
        if defect == "onset":
            begin = 1.0 / sqrt((1.0 - B) * K / p_max**2 + B * Ks / t_max**2)
        end = 2.0 * (G1 + (G2 - G1) * B**eta) / begin
        if defect == "summed-ratio" and opened > 1e-150:
            end *= (1.0 + abs(s) / opened) ** 2 / (1.0 + (s / opened) ** 2)
        if "sqrt2-compressed-shear" in defect and g <= 0.0:
            end *= sqrt(2.0)
        D = min(max(end * (size - begin) / (size * (end - begin)), 0.0), 1.0) if size > begin else 0.0
        rate = dt / (dt + amount) if defect == "viscosity" else 1.0
        d = max(amount * d, D) if defect == "healing" else d + rate * max(D - d, 0.0)
        p = (1.0 - d) * K * g
        if g < 0.0:
            p = penalty * g * {"damaged-contact": 1.0 - d, "no-contact": 0.0}.get(defect, 1.0)
        sign = amount if defect == "slip-sign" and s < 0.0 else 1.0
        return p, sign * (1.0 - d) * Ks * s, (d, now)

    return law
