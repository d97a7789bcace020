"""The study: one run at a time, each in its own process or under mpirun, and the results of all runs."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from functools import cached_property
from pathlib import Path
from typing import ClassVar

from verify.scene.schema import Scene
from verify.studies import frame
from verify.studies.frame import BUSY, one_thread, repeated
from verify.studies.scaling.growth import Fit, Shared, fit, shared
from verify.studies.scaling.plan import SIZES, planned
from verify.studies.scaling.row import PARTS, Row, row

#: Columns whose growth with the unknowns is fitted.
FITTED_COLUMNS = ("iteration", *PARTS, "peak_memory_mb", "model_memory_mb")


@dataclass(frozen=True)
class Study(frame.Study):
    """Results; ``load``: load average of the machine at the begin and at the end of the study."""

    NAME: ClassVar[str] = "scaling"
    ROW: ClassVar[type] = Row

    load: tuple[float, float]

    @property
    def complete(self) -> bool:
        return bool(self.rows) and all(one.measured for one in self.rows)

    @property
    def methods(self) -> list[str]:
        return list(dict.fromkeys(one.method for one in self.ladder()))

    def ladder(self, method: str = "") -> list[Row]:
        """Rows on one rank by size, without the one that measures the memory of the program."""
        ours = (one for one in self.rows if one.measured and one.ranks == 1 and not one.bare)
        return sorted((one for one in ours if method in ("", one.method)), key=lambda one: one.dofs)

    def program_mb(self, method: str) -> float:
        """Memory of a run with a tiny mesh: Python and the libraries."""
        bare = [one.peak_memory_mb for one in self.rows if one.bare and one.method == method and one.measured]
        return min(bare, default=0.0)

    @cached_property
    def growth(self) -> Mapping[str, Mapping[str, Fit]]:
        """Power laws by method: time of an iteration, its parts, and memory."""
        return {method: {what: self._fit(method, what) for what in FITTED_COLUMNS} for method in self.methods}

    def value(self, one: Row, what: str) -> float:
        """A number of a row; "model_memory_mb" is the memory beyond that of the program."""
        if what == "model_memory_mb":
            return one.peak_memory_mb - self.program_mb(one.method)
        return getattr(one, what)

    def _fit(self, method: str, what: str) -> Fit:
        ladder = self.ladder(method)
        return fit([one.dofs for one in ladder], [self.value(one, what) for one in ladder])

    @cached_property
    def shared(self) -> list[Shared]:
        return shared(self.rows)

    @property
    def sentences(self) -> list[str]:
        """The results in sentences."""
        found = []
        for method, fits in self.growth.items():
            small, large = self.ladder(method)[0], self.ladder(method)[-1]
            time, memory = fits["iteration"], fits["model_memory_mb"]
            found.append(
                f"{method}, degree {large.degree}, {small.dofs} to {large.dofs} unknowns: an iteration takes "
                f"N^{time} ({large.iteration:.2g} s at the end), the memory beyond the program's "
                f"{self.program_mb(method):.0f} MB N^{memory} (peak {large.peak_memory_mb:.0f} MB)"
            )
        for one in self.shared:
            found.append(
                f"dolfinx, {one.dofs} unknowns on {one.ranks} ranks: {one.speed_up['iteration']:.2g} x as fast "
                f"(assembly {one.speed_up['assembly']:.2g} x), efficiency {one.efficiency:.0%}"
            )
        return [*found, *self.busy]

    @property
    def busy(self) -> list[str]:
        """Signs of a busy machine: equal runs with different times, and several ranks that are slower than one."""
        most = max((one.spread for one in self.rows if one.measured), default=1.0)
        found = []
        if most > BUSY:
            found.append(f"Equal runs differ by up to {most:.2g} x: the machine was busy, and the times say the less")
        if any(one.speed_up["iteration"] < 1.0 for one in self.shared):
            found.append("More ranks were slower than one: on cores that other work takes they wait for each other")
        return found

    def lines(self) -> list[str]:
        stopped = [f"{one.run}: {one.status}" for one in self.rows if not one.measured]
        return [*self.sentences, *self.left_out, *stopped]

    def about(self) -> dict[str, object]:
        return {
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
            "sentences": self.sentences,
            "load_average": list(self.load),
        }


def scaling(source: str, scene: Scene, given: Sequence[str], out: Path) -> Study:
    """Run the study into ``out``: scaling.csv, scaling.json, report.html.

    Parameters
    ----------
    given : overrides that ``scene`` contains and every run repeats
    """
    one_thread()
    (runs, left_out), before = planned(source, scene, given), _load()
    found = frame.run(repeated(runs, range(SIZES.times)), out)
    rows = tuple(
        row(run, [o for job, o in found.items() if (job.overrides, job.ranks) == (run.overrides, run.ranks)])
        for run in runs
    )
    doubts = frame.doubts(outcome for job, outcome in found.items() if not job.repeat)
    study = Study(scene, rows, left_out, (before, _load()), unresolved=doubts)
    study.write(out)
    return study


def would_run(source: str, scene: Scene, given: Sequence[str], out: Path) -> list[str]:
    """One line per run with its expected time, and what is left out; nothing is run."""
    runs, left_out = planned(source, scene, given)
    return frame.would_run(repeated(runs, range(SIZES.times)), left_out, out)


def _load() -> float:
    return os.getloadavg()[0] if hasattr(os, "getloadavg") else 0.0
