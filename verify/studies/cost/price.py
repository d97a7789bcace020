"""The price of an accuracy on one scene, from the rows of a ladder: a sentence and its numbers."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from verify.methods.names import METHODS
from verify.scene.schema import Scene
from verify.studies.cost.findings import LEVELS, THEORIES, Cheapest, cheapest, of_equal_steps
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

    def _cheapest(self, rows: Sequence[Row]) -> Cheapest:
        return cheapest(rows, self.level) if self.level else Cheapest(None, {})

    @property
    def pair(self) -> tuple[Row, ...]:
        """The cheapest run of the level, and that of `OTHER_CODE` (of the next method if `OTHER_CODE` is cheapest)."""
        found = self._cheapest(self.rows)
        if found.best is None:
            return ()
        others = [row for method, row in found.of_method.items() if method not in (found.best.method, *THEORIES)]
        wanted = others if found.best.method == OTHER_CODE else [row for row in others if row.method == OTHER_CODE]
        return (found.best, *wanted[:1])

    @property
    def equal(self) -> tuple[Row, ...]:
        """The runs of the methods of `pair` at equal steps; empty where one of them is missing."""
        found = self._cheapest(of_equal_steps(self.rows)).of_method
        rows = tuple(found[one.method] for one in self.pair if one.method in found)
        return rows if len(rows) == 2 else ()

    @property
    def theories(self) -> tuple[Row, ...]:
        """The quickest run of the beam of each order, of whatever error."""
        of_order = [[row for row in self.rows if row.method == method and row.measured] for method in THEORIES]
        return tuple(min(rows, key=lambda row: row.seconds) for rows in of_order if rows)

    @property
    def sentence(self) -> str:
        """A sentence such as: 0.3 % of the load curve costs 0.11 s with one method and 0.83 s with another."""
        unfinished = f" {UNFINISHED}" if UNFINISHED in self.left_out else ""
        if not self.pair:
            most = _percent(PRICED[-1])
            return f"No run of the quick ladder on {self.scene.name} is within {most} of its load curve.{unfinished}"
        first, *others = self.pair
        text = f"{_percent(self.level)} of the load curve of {self.scene.name} costs {_cost(first)} unknowns"
        if others:
            text += f" and {_cost(others[0])}, {ratio(self.pair):.2g} × as long"
            text += f"; at equal steps {ratio(self.equal):.2g} ×" if self.equal else ""
        else:
            text += f"; {self._without(first)}"
        beams = ", that ".join(
            f"of order {BEAM_ORDERS[row.method]} takes {row.seconds:.2g}\u00a0s and is "
            f"{100 * row.curve_error:.2g}\u00a0% off"
            for row in self.theories
        )
        return f"{text}.{f' The beam {beams}.' if beams else ''}{unfinished}"

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
            "ratio": ratio(self.pair),
            "at_equal_steps": [self._run(row) for row in self.equal],
            "ratio_at_equal_steps": ratio(self.equal),
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


def _cost(row: Row) -> str:
    label = METHODS[BASIS_METHODS.get(row.method, row.method)].label
    return f"{row.seconds:.2g}\u00a0s with {label} p={row.degree} of {row.dofs}"
