"""The quick ladder of a verification: the study with few meshes of few families, whose steps follow the accuracy."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from time import monotonic

from verify.runs.jobs import Job, Outcome
from verify.scene.schema import Scene
from verify.studies import frame
from verify.studies.cost.findings import LEVELS
from verify.studies.cost.ladder import BEAM_FAMILIES, LADDER, OF_SCENE, Family, Ladder, Try, ladders
from verify.studies.cost.price import PRICED, UNFINISHED, Price
from verify.studies.cost.reference import Meshes, reference_jobs
from verify.studies.cost.row import Row
from verify.studies.cost.study import Runner, begun, climb, without_number
from verify.support.say import say


@dataclass(frozen=True)
class Quick:
    """Plan of the quick ladder.

    families : each with the elements in the process zone of its coarsest mesh, so that four meshes lead from an error
        of 2 to 0.05 % on ``dcb-czm1``; of every method the degree that reaches 0.3 % first there. Higher degrees of
        DOLFINx would be compiled first
    ladder : meshes and steps. A distance of 0.02 from the tangent leaves an error of 0.1 to 0.2 % between the steps, so
        that few runs miss 0.3 % by their steps; the best meshes of the two methods that are compared are tried with
        fewer, and with equal ones. Beams are those that the verification has run
    meshes : of the reference, 0.02 % off on ``dcb-czm1``, where its uncertainty is 0.02 %
    climb, vary, repeat : seconds after which no run of the ladder, with other steps, or for repetition is begun
    times : how often the runs of the price are timed. One of DOLFINx takes 3 s with its start: more do not fit
    """

    families: tuple[Family, ...] = (
        Family("nurbs", "nurbs", 2, 2.25),
        Family("tspline", "tspline", 3, 2.4),
        Family("lagrange", "lagrange", 2, 1.96),
        Family("dolfinx", "dolfinx", 2, 1.4),
        *BEAM_FAMILIES,
    )
    ladder: Ladder = Ladder(rungs=4, steps="auto-0.02", other_steps=("auto-0.05", LADDER.steps), beams=(OF_SCENE,))
    meshes: Meshes = Meshes(zone=(3.0, 5.0, 8.0), other_zone=(), steps="auto-0.002")
    climb: float = 28.0
    vary: float = 35.0
    repeat: float = 40.0
    times: int = 2


QUICK = Quick()


def references(source: str, scene: Scene) -> tuple[Job, ...]:
    """The runs of the reference of a quick ladder, coarse to fine; they are not timed, and may be done with others."""
    return reference_jobs(source, scene, (), QUICK.meshes)[0]


def quick(source: str, scene: Scene, out: Path, jobs: int, other: Sequence[Outcome] = ()) -> Price | None:
    """Run the quick ladder on a scene into ``out``; None, with a message, where nothing can be measured.

    Parameters
    ----------
    jobs : runs of the reference at a time; timed runs are done one at a time
    other : runs of the other code on two meshes, coarse to fine, which the reference is held against
    """
    rungs, reasons = ladders(source, scene, (), QUICK.families, QUICK.ladder)
    if not rungs:
        say(f"no quick ladder on {scene.name}: {'; '.join(reasons)}")
        return None
    start = monotonic()
    if (runner := begun(source, scene, (), out, jobs, QUICK.meshes, other)) is None:
        return None
    runner = replace(runner, start=start)
    if not _measured(runner, rungs):
        reasons.append(UNFINISHED)
    price = _price(runner, reasons)
    print(price.sentence, file=sys.stderr, flush=True)
    return price


def _measured(runner: Runner, rungs: dict[Family, list[Try]]) -> bool:
    """Do the runs: the ladder, other steps on the best meshes, repetitions. Returns whether there was time for all."""
    if not climb(rungs, partial(runner, seconds=QUICK.climb), lambda: runner.rows, LEVELS[PRICED[0]]):
        return False
    for n in range(1, QUICK.times):
        if not (runner(_other_steps(runner), QUICK.vary) and runner(_repeated(runner, n), QUICK.repeat)):
            return False
    return runner(_other_steps(runner), QUICK.repeat)  # a repetition may have changed who is the cheapest


def _other_steps(runner: Runner) -> list[Try]:
    """The meshes of the price with other steps."""
    chosen = _told(runner, _price(runner).pair)
    return [other for one in chosen for other in one.with_other_steps(QUICK.ladder.other_steps)]


def _repeated(runner: Runner, n: int) -> list[Try]:
    """The runs of the price and those at equal steps once more."""
    price = _price(runner)
    return [replace(one, repeat=n) for one in _told(runner, (*price.pair, *price.equal))]


def _told(runner: Runner, rows: Sequence[Row]) -> list[Try]:
    """The runs of some rows."""
    names = {row.run for row in rows}
    return [one for one in runner.rows if one.variant in names]


def _price(runner: Runner, reasons: Sequence[str] = ()) -> Price:
    rows = tuple(runner.rows.values())
    return Price(runner.scene, runner.against, rows, (*reasons, *without_number(rows)), runner.how)


def would_run(source: str, scene: Scene, out: Path) -> list[str]:
    """One line per run of the ladder, with its expected time; nothing is run."""
    rungs, reasons = ladders(source, scene, (), QUICK.families, QUICK.ladder)
    plan = [one.job(source, scene) for ones in rungs.values() for one in ones]
    return frame.would_run(plan, reasons, out)
