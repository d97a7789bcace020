"""Dead tractions on patches of the outline: the displacement that is conjugate to one, and its derivative along X."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from iga.elements.shape_functions import BlockBasis, chain_basis
from iga.mesh.extraction import Chain
from iga.mesh.quadrature import gauss, square
from iga.specimen.body import Body
from iga.specimen.layout import Load, Support
from iga.specimen.pose import Pose


@dataclass(frozen=True)
class Spots:
    """Points (n_q,) on the outline in the specimen's own frame: places X_qI, lengths w_q, and on the control points
    ``conn_qa`` the functions N_qa and their derivatives dN_qa along X."""

    conn_qa: np.ndarray
    N_qa: np.ndarray
    dN_qa: np.ndarray
    X_qI: np.ndarray
    w_q: np.ndarray


@dataclass(frozen=True)
class PatchRows:
    """Rows (n_dof,) of a dead traction: ``mean_d`` gives the displacement that is conjugate to it, ``slope_d`` that of
    the derivative of the displacements along X, which enters the J-integral."""

    mean_d: np.ndarray
    slope_d: np.ndarray


def patch_rows(bodies: tuple[Body, ...], patch: Load | Support, pose: Pose, n_dof: int) -> PatchRows:
    """Rows of a traction on a patch: upwards with resultant 1, or a couple with the moment 1, anticlockwise.

    They give the mean displacement across the specimen or the mean rotation, ``- int u_x (Y - Y_m) / int (Y - Y_m)^2``.

    Raises
    ------
    ValueError : a patch that is not on its side.
    """
    numbers = range(len(bodies)) if patch.body is None else (patch.body,)
    spots = [spot for number in numbers for spot in _spots(bodies[number], patch, pose)]
    length = sum(float(one.w_q.sum()) for one in spots)
    if not length > 0.0:
        raise ValueError(f"a patch must lie on the side {patch.side} of its body, got {patch.extent}")
    middle = sum(float(one.w_q @ one.X_qI[:, 1]) for one in spots) / length
    square = sum(float(one.w_q @ (one.X_qI[:, 1] - middle) ** 2) for one in spots)
    mean_Ai, slope_Ai = np.zeros((n_dof // pose.d, pose.d)), np.zeros((n_dof // pose.d, pose.d))
    for one in spots:
        if patch.couple:
            t_qi = (-one.w_q * (one.X_qI[:, 1] - middle) / square)[:, None] * pose.axes_kI[0]
        else:
            t_qi = (one.w_q / length)[:, None] * pose.axes_kI[1]
        for row_Ai, values_qa in ((mean_Ai, one.N_qa), (slope_Ai, one.dN_qa)):
            np.add.at(row_Ai, one.conn_qa, values_qa[..., None] * t_qi[:, None])
    return PatchRows(mean_Ai.ravel(), slope_Ai.ravel())


def _spots(body: Body, patch: Load | Support, pose: Pose) -> Iterator[Spots]:
    if patch.side in body.ends:
        yield from (_spots_of(basis, pose) for basis in body.ends[patch.side])
    elif pose.d == 3:
        yield from _along_face(body, patch, pose)
    else:
        yield _along_side(body, patch, pose)


def _spots_of(basis: BlockBasis, pose: Pose) -> Spots:
    n_a = basis.N_eqa.shape[2]
    dN_eqa = np.einsum("eqIa,I->eqa", basis.dN_eqIa, pose.axes_kI[0])
    conn_eqa = np.broadcast_to(basis.conn_ea[:, None], dN_eqa.shape)
    N_eqa = np.broadcast_to(basis.N_eqa, dN_eqa.shape)
    X_qI = pose.own(basis.X_eqI).reshape(-1, pose.d)
    conn_qa, N_qa, dN_qa = (v.reshape(-1, n_a) for v in (conn_eqa, N_eqa, dN_eqa))
    return Spots(conn_qa, N_qa, dN_qa, X_qI, basis.dV_eq.ravel())


def _along_face(body: Body, patch: Load | Support, pose: Pose) -> Iterator[Spots]:
    """Gauss points on the parts of the faces of a side of a solid that lie in the extent, which cuts few of them."""
    chain, corners = body.mesh.chains[patch.side], np.array([[0.0, 0.0], [1.0, 0.0]])
    (basis,) = chain_basis(body.mesh, chain, corners, np.ones(2))
    start_c, part_c = _cut(pose.own(basis.X_eqI)[..., 0], patch.extent)
    rule = gauss(max(body.mesh.blocks[0].degrees) + 1)
    cuts, kind_c = np.unique(np.round([start_c, part_c], 12), axis=1, return_inverse=True)
    for kind, (start, part) in enumerate(cuts.T):
        c = np.flatnonzero((kind_c == kind) & (part > 0.0))
        here = Chain(chain.block_c[c], chain.element_c[c], chain.side_c[c], chain.outward)
        points = square((start + part * rule[0], part * rule[1]), rule)
        for one in chain_basis(body.mesh, here, *points):
            yield _spots_of(replace(one, conn_ea=one.conn_ea + body.first), pose)


def _cut(X_ck: np.ndarray, extent: tuple[float, float] | None) -> tuple[np.ndarray, np.ndarray]:
    """Where in each side, with ends X_ck (n_c, 2), an extent begins, and the part (n_c,) that lies in it."""
    low, high = extent or (float(X_ck.min()), float(X_ck.max()))
    at_ck = np.clip((np.array([low, high]) - X_ck[:, :1]) / (X_ck[:, 1:] - X_ck[:, :1]), 0.0, 1.0)
    return at_ck.min(1), np.ptp(at_ck, axis=1)


def _along_side(body: Body, patch: Load | Support, pose: Pose) -> Spots:
    """Gauss points on the parts of a straight side along X that lie in the extent."""
    face = body.surface(patch.side)
    Q_cbI = face.bezier_points(np.concatenate([np.zeros((body.first, 2)), body.mesh.P_AI]))
    X_ck = pose.own(Q_cbI[:, [0, -1]] / face.w_cb[:, [0, -1], None])[..., 0]
    start_c, part_c = _cut(X_ck, patch.extent)
    c, (x, w) = np.flatnonzero(part_c > 0.0), gauss(face.degree + 1)
    c_q = np.repeat(c, len(x))
    xi_q = start_c[c_q] + part_c[c_q] * np.tile(x, len(c))
    r0_qb, r1_qb = face.coefficients(c_q, xi_q, 1)
    X_qI = pose.own(np.einsum("qb,qbI->qI", r0_qb, Q_cbI[c_q]))
    t_q = np.einsum("qb,qbI,I->q", r1_qb, Q_cbI[c_q], pose.axes_kI[0])
    w_q = np.abs(t_q) * part_c[c_q] * np.tile(w, len(c))
    dN_qa = face.functions(c_q, r1_qb) / t_q[:, None]
    return Spots(face.conn_ca[c_q], face.functions(c_q, r0_qb), dN_qa, X_qI, w_q)
