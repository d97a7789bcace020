"""The sweep: one run at a time, each in a process or under mpirun, and what they say together."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from functools import cached_property
from math import isfinite
from pathlib import Path

from verify.runs.environment import ALL_PACKAGES, THREADS, machine, versions
from verify.runs.fingerprint import source as source_of
from verify.runs.folder import write_csv, write_json
from verify.runs.jobs import dry_run, run_all
from verify.scene.schema import Scene
from verify.studies.scaling.expect import (
    MANY,
    Expectation,
    Larger,
    Shared,
    expectation,
    larger,
    shared,
    whatever_the_size,
)
from verify.studies.scaling.growth import Fit, fit
from verify.studies.scaling.plan import Plan, planned
from verify.studies.scaling.row import PARTS, Row, row
from verify.support.say import write_page

#: What grows, by the name of the column.
GROWING = ("iteration", *PARTS, "peak_memory_mb", "model_memory_mb")

#: Equal runs whose times differ by more than this were made on a busy machine.
BUSY = 1.2


@dataclass(frozen=True)
class Study:
    """What a sweep found.

    columns : cells along the specimen of the largest DOLFINx mesh
    load : load average of the machine when the study began and when it ended
    """

    scene: Scene
    rows: tuple[Row, ...]
    reasons: tuple[str, ...]
    columns: int
    load: tuple[float, float]

    @property
    def complete(self) -> bool:
        return bool(self.rows) and all(one.measured for one in self.rows)

    @property
    def methods(self) -> list[str]:
        return list(dict.fromkeys(one.method for one in self.ladder()))

    def ladder(self, method: str = "") -> list[Row]:
        """Sizes on one rank, small to large, without the one that tells the memory of the program."""
        ours = (one for one in self.rows if one.measured and one.ranks == 1 and not one.bare)
        return sorted((one for one in ours if method in ("", one.method)), key=lambda one: one.dofs)

    def program_mb(self, method: str) -> float:
        """Memory of a run with next to no mesh: Python, the libraries."""
        bare = [one.peak_memory_mb for one in self.rows if one.bare and one.method == method and one.measured]
        return min(bare, default=0.0)

    @cached_property
    def growth(self) -> Mapping[str, Mapping[str, Fit]]:
        """Power laws by method: of the time of an iteration, of its parts, and of the memory."""
        return {method: {what: self._fit(method, what) for what in GROWING} for method in self.methods}

    def value(self, one: Row, what: str) -> float:
        """A number of a row; "model_memory_mb" is what the mesh adds to the memory of the program."""
        if what == "model_memory_mb":
            return one.peak_memory_mb - self.program_mb(one.method)
        return getattr(one, what)

    def _fit(self, method: str, what: str) -> Fit:
        ladder = self.ladder(method)
        return fit([one.dofs for one in ladder], [self.value(one, what) for one in ladder])

    @cached_property
    def shared(self) -> list[Shared]:
        return shared(self.rows)

    @cached_property
    def waiting(self) -> float:
        """Seconds of an iteration that two ranks need more than one whatever the size; 0 where that cannot be told."""
        known = whatever_the_size(self.rows)
        return max(known[2] - known[1], 0.0) if {1, 2} <= known.keys() else 0.0

    def expected(self) -> list[Expectation]:
        """The largest size on many ranks; nothing where there was one rank alone."""
        ladder = self.ladder("dolfinx")
        tried = [one for one in self.shared if ladder and one.dofs == ladder[-1].dofs]
        if not tried:
            return []
        base, program = ladder[-1], self.program_mb("dolfinx")
        memory = program, base.peak_memory_mb - program
        return [expectation(n, base, tried[-1], self.columns, self.waiting, memory) for n in MANY]

    def larger(self) -> list[Larger]:
        """Sizes for many ranks."""
        if "dolfinx" not in self.growth:
            return []
        fits, base = self.growth["dolfinx"], self.ladder("dolfinx")[-1]
        known = fits["iteration"], fits["model_memory_mb"], self.value(base, "model_memory_mb")
        return [larger(n, base, self.columns, *known) for n in MANY]

    @property
    def sentences(self) -> list[str]:
        """What was found, a sentence each."""
        found = []
        for method, fits in self.growth.items():
            small, large = self.ladder(method)[0], self.ladder(method)[-1]
            time, memory = fits["iteration"], fits["model_memory_mb"]
            found.append(
                f"{method}, degree {large.degree}, {small.dofs} to {large.dofs} unknowns: an iteration takes "
                f"N^{power(time)} ({large.iteration:.2g} s at the end), the memory beyond the program's "
                f"{self.program_mb(method):.0f} MB N^{power(memory)} (peak {large.peak_memory_mb:.0f} MB)"
            )
        for one in self.shared:
            found.append(
                f"dolfinx, {one.dofs} unknowns on {one.ranks} ranks: {one.speed_up['iteration']:.2g} x as fast "
                f"(assembly {one.speed_up['assembly']:.2g} x), efficiency {one.efficiency:.0%}"
            )
        return [*found, *self.busy]

    @property
    def busy(self) -> list[str]:
        """What makes the times doubtful: equal runs that differ, and ranks that were in each other's way."""
        most = max((one.spread for one in self.rows if one.measured), default=1.0)
        found = []
        if most > BUSY:
            found.append(f"Equal runs differ by up to {most:.2g} x: the machine was busy, and the times say the less")
        if any(one.speed_up["iteration"] < 1.0 for one in self.shared):
            found.append(
                "More ranks were slower than one: on cores that other work takes they wait for each other; what is "
                "extrapolated from that has no lower end to speak of"
            )
        return found

    def summary(self) -> dict[str, object]:
        """The content of ``scaling.json``."""
        return {
            "scene": self.scene.model_dump(),
            "growth": {
                method: {
                    what: {"exponent": one.exponent, "standard_error": one.error, "factor": one.factor}
                    for what, one in fits.items()
                }
                for method, fits in self.growth.items()
            },
            "program_memory_mb": {method: self.program_mb(method) for method in self.methods},
            "measured": [asdict(one) for one in self.rows],
            "strong_scaling": [asdict(one) | {"efficiency": one.efficiency} for one in self.shared],
            "extrapolated": {
                "largest_on_many_ranks": [asdict(one) for one in self.expected()],
                "enough_for_many_ranks": [asdict(one) for one in self.larger()],
                "waiting_seconds": self.waiting,
            },
            "sentences": self.sentences,
            "left_out": list(self.reasons),
            "load_average": list(self.load),
            "source": source_of(ALL_PACKAGES),
            "versions": versions(),
            "machine": machine(),
            "threads": 1,
        }


