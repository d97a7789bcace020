"""Number of nonzero entries of the tangent of an ``iga`` run, counted on its mesh outside of the solver."""

from __future__ import annotations

import numpy as np

from verify.methods.names import WITH_DOFS
from verify.methods.solve import prepare
from verify.scene.schema import Scene


def nonzeros(scene: Scene, method: str) -> int:
    """Pairs of unknowns that share an element or an interface point, undeformed; 0 for other methods."""
    if method not in WITH_DOFS:
        return 0
    solver, problem = prepare(scene, method).problem
    system = solver.build(problem).system
    touching = system.interface.rest.dof_qd[:, ::2] // 2  # control points of both surfaces that each point depends on
    connected = [*system.bulk.connectivity, touching]
    n = system.n_dof // 2
    pairs = [np.unique(conn[:, :, None] * n + conn[:, None, :]) for conn in connected]
    return 4 * int(np.unique(np.concatenate(pairs)).size)
