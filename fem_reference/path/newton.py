"""Newton's method for a state of equilibrium and its load, closed by one control equation."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from fem_reference.model.model import Model
from fem_reference.path.control import Control


@dataclass(frozen=True)
class NewtonSettings:
    """When iterations stop, and how the second attempt at a step searches.

    tolerance : residual over the force scale at which a state counts as converged.
    rounding : the residual that rounding leaves, in units of (machine epsilon) x (largest displacement) x (largest
        stiffness); iterations also stop there, since they cannot get below it.
    full_iterations : iterations with full steps; where these cycle, more of them only delay the second attempt.
    impatient : iterations with full steps where a failure is followed by a shorter step and no second attempt.
    searched_iterations : iterations with a line search, in every stage of the second attempt.
    diverged : residual over the force scale from which a step is given up.
    slack : a line search ends once this part of the work along the step, or less, remains; smaller values cost more
        residuals, larger ones more corrections.
    searches : largest number of residuals of one line search; with bisection every other time, they resolve 1e-6 of the
        step.
    soft_contact : stiffness of contact in the first stage of the second attempt, in units of that of the bond.
    soft_faces : soft_contact where surfaces touch that are not bonded, so that only contact acts between them. With
        stiffer contact an iteration moves the edge of a closed zone by little more than an element.
    """

    tolerance: float = 1e-10
    rounding: float = 16.0
    full_iterations: int = 20
    impatient: int = 14
    searched_iterations: int = 60
    diverged: float = 1e12
    slack: float = 0.5
    searches: int = 40
    soft_contact: float = 100.0
    soft_faces: float = 0.01


REFERENCE_NEWTON = NewtonSettings()


@dataclass(frozen=True)
class Step:
    """The equations of one step: equilibrium from a committed history ``k_q`` of the bond, and the control equation.

    ``force_scale`` is the largest norm of the external forces so far; it or the load of the guess must not be zero.
    ``early`` is the residual over the force scale at which iterations may stop, since one more correction follows.
    Without ``patience`` there is no second attempt.
    """

    control: Control
    k_q: np.ndarray
    force_scale: float
    early: float = 0.0
    patience: bool = True


@dataclass(frozen=True)
class Attempt:
    """The end of Newton's iterations; ``residuals`` are norms over the force scale, before and after each of them."""

    u_n: np.ndarray
    load: float
    residuals: tuple[float, ...]
    converged: bool

    @property
    def iterations(self) -> int:
        return len(self.residuals) - 1


@dataclass(frozen=True)
class Line:
    """The straight line ``u_n + s du_n``, ``load + s d_load`` of one Newton correction."""

    model: Model
    k_q: np.ndarray
    u_n: np.ndarray
    load: float
    du_n: np.ndarray
    d_load: float

    def at(self, s: float) -> tuple[np.ndarray, float]:
        """Displacements and load at the part s of the correction."""
        return self.u_n + s * self.du_n, self.load + s * self.d_load

    def residual(self, s: float) -> np.ndarray:
        """Residual (n,) there."""
        return self.model.residual(*self.at(s), self.k_q)


#: Chooses the part s of a correction from its line and the residual at s = 0; returns it and the residual there.
Length = Callable[[Line, np.ndarray], tuple[float, np.ndarray]]


def find_equilibrium(model: Model, step: Step, u_n: np.ndarray, load: float) -> Attempt:
    """Newton's method from a guess that may violate both equilibrium and control.

    First with full steps; if these fail, from the same guess with a line search and with contact that is stiffened in
    stages. The bordered system ``[K, -f; c, 0] [du; dP] = [-r; missing]`` needs one factorisation of K and two
    back-substitutions (Batoz and Dhatt 1979, Int. J. Numer. Methods Eng. 14, 1262-1267).
    """
    most = REFERENCE_NEWTON.full_iterations if step.patience else REFERENCE_NEWTON.impatient
    plain = _newton(model, step, u_n, load, most, full_step)
    if plain.converged or not step.patience:
        return plain
    careful = plain
    for stage in stiffening(model):
        found = _newton(stage, step, u_n, load, REFERENCE_NEWTON.searched_iterations, line_search)
        careful = replace(found, residuals=careful.residuals[:-1] + found.residuals)
        if not found.converged:
            break
        u_n, load = found.u_n, found.load
    return careful


