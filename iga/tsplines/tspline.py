"""T-splines by extraction: Bezier elements and extraction operators of a T-mesh.

On every Bezier element a function is the product of two cubics, whose Bernstein coefficients are their blossoms at the
ends of the span (Scott, Borden, Verhoosel, Sederberg, Hughes 2011).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from iga.mesh.bernstein import tensor
from iga.mesh.extraction import ElementBlock, Mesh, one_sided
from iga.tsplines.tmesh import DEGREE, FRAME, TMesh, counting, neighbours, require_suitable

_AT_ONCE = 2048  # elements whose intermediate arrays stay in the cache


@dataclass(frozen=True)
class Extraction:
    """Bezier elements of a T-mesh, with index boxes ``box_ek`` (n_e, 4) i0, i1, j0, j1.

    Element e is number ``place_e[e]`` of block ``block_e[e]``.
    """

    box_ek: np.ndarray
    blocks: tuple[ElementBlock, ...]
    block_e: np.ndarray
    place_e: np.ndarray


def tspline_mesh(mesh: TMesh, P_AI: np.ndarray, w_A: np.ndarray | None = None) -> Mesh:
    """The T-spline of a T-mesh; its functions have the order of ``mesh.anchors``.

    Parameters
    ----------
    mesh : analysis-suitable T-mesh with n_A anchors.
    P_AI : (n_A, 2) control points, not homogeneous.
    w_A : (n_A,) positive weights; default: all 1.

    Raises
    ------
    NotSuitable : extensions intersect; the message has the coordinates.
    ValueError : a wrong number of control points or weights, or a weight that is not positive.
    """
    require_suitable(mesh)
    n_A = len(mesh.anchors)
    w_A = np.ones(n_A) if w_A is None else np.asarray(w_A, dtype=float)
    if P_AI.shape != (n_A, 2) or w_A.shape != (n_A,):
        raise ValueError(f"the T-mesh asks for {n_A} control points and weights, got {len(P_AI)} and {w_A.size}")
    if not np.all(w_A > 0):
        raise ValueError(f"weights must be > 0, the smallest is {w_A.min()}")
    found = extracted(mesh)
    chains = {
        side.lower(): one_sided(side, found.block_e[e], found.place_e[e])
        for side, e in _sides(mesh, found.box_ek).items()
    }
    return Mesh(P_AI, w_A, found.blocks, chains)


def extracted(mesh: TMesh) -> Extraction:
    """Bezier elements in blocks with the same number of functions."""
    box_ek = bezier_elements(mesh)
    e_n, A_n = _supported(mesh, box_ek)
    count_e = np.bincount(e_n, minlength=len(box_ek))
    start_e = np.cumsum(count_e) - count_e
    blocks: list[ElementBlock] = []
    block_e, place_e = np.zeros(len(box_ek), dtype=int), np.zeros(len(box_ek), dtype=int)
    for n_a in np.unique(count_e):
        e = np.flatnonzero(count_e == n_a)
        conn_ea = A_n[start_e[e][:, None] + np.arange(n_a)]
        block_e[e], place_e[e] = len(blocks), np.arange(len(e))
        blocks.append(ElementBlock((DEGREE, DEGREE), _extraction(mesh, box_ek[e], conn_ea), conn_ea))
    return Extraction(box_ek, tuple(blocks), block_e, place_e)


def tspline_rectangle(mesh: TMesh) -> Mesh:
    """The rectangle of the knot ranges; parameters are positions."""
    return tspline_mesh(mesh, greville(mesh))


def greville(mesh: TMesh) -> np.ndarray:
    """Control points (n_A, 2) of the identity map: means of the inner local knots (Beirao da Veiga et al. 2013)."""
    return np.stack([knots[:, 1:-1].mean(1) for knots in mesh.local_knots], -1)


def bezier_elements(mesh: TMesh) -> np.ndarray:
    """Index boxes (n_e, 4) i0, i1, j0, j1 of the faces with area of the mesh with its extensions; i runs fastest.

    All faces are rectangles, since the lines of a T-mesh end on other lines.
    """
    return faces(mesh, *mesh.extended())


def blossoms(knots_n5: np.ndarray, start_n: np.ndarray, end_n: np.ndarray) -> np.ndarray:
    """Bernstein coefficients (n, 4) of cubic B-splines with knots (n, 5) on spans [start, end] within one knot span.

    The blossom is the recursion of Cox and de Boor with a different argument at each level; coefficient b is its value
    for 3 - b arguments at the start and b at the end (Ramshaw 1989).
    """
    knots_kn, middle_n = np.ascontiguousarray(knots_n5.T), 0.5 * (start_n + end_n)
    inverse = {}
    for r in range(1, DEGREE + 1):
        length_jn = knots_kn[r:] - knots_kn[:-r]
        inverse[r] = np.divide(1.0, length_jn, out=np.zeros_like(length_jn), where=length_jn > 0.0)
    level_0 = ((knots_kn[:-1] <= middle_n) & (middle_n < knots_kn[1:])).astype(float)
    out_bn = np.empty((DEGREE + 1, len(middle_n)))
    for b in range(DEGREE + 1):
        N_jn = level_0
        for r in range(1, DEGREE + 1):
            x_n = end_n if r <= b else start_n
            rise_jn, fall_jn = (x_n - knots_kn[:-r]) * inverse[r], (knots_kn[r:] - x_n) * inverse[r]
            N_jn = rise_jn[:-1] * N_jn[:-1] + fall_jn[1:] * N_jn[1:]
        out_bn[b] = N_jn[0]
    return out_bn.T


def faces(mesh: TMesh, across_ij: np.ndarray, up_ij: np.ndarray) -> np.ndarray:
    """Index boxes (n, 4) of the faces with area between the unit edges ``across_ij`` and ``up_ij`` of the mesh."""
    across, up = across_ij[FRAME:-FRAME, FRAME:-FRAME], up_ij[FRAME:-FRAME, FRAME:-FRAME]
    corner = np.argwhere((up[:-1] & across[:, :-1]).T)[:, ::-1]
    i, j = corner.T
    end_i, end_j = neighbours(up, i, j, 1)[:, 2], neighbours(across.T, j, i, 1)[:, 2]
    box = np.stack([i, end_i, j, end_j], -1) + FRAME
    has_area = (mesh.knots_i[box[:, 1]] > mesh.knots_i[box[:, 0]]) & (mesh.knots_j[box[:, 3]] > mesh.knots_j[box[:, 2]])
    return box[has_area]


def _supported(mesh: TMesh, box_ek: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """All pairs (n,) of an element and a function with support on it, sorted by element and then by function.

    With elements sorted by rows, those under a function are one run in each row.
    """
    across, up = mesh.local_indices
    m = len(mesh.knots_i)
    key_e = box_ek[:, 2] * m + box_ek[:, 0]
    order = np.argsort(key_e)
    first, rows = up[:, 0], up[:, -1] - up[:, 0]
    A_r = np.repeat(np.arange(len(rows)), rows)
    row_r = first[A_r] + counting(rows)
    low = np.searchsorted(key_e[order], row_r * m + across[A_r, 0])
    high = np.searchsorted(key_e[order], row_r * m + across[A_r, -1])
    A_n = np.repeat(A_r, high - low)
    e_n = order[np.repeat(low, high - low) + counting(high - low)]
    sort = np.lexsort((A_n, e_n))
    return e_n[sort], A_n[sort]


def _extraction(mesh: TMesh, box_ek: np.ndarray, conn_ea: np.ndarray) -> np.ndarray:
    """Extraction operators (n_e, n_a, 16) of elements with the functions ``conn_ea``."""
    n_e, n_a = conn_ea.shape
    (s, t), C_eab = mesh.local_knots, np.empty((n_e, n_a, (DEGREE + 1) ** 2))
    for first in range(0, n_e, _AT_ONCE):
        some = slice(first, first + _AT_ONCE)
        A_n, (i0, i1, j0, j1) = conn_ea[some].ravel(), np.repeat(box_ek[some], n_a, axis=0).T
        C_nb = tensor(_pieces(s, mesh.knots_i, A_n, i0, i1), _pieces(t, mesh.knots_j, A_n, j0, j1))
        C_eab[some] = C_nb.reshape(-1, n_a, C_nb.shape[1])
    return C_eab


def _pieces(local: np.ndarray, knots: np.ndarray, A_n: np.ndarray, i0: np.ndarray, i1: np.ndarray) -> np.ndarray:
    """Bernstein coefficients (n, 4) in one direction, computed once for all elements that share them."""
    _, first, same = np.unique((A_n * len(knots) + i0) * len(knots) + i1, return_index=True, return_inverse=True)
    return blossoms(local[A_n[first]], knots[i0[first]], knots[i1[first]])[same]


def _sides(mesh: TMesh, box_ek: np.ndarray) -> dict[str, np.ndarray]:
    """Elements on each side of the domain, in the order of the side's own parameter."""
    s0, s1 = mesh.knots_i[box_ek[:, :2]].T
    t0, t1 = mesh.knots_j[box_ek[:, 2:]].T
    at = {
        "LEFT": (s0 == mesh.knots_i[0], t0),
        "RIGHT": (s1 == mesh.knots_i[-1], t0),
        "BOTTOM": (t0 == mesh.knots_j[0], s0),
        "TOP": (t1 == mesh.knots_j[-1], s0),
    }
    return {side: np.flatnonzero(here)[np.argsort(along[here])] for side, (here, along) in at.items()}
