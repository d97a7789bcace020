"""The search for the cheapest runs of an accuracy: which runs come next, until none can be cheaper.

Every family begins on a coarse mesh, and goes on to finer ones until it reaches the accuracy. From its cheapest run
that does, the search goes to neighbours that take less time, and from runs that miss it by little and are quicker to
neighbours that are more accurate. Then all that may be the cheapest of their method are timed again, in turns.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from math import inf

from verify.methods.names import METHODS
from verify.studies.cost.findings import of_equal_steps
from verify.studies.cost.grid import GRID, Meshes, Try, may_reach
from verify.studies.cost.plan import LEVELS, Plan
from verify.studies.cost.row import Row


def first(grid: Meshes, plan: Plan, start: int = 0) -> list[Try]:
    """The first runs of a family, on its mesh number ``start``."""
    if grid.family.beam:
        return [Try(grid.family, 0.0, steps) for steps in plan.beams]
    return [Try(grid.family, size, plan.steps) for size in grid.sizes[min(start, len(grid.sizes) - 1) :][:1]]


def moves(rows: Mapping[Try, Row], grids: Iterable[Meshes], plan: Plan) -> list[Try]:
    """The runs that are next for any of the aims and may be a method's cheapest; empty where the search is over."""
    found = (one for aim in plan.aims for grid in grids for one in _of_aim(rows, grid, LEVELS[aim], plan))
    return [one for one in dict.fromkeys(found) if one not in rows]


def _of_aim(rows: Mapping[Try, Row], grid: Meshes, error: float, plan: Plan) -> Iterator[Try]:
    ours = [one for one in rows if one.family == grid.family and may_reach(one.steps, error)]
    if grid.family.beam or not ours:
        return
    reach = {one: row.seconds for one, row in rows.items() if row.curve_error <= error and not one.family.beam}
    front = max((one for one in ours if one.steps == plan.steps and not one.model), key=lambda one: one.size)
    for one in ours:
        # at equal steps a mesh is held against others at equal steps, few steps come later
        rivals = [other for other in reach if other.steps == GRID.equal or one.steps != GRID.equal]
        least = min((reach[other] for other in rivals if other.family.method == grid.family.method), default=inf)
        of_all = min((reach[other] for other in rivals), default=inf) if one.family.solver in METHODS else inf
        soonest = rows[one].seconds * max(rows[one].curve_error / error, 1.0) ** plan.pace
        if soonest > min(plan.behind * least, plan.patience * of_all, plan.longest):
            continue
        if one not in reach and one == front:
            yield from grid.other(one, 2) or grid.other(one, 1)
        few = one.steps != GRID.equal
        if one not in reach and rows[one].curve_error <= plan.near * error and least < inf:
            if not few:
                yield from grid.few_steps(one, error)
            elif soonest < least and not one.model:
                yield from (*grid.other(one, 1), *grid.more_steps(one))
        if one in reach and all(reach[one] <= reach[other] for other in rivals if other in ours):
            best, steps = reach[one] == least, grid.few_steps(one, error)
            yield from (*(grid.other(one, -1) if best or few else ()), *steps)
            if best and all(other.steps != GRID.equal for other in reach if other.family.method == one.family.method):
                yield replace(one, steps=GRID.equal, model="")
            if best and plan.models and all(other in rows for other in steps):
                yield from grid.other_models(one)


def turn(rows: Mapping[Try, Row], plan: Plan) -> list[Try]:
    """What may be the cheapest of its method for an aim, at its best and at equal steps, once more; beams, which
    have no mesh to choose, are not.

    All are timed one after the other, so that other load on the machine affects all alike; empty where all have had
    their turns.
    """
    chosen: dict[Try, None] = {}
    for error in map(LEVELS.__getitem__, plan.aims):
        within = {one: row for one, row in rows.items() if row.curve_error <= error and not one.family.beam}
        equal = {one: row for one, row in within.items() if row in of_equal_steps([row])}
        for rivals, close, late in ((within, plan.close, plan.late), (equal, 1.0, 0.0)):
            for one, row in rivals.items():
                least = min(other.seconds for other in rivals.values() if other.method == row.method)
                if row.seconds <= close * least + late:
                    chosen[one] = None
    return [replace(one, repeat=rows[one].times) for one in chosen if rows[one].times <= plan.turns]
