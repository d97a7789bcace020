"""Number of nonzero entries of the tangent of an ``iga`` run, counted on its mesh outside of the solver."""

from __future__ import annotations

from typing import Any

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
    connected = [np.asarray(solid.basis.conn_ea) for solid in system.solids] + [_touching(system.interface)]
    n = system.n_dof // 2
    pairs = [np.unique(conn[:, :, None] * n + conn[:, None, :]) for conn in connected]
    return 4 * int(np.unique(np.concatenate(pairs)).size)


def _touching(interface: Any) -> np.ndarray:
    """Control points (n_q, n_a) of both surfaces that each interface point touches."""
    pairing = interface.pairing
    if pairing is None:
        return interface.known_conn_qa
    return np.concatenate([interface.conn_qa, interface.master.conn_ca[pairing.c_q]], axis=1)
