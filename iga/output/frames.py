"""All fields at a converged point, in the form for drawing programs: elements in Bezier form, and the interface."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from iga.elements.bulk import gradient
from iga.elements.shape_functions import block_basis
from iga.mesh.bezier import homogeneous
from iga.mesh.quadrature import gauss, square
from iga.path.point import Point
from iga.specimen.specimen import Specimen

#: Components of a stress that are told, by the number of directions.
STRESSES = {2: ((0, 0), (1, 1), (0, 1)), 3: ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2))}


def frame(specimen: Specimen, point: Point) -> dict[str, Any]:
    """Fields of the bodies and of the interface, in global coordinates and not in the specimen's own frame.

    There are d = 2 directions, 3 of a solid. Keys: opening, load; ``bond`` with X_qi, u_qi (n_q, d) of the slave's
    points and s_q, gap_q, traction_q, damage_q, history_q, bonded_q (n_q,), with shear also slip_q and shear_q, ordered
    along the specimen; ``cells``, one entry for every block of elements of one degree: body, degrees; Bezier points
    X_ebI, u_ebi (n_e, n_b, d) and weights w_eb, exact; and at the points points_q (n_q, d) of the element the Cauchy
    stress stress_eqv (n_e, n_q, n_v), see `STRESSES`, with along_eqk (n_e, n_q, d), the second Piola-Kirchhoff stress
    along the axes of the material over det F.

    These points are a Gauss rule of one more point than the degree along each direction: polynomials that interpolate
    the values there are the discrete L2 projection by this rule.
    """
    cells = [part for number in range(len(specimen.bodies)) for part in _cells(specimen, number, point.state.u_d)]
    return {"opening": point.opening, "load": point.state.load, "cells": cells, "bond": _bond(specimen, point)}


def _cells(specimen: Specimen, number: int, u_d: np.ndarray) -> Iterator[dict[str, Any]]:
    body, kinematics, axes_kI = specimen.bodies[number], specimen.system.bulk.kinematics, specimen.pose.axes_kI
    d = specimen.pose.d
    mesh, u_Ai = body.mesh, u_d.reshape(-1, d)[body.points]
    for block in mesh.blocks:
        points_q, weights_q = square(*(gauss(p + 1) for p in block.degrees))
        basis = block_basis(mesh, block, points_q, weights_q)
        H_iIeq = gradient(basis, u_Ai)
        sigma_ijeq = kinematics.cauchy(body.D, H_iIeq)
        inside_IJeq = kinematics.material(sigma_ijeq, H_iIeq)
        H_ebf = homogeneous(np.concatenate([mesh.P_AI, u_Ai], axis=1), mesh.w_A, block)
        values_ebf, w_eb = H_ebf[..., :-1] / H_ebf[..., -1:], H_ebf[..., -1]
        yield {
            "body": number,
            "degrees": block.degrees,
            "X_ebI": values_ebf[..., :d],
            "u_ebi": values_ebf[..., d:],
            "w_eb": w_eb,
            "points_q": points_q,
            "stress_eqv": np.stack([sigma_ijeq[ij] for ij in STRESSES[d]], -1),
            "along_eqk": np.einsum("kI,IJeq,kJ->eqk", axes_kI, inside_IJeq, axes_kI),
        }


def _bond(specimen: Specimen, point: Point) -> dict[str, np.ndarray]:
    interface, state, response = specimen.system.interface, point.state, point.response
    s_q, order = specimen.distance(interface.X_qi), specimen.ordered[1]
    values = {
        "X_qi": interface.X_qi,
        "u_qi": interface.at_slave(state.u_d.reshape(-1, specimen.pose.d)),
        "s_q": s_q,
        "gap_q": response.contact.g_q,
        "traction_q": response.p_q,
        "damage_q": np.where(interface.bonded_q, interface.law.damage(state.k_q), 1.0),
        "history_q": state.k_q,
        "bonded_q": interface.bonded_q,
    }
    if response.contact.slip is not None:
        values |= {"slip_q": response.contact.slip.s_q, "shear_q": response.pull.t_q}
    return {name: value[order] for name, value in values.items()}
