"""Schemes of beam theory: with the measured crack length, or with the one that the compliance says; and J."""

from __future__ import annotations

import numpy as np

from verify.reduction.data import Measured
from verify.reduction.dcb import factors
from verify.reduction.scheme import CannotReduce, Fitted, Setting, measured_crack

#: Kinds to which the factors of large openings belong.
LIKE_A_DCB = ("dcb", "adcb")
#: Passes of the fixed point of an equivalent crack and its factor N, which changes it by a few per cent.
PASSES = 8


def cbt(s: Setting) -> Fitted:
    """Corrected beam theory: G = P^2 / (2 b) dC/da at a + chi h and a + 0.42 chi h (`Flexure`), E that of the scene.

    Williams (1989), Compos. Sci. Technol. 35, 367-376; Wang and Williams (1992) for sliding. Of an mmb E is E_1f, from
    the compliance of the linear part (ASTM D6671).
    """
    bending = s.coupon.kind == "mmb"
    E = flexural(s) if bending else s.coupon.young
    name, what = ("D6671", "ASTM D6671") if bending else ("CBT", "corrected beam theory")

    def release(rows: Measured) -> tuple[np.ndarray, np.ndarray]:
        return _parts(s, rows, rows.crack, E)

    return Fitted(name, what, release, measured_crack, {"E_f": E} if bending else {"E": E})


def cbbm(s: Setting) -> Fitted:
    """Compliance-based beam method: a_e from C(a_e) = d / P, G = P^2 / (2 b) dC/da there; no crack length is read.

    The flexural modulus E_f is that at which the linear part has the compliance of the precrack. de Moura, Morais,
    Dourado (2008), Eng. Fract. Mech. 75, 3852-3865 (DCB); de Moura, Silva, de Morais, Goncalves (2006), Eng. Fract.
    Mech. 73, 978-993 (ENF); Oliveira, de Moura, Silva, Morais (2007), Compos. Sci. Technol. 67, 1764-1771 (MMB). The
    rotation at the tip counts as in `cbt`, in sliding as well, where the first papers left it to E_f.
    """
    E, beam, a0 = flexural(s), s.beam, s.coupon.precrack
    with_factors = s.coupon.kind in LIKE_A_DCB and (s.settings.large or s.settings.block != (0.0, 0.0))

    def crack(rows: Measured) -> np.ndarray:
        a = beam.crack(rows.compliance, E)
        for _ in range(PASSES * with_factors):
            N = factors(rows.opening, np.where(a > 0.0, a, a0), s.settings.large, s.settings.block)[1]
            a = beam.crack(rows.compliance / N, E)
        return a

    def release(rows: Measured) -> tuple[np.ndarray, np.ndarray]:
        return _parts(s, rows, crack(rows), E)

    return Fitted("CBBM", "compliance-based beam method", release, crack, {"E_f": E}, uses_cracks=False)


def flexural(s: Setting) -> float:
    """Modulus of the arms by the compliance of the linear part.

    Raises
    ------
    CannotReduce
    """
    E = s.beam.modulus(s.part.compliance, s.coupon.precrack)
    if not E > 0.0:
        raise CannotReduce("the specimen is stiffer than shear of its arms alone makes it")
    return E


def _parts(s: Setting, rows: Measured, a: np.ndarray, E: float) -> tuple[np.ndarray, np.ndarray]:
    opened, slid = s.beam.release(rows.load, a, E)
    if s.coupon.kind in LIKE_A_DCB:
        F = factors(rows.opening, a, s.settings.large, s.settings.block)[0]
        opened, slid = F * opened, F * slid
    return opened + slid, slid if s.beam.separate else np.full(np.shape(opened), np.nan)


def by_j(s: Setting) -> Fitted:
    """J of rotations, or of a run (`Measured`): its crack lengths are the measured ones, or those of the compliance.

    Raises
    ------
    CannotReduce : nothing of the kind is measured.
    """
    if s.grown.J is None:
        raise CannotReduce("needs rotations of the loaded ends")
    by_compliance = cbbm(s).crack

    def release(rows: Measured) -> tuple[np.ndarray, np.ndarray]:
        assert rows.J is not None
        unknown = np.full(rows.J.shape, np.nan)
        slid = {"enf": rows.J, "els": rows.J, "4enf": rows.J, "dcb": np.zeros_like(rows.J)}.get(s.coupon.kind, unknown)
        return rows.J, slid

    def crack(rows: Measured) -> np.ndarray:
        return np.where(np.isfinite(rows.crack), rows.crack, by_compliance(rows))

    return Fitted("J", "J-integral of rotations", release, crack, uses_cracks=False)
