"""Whether the elements of a mesh form one body: covered once, without tears, by functions that add up to one.

Neighbours share their common side and the functions on it. Sides that are not shared are the boundary. A tear is a part
of the boundary inside the body, which is found in one of two ways. In a smooth mesh, functions continue beyond the
tear: their traces on the boundary are linearly dependent. In a C0 mesh, functions can end there: two sides of the
boundary then coincide. They are the faces of a slit, and no error, if both belong to chains of the mesh.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from iga.mesh.bezier import homogeneous, jacobian
from iga.mesh.edges import SAME_POINT, Sides, element_sides, nearest, walked
from iga.mesh.extraction import Mesh
from iga.mesh.quadrature import gauss, square
from iga.mesh.rank import coefficients, rank

#: Largest error of the sum of the functions. Files hold 16 or 17 digits: 25 coefficients then add up within 1e-14.
UNITY = 1e-10


@dataclass(frozen=True)
class SoundnessSettings:
    """How torn, doubled and overlapping elements are found.

    ended : coefficient on a side below which a function, of size one, vanishes there.
    touching : distance below which two boundary sides lie on each other, as a part of the length of the side and of the
        height of its element.
    samples : parameters at which sides are compared; none is a simple fraction, where hanging nodes lie.
    pieces : straight pieces of a side in the search for overlaps; more pieces follow curved sides more closely.
    chunk : pairs of a point and a side that are treated together, for the sake of memory.
    """

    ended: float = 1e-9
    touching: float = 1e-2
    samples: tuple[float, ...] = (0.137, 0.291, 0.413, 0.587, 0.709, 0.863)
    pieces: int = 8
    chunk: int = 1_000_000


SOUNDNESS = SoundnessSettings()


def missed_unity(mesh: Mesh) -> float:
    """Largest ``|sum_a N_a - 1|`` or ``|sum_a w_a N_a - 1|`` in Bernstein coefficients, of the sum that comes closer.

    Semi-standard T-splines satisfy the second sum. Bernstein polynomials whose value and gradient vanish on all sides
    are left out: constructions at extraordinary points can leave a bubble of degree four inside an element, which the
    rational functions divide out.
    """
    plain, weighted = [], []
    for block in mesh.blocks:
        p, q = block.degrees
        inner_ji = np.zeros((q + 1, p + 1), dtype=bool)
        inner_ji[2 : q - 1, 2 : p - 1] = True
        C_eab = block.C_eab[..., ~inner_ji.ravel()]
        plain.append(np.abs(C_eab.sum(1) - 1.0).max())
        weighted.append(np.abs(np.einsum("ea,eab->eb", mesh.w_A[block.conn_ea], C_eab) - 1.0).max())
    return float(min(max(plain), max(weighted)))


def unity_fault(mesh: Mesh) -> tuple[str, ...]:
    """A sentence if the functions do not add up to 1 within `UNITY`, else empty."""
    missed = missed_unity(mesh)
    return (f"the sum of the functions misses 1 by {missed:.3g}",) if missed > UNITY else ()


def dependence(mesh: Mesh) -> tuple[str, ...]:
    """A sentence if the functions are linearly dependent, so that stiffness matrices are singular, else empty."""
    found, count = rank(coefficients(mesh)), len(mesh.P_AI)
    return (f"the functions are dependent: rank {found} of {count}",) if found < count else ()


def faults(mesh: Mesh, sides: Sides | None = None) -> tuple[str, ...]:
    """Sentences that say why a mesh with positive Jacobians is not one body; empty for a sound mesh.

    Overlaps are found from the boundary, at seven points of each of its sides. A side is torn where place or functions
    of its neighbour differ by more than `SAME_POINT`.
    """
    sides = element_sides(mesh) if sides is None else sides
    found = list(_shared_badly(sides)) or list(_pieces(sides))
    if found:
        return tuple(found)
    k_n = np.flatnonzero(~sides.shared_k)
    return (*_vertices(sides, k_n), *_endless(mesh, sides, k_n), *_in_the_body(mesh, sides, k_n))


def _shared_badly(sides: Sides) -> Iterator[str]:
    """Sides with a neighbour along a part of them only, with several, or with one that overlaps their element."""
    torn_k, doubled_k = np.zeros((2, len(sides.side_k)), dtype=bool)
    whole_k = sides.length_k >= SAME_POINT * sides.size_k  # many elements may share a side of length zero
    count_k = np.bincount(sides.edge_k)[sides.edge_k]
    doubled_k |= whole_k & (count_k > 2)
    order = np.flatnonzero(whole_k & (count_k == 2))
    k, other = order[np.argsort(sides.edge_k[order], kind="stable")].reshape(-1, 2).T
    covered_sk = np.zeros((len(SOUNDNESS.samples), len(torn_k)), dtype=bool)
    for covered_k, t in zip(covered_sk, SOUNDNESS.samples, strict=True):
        same, against = _same(sides, k, other, np.full(len(k), t))
        torn_k[k[~same]] = True
        doubled_k[k[same & ~against]] = True
        lone = sides.lone
        point, side, _ = sides.on(sides.points(lone, np.full(len(lone), t)), sides.size_k[lone])
        beside = lone[point] != side
        here, there = lone[point[beside]], side[beside]
        _, against = _same(sides, here, there, np.full(len(here), t))
        doubled_k[here[~against]] = True
        covered_k[here] = True
    torn_k |= np.any(covered_sk, axis=0) & ~np.all(covered_sk, axis=0) & ~doubled_k
    if np.any(doubled_k):
        many = f"{_count(doubled_k)} with more than one neighbour, {_first(sides, doubled_k)}"
        yield f"elements lie on each other: {many}"
    if np.any(torn_k):
        yield f"the mesh is torn: {_count(torn_k)} shared in part, {_first(sides, torn_k)}"


def _same(sides: Sides, k_n: np.ndarray, other_n: np.ndarray, t_n: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Whether points of sides coincide with points of other sides, and whether those run the other way."""
    X_nI, H_nbI = sides.points(k_n, t_n), sides.H_kbI[other_n]
    there_n = 1.0 - t_n
    away_nI = np.abs(sides.points(other_n, there_n) - X_nI)
    off = np.flatnonzero(
        np.any(away_nI[:, :2] >= SAME_POINT * sides.size_k[k_n, None], axis=1) | (away_nI[:, 2] >= SAME_POINT)
    )
    there_n[off] = nearest(H_nbI[off], X_nI[off, :2])
    away_nI = np.abs(sides.points(other_n, there_n) - X_nI)
    size_n = np.minimum(sides.size_k[k_n], sides.size_k[other_n])
    same_n = (np.hypot(away_nI[:, 0], away_nI[:, 1]) < SAME_POINT * size_n) & (away_nI[:, 2] < SAME_POINT)
    return same_n, np.sum(_tangent(sides, k_n, t_n) * _tangent(sides, other_n, there_n), axis=1) < 0.0


