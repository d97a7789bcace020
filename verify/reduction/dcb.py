"""Double cantilever beams with crack lengths: MBT, CC, MCC of ASTM D5528 and ISO 15024, and their factors F and N."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike

from verify.reduction.corrections import fitted_line
from verify.reduction.data import Measured
from verify.reduction.scheme import CannotReduce, Fitted, Setting, growing_line, measured_crack, readings
from verify.theory.lefm import F2, N2


def factors(opening: ArrayLike, a: ArrayLike, large: bool, block: tuple[float, float]) -> tuple[np.ndarray, np.ndarray]:
    """F of the shortened arms and tilted blocks, and N of the stiffening by blocks (n,).

        F = 1 - 3/10 (d/a)^2 - 3/2 d l1/a^2
        N = 1 - (l2/a)^3 - 9/8 [1 - (l2/a)^2] d l1/a^2 - 9/35 (d/a)^2

    ASTM D5528, annex A1, after Hashemi, Kinloch, Williams (1990), Proc. R. Soc. A 427, 173-199; terms of (d/a)^2 are
    left out where not ``large``. ASTM calls (l1, l2) t and L'. ISO 15024 has the same N, and a factor 2/3 for blocks in
    F in place of the 3/2 that is derived in 1990.
    """
    d, a = np.asarray(opening, dtype=float), np.asarray(a, dtype=float)
    l1, l2 = block
    square, tilt, clamp = large * (d / a) ** 2, d * l1 / a**2, l2 / a
    F = 1.0 - F2 * square - 1.5 * tilt
    N = 1.0 - clamp**3 - 1.125 * (1.0 - clamp**2) * tilt - N2 * square
    return F, N


def _corrected_root(s: Setting) -> tuple[Measured, np.ndarray]:
    """Rows with readings, and (C / N)^(1/3) of them."""
    rows = readings(s)
    _, N = factors(rows.opening, rows.crack, s.settings.large, s.settings.block)
    with np.errstate(invalid="ignore"):
        root = np.cbrt(rows.compliance / N)
    if not (N > 0.0).all():
        raise CannotReduce("the opening is too large beside the crack length for the factor N, or the block too long")
    return rows, root


def _fitted(
    s: Setting, what: str, constants: dict[str, float], G: Callable[[Measured, np.ndarray], np.ndarray]
) -> Fitted:
    """A scheme by ``G`` of rows and their N (n,), without F / b. What slides of an adcb is not known."""

    def release(rows: Measured) -> tuple[np.ndarray, np.ndarray]:
        F, N = factors(rows.opening, rows.crack, s.settings.large, s.settings.block)
        found = G(rows, N) * F / s.coupon.width
        return found, np.full_like(found, 0.0 if s.coupon.kind == "dcb" else np.nan)

    return Fitted(what, release, measured_crack, constants)


def mbt(s: Setting) -> Fitted:
    """Modified beam theory: G_I = 3 P d F / [2 b (a + |D|) N], D where the line of (C/N)^(1/3) over a meets the axis.

    ASTM D5528, 13.2.1; ISO 15024, method A (corrected beam theory).
    """
    rows, root = _corrected_root(s)
    slope, at_zero = growing_line(rows.crack, root)
    D = at_zero / slope
    G = lambda rows, N: 1.5 * rows.load * rows.opening / ((rows.crack + D) * N)  # noqa: E731
    return _fitted(s, "modified beam theory", {"Delta": D}, G)


def cc(s: Setting) -> Fitted:
    """Compliance calibration of Berry: G_I = n P d F / (2 b a N), n the slope of log(C/N) over log a.

    ASTM D5528, 13.2.2; not in ISO 15024.
    """
    rows, root = _corrected_root(s)
    n = 3.0 * fitted_line(np.log(rows.crack), np.log(root))[0]
    G = lambda rows, N: 0.5 * n * rows.load * rows.opening / (rows.crack * N)  # noqa: E731
    return _fitted(s, "compliance calibration", {"n": n}, G)


def mcc(s: Setting) -> Fitted:
    """Modified compliance calibration: G_I = 3 P^2 (C/N)^(2/3) F / (2 A1 b t), A1 the slope of a/t over (C/N)^(1/3).

    t is the thickness of both arms. ASTM D5528, 13.2.3; ISO 15024, method B.
    """
    rows, root = _corrected_root(s)
    t = sum(s.coupon.thickness)
    A1, _ = growing_line(root, rows.crack / t)
    G = lambda rows, N: 1.5 * rows.load**2 * np.cbrt(rows.compliance / N) ** 2 / (A1 * t)  # noqa: E731
    return _fitted(s, "modified compliance calibration", {"A1": A1}, G)
