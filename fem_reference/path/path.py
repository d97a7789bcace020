"""The path of equilibrium along the load programme: predictor, control, Newton, step length, end."""

from __future__ import annotations

from collections.abc import Generator, Iterator
from dataclasses import dataclass, replace

import numpy as np

from fem_reference.model.model import Model
from fem_reference.path.control import FRONT_STEP, Control, Front, at, front_of, opening_control
from fem_reference.path.newton import bordered_step, find_equilibrium
from fem_reference.path.state import State
from fem_reference.path.work import work_along
from fem_reference.problem.problem import Debonding

#: A step is halved this often before the run stops.
MAX_HALVINGS = 12
#: Steps towards one goal after which a path that does not arrive is given up.
MAX_STEPS = 20_000
#: A specimen has separated when its load has fallen to this part of the peak while damage grew.
SEPARATED = 1e-3
#: A step that ends within this part of an increment before the goal is drawn out to the goal.
NEAR = 0.01
#: How far ahead the direction of a path that sets out is read off, as a part of the way to the goal.
TRIFLE = 1e-6


#: What to do where a path cannot go on, and where the bodies are pressed together.
FINER = "use more elements along the specimen or a higher degree"
LESS = "close by less (load.opening), as bodies that are crushed have no equilibrium,"


@dataclass(frozen=True)
class Failure:
    """A step that did not converge; ``final`` when the run stops for it."""

    reason: str
    final: bool = False


@dataclass(frozen=True)
class Separation:
    """The end of a path on which nothing is left that carries."""

    opening: float


def branches(problem: Debonding) -> list[np.ndarray]:
    """Equal increments of the opening, about ``steps`` over the whole programme: their ends, one array a branch.

    A branch ends where the programme passes through zero, at which all gaps of an unloaded bond open or close.
    """
    goals = np.concatenate([[0.0], problem.opening])
    crossed = np.flatnonzero(goals[1:] * goals[:-1] < 0.0)
    corners = np.insert(goals, crossed + 1, 0.0)
    ways = np.abs(np.diff(corners))
    counts = np.maximum(1, np.rint(problem.steps * ways / ways.sum()).astype(int))
    parts = zip(corners[:-1], corners[1:], counts, ways, strict=True)
    return [np.linspace(start, end, n + 1) for start, end, n, way in parts if way > 0]


def path(model: Model) -> Iterator[State | Failure | Separation]:
    """Converged states along the programme, and the failures between them; ends after a final one or a separation."""
    state = unloaded(model)
    for lines in branches(model.problem):
        first = state.heading == 0.0
        state = departing(model, state, lines[-1])
        if first:
            yield state
        end = yield from reach(model, state, lines)
        if end is None:
            return
        state = end


def reach(model: Model, state: State, lines: np.ndarray) -> Generator[State | Failure | Separation, None, State | None]:
    """Converged states along a branch; returns the last one, or None where the path ends before its goal.

    Steps that fail are halved and grow again afterwards.
    """
    goal, part = float(lines[-1]), 1.0
    for _ in range(MAX_STEPS):
        point = advance(model, state, lines, part)
        if isinstance(point, Failure):
            part *= 0.5
            final = part < 0.5**MAX_HALVINGS
            yield replace(point, final=final)
            if final:
                return None
            continue
        yield point
        if point.opening == goal:
            return point
        if separated(model, state, point, goal):
            yield Separation(point.opening)
            return None
        state, part = point, min(1.0, 2 * part)
    yield Failure(
        f"the path did not come from opening {state.opening:.6g} to {goal:.6g} in {MAX_STEPS} steps; "
        "use more elements along the specimen or a higher degree",
        final=True,
    )
    return None


def advance(model: Model, state: State, lines: np.ndarray, part: float) -> State | Failure:
    """One step: to the next line of the branch, or as far as the front is to be led where damage grows fast.

    An opening can be met by two states, before and after a snap-back. A step over which the front has gone much
    further than it may has missed the path between them, and is taken again by the front.
    """
    goal, reach = float(lines[-1]), part * abs(lines[1] - lines[0])
    front, ahead = front_of(model, state, reach), goal > state.opening
    if front is None:
        state = departing(model, state, goal)
        return step(model, state, opening_control(model, next_line(state.opening, lines, reach)))
    front_control = front.control(model, reach, part)
    if (state.heading > 0) == ahead and front.calm(model, reach, part):
        control = opening_control(model, next_line(state.opening, lines, reach))
        reached = step(model, state, control, along_n=front_control.row_n)
        if isinstance(reached, State) and not skipped(model, front, reached, part):
            return reached
    return lead(model, state, front_control, lines)


def next_line(opening: float, lines: np.ndarray, reach: float) -> float:
    """The first line of a branch that is clearly ahead, or as far towards it as a step may reach."""
    way = (lines - opening) / (lines[1] - lines[0])
    line = float(lines[np.argmax(way > NEAR)]) if way[-1] > NEAR else float(lines[-1])
    left = line - opening
    return line if abs(left) <= reach * (1 + NEAR) else opening + float(np.copysign(reach, left))


def skipped(model: Model, front: Front, reached: State, part: float) -> bool:
    """Whether the front has opened by far more than its largest step."""
    return abs(at(model, front.place, reached.g_q) - front.gap) > 2 * part * FRONT_STEP * model.law.g_open


