"""Bicubic splines on unstructured quadrilateral control meshes: extraction, extraordinary points included.

Every face with positive knot intervals is one Bezier element. Its inner Bezier points are means of its own four control
points, those on edges and corners are means of the adjacent inner ones (Scott, Simpson, Evans, Lipton, Bordas, Hughes,
Sederberg 2013, sec. 3). Around an extraordinary point the functions are C0 across the spokes and C1 elsewhere.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_array, csr_array

from iga.bases.bspline import open_knots
from iga.mesh.extraction import ElementBlock, Mesh

#: Bernstein indices of a bicubic element beside corner k: the inner point, and the points on edge k at its two ends.
INNER, CORNER = (5, 6, 10, 9), (0, 3, 15, 12)
EDGE_START, EDGE_END = (1, 7, 14, 8), (2, 11, 13, 4)


def unstructured_mesh(V_AI: np.ndarray, faces_fa: np.ndarray) -> Mesh:
    """Mesh of all faces but the outermost ring, across which the knot intervals are zero; all others are one.

    Parameters
    ----------
    V_AI : (n_A, 2) control points of weight one.
    faces_fa : (n_f, 4) their numbers around each face, counterclockwise; s runs along the first edge. No extraordinary
        point lies on the outline.
    """
    grid = _topology(np.asarray(faces_fa))
    h_fs = _open_intervals(grid)
    rows = _bezier_rows(grid, h_fs, np.flatnonzero(np.all(h_fs > 0, axis=1)), len(V_AI))
    return Mesh(np.asarray(V_AI, dtype=float), np.ones(len(V_AI)), _blocks(rows))


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
    at = np.minimum(np.searchsorted(key[order], opposite), n_h - 1)
    twin_h = np.where(key[order][at] == opposite, order[at], -1)
    return _Topology(faces_fa, twin_h)


def _open_intervals(grid: _Topology) -> np.ndarray:
    """Knot intervals (n_f, 2): 1, but 0 across the faces on the boundary."""
    edge_fk = grid.twin_h.reshape(-1, 4) < 0
    return 1.0 - np.stack([edge_fk[:, 1] | edge_fk[:, 3], edge_fk[:, 0] | edge_fk[:, 2]], -1)


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


def polygon_mesh(corners: int, n: int) -> Mesh:
    """Regular polygon of radius 1 about the origin, n x n elements in each sector."""
    return unstructured_mesh(*polygon_control(corners, n))


def polygon_control(corners: int, n: int) -> tuple[np.ndarray, np.ndarray]:
    """Control points (n_A, 2) and faces (n_f, 4) of a polygon, faces in the order sector, t, s.

    A sector is the quadrilateral of centre, middle of one edge, corner, middle of the next edge. Its control points
    reproduce the bilinear map exactly, with a ring of zero intervals along the outline. With four corners the centre is
    an ordinary point.
    """
    reach = open_knots(np.linspace(-1.0, 1.0, 2 * n + 1), 3).greville[n + 1 :]  # n + 2 values, from 0 to 1
    t, s = np.meshgrid(reach, reach, indexing="ij")
    corner = np.exp(2j * np.pi / corners * np.arange(corners))[:, None, None]
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
