"""The path of equilibrium along the load programme, in increments of the opening: predictor, control, Newton, step
length, end.
"""

from __future__ import annotations

from collections.abc import Generator, Iterator
from dataclasses import dataclass, replace

import numpy as np
from mpi4py import MPI

from fem_reference.model.model import Model
from fem_reference.path.control import LANDING, Control, Front, at, edge_control, front_of, opening_control
from fem_reference.path.state import Largest, State
from fem_reference.path.step import FINER, Failure, advice, departing, step, unloaded
from fem_reference.path.stride import CHOSEN_STEPS, COUNTED_STEPS, Chosen, Counted, Stride, chosen
from fem_reference.problem.problem import Debonding

#: A step that ends within this part of an increment of its goal is extended to the goal.
NEAR_THE_GOAL = 0.01


def branches(problem: Debonding, whole: bool = False) -> list[np.ndarray]:
    """Ends of equal increments of the opening, about ``steps`` over the whole programme, one array per branch.

    With ``whole``, for paths that choose their steps, each branch is one increment. A branch also ends where the
    programme passes through zero, as all gaps of an unloaded bond open or close there.
    """
    goals = np.concatenate([[0.0], problem.opening])
    crossed = np.flatnonzero(goals[1:] * goals[:-1] < 0.0)
    corners = np.insert(goals, crossed + 1, 0.0)
    ways = np.abs(np.diff(corners))
    steps = 0 if whole else problem.steps or COUNTED_STEPS.instead
    counts = np.maximum(1, np.rint(steps * ways / ways.sum()).astype(int))
    parts = zip(corners[:-1], corners[1:], counts, ways, strict=True)
    return [np.linspace(start, end, n + 1) for start, end, n, way in parts if way > 0]


def next_line(opening: float, lines: np.ndarray, reach: float) -> float:
    """Opening at the end of the next increment, or nearer, as far as a step may reach."""
    way = (lines - opening) / (lines[1] - lines[0])
    line = float(lines[np.argmax(way > NEAR_THE_GOAL)]) if way[-1] > NEAR_THE_GOAL else float(lines[-1])
    left = line - opening
    return line if abs(left) <= reach * (1 + NEAR_THE_GOAL) else opening + float(np.copysign(reach, left))


@dataclass(frozen=True)
class PathSettings:
    """When a path ends.

    steps : steps towards one goal after which the run stops.
    separated : load, as a part of the peak, below which a specimen whose damage grew has separated.
    """

    steps: int = 20_000
    separated: float = 1e-3


REFERENCE_PATH = PathSettings()

#: Why a step is repeated: of a viscous bond, and with steps by accuracy.
TOO_FAST = "damage grows too much in one step"
TOO_LONG = "the curve is not accurate on so long a step"


@dataclass(frozen=True)
class Separation:
    """The end of a path: the bond no longer carries load."""

    opening: float


def path(model: Model) -> Iterator[State | Failure | Separation]:
    """Converged states along the programme and the failures in between, up to a final failure or a separation."""
    state, by_accuracy = unloaded(model), model.problem.steps is None and not model.timed
    way = model.problem.way
    stride: Stride = chosen(way, model.problem.bend, way / float(np.max(np.abs(model.problem.opening))))
    side, peaks = 1.0, {-1.0: Largest(), 1.0: Largest()}
    for lines in branches(model.problem, whole=by_accuracy):
        first, before, side = state.heading == 0.0, side, float(np.sign(lines[0] + lines[-1]))
        if not by_accuracy:
            stride = Counted(abs(lines[1] - lines[0]))
        elif side != before:  # faces are seldom pressed as far as they open
            stride = replace(stride, reach=CHOSEN_STEPS.first * abs(lines[-1] - lines[0]))
        state = departing(model, replace(state, peak=peaks[side]), lines[-1], stride)
        if first:
            yield state
        end = yield from reach(model, state, lines, stride)
        if end is None:
            return
        state, stride = end
        peaks[side] = state.peak


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
        state = point
        if isinstance(stride, Chosen) and at_kink(model, point):
            state, stride = departing(model, point, goal, stride, anew=True), stride.past_kink()
    yield Failure(
        f"the path did not come from opening {state.opening:.6g} to {goal:.6g} in {REFERENCE_PATH.steps} steps; "
        f"{FINER}",
        final=True,
    )
    return None


