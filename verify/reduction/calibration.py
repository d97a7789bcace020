"""Compliance calibration where the compliance is a polynomial of the crack length: enf, els, slb, 4enf."""

from __future__ import annotations

import numpy as np

from verify.reduction.data import Measured
from verify.reduction.scheme import CannotReduce, Fitted, Setting, fitted_line, measured_crack, readings

#: Kind -> power of the crack length in its compliance.
POWERS = {"enf": 3, "els": 3, "slb": 3, "4enf": 1}


def cc(s: Setting) -> Fitted:
    """C = A + m a^k, hence G = k m P^2 a^(k-1) / (2 b).

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
    m, A = fitted_line(a**power, C)
    if m <= 0.0:
        raise CannotReduce("the compliance does not grow with the crack length")

    def release(rows: Measured) -> tuple[np.ndarray, np.ndarray]:
        G = 0.5 * power * m * rows.load**2 * rows.crack ** (power - 1) / b
        return G, np.full_like(G, np.nan) if s.coupon.kind == "slb" else G

    return Fitted("CC", "compliance calibration", release, measured_crack, {"A": A, "m": m})
