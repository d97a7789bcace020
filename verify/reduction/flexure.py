"""Compliance and energy release rate of delamination specimens by beam theory, one formula for every kind."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from verify.reduction.coupon import Coupon

#: Correction of the crack length in sliding, in parts of that in opening (Wang and Williams 1992, Compos. Sci. Technol.
#: 43, 251-264; ASTM D6671 and D7905).
SLIDING_PART = 0.42


@dataclass(frozen=True)
class Flexure:
    """Compliance over the crack length ``a``, E the modulus along the arms:

        C = [base + opening (a + D)^3 + sliding (a + 0.42 D)^3 + linear (a + 0.42 D)] / (E b h^3)
            + shear + shear_a a,   D = chi h

    ``base`` to ``linear`` are numbers of the specimen's plan alone (closed forms: ``docs/pages/guide/specimens.md``),
    ``shear`` and ``shear_a`` those of the arms' shear with the factor 6/5. D makes up for the rotation at the tip. The
    energy release rate is P^2 / (2 b) dC/da: its parts of opening and sliding come from the terms of these names.
    ``limit`` is the crack length up to which it holds, to a load or a support.
    """

    width: float
    thickness: float
    correction: float
    limit: float
    base: float = 0.0
    opening: float = 0.0
    sliding: float = 0.0
    linear: float = 0.0
    shear: float = 0.0
    shear_a: float = 0.0
    separate: bool = True  # whether the part of sliding is known

    def _lengths(self, a: ArrayLike) -> tuple[np.ndarray, np.ndarray, float]:
        """Crack lengths in opening and in sliding (n,), and b h^3."""
        a, D = np.asarray(a, dtype=float), self.correction
        return a + D, a + SLIDING_PART * D, self.width * self.thickness**3

    def compliance(self, a: ArrayLike, E: float) -> np.ndarray:
        """Displacement of the load for a load of 1 (n,)."""
        one, two, scale = self._lengths(a)
        bending = self.base + self.opening * one**3 + self.sliding * two**3 + self.linear * two
        return bending / (scale * E) + self.shear + self.shear_a * np.asarray(a, dtype=float)

    def modulus(self, C: float, a: float) -> float:
        """Flexural modulus that gives the compliance ``C`` at the crack length ``a``; NaN where shear alone exceeds it.

        E_f = bending(a) / (C - shear): de Moura, Morais, Dourado (2008), Eng. Fract. Mech. 75, 3852-3865, for DCB;
        de Moura, Silva, de Morais, Goncalves (2006), Eng. Fract. Mech. 73, 978-993, for ENF; ASTM D6671 for
        the E_1f of an MMB.
        """
        shear = self.shear + self.shear_a * a
        return float(self.compliance(a, 1.0) - shear) / (C - shear) if C > shear else float("nan")

    def crack(self, C: ArrayLike, E: float) -> np.ndarray:
        """Equivalent crack length a_e (n,) of compliances ``C``, NaN below that of no crack: the root of C(a) = C.

        Newton's method: C(a) grows and is convex, so that the first step leads above the root, and the others descend
        to it without passing it.
        """
        wanted = np.asarray(C, dtype=float)
        a = np.full(wanted.shape, 2.0 * self.limit)
        with np.errstate(invalid="ignore", divide="ignore"):
            for _ in range(120):
                step = (self.compliance(a, E) - wanted) / sum(self._slopes(a, E))
                a = a - step
                if not np.any(np.abs(step) > 1e-13 * np.abs(a)):
                    break
            return np.where(a > 0.0, a, np.nan)

    def _slopes(self, a: ArrayLike, E: float) -> tuple[np.ndarray, np.ndarray]:
        """dC/da of opening, with the arms' shear, and of sliding (n,)."""
        one, two, scale = self._lengths(a)
        opened = 3.0 * self.opening * one**2 / (scale * E) + self.shear_a
        return opened, (3.0 * self.sliding * two**2 + self.linear) / (scale * E)

    def release(self, P: ArrayLike, a: ArrayLike, E: float) -> tuple[np.ndarray, np.ndarray]:
        """G_I and G_II (n,) of loads ``P`` at crack lengths ``a``: P^2 / (2 b) dC/da (Irwin and Kies 1954).

        Where the parts are not known (`separate`) all of it is G_I.
        """
        scale = np.asarray(P, dtype=float) ** 2 / (2.0 * self.width)
        opened, slid = self._slopes(a, E)
        return scale * opened, scale * slid


