"""The path of equilibrium along the load programme: predictor, control, Newton, step length, end."""

from __future__ import annotations

from collections.abc import Generator, Iterator
from dataclasses import dataclass, replace

import numpy as np
from mpi4py import MPI

from fem_reference.model.model import BondEnergies, Model
from fem_reference.path.control import LANDING, Control, Front, at, edge_control, front_of, opening_control
from fem_reference.path.newton import Step, bordered_step, find_equilibrium, scale_and_target
from fem_reference.path.programme import NEAR_THE_GOAL, branches, next_line
from fem_reference.path.state import State
from fem_reference.path.stride import COUNTED_STEPS, Counted, Stride, chosen
from fem_reference.path.work import chord, work_along


@dataclass(frozen=True)
class PathSettings:
    """When a path ends, and when two openings count as the same.

    steps : steps towards one goal after which the run stops.
    separated : load, as a part of the peak, below which a specimen whose damage grew has separated.
    leap : part of the energy, or of the largest load times the change of the opening, by which work and energy of a
        step may differ; one that ends on another branch of equilibrium was seen to miss by a quarter of the energy, one
        along the path misses by 1e-6.
    corrections, closed : corrections, each with a new tangent, after iterations that stop early, and the residual over
        the force scale that they have to reach.
    ahead : distance, as a part of the way to the goal, at which the open and closed points of a path that sets out are
        determined: small enough to change no force, large enough for gaps beyond rounding.
    """

    steps: int = 20_000
    separated: float = 1e-3
    leap: float = 0.05
    corrections: int = 20
    closed: float = 1e-8
    ahead: float = 1e-6


REFERENCE_PATH = PathSettings()

#: Why a step of a viscous bond is repeated, and one that the path has chosen.
TOO_FAST = "damage grows too much in one step"
TOO_LONG = "the curve is not accurate on so long a step"

#: Advice for a path that cannot go on, and for bodies that are pressed together.
FINER = "use more elements along the specimen or a higher degree"
LESS = "close by less (load.opening), as bodies that are crushed have no equilibrium,"


@dataclass(frozen=True)
class Failure:
    """A step that did not converge; ``final`` if the run stops because of it."""

    reason: str
    final: bool = False


@dataclass(frozen=True)
class Separation:
    """The end of a path: the bond no longer carries load."""

    opening: float


def path(model: Model) -> Iterator[State | Failure | Separation]:
    """Converged states along the programme and the failures in between, up to a final failure or a separation."""
    state, stride = unloaded(model), None
    by_accuracy = model.problem.steps is None and not model.timed
    for lines in branches(model.problem, by_accuracy):
        if not by_accuracy:
            stride = Counted(abs(lines[1] - lines[0]))
        elif stride is None:
            stride = chosen(model.problem.way, model.problem.bend)
        first = state.heading == 0.0
        state = departing(model, state, lines[-1], stride)
        if first:
            yield state
        end = yield from reach(model, state, lines, stride)
        if end is None:
            return
        state, stride = end


def reach(
    model: Model, state: State, lines: np.ndarray, stride: Stride
) -> Generator[State | Failure | Separation, None, tuple[State, Stride] | None]:
    """Converged states along a branch; returns the last one and the next stride, or None where the path ends before.

    Steps that fail are halved, and those that are not accurate made shorter; steps after them grow again.
    """
    goal = float(lines[-1])
    for _ in range(REFERENCE_PATH.steps):
        point = advance(model, state, lines, stride)
        if isinstance(point, Failure):
            shorter = stride.failed()
            yield replace(point, final=shorter is None)
            if shorter is None:
                return None
            stride = shorter
            continue
        accurate, stride = stride.judged(state, point)
        if not accurate:
            yield Failure(TOO_LONG)
            continue
        yield point
        if point.opening == goal:
            return point, stride
        if separated(model, state, point, goal):
            yield Separation(point.opening)
            return None
        state = departing(model, point, goal, stride, anew=stride.lands and at_kink(model, point))
    yield Failure(
        f"the path did not come from opening {state.opening:.6g} to {goal:.6g} in {REFERENCE_PATH.steps} steps; "
        f"{FINER}",
        final=True,
    )
    return None


def advance(model: Model, state: State, lines: np.ndarray, stride: Stride) -> State | Failure:
    """One step: to the next end of an increment, or controlled by the front where damage grows fast.

    Two states before and after a snap-back can have the same opening. If the front has moved much further than its
    largest step, the step has missed the path between them and is repeated with control by the front. Where a bond that
    keeps its damage is unloaded, no step is: the front would lead back along the path of loading.
    """
    goal, reach = float(lines[-1]), stride.reach
    front = None if model.timed else front_of(model, state, reach)
    ahead = goal > state.opening
    if front is None:
        state = departing(model, state, goal, stride)
        reached = step(model, state, opening_control(model, next_line(state.opening, lines, reach)), stride)
        return Failure(TOO_FAST) if model.timed and hastens(model, state, reached, stride) else reached
    front_control, forward = front.control(model, stride), (state.heading > 0) == ahead
    ends = stride.lands and front.within(model, stride, abs(goal - state.opening))
    edge = edge_control(model, state, front, stride) if stride.lands and not ends else None
    if edge is not None:
        return lead(model, state, edge, lines, stride)
    if forward and (ends or front.calm(model, stride)):
        control = opening_control(model, next_line(state.opening, lines, reach))
        if model.law.irreversible and abs(goal) < abs(state.opening):
            return step(model, state, control, stride)
        reached = step(model, state, control, stride, along_n=front_control.row_n)
        if isinstance(reached, State) and not skipped(model, front, reached, stride):
            return reached
    return lead(model, state, front_control, lines, stride)


