"""Cells: rectangles of Bezier elements, traced to one another by the functions that live on their corners and sides.

A corner or side of two cells is the same where all functions of the mesh have the same values on it. Random numbers in
place of control points tell that apart from points that merely coincide, such as the two faces of a crack.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from iga.bernstein import bernstein, tensor
from iga.bezier import homogeneous
from iga.extraction import Mesh

#: Two points are one where all their random coordinates, which lie in [0, 1], agree to this: files may have few digits.
SAME = 1e-6

#: Parameters of the corners of a cell, counterclockwise; side k runs from corner k to the next.
CORNERS = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)])
SIDE_NAMES = np.array(["BOTTOM", "RIGHT", "TOP", "LEFT"])


@dataclass(frozen=True, eq=False)
class Cells:
    """Cells of a mesh: the rectangle ``box_cds`` (n_c, 2, 2) [direction, end] of element ``element_c`` of a block."""

    mesh: Mesh
    block_c: np.ndarray
    element_c: np.ndarray
    box_cds: np.ndarray

    def cut(self, direction: int, at_c: np.ndarray) -> tuple[Cells, np.ndarray]:
        """Cells cut in two at a parameter of their elements, whole where it is NaN; and where each comes from."""
        cut_c = ~np.isnan(at_c)
        source = np.repeat(np.arange(len(at_c)), 1 + cut_c)
        second = np.diff(source, prepend=-1) == 0
        box = self.box_cds[source]
        box[cut_c[source] & ~second, direction, 1] = at_c[cut_c]
        box[second, direction, 0] = at_c[cut_c]
        return Cells(self.mesh, self.block_c[source], self.element_c[source], box), source

    def halved(self) -> Cells:
        """Every cell cut into four."""
        cells = self
        for direction in (0, 1):
            cells, _ = cells.cut(direction, cells.box_cds[:, direction].mean(1))
        return cells

    def points(self, c_n: np.ndarray, xi_nd: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Random coordinates (n, 4) and positions (n, 2) at parameters (n, 2) in [0, 1] of the cells c_n (n,)."""
        box = self.box_cds[c_n]
        st = box[:, :, 0] * (1.0 - xi_nd) + box[:, :, 1] * xi_nd
        values = np.empty((len(c_n), 7))
        for number in np.unique(self.block_c[c_n]):
            here = np.flatnonzero(self.block_c[c_n] == number)
            p, q = self.mesh.blocks[number].degrees
            B_nb = tensor(bernstein(p, st[here, 0]), bernstein(q, st[here, 1]))
            values[here] = np.einsum("nb,nbk->nk", B_nb, self._bezier[number][self.element_c[c_n[here]]])
        return values[:, :4] / values[:, 6:], values[:, 4:6] / values[:, 6:]

    @cached_property
    def _bezier(self) -> tuple[np.ndarray, ...]:
        """Homogeneous Bezier points (n_e, n_b, 7) of each block: random coordinates, position, weight."""
        random = np.random.default_rng(20131).random((len(self.mesh.P_AI), 4))
        columns = np.concatenate([random, self.mesh.P_AI], axis=1)
        return tuple(homogeneous(columns, self.mesh.w_A, block) for block in self.mesh.blocks)

    @cached_property
    def corner_ck(self) -> np.ndarray:
        """Number (n_c, 4) of the vertex at each corner."""
        n_c = len(self.block_c)
        random, _ = self.points(np.repeat(np.arange(n_c), 4), np.tile(CORNERS, (n_c, 1)))
        return _merged(random).reshape(-1, 4)

    @cached_property
    def side_ck(self) -> np.ndarray:
        """Number (n_c, 4) of each side: one for both cells at it."""
        n_c, start, end = len(self.block_c), self.corner_ck, np.roll(self.corner_ck, -1, axis=1)
        middles = 0.5 * (CORNERS + np.roll(CORNERS, -1, axis=0))
        middle = _merged(self.points(np.repeat(np.arange(n_c), 4), np.tile(middles, (n_c, 1)))[0])
        keys = np.stack([np.minimum(start, end).ravel(), np.maximum(start, end).ravel(), middle], -1)
        return np.unique(keys, axis=0, return_inverse=True)[1].reshape(-1, 4)

    @property
    def lonely_ck(self) -> np.ndarray:
        """Whether a side (n_c, 4) belongs to one cell only."""
        return np.bincount(self.side_ck.ravel())[self.side_ck] == 1


def whole_cells(mesh: Mesh) -> Cells:
    """Every element as one cell."""
    count = [len(block.conn_ea) for block in mesh.blocks]
    block_c = np.repeat(np.arange(len(count)), count)
    element_c = np.concatenate([np.arange(n) for n in count])
    return Cells(mesh, block_c, element_c, np.tile([0.0, 1.0], (len(block_c), 2, 1)))


def _merged(x_nk: np.ndarray) -> np.ndarray:
    """One number (n,) for all points that are the same."""
    pairs = cKDTree(x_nk).query_pairs(SAME, output_type="ndarray")
    graph = coo_array((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(len(x_nk), len(x_nk)))
    return connected_components(graph, directed=False)[1]