def flexure(coupon: Coupon) -> Flexure:
    """The closed form of a specimen's kind, each with shear of the arms by 3 / (10 b h G) = k:

    - dcb: C = 8 (a + D)^3 / (E b h^3) + 8 k a (de Moura, Morais, Dourado 2008)
    - adcb: C = 4 (a + D)^3 / b [1 / (E_1 h_1^3) + 1 / (E_2 h_2^3)] + shear: both arms as cantilevers
    - enf: C = [2 L^3 + 3 (a + 0.42 D)^3] / (8 E b h^3) + k L (de Moura et al. 2006), 2 L the span, here and below
    - els: C = [l^3 + 3 (a + 0.42 D)^3] / (2 E b h^3) + 2 k l, l the whole length (ISO 15114:2014)
    - 4enf: C = d^2 [3 S - 4 d + 9 (a + 0.42 D - 2 d / 3)] / (8 E b h^3) + k d, S the span, d between the loads; dC/da
      is that of Martin and Davidson (1999), Plast. Rubber Compos. 28, 401-406
    - slb: C = [2 L^3 + 4 (a + D)^3 + 3 (a + 0.42 D)^3] / (8 E b h^3) + k (a / 2 + L): 7 a^3 of Davidson and
      Sundararaman (1996), Int. J. Fract. 78, 193-210, in its parts of opening and sliding, 4 to 3
    - mmb: C = [8 (a + D)^3 (3 c - L)^2 + (6 (a + 0.42 D)^3 + 4 L^3) (c + L)^2] / (16 E b h^3 L^2) (ASTM D6671), hence
      G_I = 12 P^2 (3 c - L)^2 (a + D)^2 / (16 E b^2 h^3 L^2), G_II = 9 P^2 (c + L)^2 (a + 0.42 D)^2 / (16 E b^2 h^3
      L^2) (Reeder and Crews 1990, AIAA J. 28, 1270-1276). A lever shorter than L / 3 presses the arms together, and G_I
      is 0. The weight of the lever is left out.
    """
    (h, h2), length, d = coupon.thickness, coupon.length, coupon.offset
    L, k, ratio = length / 2.0, 3.0 / (10.0 * coupon.width * h * coupon.shear), coupon.moduli[0] / coupon.moduli[1]
    one, two = ((max(arm, 0.0) / (4.0 * L)) ** 2 for arm in (3.0 * coupon.lever - L, coupon.lever + L))
    numbers = {
        "dcb": {"limit": length, "opening": 8.0, "shear_a": 8.0 * k},
        "adcb": {"limit": length, "opening": 4.0 + 4.0 * ratio * (h / h2) ** 3, "shear_a": 4.0 * k * (1.0 + h / h2)},
        "enf": {"limit": L, "base": L**3 / 4.0, "sliding": 3.0 / 8.0, "shear": k * L},
        "els": {"limit": length, "base": length**3 / 2.0, "sliding": 1.5, "shear": 2.0 * k * length},
        "4enf": {
            "limit": length - d,
            "base": d**2 * (3.0 * length - 10.0 * d) / 8.0,
            "linear": 9.0 * d**2 / 8.0,
            "shear": k * d,
        },
        "slb": {
            "limit": L,
            "base": L**3 / 4.0,
            "opening": 0.5,
            "sliding": 3.0 / 8.0,
            "shear": k * L,
            "shear_a": k / 2.0,
        },
        "mmb": {"limit": L, "base": 4.0 * L**3 * two, "opening": 8.0 * one, "sliding": 6.0 * two},
    }[coupon.kind]
    return Flexure(coupon.width, h, coupon.correction, separate=coupon.kind != "adcb", **numbers)
