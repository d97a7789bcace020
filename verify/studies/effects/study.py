"""The study: a row for each effect, the run with it against that without it."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from pathlib import Path
from typing import ClassVar

from verify.methods.solve import prepare
from verify.studies import frame, pairs
from verify.studies.effects.switches import Plan
from verify.studies.pairs import compared, jobs_of, timed


@dataclass(frozen=True)
class Study(pairs.Study):
    """Results; ``left_out`` has a sentence for each effect that cannot be switched in the scene."""

    NAME: ClassVar[str] = "effects"

    title = "What each effect does"

    def about(self) -> dict[str, object]:
        return {
            "method": self.method,
            "simulated": prepare(self.scene, self.method).effects,
            "effects": {one.key: asdict(one) | {"sentence": one.sentence} for one in self.rows},
        }


def effects(plan: Plan, out: Path, jobs: int, scheduler: str | None = None) -> Study:
    """Run the study into ``out``: effects.csv, effects.json, report.html; see `compared`."""
    found = compared(plan.pairs, out, jobs, scheduler)
    study = Study(plan.base.scene, left_out=plan.left_out, method=plan.base.method, **found)
    study.write(out)
    return study


def would_run(plan: Plan, out: Path) -> list[str]:
    """The runs with their times, a line each, and the effects that are left out; nothing is run."""
    every = jobs_of(plan.pairs)
    return frame.would_run([*every, *timed(every)], plan.left_out, out)
