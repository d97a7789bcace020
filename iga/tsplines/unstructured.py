"""Bicubic splines on unstructured quadrilateral control meshes: extraction, extraordinary points included.

Every face with positive knot intervals is one Bezier element. Its inner Bezier points are means of its own four control
points, those on edges and corners are means of the adjacent inner ones (Scott, Simpson, Evans, Lipton, Bordas, Hughes,
Sederberg 2013, sec. 3). Around an extraordinary point the functions are C0 across the spokes and C1 elsewhere.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.sparse import coo_array, csr_array

from iga.bases.bspline import open_knots
from iga.mesh.boundary import boundary_chains
from iga.mesh.extraction import Chain, ElementBlock, Mesh

#: Bernstein indices of a bicubic element beside corner k: the inner point, and the points on edge k at its two ends.
INNER, CORNER = (5, 6, 10, 9), (0, 3, 15, 12)
EDGE_START, EDGE_END = (1, 7, 14, 8), (2, 11, 13, 4)


def unstructured_mesh(
    V_AI: np.ndarray, faces_fa: np.ndarray, intervals_fs: np.ndarray | None = None, w_A: np.ndarray | None = None
) -> Mesh:
    """Mesh of all faces with positive knot intervals; its outlines are the chains ``boundary``, ``boundary-1`` ...

    Parameters
    ----------
    V_AI : (n_A, 2) control points, not homogeneous.
    faces_fa : (n_f, 4) their numbers around each face, counterclockwise; s runs along the first edge.
    intervals_fs : (n_f, 2) knot intervals along s and t, equal on both sides of an edge. An open boundary is a ring of
        faces whose interval across the boundary is zero. Default: 1, but 0 across the outermost ring.
    w_A : (n_A,) positive weights; default: all 1.

    Raises
    ------
    ValueError : faces of different orientation, intervals that differ across an edge or are negative, no face with
        positive intervals or one without a neighbour on some side, or an extraordinary point on the boundary.
    """
    grid = _topology(np.asarray(faces_fa))
    h_fs = _open_intervals(grid) if intervals_fs is None else np.asarray(intervals_fs, dtype=float)
    w_A = np.ones(len(V_AI)) if w_A is None else np.asarray(w_A, dtype=float)
    element_f = np.all(h_fs > 0, axis=1)
    _refuse_wrong_intervals(grid, h_fs, element_f)
    rows = _bezier_rows(grid, h_fs, np.flatnonzero(element_f), len(V_AI))
    mesh = Mesh(np.asarray(V_AI, dtype=float), w_A, _blocks(rows))
    chains = boundary_chains(mesh)
    return replace(mesh, chains={f"boundary-{i}" if i else "boundary": chain for i, chain in enumerate(chains)})


@dataclass(frozen=True)
class _Topology:
    """Faces (n_f, 4) and, for each half-edge 4 f + k, the opposite one, or -1 on the boundary: ``twin_h``."""

    faces_fa: np.ndarray
    twin_h: np.ndarray

    def across(self, v_h: np.ndarray, outside: float) -> np.ndarray:
        """Values of the opposite half-edges; ``outside`` on the boundary."""
        return np.where(self.twin_h >= 0, v_h[self.twin_h], outside)


def _topology(faces_fa: np.ndarray) -> _Topology:
    start, end = faces_fa.ravel(), np.roll(faces_fa, -1, axis=1).ravel()
    n_h, n_A = start.size, int(faces_fa.max()) + 1
    key, opposite = start * n_A + end, end * n_A + start
    order = np.argsort(key, kind="stable")
    if np.any(np.diff(key[order]) == 0):
        twice = order[1:][np.diff(key[order]) == 0][0]
        raise ValueError(
            f"edge {start[twice]}-{end[twice]} is used twice in one direction: faces must be oriented alike"
        )
    at = np.minimum(np.searchsorted(key[order], opposite), n_h - 1)
    twin_h = np.where(key[order][at] == opposite, order[at], -1)
    return _Topology(faces_fa, twin_h)


def _open_intervals(grid: _Topology) -> np.ndarray:
    """Knot intervals (n_f, 2): 1, but 0 across the faces on the boundary."""
    edge_fk = grid.twin_h.reshape(-1, 4) < 0
    return 1.0 - np.stack([edge_fk[:, 1] | edge_fk[:, 3], edge_fk[:, 0] | edge_fk[:, 2]], -1)


def _refuse_wrong_intervals(grid: _Topology, h_fs: np.ndarray, element_f: np.ndarray) -> None:
    n_f = len(grid.faces_fa)
    if h_fs.shape != (n_f, 2) or not np.all(h_fs >= 0):
        raise ValueError(f"knot intervals must be {n_f} pairs >= 0, got shape {h_fs.shape}, the least {h_fs.min()}")
    along_h = np.tile(h_fs, 2).ravel()
    uneven = ~np.isclose(grid.across(along_h, np.nan), along_h, rtol=1e-12, atol=0.0) & (grid.twin_h >= 0)
    if np.any(uneven):
        h = int(np.argmax(uneven))
        intervals = f"{along_h[h]:g} and {along_h[grid.twin_h[h]]:g}"
        raise ValueError(f"edge {h % 4} of face {h // 4} must have one knot interval on both sides, got {intervals}")
    if not np.any(element_f):
        raise ValueError(f"some face must have positive knot intervals, got none among {n_f}")
    bare_f = element_f & np.any(grid.twin_h.reshape(-1, 4) < 0, axis=1)
    if np.any(bare_f):
        raise ValueError(f"face {int(np.argmax(bare_f))} lies on the boundary and must have a zero interval across it")
    valence_A = np.bincount(grid.faces_fa.ravel())
    at_rim_A = np.bincount(grid.faces_fa[~element_f].ravel(), minlength=len(valence_A)) > 0
    of_element_A = np.bincount(grid.faces_fa[element_f].ravel(), minlength=len(valence_A)) > 0
    wrong_A = at_rim_A & of_element_A & (valence_A != 4)
    if np.any(wrong_A):
        A = int(np.argmax(wrong_A))
        raise ValueError(f"vertex {A} touches a face of zero interval and must have valence 4, got {valence_A[A]}")


def _bezier_rows(grid: _Topology, h_fs: np.ndarray, elements: np.ndarray, n_A: int) -> csr_array:
    """Bezier points (16 n_e, n_A) of the elements as linear combinations of control points, index 16 e + 4 j + i."""
    n_h = grid.twin_h.size
    across_h = np.roll(np.tile(h_fs, 2), -1, axis=1).ravel()  # interval of the own face across the half-edge
    beyond_h = grid.across(across_h, 0.0)
    inner = _inner_points(grid, h_fs, beyond_h.reshape(-1, 4), n_A)
    half_edge = 4 * elements[:, None] + np.arange(4)
    following = np.arange(n_h).reshape(-1, 4)[:, [1, 2, 3, 0]].ravel()
    own, other = half_edge.ravel(), grid.twin_h[half_edge.ravel()]
    # Each inner point has the interval of the other face as weight.
    share = beyond_h[own] / (beyond_h[own] + across_h[own])
    edge_start = _rows(own, share, n_h) @ inner + _rows(following[other], 1.0 - share, n_h) @ inner
    edge_end = _rows(following[own], share, n_h) @ inner + _rows(other, 1.0 - share, n_h) @ inner
    corner = _corner_means(grid, h_fs)[grid.faces_fa[elements].ravel()] @ inner
    rows = 16 * np.arange(len(elements))[:, None]
    placed = ((INNER, inner[own]), (CORNER, corner), (EDGE_START, edge_start), (EDGE_END, edge_end))
    return sum(_moved(part, (rows + place).ravel(), 16 * len(elements)) for place, part in placed)


def _inner_points(grid: _Topology, h_fs: np.ndarray, beyond_fk: np.ndarray, n_A: int) -> csr_array:
    """Inner Bezier points (4 n_f, n_A), 4 f + k beside corner k.

    In one direction, with intervals a before, h of the face and b behind: ``((h + b) P_0 + a P_1) / (a + h + b)``.
    """
    k = np.arange(4)
    far = []
    for before, behind, own in ((k - 1, (k + 1) % 4, k % 2), (k, (k + 2) % 4, (k + 1) % 2)):
        total = beyond_fk[:, before] + h_fs[:, own] + beyond_fk[:, behind]
        far.append(np.divide(beyond_fk[:, before], total, out=np.zeros_like(total), where=total > 0))
    along, up = far  # weights of the far vertices along edges k and k - 1
    weights = np.stack([(1 - along) * (1 - up), along * (1 - up), along * up, (1 - along) * up], -1)
    columns = grid.faces_fa[:, (k[:, None] + k) % 4]
    rows = np.repeat(np.arange(grid.twin_h.size), 4)
    return csr_array((weights.ravel(), (rows, columns.ravel())), shape=(grid.twin_h.size, n_A))


def _corner_means(grid: _Topology, h_fs: np.ndarray) -> csr_array:
    """Vertices as means (n_A, 4 n_f) of the adjacent inner points; weights of four: the areas of opposite faces."""
    n_h = grid.twin_h.size
    preceding = np.arange(n_h).reshape(-1, 4)[:, [3, 0, 1, 2]].ravel()
    turned = grid.twin_h[preceding]  # the half-edge of the next face around the same vertex
    opposite = turned[turned]
    vertex = grid.faces_fa.ravel()
    weight = np.where(np.bincount(vertex)[vertex] == 4, np.prod(h_fs, axis=1)[opposite // 4], 1.0)
    total = np.bincount(vertex, weight)
    weight = np.divide(weight, total[vertex], out=np.zeros(n_h), where=total[vertex] > 0)
    return csr_array((weight, (vertex, np.arange(n_h))), shape=(total.size, n_h))


def _rows(columns: np.ndarray, values: np.ndarray, n: int) -> csr_array:
    return csr_array((values, (np.arange(columns.size), columns)), shape=(columns.size, n))


def _moved(rows: csr_array, to: np.ndarray, n: int) -> csr_array:
    """A matrix of n rows with these rows at the places ``to``."""
    return csr_array((np.ones(to.size), (to, np.arange(to.size))), shape=(n, to.size)) @ rows


def _blocks(rows: csr_array) -> tuple[ElementBlock, ...]:
    """Elements grouped by their number of functions."""
    entries = coo_array(rows)
    alive = entries.data != 0.0
    row, column, value = entries.row[alive], entries.col[alive], entries.data[alive]
    n_e, n_A = rows.shape[0] // 16, rows.shape[1]
    pairs, which = np.unique(row // 16 * n_A + column, return_inverse=True)
    element, function = np.divmod(pairs, n_A)
    n_a = np.bincount(element, minlength=n_e)
    a = np.arange(pairs.size) - np.repeat(np.cumsum(n_a) - n_a, n_a)
    blocks, place_e = [], np.empty(n_e, dtype=int)
    for count in np.unique(n_a):
        e = np.flatnonzero(n_a == count)
        place_e[e] = np.arange(e.size)
        C_eab = np.zeros((e.size, count, 16))
        here = n_a[row // 16] == count
        C_eab[place_e[row[here] // 16], a[which[here]], row[here] % 16] = value[here]
        conn_ea = function[n_a[element] == count].reshape(e.size, count)
        blocks.append(ElementBlock((3, 3), C_eab, conn_ea))
    return tuple(blocks)


def polygon_mesh(corners: int, n: int, radius: float = 1.0) -> Mesh:
    """Regular polygon about the origin, n x n elements in each sector, with chains ``edge-0`` ... counterclockwise."""
    mesh = unstructured_mesh(*polygon_control(corners, n, radius))
    return replace(mesh, chains=dict(mesh.chains) | _edges(mesh.chains["boundary"], corners))


def polygon_control(corners: int, n: int, radius: float = 1.0) -> tuple[np.ndarray, np.ndarray]:
    """Control points (n_A, 2) and faces (n_f, 4) of a polygon, faces in the order sector, t, s.

    A sector is the quadrilateral of centre, middle of one edge, corner, middle of the next edge. Its control points
    reproduce the bilinear map exactly, with a ring of zero intervals along the outline. With four corners the centre is
    an ordinary point.

    Raises
    ------
    ValueError : fewer than 3 corners, or fewer than 1 element.
    """
    if corners < 3 or n < 1:
        raise ValueError(f"a polygon needs at least 3 corners and 1 element a sector side, got {corners} and {n}")
    reach = open_knots(np.linspace(-1.0, 1.0, 2 * n + 1), 3).greville[n + 1 :]  # n + 2 values, from 0 to 1
    t, s = np.meshgrid(reach, reach, indexing="ij")
    corner = radius * np.exp(2j * np.pi / corners * np.arange(corners))[:, None, None]
    before, after = 0.5 * (corner + np.roll(corner, 1, axis=0)), 0.5 * (corner + np.roll(corner, -1, axis=0))
    z_kji = s * (1 - t) * before + s * t * corner + (1 - s) * t * after
    number_kji = _numbers(corners, n + 2)
    z_A = np.empty(number_kji.max() + 1, dtype=complex)
    z_A[number_kji] = z_kji
    around = (number_kji[:, :-1, :-1], number_kji[:, :-1, 1:], number_kji[:, 1:, 1:], number_kji[:, 1:, :-1])
    return np.stack([z_A.real, z_A.imag], -1), np.stack(around, -1).reshape(-1, 4)


def _numbers(corners: int, m: int) -> np.ndarray:
    """Vertex numbers (corners, m, m) [sector, t, s]: the centre is 0, the row s = 0 is the next sector's row t = 0."""
    own = 1 + np.arange(corners * (m - 1) * m).reshape(corners, m, m - 1)  # s > 0
    spoke = np.roll(own, -1, axis=0)[:, 0, :]
    left = np.concatenate([np.zeros((corners, 1), dtype=int), spoke], axis=1)
    return np.concatenate([left[:, :, None], own], axis=2)


def _edges(outline: Chain, corners: int) -> dict[str, Chain]:
    """The outline cut at its corners, where two successive sides belong to one element."""
    same = (np.roll(outline.block_c, 1) == outline.block_c) & (np.roll(outline.element_c, 1) == outline.element_c)
    first = np.flatnonzero(same)[0]
    order = np.roll(np.arange(same.size), -first).reshape(corners, -1)
    chains = (Chain(outline.block_c[c], outline.element_c[c], outline.side_c[c], outline.outward) for c in order)
    return {f"edge-{i}": chain for i, chain in enumerate(chains)}
