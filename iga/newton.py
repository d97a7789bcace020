"""Newton on the bordered system: displacements and load together, closed by one scalar control equation.

Equilibrium ``internal(u) = load f`` is bordered by the control; one factorisation serves both right-hand sides. A
further control is one more function like `opening_control`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from iga.banded import BandLU
from iga.system import Phase, Response, State, System, factorise, respond, rounding

#: Value of a control at a state with its response, and its gradient with respect to u (n_dof,).
Control = Callable[[State, Response], tuple[float, np.ndarray]]


@dataclass(frozen=True)
class Newton:
    """Tolerance on the residual relative to the forces in play, and limits.

    Far ahead of a crack the gaps alternate in sign while they decay below rounding: deciding there anew in every
    iteration sets penalty against cohesion for ever. So contact is settled once the residual is below ``settle``; what
    a point could be wrong by is then below that, too.
    """

    tolerance: float = 5e-12
    settle: float = 1e-8
    iterations: int = 25
    halvings: int = 5


DEFAULT = Newton()


def opening_control(system: System) -> Control:
    """Mean opening of the loaded faces."""

    def control(state: State, response: Response) -> tuple[float, np.ndarray]:
        return float(system.load_d @ state.u_d), system.load_d

    return control


def gap_control(system: System, point: int) -> Control:
    """Gap at one quadrature point of the interface."""

    def control(state: State, response: Response) -> tuple[float, np.ndarray]:
        return float(response.contact.g_q[point]), response.contact.row(point, system.n_dof)

    return control


def equilibrium(
    system: System, trial: State, control: Control, target: float, change: float, newton: Newton, phase: Phase
) -> tuple[State, Response, tuple[float, ...]] | None:
    """Equilibrium near a trial state at which the control has its ``target`` value.

    Parameters
    ----------
    trial : prediction; its history is that of the last converged state and stays so.
    change : by how much the control changes in this step, for the tolerance on it.

    Returns
    -------
    State, response to it, and the relative residual norms on the way; None where Newton does not converge.
    """
    trial, response, norm = _evaluate(system, trial, True, phase)
    residuals = [norm]
    while not (_balanced(system, trial, response, norm, newton) and _met(control(trial, response)[0], target, change)):
        if len(residuals) > newton.iterations or not np.isfinite(norm):
            return None
        with phase("factor"):
            lu = factorise(response)
        if lu is None:
            return None
        with phase("solve"):
            du_d, d_load = _correction(system, trial, response, lu, control, target)
        trial, response, norm = _search(system, trial, du_d, d_load, norm, newton, phase)
        residuals.append(norm)
    return trial, response, tuple(residuals)


def _balanced(system: System, trial: State, response: Response, norm: float, newton: Newton) -> bool:
    """Below the tolerance, or below what rounding leaves where elements are so thin that this is more."""
    if norm > newton.settle:
        return False
    return norm <= newton.tolerance or norm * response.scale <= rounding(system, trial.u_d)


def _met(value: float, target: float, change: float) -> bool:
    """The control within a millionth of its change, or within rounding of its value."""
    return abs(value - target) <= max(1e-6 * abs(change), 1e-12 * abs(target))


def _evaluate(system: System, trial: State, decide: bool, phase: Phase) -> tuple[State, Response, float]:
    """Response to a trial state, and that state with the contact it found, from which the next search starts."""
    with phase("assembly"):
        response = respond(system, trial, decide)
    found = replace(trial, pairing=response.contact.pairing, closed_q=response.closed_q)
    return found, response, residual_norm(system, trial.load, response)


def residual_norm(system: System, load: float, response: Response) -> float:
    """Norm of the residual of the free unknowns relative to the forces that the elements hold against each other."""
    r_d = np.where(system.free_d, response.internal_d - load * system.load_d, 0.0)
    return float(np.linalg.norm(r_d)) / (response.scale or 1.0)


def _correction(
    system: System, trial: State, response: Response, lu: BandLU, control: Control, target: float
) -> tuple[np.ndarray, float]:
    """Bordered step: ``du = v + z d_load`` with K v = -r, K z = f, and d_load from the linearised control."""
    residual_d = response.internal_d - trial.load * system.load_d
    v, z = lu.solve(np.stack([-residual_d, system.load_d], -1)).T
    value, a_d = control(trial, response)
    d_load = (target - value - a_d @ v) / (a_d @ z)
    return v + d_load * z, float(d_load)


def _search(
    system: System, trial: State, du_d: np.ndarray, d_load: float, norm: float, newton: Newton, phase: Phase
) -> tuple[State, Response, float]:
    """Full Newton step, or the best of a few halved ones where the full one makes the residual grow."""
    best = None
    for halving in range(newton.halvings + 1):
        fraction = 0.5**halving
        candidate = replace(trial, u_d=trial.u_d + fraction * du_d, load=trial.load + fraction * d_load)
        candidate, response, reached = _evaluate(system, candidate, norm > newton.settle, phase)
        if best is None or reached < best[2]:
            best = (candidate, response, reached)
        if reached < norm:
            break
    return best