def at_kink(model: Model, state: State) -> bool:
    """Whether damage that has paused is just about to grow again."""
    held_q = model.held(state.k_q)
    missing_q = held_q - model.measure(state.g_q)
    soon_q = (held_q > model.onset) & (held_q < model.failure) & (missing_q > 0) & (missing_q < 4 * LANDING * model.unit)
    return bool(model.norm(soon_q.astype(float)) > 0)


def skipped(model: Model, front: Front, reached: State, stride: Stride) -> bool:
    """Whether the gap of the front has changed by more than twice its largest step."""
    change = at(model, front.place, model.measure(reached.g_q)) - front.gap
    return abs(change) > 2 * stride.front * model.unit


def hastens(model: Model, before: State, reached: State | Failure, stride: Stride) -> bool:
    """Whether the damage of a viscous bond grows by more in a step than follows its time; not of the shortest steps."""
    if isinstance(reached, Failure) or (isinstance(stride, Counted) and stride.part <= 0.5 ** (COUNTED_STEPS.halvings - 1)):
        return False
    grows_q = model.damage(reached.k_q) - model.damage(before.k_q)
    return model.comm.allreduce(float(np.max(grows_q, initial=0.0)), MPI.MAX) > COUNTED_STEPS.front


def lead(model: Model, state: State, control: Control, lines: np.ndarray, stride: Stride) -> State | Failure:
    """A step controlled by the front; if it passes or nearly reaches the goal it is repeated to end there."""
    reached = step(model, state, control, stride)
    goal, increment = float(lines[-1]), lines[1] - lines[0]
    if isinstance(reached, State) and reached.opening * goal < 0.0 <= state.opening * goal:
        # the gap of the front can be met on both sides of zero, by pulling and by pressing
        return Failure(f"the path leaps from opening {state.opening:.6g} to {reached.opening:.6g}; {LESS} or {FINER}")
    if isinstance(reached, Failure) or (goal - reached.opening) / increment > NEAR_THE_GOAL:
        return reached
    share = (goal - state.opening) / (reached.opening - state.opening)
    between = state.u_n + share * (reached.u_n - state.u_n), state.load + share * (reached.load - state.load)
    return step(model, state, opening_control(model, goal), stride, between, control.row_n)


def step(
    model: Model,
    state: State,
    control: Control,
    stride: Stride,
    guess: tuple[np.ndarray, float] | None = None,
    along_n: np.ndarray | None = None,
) -> State | Failure:
    """The next converged state with its history committed, or the reason why there is none.

    The tangent that gives the direction of the path also gives one more correction, after which only rounding remains,
    or is made anew for another one until that is so.

    Parameters
    ----------
    guess : displacements and load to start from; default: extrapolated along the tangent of the path.
    along_n : a functional that changes monotonically along the step; default: the prescribed one.
    """
    if control.row_n is model.load_n:
        model = model.in_time(control.value - state.opening)
    if guess is None:
        move = (control.value - model.dot(control.row_n, state.u_n)) / model.dot(control.row_n, state.rate_n)
        guess = state.u_n + move * state.rate_n, state.load + move * state.slope
    u_n, load = guess
    found = equations(model, state, control, stride)
    attempt = find_equilibrium(model, found, u_n, load)
    if not attempt.converged:
        less = f"{LESS} or " if state.opening <= 0.0 and state.heading < 0.0 else ""
        return Failure(
            f"no equilibrium beyond opening {state.opening:.6g} in {attempt.iterations} iterations "
            f"(residual {attempt.residuals[-1]:.1e} of the load), however short the step; {less}{FINER}"
        )
    u_n, load, r_n = attempt.u_n, attempt.load, model.residual(attempt.u_n, attempt.load, state.k_q)
    for corrections in range(1, REFERENCE_PATH.corrections + 1):
        model.factorise(on_arrival(model, state, u_n), state.k_q)
        rate_n, slope = tangent_of_path(model)
        du_n, d_load = bordered_step(model, control, u_n, r_n)
        u_n, load = u_n + du_n, load + d_load
        if not found.early:
            break
        r_n = model.residual(u_n, load, state.k_q)
        scale, target = scale_and_target(model, found, u_n, load)
        if model.norm(r_n) <= max(target, REFERENCE_PATH.closed) * scale:
            break
    else:
        return Failure(f"iterations do not end near opening {state.opening:.6g}, however short the step; {FINER}")
    row_n = control.row_n if along_n is None else along_n
    change = model.dot(row_n, u_n - state.u_n)
    rates = change / model.dot(row_n, state.rate_n), change / model.dot(row_n, rate_n)
    opening = control.value if control.row_n is model.load_n else model.dot(model.load_n, u_n)
    g_q = model.jump(u_n)
    slopes = state.slope, slope
    if model.timed:  # the tangents are those of frozen time
        slopes, rates = chord((state.opening, opening), (state.load, load))
    work = work_along((state.opening, opening), (state.load, load), slopes, rates)
    k_q = model.history(g_q, state.k_q)
    reached = State(
        u_n=u_n,
        load=load,
        opening=opening,
        k_q=k_q,
        g_q=g_q,
        rate_n=rate_n,
        slope=slope,
        heading=float(np.sign(rates[1])),
        peak=max(state.peak, abs(load)),
        work=state.work + work,
        bulk=model.bulk_energy(u_n),
        bond=model.energies_after((state.g_q, state.k_q, state.bond), g_q, k_q),
        iterations=attempt.iterations + corrections,
    )
    if leaps(state, reached):
        return Failure(f"the energy leaps at opening {state.opening:.6g}, however short the step; {FINER}")
    return reached


