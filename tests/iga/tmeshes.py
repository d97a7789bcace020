"""T-meshes for tests: bisected in two directions, made analysis-suitable, transposed."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from iga.mesh.extraction import Mesh
from iga.tsplines import tspline
from iga.tsplines.lines import tensor_grid, with_lines
from iga.tsplines.tmesh import FRAME, TMesh, neighbours
from iga.tsplines.transfer import transfer


@dataclass(frozen=True)
class Bisected:
    """Elements of a grid, some of them bisected: even levels by vertical lines, odd levels by horizontal lines.

    ``corner_ek`` (n_e, 2) are lower left corners in units of the initial grid, ``level_e`` (n_e,) how often each
    element was bisected.
    """

    breaks_s: np.ndarray
    breaks_t: np.ndarray
    corner_ek: np.ndarray
    level_e: np.ndarray

    @property
    def size_ek(self) -> np.ndarray:
        """Widths and heights (n_e, 2) in units of the initial grid."""
        return np.stack([0.5 ** ((self.level_e + 1) // 2), 0.5 ** (self.level_e // 2)], -1)

    @property
    def box_ek(self) -> np.ndarray:
        """Elements (n_e, 4) as s0, s1, t0, t1 in knot values."""
        ends = np.stack([self.corner_ek, self.corner_ek + self.size_ek], -1)
        knots = [np.interp(ends[:, k], np.arange(len(b)), b) for k, b in enumerate((self.breaks_s, self.breaks_t))]
        return np.concatenate(knots, axis=1)

    @property
    def tmesh(self) -> TMesh:
        return from_rectangles(self.box_ek)

    def refined(self, marked_e: np.ndarray) -> Bisected:
        """The marked elements bisected, and before them all coarser elements in the patch around each, and so on.

        The patch (Morgenstern and Peterseim 2015, degree 3) keeps the T-mesh analysis-suitable.
        """
        cut, size = np.zeros(len(self.level_e), dtype=bool), self.size_ek
        cut[marked_e] = True
        queue = list(np.flatnonzero(cut))
        while queue:
            e = queue.pop()
            reach = size[e] * ([1.5, 2.5] if self.level_e[e] % 2 == 0 else [2.5, 1.5])
            away = np.abs(self.corner_ek + size / 2 - self.corner_ek[e] - size[e] / 2)
            coarser = np.flatnonzero(np.all(away < reach + size / 2, axis=1) & (self.level_e < self.level_e[e]) & ~cut)
            cut[coarser] = True
            queue += list(coarser)
        level = self.level_e[cut] + 1
        half = Bisected(self.breaks_s, self.breaks_t, self.corner_ek[cut], level)
        second = half.corner_ek + half.size_ek * np.stack([level % 2 == 1, level % 2 == 0], -1)
        corner = np.concatenate([self.corner_ek[~cut], half.corner_ek, second])
        return Bisected(self.breaks_s, self.breaks_t, corner, np.concatenate([self.level_e[~cut], level, level]))


def initial(breaks_s: np.ndarray, breaks_t: np.ndarray) -> Bisected:
    """A grid, nothing bisected."""
    t, s = np.meshgrid(np.arange(len(breaks_t) - 1.0), np.arange(len(breaks_s) - 1.0), indexing="ij")
    corner_ek = np.stack([s.ravel(), t.ravel()], -1)
    return Bisected(np.asarray(breaks_s), np.asarray(breaks_t), corner_ek, np.zeros(len(corner_ek), dtype=int))


def from_rectangles(box_ek: np.ndarray) -> TMesh:
    """The T-mesh of a rectangle tiled by rectangles s0, s1, t0, t1; sides on one line have the same float."""
    s0, s1, t0, t1 = np.asarray(box_ek).T
    outline = tensor_grid(np.array([s0.min(), s1.max()]), np.array([t0.min(), t1.max()]))
    inner_s, inner_t = s0 > s0.min(), t0 > t0.min()
    return with_lines(outline, np.stack([s0, t0, t1], -1)[inner_s], np.stack([t0, s0, s1], -1)[inner_t])


def made_suitable(mesh: TMesh) -> TMesh:
    """The T-mesh with horizontal lines prolonged to the next line until no extensions of T-junctions meet."""
    while not mesh.suitable:
        (i0, i1, j), (j0, j1, i) = mesh.extensions[0].T[..., None], mesh.extensions[1].T
        meets = np.any((i0 <= i) & (i <= i1) & (j0 <= j) & (j <= j1), axis=1)
        i, j, missing = mesh.junctions[mesh.junctions[:, 2] < 2][meets].T
        before, _, after = neighbours(mesh.crossed_ij, i, j, 1).T
        across = mesh.across_ij.copy()
        for low, high, line in zip(np.where(missing == 0, i, before), np.where(missing == 0, after, i), j, strict=True):
            across[low:high, line] = True
        across[:FRAME] |= across[FRAME]
        across[-FRAME:] |= across[-FRAME - 1]
        mesh = TMesh(mesh.knots_i, mesh.knots_j, across, mesh.up_ij)
    return mesh


def transposed(mesh: TMesh) -> TMesh:
    """The same mesh with its directions exchanged."""
    return TMesh(mesh.knots_j, mesh.knots_i, mesh.up_ij.T, mesh.across_ij.T)


def faces(mesh: TMesh) -> np.ndarray:
    """Index boxes (n, 4) of the faces with area, without extensions."""
    return tspline.faces(mesh, mesh.across_ij, mesh.up_ij)


def transferred(old: TMesh, body: Mesh, new: TMesh) -> Mesh:
    """A T-spline on another T-mesh: the same body where the new T-mesh refines the old one."""
    matrix = transfer(old, new)
    w_A = matrix @ body.w_A
    return tspline.tspline_mesh(new, (matrix @ (body.w_A[:, None] * body.P_AI)) / w_A[:, None], w_A)


def half_fine(n: int) -> TMesh:
    """The unit square, 2 n columns below the middle and n above it: T-junctions along the middle. ``n`` is even."""
    s = np.linspace(0.0, 1.0, 2 * n + 1)
    t = np.concatenate([np.linspace(0.0, 0.5, n + 1), np.linspace(0.5, 1.0, n // 2 + 1)[1:]])
    knots_s, knots_t = (np.concatenate([[0.0] * 3, x, [1.0] * 3]) for x in (s, t))
    up = np.ones((knots_s.size, knots_t.size - 1), dtype=bool)
    up[4:-4:2, np.searchsorted(knots_t, 0.5) :] = False
    return TMesh(knots_s, knots_t, np.ones((knots_s.size - 1, knots_t.size), dtype=bool), up)
