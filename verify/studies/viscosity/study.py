"""The study: every run once, several at a time, and then repetitions one at a time for their wall times."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from pathlib import Path
from typing import ClassVar

from verify.studies import frame
from verify.studies.viscosity.plan import Plan
from verify.studies.viscosity.row import Row, cheapest, rows


@dataclass(frozen=True)
class Study(frame.Study):
    """Results; the first row has no viscosity."""

    NAME: ClassVar[str] = "viscosity"
    ROW: ClassVar[type] = Row
    PACKAGES: ClassVar[tuple[str, ...]] = ("iga", "fem_reference")

    method: str

    @property
    def complete(self) -> bool:
        return all(one.complete for one in self.rows)

    @property
    def sentence(self) -> str:
        return cheapest(self.rows)

    def about(self) -> dict[str, object]:
        return {"method": self.method, "sentence": self.sentence, "rows": [asdict(one) for one in self.rows]}

    def lines(self) -> list[str]:
        return [*(one.sentence for one in self.rows), self.sentence, *self.left_out]


def viscosity(plan: Plan, out: Path, jobs: int, scheduler: str | None = None) -> Study:
    """Run the study into ``out``: viscosity.csv, viscosity.json, report.html.

    Parameters
    ----------
    jobs : runs at a time, or with a dask ``scheduler`` its workers; timed runs are done here, one at a time
    """
    frame.one_thread()
    first = frame.run(plan.jobs, out, jobs, scheduler)
    timed = frame.run(frame.worth(plan.timed, first), out)
    again = {job: [o for o in timed.values() if o.job.overrides == job.overrides] for job in plan.jobs}
    doubts = frame.doubts(first.values())
    study = Study(plan.exact.scene, rows(plan.jobs, first, again), (), plan.exact.method, unresolved=doubts)
    study.write(out)
    return study


def would_run(plan: Plan, out: Path) -> list[str]:
    """The runs with their times, a line each; nothing is run."""
    return frame.would_run([*plan.jobs, *plan.timed], (), out)
