"""The path of equilibrium along the load programme: predictor, Newton, step length."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from fem_reference.model import Model
from fem_reference.newton import OpeningControl, bordered_step, find_equilibrium
from fem_reference.problem import Problem
from fem_reference.state import State

#: A step is halved this often before the run stops.
MAX_HALVINGS = 12


@dataclass(frozen=True)
class Failure:
    """A step that did not converge; ``final`` when it cannot be made shorter."""

    reason: str
    final: bool = False


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
        state = departing(model, state, towards=branch[-1])
        for target in branch:
            for point in reach(model, state, target, force_scale):
                yield point
                if isinstance(point, Failure) and point.final:
                    return
                state = state if isinstance(point, Failure) else point
                force_scale = max(force_scale, abs(state.load) * model.norm(model.load_n))


def reach(model: Model, state: State, target: float, force_scale: float) -> Iterator[State | Failure]:
    """Converged states on the way to one target opening: in one step, or in halves of it that grow again."""
    whole, part = target - state.opening, 1.0
    while state.opening != target:
        left = target - state.opening
        goal = target if part * abs(whole) >= abs(left) * (1 - 1e-9) else state.opening + part * whole
        point = step(model, state, goal, force_scale)
        if isinstance(point, State):
            state, part = point, 2 * part
        else:
            part *= 0.5
            point = replace(point, final=part < 0.5**MAX_HALVINGS)
        yield point
        if isinstance(point, Failure) and point.final:
            return


def step(model: Model, state: State, opening: float, force_scale: float) -> State | Failure:
    """The next converged state, its history committed, or why there is none.

    The tangent that gives the direction of the path also gives one more correction, which leaves rounding alone.
    """
    move = opening - state.opening
    guess = state.u_n + move * state.rate_n, state.load + move * state.slope
    control = OpeningControl(opening)
    attempt = find_equilibrium(model, control, *guess, state.k_q, force_scale)
    if not attempt.converged:
        return Failure(
            f"no equilibrium beyond opening {state.opening:.6g} in {attempt.iterations} iterations "
            f"(residual {attempt.residuals[-1]:.1e} of the load); the specimen may snap back here: "
            "use more elements along it or a higher degree"
        )
    model.factorise(attempt.u_n, state.k_q)
    rate_n, slope = tangent_of_path(model)
    du_n, d_load = bordered_step(
        model, control, attempt.u_n, attempt.load, model.residual(attempt.u_n, attempt.load, state.k_q)
    )
    u_n, load = attempt.u_n + du_n, attempt.load + d_load
    g_q = model.bond.gap(u_n)
    return State(
        u_n=u_n,
        load=load,
        opening=opening,
        k_q=model.law.history(g_q, state.k_q),
        g_q=g_q,
        rate_n=rate_n,
        slope=slope,
        work=state.work + 0.5 * move * (state.load + load) + move**2 / 12 * (state.slope - slope),
        iterations=attempt.iterations + 1,
    )


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
    """The same state with the direction in which a path that turns round leaves it: unloading along all secants.

    A gap equal to its history is on the edge between loading and unloading; a history raised by a trifle decides it.
    """
    if state.load == 0.0 or towards > state.opening:
        return state
    model.factorise(state.u_n, state.k_q * (1 + 1e-9))
    rate_n, slope = tangent_of_path(model)
    return replace(state, rate_n=rate_n, slope=slope)
