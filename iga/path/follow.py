"""The equilibrium path: predictor along the tangent, choice of the control, step length, programme, end.

While damage grows the opening of the cohesive front is prescribed, so that the path is followed through snap-backs;
otherwise the opening of the specimen is. Where a step fails, the next one ends at the next kink of the law: from kink
to kink a path has few surprises, and with a law that is linear between them none.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace

import numpy as np

from iga.path.control import opening_control
from iga.path.energy import leaks
from iga.path.newton import DEFAULT, PATIENT, Equilibrium, Newton, equilibrium
from iga.path.point import End, Point
from iga.path.polyline import KEPT, Largest, judged
from iga.path.step import advance, foresee
from iga.path.step_length import BEND, CUTS, Step, next_step, paced
from iga.path.tangent import Linearised, tangent
from iga.system.state import State
from iga.system.system import Phase, System, energies, respond, untimed

#: A specimen has separated when its load, and all that the path could bring back, is below this part of the peak.
SEPARATED = 1e-3
#: A state as good as the one where the path departs is this part of the opening, or of g_max, ahead.
TRIFLE = 1e-6
#: Parts of the penalty with which contact is searched for, one after the other, where it is too stiff to be found.
SOFTER = (1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 1e-1, 1.0)


def follow(
    system: System,
    programme: Sequence[float],
    steps: int | None,
    newton: Newton = DEFAULT,
    phase: Phase = untimed,
    renew: Callable[[Point], tuple[System, State] | None] | None = None,
    bend: float = BEND,
) -> Iterator[Point | End]:
    """Walk through a programme of openings; yields every converged `Point` and, last, the `End`.

    Parameters
    ----------
    programme : openings to be reached one after the other, from zero.
    steps : number of steps asked for over the whole programme; None lets the path choose them, few and by accuracy,
        and so does a number too small to draw the curve. A step that fails is made to end at the next kink of the law,
        then tried with other controls, then halved, down to 1/4096, and grows again afterwards.
    bend : by how much of the peak the load may leave the tangent of a step that the path chooses; what such a step
        keeps (see `iga.path.polyline`) follows from it.
    renew : may answer a converged point with another system, and its state in equilibrium at the same opening.
    """
    pace = paced(np.array(programme), steps, bend, system.kinematics == "linear")
    reach = float(np.max(np.abs(programme)))
    rejected, largest = 0, Largest()
    direction = float(np.sign(programme[0]))
    departed = _departing(system, system.start(), direction, 0.0, phase)
    if departed is None:
        raise ValueError("the system is singular: the supports or the interface do not hold the bodies")
    known: Linearised | None
    point, known = departed
    yield point
    for goal in by_way_of_zero(programme):
        if direction * (goal - point.opening) < 0.0 or (point.opening == 0.0 and point.iterations > 0):
            direction = float(np.sign(goal - point.opening))
            point, known = _departing(system, point.state, direction, point.external_work, phase) or (point, None)
        while point.opening != goal:
            asked = next_step(system, point, goal, pace, direction)
            length = asked.away * float(system.load_d @ point.tangent.du_d)
            foreseen, known = (
                foresee(system, point, asked, pace.by_kinks and not asked.exact, known, phase),
                None,
            )  # of all that is held the largest
            reached, known = advance(system, point, asked, foreseen, direction, pace, newton, phase)
            if reached is not None and direction * (reached.opening - goal) > 0.0 and not asked.exact:
                asked, known = _onto(system, point, goal), None
                foreseen = foresee(system, point, asked, False, None, phase)
                reached, known = advance(system, point, asked, foreseen, direction, pace, newton, phase)
            kept = KEPT
            if reached is not None and pace.promised:
                kept = judged(system, point, reached, largest, pace.bend)
            if kept.part < 1.0 and pace.cuts < CUTS:
                known, rejected = None, rejected + 1  # before the next one is made
                pace = pace.cut(kept, length)
                known = _once_more(system, point, direction, phase) if pace.by_kinks else None
                continue
            if reached is None or leaks(system, point, reached, largest.work):
                known = None  # before the next one is made
                rejected, pace = rejected + 1, pace.slower()
                known = _once_more(system, point, direction, phase) if pace.by_kinks else None
                if pace.exhausted:
                    yield End(_advice(point, leapt=reached is not None), rejected)
                    return
                continue
            largest = largest.with_point(reached)
            pace = pace.after(point, reached, largest.load, kept)
            point = replace(reached, opening=goal) if asked.exact else reached
            yield point
            if direction * point.opening > 0.0 and _separated(system, point, reach, largest.load, direction):
                yield End("complete", rejected, separated=True)
                return
            renewed = renew(point) if renew is not None else None
            if renewed is not None:
                system, state = renewed
                departed = _departing(system, state, direction, point.external_work, phase)
                if departed is None:
                    yield End(f"stopped: the new mesh at opening {goal:.6g} has a singular tangent", rejected)
                    return
                point, known = departed
    yield End("complete", rejected)


def by_way_of_zero(programme: Sequence[float]) -> tuple[float, ...]:
    """The programme with a stop wherever it passes through zero: there all points of an unloaded interface touch."""
    way, here = [], 0.0
    for goal in programme:
        way += [0.0, goal] if here * goal < 0.0 else [goal]
        here = goal
    return tuple(way)


def _separated(system: System, point: Point, reach: float, peak: float, direction: float) -> bool:
    """Most of the bond is broken, and nothing is left that carries: no load, and none that the path is to bring.

    Pressing may pry a bond open as pulling does.
    """
    interface = system.interface
    area_q = interface.dA_q if interface.bonded_q is None else interface.dA_q * interface.bonded_q
    broken = float(area_q @ (point.state.k_q >= interface.law.g_u)) / float(area_q.sum())
    small = SEPARATED * peak
    falling = direction * point.tangent.d_load < 0.0 or abs(point.slope) * reach <= small
    return broken > 0.5 and abs(point.state.load) <= small and falling


def _departing(
    system: System, state: State, direction: float, work: float, phase: Phase
) -> tuple[Point, Linearised] | None:
    """A converged state at which the programme sets out or turns round.

    Where many points touch at once their rates alone may not sort them out. Then a state a trifle ahead does, which
    a patient search finds.
    """
    opening = float(system.load_d @ state.u_d)
    for ahead in (False, True):
        with phase("assembly"):
            response = respond(system, state, decide=False)
        answer = tangent(system, state, response, direction, phase, turning=not ahead)
        if answer is None:
            return None
        found, known = answer
        start = Point(
            replace(state, closed_q=found.closed_q),
            response,
            opening,
            found,
            work,
            energies(system, state, response),
            (),
        )
        if found.agreed or ahead:
            break
        trifle = direction * TRIFLE * max(abs(opening), system.interface.law.g_max)
        rate = float(system.load_d @ found.du_d)
        moved = replace(
            start.state,
            u_d=state.u_d + trifle / rate * found.du_d,
            load=state.load + trifle / rate * found.d_load,
        )
        tried = _touching(system, moved, opening + trifle, trifle, phase)
        if tried is not None:
            state = replace(state, closed_q=tried.state.closed_q)
    return start, known


def _once_more(system: System, point: Point, direction: float, phase: Phase) -> Linearised | None:
    """What the tangent at a point was read from: a shorter step is foreseen with it, for less than it saves."""
    answer = tangent(system, point.state, point.response, direction, phase)
    return None if answer is None else answer[1]


def _touching(system: System, trial: State, opening: float, change: float, phase: Phase) -> Equilibrium | None:
    """Equilibrium at an opening where it is not known what touches.

    Where a search with the contact as it is fails, softer contact shows most of what touches, and ever stiffer one the
    rest.
    """
    control = opening_control(system)
    found = equilibrium(system, trial, control, opening, change, PATIENT, phase)
    if found is not None:
        return found
    law = system.interface.law
    for part in SOFTER:
        soft = replace(system, interface=replace(system.interface, law=replace(law, penalty=part * law.penalty)))
        found = equilibrium(soft, trial, control, opening, change, PATIENT, phase)
        if found is not None:
            trial = replace(found.state, k_q=trial.k_q)
    return found


def _onto(system: System, point: Point, goal: float) -> Step:
    """The step that ends on the goal."""
    return Step(opening_control(system), (goal - point.opening) / float(system.load_d @ point.tangent.du_d), exact=True)


def _advice(point: Point, leapt: bool) -> str:
    opening = point.opening
    if opening < 0.0 and point.state.load < 0.0:
        return (
            f"stopped: Newton did not converge beyond opening {opening:.6g}, where a load of {point.state.load:.4g} "
            "presses the bodies together, even with a step 4096 times smaller; close by less (load.opening), as bodies "
            "that are crushed have no equilibrium, or refine the mesh along the crack (discretization.dofs)"
        )
    if leapt:
        return (
            f"stopped: the energy jumps at opening {opening:.6g}, however short the step, as where a point of the "
            "interface crosses a corner of the other surface; refine the mesh along the crack (discretization.dofs) or "
            "take a basis with smooth surfaces (tspline, nurbs)"
        )
    return (
        f"stopped: Newton did not converge beyond opening {opening:.6g} even with a step 4096 times smaller; "
        "refine the mesh along the crack (discretization.dofs), take more interface points "
        "(discretization.interface_points) or lower interface.strength"
    )