def power(one: Fit) -> str:
    """1.02 +- 0.01: an exponent with its standard error."""
    return f"{one.exponent:.2f} +- {one.error:.2f}" if isfinite(one.exponent) else "?"


def scaling(source: str, scene: Scene, given: Sequence[str], out: Path) -> Study:
    """Run the study into ``out``: scaling.csv, scaling.json, report.html.

    Parameters
    ----------
    given : overrides that ``scene`` has, and that every run repeats
    """
    os.environ.update(dict.fromkeys(THREADS, "1"))
    plan, before = planned(source, scene, given), _load()
    found = {outcome.job: outcome for outcome in run_all(plan.again(), out, jobs=1)}
    rows = tuple(
        row(run, [o for job, o in found.items() if (job.overrides, job.ranks) == (run.overrides, run.ranks)])
        for run in plan.runs
    )
    study = Study(scene, rows, plan.reasons, _columns(plan), (before, _load()))
    write_csv(out / "scaling.csv", Row, study.rows)
    write_json(out / "scaling.json", study.summary())
    write_page("verify.studies.scaling.page", study, out / "report.html")
    stopped = [f"{one.run}: {one.status}" for one in rows if not one.measured]
    print("\n".join([*study.sentences, *study.reasons, *stopped, f"written: {out / 'scaling.csv'}"]))
    return study


def would_run(source: str, scene: Scene, given: Sequence[str], out: Path) -> list[str]:
    """The runs with their times, a line each, and what is left out; nothing is run."""
    plan = planned(source, scene, given)
    return [*dry_run(plan.again(), out, 1), *plan.reasons]


def _columns(plan: Plan) -> int:
    return max((run.solved.dolfinx.elements for run in plan.runs if run.method == "dolfinx"), default=0)


def _load() -> float:
    return os.getloadavg()[0] if hasattr(os, "getloadavg") else 0.0
