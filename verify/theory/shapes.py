"""Shapes of softening, once for bonds that open and for those that slide as well.

After the part x of the way from onset to failure, in the effective separation, the part r(x) of the traction is left,
with r(0) = 1, r(1) = 0 and the area A. The length of the way follows from the toughness G and the jump at onset, in the
energy norm lambda0, as (G - lambda0^2 / 2) / (lambda0 A).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from verify.support.refusal import Refusal


@dataclass(frozen=True, eq=False)
class Shape:
    """``corners``: the x at which the slope jumps. ``left``: r, a function of 1 - x. ``spent``: its integral from 0 to
    x. ``steepest``: the largest slope -dr/dx."""

    corners: np.ndarray
    left: Callable[[Any], np.ndarray]
    spent: Callable[[Any], np.ndarray]
    steepest: float

    @cached_property
    def area(self) -> float:
        return float(self.spent(1.0))

    @property
    def steepness(self) -> float:
        """Of the softening, over that of a straight line with as much toughness."""
        return 2.0 * self.area * self.steepest

    @property
    def at_failure(self) -> float:
        """The same where the bond fails, at least 1: faces open fastest there."""
        near = 1e-6
        return max(1.0, 2.0 * self.area * float(self.left(near)) / near)


def lines(*corners: tuple[float, float]) -> Shape:
    """Straight lines through (x, r)."""
    at, r = np.array(corners).T
    up_to = np.concatenate([[0.0], np.cumsum(0.5 * (r[1:] + r[:-1]) * np.diff(at))])

    def spent(x: Any) -> np.ndarray:
        x = np.clip(x, 0.0, 1.0)
        i = np.searchsorted(at, x, side="right") - 1
        return np.asarray(up_to[i] + 0.5 * (r[i] + np.interp(x, at, r)) * (x - at[i]))

    steepest = float(np.max(-np.diff(r) / np.diff(at)))
    return Shape(at, lambda to_go: np.asarray(np.interp(to_go, 1.0 - at[::-1], r[::-1])), spent, steepest)


def decaying(keys: Any) -> Shape:
    """r = (exp(-a x) - exp(-a)) / (1 - exp(-a)), as in Abaqus with SOFTENING=EXPONENTIAL."""
    a = keys.decay
    if not 0.1 <= a <= 100.0:
        raise Refusal(f"decay: must be in [0.1, 100], got {a:g}")

    def left(to_go: Any) -> np.ndarray:
        return np.asarray(np.expm1(a * np.clip(to_go, 0.0, 1.0)) / np.expm1(a))

    def spent(x: Any) -> np.ndarray:
        x = np.clip(x, 0.0, 1.0)
        return np.asarray(-np.expm1(-a * x) / a - x * np.exp(-a)) / -np.expm1(-a)

    return Shape(np.array([0.0, 1.0]), left, spent, -a / np.expm1(-a))


def level(keys: Any) -> Shape:
    """The traction stays for the part ``plateau`` of the way."""
    if not 0.0 <= keys.plateau < 1.0:
        raise Refusal(f"plateau: must be in [0, 1), got {keys.plateau:g}")
    return lines((0.0, 1.0), *[(keys.plateau, 1.0)] * (keys.plateau > 0.0), (1.0, 0.0))


def bent(keys: Any) -> Shape:
    """Two lines that meet at (knee, knee_traction)."""
    for key in ("knee", "knee_traction"):
        if not 0.0 < getattr(keys, key) < 1.0:
            raise Refusal(f"{key}: must be in (0, 1), got {getattr(keys, key):g}")
    return lines((0.0, 1.0), (keys.knee, keys.knee_traction), (1.0, 0.0))


def tabular(keys: Any) -> Shape:
    """Lines through a ``table`` of openings and tractions, as of fibres that bridge a crack; damage does not heal."""
    table = np.array(keys.table, dtype=float)
    if table.shape[1:] != (2,) or len(table) < 2 or not np.all(np.isfinite(table)):
        raise Refusal(f"table: must be two or more pairs of opening and traction, got {table.tolist()}")
    opening, traction = table.T
    if opening[0] <= 0.0 or np.any(np.diff(opening) <= 0.0):
        raise Refusal(f"table: openings must rise from above 0, got {opening.tolist()}")
    if np.any(traction[:-1] <= 0.0) or traction[-1] != 0.0:
        raise Refusal(f"table: tractions must be > 0 and the last one 0, got {traction.tolist()}")
    if np.any(np.diff(traction / opening) >= 0.0):
        raise Refusal(f"table: traction / opening must fall from pair to pair, got {(traction / opening).tolist()}")
    return lines(*zip((opening - opening[0]) / np.ptp(opening), traction / traction[0], strict=True))


#: Name in a scene -> shape of its keys.
KNOWN_SHAPES: dict[str, Callable[[Any], Shape]] = {
    "bilinear": lambda _: lines((0.0, 1.0), (1.0, 0.0)),
    "trapezoidal": level,
    "trilinear": bent,
    "tabular": tabular,
    "exponential-softening": decaying,
}


@dataclass(frozen=True, kw_only=True)
class Keys:
    """Keys of the shapes, of which each has its own: ``plateau``, part of the way on which the traction stays;
    ``knee``, ``knee_traction``, the corner of the trilinear law; ``decay``, of the exponential softening; ``table``,
    openings and tractions of corners."""

    plateau: float = 0.5
    knee: float = 0.2
    knee_traction: float = 0.25
    decay: float = 5.0
    table: tuple[tuple[float, float], ...] = ()
