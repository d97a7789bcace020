"""Shapes of softening: the part f of the traction at onset that is left on the way from there to failure.

The way is measured by the effective separation, the opening or the energy norm of a jump, as a part x from 0 to 1. A
law scales the way so that the area is its toughness, at every mode ratio. A shape is a row in `SHAPES`, and serves laws
that open alone and laws that slide.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any, ClassVar, TypeVar

import numpy as np
from scipy.special import wrightomega

#: Part of the stiffness below which the place on the way is that of a failed point.
NOTHING_LEFT = 1e-15


class Shape(ABC):
    """``f`` falls from 1 at the onset to 0 at failure, with ``corners`` (x, f) from (0, 1) to (1, 0).

    Arguments ``left`` (n,) are 1 - x, clipped to [0, 1].
    """

    corners: tuple[tuple[float, float], ...] = ((0.0, 1.0), (1.0, 0.0))

    @cached_property
    def area(self) -> float:
        """Integral of f over the way."""
        return float(self.rest(np.ones(())))

    @abstractmethod
    def at(self, left: np.ndarray) -> tuple[np.ndarray, np.ndarray | float]:
        """f, and its derivative by ``left``; at a corner that of the side of failure."""

    @abstractmethod
    def rest(self, left: np.ndarray) -> np.ndarray:
        """Integral of f from there to failure."""

    @abstractmethod
    def reached(self, kept: np.ndarray, slender: float) -> tuple[np.ndarray, np.ndarray]:
        """``lambda / lambda0`` (n,) at which the part ``kept`` = 1 - d of the stiffness is left, and its slope by d,
        of a law with ``lambda_f / lambda0 = 1 + slender``."""


@dataclass(frozen=True)
class Lines(Shape):
    """Straight lines through the corners (x, f)."""

    corners: tuple[tuple[float, float], ...] = Shape.corners

    @cached_property
    def _lines(self) -> tuple[np.ndarray, ...]:
        """Places and parts (n + 1,) of the corners, slopes by ``left`` and parts at the onset (n,) of the lines."""
        x_n, f_n = np.array(self.corners).T.copy()
        slope_n = -np.diff(f_n) / np.diff(x_n)
        return x_n, f_n, slope_n, f_n[:-1] + slope_n * x_n[:-1]

    def at(self, left: np.ndarray) -> tuple[np.ndarray, np.ndarray | float]:
        x_n, f_n, slope_n, _ = self._lines
        left = np.maximum(np.minimum(left, 1.0), 0.0)  # clip takes longer for few points
        if slope_n.size == 1:
            return left, 1.0
        n = np.searchsorted(x_n[1:-1], 1.0 - left, side="right")
        return f_n[n + 1] + slope_n[n] * (left - (1.0 - x_n[n + 1])), slope_n[n]

    def rest(self, left: np.ndarray) -> np.ndarray:
        x_n, f_n, slope_n, _ = self._lines
        ways = np.clip(np.clip(left, 0.0, 1.0)[..., None] - (1.0 - x_n[1:]), 0.0, np.diff(x_n))  # on each line
        return np.sum((f_n[1:] + 0.5 * slope_n * ways) * ways, axis=-1)

    def reached(self, kept: np.ndarray, slender: float) -> tuple[np.ndarray, np.ndarray]:
        x_n, f_n, slope_n, top_n = self._lines
        n = np.searchsorted(-f_n[1:-1] / (1.0 + slender * x_n[1:-1]), -kept, side="right")
        slope, top = slope_n[n], top_n[n]
        below = slope + kept * slender
        return 1.0 + slender * (top - kept) / below, slender * (slope + top * slender) / below**2


@dataclass(frozen=True)
class Decaying(Shape):
    """``(exp(-a x) - exp(-a)) / (1 - exp(-a))`` with a = ``decay``; the larger, the steeper after the onset.

    Raises
    ------
    ValueError : a decay below 0.1, which is a line, or above 100.
    """

    decay: float

    def __post_init__(self) -> None:
        if not 0.1 <= self.decay <= 100.0:
            raise ValueError(f"decay must be >= 0.1 and <= 100, got {self.decay}")

    def at(self, left: np.ndarray) -> tuple[np.ndarray, np.ndarray | float]:
        grown, whole = np.expm1(self.decay * np.clip(left, 0.0, 1.0)), np.expm1(self.decay)
        return grown / whole, self.decay * (grown + 1.0) / whole

    def rest(self, left: np.ndarray) -> np.ndarray:
        left, a = np.clip(left, 0.0, 1.0), self.decay
        return (np.expm1(a * left) / a - left) / np.expm1(a)

    def reached(self, kept: np.ndarray, slender: float) -> tuple[np.ndarray, np.ndarray]:
        """By Wright's function, and a step of Newton for the digits that it loses near failure."""
        a, kept = self.decay, np.maximum(kept, NOTHING_LEFT)
        chord = kept * slender * np.expm1(a)  # exp(a left) = meets - chord left
        meets = 1.0 + chord + kept * np.expm1(a)
        left = np.clip(meets / chord - wrightomega(np.log(a / chord) + a * meets / chord) / a, 0.0, 1.0)
        f, slope = self.at(left)
        left = np.clip(left - (f - kept * (1.0 + slender * (1.0 - left))) / (slope + kept * slender), 0.0, 1.0)
        x = 1.0 + slender * (1.0 - left)
        return x, slender * x / (self.at(left)[1] + kept * slender)


