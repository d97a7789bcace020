"""How many entries the tangent of an ``iga`` run has, counted on a mesh built for it: no solver is asked to count."""

from __future__ import annotations

import numpy as np

from verify.methods.names import WITH_DOFS
from verify.methods.solve import prepare
from verify.scene.schema import Scene


def nonzeros(scene: Scene, method: str) -> int:
    """Pairs of unknowns that share an element or an interface point, before anything moves; 0 for other methods."""
    if method not in WITH_DOFS:
        return 0
    solver, problem = prepare(scene, method).problem
    system = solver.build(problem).system
    touching = system.interface.rest.dof_qd[:, ::2] // 2  # control points of both surfaces that each point depends on
    together = [*system.bulk.connectivity, touching]
    n = system.n_dof // 2
    pairs = [np.unique(conn[:, :, None] * n + conn[:, None, :]) for conn in together]
    return 4 * int(np.unique(np.concatenate(pairs)).size)
