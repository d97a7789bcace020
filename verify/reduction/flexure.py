"""Compliance and energy release rate of delamination specimens by beam theory, one formula for every kind."""

from __future__ import annotations

from collections.abc import Callable
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

    @property
    def _scale(self) -> float:
        return self.width * self.thickness**3

    def _bending(self, a: ArrayLike) -> np.ndarray:
        a, D = np.asarray(a, dtype=float), self.correction
        cubes = self.opening * (a + D) ** 3 + self.sliding * (a + SLIDING_PART * D) ** 3
        return (self.base + cubes + self.linear * (a + SLIDING_PART * D)) / self._scale

    def compliance(self, a: ArrayLike, E: float) -> np.ndarray:
        """Displacement of the load for a load of 1 (n,)."""
        return self._bending(a) / E + self.shear + self.shear_a * np.asarray(a, dtype=float)

    def modulus(self, C: float, a: float) -> float:
        """Flexural modulus that gives the compliance ``C`` at the crack length ``a``; NaN where shear alone exceeds it.

        E_f = bending(a) / (C - shear): de Moura, Morais, Dourado (2008), Eng. Fract. Mech. 75, 3852-3865, for DCB;
        de Moura, Silva, de Morais, Goncalves (2006), Eng. Fract. Mech. 73, 978-993, for ENF; ASTM D6671 for
        the E_1f of an MMB.
        """
        left = C - self.shear - self.shear_a * a
        return float(self._bending(a)) / left if left > 0.0 else float("nan")

    def crack(self, C: ArrayLike, E: float) -> np.ndarray:
        """Equivalent crack length a_e (n,) of compliances ``C``, NaN below that of no crack: the root of C(a) = C.

        Newton's method from above; C(a) grows and is convex, so it descends to the root without passing it.
        """
        wanted = np.asarray(C, dtype=float)
        a = np.full(wanted.shape, 2.0 * self.limit)
        with np.errstate(invalid="ignore", divide="ignore"):
            for _ in range(60):
                short = self.compliance(a, E) < wanted
                a = np.where(short, 2.0 * a, a)
                if not short.any():
                    break
            for _ in range(60):
                step = (self.compliance(a, E) - wanted) / self._slope(a, E)
                a = a - step
                if not np.any(np.abs(step) > 1e-13 * np.abs(a)):
                    break
            return np.where(a > 0.0, a, np.nan)

    def _slope(self, a: np.ndarray, E: float) -> np.ndarray:
        opened, slid = self._parts(a, E)
        return opened + slid

    def _parts(self, a: ArrayLike, E: float) -> tuple[np.ndarray, np.ndarray]:
        """dC/da of opening, with the arms' shear, and of sliding (n,)."""
        a, D = np.asarray(a, dtype=float), self.correction
        opened = 3.0 * self.opening * (a + D) ** 2 / (self._scale * E) + self.shear_a
        slid = (3.0 * self.sliding * (a + SLIDING_PART * D) ** 2 + self.linear) / (self._scale * E)
        return opened, slid

    def release(self, P: ArrayLike, a: ArrayLike, E: float) -> tuple[np.ndarray, np.ndarray]:
        """G_I and G_II (n,) of loads ``P`` at crack lengths ``a``: P^2 / (2 b) dC/da (Irwin and Kies 1954).

        Where the parts are not known (`separate`) all of it is G_I.
        """
        scale = np.asarray(P, dtype=float) ** 2 / (2.0 * self.width)
        opened, slid = self._parts(a, E)
        return scale * opened, scale * slid


def flexure(coupon: Coupon) -> Flexure:
    """The closed form of a specimen's kind."""
    return FORMS[coupon.kind](coupon)


def _dcb(c: Coupon) -> Flexure:
    """C = 8 (a + D)^3 / (E b h^3) + 12 a / (5 b h G) (de Moura, Morais, Dourado 2008)."""
    shear = 12.0 / (5.0 * c.width * c.h * c.shear)
    return Flexure(c.width, c.h, c.correction, c.length, opening=8.0, shear_a=shear)


