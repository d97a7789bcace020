"""One step: from a converged state to the next, and the tangent with which a path sets out.

Its external work is of fourth order, also where the opening turns back.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from fem_reference.model.energy import energies_after
from fem_reference.model.linear import Singular
from fem_reference.model.model import BondEnergies, Model
from fem_reference.path.control import Control, opening_control
from fem_reference.path.newton import Attempt, Step, bordered_step, find_equilibrium, scale_and_target
from fem_reference.path.state import Largest, State
from fem_reference.path.stride import Stride

#: Integrals of h_i dh_j/ds over 0 <= s <= 1 for the cubic Hermite polynomials h of (value at 0, value at 1, slope at 0,
#: slope at 1); by parts, the matrix plus its transpose is the outer product of the end values.
HERMITE = np.array([[-30, 30, 6, -6], [-30, 30, -6, 6], [-6, 6, 0, -1], [6, -6, 1, 0]]) / 60.0


def work_along(
    openings: tuple[float, float], loads: tuple[float, float], slopes: tuple[float, float], rates: tuple[float, float]
) -> float:
    """Integral of the load over the opening, both taken as cubics in the prescribed quantity s.

    Where the path turns back, the load is not a function of the opening, but still a function of s.

    Parameters
    ----------
    openings, loads, slopes : opening, load and d load / d opening at both ends.
    rates : d opening / ds at both ends; s goes from 0 to 1 over the step.
    """
    opening_slopes = np.array(rates)
    load_slopes = opening_slopes * slopes
    return float(np.concatenate([loads, load_slopes]) @ HERMITE @ np.concatenate([openings, opening_slopes]))


def chord(openings: tuple[float, float], loads: tuple[float, float]) -> tuple[tuple[float, float], tuple[float, float]]:
    """Slopes and rates for `work_along` of a straight step, where those of the path are not known."""
    way = openings[1] - openings[0]
    return ((loads[1] - loads[0]) / way,) * 2, (way, way)


@dataclass(frozen=True)
class StepSettings:
    """Accuracy of a step, and when two openings count as the same.

    corrections, closed : largest number of corrections, each with a new tangent, after iterations that stop early, and
        the residual over the force scale that they have to reach.
    leap : largest difference between work and change of energy of a step, as a part of the energy, or of the largest
        load times the change of the opening. A step that ended on another branch of equilibrium missed by a quarter of
        the energy; a step along the path misses by 1e-6.
    ahead : distance, as a part of the way to the goal, at which the open and closed points of a departing path are
        determined: too small to change a force, but large enough for gaps above rounding.
    """

    corrections: int = 6
    closed: float = 1e-8
    leap: float = 0.05
    ahead: float = 1e-6


REFERENCE_STEP = StepSettings()

#: Advice for a path that cannot go on, and for bodies that are pressed together.
FINER = "use more elements along the specimen or a higher degree"
LESS = "close by less (load.opening), as bodies that are crushed have no equilibrium,"


@dataclass(frozen=True)
class Failure:
    """A step that did not converge; ``final`` if the run stops because of it."""

    reason: str
    final: bool = False


@dataclass(frozen=True)
class Arrival:
    """A state that satisfies equilibrium and control, and the path through it: du and d load by d opening."""

    u_n: np.ndarray
    load: float
    rate_n: np.ndarray
    slope: float
    iterations: int


def step(
    model: Model,
    state: State,
    control: Control,
    stride: Stride,
    guess: tuple[np.ndarray, float] | None = None,
    along_n: np.ndarray | None = None,
) -> State | Failure:
    """The next converged state with its history committed, or the reason why there is none.

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
    try:
        found = arrive(model, state, equations(model, state, control, stride), guess)
    except Singular:
        return Failure(f"the tangent is singular beyond opening {state.opening:.6g}, however short the step; {FINER}")
    if isinstance(found, Failure):
        return found
    u_n, load, rate_n, slope = found.u_n, found.load, found.rate_n, found.slope
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
        peak=state.peak.with_point(load, opening),
        work=state.work + work,
        bulk=model.bulk_energy(u_n),
        bond=energies_after(model, (state.g_q, state.k_q), state.bond, (g_q, k_q)),
        iterations=found.iterations,
    )
    if leaps(state, reached):
        return Failure(f"the energy leaps at opening {state.opening:.6g}, however short the step; {FINER}")
    return reached


