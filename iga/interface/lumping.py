"""Control-point lumping: the traction law is evaluated at control points of the interface, not at Gauss points.

Between points that share functions a stiff interface couples openings of opposite sign, and the traction oscillates.
At nodes of Lagrange elements Newton-Cotes rules uncouple them (Schellekens and de Borst 1993). For splines no point of
the surface belongs to one control point alone, and the matrix of the interface itself has to be lumped (Vignollet, May,
de Borst 2015, sec. 5).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from iga.interface.interface import Interface, SearchedInterface, SettledInterface, paired


@dataclass(frozen=True)
class Matching:
    """Tolerances for control points of matching meshes: ``place`` relative to the specimen's size, ``function``
    absolute.

    Both are far above rounding and far below the differences of meshes that do not match.
    """

    place: float = 1e-9
    function: float = 1e-9


MATCHING = Matching()


@dataclass(frozen=True)
class Pairs:
    """Points (n_q,) of an interface with their functions N_qa, areas dA_q, places X_qi, normals n_qi, and partners.

    They face the control points ``twin_qa`` (n_q, n_a) of the master, or their mirror image where ``twin_qa`` is None.
    """

    N_qa: np.ndarray
    conn_qa: np.ndarray
    twin_qa: np.ndarray | None
    dA_q: np.ndarray
    X_qi: np.ndarray
    n_qi: np.ndarray


def lumped(*parts: Interface) -> SettledInterface:
    """One interface from several parts; on bonded parts the control points take the place of the quadrature points.

    Point A has the area ``w_A = int R_A dGamma`` and the gap ``g_A = (u_A^s - u_A^m) . n_A``: the jump of the control
    variables along the normal of the reference configuration (its weighted mean where the surface is curved). In finite
    kinematics, too, each point keeps the control point that it faces. Since the functions add up to one, a uniform gap
    gives the exact forces and energies. ``X_qi`` are the control points, which lie on the surface only where it is
    straight. Parts that only touch keep their quadrature points, which meet the control points that face theirs.

    Parameters
    ----------
    parts : with p + 1 or more Gauss points on each bonded side.

    Raises
    ------
    ValueError : the meshes of the two bodies do not match along the interface, or a control point has no area.
    """
    pairs = [_at_control_points(part) if part.all_bonded else _at_points(part) for part in parts]
    n_a = max(one.N_qa.shape[1] for one in pairs)
    # lumped points are padded with zero functions, so that all points have the same number
    N_qa = np.concatenate([np.pad(one.N_qa, ((0, 0), (0, n_a - one.N_qa.shape[1]))) for one in pairs])
    conn_qa = np.concatenate([_padded(one.conn_qa, n_a) for one in pairs])
    twins = [_padded(one.twin_qa, n_a) for one in pairs if one.twin_qa is not None]
    return paired(
        N_qa=N_qa,
        dN_qa=np.zeros_like(N_qa),
        d2N_qa=np.zeros_like(N_qa),
        conn_qa=conn_qa,
        dA_q=np.concatenate([one.dA_q for one in pairs]),
        X_qi=np.concatenate([one.X_qi for one in pairs]),
        P_AI=parts[0].P_AI,
        law=parts[0].law,
        forward_i=parts[0].forward_i,
        bonded_q=np.repeat([part.all_bonded for part in parts], [len(one.dA_q) for one in pairs]),
        both_qa=np.concatenate([conn_qa, np.concatenate(twins)], axis=1) if twins else conn_qa,
        D_qa=np.concatenate([N_qa, -N_qa], axis=1) if twins else 2.0 * N_qa,
        n_qi=np.concatenate([one.n_qi for one in pairs]),
    )


def _at_control_points(part: Interface) -> Pairs:
    w_A, n_Ai = _areas(part)
    A = _in_order(part.conn_qa)
    if np.any(w_A[A] <= 0.0):
        raise ValueError(
            'interface_rule must be "gauss" or "lobatto" where a control point has no positive area, got "lumped"'
        )
    return Pairs(
        N_qa=np.ones((len(A), 1)),
        conn_qa=A[:, None],
        twin_qa=_twins(part, A)[:, None] if isinstance(part, SearchedInterface) else None,
        dA_q=w_A[A],
        X_qi=part.P_AI[A],
        n_qi=n_Ai[A] / np.linalg.norm(n_Ai[A], axis=1, keepdims=True),
    )


def _at_points(part: Interface) -> Pairs:
    twin_qa = None
    if isinstance(part, SearchedInterface):
        A, twin_A = _in_order(part.conn_qa), np.zeros(len(part.P_AI), dtype=int)
        twin_A[A] = _twins(part, A)
        twin_qa = twin_A[part.conn_qa]
    return Pairs(part.N_qa, part.conn_qa, twin_qa, part.dA_q, part.X_qi, part.rest.n_qi)


def _padded(conn_qa: np.ndarray, n_a: int) -> np.ndarray:
    return np.pad(conn_qa, ((0, 0), (0, n_a - conn_qa.shape[1])), mode="edge")


def _areas(part: Interface) -> tuple[np.ndarray, np.ndarray]:
    """Area (n_A,) of every control point and its normal (n_A, 2) times that area."""
    w_qa, n_qi, n = part.N_qa * part.dA_q[:, None], part.rest.n_qi, len(part.P_AI)
    weighted = [w_qa, *(w_qa * n_qi[:, i : i + 1] for i in range(2))]
    w_A, *n_iA = (np.bincount(part.conn_qa.ravel(), v.ravel(), n) for v in weighted)
    return w_A, np.stack(n_iA, -1)


def _in_order(conn_qa: np.ndarray) -> np.ndarray:
    """The different control points in ``conn_qa``, in the order of their first appearance."""
    A, first = np.unique(conn_qa, return_index=True)
    return A[np.argsort(first)]


def _twins(part: SearchedInterface, A: np.ndarray) -> np.ndarray:
    """The control point of the master at the place of each of A, with the same function along the interface."""
    there, X_AI = part.reference, part.local_AI
    master_qb = part.master.conn_ca[there.c_q]
    B = _in_order(master_qb)
    from scipy.spatial import cKDTree  # here, as few scenes are lumped

    distance, nearest = cKDTree(X_AI[B]).query(X_AI[A])
    twin = B[nearest]
    same = len(B) == len(A) and bool(np.all(distance < MATCHING.place * np.ptp(X_AI, axis=0).max()))
    if same:
        slave_qA, master_qA = _dense(part.conn_qa, part.N_qa, A), _dense(master_qb, there.M_qb, twin)
        same = np.allclose(slave_qA, master_qA, rtol=0.0, atol=MATCHING.function)
    if not same:
        raise ValueError(
            'interface_rule must be "gauss" or "lobatto" on meshes that do not match along the interface '
            f'({len(A)} control points on {len(B)}), got "lumped", which joins them one to one'
        )
    return twin


def _dense(conn_qa: np.ndarray, N_qa: np.ndarray, A: np.ndarray) -> np.ndarray:
    """Functions as a matrix (n_q, n_A) with a column for each control point of A; others are left out."""
    place = np.full(max(conn_qa.max(), A.max()) + 1, len(A))
    place[A] = np.arange(len(A))
    dense = np.zeros((len(conn_qa), len(A) + 1))
    np.add.at(dense, (np.arange(len(conn_qa))[:, None], place[conn_qa]), N_qa)
    return dense[:, :-1]
