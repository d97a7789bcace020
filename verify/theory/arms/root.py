"""What a plane arm gives at a crack tip beyond a beam: extra crack lengths, and the compliances that stand for them.

A beam that is clamped at the tip is too stiff. Effective crack lengths are a + D_I in opening and a + D_II in sliding,

    D_I = chi h,  D_II = 0.42 chi h

with the chi of `verify.theory.lefm` (Wang and Williams 1992, Compos. Sci. Technol. 43; ASTM D6671). Two equal
Timoshenko arms on an even foundation of the compliances c_n and c_t (length per stress) have

    D_I^2 = 2 sqrt(E h^3 c_n / 24) + E h^2 / (12 kappa G),  D_II^2 = E h c_t / 8,  kappa = 5/6,

from the decay of opening, whose rates a, b have a b = sqrt(24 / (E h^3 c_n)) and D_I = 1/a + 1/b, and from that of
slip, s'' = 8 s / (E h c_t). Solved for c_n and c_t, half of each belongs to an arm.
"""

from __future__ import annotations

from collections.abc import Sequence

from verify.theory.arms.problem import Arm
from verify.theory.arms.sections import SHEAR_CORRECTION
from verify.theory.lefm import chi

#: Part of the extra crack length in opening that it has in sliding (ASTM D6671).
SLIDING_PART = 0.42

#: Least part of D_I^2 that is left for the foundation: in arms that hardly bend beside their shear the formula leaves
#: none.
LEAST_FOUNDATION = 0.02


def extra_lengths(arm: Arm) -> tuple[float, float]:
    """(D_I, D_II) of an arm (length)."""
    opening = chi(arm) * arm.thickness
    return opening, SLIDING_PART * opening


def compliances(arms: Sequence[Arm]) -> tuple[float, float]:
    """(c_n, c_t) of both arms together, in series with the bond (length per stress)."""
    c_n = c_t = 0.0
    for arm in arms:
        E, h, (D_I, D_II) = arm.young, arm.thickness, extra_lengths(arm)
        rest = max(D_I**2 - E * h**2 / (12.0 * SHEAR_CORRECTION * arm.shear), LEAST_FOUNDATION * D_I**2)
        c_n += 3.0 * rest**2 / (E * h**3)
        c_t += 4.0 * D_II**2 / (E * h)
    return c_n, c_t
