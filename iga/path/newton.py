"""Newton on the bordered system: displacements and load together, closed by one scalar control equation.

Equilibrium ``internal(u) = load f`` is bordered by the control; one factorisation serves both right-hand sides (Batoz
and Dhatt 1979).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from iga.algebra.factors import Inverse, bordered
from iga.interface.interface import traction
from iga.path.control import Control
from iga.path.gap_newton import settled_step
from iga.system.state import Response, State
from iga.system.system import Phase, System, factorise, respond, rounding

#: Part of the work along a step that may be left, and the attempts to find its length.
SLACK, SEARCHES = 0.05, 12
#: Relative residual of a state that only shows where to go on from.
ROUGH = 1e-3


@dataclass(frozen=True)
class Newton:
    """Tolerance on the residual relative to the forces in play, and limits.

    Far ahead of a crack the gaps alternate in sign while they decay below rounding: deciding there anew in every
    iteration sets penalty against cohesion for ever. So contact is settled once the residual is below ``settle``; what
    a point could be wrong by is then below that, too. What rounding leaves is only asked below ``rough``. A search
    whose residual has not come below the best one for ``patience`` iterations goes round in circles, as the softening
    front does between two of its points, and ends.
    """

    tolerance: float = 5e-12
    settle: float = 1e-8
    rough: float = 1e-4
    iterations: int = 25
    patience: int = 6

    @property
    def searching(self) -> Newton:
        """Limits where every step is measured; the work falls then, the residual need not."""
        return replace(self, iterations=3 * self.iterations, patience=4 * self.patience)


DEFAULT = Newton()


def roughly(newton: Newton) -> Newton:
    """Tolerance for a state that only shows where to go on from."""
    return replace(newton, tolerance=ROUGH)


#: For a state at which hundreds of points decide at once.
PATIENT = Newton(iterations=100, patience=20)


@dataclass(frozen=True)
class Equilibrium:
    """A converged state, the response to it, and the relative residual norms on the way."""

    state: State
    response: Response
    residuals: tuple[float, ...]


def equilibrium(
    system: System, trial: State, control: Control, target: float, change: float, newton: Newton, phase: Phase
) -> Equilibrium | None:
    """Equilibrium near a trial state at which the control has its ``target`` value; None where Newton finds none.

    Full steps first: arms that turn need them, for a step of pure rotation stretches them to second order, and the
    next one takes that away. Only where they lead nowhere is each step measured by the work that is left along it.

    Parameters
    ----------
    trial : prediction; its history is that of the last converged state and stays so.
    change : by how much the control changes in this step, for the tolerance on it.
    """
    spent: tuple[float, ...] = ()
    for advance, limits in ((_full, newton), (_searched, newton.searching)):
        found, residuals = _iterate(system, trial, control, target, change, limits, phase, advance)
        spent += residuals
        if found is not None:
            return Equilibrium(*found, spent)
    return None


def _iterate(
    system: System,
    trial: State,
    control: Control,
    target: float,
    change: float,
    newton: Newton,
    phase: Phase,
    advance: Callable,
) -> tuple[tuple[State, Response] | None, tuple[float, ...]]:
    """The converged state with its response, or None, and the residual norms on the way."""
    trial, response, norm = _evaluate(system, trial, True, phase)
    residuals, tangent, inner = [norm], None, advance is _full
    while True:
        met = _met(control(trial, response)[0], target, change)
        if met and norm <= newton.tolerance:
            return (trial, response), tuple(residuals)
        floor = _floor(system, trial, response, newton) if norm < newton.rough else newton.tolerance
        stays = len(residuals) > 1 and norm > 0.25 * residuals[-2]
        if met and stays and norm <= floor:
            return (trial, response), tuple(residuals)
        if _hopeless(residuals, newton):
            return None, tuple(residuals)
        stale = tangent is not None and _holds(residuals, newton.tolerance)
        if not stale:
            tangent = None  # before the next one is made: of all that a run holds it is the largest
            tangent = factorise(system, response, phase)
        if tangent is None:
            return None, tuple(residuals)
        decide = not met or norm > max(newton.settle, 10.0 * floor)
        tried = inner and decide and norm > newton.rough and not stale
        with phase("solve"):
            corrected = correction(system, trial, response, tangent, control, target, tried)
        if corrected is None:
            return None, tuple(residuals)
        step_d, settled = corrected
        inner = inner and (settled or not tried)  # where it does not find its way once, it will not the next time

        def at(
            s: float, trial: State = trial, step_d: np.ndarray = step_d, decide: bool = decide
        ) -> tuple[State, Response, float]:
            return _evaluate(system, trial.moved(s * step_d), decide, phase)

        trial, response, norm = advance(system, at, step_d[:-1], (trial, response, norm))
        residuals.append(norm)


def residual_norm(system: System, load: float, response: Response) -> float:
    """Norm of the residual of the free unknowns relative to the forces that the elements hold against each other."""
    r_d = np.where(system.free_d, response.internal_d - load * system.load_d, 0.0)
    return float(r_d @ r_d) ** 0.5 / (response.scale or 1.0)


def _floor(system: System, trial: State, response: Response, newton: Newton) -> float:
    """Relative residual norm that counts as none once it stays: what rounding leaves where the tolerance is less."""
    if response.scale == 0.0:
        return newton.tolerance
    return max(newton.tolerance, rounding(system, trial.u_d, response) / response.scale)


def _met(value: float, target: float, change: float) -> bool:
    """The control within a millionth of its change, or within rounding of its value."""
    return abs(value - target) <= max(1e-6 * abs(change), 1e-12 * abs(target))


def _holds(residuals: list[float], tolerance: float) -> bool:
    """Whether the last factors are good enough to bring the residual below the tolerance at once.

    Newton's residual falls by the error of the configuration before, and with the factors of that one the next one
    falls by twice as much as the last one did.
    """
    return 2.0 * residuals[-1] ** 2 <= tolerance * residuals[-2]


def _hopeless(residuals: list[float], newton: Newton) -> bool:
    if len(residuals) > newton.iterations or not np.isfinite(residuals[-1]):
        return True
    best = int(np.argmin(residuals))
    return len(residuals) - 1 - best > newton.patience


def _evaluate(system: System, trial: State, decide: bool, phase: Phase) -> tuple[State, Response, float]:
    """Response to a trial state, and that state with the contact it found, from which the next search starts."""
    with phase("assembly"):
        response = respond(system, trial, decide)
    found = replace(trial, pairing=response.contact.pairing, closed_q=response.closed_q)
    return found, response, residual_norm(system, trial.load, response)


def correction(
    system: System,
    trial: State,
    response: Response,
    inverse: Inverse,
    control: Control,
    target: float,
    inner: bool,
    guess_q: np.ndarray | None = None,
) -> tuple[np.ndarray, bool] | None:
    """Step (n_dof + 1,) of displacements and load, bordered by the linearised control; None where that feels no load.

    The ``inner`` Newton puts all tractions on the law, from the gaps ``guess_q`` (n_q,) where these are told; whether
    it has, is told, too.
    """
    value, a_d, a_load = control(trial, response)
    tied = bordered(inverse, a_d, a_load)
    if tied is None:
        return None
    residual_d = response.internal_d - trial.load * system.load_d
    plain_d = tied.solve(-residual_d[:, None], target - value)[:, 0]
    if not inner:
        return plain_d, False
    interface, touch = system.interface, response.contact

    def law(g_q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return traction(interface, touch, trial.k_q, g_q < 0.0, g_q)[:2]

    found = settled_step(interface, touch, law, (response.p_q, response.dp_q), plain_d, tied, guess_q)
    return (plain_d, False) if found is None else (found, True)


def _full(system: System, at: Callable, du_d: np.ndarray, before: tuple) -> tuple[State, Response, float]:
    return at(1.0)


def _searched(system: System, at: Callable, du_d: np.ndarray, before: tuple) -> tuple[State, Response, float]:
    """The Newton step shortened to where little work is left along it, by bisection and false position in turn.

    Where bulk and interface stiffen, as in contact, the work ``du . r`` changes sign where the energy is lowest along
    the step (Crisfield 1991, ch. 9).
    """
    start = _work(system, du_d, before)
    best = at(1.0)
    low, high = (0.0, start), (1.0, _work(system, du_d, best))
    if start >= 0.0 or high[1] <= 0.0:
        return best
    work = high[1]
    for attempt in range(SEARCHES):
        if 0.5 * start <= work <= -SLACK * start:
            break
        falsi = low[0] + (high[0] - low[0]) * low[1] / (low[1] - high[1])
        s = falsi if attempt % 2 == 0 else 0.5 * (low[0] + high[0])
        best = at(s)
        work = _work(system, du_d, best)
        low, high = ((s, work), high) if work < 0.0 else (low, (s, work))
    return best


def _work(system: System, du_d: np.ndarray, at: tuple[State, Response, float]) -> float:
    state, response, _ = at
    return float(du_d @ np.where(system.free_d, response.internal_d - state.load * system.load_d, 0.0))