def lead(model: Model, state: State, control: Control, lines: np.ndarray) -> State | Failure:
    """A step of the front; one that passes the goal, or all but reaches it, is taken again so that it ends there."""
    reached = step(model, state, control)
    goal, increment = float(lines[-1]), lines[1] - lines[0]
    if isinstance(reached, State) and reached.opening * goal < 0.0 <= state.opening * goal:
        # a front opens on both sides of zero: by pulling and by pressing
        return Failure(f"the path leaps from opening {state.opening:.6g} to {reached.opening:.6g}; {LESS} or {FINER}")
    if isinstance(reached, Failure) or (goal - reached.opening) / increment > NEAR:
        return reached
    share = (goal - state.opening) / (reached.opening - state.opening)
    between = state.u_n + share * (reached.u_n - state.u_n), state.load + share * (reached.load - state.load)
    return step(model, state, opening_control(model, goal), between, control.row_n)


def step(
    model: Model,
    state: State,
    control: Control,
    guess: tuple[np.ndarray, float] | None = None,
    along_n: np.ndarray | None = None,
) -> State | Failure:
    """The next converged state, its history committed, or why there is none.

    The tangent that gives the direction of the path also gives one more correction, which leaves rounding alone.

    Parameters
    ----------
    guess : displacements and load to begin with; those that the tangent of the path predicts unless given.
    along_n : the functional that grows or falls steadily along the step; the prescribed one unless given.
    """
    if guess is None:
        move = (control.value - model.dot(control.row_n, state.u_n)) / model.dot(control.row_n, state.rate_n)
        guess = state.u_n + move * state.rate_n, state.load + move * state.slope
    u_n, load = guess
    attempt = find_equilibrium(model, control, u_n, load, state.k_q, state.peak * model.norm(model.load_n))
    if not attempt.converged:
        less = f"{LESS} or " if state.opening <= 0.0 and state.heading < 0.0 else ""
        return Failure(
            f"no equilibrium beyond opening {state.opening:.6g} in {attempt.iterations} iterations "
            f"(residual {attempt.residuals[-1]:.1e} of the load), however short the step; {less}{FINER}"
        )
    model.factorise(on_arrival(model, state, attempt.u_n), state.k_q)
    rate_n, slope = tangent_of_path(model)
    du_n, d_load = bordered_step(model, control, attempt.u_n, model.residual(attempt.u_n, attempt.load, state.k_q))
    u_n, load = attempt.u_n + du_n, attempt.load + d_load
    row_n = control.row_n if along_n is None else along_n
    change = model.dot(row_n, u_n - state.u_n)
    rates = change / model.dot(row_n, state.rate_n), change / model.dot(row_n, rate_n)
    opening = control.value if control.row_n is model.load_n else model.dot(model.load_n, u_n)
    g_q = model.bond.gap(u_n)
    work = work_along((state.opening, opening), (state.load, load), (state.slope, slope), rates)
    return State(
        u_n=u_n,
        load=load,
        opening=opening,
        k_q=model.history(g_q, state.k_q),
        g_q=g_q,
        rate_n=rate_n,
        slope=slope,
        heading=float(np.sign(rates[1])),
        peak=max(state.peak, abs(load)),
        work=state.work + work,
        iterations=attempt.iterations + 1,
    )


def on_arrival(model: Model, state: State, u_n: np.ndarray) -> np.ndarray:
    """Displacements at which the tangent of a converged step is taken: those found, unless they are nothing at all.

    At no opening the signs of the gaps are rounding. What is open and what is closed is as it was a trifle before.
    """
    if abs(model.dot(model.load_n, u_n)) > TRIFLE * abs(state.opening):
        return u_n
    return u_n + TRIFLE * (state.u_n - u_n)


def tangent_of_path(model: Model) -> tuple[np.ndarray, float]:
    """du/d(opening) and d load/d(opening), with the tangent last factorised."""
    by_load_n = model.solve(model.free_n * model.load_n)
    compliance = model.dot(model.load_n, by_load_n)
    return by_load_n / compliance, 1.0 / compliance


def unloaded(model: Model) -> State:
    """The specimen before anything happens; it has no heading yet."""
    u_n, k_q = np.zeros_like(model.load_n), np.zeros_like(model.X_q)
    model.factorise(u_n, k_q)
    rate_n, slope = tangent_of_path(model)
    return State(u_n, 0.0, 0.0, k_q, np.zeros_like(k_q), rate_n, slope, 0.0, 0.0, 0.0, 0)


def departing(model: Model, state: State, goal: float) -> State:
    """The same state with the direction in which the path leaves it for a goal.

    Where the path turns round, and where all gaps are zero, it is not that of the arrival: points whose damage grew
    unload along their secants, gaps open or close. Which ones is read off a state a trifle ahead.
    """
    heading = float(np.sign(goal - state.opening))
    if heading == state.heading and state.opening != 0.0:
        return state
    trifle = TRIFLE * (goal - state.opening)
    guess = state.u_n + trifle * state.rate_n, state.load + trifle * state.slope
    control = opening_control(model, state.opening + trifle)
    ahead = find_equilibrium(model, control, *guess, state.k_q, state.peak * model.norm(model.load_n))
    model.factorise(ahead.u_n if ahead.converged else state.u_n, state.k_q)
    rate_n, slope = tangent_of_path(model)
    return replace(state, rate_n=rate_n, slope=slope, heading=heading)


def separated(model: Model, before: State, state: State, goal: float) -> bool:
    """Whether a step on which damage grew has left nothing that carries, nor will by the end of the branch.

    Unloading to zero is none: no damage grows there, and the secants bring the load back.
    """
    grew_q = state.k_q > np.maximum(before.k_q, model.law.g_peak)
    way = float(np.sign(goal))
    gain = max(0.0, way * state.heading * state.slope) * abs(goal - state.opening)
    carried = abs(state.load) + gain
    return (
        way * (goal - state.opening) > 0.0
        and carried < SEPARATED * state.peak
        and bool(model.norm(grew_q.astype(float)) > 0)
    )
