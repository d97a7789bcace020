"""Evaluation of the rows: the cheapest run for every accuracy, ratios, observed orders, growth of the cost."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from math import isfinite, nan
from operator import attrgetter

import numpy as np

from verify.studies.cost.ladder import BASIS_METHODS, BEAM_ORDERS, LADDER
from verify.studies.cost.row import Row

#: Accuracies for which the cheapest runs are found: curve errors by their text.
LEVELS: Mapping[str, float] = {"1%": 0.01, "0.3%": 0.003, "0.1%": 0.001}

#: Methods with an error of their theory, which no mesh reduces: compared, but never the cheapest.
THEORIES = tuple(BEAM_ORDERS)

#: The code of a method with a mesh that is not a basis of `iga`; plug-ins are left out.
CODES = {"dolfinx": "DOLFINx"}

#: Number of finest meshes from which an order is fitted.
RUNGS_OF_AN_ORDER = 4


@dataclass(frozen=True)
class Cheapest:
    """The cheapest run for an accuracy, over all methods with a mesh and for each method.

    ratio : time of each other method's cheapest run over that of the best; only methods that reach the accuracy
    """

    level: str
    best: Row | None
    of_method: Mapping[str, Row]

    @property
    def codes(self) -> dict[str, float]:
        """Time of the quickest run of each own code with a mesh over that of the quickest of all, by its name."""
        quickest: dict[str, float] = {}
        for method, row in self.of_method.items():
            code = "iga" if method in BASIS_METHODS else CODES.get(method)
            if code:
                quickest[code] = min(row.seconds, quickest.get(code, row.seconds))
        return {code: each / self.best.seconds for code, each in quickest.items()} if self.best else {}

    @property
    def ratio(self) -> dict[str, float]:
        if self.best is None:
            return {}
        return {m: row.seconds / self.best.seconds for m, row in self.of_method.items() if m != self.best.method}

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
    of_method: dict[str, Row] = {}
    for row in enough:
        of_method.setdefault(row.method, row)
    return Cheapest(level, next((row for row in enough if row.method not in THEORIES), None), of_method)


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
    families = {name: ladder for name, ladder in sorted(by_family(rows).items()) if _sizes(ladder) >= 3}
    return {name: {what: slope(ladder, value) for what, value in each.items()} for name, ladder in families.items()}


def slope(rows: Sequence[Row], value: Callable[[Row], float]) -> float:
    """Least-squares exponent of a value over the unknowns; NaN for fewer than three meshes."""
    points = [(row.dofs, value(row)) for row in rows if row.dofs and row.newton_iterations and value(row) > 0.0]
    if _sizes(rows) < 3 or len(points) < 3:
        return nan
    dofs, values = np.log(np.array(points)).T
    return float(np.polyfit(dofs, values, 1)[0])


def _sizes(rows: Sequence[Row]) -> int:
    """Number of different meshes."""
    return len({row.dofs for row in rows if row.dofs})


def peer(best: Cheapest, equal: Cheapest) -> str:
    """Comparison of the two codes for an accuracy, each at its best and both with the same number of steps.

    Empty where not both codes reach the accuracy.
    """
    told = []
    for found, when in ((best, "each at its best"), (equal, f"with {LADDER.steps} steps asked of both")):
        times = found.codes
        if len(times) < 2:
            told.append(f"nothing to compare {when}")
            continue
        slower, quicker = max(times, key=lambda code: times[code]), min(times, key=lambda code: times[code])
        told.append(f"{slower} takes {times[slower]:.2g} × as long as {quicker} {when}")
    return ", ".join(told) if len(best.codes) > 1 else ""


def table(rows: Sequence[Row]) -> list[str]:
    """The cheapest run of every method for every accuracy, and its ratio to the cheapest of all."""
    lines = []
    for level in LEVELS:
        found, equal = cheapest(rows, level), cheapest(of_equal_steps(rows), level)
        lines.append(f"curve error <= {level}" + (f": {said}" if (said := peer(found, equal)) else ""))
        for method, row in found.of_method.items():
            ratio = row.seconds / found.best.seconds if found.best else nan
            same = equal.of_method.get(method)
            same_ratio = same.seconds / equal.best.seconds if same and equal.best else nan
            apart = f"{same_ratio:6.2f} at equal steps" if isfinite(same_ratio) else ""
            lines.append(
                f"  {row.family:18} {row.dofs:6d} unknowns {row.steps:4d} steps {row.curve_error:8.3%} "
                f"{row.seconds:8.2f} s {ratio:6.2f} x {apart}".rstrip()
            )
        missed = sorted({row.method for row in rows} - set(found.of_method))
        lines += [f"  not reached: {', '.join(missed)}"] if missed else []
    return lines
