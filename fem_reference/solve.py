"""Follow the load programme of a double cantilever beam, step by converged step."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass, replace

import numpy as np
from mpi4py import MPI

from fem_reference.assembled import owned
from fem_reference.fields import field_sampler
from fem_reference.model import Model, build_model
from fem_reference.newton import OpeningControl, find_equilibrium
from fem_reference.problem import Problem
from fem_reference.state import State, row_of

#: A step is halved this often before the run stops.
MAX_HALVINGS = 12

OnStep = Callable[[Mapping[str, float]], None]


@dataclass(frozen=True)
class Solution:
    """A run, as far as it came; the same on every rank, but for the snapshots, which the first one has."""

    rows: tuple[dict[str, float], ...]
    dofs: int  # two a node of both arms, supported ones included
    elements: int
    rejected_steps: int
    status: str  # "complete", or "stopped: <cause and what to do>"
    snapshots: tuple[dict, ...]


def solve_dcb(
    problem: Problem,
    on_step: OnStep = lambda row: None,
    phase: Callable[[str], AbstractContextManager] = lambda name: nullcontext(),
    comm: MPI.Intracomm = MPI.COMM_WORLD,
) -> Solution:
    """Solve a double cantilever beam.

    Parameters
    ----------
    on_step : called on the first rank with the row of every converged step; the first row is the unloaded specimen.
    phase : context manager that times a part of the work: "mesh", "basis" (compiling the forms too), "assembly",
        "factor", "solve".
    """
    model = build_model(problem, phase, comm)
    with phase("basis"):
        sample = field_sampler(model)
    rows: list[dict[str, float]] = []
    snapshots: list[dict | None] = []
    wanted = sorted(problem.snapshot_openings)
    status, rejected = "complete", 0
    for point in path(model):
        if isinstance(point, Failure):
            rejected += 1
            status = f"stopped: {point.reason}" if point.final else status
            continue
        with phase("assembly"):
            rows.append(row_of(model, point))
        if comm.rank == 0:
            on_step(rows[-1])
        while wanted and point.opening >= wanted[0] * (1 - 1e-12):
            snapshots.append(sample(point))
            wanted.pop(0)
    return Solution(
        rows=tuple(rows),
        dofs=comm.allreduce(sum(owned(u) for u in model.displacement)),
        elements=2 * problem.elements * problem.elements_across,
        rejected_steps=rejected,
        status=status,
        snapshots=tuple(s for s in snapshots if s is not None),
    )


@dataclass(frozen=True)
class Failure:
    """A step that did not converge; ``final`` when it cannot be made shorter."""

    reason: str
    final: bool


def targets(problem: Problem) -> list[np.ndarray]:
    """Openings to reach, one array a branch of the programme: equal increments, about ``steps`` over all branches."""
    corners = np.concatenate([[0.0], problem.opening])
    lengths = np.abs(np.diff(corners))
    counts = np.maximum(1, np.rint(problem.steps * lengths / lengths.sum()).astype(int))
    branches = zip(corners[:-1], corners[1:], counts, lengths, strict=True)
    return [np.linspace(start, end, n + 1)[1:] for start, end, n, length in branches if length > 0]


def path(model: Model) -> Iterator[State | Failure]:
    """Converged states along the programme, and the failures between them; ends after a final one."""
    branches = targets(model.problem)
    state = unloaded(model, towards=branches[0][0])
    yield state
    force_scale = 0.0
    for branch in branches:
        state = departing(model, state, towards=branch[0])
        for target in branch:
            part = 1.0
            increment = target - state.opening
            while abs(target - state.opening) > 1e-9 * abs(increment):
                goal = target if part == 1.0 else min_by_size(state.opening + part * increment, target, state.opening)
                new, reason = step(model, state, goal, force_scale)
                if new is None:
                    part *= 0.5
                    final = part < 0.5**MAX_HALVINGS
                    yield Failure(f"at opening {state.opening:.6g}: {reason}", final)
                    if final:
                        return
                    continue
                state, part = new, min(1.0, 2 * part)
                force_scale = max(force_scale, abs(state.load) * model.norm(model.load_n))
                yield state


def min_by_size(goal: float, target: float, start: float) -> float:
    """The goal, but not beyond the target."""
    return goal if abs(goal - start) < abs(target - start) else target


def step(model: Model, state: State, opening: float, force_scale: float) -> tuple[State | None, str]:
    """The next converged state, its history committed, or None and why not."""
    move = opening - state.opening
    guess = state.u_n + move * state.rate_n, state.load + move * state.slope
    attempt = find_equilibrium(model, OpeningControl(opening), *guess, state.k_q, force_scale)
    if not attempt.converged:
        return None, (
            f"no equilibrium within {attempt.iterations} iterations (residual {attempt.residuals[-1]:.1e} of the load); "
            "the specimen may snap back here: use more elements along it or a higher degree"
        )
    model.factorise(attempt.u_n, state.k_q)
    rate_n, slope = tangent_of_path(model)
    g_q = model.bond.gap(attempt.u_n)
    new = State(
        u_n=attempt.u_n,
        load=attempt.load,
        opening=opening,
        k_q=model.law.history(g_q, state.k_q),
        g_q=g_q,
        rate_n=rate_n,
        slope=slope,
        work=state.work + 0.5 * move * (state.load + attempt.load) + move**2 / 12 * (state.slope - slope),
        iterations=attempt.iterations + 1,
    )
    return new, ""


def tangent_of_path(model: Model) -> tuple[np.ndarray, float]:
    """du/d(opening) and d load/d(opening), with the tangent last factorised."""
    by_load_n = model.solve(model.free_n * model.load_n)
    compliance = model.dot(model.load_n, by_load_n)
    return by_load_n / compliance, 1.0 / compliance


def unloaded(model: Model, towards: float) -> State:
    """The specimen before anything happens, and the direction in which it sets out.

    Where gaps open and where they close is settled by the first load; it is read off a state a trifle ahead.
    """
    u_n, k_q = np.zeros_like(model.load_n), np.zeros_like(model.X_q)
    model.factorise(u_n, k_q)
    rate_n, slope = tangent_of_path(model)
    trifle = 1e-6 * towards
    ahead = find_equilibrium(model, OpeningControl(trifle), trifle * rate_n, trifle * slope, k_q, 0.0)
    model.factorise(ahead.u_n, k_q)
    rate_n, slope = tangent_of_path(model)
    return State(u_n, 0.0, 0.0, k_q, np.zeros_like(k_q), rate_n, slope, 0.0, 0)


def departing(model: Model, state: State, towards: float) -> State:
    """The same state with the direction in which a path that turns round leaves it: every point unloads along its secant.

    A gap that equals its history is on the edge between loading and unloading; a history raised by a trifle decides it.
    """
    if state.load == 0.0 or towards > state.opening:
        return state
    model.factorise(state.u_n, state.k_q * (1 + 1e-9))
    rate_n, slope = tangent_of_path(model)
    return replace(state, rate_n=rate_n, slope=slope)
