"""Schemes of beam theory and of calibration, J, and which schemes every kind of specimen has."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from verify.reduction import dcb
from verify.reduction.data import Measured
from verify.reduction.scheme import CannotReduce, Fitted, Setting, growing_line, measured_crack, readings


def peel(s: Setting) -> Fitted:
    """G = P (1 - cos theta) / b + P^2 / (2 b^2 h E) of a strip that stretches, theta the angle of the load to the bond.

    Kinloch, Lau, Williams (1994), Int. J. Fract. 66, 45-70, without what plastic bending dissipates. Where the rotation
    phi of the pulled end is known, the arm need not be in line with the load: G = P [cos(theta - phi) - cos(theta)] / b
    + N^2 / (2 b^2 h E), N = P cos(theta - phi), by the J-integral around the arm. `Measured` has the first part as J.
    """
    b, level, EA = s.coupon.width, np.cos(s.coupon.angle), s.coupon.stretching

    def release(rows: Measured) -> tuple[np.ndarray, np.ndarray]:
        J = rows.load * (1.0 - level) / b if rows.J is None else rows.J
        N = J * b + rows.load * level
        return J + N**2 / (2.0 * b * EA), np.full(J.size, np.nan)

    return Fitted("peel at an angle", release, measured_crack)


#: Kinds to which the factors of large openings belong, and those in which all slides.
LIKE_A_DCB, ALL_SLIDES = ("dcb", "adcb"), ("enf", "els", "4enf")
#: Kind -> power of the crack length in its compliance.
POWERS = {"enf": 3, "els": 3, "slb": 3, "4enf": 1}
#: Passes of the fixed point of an equivalent crack and its factor N, which changes it by a few per cent.
PASSES = 8


def cc(s: Setting) -> Fitted:
    """Compliance calibration: C = A + m a^k, hence G = k m P^2 a^(k-1) / (2 b).

    k = 3: ASTM D7905, 13.1, whose A and m come from three precracks that are loaded and not broken (`calibration` of
    the settings); without these, and in the experimental compliance method of ISO 15114, from the crack lengths of the
    test itself. Single-leg bending alike: Davidson and Sundararaman (1996), Int. J. Fract. 78, 193-210. k = 1, four-
    point ENF: Martin and Davidson (1999), Plast. Rubber Compos. 28, 401-406.
    """
    power, b = POWERS[s.coupon.kind], s.coupon.width
    if s.settings.calibration:
        a, C = np.array(s.settings.calibration, dtype=float).T
        C = C - s.settings.machine
    else:
        rows = readings(s)
        a, C = rows.crack, rows.compliance
    m, A = growing_line(a**power, C)

    def release(rows: Measured) -> tuple[np.ndarray, np.ndarray]:
        G = 0.5 * power * m * rows.load**2 * rows.crack ** (power - 1) / b
        return G, np.full_like(G, np.nan) if s.coupon.kind == "slb" else G

    return Fitted("compliance calibration", release, measured_crack, {"A": A, "m": m})


def cbt(s: Setting) -> Fitted:
    """Corrected beam theory: G = P^2 / (2 b) dC/da at a + chi h and a + 0.42 chi h (`Flexure`), E that of the scene.

    Williams (1989), Compos. Sci. Technol. 35, 367-376; Wang and Williams (1992) for sliding. Of an mmb E is E_1f, from
    the compliance of the linear part (ASTM D6671).
    """
    what, constants = "corrected beam theory", {"E": s.coupon.young}
    if s.coupon.kind == "mmb":
        what, constants = "ASTM D6671", {"E_f": _flexural(s)}
    (E,) = constants.values()
    return Fitted(what, lambda rows: _parts(s, rows, rows.crack, E), measured_crack, constants)


def cbbm(s: Setting) -> Fitted:
    """Compliance-based beam method: a_e from C(a_e) = d / P, G = P^2 / (2 b) dC/da there; no crack length is read.

    The flexural modulus E_f is that at which the linear part has the compliance of the precrack. de Moura, Morais,
    Dourado (2008), Eng. Fract. Mech. 75, 3852-3865 (DCB); de Moura, Silva, de Morais, Goncalves (2006), Eng. Fract.
    Mech. 73, 978-993 (ENF); Oliveira, de Moura, Silva, Morais (2007), Compos. Sci. Technol. 67, 1764-1771 (MMB). The
    rotation at the tip counts as in `cbt`, in sliding as well, where the first papers left it to E_f.
    """
    E, beam, a0, settings = _flexural(s), s.beam, s.coupon.precrack, s.settings
    with_factors = s.coupon.kind in LIKE_A_DCB and (settings.large or settings.block != (0.0, 0.0))

    def crack(rows: Measured) -> np.ndarray:
        a = beam.crack(rows.compliance, E)
        for _ in range(PASSES * with_factors):
            N = dcb.factors(rows.opening, np.where(a > 0.0, a, a0), settings.large, settings.block)[1]
            a = beam.crack(rows.compliance / N, E)
        return a

    return Fitted("compliance-based beam method", lambda rows: _parts(s, rows, crack(rows), E), crack, {"E_f": E})


def by_j(s: Setting) -> Fitted:
    """J of rotations, or of a run (`Measured`): its crack lengths are the measured ones, or those of the compliance.

    Raises
    ------
    CannotReduce : nothing of the kind is measured.
    """
    if s.grown.J is None:
        raise CannotReduce("needs rotations of the loaded ends")
    by_compliance, kind = cbbm(s).crack, s.coupon.kind
    part = 1.0 if kind in ALL_SLIDES else 0.0 if kind == "dcb" else np.nan

    def release(rows: Measured) -> tuple[np.ndarray, np.ndarray]:
        assert rows.J is not None
        return rows.J, part * rows.J

    def crack(rows: Measured) -> np.ndarray:
        return np.where(np.isfinite(rows.crack), rows.crack, by_compliance(rows))

    return Fitted("J-integral of rotations", release, crack)


def _flexural(s: Setting) -> float:
    """Modulus of the arms by the compliance of the linear part.

    Raises
    ------
    CannotReduce
    """
    if not s.part.rows.size:
        raise CannotReduce("needs a linear part, and the file has readings of a growing crack alone")
    E = s.beam.modulus(s.part.compliance, s.coupon.precrack)
    if not E > 0.0:
        raise CannotReduce("the specimen is stiffer than shear of its arms alone makes it")
    return E


def _parts(s: Setting, rows: Measured, a: np.ndarray, E: float) -> tuple[np.ndarray, np.ndarray]:
    """G and its part G_II (n,) at crack lengths ``a``, with F where it belongs."""
    opened, slid = s.beam.release(rows.load, a, E)
    F = dcb.factors(rows.opening, a, s.settings.large, s.settings.block)[0] if s.coupon.kind in LIKE_A_DCB else 1.0
    return F * (opened + slid), F * slid if s.beam.separate else np.full(np.shape(opened), np.nan)


Schemes = dict[str, Callable[[Setting], Fitted]]
_OPENED: Schemes = {"MBT": dcb.mbt, "CC": dcb.cc, "MCC": dcb.mcc, "CBT": cbt, "CBBM": cbbm, "J": by_j}
_BENT: Schemes = {"CC": cc, "CBT": cbt, "CBBM": cbbm, "J": by_j}

#: Kind -> name -> scheme, in the order of tables.
SCHEMES: dict[str, Schemes] = {
    **dict.fromkeys(LIKE_A_DCB, _OPENED),
    **dict.fromkeys(POWERS, _BENT),
    "mmb": {"D6671": cbt, "CBBM": cbbm, "J": by_j},
    "peel": {"peel": peel},
}
