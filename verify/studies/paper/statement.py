"""A statement, the comparisons of runs that test it, and its verdict."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from math import isfinite
from typing import Literal

import numpy as np

#: Sources of the statements; the paper gives no numbers for Figure 9.
PAPER, CONVERGENCE, READING = "the paper", "convergence", "moduli read as GPa"
THEORY, J_INTEGRAL, LIMIT = "beam theory", "the J-integral", "LEFM, plate limit"

Unit = Literal["ratio", "fraction", "number"]

#: Pairs of a subject and its number.
Found = Iterable[tuple[str, float]]


@dataclass(frozen=True)
class Comparison:
    """One number; ``holds`` is None where a run is missing or the difference is below the error of the reference."""

    subject: str
    value: float
    holds: bool | None


@dataclass(frozen=True)
class Statement:
    """One statement with the comparisons of runs that test it; ``source`` says where it is from."""

    text: str
    measure: str
    unit: Unit
    comparisons: tuple[Comparison, ...]
    source: str = PAPER

    @property
    def verdict(self) -> str:
        held, decided = self._counts
        if not decided:
            return "not tested"
        return "confirmed" if held == decided else "confirmed in part" if held else "not confirmed"

    @property
    def extent(self) -> str:
        """Number of comparisons in which the statement holds, with median and range of their values."""
        values = [c.value for c in self.comparisons if isfinite(c.value)]
        if not values:
            return "no two runs to compare"
        low, middle, high = (self.shown(v) for v in (min(values), float(np.median(values)), max(values)))
        spread = f"{middle}, from {low} to {high}" if low != high else middle
        held, decided = self._counts
        open_ = len(self.comparisons) - decided
        return f"{held} of {decided}{f', {open_} undecided' if open_ else ''}; {self.measure}: {spread}"

    def shown(self, value: float) -> str:
        """A value in the statement's unit."""
        if not isfinite(value):
            return "no value"
        return f"{100 * value:.2g} %" if self.unit == "fraction" else f"{value:.3g}"

    @property
    def _counts(self) -> tuple[int, int]:
        decided = [c.holds for c in self.comparisons if c.holds is not None]
        return sum(decided), len(decided)


def each(
    texts: tuple[str, str], unit: Unit, found: Found, holds: Callable[[float], bool], source: str = PAPER
) -> Statement:
    """A statement that is tested for each number separately; ``texts`` are the statement and the name of the number."""
    comparisons = (Comparison(subject, n, bool(holds(n)) if isfinite(n) else None) for subject, n in found)
    return Statement(*texts, unit, tuple(comparisons), source)


def counted(found: Sequence[Statement]) -> str:
    """The numbers of statements by verdict, as a sentence without full stop."""
    verdicts = [s.verdict for s in found]
    kinds = [k for k in ("confirmed", "confirmed in part", "not confirmed", "not tested") if k in verdicts]
    return f"Of {len(found)} statements " + ", ".join(f"{verdicts.count(kind)} {kind}" for kind in kinds)
