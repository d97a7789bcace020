"""Fields at a converged point, gathered on the first rank."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import ufl
from dolfinx import fem, mesh

from fem_reference.dolfinx_api import evaluate, expression
from fem_reference.model.forms import cauchy_stress, constant, second_stress
from fem_reference.model.model import Model
from fem_reference.path.row import front_fields
from fem_reference.path.state import State, ordered_along

Snapshot = dict[str, Any]
Sampler = Callable[[State], np.ndarray | None]


def field_sampler(model: Model) -> Sampler:
    """A function that evaluates the fields of a state; it returns None on all ranks but the first.

    Every element has its own grid of (degree + 1)^2 evenly spaced points, which determine its displacement; jumps
    between elements are kept. Shape (n_e, k, k, 10): X, Y, u_x, u_y, the Cauchy stress xx, yy, xy, the second
    Piola-Kirchhoff stress 11, 22 over det F, and the number of the body. Of a solid it is the plane in the middle of
    the width.
    """
    k, dim = model.problem.degree + 1, model.specimen.dim
    lines = [np.linspace(0.0, 1.0, k)] * dim
    points_qI = np.stack(np.meshgrid(*lines, indexing="ij"), axis=-1).reshape(-1, dim)
    samplers = []
    for u, body in zip(model.displacement, model.specimen.bodies, strict=True):
        domain = u.function_space.mesh
        D = constant(domain, body.D_IJ)
        X = ufl.SpatialCoordinate(domain)
        finite = model.problem.kinematics == "finite"
        stress, S = cauchy_stress(u, D, finite), second_stress(u, D, finite)
        J = ufl.det(ufl.Identity(dim) + ufl.grad(u)) if finite else 1.0
        of_stress = [stress[0, 0], stress[1, 1], stress[0, 1], S[0, 0] / J, S[1, 1] / J]
        Z = [X[i] for i in range(2, dim)]
        samplers.append((expression(ufl.as_vector([X[0], X[1], u[0], u[1], *of_stress, *Z]), points_qI), domain))

    def sample(state: State) -> np.ndarray | None:
        model.displace(state.u_n)
        parts = [_owned_values(e, domain) for e, domain in samplers]
        if dim > 2:
            parts = [_in_the_middle(part, k, model.specimen.near) for part in parts]
        numbered = [np.insert(part, part.shape[2], body, axis=2) for body, part in enumerate(parts)]
        gathered = model.comm.gather(np.concatenate(numbered))
        return None if gathered is None else along_first(np.concatenate(gathered).reshape(-1, k, k, 10))

    return sample


def snapshot(model: Model, sample: Sampler, state: State) -> Snapshot | None:
    """Fields along the interface, and a grid of samples for every element; None on all ranks but the first."""
    values_euvc, bond = sample(state), _bond_fields(model, state)
    front = front_fields(model, state) if model.problem.solid else {}
    if values_euvc is None:
        return None
    return {
        "opening": state.opening,
        "load": state.load,
        **bond,
        **front,
        "X_euvi": values_euvc[..., :2],
        "u_euvi": values_euvc[..., 2:4],
        "stress_euv": values_euvc[..., 4],
    }


def _in_the_middle(values_epc: np.ndarray, k: int, near: float) -> np.ndarray:
    """Of the values on a solid, with Z as the last one, those of the k^2 points at Z = 0 of the elements there."""
    there_epc = values_epc[values_epc[..., -1].min(axis=1) < near]
    X_ep, Y_ep, Z_ep = (np.rint(there_epc[..., c] / near) for c in (0, 1, -1))
    order_ep = np.lexsort((Y_ep, X_ep, Z_ep), axis=-1)[:, : k * k]
    return np.take_along_axis(there_epc, order_ep[..., None], axis=1)[..., :-1]


def along_first(values_euvc: np.ndarray) -> np.ndarray:
    """Elements sorted by position, upper body first, with X rising along u and Y along v."""
    X_euv, Y_euv = values_euvc[..., 0], values_euvc[..., 1]
    turned = np.abs(X_euv[:, -1, 0] - X_euv[:, 0, 0]) < np.abs(X_euv[:, 0, -1] - X_euv[:, 0, 0])
    straight = np.where(turned[:, None, None, None], values_euvc.swapaxes(1, 2), values_euvc)
    for axis, c in ((1, 0), (2, 1)):
        ends = straight[:, [0, -1]] if axis == 1 else straight[:, :, [0, -1]]
        falling = np.take(ends, 1, axis)[:, 0, c] < np.take(ends, 0, axis)[:, 0, c]
        straight = np.where(falling[:, None, None, None], np.flip(straight, axis), straight)
    middle_ei = np.stack([X_euv.mean(axis=(1, 2)), Y_euv.mean(axis=(1, 2))], axis=1)
    spread_i = np.ptp(middle_ei, axis=0)
    rounded = np.round(middle_ei / np.where(spread_i > 0.0, spread_i, 1.0), 9)
    return straight[np.lexsort((rounded[:, 0], -rounded[:, 1]))]


def _owned_values(e: fem.Expression, domain: mesh.Mesh) -> np.ndarray:
    return evaluate(e, domain, np.arange(domain.topology.index_map(domain.topology.dim).size_local, dtype=np.int32))


def _bond_fields(model: Model, state: State) -> Snapshot:
    fields = model.bond_fields(state.g_q, state.k_q)
    del fields["history_q"]
    return dict(zip(("s_q", *fields), ordered_along(model, *fields.values()), strict=True))
