"""The price of an accuracy on one scene, from the rows of a ladder: a sentence and its numbers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from verify.methods.names import METHODS
from verify.scene.schema import Scene
from verify.studies.cost.findings import LEVELS, THEORIES, cheapest, of_equal_steps
from verify.studies.cost.ladder import BASIS_METHODS, BEAM_ORDERS
from verify.studies.cost.reference import Reference
from verify.studies.cost.row import Row

#: Levels of accuracy; the price of the first one that is reached is reported.
PRICED = ("0.3%", "1%")

#: Sentence for a ladder that was not finished.
UNFINISHED = "The time allowed for a quick ladder is over; the same command goes on from here."

#: The code whose price is reported in addition to the cheapest one.
OTHER_CODE = "dolfinx"


@dataclass(frozen=True)
class Price:
    """The runs of a ladder and what they cost.

    left_out : a sentence for everything that was not run
    how : overrides of the runs by name
    """

    scene: Scene
    against: Reference
    rows: tuple[Row, ...]
    left_out: tuple[str, ...] = ()
    how: Mapping[str, tuple[str, ...]] = field(default_factory=dict)

    @property
    def level(self) -> str:
        """The first of `PRICED` that a method with a mesh reaches; empty where none does."""
        return next((level for level in PRICED if cheapest(self.rows, level).best is not None), "")

    @property
    def pair(self) -> tuple[Row, ...]:
        """The cheapest run of the level, and that of `OTHER_CODE` (of the next method if `OTHER_CODE` is cheapest)."""
        found = cheapest(self.rows, self.level) if self.level else None
        if found is None or found.best is None:
            return ()
        best = found.best
        others = [row for method, row in found.of_method.items() if method not in (best.method, *THEORIES)]
        wanted = others if best.method == OTHER_CODE else [row for row in others if row.method == OTHER_CODE]
        return (best, *wanted[:1])

    @property
    def equal(self) -> tuple[Row, ...]:
        """The runs of the methods of `pair` at equal steps; empty where one of them is missing."""
        found = cheapest(of_equal_steps(self.rows), self.level).of_method if self.level else {}
        rows = tuple(found[one.method] for one in self.pair if one.method in found)
        return rows if len(rows) == 2 else ()

    @property
    def ratio(self) -> float | None:
        return ratio(self.pair)

    @property
    def ratio_at_equal_steps(self) -> float | None:
        return ratio(self.equal)

    @property
    def sentence(self) -> str:
        """A sentence such as: 0.3 % of the load curve costs 0.11 s with one method and 0.83 s with another."""
        return f"{self._told} {UNFINISHED}" if UNFINISHED in self.left_out else self._told

    @property
    def _told(self) -> str:
        if not self.pair:
            return (
                f"No run of the quick ladder on {self.scene.name} is within {_percent(PRICED[-1])} of its load curve."
            )
        first, *others = self.pair
        text = f"{_percent(self.level)} of the load curve of {self.scene.name} costs {_cost(first, ' unknowns')}"
        if not others:
            return f"{text}; {self._without(first)}.{self._of_beams}"
        text += f" and {_cost(others[0])}, {self.ratio:.2g} × as long"
        if self.ratio_at_equal_steps is not None:
            text += f"; at equal steps {self.ratio_at_equal_steps:.2g} ×"
        return f"{text}.{self._of_beams}"

    @property
    def theories(self) -> tuple[Row, ...]:
        """The quickest run of the beam of each order, of whatever error."""
        found: dict[str, Row] = {}
        for row in sorted((row for row in self.rows if row.measured), key=lambda row: row.seconds):
            if row.method in THEORIES:
                found.setdefault(row.method, row)
        return tuple(found[method] for method in THEORIES if method in found)

    @property
    def _of_beams(self) -> str:
        each = [
            f"of order {BEAM_ORDERS[row.method]} takes {row.seconds:.2g}\u00a0s "
            f"and is {100 * row.curve_error:.2g}\u00a0% off"
            for row in self.theories
        ]
        return f" The beam {', that '.join(each)}." if each else ""

    def _without(self, first: Row) -> str:
        """Why there is no other run to compare the cheapest one with."""
        if first.method == OTHER_CODE:
            return "no other method reached it"
        run = any(row.method == OTHER_CODE for row in self.rows)
        return f"{METHODS[OTHER_CODE].label} {'did not reach it' if run else 'was not run'}"

    def summary(self) -> dict[str, Any]:
        """The entry ``price`` of ``verdict.json``."""
        return {
            "scene": self.scene.name,
            "sentence": self.sentence,
            "curve_error": LEVELS.get(self.level),
            "runs": [self._run(row) for row in self.pair],
            "ratio": self.ratio,
            "at_equal_steps": [self._run(row) for row in self.equal],
            "ratio_at_equal_steps": self.ratio_at_equal_steps,
            "beams": [self._run(row) for row in self.theories],
            "reference": self.against.summary(),
            "left_out": list(self.left_out),
        }

    def _run(self, row: Row) -> dict[str, Any]:
        keys = ("method", "degree", "dofs", "steps", "asked", "newton_iterations", "curve_error", "seconds", "times")
        run = f"{self.scene.name}/{row.run}"
        return {key: getattr(row, key) for key in keys} | {"overrides": list(self.how.get(row.run, ())), "run": run}


def ratio(rows: tuple[Row, ...]) -> float | None:
    """Time of the second run over that of the first; None without two."""
    return rows[1].seconds / rows[0].seconds if len(rows) == 2 else None


def _percent(level: str) -> str:
    return level.replace("%", "\u00a0%")


def _cost(row: Row, unknowns: str = "") -> str:
    label = METHODS[BASIS_METHODS.get(row.method, row.method)].label
    return f"{row.seconds:.2g}\u00a0s with {label} p={row.degree} of {row.dofs}{unknowns}"
