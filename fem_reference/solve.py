"""Solve a problem: build the model, follow its path, collect rows and snapshots."""

from __future__ import annotations

import sys
import traceback
from collections.abc import Callable, Iterator, Mapping
from contextlib import AbstractContextManager, contextmanager, nullcontext
from dataclasses import dataclass
from functools import partial
from typing import Any

from mpi4py import MPI
from petsc4py import PETSc

from fem_reference.model.assembled import owned
from fem_reference.model.build import build_model
from fem_reference.output.frames import frame
from fem_reference.output.snapshots import field_sampler, snapshot
from fem_reference.path.path import Separation, path
from fem_reference.path.row import row
from fem_reference.path.step import Failure
from fem_reference.problem.problem import Debonding


@dataclass(frozen=True)
class Solution:
    """A run up to its end; the same on every rank, except that only the first one has the snapshots."""

    rows: tuple[dict[str, float], ...]
    dofs: int  # unknowns, two per node of both bodies, supported ones included
    elements: int
    rejected_steps: int
    status: str  # "complete", or "stopped: <cause and what to do>"
    ending: str  # "separated at opening ...", or empty
    snapshots: tuple[dict, ...]
    nonzeros: int = 0  # stored entries of the tangent


def solve_debonding(
    problem: Debonding,
    on_step: Callable[[Mapping[str, float]], None] = lambda row: None,
    phase: Callable[[str], AbstractContextManager] = lambda name: nullcontext(),
    comm: MPI.Intracomm = MPI.COMM_WORLD,
    on_frame: Callable[[float, Callable[[], dict[str, Any] | None]], None] | None = None,
) -> Solution:
    """Solve a problem, like a `fem_reference.problem.delamination.Problem`.

    Parameters
    ----------
    on_step : called on the first rank with the row of every converged step; the first row is the unloaded specimen.
    phase : context manager that times a part of the work: "mesh", "basis", "compile" (compiling the forms or reading
        them from the cache), "assembly", "factor", "solve".
    on_frame : called on all ranks with the opening of every converged step and a function that makes its frame
        (`fem_reference.output.frames`), which must be called on all ranks or on none; the first rank gets the frame.

    Raises
    ------
    ValueError : a point load without a node.
    """
    model = build_model(problem, phase, comm)
    with phase("compile"):
        sample = field_sampler(model)
    rows: list[dict[str, float]] = []
    snapshots: list[dict | None] = []
    wanted = sorted(problem.snapshot_openings)
    status, ending, rejected = "complete", "", 0
    with _all_or_none(comm):
        for point in path(model):
            if isinstance(point, Failure):
                rejected += 1
                status = f"stopped: {point.reason}" if point.final else status
                continue
            if isinstance(point, Separation):
                ending = f"separated at opening {point.opening:.6g}"
                continue
            with phase("assembly"):
                rows.append(row(model, point))
            if comm.rank == 0:
                on_step(rows[-1])
            if on_frame is not None:
                on_frame(point.opening, partial(frame, model, sample, point))
            while wanted and point.opening >= wanted[0] * (1 - 1e-12):
                snapshots.append(snapshot(model, sample, point))
                wanted.pop(0)
    return Solution(
        rows=tuple(rows),
        dofs=comm.allreduce(sum(owned(u) for u in model.displacement)),
        elements=comm.allreduce(sum(cells.size for cells in model.bodies.cells)),
        rejected_steps=rejected,
        status=status,
        ending=ending,
        snapshots=tuple(s for s in snapshots if s is not None),
        nonzeros=int(model.tangent_matrix.getInfo(PETSc.Mat.InfoType.GLOBAL_SUM)["nz_used"]),
    )


@contextmanager
def _all_or_none(comm: MPI.Intracomm) -> Iterator[None]:
    """A rank that fails ends all of them: the others would wait for it for ever."""
    try:
        yield
    except Exception:
        if comm.size > 1:
            traceback.print_exc()
            sys.stderr.flush()
            comm.Abort(1)
        raise
