"""The sweep: every run once, as many at a time as are asked for, and then each alone for its time."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import ClassVar

from verify.methods.solve import prepare, require
from verify.scene.schema import Scene
from verify.studies import frame
from verify.studies.effects.plan import planned
from verify.studies.effects.row import Row, row


@dataclass(frozen=True)
class Study(frame.Study):
    """What was found; ``left_out`` says which effects the scene does not admit."""

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


def effects(
    source: str, scene: Scene, method: str, given: Sequence[str], out: Path, jobs: int, scheduler: str | None = None
) -> Study:
    """Run the study into ``out``: effects.csv, effects.json, report.html.

    Parameters
    ----------
    given : overrides that ``scene`` has, and that every run repeats
    jobs : runs at a time, or those of a dask ``scheduler``; what is timed runs here, alone
    """
    frame.one_thread()
    plan = planned(source, scene, method, given)
    first = frame.run(plan.jobs, out, jobs, scheduler)
    timed = frame.run(plan.timed, out)
    again = {job: [o for o in timed.values() if o.job.overrides == job.overrides] for job in plan.jobs}
    study = Study(scene, tuple(row(pair, first, again) for pair in plan.pairs), plan.left_out, method)
    study.write(out)
    return study


def would_run(source: str, scene: Scene, method: str, given: Sequence[str], out: Path) -> list[str]:
    """The runs with their times, a line each, and what is left out; nothing is run."""
    require(prepare(scene, method))
    plan = planned(source, scene, method, given)
    return frame.would_run([*plan.jobs, *plan.timed], plan.left_out, out)
