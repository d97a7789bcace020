"""Peel tests: G of a strip that is pulled off at an angle."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from verify.reduction.coupon import Coupon
from verify.reduction.data import Measured
from verify.reduction.scheme import Fitted, Setting, measured_crack


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


def with_growth(rows: Measured, of: Coupon) -> Measured:
    """The rows with a crack length each: where none is read, the crack grows by the opening over 1 - cos(theta), from
    the first row whose load is the median of all."""
    if rows.has_cracks:
        return rows
    first = int(np.argmax(rows.load >= np.median(rows.load)))
    grown = np.maximum(rows.opening - rows.opening[first], 0.0) / (1.0 - np.cos(of.angle))
    return replace(rows, crack=of.precrack + grown)
