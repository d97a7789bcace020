"""Evaluation of the rows: the cheapest run for every accuracy, ratios, observed orders."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import nan
from operator import attrgetter

from verify.methods.names import METHODS
from verify.methods.peers import known
from verify.methods.plugins import plugins
from verify.studies.cost.grid import BASIS_METHODS, BEAM_FAMILIES, BEAM_ORDERS, FAMILIES, GRID
from verify.studies.cost.plan import LEVELS
from verify.studies.cost.row import Row
from verify.studies.frame import power

#: Methods with an error of their theory, which no mesh reduces: compared, but never the cheapest.
THEORIES = tuple(BEAM_ORDERS)

#: The code of a method with a mesh that is not a basis of `iga`; plug-ins are left out.
CODES = {"dolfinx": "DOLFINx"}

#: Codes of others.
OTHERS = tuple(name for name in (*plugins(), *known()) if name not in METHODS)

#: Method of a row: (name, colour of the palette).
SHOWN: Mapping[str, tuple[str, str]] = (
    {
        one.method: (METHODS[one.solver].label + ", adaptive" * one.adaptive, "accent" if one.adaptive else one.solver)
        for one in FAMILIES
    }
    | {
        one.method: (f"{METHODS[one.solver].label}, order {BEAM_ORDERS[one.method]}", one.solver)
        for one in BEAM_FAMILIES
    }
    | {name: (name, f"other-{i % 5 + 1}") for i, name in enumerate(OTHERS)}
)

#: Methods of a table that are of this project.
OWN_CODES = (*BASIS_METHODS, *CODES, *THEORIES)

#: Number of finest meshes from which an order is fitted.
RUNGS_OF_AN_ORDER = 4


@dataclass(frozen=True)
class Cheapest:
    """The cheapest run for an accuracy, over all methods with a mesh and for each method."""

    best: Row | None
    of_method: Mapping[str, Row]

    @property
    def times(self) -> dict[str, float]:
        """Time of each method that reaches the accuracy over that of the best; empty where none with a mesh does."""
        return {m: row.seconds / self.best.seconds for m, row in self.of_method.items()} if self.best else {}

    @property
    def codes(self) -> dict[str, Row]:
        """The quickest run of each own code with a mesh, by its name, the quickest first."""
        of_code: dict[str, Row] = {}
        for method, row in self.of_method.items():
            if code := "iga" if method in BASIS_METHODS else CODES.get(method):
                of_code.setdefault(code, row)
        return of_code

    @property
    def peer(self) -> float:
        """Time of the slower code over that of the quicker one; NaN where one of them does not reach the accuracy."""
        rows = [*self.codes.values()]
        return rows[-1].seconds / rows[0].seconds if len(rows) > 1 else nan

    @property
    def others(self) -> str:
        """The quickest code of others against the best of ours, in words; empty where one of them has no run."""
        ours, theirs = [*self.codes.values()], [row for m, row in self.of_method.items() if m not in OWN_CODES]
        if not (ours and theirs):
            return ""
        ratio = theirs[0].seconds / ours[0].seconds
        return f"{costs(theirs[0])} unknowns is the quickest of other codes: {ratio:.2g} × as long as ours"

    def summary(self) -> dict[str, object]:
        if self.best is None:
            return {"method": None, "ratio": {}}
        keys = ("method", "degree", "dofs", "steps", "asked", "curve_error", "seconds", "run")
        ratio = {method: time for method, time in self.times.items() if method != self.best.method}
        return {key: getattr(self.best, key) for key in keys} | {"ratio": ratio}


def cheapest(rows: Sequence[Row], level: str) -> Cheapest:
    """Cheapest runs whose curve error is at most that of a level."""
    enough = sorted(
        (row for row in rows if row.measured and row.curve_error <= LEVELS[level]), key=attrgetter("seconds")
    )
    of_method = {row.method: row for row in reversed(enough)}  # the quickest of each is put in last
    best = next((row for row in enough if row.method not in THEORIES), None)
    return Cheapest(best, {row.method: of_method[row.method] for row in enough})


@dataclass(frozen=True)
class Level:
    """The cost of an accuracy: with each method's best number of steps, and with equal steps."""

    name: str
    best: Cheapest
    equal: Cheapest

    @property
    def peer(self) -> str:
        """Comparison of the two codes, each at its best and both with the same number of steps.

        Empty where not both codes reach the accuracy.
        """
        if len(self.best.codes) < 2:
            return ""
        told = []
        for found, when in ((self.best, "each at its best"), (self.equal, f"with {GRID.equal} steps asked of both")):
            names = [*found.codes]
            ratio = f"{names[-1]} takes {found.peer:.2g} × as long as {names[0]}" if len(names) > 1 else ""
            told.append(f"{ratio or 'nothing to compare'} {when}")
        return ", ".join(told)

    @property
    def said(self) -> str:
        """The cost in words."""
        row = self.best.best
        if row is None:
            return f"Curve error {self.name}: no run is that accurate."
        beaten = ", ".join(f"{SHOWN[m][0]} {t:.2g} ×" for m, t in self.best.times.items() if m != row.method)
        others = f" Times of the others: {beaten}." if beaten else ""
        took = f"{costs(row)} unknowns, {row.steps} steps"
        told = "".join(f" {text}." for text in (self.peer, self.best.others) if text)
        return f"Curve error {self.name}: {took}.{others}{told}"


