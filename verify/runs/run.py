"""One run into one folder."""

from __future__ import annotations

import os
import sys
import traceback
from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any, NoReturn

import numpy as np

from verify.checks import matched, neglected
from verify.checks.identities import run_checks
from verify.fields.frames import Frames, cleared
from verify.fields.moments import LEAD, Moments
from verify.methods import zone_resolution
from verify.methods.solve import solve
from verify.result import CURVE_COLUMNS, Result, steps_from_rows
from verify.runs.environment import machine, mpi_rank, mpi_size, threads, versions
from verify.runs.folder import NO_ROOM, CurveWriter, write_fields, write_json
from verify.runs.memory import keep_freed_memory
from verify.runs.store import alone_in
from verify.scene.effects import decided, simulated
from verify.scene.schema import Scene
from verify.support.say import say
from verify.support.timing import PHASES, peak_memory_mb
from verify.verdict import Check, of_state

Solver = Callable[[Scene, str, Callable[[Mapping[str, float]], None] | None], Result]
Row = Mapping[str, float]


def run(
    scene: Scene,
    method: str,
    folder: Path,
    keep_fields: bool = False,
    on_step: Callable[[Row], None] | None = None,
    solver: Solver = solve,
    frames: int = 0,
) -> tuple[Result, tuple[Check, ...]]:
    """Solve a scene by one method and write its folder.

    Whatever ends the run, the files are valid: rows are written as they come, and ``result.json`` says in ``status``
    why a run stopped. An interrupt by the user is recorded and passed on; so is a disk that takes no more.

    Parameters
    ----------
    folder : made where absent; an earlier run in it is replaced
    on_step : called after every converged step, for progress
    solver : what to run; ``verify.methods.solve.solve``
    frames : so many for ParaView on the way along the programme, see ``verify.fields.frames``

    Raises
    ------
    Refusal : another run is at work in the folder.
    OSError : the folder takes no more; what is in it is valid.
    """
    keep_freed_memory()
    if frames:
        solver = partial(_filmed, solver, Frames(folder, scene, method, frames, writes=mpi_rank() == 0))
    elif keep_fields and method == LEAD and solver is solve:
        solver = _with_moments
    if mpi_rank() > 0:  # the same numbers are on every rank: one of them writes
        return _silent(scene, method, solver), ()
    folder.mkdir(parents=True, exist_ok=True)
    with alone_in(folder):
        return _recorded(scene, method, folder, keep_fields, on_step, solver)


def _recorded(
    scene: Scene, method: str, folder: Path, keep_fields: bool, on_step: Callable[[Row], None] | None, solver: Solver
) -> tuple[Result, tuple[Check, ...]]:
    cleared(folder)
    writer = CurveWriter(folder)
    rows: list[Row] = []

    def record(row: Row) -> None:
        rows.append(dict(row))
        writer(row)
        if on_step is not None:
            on_step(row)

    try:
        result = _explained(scene, solver(scene, method, record))
    except KeyboardInterrupt:
        _finish(folder, scene, _stopped(method, rows, "interrupted"), keep_fields)
        raise
    except Exception as error:
        if isinstance(error, OSError) and error.errno in NO_ROOM:
            if mpi_size() > 1:
                _take_down_all_ranks(str(error))
            raise
        (folder / "error.log").write_text(traceback.format_exc())
        whose = getattr(error, "whose", "the program: please report it with error.log")
        why = f"{type(error).__name__}: {error} (an error in {whose})"
        result = _stopped(method, rows, why)
        if mpi_size() > 1:
            _finish(folder, scene, result, keep_fields)
            _take_down_all_ranks(why)
    finally:
        writer.close()
    return result, _finish(folder, scene, result, keep_fields)


def _explained(scene: Scene, result: Result) -> Result:
    """A path that stops on a mesh too coarse for its process zone says so first: no step is small enough for that."""
    warning = next(iter(zone_resolution.warnings(scene, result.method)), "")
    if result.complete or not warning:
        return result
    zone, _, _ = warning.partition(":")
    return replace(result, status=f"stopped: {zone}; {result.status.removeprefix('stopped: ')}")


def _filmed(
    solver: Callable[..., Result], frames: Frames, scene: Scene, method: str, on_step: Callable | None
) -> Result:
    result = solver(scene, method, on_step, on_frame=frames)
    frames.finish()
    return result


def _with_moments(scene: Scene, method: str, on_step: Callable | None) -> Result:
    moments = Moments(scene)
    result = solve(scene, method, on_step, on_frame=moments)
    return replace(result, between=moments.snapshots())


def _silent(scene: Scene, method: str, solver: Solver) -> Result:
    try:
        return solver(scene, method, None)
    except Exception as error:
        return _take_down_all_ranks(f"{type(error).__name__}: {error}")


def _take_down_all_ranks(why: str) -> NoReturn:
    """End without MPI_Finalize, which would wait for ranks that wait for this one; mpirun then ends those."""
    say(f"rank {mpi_rank()}: {why}")
    sys.stdout.flush()
    os._exit(1)


def _finish(folder: Path, scene: Scene, result: Result, keep_fields: bool) -> tuple[Check, ...]:
    checks = run_checks(scene, result)
    if keep_fields and result.snapshots:
        write_fields(folder / "fields.npz", result.snapshots)
    if keep_fields and result.between:
        write_fields(folder / "moments.npz", result.between)
    write_json(folder / "result.json", summary(scene, result, checks))
    return checks


def summary(scene: Scene, result: Result, checks: tuple[Check, ...]) -> dict[str, Any]:
    """The content of ``result.json``."""
    opening, load = result.opening, result.load
    peak = int(np.argmax(load)) if load.size else 0
    return {
        "scene": scene.model_dump(),
        "method": result.method,
        "dofs": result.dofs,
        "elements": result.elements,
        "steps": max(int(load.size) - 1, 0),
        "newton_iterations": int(np.sum(result.steps.get("newton_iterations", 0))),
        "rejected_steps": result.rejected_steps,
        "peak_load": float(load[peak]) if load.size else 0.0,
        "peak_opening": float(opening[peak]) if load.size else 0.0,
        "seconds": dict(result.seconds or dict.fromkeys((*PHASES, "other", "total"), 0.0)),
        "jit_seconds": result.jit_seconds,
        "peak_memory_mb": result.peak_memory_mb,
        "nonzeros": result.nonzeros,
        "effects": simulated(scene, result.method),
        "decided": {one.key: one.why for one in decided(scene, result.method)},
        "neglected": neglected.summary(scene, result),
        "process_zone": zone_resolution.summary(scene, result),
        "matched_interface": matched.summary(scene, result),
        "checks": {c.name: _verdict(c) for c in checks},
        "versions": versions(),
        "machine": machine(),
        "threads": threads(),
        "status": result.status,
        "ending": result.ending,
        "condition": result.condition,
    }


def _verdict(check: Check) -> dict[str, Any]:
    return {"value": check.value, "tolerance": check.tolerance, "kind": check.kind, **of_state(check)}


def _stopped(method: str, rows: list[Row], why: str) -> Result:
    steps = steps_from_rows(rows) if rows else {name: np.zeros(0) for name in CURVE_COLUMNS}
    return Result(method=method, steps=steps, status=f"stopped: {why}", peak_memory_mb=peak_memory_mb())
