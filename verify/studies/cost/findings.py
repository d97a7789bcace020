"""Evaluation of the rows: the cheapest run for every accuracy, ratios, observed orders, growth of the cost."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from math import nan
from operator import attrgetter

from verify.studies.cost.ladder import BASIS_METHODS, BEAM_ORDERS, LADDER
from verify.studies.cost.row import Row
from verify.studies.frame import power

#: Accuracies for which the cheapest runs are found: curve errors by their text.
LEVELS: Mapping[str, float] = {"1%": 0.01, "0.3%": 0.003, "0.1%": 0.001}

#: Methods with an error of their theory, which no mesh reduces: compared, but never the cheapest.
THEORIES = tuple(BEAM_ORDERS)

#: The code of a method with a mesh that is not a basis of `iga`; plug-ins are left out.
CODES = {"dolfinx": "DOLFINx"}

#: Steps that runs are asked for where their number is the same.
ASKED = f"{LADDER.steps} steps"

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
    def ratio(self) -> dict[str, float]:
        """The times of the other methods."""
        return {m: time for m, time in self.times.items() if self.best and m != self.best.method}

    @property
    def codes(self) -> dict[str, float]:
        """The least time of each own code with a mesh, by its name."""
        quickest: dict[str, float] = {}
        for method, time in self.times.items():
            if code := "iga" if method in BASIS_METHODS else CODES.get(method):
                quickest[code] = min(time, quickest.get(code, time))
        return quickest

    def summary(self) -> dict[str, object]:
        if self.best is None:
            return {"method": None, "ratio": {}}
        keys = ("method", "degree", "dofs", "steps", "asked", "curve_error", "seconds", "run")
        return {key: getattr(self.best, key) for key in keys} | {"ratio": self.ratio}


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
        told = []
        for times, when in ((self.best.codes, "each at its best"), (self.equal.codes, f"with {ASKED} asked of both")):
            if len(times) < 2:
                told.append(f"nothing to compare {when}")
                continue
            quicker, slower = sorted(times, key=lambda code: times[code])
            told.append(f"{slower} takes {times[slower]:.2g} × as long as {quicker} {when}")
        return ", ".join(told) if len(self.best.codes) > 1 else ""


def levels(rows: Sequence[Row]) -> tuple[Level, ...]:
    """The cost of every accuracy."""
    equal = of_equal_steps(rows)
    return tuple(Level(name, cheapest(rows, name), cheapest(equal, name)) for name in LEVELS)


def of_equal_steps(rows: Sequence[Row]) -> list[Row]:
    """Rows of the runs that were asked for the same number of steps."""
    return [row for row in rows if row.asked == str(LADDER.steps)]


def pareto(rows: Sequence[Row]) -> list[Row]:
    """The Pareto front of error and time, quickest run first."""
    kept: list[Row] = []
    for row in sorted((row for row in rows if row.measured), key=lambda row: (row.seconds, row.curve_error)):
        if not kept or row.curve_error < kept[-1].curve_error:
            kept.append(row)
    return kept


def by_family(rows: Sequence[Row]) -> dict[str, list[Row]]:
    """Rows of equal steps by method and degree, with rising unknowns."""
    found: dict[str, list[Row]] = {}
    for row in sorted(of_equal_steps(rows), key=lambda row: row.dofs):
        if row.measured and not row.model:
            found.setdefault(row.family, []).append(row)
    return found


def orders(rows: Sequence[Row], floor: float) -> dict[str, float]:
    """Observed order p of curve error ~ unknowns^-p on the finest meshes of every family; NaN for fewer than three.

    Along a thin specimen the number of unknowns is proportional to one over the element length. Errors below ``floor``
    are left out, as they contain the error of the reference.
    """
    found = {}
    for name, ladder in sorted(by_family(rows).items()):
        seen = [row for row in ladder if row.curve_error > floor][-RUNGS_OF_AN_ORDER:]
        found[name] = -slope(seen, lambda row: row.curve_error)
    return found


def growth(rows: Sequence[Row]) -> dict[str, dict[str, float]]:
    """Exponents q of cost ~ unknowns^q by family: time of a Newton iteration, of its parts, and memory."""
    each: dict[str, Callable[[Row], float]] = {
        "iteration": lambda row: row.seconds / row.newton_iterations,
        "assembly": lambda row: row.assembly / row.newton_iterations,
        "factor": lambda row: row.factor / row.newton_iterations,
        "memory": lambda row: row.peak_memory_mb,
    }
    ladders = {name: ladder for name, ladder in sorted(by_family(rows).items()) if len({r.dofs for r in ladder}) >= 3}
    return {name: {what: slope(ladder, value) for what, value in each.items()} for name, ladder in ladders.items()}


def slope(rows: Sequence[Row], value: Callable[[Row], float]) -> float:
    """Exponent of a value over the unknowns; NaN for fewer than three meshes."""
    counted = [row for row in rows if row.dofs and row.newton_iterations]
    return power([row.dofs for row in counted], [value(row) for row in counted])[0]


def table(rows: Sequence[Row]) -> list[str]:
    """The cheapest run of every method for every accuracy, and its ratio to the cheapest of all."""
    lines = []
    for level in levels(rows):
        found, same = level.best, level.equal.times
        lines.append(f"curve error <= {level.name}" + (f": {level.peer}" if level.peer else ""))
        for method, row in found.of_method.items():
            apart = f"{same[method]:6.2f} at equal steps" if method in same else ""
            lines.append(
                f"  {row.family:18} {row.dofs:6d} unknowns {row.steps:4d} steps {row.curve_error:8.3%} "
                f"{row.seconds:8.2f} s {found.times.get(method, nan):6.2f} x {apart}".rstrip()
            )
        missed = sorted({row.method for row in rows} - set(found.of_method))
        lines += [f"  not reached: {', '.join(missed)}"] if missed else []
    return lines
