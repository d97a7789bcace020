"""The study: a row for each variant, held against the first one; and how time and memory grow with the unknowns."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from math import nan
from pathlib import Path
from typing import ClassVar

import numpy as np

from verify.methods.solve import prepare
from verify.studies import frame, pairs
from verify.studies.pairs import Row, compared, jobs_of, timed
from verify.studies.vary.plan import Plan

#: The largest over the least number of unknowns from which on their growth is stated.
GROWN = 4.0


@dataclass(frozen=True)
class Study(pairs.Study):
    """Results; the first row is that of the variant which the others are held against."""

    NAME: ClassVar[str] = "vary"

    @property
    def title(self) -> str:
        return f"What {self.rows[0].key} changes"

    @property
    def sentences(self) -> list[str]:
        first, *others = self.rows
        head = f"{first.name}: {first.steps} steps, {first.seconds:.2g} s" if first.complete else first.sentence
        return [head, *(one.sentence for one in others), *growth(self.rows)]

    def about(self) -> dict[str, object]:
        return {"method": self.method, "sentences": self.sentences, "rows": [asdict(one) for one in self.rows]}


def growth(rows: Sequence[Row]) -> list[str]:
    """Power law of the time of an iteration, and memory for each thousand unknowns, where meshes differ enough."""
    rows = sorted((one for one in rows if one.complete and one.dofs), key=lambda one: one.dofs)
    if len(rows) < 3 or rows[-1].dofs < GROWN * rows[0].dofs:
        return []
    exponent, error = power([one.dofs for one in rows], [one.iteration for one in rows])
    first, last = rows[0], rows[-1]
    memory = (last.peak_memory_mb - first.peak_memory_mb) / (last.dofs - first.dofs)
    time = f"an iteration takes N^{exponent:.2f} +- {error:.2f}, {last.iteration:.2g} s at the end"
    return [f"{first.dofs} to {last.dofs} unknowns: {time}; memory grows by {1000 * memory:.2g} MB for every thousand"]


def power(n: Sequence[float], value: Sequence[float]) -> tuple[float, float]:
    """Exponent of ``value = c n^exponent`` by least squares on logarithms, and its standard error; NaN for less than
    three positive points."""
    x, y = np.asarray(n, float), np.asarray(value, float)
    there = (x > 0.0) & (y > 0.0) & np.isfinite(y)
    if np.unique(x[there]).size < 3:
        return nan, nan
    (slope, _), covariance = np.polyfit(np.log(x[there]), np.log(y[there]), 1, cov="unscaled")
    fitted = np.polyval(np.polyfit(np.log(x[there]), np.log(y[there]), 1), np.log(x[there]))
    scatter = float(np.sum((np.log(y[there]) - fitted) ** 2)) / (int(there.sum()) - 2)
    return float(slope), float((covariance[0, 0] * scatter) ** 0.5)


def vary(plan: Plan, out: Path, jobs: int, scheduler: str | None = None) -> Study:
    """Run the study into ``out``: vary.csv, vary.json, report.html; see `compared`."""
    first = plan.pairs[0].other
    study = Study(
        first.solved,
        left_out=(*plan.left_out, *chosen_otherwise(plan)),
        method=first.method,
        **compared(plan.pairs, out, jobs, scheduler),
    )
    study.write(out)
    return study


def chosen_otherwise(plan: Plan) -> list[str]:
    """A sentence for each variant for which "auto" chooses other effects than for the first one, and keys do not."""
    first, *others = ((pair.name, prepare(pair.one.solved, pair.one.method)) for pair in plan.pairs)
    found = []
    for name, prepared in others:
        for one in prepared.decisions:
            before = first[1].effects.get(one.key)
            if one.value != before:
                found.append(f"{name}: effects.{one.key} is {one.value} by itself, and {before} for {first[0]}")
    return found


def would_run(plan: Plan, out: Path) -> list[str]:
    """The runs with their times, a line each, and what is left out; nothing is run."""
    every = jobs_of(plan.pairs)
    return frame.would_run([*every, *timed(every)], plan.left_out, out)
