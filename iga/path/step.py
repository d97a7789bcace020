"""One step of the path: its prediction, the equilibrium, and what the step has cost in energy."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from iga.interface.contact import Contact
from iga.path.control import Prescribed, gap_control
from iga.path.energy import by_chords, dissipating, step_work, straight_work
from iga.path.kinks import (
    SEVERAL,
    Kink,
    Run,
    StepEnd,
    broken_between,
    first_end,
    nearest_end,
    run_to,
    slope_over_arcs,
)
from iga.path.newton import Equilibrium, correction, equilibrium
from iga.path.point import Point
from iga.path.solver import Solver
from iga.path.step_length import Step, grows
from iga.path.tangent import Tangent, in_time, tangent
from iga.system.state import Response, State
from iga.system.system import System, energies

#: Openings below this part of the one before count as zero.
CLOSED = 1e-9
#: The front leaps where it opens by more than this part of g_u: gaps then travel rather than grow along the tangent.
LEAP = 0.1


@dataclass(frozen=True)
class Prediction:
    """Where the search for equilibrium begins, and the kink at which the step is to end, if any.

    ``settled``: all tractions are on the law there, with the bulk linearised. ``spent`` are the residuals of the
    iterations of the prediction.
    """

    state: State
    settled: bool = False
    end: StepEnd | None = None
    spent: tuple[float, ...] = ()


def predicted(solver: Solver, point: Point, asked: Step) -> Prediction:
    """Prediction along the tangent; if its factors are still kept and the bond only opens, Newton on the gaps puts all
    tractions on the law.

    The factors are dropped.
    """
    system, path, known = solver.system, point.tangent, solver.linearised
    old = replace(point.state, dt=asked.dt)
    if asked.near is not None:
        solver.drop()
        return Prediction(asked.near)
    along_d = asked.away * np.append(path.du_d, path.d_load)
    if system.interface.slides:
        return Prediction(old.moved(_run_on(solver, point, asked, along_d)))
    if known is None:
        solver.drop()
        return Prediction(old.moved(along_d))
    response, touch = known.response, known.response.contact
    value, a_d, a_load = asked.control(old, response)
    target = value + float(a_d @ along_d[:-1]) + a_load * along_d[-1]
    goal, end, run = Prescribed(asked.control, target, target - value), None, _leaping(system, point, asked)
    guess_q = None if run is None else run.travelled(touch.g_q)
    # the kink is chosen along the tangent: any kink near will do, and with a linear bulk the step onto it is exact
    ahead_q = response.x_q + asked.away * path.rate_q if guess_q is None and system.linear else guess_q
    if asked.to_kink and ahead_q is not None:
        end = _end(system, point, asked, touch, ahead_q)
    if end is not None:
        goal = _onto(system, point, end)
    found = correction(solver, old, response, goal, True, guess_q)
    if found is not None and found[1] and asked.to_kink and end is None:
        guess_q = response.x_q + response.x_rates(found[0][:-1])
        end = _end(system, point, asked, touch, guess_q)
        if end is not None and system.linear:  # exact then; otherwise Newton follows anyway
            onto = correction(solver, old, response, _onto(system, point, end), True, guess_q)
            found = onto if onto is not None and onto[1] else found
    solver.drop()
    if found is None or not found[1]:
        return Prediction(old.moved(along_d))
    return Prediction(old.moved(found[0]), True, end)


def advance(solver: Solver, point: Point, asked: Step, direction: float) -> Point | None:
    """The point where a step ends, or None where it fails; its history is committed only after convergence.

    The solver keeps the factors of its tangent.
    """
    system, old, path, control = solver.system, point.state, point.tangent, asked.control
    value, a_d, a_load = control(old, point.response)
    rate = float(a_d @ path.du_d) + a_load * path.d_load
    if rate == 0.0:  # the control does not change along the tangent
        return None
    change = rate * asked.away
    converged = _converged(solver, point, asked, Prescribed(control, value + change, change))
    if converged is None:
        return None
    found, kink = converged
    state, response = _committed(solver, point, asked, found)
    if grows(old, state) > asked.growth:
        return None
    if asked.dt:
        leaving = in_time(solver, state, asked.dt, direction)
    else:
        leaving = tangent(solver, state, response, direction, kink=kink)
    if leaving is None:
        return None
    opening = float(system.load_d @ state.u_d)
    if asked.dt:  # the tangent is that of one step, and no slope of the curve
        leaving = replace(leaving, slope=(state.load - old.load) / (opening - point.opening))
    broken = broken_between(system, old, state) if asked.by_kinks else 0
    leaving = _smoothed(point, asked, leaving, broken, (opening, state.load))
    before = (point.opening, old.load) if broken else None
    reached = Point(state, response, opening, leaving, 0.0, point.energies, found.residuals, before)
    there, b_d, b_load = control(state, response)
    end_rate = float(b_d @ leaving.du_d) + b_load * leaving.d_load
    if end_rate == 0.0:
        return None
    away, back = (there - value) / rate, (there - value) / end_rate
    if by_chords(system):
        work = 0.5 * (point.state.load + state.load) * (opening - point.opening)
    elif asked.by_kinks and point.heading == leaving.heading == np.sign(opening - point.opening):
        work = straight_work(point, reached, broken >= SEVERAL)
    else:
        work = step_work(system, point, reached, away, back)
    state = dissipating(system, point, reached, (away, back))
    spent = energies(system, state, response)
    return replace(reached, state=state, external_work=point.external_work + work, energies=spent)


def _converged(solver: Solver, point: Point, asked: Step, goal: Prescribed) -> tuple[Equilibrium, Kink | None] | None:
    """Equilibrium where the step ends, and the kink it ends on, if any."""
    ahead = predicted(solver, point, asked)
    if asked.to_kink and not ahead.settled:
        nearly = equilibrium(solver, ahead.state, goal, solver.newton.predicting)
        if nearly is None:
            return None
        touch = nearly.response.contact
        end = _end(solver.system, point, asked, touch, nearly.response.x_q)
        ahead = Prediction(nearly.state, True, end, nearly.residuals)
    found, kink = None, None
    if ahead.end is not None:
        found = _at_kink(solver, point, ahead.state, ahead.end)
        kink = ahead.end.kink if found is not None and ahead.end.on else None
    if found is None:
        found = equilibrium(solver, ahead.state, goal)
    return None if found is None else (replace(found, residuals=ahead.spent + found.residuals), kink)


def _at_kink(solver: Solver, point: Point, trial: State, end: StepEnd) -> Equilibrium | None:
    """Equilibrium at the end of a step; None where there is none, or where it has not reached the kink."""
    found = equilibrium(solver, trial, _onto(solver.system, point, end))
    return None if found is None or found.response.x_q[end.kink.q] < end.kink.gap else found


def _onto(system: System, point: Point, end: StepEnd) -> Prescribed:
    """The gap at the kink as the control of a step from a point."""
    change = end.target - float(point.response.x_q[end.kink.q])
    return Prescribed(gap_control(system, end.kink.q), end.target, change)


def _end(system: System, point: Point, asked: Step, touch: Contact, g_q: np.ndarray) -> StepEnd | None:
    """The kink at which a step from a point to the gaps g_q (n_q,) is to end."""
    if asked.every_kink:
        return first_end(system, point.state, point.response, touch, g_q)
    history_q = point.response.back_q
    return nearest_end(system, history_q, touch, g_q, follows_on=point.before is not None)


def _leaping(system: System, point: Point, asked: Step) -> Run | None:
    """How far the crack runs on a leap of its front; None where it does not leap."""
    q, path, x_q = point.front, point.tangent, point.response.x_q
    opens = asked.away * path.rate_q[q] if path.growing_q[q] else 0.0
    return run_to(system.interface, x_q, q, x_q[q] + opens) if opens > LEAP * system.interface.law.span else None


def _run_on(solver: Solver, point: Point, asked: Step, along_d: np.ndarray) -> np.ndarray:
    """Step (n_dof + 1,) of displacements and load of a bond that slides, where its crack runs on: the damage travels
    and is kept, so that the bond is a secant one, and its tangent gives the step. Where the front does not leap the
    step goes along the tangent."""
    old, run = point.state, _leaping(solver.system, point, asked) if asked.by_kinks else None
    solver.drop()
    if run is None:
        return along_d
    ahead = replace(old, k_q=np.maximum(old.k_q, run.travelled(old.k_q)))
    response = solver.respond(ahead, decide=False)
    if solver.factorise(response) is None:
        return along_d
    value, a_d, a_load = asked.control(old, point.response)
    target = value + float(a_d @ along_d[:-1]) + a_load * along_d[-1]
    found = correction(solver, ahead, response, Prescribed(asked.control, target, target - value), False)
    solver.drop()
    return along_d if found is None else found[0]


def _committed(solver: Solver, point: Point, asked: Step, found: Equilibrium) -> tuple[State, Response]:
    """The state with the history that it leaves, and the response to it."""
    old, state, response = point.state, found.state, found.response
    if asked.exact and abs(float(solver.system.load_d @ state.u_d)) <= CLOSED * abs(point.opening):
        # closed specimen: the signs of its gaps are rounding, so contact stays as it was before
        state = replace(state, closed_q=old.closed_q)
        response = solver.respond(replace(state, k_q=old.k_q), decide=False)
    after, scale = response.pull.history, max(old.scale, response.scale)
    return replace(state, k_q=after.d, slip_q=after.slip, scale=scale), response


def _smoothed(point: Point, asked: Step, leaving: Tangent, broken: int, end: tuple[float, float]) -> Tangent:
    """The tangent with a slope that draws a smooth curve through opening and load at the ``end`` of a step.

    ``broken`` points have broken on the step.
    """
    if leaving.arrival * leaving.departure < 0.0 and leaving.came == leaving.heading:
        leaving = replace(leaving, slope=0.0)  # a top or a foot, where any other slope would overshoot on one side
    over_arcs = broken >= SEVERAL or (broken and leaving.rough and not asked.every_kink)
    if over_arcs and point.before is not None:
        slope = slope_over_arcs(point.before, (point.opening, point.state.load), end)
        leaving = leaving if slope is None else replace(leaving, slope=slope)
    return leaving
