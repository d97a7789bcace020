"""How many entries the tangent of an ``iga`` run has, counted on a mesh built for it: no solver is asked to count."""

from __future__ import annotations

import numpy as np

from verify.methods import WITH_DOFS, iga_problem
from verify.schema import Scene


def nonzeros(scene: Scene, method: str) -> int:
    """Pairs of unknowns that share an element or an interface point, before anything moves; 0 for other methods."""
    if method not in WITH_DOFS:
        return 0
    solver, problem = iga_problem(scene, method)
    system = solver.build(problem).system
    points = [conn_ea for solid in system.solids for conn_ea in [np.asarray(solid.basis.conn_ea)]]
    points.append(np.asarray(system.reference_conn_qa))
    n = system.n_dof // 2
    pairs = [np.unique((conn[:, :, None] * n + conn[:, None, :]).ravel()) for conn in points]
    return 4 * int(np.unique(np.concatenate(pairs)).size)
