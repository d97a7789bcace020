"""The study: a reference, then the runs that the search asks for, until none can be cheaper.

Every family begins on a coarse mesh, and goes on to finer ones until it reaches the accuracy. From its cheapest run
that does, the search goes to neighbours that take less time, and from runs that miss it by little and are quicker to
neighbours that are more accurate. Then all that may be the cheapest of their method are timed again, in turns.
"""

from __future__ import annotations

import sys
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from math import inf, log
from pathlib import Path
from time import monotonic
from typing import ClassVar

from verify.methods.names import METHODS
from verify.methods.zone_resolution import expected
from verify.runs.jobs import Outcome, run_all
from verify.scene.schema import Scene
from verify.studies import frame
from verify.studies.cost.findings import Level, levels, of_equal_steps, orders, pareto, ways
from verify.studies.cost.grid import BASIS_METHODS, GRID, Meshes, Try, may_reach, meshes
from verify.studies.cost.plan import LEVELS, WHOLE_STUDY, Plan
from verify.studies.cost.reference import Reference, reference, reference_jobs
from verify.studies.cost.row import Row, errors, row
from verify.support.say import say


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
            for one, run in rivals.items():
                least = min(other.seconds for other in rivals.values() if other.method == run.method)
                if run.seconds <= close * least + late:
                    chosen[one] = None
    return [replace(one, repeat=rows[one].times) for one in chosen if rows[one].times <= plan.turns]


#: A sentence of a search that was not finished.
UNFINISHED = "The time allowed for the search is over; the same command goes on from here."


@dataclass(frozen=True)
class Study(frame.Study):
    """Results; ``against``: the reference; ``how``: overrides of the runs by name."""

    NAME: ClassVar[str] = "cost"
    ROW: ClassVar[type] = Row

    against: Reference
    how: Mapping[str, tuple[str, ...]] = field(default_factory=dict)

    @property
    def complete(self) -> bool:
        """Whether every run that was made gives a number, those of the other code for the reference included."""
        return not self.against.faults and not without_number(self.rows)

    def lines(self) -> list[str]:
        return [self.against.sentence, *self.left_out, *(level.said for level in levels(self.rows)), self.ways]

    def about(self) -> dict[str, object]:
        found = levels(self.rows)
        return {
            "reference": self.against.summary(),
            "cheapest": {level.name: level.best.summary() for level in found},
            "cheapest_at_equal_steps": {level.name: level.equal.summary() for level in found},
            "pareto": [self._told(one) for one in pareto(self.rows)],
            "orders": orders(self.rows, 2.0 * self.against.uncertainty["curve"]),
        }

    @property
    def ways(self) -> str:
        """The cheapest way to every accuracy, in one line."""
        return ways(f"{self.scene.name} ({self.scene.specimen.kind})", self.rows)

    @property
    def priced(self) -> Level:
        """The accuracy whose price is told: 0.3 %, or 1 % where no method with a mesh reaches that."""
        coarse, fine, _ = levels(self.rows)
        return fine if fine.best.best else coarse

    @property
    def sentence(self) -> str:
        """The price in words."""
        return " ".join([self.priced.said, *(text for text in self.left_out if text == UNFINISHED)])

    def price(self) -> dict[str, object]:
        """The entry ``price`` of ``verdict.json``: the cheapest run of each code, at its best and at equal steps."""
        level = self.priced
        best, equal = ([*found.codes.values()] for found in (level.best, level.equal))
        return {
            "scene": self.scene.name,
            "sentence": self.sentence,
            "ways": self.ways,
            "curve_error": LEVELS[level.name] if best else None,
            "runs": [self._told(row) for row in best],
            "ratio": level.best.peer,
            "at_equal_steps": [self._told(row) for row in equal],
            "ratio_at_equal_steps": level.equal.peer,
            "reference": self.against.summary(),
            "left_out": list(self.left_out),
        }

    def _told(self, one: Row) -> dict[str, object]:
        """A run with the overrides that repeat it."""
        keys = ("method", "degree", "dofs", "steps", "asked", "curve_error", "seconds", "times", "run")
        how = {"solver": BASIS_METHODS.get(one.method, one.method), "overrides": list(self.how.get(one.run, ()))}
        return {key: getattr(one, key) for key in keys} | how


