"""Which runs may still be the cheapest of their method for an accuracy; others are not tried or repeated."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

from verify.studies.cost.findings import LEVELS, cheapest, of_equal_steps
from verify.studies.cost.ladder import Try
from verify.studies.cost.row import Row


@dataclass(frozen=True)
class Contenders:
    """Meshes on which few steps are tried; larger values try more runs and cost time.

    near : their error with equal steps is at most ``near`` times an accuracy; errors of mesh and steps may cancel
    behind : their time with equal steps is at most ``behind`` times that of the method's cheapest
    meshes : only the coarsest ``meshes`` of each family are tried, since no finer one is cheaper
    """

    near: float = 1.2
    behind: float = 2.0
    meshes: int = 2


CONTENDERS = Contenders()


def few_steps(rows: Mapping[Try, Row]) -> list[Try]:
    """Runs with few steps on the meshes that may be the cheapest of their method for an accuracy."""
    equal = of_equal_steps(list(rows.values()))
    chosen: set[Try] = set()
    for level, error in LEVELS.items():
        near = {one: row for one, row in rows.items() if row in equal and row.curve_error <= CONTENDERS.near * error}
        for one, found in near.items():
            quickest = min(row.seconds for row in near.values() if row.method == found.method)
            coarser = [other for other in near if other.family == one.family and other.size < one.size]
            if len(coarser) < CONTENDERS.meshes and found.seconds <= CONTENDERS.behind * quickest:
                chosen.update(one.with_few_steps(level))
    return sorted(chosen, key=lambda one: one.variant)


def best(rows: Mapping[Try, Row], within: float = 1.0, once: float = 1.0, late: float = 0.0) -> list[Try]:
    """The cheapest runs of every method for every level, and those whose time is nearly the same.

    Nearly: at most the factor ``within``, or ``once`` for runs that were timed once, plus ``late`` seconds.
    """
    chosen = []
    for level, error in LEVELS.items():
        for method, cheap in cheapest(list(rows.values()), level).of_method.items():
            for one, found in rows.items():
                most = (once if found.times == 1 else within) * cheap.seconds + late
                if found.method == method and found.curve_error <= error and found.seconds <= most:
                    chosen.append(one)
    return list(dict.fromkeys(chosen))


def other_steps(rows: Mapping[Try, Row]) -> list[Try]:
    """The meshes of the cheapest runs with other numbers of steps."""
    return [other for one in best(rows) for other in one.with_other_steps()]


def other_models(rows: Mapping[Try, Row]) -> list[Try]:
    """Other models on the meshes of the cheapest runs, and more points on the next coarser ones; steps are kept."""
    chosen: list[Try] = []
    for one in best(rows):
        chosen += one.with_other_models()
        below = _coarser(rows, one)
        if below is not None and one.family.solver == "dolfinx":
            chosen.append(replace(one, rung=below.rung, size=below.size, model="more-points"))
    return list(dict.fromkeys(chosen))


def between(rows: Mapping[Try, Row]) -> list[Try]:
    """Meshes between the last that misses a level and the first that reaches it, for every method's best family."""
    chosen = []
    for error in LEVELS.values():
        for one in best(rows):
            below = _coarser(rows, one)
            if below is not None and rows[one].curve_error <= error < rows[below].curve_error:
                chosen.append(Try(one.family, one.rung, round((one.size * below.size) ** 0.5), one.steps))
    return list(dict.fromkeys(chosen))


def _coarser(rows: Mapping[Try, Row], one: Try) -> Try | None:
    """A run of the same family on the next coarser mesh."""
    coarser = [other for other in rows if other.family == one.family and other.size < one.size]
    return max(coarser, key=lambda other: other.size, default=None)
