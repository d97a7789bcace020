"""One run, written to one folder."""

from __future__ import annotations

import os
import sys
import traceback
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any, NoReturn

import numpy as np

from verify.checks import matched, neglected
from verify.checks.identities import checks_of
from verify.fields.frames import Frames, cleared
from verify.methods import zone_resolution
from verify.methods.method import Failure, Prepared
from verify.methods.solve import solve_prepared
from verify.result import CURVE_COLUMNS, Result, steps_from_rows
from verify.runs.environment import keep_freed_memory, machine, mpi_rank, mpi_size, threads, versions
from verify.runs.folder import NO_ROOM, CurveWriter, hashes, refuse_files_of_others, write_fields, write_json
from verify.runs.store import alone_in
from verify.support import interrupts
from verify.support.say import say
from verify.support.timing import PHASES, peak_memory_mb
from verify.verdict import Check, of_state

Row = Mapping[str, float]
OnRow = Callable[[Row], None]

#: Replaces the method of a run; used in tests.
Solver = Callable[..., Result]

#: Origin of an unexpected error.
OURS = "the program: please report it with error.log"


@dataclass(frozen=True)
class Keep:
    """Output of a run beside its curve: fields of a few steps, and a number of frames for ParaView
    (`verify.fields.frames`)."""

    fields: bool = False
    frames: int = 0


NO_FIELDS = Keep()


def run(
    prepared: Prepared,
    folder: Path,
    keep: Keep = NO_FIELDS,
    on_step: OnRow | None = None,
    solver: Solver | None = None,
) -> tuple[Result, tuple[Check, ...]]:
    """Solve a prepared scene by its method and write its folder.

    The files are valid however the run ends: rows are written step by step, and ``status`` in ``result.json`` is the
    reason why a run stopped. An interrupt by the user is recorded and raised again, like the error of a full disk.

    Parameters
    ----------
    folder : created if absent; an earlier run in it is replaced
    on_step : called after every converged step, for progress
    solver : called with scene, name of the method and a function for every row; default: the method of the prepared
        scene

    Raises
    ------
    Refusal : another run is at work in the folder, or it has files of the same names that no run wrote.
    OSError : the disk is full; the files are valid.
    """
    keep_freed_memory()
    scene, name = prepared.scene, prepared.method.name
    solving = partial(solver, scene, name) if solver is not None else partial(solve_prepared, prepared)
    if keep.frames and prepared.framed:
        solving = partial(_with_frames, solving, Frames(folder, scene, name, keep.frames, writes=mpi_rank() == 0))
    if mpi_rank() > 0:  # all ranks have the same numbers; one of them writes
        try:
            return solving(None), ()
        except Exception as error:
            _take_down_all_ranks(f"{type(error).__name__}: {error}")
    folder.mkdir(parents=True, exist_ok=True)
    with alone_in(folder):
        refuse_files_of_others(folder)
        cleared(folder)
        return _recorded(prepared, folder, keep, on_step, solving)


def _recorded(
    prepared: Prepared, folder: Path, keep: Keep, on_step: OnRow | None, solving: Callable[[OnRow], Result]
) -> tuple[Result, tuple[Check, ...]]:
    """Solve with every row in the folder, and finish its files however that ends."""
    writer = CurveWriter(folder, prepared.by_accuracy)
    rows: list[Row] = []

    def record(row: Row) -> None:
        rows.append(dict(row))
        writer(row)
        if on_step is not None:
            on_step(row)

    def stopped(why: str) -> Result:
        steps = steps_from_rows(rows) if rows else {name: np.zeros(0) for name in CURVE_COLUMNS}
        return Result(prepared.method.name, steps, f"stopped: {why}", peak_memory_mb=peak_memory_mb())

    why = ""
    try:
        result = _with_warning(prepared, solving(record))
    except (KeyboardInterrupt, Exception) as error:
        if interrupts.is_one(error):
            why = "interrupted"
        elif isinstance(error, OSError) and error.errno in NO_ROOM:
            if mpi_size() > 1:
                _take_down_all_ranks(str(error))
            raise
        else:
            (folder / "error.log").write_text(traceback.format_exc())
            whose = error.whose if isinstance(error, Failure) else OURS
            kind = "" if isinstance(error, Failure) else f"{type(error).__name__}: "
            why = f"{kind}{error} (an error in {whose})"
        result = stopped(why)
    finally:
        writer.close()
    checks = checks_of(prepared, result)
    if keep.fields and result.snapshots:
        write_fields(folder / "fields.npz", result.snapshots)
    written = {"interpolated_rows": writer.interpolated, "sha256": hashes(folder)}
    write_json(folder / "result.json", summary(prepared, result, checks) | written)
    if why == "interrupted":
        raise KeyboardInterrupt
    if why and mpi_size() > 1:
        _take_down_all_ranks(why)
    return result, checks


def _with_warning(prepared: Prepared, result: Result) -> Result:
    """Put the warning of a mesh too coarse for the process zone into the status of a path that stopped."""
    warning = "" if result.complete else next(iter(zone_resolution.warnings(prepared)), "")
    if not warning:
        return result
    zone, _, _ = warning.partition(":")
    return replace(result, status=f"stopped: {zone}; {result.status.removeprefix('stopped: ')}")


def _with_frames(solver: Solver, frames: Frames, on_step: OnRow | None) -> Result:
    result = solver(on_step, on_frame=frames)
    frames.finish()
    return result


def _take_down_all_ranks(why: str) -> NoReturn:
    """End without MPI_Finalize, which would wait for ranks that wait for this one; mpirun ends them."""
    say(f"rank {mpi_rank()}: {why}")
    sys.stdout.flush()
    os._exit(1)


def summary(prepared: Prepared, result: Result, checks: tuple[Check, ...]) -> dict[str, Any]:
    """The content of ``result.json``."""
    opening, load = result.opening, result.load
    peak = int(np.argmax(load)) if load.size else 0
    return {
        "scene": prepared.scene.model_dump(),
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
        "effects": dict(prepared.effects),
        "decided": {one.key: one.why for one in prepared.decisions},
        "counted_steps": prepared.counted or result.counted_steps,
        "neglected": neglected.summary(prepared, result),
        "process_zone": zone_resolution.summary(prepared, result),
        "matched_interface": matched.summary(prepared, result),
        "checks": {c.name: {"value": c.value, "tolerance": c.tolerance, "kind": c.kind, **of_state(c)} for c in checks},
        "versions": versions(),
        "machine": machine(),
        "threads": threads(),
        "status": result.status,
        "ending": result.ending,
        "condition": result.condition,
    }