def stiffening(model: Model) -> list[Model]:
    """The model with softer contact, in stages up to its own, each ten times stiffer than the one before.

    Far ahead of a crack, gaps alternate in sign while they decay. Which points are closed is found more easily with
    soft contact, and hardly changes from one stage to the next.
    """
    law: Any = model.law  # a frozen dataclass
    stages = [(REFERENCE_NEWTON.soft_faces if model.specimen.touching else REFERENCE_NEWTON.soft_contact) * law.K0]
    while stages[-1] < law.penalty:
        stages.append(10 * stages[-1])
    penalties = [*stages[:-1], law.penalty]
    return [replace(model, law=replace(law, penalty=penalty)) for penalty in penalties]


def _newton(model: Model, step: Step, u_n: np.ndarray, load: float, most: int, length: Length) -> Attempt:
    settings = REFERENCE_NEWTON
    scale, target = scale_and_target(model, step, u_n, load)
    target = max(target, step.early)
    r_n = model.residual(u_n, load, step.k_q)
    norms = [model.norm(r_n) / scale]
    while target < norms[-1] < settings.diverged and len(norms) <= most:
        model.factorise(u_n, step.k_q)
        line = Line(model, step.k_q, u_n, load, *bordered_step(model, step.control, u_n, r_n))
        s, r_n = length(line, r_n)
        u_n, load = line.at(s)
        norms.append(model.norm(r_n) / scale)
    return Attempt(u_n, load, tuple(norms), norms[-1] <= target)


def scale_and_target(model: Model, step: Step, u_n: np.ndarray, load: float) -> tuple[float, float]:
    """Force scale of a step from a guess, and the residual over it at which a state counts as converged."""
    settings = REFERENCE_NEWTON
    scale = max(step.force_scale, abs(load) * model.norm(model.load_n))
    return scale, max(settings.tolerance, settings.rounding * model.rounding(u_n) / scale)


def bordered_step(model: Model, control: Control, u_n: np.ndarray, r_n: np.ndarray) -> tuple[np.ndarray, float]:
    """Corrections of displacement (n,) and load, by the tangent factorised last."""
    by_residual_n, by_load_n = model.solve(-r_n), model.solve(model.free_n * model.load_n)
    missing = control.value - model.dot(control.row_n, u_n + by_residual_n)
    d_load = missing / model.dot(control.row_n, by_load_n)
    return by_residual_n + d_load * by_load_n, d_load


def full_step(line: Line, r_n: np.ndarray) -> tuple[float, np.ndarray]:
    """The whole Newton correction.

    Rotating arms need it: a correction that is a pure rotation stretches them to second order, which raises the
    residual a thousandfold until the next correction; a line search would refuse it.
    """
    return 1.0, line.residual(1.0)


def line_search(line: Line, r_n: np.ndarray) -> tuple[float, np.ndarray]:
    """Length of a Newton correction where kinks of the law make full ones cycle, and the residual after it.

    The full correction is taken if little of the work G(s) = du . r(s) remains along it, or if G does not change sign.
    Otherwise G(s) = 0 is solved, where the energy is lowest along du (Crisfield 1991, Non-linear FE Analysis of Solids
    and Structures, ch. 9). A kink in contact changes the slope of G by a factor of a million: false position and
    bisection alternate, so that the interval shrinks for every shape of G.
    """
    full_n = line.residual(1.0)
    dot, du_n = line.model.dot, line.du_n
    start, work = dot(du_n, r_n), dot(du_n, full_n)
    slack = REFERENCE_NEWTON.slack * abs(start)
    if work * start >= 0 or abs(work) <= slack:
        return 1.0, full_n
    low, high = (0.0, start), (1.0, work)
    for n in range(REFERENCE_NEWTON.searches):
        share = low[1] / (low[1] - high[1]) if n % 2 == 0 else 0.5
        s = low[0] + (high[0] - low[0]) * share
        r_n = line.residual(s)
        work = dot(du_n, r_n)
        if abs(work) <= slack:
            break
        low, high = ((s, work), high) if work * start > 0 else (low, (s, work))
    return s, r_n
