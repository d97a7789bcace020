"""One step of the path: what is foreseen, the equilibrium, and what the step has cost in energy."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from iga.interface.interface import Contact
from iga.path.control import gap_control
from iga.path.energy import slid_off, step_work, straight_work
from iga.path.kinks import SEVERAL, Kink, Landing, broken_between, landing, next_kink, slope_over_arcs, travelled
from iga.path.newton import Equilibrium, Newton, correction, equilibrium, roughly
from iga.path.point import Point
from iga.path.step_length import Pace, Step
from iga.path.tangent import Linearised, tangent
from iga.system.state import State
from iga.system.system import Phase, System, energies, respond

#: An opening that is this part of the one before is none.
HOME = 1e-9
#: The front leaps where it opens by more than this part of g_u: gaps then travel rather than grow along the tangent.
LEAP = 0.1


@dataclass(frozen=True)
class Foreseen:
    """Where a step sets out for equilibrium, and the kink it is to end at, if any; ``settled``: with the law as it is.

    ``spent`` are the residuals of the iterations that this has taken.
    """

    state: State
    settled: bool = False
    place: Landing | None = None
    spent: tuple[float, ...] = ()


def foresee(
    system: System,
    point: Point,
    asked: Step,
    by_kinks: bool,
    known: Linearised | None,
    phase: Phase,
) -> Foreseen:
    """Along the tangent; where its inverse is still known, with what the law makes of the step, the bulk as it is."""
    old, path = point.state, point.tangent
    along_d = asked.away * np.append(path.du_d, path.d_load)
    if known is None:
        return Foreseen(old.moved(along_d))
    response, touch, control = known.response, known.response.contact, asked.control
    value, a_d, a_load = control(old, response)
    target = value + float(a_d @ along_d[:-1]) + a_load * along_d[-1]
    guess_q, place = None, None
    linear = system.kinematics == "linear"
    with phase("solve"):
        q = point.front
        opens = asked.away * path.rate_q[q] if path.growing_q[q] else 0.0
        if opens > LEAP * system.interface.law.g_u:
            guess_q = travelled(system.interface, touch.g_q, q, touch.g_q[q] + opens)
        # one kink is as good as the next one; of a linear bulk the step onto it is exact, and no other is made
        ahead_q = touch.g_q + asked.away * path.rate_q if guess_q is None and linear else guess_q
        if by_kinks and ahead_q is not None:
            place = _place(system, point, touch, ahead_q, asked.every_kink)
        if place is not None:
            control, target = gap_control(system, place.q), place.target
        found = correction(system, old, response, known.inverse, control, target, True, guess_q)
    if found is None or not found[1]:
        return Foreseen(old.moved(along_d))
    if by_kinks and place is None:
        guess_q = touch.g_q + touch.rates(found[0][:-1])
        place = _place(system, point, touch, guess_q, asked.every_kink)
        if place is not None and linear:  # this is exact then; else Newton is needed anyway
            control = gap_control(system, place.q)
            with phase("solve"):
                onto = correction(system, old, response, known.inverse, control, place.target, True, guess_q)
            found = onto if onto is not None and onto[1] else found
    return Foreseen(old.moved(found[0]), True, place)


def advance(
    system: System,
    point: Point,
    asked: Step,
    foreseen: Foreseen,
    direction: float,
    pace: Pace,
    newton: Newton,
    phase: Phase,
) -> tuple[Point, Linearised] | tuple[None, None]:
    """The point where a step ends, and its tangent's inverse; nothing is committed before it converged."""
    old, path, control = point.state, point.tangent, asked.control
    value, a_d, a_load = control(old, point.response)
    rate = float(a_d @ path.du_d) + a_load * path.d_load
    if rate == 0.0:  # what stands still leads nowhere
        return None, None
    change = rate * asked.away
    found, kink = None, None
    if pace.by_kinks and not asked.exact:
        if not foreseen.settled:
            nearly = equilibrium(system, foreseen.state, control, value + change, change, roughly(newton), phase)
            if nearly is None:
                return None, None
            touch = nearly.response.contact
            place = _place(system, point, touch, touch.g_q, asked.every_kink)
            foreseen = Foreseen(nearly.state, True, place, nearly.residuals)
        if foreseen.place is not None:
            found, kink = _landed(system, point, foreseen.state, foreseen.place, newton, phase)
    if found is None:
        found = equilibrium(system, foreseen.state, control, value + change, change, newton, phase)
    if found is None:
        return None, None
    state, response = found.state, found.response
    opening = float(system.load_d @ state.u_d)
    if asked.exact and abs(opening) <= HOME * abs(point.opening):
        # nothing has a gap here whose sign means anything: contact is what it was on the way
        state = replace(state, closed_q=old.closed_q)
        response = respond(system, replace(state, k_q=old.k_q), decide=False)
    state = replace(state, k_q=response.k_q, scale=max(old.scale, response.scale))
    left = tangent(system, state, response, direction, phase, kink=kink)
    if left is None:
        return None, None
    leaving, known = left
    broken = broken_between(system, old, state) if pace.by_kinks else 0
    if leaving.arrival * leaving.departure < 0.0 and leaving.came == leaving.heading:
        leaving = replace(leaving, slope=0.0)  # a top or a foot, where any other slope would overshoot on one side
    before = (point.opening, old.load) if broken else None
    if (broken >= SEVERAL or (broken and leaving.rough and not asked.every_kink)) and point.before is not None:
        slope = slope_over_arcs(point.before, (point.opening, old.load), (opening, state.load))
        leaving = leaving if slope is None else replace(leaving, slope=slope)
    residuals = foreseen.spent + found.residuals
    reached = Point(state, response, opening, leaving, 0.0, energies(system, state, response), residuals, before)
    there, b_d, b_load = control(state, response)
    end_rate = float(b_d @ leaving.du_d) + b_load * leaving.d_load
    if end_rate == 0.0:
        return None, None
    away, back = (there - value) / rate, (there - value) / end_rate
    if pace.by_kinks and point.heading == leaving.heading == np.sign(opening - point.opening):
        work = straight_work(point, reached, broken >= SEVERAL)
    else:
        work = step_work(system, point, reached, away, back)
    slid = slid_off(system, point, reached, away, back)
    if slid:
        spent = replace(reached.energies, dissipated=reached.energies.dissipated + slid)
        reached = replace(reached, state=replace(state, slid=old.slid + slid), energies=spent)
    return replace(reached, external_work=point.external_work + work), known


def _place(system: System, point: Point, touch: Contact, g_q: np.ndarray, every: bool) -> Landing | None:
    """Where a step from a point to the gaps g_q (n_q,) is to end."""
    if every:
        return next_kink(system, point.state, point.response.contact, touch, g_q)
    return landing(system, point.state, touch, g_q, follows_on=point.before is not None)


def _landed(
    system: System, point: Point, trial: State, place: Landing, newton: Newton, phase: Phase
) -> tuple[Equilibrium | None, Kink | None]:
    """Equilibrium at a kink; None where there is none."""
    change = place.target - point.response.contact.g_q[place.q]
    there = equilibrium(system, trial, gap_control(system, place.q), place.target, change, newton, phase)
    if there is None or there.response.contact.g_q[place.q] < place.least:
        return None, None
    return there, place.kink
