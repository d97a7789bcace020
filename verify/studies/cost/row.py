"""One run of the study, measured."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import isfinite, nan
from pathlib import Path
from typing import Any

import numpy as np

from verify.curves.curve import oscillation
from verify.curves.of_run import cubics, dissipated, distance, peak_load
from verify.result import Result, Snapshot, run_seconds
from verify.runs.jobs import Outcome
from verify.studies.cost.ladder import BEAM_FAMILY, FAMILIES, Try
from verify.studies.cost.reference import Reference
from verify.studies.frame import unmeasured
from verify.support.checked_files import NUMBER, Damaged, Shape, read_table
from verify.support.timing import PHASES

#: What is read of ``cost.json`` again.
ABOUT: Shape = {
    "reference": {
        **{"label": str, "dofs": int, "uncertainty": {"curve": NUMBER}},
        **{"other_code": str, "other_code_apart": NUMBER},
    }
}


@dataclass(frozen=True)
class Row:
    """A line of ``cost.csv``. What cannot be measured, as of a run that stopped, is NaN.

    curve_error : the smaller one of ``chords`` and ``cubics``: relative L2 distance of the load to the reference, with
        straight lines or with the cubics of the exact slopes between the converged points
    peak_error, energy_error : of the largest load and of the energy dissipated at the end, relative
    oscillation : RMS of load / reference - 1 on the propagation branch, mean removed
    traction_error : RMS over the process zone of the traction halfway, over the strength; zones brought together
    seconds : wall time without imports and without ``jit_seconds``, the least of ``times`` runs; with its phases
    asked : steps asked for; ``steps`` are those taken
    """

    method: str
    degree: int
    dofs: int
    curve_error: float
    peak_error: float
    oscillation: float
    seconds: float
    energy_error: float
    traction_error: float
    chords: float
    cubics: float
    jit_seconds: float
    mesh: float
    basis: float
    assembly: float
    factor: float
    solve: float
    other: float
    peak_memory_mb: float
    elements: int
    nonzeros: int
    steps: int
    asked: str
    newton_iterations: int
    rejected_steps: int
    times: int
    run: str
    status: str

    @property
    def family(self) -> str:
        return f"{self.method}-p{self.degree}" if self.degree else self.method

    @property
    def measured(self) -> bool:
        return isfinite(self.curve_error) and isfinite(self.seconds)


def row(one: Try, outcomes: Sequence[Outcome], against: Reference, nonzeros: int = 0) -> Row:
    """Measure a run and its repetitions, the first of them first; the errors are those of the first."""
    results = [outcome.result for outcome in outcomes if outcome.result is not None]
    family = one.family
    head: dict[str, Any] = {
        "method": family.method,
        "degree": family.degree,
        "asked": str(one.steps),
        "run": one.variant,
    }
    if not results or not results[0].complete:
        return unmeasured(Row, head | {"status": results[0].status if results else outcomes[0].left_out})
    result = results[0]
    quickest = min(results, key=run_seconds)
    phases: dict[str, Any] = {name: (quickest.seconds or {})[name] for name in (*PHASES, "other")}
    phases["basis"] -= quickest.jit_seconds
    steps = result.steps
    return Row(
        **head,
        **errors(result, against),
        **phases,
        dofs=result.dofs,
        seconds=run_seconds(quickest),
        jit_seconds=quickest.jit_seconds,
        peak_memory_mb=max(one.peak_memory_mb for one in results),
        elements=result.elements,
        nonzeros=result.nonzeros or nonzeros,
        steps=max(result.load.size - 1, 0),
        newton_iterations=int(np.sum(steps["newton_iterations"])),
        rejected_steps=result.rejected_steps,
        times=len(results),
        status=result.status,
    )


def errors(result: Result, against: Reference) -> dict[str, Any]:
    """All distances of a complete run to the reference."""
    exact = against.result
    known = cubics(exact)
    chords, smooth = (distance(curve, exact) for curve in ((result.opening, result.load), cubics(result)))
    return {
        "curve_error": min(chords, smooth),
        "chords": chords,
        "cubics": smooth,
        "peak_error": abs(peak_load(result) / peak_load(exact) - 1.0),
        "energy_error": abs(dissipated(result) / dissipated(exact) - 1.0),
        "oscillation": oscillation((result.opening, result.load), known)["rms"],
        "traction_error": traction_error(result.snapshots, exact.snapshots),
    }


def traction_error(snapshots: Sequence[Snapshot], exact: Sequence[Snapshot]) -> float:
    """RMS of the difference of the tractions over the process zone of the last snapshot but one, over the largest one.

    A run passes the opening of a snapshot at one of its steps: zones are laid over each other where half of the
    material is damaged.
    """
    if len(snapshots) < 2 or len(exact) < 2:
        return nan
    mine, known = snapshots[-2], exact[-2]
    a, b = _middle(mine), _middle(known)
    zone = (known.damage_q > 0.0) & (known.damage_q < 1.0)
    if not (isfinite(a) and isfinite(b) and zone.any()):
        return nan
    found = np.interp(known.s_q[zone] - b, mine.s_q - a, mine.traction_q)
    return float(np.sqrt(np.mean((found - known.traction_q[zone]) ** 2)) / np.max(known.traction_q))


def read_csv(path: Path) -> list[Row]:
    """Rows that were written.

    Raises
    ------
    Damaged : they are not as they were written, or of a method that is not known.
    """
    rows = read_table(path, Row)
    known = {(family.method, family.degree) for family in (*FAMILIES, BEAM_FAMILY)}
    if strange := [row for row in rows if (row.method, row.degree) not in known]:
        raise Damaged(path, f"the method {strange[0].method[:30]!r} of degree {strange[0].degree}")
    return rows


def _middle(snapshot: Snapshot) -> float:
    """Where the damage comes down to one half, going away from the load; NaN where it never is more."""
    more = np.flatnonzero(snapshot.damage_q > 0.5)
    if more.size == 0 or more[-1] + 1 == snapshot.s_q.size:
        return nan
    i = more[-1]
    (d0, d1), (s0, s1) = snapshot.damage_q[i : i + 2], snapshot.s_q[i : i + 2]
    return float(s0 + (d0 - 0.5) / (d0 - d1) * (s1 - s0))