def _pieces(sides: Sides) -> Iterator[str]:
    element_k = np.arange(len(sides.side_k)) // 4
    k, other, _ = sides.opposite
    n_e = len(sides.side_k) // 4
    graph = coo_array((np.ones(len(k)), (element_k[k], element_k[other])), shape=(n_e, n_e))
    pieces, piece_e = connected_components(graph, directed=False)
    if pieces > 1:
        smallest_k = (piece_e == np.argmin(np.bincount(piece_e)))[element_k]
        yield f"the mesh falls into {pieces} pieces that share no side, the smallest {_near(sides, smallest_k)}"


def _vertices(sides: Sides, k_n: np.ndarray) -> Iterator[str]:
    """Vertices in which the boundary touches itself."""
    start_n = sides.vertex_kv[k_n, 0]
    many_n = np.bincount(start_n)[start_n] > 1
    if np.any(many_n):
        yield f"the boundary touches itself in a vertex {_near(sides, _marked(sides, k_n[many_n]), 0.0)}"


def _endless(mesh: Mesh, sides: Sides, k_n: np.ndarray) -> Iterator[str]:
    """Sides of the boundary beyond which functions continue.

    More functions live on such a side than there are polynomials, and their traces on the boundary are dependent. The
    functions of a hierarchical basis can be more than the polynomials too, but their traces are independent.
    """
    rows, columns, values, at, first, alive_n = [], [], [], [], 0, np.zeros(len(k_n), dtype=int)
    highest_n = np.zeros(len(k_n), dtype=int)
    for b, block in enumerate(mesh.blocks):
        for name in np.unique(sides.side_k):
            n = np.flatnonzero((sides.block_k[k_n] == b) & (sides.side_k[k_n] == name))
            e, walk = sides.element_k[k_n[n]], walked(block.degrees, name)
            C_nab = block.C_eab[e][:, :, walk]
            alive_na = np.abs(C_nab).max(2, initial=0.0) > SOUNDNESS.ended
            alive_n[n], highest_n[n] = alive_na.sum(1), len(walk)
            conn_nab = np.broadcast_to(block.conn_ea[e][..., None], C_nab.shape)
            column_nab = first + np.arange(len(n) * len(walk)).reshape(len(n), 1, len(walk))
            rows.append(conn_nab.ravel())
            columns.append(np.broadcast_to(column_nab, C_nab.shape).ravel())
            values.append(np.where(alive_na[..., None], C_nab, 0.0).ravel())
            at.append(np.broadcast_to(n[:, None, None], C_nab.shape).ravel())
            first += len(n) * len(walk)
    row, column, value, side = (np.concatenate(parts) for parts in (rows, columns, values, at))
    crossed_n = alive_n > highest_n
    if not np.any(crossed_n):
        return
    traces = coo_array((value, (row, column)), shape=(len(mesh.P_AI), first)).tocsr()
    crossing = np.unique(row[crossed_n[side] & (value != 0.0)])
    if rank(traces[crossing]) < rank(coefficients(mesh)[crossing]):
        where_k = _marked(sides, k_n[crossed_n])
        beyond = f"functions go on beyond {_count(where_k)} of the boundary, {_first(sides, where_k)}"
        yield f"the mesh is torn or an element is missing: {beyond}"


