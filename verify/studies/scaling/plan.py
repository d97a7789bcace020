"""Runs of the study: sequences of sizes on one rank, and some of these sizes on several ranks."""

from __future__ import annotations

import shutil
from bisect import bisect_left
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from verify.methods.solve import prepare
from verify.runs.fingerprint import digest
from verify.runs.jobs import Job, left_out
from verify.runs.sweep import Task
from verify.scene import toml
from verify.scene.parse import parse_scene
from verify.scene.schema import MOST_ALONG, Scene
from verify.studies.scaling.ranks import MPIRUN_MISSING, cores

#: Degree of every method's elements.
DEGREES = {"nurbs": 3, "dolfinx": 2}


@dataclass(frozen=True)
class Sizes:
    """Sizes of the runs.

    smallest, largest, rungs : smallest and largest number of unknowns, and how many sizes
    bare : unknowns of a mesh that is so small that the memory is that of the program
    way, steps : part of the largest opening that is run, and steps; a few iterations are enough for their mean time
    ranks, shared : numbers of MPI ranks as far as there are cores, and indices of the sizes that are run on them; two
        sizes separate the fixed time of an iteration from the part that grows with the size
    times : number of repetitions, of which the least time counts
    """

    smallest: int = 2_000
    largest: int = 100_000
    rungs: int = 6
    bare: int = 200
    way: float = 0.005
    steps: int = 2
    ranks: tuple[int, ...] = (1, 2, 4, 8, 16)
    shared: tuple[int, ...] = (-3, -1)
    times: int = 2


SIZES = Sizes()


@dataclass(frozen=True)
class Run(Job):
    """A run of the study on a number of ranks; ``bare`` marks the small one that measures the memory of the program."""

    ranks: int = 1
    bare: bool = False

    def task(self) -> Task:
        """The run as a task of a sweep, under mpirun for more than one rank."""
        alone = super().task()
        if self.ranks == 1:
            return alone
        program = ("verify.studies.scaling.ranks", str(self.ranks), *alone.program[1:])
        return replace(alone, key=digest(alone.key, program), program=program)


def planned(source: str, scene: Scene, given: Sequence[str] = ()) -> tuple[list[Run], tuple[str, ...]]:
    """Every run once, with the overrides ``given``, and a sentence for each run that is left out."""
    runs: list[Run] = []
    reasons: list[str] = []
    for method in DEGREES:
        ladder = [_run(source, scene, method, size, given) for size in sizes()]
        bare = replace(_run(source, scene, method, SIZES.bare, given), bare=True)
        possible = [run for run in (bare, *ladder) if not left_out(run)]
        if not any(run in possible for run in ladder):
            reasons.append(f"{method}: {left_out(ladder[-1])}")
            continue
        runs += possible
        if method == "dolfinx":
            more, why = _shared([run for run in possible if not run.bare])
            runs += more
            reasons += why
    return runs, tuple(reasons)


def sizes() -> list[int]:
    """Target numbers of unknowns, evenly spaced on a logarithmic scale."""
    return [int(n) for n in np.rint(np.geomspace(SIZES.smallest, SIZES.largest, SIZES.rungs))]


def _run(source: str, scene: Scene, method: str, size: int, given: Sequence[str]) -> Run:
    """One size on one rank, with the effects of the whole programme; ``auto`` might choose others for a short one."""
    effects = (f"effects.{key}={toml.value(value)}" for key, value in prepare(scene, method).effects.items())
    mesh = (
        (f"dolfinx.degree={DEGREES[method]}", f"dolfinx.elements={elements(scene, size)}")
        if method == "dolfinx"
        else (
            f"discretization.degree={DEGREES[method]}",
            f"discretization.dofs={size}",
            "discretization.adaptive=false",
        )
    )
    opening = SIZES.way * max(scene.load.opening, key=abs)
    paced = (f"load.opening={opening!r}", f"discretization.steps={SIZES.steps}", "published=[]")
    return Run(source, scene, method, f"scaling/{method}-{size}", (*given, *paced, *effects, *mesh), fields=False)


def elements(scene: Scene, size: int) -> int:
    """DOLFINx elements along the specimen for about ``size`` unknowns."""
    return max(bisect_left(range(MOST_ALONG), size, lo=2, key=lambda n: _unknowns(scene, n)), 2)


def _unknowns(scene: Scene, n: int) -> int:
    mesh = [f"dolfinx.elements={n}", f"dolfinx.degree={DEGREES['dolfinx']}", "effects.symmetry=false"]
    specimen, p = prepare(parse_scene(scene.model_dump(), mesh), "dolfinx").problem.specimen(), DEGREES["dolfinx"]
    along = [int(np.sum(specimen.X < body.length + specimen.near)) - 1 for body in specimen.bodies]
    across = [body.Y.size - 1 for body in specimen.bodies]
    return sum(2 * (p * n + 1) * (p * m + 1) for n, m in zip(along, across, strict=True))


def _shared(ladder: Sequence[Run]) -> tuple[list[Run], list[str]]:
    """The selected sizes on several ranks, as far as there are cores, and sentences for what is left out."""
    if shutil.which("mpirun") is None:
        return [], [f"more than 1 rank: left out: {MPIRUN_MISSING}"]
    rungs = dict.fromkeys(ladder[at] for at in SIZES.shared if len(ladder) >= -at)
    there = [n for n in SIZES.ranks if 1 < n <= cores()]
    beyond = [str(n) for n in SIZES.ranks if n > cores()]
    runs = [replace(run, ranks=n, variant=f"{run.variant}-{n}-ranks") for run in rungs for n in there]
    plural = "core" if cores() == 1 else "cores"
    return runs, [f"{', '.join(beyond)} ranks: left out: {cores()} {plural} here"] if beyond else []
