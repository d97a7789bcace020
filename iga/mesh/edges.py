"""The sides of all elements as curves: coincident points, shared sides, hanging nodes.

Two points coincide if they have the same place and the same functions have the same values there. The second condition
is checked by a third coordinate, for which every control point has a number of its own: it separates the two faces of a
slit, which have the same places but different functions.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components, depth_first_order
from scipy.spatial import cKDTree

from iga.mesh.bernstein import bernstein, bernstein_derivative, elevation
from iga.mesh.bezier import homogeneous
from iga.mesh.extraction import HANDS, SIDES, Chain, Mesh, on_side

#: Distance of coincident points as a part of the size of their element; third coordinates, in [0, 1], differ by less.
SAME_POINT = 1e-6

_SIDE_NAMES = np.array(list(SIDES))
_GOLDEN = 0.5 * (np.sqrt(5.0) - 1.0)


@dataclass(frozen=True, eq=False)
class Sides:
    """All sides of all elements, four per element in the order of `SIDES`, walked with the element on the left.

    ``block_k``, ``element_k``, ``side_k`` (n_k,) are block, element and name of each side; ``H_kbI`` (n_k, p + 1, 4)
    homogeneous Bezier points (x, y, third coordinate, weight), elevated to the highest degree p of the mesh.
    """

    block_k: np.ndarray
    element_k: np.ndarray
    side_k: np.ndarray
    H_kbI: np.ndarray

    def find(self, block_c: np.ndarray, element_c: np.ndarray, side_c: np.ndarray) -> np.ndarray:
        """Numbers k (n_c,) of sides given by block, element and name."""
        first_c = np.searchsorted(self.block_k, np.asarray(block_c, dtype=int))
        place_c = np.argmax(np.asarray(side_c)[:, None] == _SIDE_NAMES, axis=1)
        return first_c + len(_SIDE_NAMES) * np.asarray(element_c, dtype=int) + place_c

    def points(self, k_n: np.ndarray, t_n: np.ndarray) -> np.ndarray:
        """Points (n, 3) of the sides k_n (n,) at the parameters t_n (n,) in [0, 1], the third coordinate included."""
        h_nI = np.einsum("nb,nbI->nI", bernstein(self.H_kbI.shape[1] - 1, t_n), self.H_kbI[k_n])
        return h_nI[:, :3] / h_nI[:, 3:]

    def parameters(self, k_n: np.ndarray, t_n: np.ndarray) -> np.ndarray:
        """The same points as parameters (n, 2) of the elements."""
        st_nd = np.empty((len(t_n), 2))
        for name, (direction, value) in SIDES.items():
            here = self.side_k[k_n] == name
            st_nd[here, direction] = value
            st_nd[here, 1 - direction] = t_n[here] if HANDS[name] > 0 else 1.0 - t_n[here]
        return st_nd

    @cached_property
    def length_k(self) -> np.ndarray:
        """Length (n_k,) of the straight lines between the Bezier points of each side."""
        X_kbI = self.H_kbI[..., :2] / self.H_kbI[..., 3:]
        return np.linalg.norm(np.diff(X_kbI, axis=1), axis=2).sum(1)

    @cached_property
    def size_k(self) -> np.ndarray:
        """Longest side (n_k,) of the element of each side."""
        return np.repeat(self.length_k.reshape(-1, len(_SIDE_NAMES)).max(1), len(_SIDE_NAMES))

    @cached_property
    def vertex_kv(self) -> np.ndarray:
        """Vertices (n_k, 2) at which each side starts and ends, numbered from 0."""
        k = np.tile(np.arange(len(self.H_kbI)), 2)
        ends = self.points(k, np.repeat([0.0, 1.0], len(self.H_kbI)))
        return _merged(ends, self.size_k[k]).reshape(2, -1).T

    @cached_property
    def edge_k(self) -> np.ndarray:
        """Edges (n_k,), numbered from 0: one for all sides with the same ends and the same middle."""
        k = np.arange(len(self.H_kbI))
        middle = _merged(self.points(k, np.full(len(k), 0.5)), self.size_k)
        ends = np.sort(self.vertex_kv, axis=1)  # of three sides on a long one, the middle one has the same middle
        return np.unique(np.column_stack([middle, ends]), axis=0, return_inverse=True)[1].ravel()

    @cached_property
    def lone(self) -> np.ndarray:
        """Sides (n,) whose edge no other side has: on the boundary, or with longer or shorter neighbours."""
        return np.flatnonzero(np.bincount(self.edge_k)[self.edge_k] == 1)

    @cached_property
    def opposite(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Sides k (n,) with a neighbour, the side l (n,) on which the middle of k lies, its parameter t (n,) on l."""
        lone, paired = self.lone, np.setdiff1d(np.arange(len(self.edge_k)), self.lone)
        order = paired[np.argsort(self.edge_k[paired], kind="stable")]
        first = np.searchsorted(self.edge_k[order], self.edge_k[order])
        last = np.searchsorted(self.edge_k[order], self.edge_k[order], side="right") - 1
        here = np.arange(len(order))
        partner = order[np.where(here < last, here + 1, first)]
        point, side, t = self.on(self.points(lone, np.full(len(lone), 0.5)), self.size_k[lone])
        other = lone[point] != side
        return (
            np.concatenate([order, lone[point[other]]]),
            np.concatenate([partner, side[other]]),
            np.concatenate([np.full(len(order), 0.5), t[other]]),
        )

    @cached_property
    def shared_k(self) -> np.ndarray:
        """Mask (n_k,) of the sides with a neighbour of any length; sides of length zero are included."""
        shared = self.length_k < SAME_POINT * self.size_k
        shared[self.opposite[0]] = True
        return shared

    @property
    def hanging(self) -> np.ndarray:
        """Pairs (n, 2) of a vertex and a side inside which it lies."""
        return np.stack(self.hanging_at[:2], -1)

    @cached_property
    def hanging_at(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Vertices (n,), the sides (n,) inside which they lie, and at which parameter (n,) of these."""
        starts = self.vertex_kv[self.lone, 0]  # these are also all ends, since lone sides form closed chains
        vertex, first = np.unique(starts, return_index=True)
        k = self.lone[first]
        point, side, t = self.on(self.points(k, np.zeros(len(k))), self.size_k[k])
        inside = np.all(self.vertex_kv[side] != vertex[point][:, None], axis=1)
        return vertex[point[inside]], side[inside], t[inside]

    def on(self, X_nI: np.ndarray, size_n: np.ndarray) -> tuple[np.ndarray, ...]:
        """All incidences of points (n, 3) on lone sides: number of the point, side, parameter on the side."""
        k_m = self.lone
        hull_mbI = self.H_kbI[k_m, :, :2] / self.H_kbI[k_m, :, 3:]
        slack_mI = SAME_POINT * self.size_k[k_m, None]
        low_mI, high_mI = hull_mbI.min(1) - slack_mI, hull_mbI.max(1) + slack_mI
        x_nmI = X_nI[:, None, :2]
        point, m = np.nonzero(np.all((low_mI <= x_nmI) & (x_nmI <= high_mI), axis=2))
        side = k_m[m]
        t = nearest(self.H_kbI[side], X_nI[point, :2])
        away = np.abs(self.points(side, t) - X_nI[point])
        size = np.minimum(size_n[point], self.size_k[side])
        on = (np.hypot(away[:, 0], away[:, 1]) < SAME_POINT * size) & (away[:, 2] < SAME_POINT)
        return point[on], side[on], t[on]


def element_sides(mesh: Mesh) -> Sides:
    """The sides of all elements; the Jacobians of the mesh must be positive."""
    own_A = np.arange(1, len(mesh.P_AI) + 1) * _GOLDEN % 1.0
    P_AI = np.column_stack([mesh.P_AI, own_A])
    highest = max(max(block.degrees) for block in mesh.blocks)
    parts = [_block_sides(homogeneous(P_AI, mesh.w_A, block), block.degrees, highest) for block in mesh.blocks]
    count_b = [len(block.conn_ea) for block in mesh.blocks]
    return Sides(
        np.repeat(np.arange(len(count_b)), len(_SIDE_NAMES) * np.array(count_b)),
        np.concatenate([np.repeat(np.arange(n), len(_SIDE_NAMES)) for n in count_b]),
        np.tile(_SIDE_NAMES, sum(count_b)),
        np.concatenate(parts),
    )


def chains_of(sides: Sides, k_n: np.ndarray) -> tuple[Chain, ...]:
    """The chains that sides k_n (n,) of the boundary form, walked with the body on the left.

    No chains are returned if a side lies inside the body, or if two sides start, or end, at one vertex.
    """
    start_n, end_n = sides.vertex_kv[k_n].T
    if np.any(sides.shared_k[k_n]) or any(len(np.unique(v)) < len(v) for v in (start_n, end_n)):
        return ()
    walks = (k_n[walk] for walk in _walks(start_n, end_n))
    return tuple(Chain(sides.block_k[k], sides.element_k[k], sides.side_k[k], 1.0) for k in walks)


def _walks(start_n: np.ndarray, end_n: np.ndarray) -> list[np.ndarray]:
    """Sides in walking order, one array per piece: from the side without a predecessor, in a loop from the first."""
    n, order = len(start_n), np.argsort(start_n)
    place = np.searchsorted(start_n, end_n, sorter=order)
    has_next = place < n
    has_next[has_next] = start_n[order[place[has_next]]] == end_n[has_next]
    before, after = np.flatnonzero(has_next), order[place[has_next]]
    graph = coo_array((np.ones(len(before)), (before, after)), shape=(n, n)).tocsr()
    _, piece_n = connected_components(graph, directed=False)
    follows_n = np.isin(np.arange(n), after)
    first = np.lexsort((np.arange(n), follows_n, piece_n))
    heads = first[np.unique(piece_n[first], return_index=True)[1]]
    return [depth_first_order(graph, head, return_predecessors=False) for head in heads]


def _block_sides(H_ebI: np.ndarray, degrees: tuple[int, ...], highest: int) -> np.ndarray:
    """Homogeneous Bezier points (4 n_e, highest + 1, d) of the sides of a block, four per element."""
    walks = (walked(degrees, name) for name in SIDES)
    sides = [np.einsum("bc,ebI->ecI", elevation(len(walk) - 1, highest), H_ebI[:, walk]) for walk in walks]
    return np.stack(sides, 1).reshape(-1, highest + 1, H_ebI.shape[-1])


def walked(degrees: tuple[int, ...], side: str) -> np.ndarray:
    """Bernstein indices along a side, walked with the element on the left."""
    return on_side(degrees, side)[:: int(HANDS[side])]


def _merged(X_nI: np.ndarray, size_n: np.ndarray) -> np.ndarray:
    """Numbers (n,) of points (n, 3), equal for coincident points."""
    i, j = cKDTree(X_nI[:, :2]).query_pairs(SAME_POINT * size_n.max(), output_type="ndarray").T
    away = np.abs(X_nI[i] - X_nI[j])
    near = np.hypot(away[:, 0], away[:, 1]) <= SAME_POINT * np.minimum(size_n[i], size_n[j])
    same = near & (away[:, 2] < SAME_POINT)
    graph = coo_array((np.ones(np.count_nonzero(same)), (i[same], j[same])), shape=(len(X_nI), len(X_nI)))
    return connected_components(graph, directed=False)[1]


def nearest(H_nbI: np.ndarray, x_nI: np.ndarray, steps: int = 8) -> np.ndarray:
    """Parameter (n,) of the closest point of each curve in the plane: best of 4 p + 1 samples, then Gauss-Newton."""
    p = H_nbI.shape[1] - 1
    H_nbI = H_nbI[..., [0, 1, 3]]
    t_m = np.linspace(0.0, 1.0, 4 * p + 1)
    h_nmI = bernstein(p, t_m) @ H_nbI
    t_n = t_m[np.argmin(np.linalg.norm(h_nmI[..., :2] / h_nmI[..., 2:] - x_nI[:, None], axis=2), axis=1)]
    for _ in range(steps):
        h, h_t = (np.einsum("nb,nbI->nI", f(p, t_n), H_nbI) for f in (bernstein, bernstein_derivative))
        X = h[:, :2] / h[:, 2:]
        X_t = (h_t[:, :2] - X * h_t[:, 2:]) / h[:, 2:]
        speed = np.maximum(np.sum(X_t * X_t, 1), np.finfo(float).tiny)
        t_n = np.clip(t_n + np.sum((x_nI - X) * X_t, 1) / speed, 0.0, 1.0)
    return t_n
