"""Newton on the bordered system: displacements and load together, closed by one scalar control equation.

Equilibrium ``internal(u) = load f`` is bordered by the control; one factorisation serves both right-hand sides (Batoz
and Dhatt 1979).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from iga.algebra.factors import bordered
from iga.interface.response import traction
from iga.path.control import Prescribed
from iga.path.gap_newton import settled_step
from iga.path.solver import Newton, Solver
from iga.system.state import Response, State
from iga.system.system import System, rounding

#: Limits of full steps where faces roll off each other: about twenty iterations are usual.
ROLLING_FACES = {"iterations": 40, "patience": 20}


@dataclass(frozen=True)
class Equilibrium:
    """A converged state, the response to it, and the relative residual norms on the way."""

    state: State
    response: Response
    residuals: tuple[float, ...]


@dataclass(frozen=True)
class Iterate:
    """A trial state with the contact that it found, the response to it, and the norm of the residual."""

    state: State
    response: Response
    norm: float


@dataclass(frozen=True)
class Line:
    """The iterates along a Newton step ``step_d`` (n_dof + 1,) from ``start``; ``decide`` as for `respond`."""

    solver: Solver
    start: Iterate
    step_d: np.ndarray
    decide: bool

    def at(self, part: float) -> Iterate:
        """The iterate at a part of the step."""
        return _evaluated(self.solver, self.start.state.moved(part * self.step_d), self.decide)

    def work(self, there: Iterate) -> float:
        """Work of the residual of an iterate along the step."""
        return float(self.step_d[:-1] @ _residual(self.solver.system, there.state.load, there.response))


def equilibrium(
    solver: Solver,
    trial: State,
    prescribed: Prescribed,
    newton: Newton | None = None,
    searches: tuple[bool, ...] = (False, True),
) -> Equilibrium | None:
    """Equilibrium near a trial state at which a control has a prescribed value; None where Newton finds none.

    Full steps are tried first. Arms that rotate need them: a step of pure rotation stretches them to second order,
    which the next step corrects. Only where full steps fail is the length of each step searched for, by the work of the
    residual along it.

    Parameters
    ----------
    trial : prediction; its history is that of the last converged state and does not change.
    newton : limits other than those of the solver.
    searches : whether the length of a step is searched for, in each attempt.
    """
    newton = newton or solver.newton
    # faces that roll off each other decide at many points where they touch
    patient = newton if solver.system.interface.bonded_q.all() else replace(newton, **ROLLING_FACES)
    spent: tuple[float, ...] = ()
    for searched in searches:
        advance, limits = (_searched, newton.searching) if searched else (_full, patient)
        found, residuals = _iterate(solver, trial, prescribed, limits, advance)
        spent += residuals
        if found is not None:
            return Equilibrium(found.state, found.response, spent)
    return None


def _iterate(
    solver: Solver,
    trial: State,
    prescribed: Prescribed,
    newton: Newton,
    advance: Callable[[Line, Newton], Iterate],
) -> tuple[Iterate | None, tuple[float, ...]]:
    """The converged iterate, or None, and the residual norms on the way."""
    now = _evaluated(solver, trial, True)
    residuals, factorised, on_gaps = [now.norm], False, advance is _full and not solver.system.interface.slides
    while True:
        met, norm = prescribed.met(now.state, now.response), now.norm
        if met and norm <= newton.tolerance:
            return now, tuple(residuals)
        floor = _floor(solver.system, now.state, now.response, newton) if norm < newton.rough else newton.tolerance
        stays = len(residuals) > 1 and norm > 0.25 * residuals[-2]
        if met and stays and norm <= floor:
            return now, tuple(residuals)
        if _hopeless(residuals, newton) or _circling(residuals):
            return None, tuple(residuals)
        stale = factorised and _holds(residuals, newton.tolerance)
        if not stale and solver.factorise(now.response) is None:
            return None, tuple(residuals)
        factorised = True
        decide = not met or norm > max(newton.settle, 10.0 * floor)
        tried = on_gaps and decide and norm > newton.rough and not stale
        found = correction(solver, now.state, now.response, prescribed, tried)
        if found is None:
            return None, tuple(residuals)
        step_d, settled = found
        if float(np.abs(step_d[:-1]).max()) > newton.furthest * np.ptp(solver.system.interface.local_AI):
            return None, tuple(residuals)
        on_gaps = on_gaps and (settled or not tried)  # Newton on the gaps that failed once fails again
        now = advance(Line(solver, now, step_d, decide), newton)
        residuals.append(now.norm)


def _residual(system: System, load: float, response: Response) -> np.ndarray:
    """Residual (n_dof,) of the free unknowns."""
    return np.where(system.free_d, response.internal_d - load * system.load_d, 0.0)


def residual_norm(system: System, load: float, response: Response) -> float:
    """Norm of the residual of the free unknowns relative to the forces that the elements hold against each other."""
    r_d = _residual(system, load, response)
    return float(r_d @ r_d) ** 0.5 / (response.scale or 1.0)


def _floor(system: System, trial: State, response: Response, newton: Newton) -> float:
    """Relative residual norm that rounding leaves: a residual that falls no further has converged below it."""
    if response.scale == 0.0:
        return newton.tolerance
    return max(newton.tolerance, rounding(system, trial.u_d, response) / response.scale)


def _holds(residuals: list[float], tolerance: float) -> bool:
    """Whether the last factors are good enough to bring the residual below the tolerance at once.

    The last step reduced the residual by the factor ``r1 / r0``; the next one, with factors that are one iteration old,
    is expected to reduce it by ``2 r1 / r0``.
    """
    return 2.0 * residuals[-1] ** 2 <= tolerance * residuals[-2]


def _hopeless(residuals: list[float], newton: Newton) -> bool:
    if len(residuals) > newton.iterations or not np.isfinite(residuals[-1]):
        return True
    best = int(np.argmin(residuals))
    return len(residuals) - 1 - best > newton.patience


def _circling(residuals: list[float]) -> bool:
    """Whether the last residuals repeat in cycles of 2 to 4: each iterate follows from the one before alone."""
    for turn in (2, 3, 4):
        last = residuals[-2 * turn :]
        if len(residuals) > 3 * turn and np.allclose(last, residuals[-3 * turn : -turn], rtol=1e-6, atol=0.0):
            return True
    return False


def _evaluated(solver: Solver, trial: State, decide: bool) -> Iterate:
    """A trial state with the contact that it found, from which the next search starts."""
    response = solver.respond(trial, decide)
    found = replace(trial, pairing=response.contact.pairing, closed_q=response.closed_q)
    return Iterate(found, response, residual_norm(solver.system, trial.load, response))


def correction(
    solver: Solver,
    trial: State,
    response: Response,
    prescribed: Prescribed,
    on_gaps: bool,
    guess_q: np.ndarray | None = None,
) -> tuple[np.ndarray, bool] | None:
    """Step (n_dof + 1,) of displacements and load with the current factors; None where the bordered system is singular.

    With ``on_gaps`` Newton on the gaps alone puts all tractions on the law, starting from the gaps ``guess_q`` (n_q,)
    where these are given; the second value is True where it has converged.
    """
    system = solver.system
    with solver.phase("solve"):
        value, a_d, a_load = prescribed.control(trial, response)
        tied = bordered(solver.inverse, a_d, a_load)
        if tied is None:
            return None
        residual_d = response.internal_d - trial.load * system.load_d
        linear_d = tied.solve(-residual_d[:, None], prescribed.value - value)[:, 0]
        if not on_gaps:
            return linear_d, False
        interface, touch = system.interface, response.contact

        def tractions(g_q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
            found = traction(interface, replace(touch, g_q=g_q), trial.past, g_q < 0.0)
            return found.p_q, found.dp_q

        known = response.p_q, response.dp_q
        found = settled_step(touch, interface.dA_q, known, tractions, linear_d, tied, guess_q)
        return (linear_d, False) if found is None else (found, True)


def _full(line: Line, newton: Newton) -> Iterate:
    return line.at(1.0)


def _searched(line: Line, newton: Newton) -> Iterate:
    """Line search: the Newton step shortened to where the work ``du . r`` of the residual is small, by false position
    and bisection in turn.

    The work changes sign where the energy is lowest along the step, which a full step may pass where bulk and interface
    stiffen, as in contact (Crisfield 1991, ch. 9).
    """
    start, best = line.work(line.start), line.at(1.0)
    work = line.work(best)
    low, high = (0.0, start), (1.0, work)
    if start >= 0.0 or work <= 0.0:
        return best
    for attempt in range(newton.searches):
        if 0.5 * start <= work <= -newton.slack * start:
            break
        falsi = low[0] + (high[0] - low[0]) * low[1] / (low[1] - high[1])
        s = falsi if attempt % 2 == 0 else 0.5 * (low[0] + high[0])
        best = line.at(s)
        work = line.work(best)
        low, high = ((s, work), high) if work < 0.0 else (low, (s, work))
    return best
