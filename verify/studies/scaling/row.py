"""Measurements of one run and its repetitions."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import isfinite
from typing import Any

import numpy as np

from verify.result import Result
from verify.runs.jobs import Outcome
from verify.studies.frame import failure, unmeasured
from verify.studies.scaling.plan import DEGREES, Run

#: Parts of a Newton iteration; "other" is the rest: step control, energies, writing of rows.
PARTS = ("assembly", "factor", "solve", "other")


@dataclass(frozen=True)
class Row:
    """A line of ``scaling.csv``; the numbers of a run that stopped are NaN.

    iteration : seconds of a Newton iteration: wall time without mesh, basis and compilation, over the number of
        iterations; the least of ``times`` runs, followed by its parts
    spread : largest over least ``iteration`` of equal runs; well above 1 the machine was busy
    set_up : seconds for mesh and basis, without compilation
    peak_memory_mb : that of the first rank
    bare : whether the run measures the memory of the program
    """

    method: str
    degree: int
    ranks: int
    dofs: int
    elements: int
    newton_iterations: int
    iteration: float
    assembly: float
    factor: float
    solve: float
    other: float
    spread: float
    set_up: float
    peak_memory_mb: float
    nonzeros: int
    times: int
    bare: bool
    run: str
    status: str

    @property
    def measured(self) -> bool:
        return isfinite(self.iteration)


def row(run: Run, outcomes: Sequence[Outcome]) -> Row:
    """The row of a run with its repetitions; ``outcomes`` begins with the run."""
    head: dict[str, Any] = {"method": run.method, "degree": DEGREES[run.method], "ranks": run.ranks, "bare": run.bare}
    head["run"] = run.variant
    results = [o.result for o in outcomes if o.result is not None and o.result.complete and o.result.seconds]
    why = failure(outcomes[0])
    if why or not results:
        return unmeasured(Row, head | {"status": why})
    each = [seconds(result) for result in results]
    whole = [sum(parts.values()) for parts in each]
    least = int(np.argmin(whole))
    result = results[least]
    once = result.seconds or {}
    return Row(
        **head,
        **each[least],
        dofs=result.dofs,
        elements=result.elements,
        newton_iterations=iterations(result),
        iteration=whole[least],
        spread=max(whole) / whole[least],
        set_up=once["mesh"] + once["basis"] - result.jit_seconds,
        peak_memory_mb=max(one.peak_memory_mb for one in results),
        nonzeros=result.nonzeros,
        times=len(results),
        status=result.status,
    )


def iterations(result: Result) -> int:
    """Newton iterations of the whole run."""
    return int(np.sum(result.steps["newton_iterations"]))


def seconds(result: Result) -> dict[str, Any]:
    """Seconds of a Newton iteration by its parts."""
    return {name: (result.seconds or {})[name] / max(iterations(result), 1) for name in PARTS}
