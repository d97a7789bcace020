"""Any T-mesh made analysis-suitable: of two lines whose extensions meet, the cheaper one goes on to the next line."""

from __future__ import annotations

import numpy as np

from iga.tsplines.tmesh import FRAME, TMesh, neighbours, painted, span_points


def made_suitable(mesh: TMesh) -> TMesh:
    """The T-mesh with lines prolonged until no extensions of T-junctions meet.

    Wherever two meet, the T-junction that has the shorter way to the next line is moved there. Knots stay as they are
    and edges are only added, so that this ends with the full grid at the latest. Scott, Li, Sederberg, Hughes 2012
    look ahead to add fewer edges.
    """
    while len(chosen := _cheaper(mesh)):
        mesh = _prolonged(mesh, chosen)
    return mesh


def _cheaper(mesh: TMesh) -> np.ndarray:
    """The T-junctions (n, 3) that are cheapest to move at the points where extensions meet."""
    level, upright = mesh.extensions
    flat = mesh.junctions[:, 2] < 2
    junctions = np.concatenate([mesh.junctions[flat], mesh.junctions[~flat]])
    i_h, j_h, n_h = span_points(level)
    j_v, i_v, n_v = span_points(upright)
    m_t = len(mesh.knots_j)
    point_h, point_v = i_h * m_t + j_h, i_v * m_t + j_v
    point = np.concatenate([point_h, point_v])
    junction = np.concatenate([n_h, n_v + len(level)])
    met = np.isin(point, np.intersect1d(point_h, point_v))
    point, junction = point[met], junction[met]
    order = np.lexsort((junction, _way(mesh, junctions)[junction], point))
    _, first = np.unique(point[order], return_index=True)
    return junctions[np.unique(junction[order[first]])]


def _next(mesh: TMesh, junctions: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Spans from T-junctions to the next line, horizontal (i0, i1, j) and vertical (j0, j1, i)."""
    i, j, missing = junctions.T
    flat = missing < 2
    spans = []
    for hit, a, line, forwards in (
        (mesh.crossed_ij, i[flat], j[flat], missing[flat] == 0),
        (mesh.levelled_ij.T, j[~flat], i[~flat], missing[~flat] == 2),
    ):
        before, _, after = neighbours(hit, a, line, 1).T
        spans.append(np.stack([np.where(forwards, a, before), np.where(forwards, after, a), line], -1))
    return spans[0], spans[1]


def _way(mesh: TMesh, junctions: np.ndarray) -> np.ndarray:
    """Lengths (n,) from T-junctions, horizontal ones first, to the next line, as parts of the domain."""
    ways = []
    for spans, knots in zip(_next(mesh, junctions), (mesh.knots_i, mesh.knots_j), strict=True):
        start, end, _ = spans.T
        ways.append((knots[end] - knots[start]) / (knots[-1] - knots[0]))
    return np.concatenate(ways)


def _prolonged(mesh: TMesh, junctions: np.ndarray) -> TMesh:
    """The T-mesh with the lines of these T-junctions drawn on to the next line."""
    level, upright = _next(mesh, junctions)
    shape = len(mesh.knots_i), len(mesh.knots_j)
    across = mesh.across_ij | painted(level, shape)
    up = mesh.up_ij | painted(upright, shape[::-1]).T
    for along in (across, up.T):
        along[:FRAME] |= along[FRAME]
        along[-FRAME:] |= along[-FRAME - 1]
    return TMesh(mesh.knots_i, mesh.knots_j, across, up)
