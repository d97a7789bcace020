"""All fields at a converged point as drawing programs read them: elements by their nodes, and the interface."""

from __future__ import annotations

from typing import Any

import numpy as np

from fem_reference.model.model import Model
from fem_reference.output.snapshots import Sampler
from fem_reference.path.state import State, ordered_along
from fem_reference.problem.specimen import UPPER


def frame(model: Model, sample: Sampler, state: State) -> dict[str, Any] | None:
    """Fields of the bodies and of the interface; None on all ranks but the first.

    Keys: opening, load; ``bond`` with X_qi, u_qi (n_q, 2) of the upper face and s_q, gap_q, traction_q, damage_q,
    history_q, bonded_q (n_q,), with shear also slip_q and shear_q, ordered along the specimen; ``cells``, one entry a
    body: body, degrees; at the evenly spaced nodes b of every element, those along X fastest, X_ebI, u_ebi
    (n_e, n_b, 2), the Cauchy stress stress_eqv (n_e, n_b, 3) in Voigt order and the second Piola-Kirchhoff stress over
    det F along_eqk (n_e, n_b, 2); w_eb None.

    DOLFINx places the nodes of degree 3 and 4 differently and numbers them in its own order: all values are evaluated
    from the displacement, at the places and in the order that drawing programs use.
    """
    values_euvc = sample(state)
    of_bond = model.bond_fields(state.g_q, state.k_q)
    s_q, X_q, bonded_q, *values = ordered_along(model, model.X_q, model.bonded_q, *of_bond.values())
    if values_euvc is None:
        return None
    cells = [_cells(number, values_euvc) for number in range(len(model.specimen.bodies))]
    named = dict(zip(of_bond, values, strict=True))
    places = {"X_qi": np.stack([X_q, np.zeros_like(X_q)], -1), "u_qi": _on_upper_face(values_euvc, X_q)}
    bond = {**places, "s_q": s_q, **named, "bonded_q": bonded_q}
    return {"opening": state.opening, "load": state.load, "cells": cells, "bond": bond}


def _cells(number: int, values_euvc: np.ndarray) -> dict[str, Any]:
    mine_euvc = values_euvc[values_euvc[:, 0, 0, 9] == number]
    n_e, k = mine_euvc.shape[:2]
    nodes_ebc = mine_euvc.swapaxes(1, 2).reshape(n_e, k * k, -1)
    names = {"X_ebI": slice(0, 2), "u_ebi": slice(2, 4), "stress_eqv": slice(4, 7), "along_eqk": slice(7, 9)}
    parts = {name: nodes_ebc[..., columns] for name, columns in names.items()}
    return {"body": number, "degrees": (k - 1, k - 1), **parts, "w_eb": None}


def _on_upper_face(values_euvc: np.ndarray, X_q: np.ndarray) -> np.ndarray:
    """Displacements (n_q, 2) of the upper body at Y = 0: polynomials along the lower sides of its lowest elements."""
    upper_euvc = values_euvc[values_euvc[:, 0, 0, 9] == UPPER]
    Y_e = upper_euvc[:, 0, 0, 1]
    row_euc = upper_euvc[Y_e < Y_e.min() + 1e-9 * np.ptp(upper_euvc[..., 1]), :, 0]
    row_euc = row_euc[np.argsort(row_euc[:, 0, 0])]
    left_e, right_e = row_euc[:, 0, 0], row_euc[:, -1, 0]
    e_q = np.clip(np.searchsorted(left_e, X_q, side="right") - 1, 0, len(left_e) - 1)
    xi_q = (X_q - left_e[e_q]) / (right_e[e_q] - left_e[e_q])
    k = row_euc.shape[1]
    N_qu = np.linalg.solve(np.vander(np.linspace(0.0, 1.0, k), k).T, np.vander(xi_q, k).T).T
    return np.einsum("qu,qui->qi", N_qu, row_euc[e_q, :, 2:4])