def _in_the_body(mesh: Mesh, sides: Sides, k_n: np.ndarray) -> Iterator[str]:
    """Sides of the boundary that coincide without being a slit, or that lie inside an element."""
    touching_n, against_n = _touching(mesh, sides, k_n)
    torn_k = _marked(sides, k_n[touching_n & against_n])
    overlapping_k = _marked(sides, k_n[_covered(sides, k_n, ~touching_n) | (touching_n & ~against_n)])
    if np.any(torn_k):
        slit = "the faces of a slit have to be side sets"
        yield f"the mesh is torn: {_count(torn_k)} of the boundary on each other, {_first(sides, torn_k)}; {slit}"
    if np.any(overlapping_k):
        inside = f"{_count(overlapping_k)} of the boundary inside the body, {_first(sides, overlapping_k)}"
        yield f"elements overlap: {inside}"


def _touching(mesh: Mesh, sides: Sides, k_n: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Masks of boundary sides that coincide with others, pairs of chains excepted, and of those that run opposite."""
    chained_k = np.zeros(len(sides.side_k), dtype=bool)
    for chain in mesh.chains.values():
        chained_k[sides.find(chain.block_c, chain.element_c, chain.side_c)] = True
    X_nbI = sides.H_kbI[k_n, :, :2] / sides.H_kbI[k_n, :, 3:]
    low_nI, high_nI = X_nbI.min(1), X_nbI.max(1)
    slack_n = SOUNDNESS.touching * np.minimum(sides.length_k[k_n], _heights(mesh, sides)[k_n])
    touching_n, against_n = np.ones(len(k_n), dtype=bool), np.ones(len(k_n), dtype=bool)
    for t in (0.25, 0.5, 0.75):
        x_nI = sides.points(k_n, np.full(len(k_n), t))
        slack_nm = np.minimum(slack_n[:, None], slack_n)[..., None]
        inside_nm = np.all((low_nI - slack_nm <= x_nI[:, None, :2]) & (x_nI[:, None, :2] <= high_nI + slack_nm), axis=2)
        np.fill_diagonal(inside_nm, False)
        inside_nm &= ~(chained_k[k_n][:, None] & chained_k[k_n])
        n, m = np.nonzero(inside_nm)
        there = nearest(sides.H_kbI[k_n[m]], x_nI[n, :2])
        away = np.linalg.norm(sides.points(k_n[m], there)[:, :2] - x_nI[n, :2], axis=1)
        on = away < np.minimum(slack_n[n], slack_n[m])
        n, m, there = n[on], m[on], there[on]
        turned = np.sum(_tangent(sides, k_n[n], np.full(len(n), t)) * _tangent(sides, k_n[m], there), axis=1) < 0.0
        touching_n &= np.isin(np.arange(len(k_n)), n)
        against_n[n[~turned]] = False
    return touching_n, against_n


def _covered(sides: Sides, k_n: np.ndarray, asked_n: np.ndarray) -> np.ndarray:
    """Sides of the boundary inside an element, by the winding number of the boundary about their points.

    The boundary, walked with the body on the left, turns by pi about a point on itself, and by 2 pi more for every
    element over the point. A side whose bounding box contains the point is divided into straight pieces, the others are
    replaced by their chords. Points that are closer to another side than its pieces are to the curve are left out.
    """
    t_j = np.linspace(0.0, 1.0, 2 * SOUNDNESS.pieces + 1)
    X_njI = sides.points(np.repeat(k_n, len(t_j)), np.tile(t_j, len(k_n)))[:, :2].reshape(len(k_n), len(t_j), 2)
    X_npI = X_njI[:, ::2]
    sag_np = np.linalg.norm(X_njI[:, 1::2] - 0.5 * (X_npI[:, :-1] + X_npI[:, 1:]), axis=2)
    sag_n = 4.0 * sag_np.max(1) + SAME_POINT * sides.length_k[k_n]
    hull_nbI = sides.H_kbI[k_n, :, :2] / sides.H_kbI[k_n, :, 3:]
    low_nI, high_nI = hull_nbI.min(1) - sag_n[:, None], hull_nbI.max(1) + sag_n[:, None]
    asked = np.flatnonzero(asked_n)
    x_sI, own_s = X_npI[asked, 1:-1].reshape(-1, 2), np.repeat(asked, SOUNDNESS.pieces - 1)
    covered_n = np.zeros(len(k_n), dtype=bool)
    for part in np.array_split(np.arange(len(x_sI)), 1 + len(x_sI) * len(k_n) // SOUNDNESS.chunk):
        x_snI = x_sI[part, None]
        angle_sn = _angle(X_npI[:, 0] - x_snI, X_npI[:, -1] - x_snI)
        s, n = np.nonzero(np.all((low_nI <= x_snI) & (x_snI <= high_nI), axis=2))
        pieces_mpI = X_npI[n] - x_sI[part[s], None]
        a, b = pieces_mpI[:, :-1], pieces_mpI[:, 1:]
        angle_sn[s, n] = _angle(a, b).sum(1)
        along = np.clip(-np.sum(a * (b - a), -1) / np.maximum(np.sum((b - a) ** 2, -1), 1e-300), 0.0, 1.0)
        away_m = np.linalg.norm(a + along[..., None] * (b - a), axis=-1).min(1)
        unclear = s[(away_m <= sag_n[n]) & (n != own_s[part[s]])]
        inside_s = angle_sn.sum(1) > 2.0 * np.pi
        inside_s[unclear] = False
        covered_n[own_s[part[inside_s]]] = True
    return covered_n


def _angle(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Angles from vectors a (..., 2) to b, counterclockwise; 0 if one of them has no length."""
    cross = a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]
    dot = a[..., 0] * b[..., 0] + a[..., 1] * b[..., 1]
    return np.arctan2(cross, dot + 0.0)  # + 0.0: a dot product of -0.0 would give the angle pi