def arrive(model: Model, state: State, equations: Step, guess: tuple[np.ndarray, float]) -> Arrival | Failure:
    """Equilibrium and the path through it.

    The tangent that gives the direction of the path is also used for one more correction, after which only rounding
    remains. After iterations that have stopped early, corrections with new tangents follow until the residual is below
    `StepSettings.closed`; a last correction with the same tangent leaves rounding. If they do not reach it, everything
    is repeated without stopping early.
    """
    attempt = find_equilibrium(model, equations, *guess)
    if not attempt.converged:
        return _no_equilibrium(model, state, attempt)
    u_n, load, r_n = attempt.u_n, attempt.load, model.residual(attempt.u_n, attempt.load, state.k_q)
    for more in range(1, REFERENCE_STEP.corrections + 1):
        model.factorise(on_arrival(model, state, equations, u_n), state.k_q)
        rate_n, slope = tangent_of_path(model)
        du_n, d_load = bordered_step(model, equations.control, u_n, r_n)
        u_n, load = u_n + du_n, load + d_load
        arrival = Arrival(u_n, load, rate_n, slope, attempt.iterations + more)
        if not equations.early:
            return arrival
        r_n = model.residual(u_n, load, state.k_q)
        scale, target = scale_and_target(model, equations, u_n, load)
        if model.norm(r_n) <= max(target, REFERENCE_STEP.closed) * scale:
            du_n, d_load = bordered_step(model, equations.control, u_n, r_n)
            return replace(arrival, u_n=u_n + du_n, load=load + d_load)
    return arrive(model, state, replace(equations, early=0.0, patience=True), guess)


def _no_equilibrium(model: Model, state: State, attempt: Attempt) -> Failure:
    presses = state.opening < 0.0 and state.heading < 0.0
    return Failure(
        f"no equilibrium beyond opening {state.opening:.6g} in {attempt.iterations} iterations "
        f"(residual {attempt.residuals[-1]:.1e} of the load), however short the step; {advice(model, presses)}"
    )


def advice(model: Model, presses: bool) -> str:
    """What to change where a path ends. Only loads that pull the arms apart crush them below zero."""
    return f"{LESS} or {FINER}" if presses and not model.specimen.pulls else FINER


def leaps(state: State, reached: State) -> bool:
    """Whether the work of a step differs so much from the change of the energy that it has left the path."""
    leak = abs(reached.work - state.work - (reached.energy - state.energy))
    step_work = reached.peak.load * abs(reached.opening - state.opening)
    return leak > REFERENCE_STEP.leap * max(state.energy, reached.energy, step_work)


def equations(model: Model, state: State, control: Control, stride: Stride) -> Step:
    """The equations of a step that starts from a converged state."""
    return Step(control, state.k_q, state.peak.load * model.norm(model.load_n), stride.early, stride.patience)


def on_arrival(model: Model, state: State, equations: Step, u_n: np.ndarray) -> np.ndarray:
    """Displacements at which the tangent of a converged step is taken: those found, unless the opening is zero.

    At zero opening the signs of the gaps are rounding; open and closed points are then those of the equilibrium just
    before. The chord of a long step has others: arms that turn or slide open faces along it that stay closed.
    """
    before = REFERENCE_STEP.ahead * state.opening
    if abs(model.dot(model.load_n, u_n)) > abs(before):
        return u_n
    guess = u_n + REFERENCE_STEP.ahead * (state.u_n - u_n), before * state.slope
    near = replace(equations, control=opening_control(model, before), early=0.0, patience=True)
    found = find_equilibrium(model, near, *guess)
    return found.u_n if found.converged else guess[0]


def tangent_of_path(model: Model) -> tuple[np.ndarray, float]:
    """du/d(opening) (n,) and d load/d(opening), by the tangent factorised last."""
    by_load_n = model.solve(model.free_n * model.load_n)
    compliance = model.dot(model.load_n, by_load_n)
    return by_load_n / compliance, 1.0 / compliance


def unloaded(model: Model) -> State:
    """The unloaded specimen; its ``heading`` is 0."""
    u_n, k_q = np.zeros_like(model.load_n), model.law.intact(model.bonded_q)
    model.factorise(u_n, k_q)
    rate_n, slope = tangent_of_path(model)
    return State(u_n, 0.0, 0.0, k_q, model.jump(u_n), rate_n, slope, 0.0, Largest(), 0.0, 0.0, BondEnergies(), 0)


def departing(model: Model, state: State, goal: float, stride: Stride, anew: bool = False) -> State:
    """The same state with the tangent of the path that leaves it for a goal.

    Where the programme turns round, and where all gaps are zero, it differs from the tangent of the arrival: points
    whose damage grew unload along their secants, gaps open or close. A state slightly ahead shows which points do; it
    is searched for with patience where faces touch all at once, as no shorter step makes that easier. A state whose
    path goes on in the same direction is returned unchanged, unless its tangent is to be made ``anew``.
    """
    heading = float(np.sign(goal - state.opening))
    if heading == state.heading and state.opening != 0.0 and not anew:
        return state
    small = REFERENCE_STEP.ahead * (goal - state.opening)
    guess = state.u_n + small * state.rate_n, state.load + small * state.slope
    control = opening_control(model, state.opening + small)
    ahead_of = equations(model, state, control, stride)
    if state.opening == 0.0 and model.specimen.touching:
        ahead_of = replace(ahead_of, patience=True)
    try:
        ahead = find_equilibrium(model, ahead_of, *guess)
        model.factorise(ahead.u_n if ahead.converged else state.u_n, state.k_q)
    except Singular:  # the step tells, if it fails as well
        return replace(state, heading=heading)
    rate_n, slope = tangent_of_path(model)
    return replace(state, rate_n=rate_n, slope=slope, heading=heading)