def searched(
    source: str,
    scene: Scene,
    given: Sequence[str],
    out: Path,
    jobs: int,
    plan: Plan = WHOLE_STUDY,
    verified: Sequence[Outcome] = (),
    other: Sequence[Outcome] = (),
) -> Study | None:
    """The runs of a search, each measured; None, with a message, without a converged reference.

    Parameters
    ----------
    given : overrides that ``scene`` contains and every run repeats
    jobs : runs of the reference at a time, and of a plan that tries ``together`` those that are timed again; all others
        are done one at a time
    verified : runs on the scene from whose meshes and errors the search begins
    other : runs of the other code on two meshes, coarse to fine, which the reference is held against, too
    """
    frame.one_thread()
    own, others = reference_jobs(source, scene, given, plan)
    of_reference = frame.run([*own, *others], out, jobs)
    begin = monotonic()
    against = reference([of_reference[job] for job in own], [*(of_reference[job] for job in others), *other])
    if against is None:
        why = frame.failures(of_reference[job] for job in own)
        say(f"no converged reference of {scene.name}, so that nothing can be measured: {why[0]}")
        return None
    print(against.sentence, file=sys.stderr, flush=True)
    grids, reasons = _grids(scene, plan)
    made: dict[Try, list[Outcome]] = {}  # of a run all its repetitions
    rows: dict[Try, Row] = {}
    tried: set[Try] = set()
    plans = [one for grid in grids for one in first(grid, plan, _start(grid, verified, against, plan))]
    at_once = of_tries = jobs if plan.together else 1
    while plans and UNFINISHED not in reasons:
        tries = {one.job(source, scene, given): one for one in plans}
        for outcome in run_all(list(tries), out, at_once):
            tried.add(tries[outcome.job])
            one = replace(tries[outcome.job], repeat=0)
            made.setdefault(one, []).append(outcome)
            rows[one] = row(one, made[one], against)
            if monotonic() - begin > plan.seconds:
                break
        onward = moves(rows, grids, plan)
        at_once = of_tries if onward else 1
        plans = [one for one in onward or turn(rows, plan) if one not in tried]
        if plans and monotonic() - begin > plan.seconds:
            reasons.append(UNFINISHED)
    ordered = sorted(rows.values(), key=lambda one: (one.method, one.degree, one.dofs, one.run))
    kept = tuple(one for one in ordered if not one.status.startswith("not run"))
    impossible = {one.method: one.status for one in ordered if one.method not in {row.method for row in kept}}
    reasons += [f"{method}: {why}" for method, why in impossible.items()]
    doubts = frame.doubts([*of_reference.values(), *(outcomes[0] for outcomes in made.values())])
    how = {one.variant: one.job(source, scene).overrides for one in rows}
    return Study(scene, kept, (*reasons, *without_number(kept)), against, how, unresolved=doubts)


def _grids(scene: Scene, plan: Plan) -> tuple[list[Meshes], list[str]]:
    """The meshes of every family, and a sentence for every method that has none."""
    grids: list[Meshes] = []
    reasons: dict[str, None] = {}
    for family in plan.of_families():
        grid = meshes(scene, family)
        if family.adaptive and not scene.specimen.symmetric:
            reasons[f"{family.method}: left out: only the mesh of a dcb follows the process zone"] = None
        elif not grid.sizes:
            reasons[f"{family.method}: not run: no mesh is possible"] = None
        else:
            grids.append(grid)
    return grids, [*reasons]


def _start(grid: Meshes, verified: Sequence[Outcome], against: Reference, plan: Plan) -> int:
    """The mesh that a family begins with: the coarsest, or two before the one that has the largest error that is aimed
    at, by the error of a run of the method and the order 2 of a cohesive front."""
    family = grid.family
    known = [one for one in verified if one.job.method == family.solver and not frame.failure(one)]
    if family.beam or not known or known[0].result is None:
        return 0
    off = errors(known[0].result, against)["curve_error"] / max(LEVELS[aim] for aim in plan.aims)
    elements = expected(known[0].job.solved, family.solver).elements * off**0.5
    return max(int(2.0 * log(max(elements / family.first, 1.0)) / log(GRID.ratio)) - 2, 0)


def cost(
    source: str, scene: Scene, given: Sequence[str], out: Path, jobs: int, plan: Plan = WHOLE_STUDY
) -> Study | None:
    """Run the study into ``out``: cost.csv, cost.json, report.html; None without a converged reference.

    ``scene`` contains the overrides ``given``, which every run repeats.
    """
    if (study := searched(source, scene, given, out, jobs, plan)) is not None:
        study.write(out)
    return study


def without_number(rows: Iterable[Row]) -> tuple[str, ...]:
    """A sentence for every method some of whose runs give no number, with the first of them."""
    found: dict[str, list[Row]] = {}
    for one in [one for one in rows if not one.measured]:
        found.setdefault(one.method, []).append(one)
    return tuple(
        f"{ones[0].run}: {ones[0].status}" + f"; {len(ones) - 1} more runs of {method} give no number" * (len(ones) > 1)
        for method, ones in found.items()
    )


def would_run(
    source: str, scene: Scene, given: Sequence[str], out: Path, jobs: int, plan: Plan = WHOLE_STUDY
) -> list[str]:
    """One line per run that may be made on the way to finer meshes, with its expected time; nothing is run."""
    grids, reasons = _grids(scene, plan)
    own, others = reference_jobs(source, scene, given, plan)
    tries = (one for grid in grids for at in range(0, len(grid.sizes), 2) for one in first(grid, plan, at))
    note = (
        "families end where none of their runs can be cheaper; neighbours of the cheapest are tried, and timed in turns"
    )
    planned = [*own, *others, *(one.job(source, scene, given) for one in tries)]
    return frame.would_run(planned, [note, *reasons], out, jobs)
