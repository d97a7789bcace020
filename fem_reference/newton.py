"""Newton's method for a state of equilibrium and its load, closed by one control equation."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from fem_reference.model import Model

#: Residual over the force scale at which a state counts as converged.
TOLERANCE = 1e-10
#: The residual that rounding leaves, in units of (machine epsilon) x (largest displacement) x (largest stiffness).
ROUNDING = 16.0
MAX_ITERATIONS = 25
SHORTEST_STEP = 1 / 16


class Control(Protocol):
    """What is prescribed of a step: one scalar equation in displacements and load."""

    def residual(self, model: Model, u_n: np.ndarray, load: float) -> float:
        """What is missing; zero when the prescription is met."""

    def gradient(self, model: Model, u_n: np.ndarray, load: float) -> tuple[np.ndarray, float]:
        """Its derivatives by the displacements (n_n,) and by the load."""


@dataclass(frozen=True)
class OpeningControl:
    """The mean opening of the loaded faces is prescribed."""

    opening: float

    def residual(self, model: Model, u_n: np.ndarray, load: float) -> float:
        return model.dot(model.load_n, u_n) - self.opening

    def gradient(self, model: Model, u_n: np.ndarray, load: float) -> tuple[np.ndarray, float]:
        return model.load_n, 0.0


@dataclass(frozen=True)
class Attempt:
    """How a search for equilibrium ended; ``residuals`` are norms over the force scale, at the start and after each iteration."""

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
    """Newton from a guess that may violate both equilibrium and control, at a load other than zero or with a force scale.

    The bordered system [K, -f; c_u, c_P] [du; dP] = -[r; c] needs one factorisation of K and two back-substitutions
    (Batoz and Dhatt 1979, Int. J. Numer. Methods Eng. 14, sec. 3).

    Parameters
    ----------
    k_q : committed history of the bond, not changed here.
    force_scale : norm of the external forces met so far; the guess's own load counts too.
    """

    scale = max(force_scale, abs(load) * model.norm(model.load_n))
    target = max(TOLERANCE, ROUNDING * model.rounding(u_n) / scale)
    r_n = model.residual(u_n, load, k_q)
    norms = [model.norm(r_n) / scale]
    while norms[-1] > target and len(norms) <= MAX_ITERATIONS:
        model.factorise(u_n, k_q)
        du_n, d_load = bordered_step(model, control, u_n, load, r_n)

        def trial(s: float, u_n=u_n, load=load, du_n=du_n, d_load=d_load) -> tuple[float, np.ndarray, float, np.ndarray]:
            r_n = model.residual(u_n + s * du_n, load + s * d_load, k_q)
            return model.norm(r_n) / scale, u_n + s * du_n, load + s * d_load, r_n

        norm, u_n, load, r_n = line_search(trial, norms[-1])
        norms.append(norm)
    return Attempt(u_n, load, tuple(norms), norms[-1] <= target)


def bordered_step(
    model: Model, control: Control, u_n: np.ndarray, load: float, r_n: np.ndarray
) -> tuple[np.ndarray, float]:
    """Increments of displacement and load, with the tangent last factorised."""
    by_residual_n, by_load_n = model.solve(-r_n), model.solve(model.free_n * model.load_n)
    c_n, c_load = control.gradient(model, u_n, load)
    missing = control.residual(model, u_n, load) + model.dot(c_n, by_residual_n)
    d_load = -missing / (model.dot(c_n, by_load_n) + c_load)
    return by_residual_n + d_load * by_load_n, d_load


def line_search(trial: Callable, norm: float) -> tuple:
    """The full step if it lowers the residual, else the best of ever shorter ones.

    A kink of the law can make every step along the direction raise the residual; the best of them then still moves on.
    """
    s = 1.0
    best = trial(s)
    while not best[0] < norm and s > SHORTEST_STEP:
        s *= 0.5
        best = min(best, trial(s), key=lambda result: result[0] if np.isfinite(result[0]) else np.inf)
    return best