def leaps(state: State, reached: State) -> bool:
    """Whether the work of a step differs so much from the change of the energy that it has left the path."""
    leak = abs(reached.work - state.work - (reached.energy - state.energy))
    step_work = reached.peak * abs(reached.opening - state.opening)
    return leak > REFERENCE_PATH.leap * max(state.energy, reached.energy, step_work)


def equations(model: Model, state: State, control: Control, stride: Stride) -> Step:
    """The equations of a step that starts from a converged state."""
    return Step(control, state.k_q, state.peak * model.norm(model.load_n), stride.early, stride.patience)


def on_arrival(model: Model, state: State, u_n: np.ndarray) -> np.ndarray:
    """Displacements at which the tangent of a converged step is taken: those found, unless the opening is zero.

    At zero opening the signs of the gaps are rounding; the open and the closed points are then those just before.
    """
    if abs(model.dot(model.load_n, u_n)) > REFERENCE_PATH.ahead * abs(state.opening):
        return u_n
    return u_n + REFERENCE_PATH.ahead * (state.u_n - u_n)


def tangent_of_path(model: Model) -> tuple[np.ndarray, float]:
    """du/d(opening) (n,) and d load/d(opening), by the tangent factorised last."""
    by_load_n = model.solve(model.free_n * model.load_n)
    compliance = model.dot(model.load_n, by_load_n)
    return by_load_n / compliance, 1.0 / compliance


def unloaded(model: Model) -> State:
    """The unloaded specimen; its ``heading`` is 0."""
    u_n, k_q = np.zeros_like(model.load_n), model.intact()
    model.factorise(u_n, k_q)
    rate_n, slope = tangent_of_path(model)
    return State(u_n, 0.0, 0.0, k_q, model.jump(u_n), rate_n, slope, 0.0, 0.0, 0.0, 0.0, BondEnergies(), 0)


def departing(model: Model, state: State, goal: float, stride: Stride, anew: bool = False) -> State:
    """The same state with the tangent of the path that leaves it for a goal.

    Where the programme turns round, and where all gaps are zero, this is not the tangent of the arrival: points whose
    damage grew unload along their secants, gaps open or close. A state slightly ahead tells which. A state that sets out
    the way it has come is returned as it is, unless the tangent is to be made ``anew``.
    """
    heading = float(np.sign(goal - state.opening))
    if heading == state.heading and state.opening != 0.0 and not anew:
        return state
    small = REFERENCE_PATH.ahead * (goal - state.opening)
    guess = state.u_n + small * state.rate_n, state.load + small * state.slope
    control = opening_control(model, state.opening + small)
    ahead = find_equilibrium(model, equations(model, state, control, stride), *guess)
    model.factorise(ahead.u_n if ahead.converged else state.u_n, state.k_q)
    rate_n, slope = tangent_of_path(model)
    return replace(state, rate_n=rate_n, slope=slope, heading=heading)


def separated(model: Model, before: State, state: State, goal: float) -> bool:
    """Whether, after a step on which damage grew, the load is nearly zero and will stay so up to the goal.

    Unloading to zero is no separation: no damage grows, and the load returns along the secants.
    """
    grew_q = model.held(state.k_q) > np.maximum(model.held(before.k_q), model.onset)
    way = float(np.sign(goal))
    gain = max(0.0, way * state.heading * state.slope) * abs(goal - state.opening)
    carried = abs(state.load) + gain
    return (
        way * (goal - state.opening) > 0.0
        and carried < REFERENCE_PATH.separated * state.peak
        and bool(model.norm(grew_q.astype(float)) > 0)
    )
