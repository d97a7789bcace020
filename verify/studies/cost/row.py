"""Measurements of one run of the study."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import isfinite, nan
from pathlib import Path
from typing import Any

import numpy as np

from verify.curves.curve import oscillation
from verify.curves.of_run import cubics, dissipated, distance, peak_load
from verify.methods.peers import known
from verify.methods.plugins import plugins
from verify.result import Result, Snapshot, run_seconds
from verify.runs.jobs import Outcome
from verify.studies.cost.grid import BEAM_FAMILIES, FAMILIES, Try
from verify.studies.cost.reference import Reference
from verify.studies.frame import failure, unmeasured
from verify.support.checked_files import Damaged
from verify.support.timing import PHASES


@dataclass(frozen=True)
class Row:
    """A line of ``cost.csv``; the numbers of a run that stopped are NaN.

    curve_error : relative L2 distance of the load to the reference: the smaller one of ``chords``, with straight lines
        between the steps, and ``cubics``, with cubics by the exact slopes
    peak_error, energy_error : relative errors of the peak load and of the energy dissipated at the end
    oscillation : RMS of load / reference - 1 on the propagation branch, mean removed
    traction_error : RMS error of the tractions in the process zone halfway, over the strength; zones shifted together
    seconds : wall time without imports and ``jit_seconds`` (compiling, or the start of another program), the least of
        ``times`` runs; followed by its phases. The
        first of several is not among them: the others were made in turns with those that they are compared with, and
        the ratio of times of different moments is that of the machine
    nonzeros : entries of the tangent, 0 where a method does not tell them
    asked : requested steps; ``steps`` is the number of steps taken
    model : a key of `verify.studies.cost.ladder.OTHER_MODELS`, or empty
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
    model: str = ""

    @property
    def family(self) -> str:
        return f"{self.method}-p{self.degree}" if self.degree else self.method

    @property
    def measured(self) -> bool:
        return isfinite(self.curve_error) and isfinite(self.seconds)


def row(one: Try, outcomes: Sequence[Outcome], against: Reference) -> Row:
    """The row of a run with its repetitions; the errors are those of the first run."""
    results = [outcome.result for outcome in outcomes if outcome.result is not None]
    about: dict[str, Any] = {"method": one.family.method, "degree": one.family.degree}
    about |= {"asked": str(one.steps), "run": one.variant, "model": one.model}
    if (why := failure(outcomes[0])) or not results:
        return unmeasured(Row, about | {"status": why})
    result, quickest = results[0], min(results[1:] or results, key=run_seconds)
    phases: dict[str, Any] = {name: (quickest.seconds or {})[name] for name in (*PHASES, "other")}
    # a plug-in knows no phases: its start is part of the solution
    phases["basis" if phases["basis"] else "solve"] -= quickest.jit_seconds
    return Row(
        **about,
        **errors(result, against),
        **phases,
        dofs=result.dofs,
        seconds=run_seconds(quickest),
        jit_seconds=quickest.jit_seconds,
        peak_memory_mb=max(one.peak_memory_mb for one in results),
        elements=result.elements,
        nonzeros=result.nonzeros,
        steps=max(result.load.size - 1, 0),
        newton_iterations=int(np.sum(result.steps.get("newton_iterations", 0))),
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
        "energy_error": abs(dissipated(result) / dissipated(exact) - 1.0)
        if "dissipated_energy" in result.steps
        else nan,
        "oscillation": oscillation((result.opening, result.load), known)["rms"],
        "traction_error": traction_error(result.snapshots, exact.snapshots),
    }


def traction_error(snapshots: Sequence[Snapshot], exact: Sequence[Snapshot]) -> float:
    """RMS difference of the tractions over the process zone in the last snapshot but one, over the largest traction.

    Snapshots are taken at slightly different openings; the zones are shifted so that the points with half of the damage
    coincide.
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


def refuse_unknown(rows: Sequence[Row], path: Path) -> None:
    """Raise Damaged where the file has a row of an unknown method or degree."""
    ours = {(family.method, family.degree) for family in (*FAMILIES, *BEAM_FAMILIES)}
    others = {*plugins(), *known()}
    if strange := [row for row in rows if (row.method, row.degree) not in ours and row.method not in others]:
        raise Damaged(path, f"the method {strange[0].method[:30]!r} of degree {strange[0].degree}")


def _middle(snapshot: Snapshot) -> float:
    """Position of the damage 0.5, seen from the loaded end; NaN where the damage is smaller everywhere."""
    more = np.flatnonzero(snapshot.damage_q > 0.5)
    if more.size == 0 or more[-1] + 1 == snapshot.s_q.size:
        return nan
    i = more[-1]
    (d0, d1), (s0, s1) = snapshot.damage_q[i : i + 2], snapshot.s_q[i : i + 2]
    return float(s0 + (d0 - 0.5) / (d0 - d1) * (s1 - s0))
