"""The study: every run once, several at a time, and then repetitions one at a time for their wall times."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from pathlib import Path
from typing import ClassVar

from verify.methods.solve import prepare
from verify.studies import frame
from verify.studies.effects.plan import Plan
from verify.studies.effects.row import Row, row


@dataclass(frozen=True)
class Study(frame.Study):
    """Results; ``left_out`` has a sentence for each effect that cannot be switched in the scene."""

    NAME: ClassVar[str] = "effects"
    ROW: ClassVar[type] = Row
    PACKAGES: ClassVar[tuple[str, ...]] = ("iga", "fem_reference")

    method: str

    @property
    def complete(self) -> bool:
        return all(one.complete for one in self.rows)

    def about(self) -> dict[str, object]:
        return {
            "method": self.method,
            "simulated": prepare(self.scene, self.method).effects,
            "effects": {one.key: asdict(one) | {"sentence": one.sentence} for one in self.rows},
        }

    def lines(self) -> list[str]:
        return [*(one.sentence for one in self.rows), *self.left_out]


def effects(plan: Plan, out: Path, jobs: int, scheduler: str | None = None) -> Study:
    """Run the study into ``out``: effects.csv, effects.json, report.html.

    Parameters
    ----------
    jobs : runs at a time, or with a dask ``scheduler`` its workers; timed runs are done here, one at a time
    """
    frame.one_thread()
    first = frame.run(plan.jobs, out, jobs, scheduler)
    timed = frame.run(frame.worth(plan.timed, first), out)
    again = {job: [o for o in timed.values() if o.job.overrides == job.overrides] for job in plan.jobs}
    rows = tuple(row(pair, first, again) for pair in plan.pairs)
    doubts = frame.doubts(first.values())
    study = Study(plan.base.scene, rows, plan.left_out, plan.base.method, unresolved=doubts)
    study.write(out)
    return study


def would_run(plan: Plan, out: Path) -> list[str]:
    """The runs with their times, a line each, and the effects that are left out; nothing is run."""
    return frame.would_run([*plan.jobs, *plan.timed], plan.left_out, out)