def advance(model: Model, state: State, lines: np.ndarray, stride: Stride) -> State | Failure:
    """One step: to the next end of an increment, or controlled by the front where damage grows fast.

    States before and after a snap-back can have the same opening. If the front has moved much further than its largest
    step, the step has missed the path between them and is repeated with control by the front. This is not done on
    unloading with irreversible damage, where control by the front would lead back along the path of loading.
    """
    goal, reach = float(lines[-1]), stride.reach
    front = None if model.timed else front_of(model, state, reach)
    ahead = goal > state.opening
    if front is None:
        state = departing(model, state, goal, stride)
        reached = step(model, state, opening_control(model, next_line(state.opening, lines, reach)), stride)
        return Failure(TOO_FAST) if model.timed and hastens(model, state, reached, stride) else reached
    if model.law.irreversible and abs(goal) < abs(state.opening):
        return step(model, state, opening_control(model, next_line(state.opening, lines, reach)), stride)
    front_control, forward = front.control(model, stride), (state.heading > 0) == ahead
    ends = stride.lands and front.within(model, stride, abs(goal - state.opening))
    edge = edge_control(model, state, front, stride) if stride.lands and not ends else None
    if edge is not None:
        return lead(model, state, edge, lines, stride)
    if forward and (ends or front.calm(model, stride) and not (stride.lands and cracked(model, state))):
        control = opening_control(model, next_line(state.opening, lines, reach))
        reached = step(model, state, control, stride, along_n=front_control.row_n)
        if isinstance(reached, State) and not skipped(model, front, reached, stride):
            return reached
    return lead(model, state, front_control, lines, stride)


def cracked(model: Model, state: State) -> bool:
    """Whether any point of the bond is open."""
    return bool(model.norm((model.bonded_q & (model.law.held(state.k_q) >= model.law.failed)).astype(float)) > 0)


def at_kink(model: Model, state: State) -> bool:
    """Whether damage that has paused is just about to grow again."""
    held_q = model.law.held(state.k_q)
    missing_q = held_q - model.measure(state.g_q)
    soon_q = (
        (held_q > model.law.begun)
        & (held_q < model.law.failed)
        & (missing_q > 0)
        & (missing_q < 4 * LANDING * model.law.unit)
    )
    return bool(model.norm(soon_q.astype(float)) > 0)


def skipped(model: Model, front: Front, reached: State, stride: Stride) -> bool:
    """Whether the gap of the front has changed by more than twice its largest step."""
    change = at(model, front.place, model.measure(reached.g_q)) - front.gap
    return abs(change) > 2 * stride.front * model.law.unit


def hastens(model: Model, before: State, reached: State | Failure, stride: Stride) -> bool:
    """Whether the damage at a point of a viscous bond grows by more than `CountedSteps.front` in a step; never for the
    shortest steps."""
    if isinstance(reached, Failure) or (
        isinstance(stride, Counted) and stride.part <= 0.5 ** (COUNTED_STEPS.halvings - 1)
    ):
        return False
    grows_q = model.damage(reached.k_q) - model.damage(before.k_q)
    return model.comm.allreduce(float(np.max(grows_q, initial=0.0)), MPI.MAX) > COUNTED_STEPS.front


def lead(model: Model, state: State, control: Control, lines: np.ndarray, stride: Stride) -> State | Failure:
    """A step controlled by the front; if it passes or nearly reaches the goal it is repeated to end there."""
    reached = step(model, state, control, stride)
    goal, increment = float(lines[-1]), lines[1] - lines[0]
    if isinstance(reached, State) and astray(state, reached, lines):
        crosses = reached.opening * goal < 0.0
        return Failure(
            f"the path leaps from opening {state.opening:.6g} to {reached.opening:.6g}; {advice(model, crosses)}"
        )
    if isinstance(reached, Failure):
        return reached
    # with steps by accuracy a branch is one increment: there the length of the step counts
    near = abs(increment if isinstance(stride, Counted) else reached.opening - state.opening)
    if (goal - reached.opening) * np.sign(increment) > NEAR_THE_GOAL * near:
        return reached
    share = (goal - state.opening) / (reached.opening - state.opening)
    between = state.u_n + share * (reached.u_n - state.u_n), state.load + share * (reached.load - state.load)
    return step(model, state, opening_control(model, goal), stride, between, control.row_n)


def astray(before: State, reached: State, lines: np.ndarray) -> bool:
    """Whether a step by the front has left the branch: across zero, or away from its goal on unloading.

    One gap of the front can belong to states on both sides of zero, by pulling and by pressing. No state on the way
    back is further open than the one where the programme turned round.
    """
    start, goal = float(lines[0]), float(lines[-1])
    crosses = reached.opening * goal < 0.0 <= before.opening * goal
    return crosses or (abs(goal) < abs(start) < abs(reached.opening) and reached.opening * start > 0.0)


def separated(model: Model, before: State, state: State, goal: float) -> bool:
    """Whether, after a step on which damage grew, the load is nearly zero and will stay so up to the goal.

    Unloading to zero is no separation: no damage grows, and the load returns along the secants.
    """
    grew_q = model.law.held(state.k_q) > np.maximum(model.law.held(before.k_q), model.law.begun)
    way = float(np.sign(goal))
    gain = max(0.0, way * state.heading * state.slope) * abs(goal - state.opening)
    carried = abs(state.load) + gain
    return (
        way * (goal - state.opening) > 0.0
        and carried < REFERENCE_PATH.separated * state.peak.load
        and bool(model.norm(grew_q.astype(float)) > 0)
    )
