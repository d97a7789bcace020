"""The double cantilever beam of Dimitri, De Lorenzis, Zavarise (2013) in DOLFINx, and what is read from its runs."""

from contextlib import nullcontext
from functools import cache

import numpy as np
from mpi4py import MPI
from opening_specimens import Dcb

from fem_reference.model.build import build_model
from fem_reference.solve import solve_debonding

CZM1 = Dcb(
    length=14.0,
    arm_thickness=0.2,
    precrack=4.0,
    E1=120e3,
    E2=120e3,
    G12=50e3,
    nu12=0.2,
    strength=4.0,
    toughness=0.1,
    ductility=12.5,
)


def built(problem):
    """The model, on this rank alone."""
    return build_model(problem, lambda name: nullcontext(), MPI.COMM_SELF)


@cache
def solve(problem):
    """A run that has come to its end, and its columns."""
    solution = solve_debonding(problem)
    assert solution.status == "complete"
    return solution, {name: np.array([row[name] for row in solution.rows]) for name in solution.rows[0]}


def columns(problem):
    return solve(problem)[1]


def ledger_error(run, of="dissipated_energy"):
    """Largest gap between the work done and where it went, over the largest of a column."""
    gap = run["external_work"] - run["stored_energy"] - run["dissipated_energy"]
    return np.max(np.abs(gap)) / run[of].max()


def displacement(model, field):
    """Nodal values of a field u(X, Y, upper) -> (u_x, u_y)."""
    X, Y = model.X_nI[::2].T
    return np.stack(field(X, Y, model.upper_n[::2]), axis=1).ravel()


def tangent_error(model, u_n, k_q, direction_n, h=1e-8):
    """Distance of the tangent along a direction from the difference quotient of the residual, over the latter."""
    ahead_n, behind_n = (model.residual(u_n + s * h * direction_n, 0.0, k_q) for s in (1, -1))
    A = model.tangent(u_n, k_q)
    x, y = A.createVecs()
    x.array[:] = direction_n
    A.mult(x, y)
    change_n = (ahead_n - behind_n) / (2 * h)
    return np.linalg.norm(y.array - change_n) / np.linalg.norm(change_n)
