"""Newton's method for a state of equilibrium and its load, closed by one control equation."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from fem_reference.model.model import Model
from fem_reference.path.control import Control

#: Residual over the force scale at which a state counts as converged.
TOLERANCE = 1e-10
#: The residual that rounding leaves, in units of (machine epsilon) x (largest displacement) x (largest stiffness).
ROUNDING = 16.0
#: Iterations with full steps, and, should these fail, from the start again with a line search in every stage.
MAX_FULL = 20
MAX_SEARCHED = 60
#: Residual over the force scale beyond which there is no coming back.
DIVERGED = 1e12
#: A step is long enough when this part of the work along it, or less, is left.
SLACK = 0.5
MAX_SEARCHES = 40
#: Contact is first solved with this stiffness, in units of that of the bond, then with ten times more until its own.
SOFT_CONTACT = 100.0
#: The same where faces touch that nothing holds together.
SOFT_FACES = 1.0


@dataclass(frozen=True)
class Attempt:
    """How a search for equilibrium ended.

    ``residuals`` are norms over the force scale, at the start and after each iteration.
    """

    u_n: np.ndarray
    load: float
    residuals: tuple[float, ...]
    converged: bool

    @property
    def iterations(self) -> int:
        return len(self.residuals) - 1


def find_equilibrium(
    model: Model, control: Control, u_n: np.ndarray, load: float, k_q: np.ndarray, force_scale: float
) -> Attempt:
    """Newton from a guess that may violate both equilibrium and control.

    The bordered system [K, -f; c, 0] [du; dP] = [-r; missing] needs one factorisation of K and two back-substitutions
    (Batoz and Dhatt 1979, Int. J. Numer. Methods Eng. 14, 1262-1267).

    Parameters
    ----------
    k_q : committed history of the bond, not changed here.
    force_scale : norm of the external forces met so far; it or the load of the guess must be other than zero.
    """
    plain = _newton(model, control, u_n, load, k_q, force_scale, MAX_FULL, full_step)
    if plain.converged:
        return plain
    careful = plain
    for stage in stiffening(model):
        found = _newton(stage, control, u_n, load, k_q, force_scale, MAX_SEARCHED, line_search)
        careful = replace(found, residuals=careful.residuals[:-1] + found.residuals)
        if not found.converged:
            break
        u_n, load = found.u_n, found.load
    return careful


def stiffening(model: Model) -> list[Model]:
    """The model with softer contact, stage by stage up to its own.

    Far ahead of a crack gaps alternate in sign while they fade away; which ones are closed is found from there forward,
    and where contact is soft the answer is nearly that of stiffer contact.
    """
    law = model.law
    stages = [(SOFT_FACES if model.specimen.touching else SOFT_CONTACT) * law.K0]
    while stages[-1] < law.penalty:
        stages.append(10 * stages[-1])
    penalties = [*stages[:-1], law.penalty]
    return [replace(model, law=replace(law, penalty=penalty)) for penalty in penalties]


def _newton(
    model: Model,
    control: Control,
    u_n: np.ndarray,
    load: float,
    k_q: np.ndarray,
    force_scale: float,
    most: int,
    choose_length: Callable,
) -> Attempt:
    scale = max(force_scale, abs(load) * model.norm(model.load_n))
    target = max(TOLERANCE, ROUNDING * model.rounding(u_n) / scale)
    r_n = model.residual(u_n, load, k_q)
    norms = [model.norm(r_n) / scale]
    while target < norms[-1] < DIVERGED and len(norms) <= most:
        model.factorise(u_n, k_q)
        du_n, d_load = bordered_step(model, control, u_n, r_n)

        def residual_at(
            s: float,
            u_n: np.ndarray = u_n,
            load: float = load,
            du_n: np.ndarray = du_n,
            d_load: float = d_load,
        ) -> np.ndarray:
            return model.residual(u_n + s * du_n, load + s * d_load, k_q)

        s, r_n = choose_length(model, residual_at, du_n, r_n)
        u_n, load = u_n + s * du_n, load + s * d_load
        norms.append(model.norm(r_n) / scale)
    return Attempt(u_n, load, tuple(norms), norms[-1] <= target)


def bordered_step(model: Model, control: Control, u_n: np.ndarray, r_n: np.ndarray) -> tuple[np.ndarray, float]:
    """Increments of displacement and load, with the tangent last factorised."""
    by_residual_n, by_load_n = model.solve(-r_n), model.solve(model.free_n * model.load_n)
    missing = control.value - model.dot(control.row_n, u_n + by_residual_n)
    d_load = missing / model.dot(control.row_n, by_load_n)
    return by_residual_n + d_load * by_load_n, d_load


def full_step(
    model: Model, residual_at: Callable[[float], np.ndarray], du_n: np.ndarray, r_n: np.ndarray
) -> tuple[float, np.ndarray]:
    """The Newton step as it is.

    Arms that turn need it: a step of pure rotation stretches them to second order, which raises the residual a
    thousandfold before the next step takes it away, and a line search would not let it pass.
    """
    return 1.0, residual_at(1.0)


def line_search(
    model: Model, residual_at: Callable[[float], np.ndarray], du_n: np.ndarray, r_n: np.ndarray
) -> tuple[float, np.ndarray]:
    """Length of a Newton step where kinks of the law make full ones go round in circles, and the residual after it.

    The full step is taken when little of the work G(s) = du . r(s) remains along it, or when it does not change sign;
    else s is sought where G vanishes, which is where the energy is lowest along du (Crisfield 1991, Non-linear FE
    Analysis of Solids and Structures, ch. 9). A kink in contact bends G a millionfold: false position and bisection
    take turns, so that the interval shrinks whatever its shape.
    """
    full_n = residual_at(1.0)
    start, work = model.dot(du_n, r_n), model.dot(du_n, full_n)
    slack = SLACK * abs(start)
    if work * start >= 0 or abs(work) <= slack:
        return 1.0, full_n
    low, high = (0.0, start), (1.0, work)
    for n in range(MAX_SEARCHES):
        share = low[1] / (low[1] - high[1]) if n % 2 == 0 else 0.5
        s = low[0] + (high[0] - low[0]) * share
        r_n = residual_at(s)
        work = model.dot(du_n, r_n)
        if abs(work) <= slack:
            break
        low, high = ((s, work), high) if work * start > 0 else (low, (s, work))
    return s, r_n
