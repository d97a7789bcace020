"""Comparisons of runs, and the verdict that they give on a statement."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import isfinite, nan
from typing import Literal

import numpy as np

from verify.studies.paper.study import AnyCase, Trials, distance

#: What is seen in a figure: curves whose relative L2 distance is below this lie within the width of a drawn line.
VISIBLE = 0.01

Unit = Literal["ratio", "fraction", "number"]


@dataclass(frozen=True)
class Comparison:
    """One number; ``holds`` is None where a run is missing or the reference is too coarse to tell."""

    subject: str
    value: float
    holds: bool | None


@dataclass(frozen=True)
class Statement:
    """One statement, and every comparison of runs that it can be held against; ``source`` says who expects it."""

    text: str
    measure: str
    unit: Unit
    comparisons: tuple[Comparison, ...]
    source: str = "the paper"

    @property
    def decided(self) -> tuple[Comparison, ...]:
        return tuple(c for c in self.comparisons if c.holds is not None)

    @property
    def held(self) -> int:
        return sum(bool(c.holds) for c in self.decided)

    @property
    def verdict(self) -> str:
        if not self.decided:
            return "not tested"
        if self.held == len(self.decided):
            return "confirmed"
        return "confirmed in part" if self.held else "not confirmed"

    @property
    def extent(self) -> str:
        """By how much: in how many comparisons, and the median of their values with the range."""
        values = [c.value for c in self.comparisons if isfinite(c.value)]
        if not values:
            return "no two runs to compare"
        low, middle, high = (self.shown(v) for v in (min(values), float(np.median(values)), max(values)))
        spread = f"{middle}, from {low} to {high}" if low != high else middle
        open_ = len(self.comparisons) - len(self.decided)
        return f"{self.held} of {len(self.decided)}{f', {open_} undecided' if open_ else ''}; {self.measure}: {spread}"

    def shown(self, value: float) -> str:
        """A value in the statement's unit."""
        if not isfinite(value):
            return "no value"
        return f"{100 * value:.2g} %" if self.unit == "fraction" else f"{value:.3g}"


def ratio(study: Trials, better: AnyCase, worse: AnyCase, measure: str, subject: str) -> Comparison:
    """How many times more the worse one has; undecided where the difference is within the reference's own."""
    trials = [study.trial(case) for case in (better, worse)]
    low, high = (nan if t is None else getattr(t, measure) for t in trials)
    if not (isfinite(low) and isfinite(high)):
        return Comparison(subject, nan, None)
    floor = max(getattr(study.references[case.problem], measure) for case in (better, worse))
    holds = None if abs(high - low) <= floor else high > low
    return Comparison(subject, high / low if low > 0.0 else nan, holds)


def unseen(study: Trials, one: AnyCase, other: AnyCase, subject: str) -> Comparison:
    """Distance of two curves, which holds where it cannot be seen."""
    apart = distance(study.trial(one), study.trial(other))
    return Comparison(subject, apart, below(apart))


def below(value: float) -> bool | None:
    """Whether nothing of it is seen; None where there is no value."""
    return bool(value < VISIBLE) if isfinite(value) else None


def lines(title: str, left_out: str, found: Sequence[Statement]) -> list[str]:
    """One line a statement, for the terminal; or why there is none."""
    if left_out:
        return [f"{title} of the paper: {left_out}"]
    return [f"{s.verdict:18} {s.text}: {s.extent}" for s in found]


def counted(found: Sequence[Statement]) -> str:
    """How many statements have which verdict, in a sentence without its full stop."""
    verdicts = [s.verdict for s in found]
    kinds = [k for k in ("confirmed", "confirmed in part", "not confirmed", "not tested") if k in verdicts]
    return f"Of {len(found)} statements " + ", ".join(f"{verdicts.count(kind)} {kind}" for kind in kinds)