def _adcb(c: Coupon) -> Flexure:
    """C = 4 (a + D)^3 / b [1 / (E_1 h_1^3) + 1 / (E_2 h_2^3)] + shear: both arms as cantilevers."""
    (h1, h2), ratio = c.thickness, c.moduli[0] / c.moduli[1]
    shear = 6.0 / (5.0 * c.width * c.shear) * (1.0 / h1 + 1.0 / h2)
    unequal = 4.0 * c.h**3 * (1.0 / h1**3 + ratio / h2**3)
    return Flexure(c.width, c.h, c.correction, c.length, opening=unequal, shear_a=shear, separate=False)


def _enf(c: Coupon) -> Flexure:
    """C = [2 L^3 + 3 (a + 0.42 D)^3] / (8 E b h^3) + 3 L / (10 b h G) (de Moura et al. 2006)."""
    L = c.length / 2.0
    shear = 3.0 * L / (10.0 * c.width * c.h * c.shear)
    return Flexure(c.width, c.h, c.correction, L, base=L**3 / 4.0, sliding=3.0 / 8.0, shear=shear)


def _els(c: Coupon) -> Flexure:
    """C = [L^3 + 3 (a + 0.42 D)^3] / (2 E b h^3) + 3 L / (5 b h G), L the whole length (ISO 15114:2014)."""
    shear = 3.0 * c.length / (5.0 * c.width * c.h * c.shear)
    return Flexure(c.width, c.h, c.correction, c.length, base=c.length**3 / 2.0, sliding=1.5, shear=shear)


def _four_point(c: Coupon) -> Flexure:
    """C = d^2 [3 S - 4 d + 9 (a + 0.42 D - 2 d / 3)] / (8 E b h^3) + 3 d / (10 b h G), S the span, between the loads.

    dC/da is that of Martin and Davidson (1999), Plast. Rubber Compos. 28, 401-406.
    """
    S, d = c.length, c.offset
    shear = 3.0 * d / (10.0 * c.width * c.h * c.shear)
    base = d**2 * (3.0 * S - 10.0 * d) / 8.0
    return Flexure(c.width, c.h, c.correction, S - d, base=base, linear=9.0 * d**2 / 8.0, shear=shear)


def _slb(c: Coupon) -> Flexure:
    """C = [2 L^3 + 4 (a + D)^3 + 3 (a + 0.42 D)^3] / (8 E b h^3) + 3 (a / 2 + L) / (10 b h G).

    7 a^3 of Davidson and Sundararaman (1996), Int. J. Fract. 78, 193-210, in its parts of opening and sliding, 4 to 3.
    """
    L, shear = c.length / 2.0, 3.0 / (10.0 * c.width * c.h * c.shear)
    base, D = L**3 / 4.0, c.correction
    return Flexure(c.width, c.h, D, L, base, 0.5, 3.0 / 8.0, shear=shear * L, shear_a=shear / 2.0)


def _mmb(c: Coupon) -> Flexure:
    """C = [8 (a + D)^3 (3 c - L)^2 + (6 (a + 0.42 D)^3 + 4 L^3) (c + L)^2] / (16 E b h^3 L^2) (ASTM D6671).

    Hence G_I = 12 P^2 (3 c - L)^2 (a + D)^2 / (16 E b^2 h^3 L^2), G_II = 9 P^2 (c + L)^2 (a + 0.42 D)^2 / (16 E b^2 h^3
    L^2) (Reeder and Crews 1990, AIAA J. 28, 1270-1276). A lever shorter than L / 3 presses the arms together, and G_I
    is 0. The weight of the lever is left out.
    """
    L, lever = c.length / 2.0, c.lever
    one, two = max(3.0 * lever - L, 0.0) ** 2 / (16.0 * L**2), (lever + L) ** 2 / (16.0 * L**2)
    return Flexure(c.width, c.h, c.correction, L, base=4.0 * L**3 * two, opening=8.0 * one, sliding=6.0 * two)


#: Kind of specimen -> its closed form.
FORMS: dict[str, Callable[[Coupon], Flexure]] = {
    "dcb": _dcb,
    "adcb": _adcb,
    "enf": _enf,
    "els": _els,
    "4enf": _four_point,
    "slb": _slb,
    "mmb": _mmb,
}
