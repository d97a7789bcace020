"""The equilibrium path: one bordered system, a control equation, Newton with line search, and step control.

Unknowns are the displacements and the load. Equilibrium ``internal(u) = load f`` is bordered by one scalar control equation; one
factorisation serves both right-hand sides. A further control is one more function like `opening_control`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from iga.banded import BandLU
from iga.system import Phase, Response, State, System, factorise, respond, untimed

#: Value of a control at a state, and its gradient with respect to u (n_dof,) and to the load.
Control = Callable[[State], tuple[float, np.ndarray, float]]


@dataclass(frozen=True)
class Newton:
    """Tolerance on the residual relative to the forces in play, and limits."""

    tolerance: float = 1e-11
    iterations: int = 25
    halvings: int = 5


@dataclass(frozen=True)
class Point:
    """A converged point of the path, its history committed.

    ``slope`` is d load / d opening and ``du_d`` is du / d opening along the path, from the tangent at this very point.
    ``residuals`` are the norms that Newton went through, relative to the scale of the forces.
    """

    state: State
    response: Response
    opening: float
    slope: float
    du_d: np.ndarray
    iterations: int
    residuals: tuple[float, ...]


@dataclass(frozen=True)
class End:
    """How a path ended: ``complete`` or ``stopped: <cause and what to do>``, and how many steps were taken back."""

    status: str
    rejected: int


def opening_control(system: System) -> Control:
    """Mean opening of the loaded faces."""

    def control(state: State) -> tuple[float, np.ndarray, float]:
        return float(system.load_d @ state.u_d), system.load_d, 0.0

    return control


def follow(
    system: System, programme: Sequence[float], steps: int, newton: Newton = Newton(), phase: Phase = untimed
) -> Iterator[Point | End]:
    """Walk through a programme of openings; yields every converged `Point` and, last, the `End`.

    Parameters
    ----------
    programme : openings to be reached one after the other, from zero.
    steps : number of equal increments asked for over the whole programme; a step that fails is halved, down to 1/1024, and
        grows again afterwards.
    """
    largest = float(np.sum(np.abs(np.diff([0.0, *programme])))) / steps
    control, step, rejected = opening_control(system), largest, 0
    point = _start(system, phase)
    yield point
    for goal in programme:
        while point.opening != goal:
            left = goal - point.opening
            target = goal if abs(left) < 1.001 * step else point.opening + np.copysign(step, left)
            reached = _advance(system, point, control, target, newton, phase)
            if reached is not None:
                point = replace(reached, opening=target)
                yield point
                step = min(2.0 * step, largest) if reached.iterations <= 8 else step
                continue
            rejected, step = rejected + 1, 0.5 * step
            if step < largest / 1024:
                yield End(_advice(point.opening), rejected)
                return
    yield End("complete", rejected)


def _start(system: System, phase: Phase) -> Point:
    state = system.start()
    with phase("assembly"):
        response = respond(system, state)
    point = _point(system, state, response, 0, (), phase)
    if point is None:
        raise ValueError("the unloaded system is singular: the supports or the interface do not hold the bodies")
    return point


def _advance(system: System, point: Point, control: Control, target: float, newton: Newton, phase: Phase) -> Point | None:
    """One step by Newton from the tangent predictor; None where it does not converge. Nothing is committed before the end."""
    d_opening = target - point.opening
    old = point.state
    trial = replace(old, u_d=old.u_d + d_opening * point.du_d, load=old.load + d_opening * point.slope)
    trial, response, norm = _evaluate(system, trial, phase)
    residuals = [norm]
    while norm > newton.tolerance:
        if len(residuals) > newton.iterations or not np.isfinite(norm):
            return None
        with phase("factor"):
            lu = factorise(response)
        if lu is None:
            return None
        with phase("solve"):
            du_d, d_load = _correction(system, trial, response, lu, control, target)
        trial, response, norm = _search(system, trial, du_d, d_load, norm, newton.halvings, phase)
        residuals.append(norm)
    state = replace(trial, k_q=response.k_q)
    return _point(system, state, response, len(residuals), tuple(residuals), phase)


def _evaluate(system: System, trial: State, phase: Phase) -> tuple[State, Response, float]:
    """Response to a trial state, and that state with the contact it found, from which the next search starts."""
    with phase("assembly"):
        response = respond(system, trial)
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
    value, a_d, b = control(trial)
    d_load = (target - value - a_d @ v) / (a_d @ z + b)
    return v + d_load * z, float(d_load)


def _search(
    system: System, trial: State, du_d: np.ndarray, d_load: float, norm: float, halvings: int, phase: Phase
) -> tuple[State, Response, float]:
    """Full Newton step, or the best of a few halved ones where the full one makes the residual grow."""
    best = None
    for halving in range(halvings + 1):
        fraction = 0.5**halving
        candidate = replace(trial, u_d=trial.u_d + fraction * du_d, load=trial.load + fraction * d_load)
        candidate, response, reached = _evaluate(system, candidate, phase)
        if best is None or reached < best[2]:
            best = (candidate, response, reached)
        if reached < norm:
            break
    return best


def _point(
    system: System, state: State, response: Response, iterations: int, residuals: tuple[float, ...], phase: Phase
) -> Point | None:
    """The converged point with its exact path tangent ``K du = f d_load``, scaled to a unit change of the opening."""
    with phase("factor"):
        lu = factorise(response)
    if lu is None:
        return None
    with phase("solve"):
        z_d = lu.solve(system.load_d[:, None])[:, 0]
    slope = 1.0 / float(system.load_d @ z_d)
    opening = float(system.load_d @ state.u_d)
    return Point(state, response, opening, slope, slope * z_d, iterations, residuals)


def _advice(opening: float) -> str:
    return (
        f"stopped: Newton did not converge beyond opening {opening:.6g} even with a step 1024 times smaller; "
        "the path probably snaps back here: refine the mesh along the crack (discretization.dofs) or lower interface.strength"
    )