def levels(rows: Sequence[Row]) -> tuple[Level, ...]:
    """The cost of every accuracy."""
    equal = of_equal_steps(rows)
    return tuple(Level(name, cheapest(rows, name), cheapest(equal, name)) for name in LEVELS)


def of_equal_steps(rows: Sequence[Row]) -> list[Row]:
    """Rows of the runs that were asked for the same number of steps."""
    return [row for row in rows if row.asked == str(GRID.equal)]


def pareto(rows: Sequence[Row]) -> list[Row]:
    """The Pareto front of error and time, quickest run first."""
    kept: list[Row] = []
    for row in sorted((row for row in rows if row.measured), key=lambda row: (row.seconds, row.curve_error)):
        if not kept or row.curve_error < kept[-1].curve_error:
            kept.append(row)
    return kept


def orders(rows: Sequence[Row], floor: float) -> dict[str, float]:
    """Observed order p of curve error ~ unknowns^-p on the finest meshes of every family; NaN for fewer than three.

    Along a thin specimen the number of unknowns is proportional to one over the element length. Errors below ``floor``
    are left out, as they contain the error of the reference.
    """
    ladders: dict[str, list[Row]] = {}
    for row in sorted(of_equal_steps(rows), key=lambda row: row.dofs):
        if row.measured and not row.model:
            ladders.setdefault(row.family, []).append(row)
    found = {}
    for name, ladder in sorted(ladders.items()):
        seen = [row for row in ladder if row.curve_error > floor][-RUNGS_OF_AN_ORDER:]
        found[name] = -power([row.dofs for row in seen], [row.curve_error for row in seen])[0]
    return found


def ways(scene: str, rows: Sequence[Row]) -> str:
    """The cheapest way to every accuracy on a scene, in one line."""
    found = {level.replace("%", "\u00a0%"): cheapest(rows, level).best for level in LEVELS}
    told = (level + (f" in {costs(row)} unknowns" if row else " no run is near enough") for level, row in found.items())
    return f"The cheapest way on {scene} to {', to '.join(told)}."


def costs(row: Row) -> str:
    """Time, method and unknowns of a run with a mesh."""
    return f"{row.seconds:.2g}\u00a0s with {named(row)} of {row.dofs}"


def named(row: Row) -> str:
    """A name such as "T-spline, degree 3"."""
    name = SHOWN[row.method][0]
    return f"{name}, degree {row.degree}" if row.degree else name
