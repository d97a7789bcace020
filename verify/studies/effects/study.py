"""The sweep: every run once, as many at a time as are asked for, and then each alone for its time."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

from verify.methods.solve import prepare, require
from verify.runs.environment import THREADS, machine, versions
from verify.runs.fingerprint import source as source_of
from verify.runs.folder import write_csv, write_json
from verify.runs.jobs import dry_run, run_all
from verify.scene.schema import Scene
from verify.studies.effects.plan import planned
from verify.studies.effects.row import Row, row, table
from verify.support.say import write_page


@dataclass(frozen=True)
class Study:
    """What a sweep found; ``reasons`` say which effects the scene does not admit."""

    scene: Scene
    method: str
    rows: tuple[Row, ...]
    reasons: tuple[str, ...]

    @property
    def complete(self) -> bool:
        return all(one.complete for one in self.rows)

    def summary(self) -> dict[str, object]:
        """The content of ``effects.json``."""
        return {
            "scene": self.scene.model_dump(),
            "method": self.method,
            "simulated": prepare(self.scene, self.method).effects,
            "effects": {one.key: asdict(one) | {"sentence": one.sentence} for one in self.rows},
            "left_out": list(self.reasons),
            "source": source_of(("iga", "fem_reference")),
            "versions": versions(),
            "machine": machine(),
            "threads": 1,
        }


def effects(
    source: str, scene: Scene, method: str, given: Sequence[str], out: Path, jobs: int, scheduler: str | None = None
) -> Study:
    """Run the study into ``out``: effects.csv, effects.json, report.html.

    Parameters
    ----------
    given : overrides that ``scene`` has, and that every run repeats
    jobs : runs at a time, or those of a dask ``scheduler``; what is timed runs here, alone
    """
    os.environ.update(dict.fromkeys(THREADS, "1"))
    plan = planned(source, scene, method, given)
    first = {outcome.job: outcome for outcome in run_all(plan.jobs, out, jobs, scheduler)}
    timed = {outcome.job: outcome for outcome in run_all(list(plan.repeats()), out, jobs=1)}
    again = {job: [o for o in timed.values() if o.job.overrides == job.overrides] for job in plan.jobs}
    study = Study(scene, method, tuple(row(pair, first, again) for pair in plan.pairs), plan.reasons)
    write_csv(out / "effects.csv", Row, study.rows)
    write_json(out / "effects.json", study.summary())
    write_page("verify.studies.effects.page", study, out / "report.html")
    print("\n".join([*table(study.rows, study.reasons), f"written: {out / 'effects.csv'}"]))
    return study


def would_run(source: str, scene: Scene, method: str, given: Sequence[str], out: Path) -> list[str]:
    """The runs with their times, a line each, and what is left out; nothing is run."""
    require(prepare(scene, method))
    plan = planned(source, scene, method, given)
    return [*dry_run([*plan.jobs, *plan.repeats()], out, 1), *plan.reasons]
