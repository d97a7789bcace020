"""What a scheme of data reduction is: fitted to a test once, it gives G of any of its rows."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np

from verify.reduction.corrections import LinearPart, fitted_line
from verify.reduction.coupon import Coupon
from verify.reduction.data import Measured
from verify.reduction.flexure import Flexure, flexure

#: G and its part G_II (n,) of rows, NaN where that part is not known.
Release = Callable[[Measured], tuple[np.ndarray, np.ndarray]]


@dataclass(frozen=True)
class Settings:
    """What a user decides.

    Parameters
    ----------
    window : loads between which the curve is linear, in parts of the largest
    toe : whether the origin is moved to that of the linear part
    machine : compliance of the machine, which takes its part of the opening
    large : whether F and N of moderately large openings count (dcb, adcb)
    block : (l1, l2) of load blocks: from the pin to the middle of the arm, and to the edge of the block
    begin, end : range of crack growth from which the propagation value is; None: chosen
    calibration : crack lengths and compliances of unloaded precracks (ASTM D7905)
    """

    window: tuple[float, float] = (0.2, 0.5)
    toe: bool = True
    machine: float = 0.0
    large: bool = False
    block: tuple[float, float] = (0.0, 0.0)
    begin: float | None = None
    end: float | None = None
    calibration: tuple[tuple[float, float], ...] = ()


@dataclass(frozen=True)
class Fitted:
    """A scheme with its numbers.

    ``crack`` gives the crack length (n,) that it takes of rows.
    """

    what: str
    release: Release
    crack: Callable[[Measured], np.ndarray]
    constants: Mapping[str, float] = field(default_factory=dict)


class CannotReduce(Exception):
    """Why a scheme gives nothing here."""


@dataclass(frozen=True)
class Setting:
    """What a scheme is fitted to: rows ``grown`` with a crack length on which the crack grows, and the linear part."""

    coupon: Coupon
    settings: Settings
    part: LinearPart
    grown: Measured

    @property
    def beam(self) -> Flexure:
        return flexure(self.coupon)


#: The fewest crack lengths that a fit of two numbers rests on.
FEWEST = 3


def readings(s: Setting) -> Measured:
    """The rows with a crack length, if there are enough.

    Raises
    ------
    CannotReduce
    """
    found = s.grown.at(np.isfinite(s.grown.crack) & (s.grown.load > 0.0))
    count = np.unique(found.crack).size
    if count < FEWEST:
        raise CannotReduce(f"needs {FEWEST} crack lengths or more while the crack grows, got {count}")
    return found


def growing_line(x: np.ndarray, y: np.ndarray) -> tuple[float, float]:
    """Slope and intercept of a line by which the compliance grows with the crack length.

    Raises
    ------
    CannotReduce
    """
    slope, at_zero = fitted_line(x, y)
    if slope <= 0.0:
        raise CannotReduce("the compliance does not grow with the crack length")
    return slope, at_zero


def measured_crack(rows: Measured) -> np.ndarray:
    return rows.crack