def _heights(mesh: Mesh, sides: Sides) -> np.ndarray:
    """Height (n_k,) of the element over each side: its area over the length of the side."""
    area = []
    for block in mesh.blocks:
        points_q, weights_q = square(*(gauss(p + 1) for p in block.degrees))
        area.append(jacobian(homogeneous(mesh.P_AI, mesh.w_A, block), block.degrees, points_q) @ weights_q)
    return np.repeat(np.concatenate(area), 4) / np.maximum(sides.length_k, np.finfo(float).tiny)


def _tangent(sides: Sides, k_n: np.ndarray, t_n: np.ndarray) -> np.ndarray:
    """Tangents (n, 2) of sides by a difference quotient, not normalised."""
    ends = (np.clip(t_n + step, 0.0, 1.0) for step in (1e-3, -1e-3))
    ahead, behind = (sides.points(k_n, t)[:, :2] for t in ends)
    return ahead - behind


def _marked(sides: Sides, k_n: np.ndarray) -> np.ndarray:
    marked_k = np.zeros(len(sides.side_k), dtype=bool)
    marked_k[k_n] = True
    return marked_k


def _count(marked_k: np.ndarray) -> str:
    count = int(np.count_nonzero(marked_k))
    return f"{count} side{'s' * (count > 1)}"


def _first(sides: Sides, marked_k: np.ndarray) -> str:
    return f"the first {_near(sides, marked_k)}"


def _near(sides: Sides, marked_k: np.ndarray, t: float = 0.5) -> str:
    x, y, _ = sides.points(np.flatnonzero(marked_k)[:1], np.array([t]))[0]
    return f"near ({x:.4g}, {y:.4g})"
