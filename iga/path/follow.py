"""The equilibrium path: predictor along the tangent, choice of the control, step length, programme, end.

While damage grows the opening of the cohesive front is prescribed, so that the path is followed through snap-backs;
otherwise the opening of the specimen is. Where a step fails, the next one ends at the next kink of the law: from kink
to kink a path is nearly straight, and is straight where bulk and law are linear.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from iga.path.control import Prescribed, opening_control
from iga.path.energy import leaks
from iga.path.newton import Equilibrium, equilibrium
from iga.path.point import End, Point
from iga.path.polyline import Largest, StepError, step_error
from iga.path.solver import MANY_DECIDE, Solver
from iga.path.step import advance
from iga.path.step_length import LENGTHS, InTime, Step, StepLength, next_step, past, step_length
from iga.path.tangent import tangent
from iga.system.state import State
from iga.system.system import System, energies


@dataclass(frozen=True)
class PathLimits:
    """Where a path departs and where it ends.

    ``separated``: a specimen has come apart when its load, and all load that the path could regain, is below this part
    of the peak. ``ahead``: distance, relative to the opening, of the nearby state that tells which points touch; at
    least the part ``off_zero`` of g_max, where damage does not grow yet and gaps are no
    rounding of positions. ``softer``: parts of the penalty with which contact is searched for, one after the other,
    where the full penalty is too stiff to converge; a short way to it, and a long one where the short one fails.
    """

    separated: float = 1e-3
    ahead: float = 1e-6
    off_zero: float = 1e-2
    softer: tuple[float, ...] = (1e-2, 1e-1, 1.0, 1e-5, 1e-4, 1e-3, 1e-2, 1e-1, 1.0)


PATH = PathLimits()


def follow(
    solver: Solver,
    programme: Sequence[float],
    steps: int | None,
    renew: Callable[[Point], tuple[System, State] | None] | None = None,
    tolerance: float = LENGTHS.tolerance,
) -> Iterator[Point | End]:
    """Walk through a programme of openings; yields every converged `Point` and, last, the `End`.

    Parameters
    ----------
    programme : openings to be reached one after the other, from zero.
    steps : number of steps over the whole programme. With None the path chooses few steps by their accuracy; so it does
        with a number too small to draw the curve. A counted step that fails is made to end at the next kink of the law,
        then tried with other controls, then halved, down to 1/4096, and grows again afterwards.
    renew : may answer a converged point with another system, and its state in equilibrium at the same opening.
    tolerance : by how much of the peak the load may leave the tangent of a step that the path chooses; how accurate
        such a step is (see `iga.path.polyline`) follows from it.
    """
    system = solver.system
    lengths: StepLength | InTime = step_length(
        np.array(programme), steps, tolerance, system.linear, system.interface.viscosity
    )
    reach, rejected, sides = float(np.max(np.abs(programme))), 0, {-1.0: Largest(), 1.0: Largest()}
    direction = float(np.sign(programme[0]))
    departed = _departing(solver, solver.system.start(), direction, 0.0)
    if departed is None:
        raise ValueError("the system is singular: the supports or the interface do not hold the bodies")
    yield (point := departed)
    for goal in by_way_of_zero(programme):
        if direction * (goal - point.opening) < 0.0 or (point.opening == 0.0 and point.iterations > 0):
            direction = float(np.sign(goal - point.opening))
            point = _departing(solver, point.state, direction, point.external_work) or point
        side = float(np.sign(point.opening + goal))
        largest = sides[side]
        while point.opening != goal:
            asked, moved, reached = _attempted(solver, point, goal, lengths, direction)
            error = StepError()
            if reached is not None and lengths.tolerance is not None:
                error = step_error(solver.system, point, reached, largest, lengths.tolerance)
            inaccurate = error.part < 1.0 and lengths.cuts < LENGTHS.cuts
            if inaccurate or reached is None or leaks(solver.system, point, reached, largest.work):
                solver.drop()
                shorter = lengths.cut(error, moved) if inaccurate else lengths.failed(point.opening)
                rejected += 1
                if shorter is None:
                    yield End(_advice(point, leapt=reached is not None), rejected, counted=lengths.since)
                    return
                lengths = shorter
                # To make the factors again costs less than they save in the prediction of the shorter step.
                if lengths.by_accuracy:
                    tangent(solver, point.state, point.response, direction)
                continue
            sides[side] = largest = largest.with_point(reached)
            lengths = lengths.after(point, reached, largest.load, error)
            yield (point := replace(reached, opening=goal) if asked.exact else reached)
            if direction * point.opening > 0.0 and _separated(solver.system, point, reach, largest.load, direction):
                yield End("complete", rejected, separated=True, counted=lengths.since)
                return
            renewed = renew(point) if renew is not None else None
            if renewed is not None:
                solver = solver.of(renewed[0])
                departed = _departing(solver, renewed[1], direction, point.external_work)
                if departed is None:
                    yield End(f"stopped: the new mesh at opening {goal:.6g} has a singular tangent", rejected)
                    return
                point = departed
    yield End("complete", rejected, counted=lengths.since)


def _attempted(
    solver: Solver, point: Point, goal: float, lengths: StepLength | InTime, direction: float
) -> tuple[Step, float, Point | None]:
    """A step, the change of opening asked of it, and the point where it ends; a step beyond the goal is replaced by one
    that ends on it."""
    asked = next_step(solver.system, point, goal, lengths, direction)
    opening_rate = float(solver.system.load_d @ point.tangent.du_d)
    moved, reached = asked.away * opening_rate, advance(solver, point, asked, direction)
    if reached is None and asked.exact and lengths.by_accuracy and point.tangent.growing_q.any():
        # where the load falls from point to point of the bond, there may be no path to the goal by the opening
        solver.drop()
        tangent(solver, point.state, point.response, direction)
        asked = past(solver.system, point, asked, lengths.front)
        reached = advance(solver, point, asked, direction)
    if reached is not None and direction * (reached.opening - goal) > 0.0 and not asked.exact:
        solver.drop()
        part = (goal - point.opening) / (reached.opening - point.opening)
        away = (goal - point.opening) / opening_rate
        chord_d = np.append(reached.state.u_d - point.state.u_d, reached.state.load - point.state.load)
        near = point.state.moved(part * chord_d)
        asked = Step(opening_control(solver.system), away, exact=True, by_kinks=asked.by_kinks, near=near)
        reached = advance(solver, point, asked, direction)
    return asked, moved, reached


def by_way_of_zero(programme: Sequence[float]) -> tuple[float, ...]:
    """The programme with a stop wherever it passes through zero, as all points of an unloaded interface touch there."""
    way, here = [], 0.0
    for goal in programme:
        way += [0.0, goal] if here * goal < 0.0 else [goal]
        here = goal
    return tuple(way)


def _separated(system: System, point: Point, reach: float, peak: float, direction: float) -> bool:
    """Whether most of the bond is broken and carries no load, now or later on the path.

    Pressing may pry a bond open as pulling does.
    """
    interface = system.interface
    area_q = interface.dA_q * interface.bonded_q
    broken = float(area_q @ (point.state.k_q >= interface.law.failed)) / float(area_q.sum())
    small = PATH.separated * peak
    falling = direction * point.tangent.d_load < 0.0 or abs(point.slope) * reach <= small
    return broken > 0.5 and abs(point.state.load) <= small and falling


def _departing(solver: Solver, state: State, direction: float, work: float) -> Point | None:
    """A converged state at which the programme sets out or turns round; None where its tangent is singular.

    Many points touch at once there. Which of them open is decided by the state a little ahead.
    """
    system = solver.system
    opening = float(system.load_d @ state.u_d)
    found = tangent(solver, state, solver.respond(state, decide=False), direction, turning=True)
    if found is None:
        return None
    change = direction * max(PATH.ahead * abs(opening), PATH.off_zero * system.interface.law.g_max)
    way_d = change / float(system.load_d @ found.du_d) * np.append(found.du_d, found.d_load)
    # forces so near are small beside those of the past, and contact is decided by them alone
    tried = _touching(solver, replace(state, scale=0.0).moved(way_d), opening + change, change)
    if tried is not None:
        state = replace(state, closed_q=tried.state.closed_q)
        found = tangent(solver, state, solver.respond(state, decide=False), direction, turning=True)
    if found is None:
        return None
    response = solver.respond(state, decide=False)
    return Point(state, response, opening, found, work, energies(system, state, response), ())


def _touching(solver: Solver, trial: State, opening: float, change: float) -> Equilibrium | None:
    """Equilibrium at an opening where it is not known which points touch.

    First full Newton steps are tried. Where they fail, a soft penalty finds most points that touch, and ever stiffer
    ones find the rest, with line searches, as full steps go round in circles.
    """
    system = solver.system
    goal = Prescribed(opening_control(system), opening, change)
    found = equilibrium(solver, trial, goal, MANY_DECIDE, searches=(False,))
    if found is not None:
        return found
    law = system.interface.law
    for part in PATH.softer:
        softer = replace(law, penalty=part * law.penalty)
        found = equilibrium(solver.of(system.with_law(softer)), trial, goal, MANY_DECIDE, searches=(True,))
        if found is not None and part == 1.0:
            return found
        if found is not None:
            trial = replace(found.state, k_q=trial.k_q)
    return None


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