@dataclass(frozen=True, kw_only=True)
class Softening:
    """The keys of all shapes, of which each uses its own, and the shape of its ``row`` of `SHAPES`.

    ``plateau``: part of the way on which the traction stays. ``knee``, ``knee_traction``: part of the way after which
    the slope changes, and what is left there. ``decay``: see `Decaying`. ``table``: openings and tractions of corners,
    the first at onset.

    Raises
    ------
    ValueError : a key out of its range.
    """

    plateau: float = 0.5
    knee: float = 0.2
    knee_traction: float = 0.25
    decay: float = 5.0
    table: tuple[tuple[float, float], ...] = ()
    row: ClassVar[str] = "bilinear"

    @cached_property
    def shape(self) -> Shape:
        if not 0.0 <= self.plateau < 1.0:
            raise ValueError(f"plateau must be >= 0 and < 1, got {self.plateau}")
        for key in ("knee", "knee_traction"):
            if not 0.0 < getattr(self, key) < 1.0:
                raise ValueError(f"{key} must be > 0 and < 1, got {getattr(self, key)}")
        return SHAPES[self.row](self)


def _of_a_table(keys: Softening) -> Shape:
    """Damage would stop or heal where the secants do not fall."""
    corners = np.asarray(keys.table, dtype=float)
    if corners.ndim != 2 or corners.shape[0] < 2 or corners.shape[1] != 2 or not np.all(np.isfinite(corners)):
        raise ValueError(f"table must be two or more pairs of opening and traction, got {keys.table}")
    g_n, p_n = corners.T
    if not (g_n[0] > 0.0 and np.all(np.diff(g_n) > 0.0)):
        raise ValueError(f"openings of the table must rise from above zero, got {g_n.tolist()}")
    if not (p_n[0] > 0.0 and np.all(p_n >= 0.0) and p_n[-1] == 0.0):
        raise ValueError(f"tractions of the table must be >= 0, the first one > 0, the last one 0, got {p_n.tolist()}")
    if not np.all(np.diff(p_n / g_n) < 0.0):
        raise ValueError(f"traction over opening must fall from corner to corner, got {(p_n / g_n).tolist()}")
    x_n, f_n = (g_n - g_n[0]) / (g_n[-1] - g_n[0]), p_n / p_n[0]
    return Lines(tuple(zip(x_n.tolist(), f_n.tolist(), strict=True)))


#: Name in a scene -> shape.
SHAPES: dict[str, Callable[[Any], Shape]] = {
    "bilinear": lambda keys: Lines(),
    "trapezoidal": lambda keys: Lines(((0.0, 1.0), *[(keys.plateau, 1.0)] * (keys.plateau > 0.0), (1.0, 0.0))),
    "trilinear": lambda keys: Lines(((0.0, 1.0), (keys.knee, keys.knee_traction), (1.0, 0.0))),
    "tabular": _of_a_table,
    "exponential-softening": lambda keys: Decaying(keys.decay),
}

_Law = TypeVar("_Law", bound=Softening)


def shaped(law: type[_Law]) -> dict[str, type[_Law]]:
    """Name in a scene -> the law with this shape."""
    return {row: type(law.__name__, (law,), {"row": row, "__module__": law.__module__}) for row in SHAPES}
