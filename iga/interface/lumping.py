"""Control-point lumping: the traction law is asked at the control points of the interface, not between them.

Between points that share functions a stiff interface couples openings of opposite sign, and the traction oscillates.
For nodes of Lagrange elements Newton-Cotes rules uncouple them (Schellekens and de Borst 1993); control points of
splines lie on no common point of the surface, and the matrix of the interface has to be lumped itself (Vignollet,
May, de Borst 2015, sec. 5).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.spatial import cKDTree

from iga.interface.interface import Contact, Interface, resting

#: Part of the specimen's size, or of one, within which control points and functions are the same.
SAME_POINT = 1e-9


def lumped(interface: Interface) -> Interface:
    """The interface with control points for points.

    Point A has the area ``w_A = int R_A dGamma`` and the gap ``g_A = (u_A^s - u_A^m) . n_A``, the jump of the control
    variables along the normal of the reference configuration (the weighted mean of it where the surface is curved), in
    finite kinematics as well: each point keeps the one that it faces. Since the functions add up to one, a uniform gap
    gives the exact forces and energies. ``X_qi`` are the control points, which lie on straight surfaces only.

    Parameters
    ----------
    interface : any interface with p + 1 or more Gauss points on each bonded side.

    Raises
    ------
    ValueError : the meshes of the two bodies do not match along the interface, or a control point has no area.
    """
    start = resting(interface)
    w_A, n_Ai = _areas(interface, start.n_qi)
    A = _in_order(interface.conn_qa)
    if np.any(w_A[A] <= 0.0):
        raise ValueError(
            'interface_rule must be "gauss" or "lobatto" where a control point has no positive area, got "lumped"'
        )
    return replace(
        interface,
        N_qa=np.ones((len(A), 1)),
        conn_qa=A[:, None],
        dA_q=w_A[A],
        X_qi=interface.P_AI[A],
        master=None,
        mirror_i=n_Ai[A] / np.linalg.norm(n_Ai[A], axis=1, keepdims=True),
        twin_qa=None if interface.master is None else _twins(interface, start, A)[:, None],
    )


def paired(interface: Interface) -> Interface:
    """The interface at its own points, which meet the control points that face theirs, for good.

    Parameters and errors as those of `lumped`, beside which it has places that are not bonded.
    """
    start = resting(interface)
    if interface.master is None:
        return replace(interface, mirror_i=start.n_qi)
    A = _in_order(interface.conn_qa)
    twin_A = np.zeros(len(interface.P_AI), dtype=int)
    twin_A[A] = _twins(interface, start, A)
    return replace(interface, master=None, mirror_i=start.n_qi, twin_qa=twin_A[interface.conn_qa])


def chained(parts: Sequence[Interface]) -> Interface:
    """One interface from parts without a search; a lumped point takes functions that are zero there as well."""
    first, *others = parts
    if not others:
        return first
    n_a = max(part.N_qa.shape[1] for part in parts)
    joined = {name: np.concatenate([getattr(part, name) for part in parts]) for name in ("dA_q", "X_qi", "mirror_i")}
    joined["N_qa"] = np.concatenate([np.pad(part.N_qa, ((0, 0), (0, n_a - part.N_qa.shape[1]))) for part in parts])
    for name in ("conn_qa", "twin_qa"):
        values = [getattr(part, name) for part in parts]
        if values[0] is not None:
            joined[name] = np.concatenate([np.pad(v, ((0, 0), (0, n_a - v.shape[1])), mode="edge") for v in values])
    return replace(first, **joined)


def _areas(interface: Interface, n_qi: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Area (n_A,) of every control point and its normal (n_A, 2) times that area."""
    w_qa, n = interface.N_qa * interface.dA_q[:, None], len(interface.P_AI)
    weighted = [w_qa, *(w_qa * n_qi[:, i : i + 1] for i in range(2))]
    w_A, *n_iA = (np.bincount(interface.conn_qa.ravel(), v.ravel(), n) for v in weighted)
    return w_A, np.stack(n_iA, -1)


def _in_order(conn_qa: np.ndarray) -> np.ndarray:
    """Control points of some rows, in the order of their first appearance."""
    A, first = np.unique(conn_qa, return_index=True)
    return A[np.argsort(first)]


def _twins(interface: Interface, start: Contact, A: np.ndarray) -> np.ndarray:
    """The control point of the master at the place of each of A, with the same function along the interface."""
    n_a = interface.N_qa.shape[1]
    master_qb, D_qb = start.dof_qd[:, 2 * n_a :: 2] // 2, _functions(interface, start)
    B = _in_order(master_qb)
    distance, nearest = cKDTree(interface.local_AI[B]).query(interface.local_AI[A])
    twin = B[nearest]
    rounding = SAME_POINT * np.ptp(interface.local_AI, axis=0).max()
    same = len(B) == len(A) and bool(np.all(distance < rounding))
    if same:
        slave_qA, master_qA = (
            _dense(conn, N, points)
            for conn, N, points in ((interface.conn_qa, interface.N_qa, A), (master_qb, D_qb, twin))
        )
        same = np.allclose(slave_qA, master_qA, rtol=0.0, atol=SAME_POINT)
    if not same:
        raise ValueError(
            'interface_rule must be "gauss" or "lobatto" on meshes that do not match along the interface '
            f'({len(A)} control points on {len(B)}), got "lumped", which joins them one to one'
        )
    return twin


def _functions(interface: Interface, start: Contact) -> np.ndarray:
    """Functions (n_q, n_b) of the master where the points meet it."""
    assert start.pairing is not None
    (r,) = interface.surface.coefficients(start.pairing.c_q, start.pairing.xi_q, 0)
    return interface.surface.functions(start.pairing.c_q, r)


def _dense(conn_qa: np.ndarray, N_qa: np.ndarray, A: np.ndarray) -> np.ndarray:
    """Functions as a matrix (n_q, n_A) with a column for each control point of A; others are left out."""
    place = np.full(max(conn_qa.max(), A.max()) + 1, len(A))
    place[A] = np.arange(len(A))
    dense = np.zeros((len(conn_qa), len(A) + 1))
    np.add.at(dense, (np.arange(len(conn_qa))[:, None], place[conn_qa]), N_qa)
    return dense[:, :-1]
