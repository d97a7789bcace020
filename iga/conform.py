"""Hanging nodes: cells are cut where the corner of a neighbour lies on their side, until none is left."""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from iga.cells import SAME, Cells, whole_cells
from iga.extraction import Mesh

#: Rounds of cuts before giving up: a cut crosses one element a round.
ROUNDS = 200


def conforming(mesh: Mesh) -> Cells:
    """Cells that meet side to side: the elements, cut along the lines that end on their sides.

    Raises
    ------
    ValueError : cuts that go on for ever, as they may where they wind around an extraordinary point.
    """
    cells = whole_cells(mesh)
    for _ in range(ROUNDS):
        cut, direction, at = _hanging(cells)
        if not cut.size:
            return cells
        at_cd = np.full((len(cells.block_c), 2), np.nan)
        at_cd[cut, direction] = at  # of several cuts across one cell one is made, the others in the next rounds
        cells, source = cells.cut(0, at_cd[:, 0])
        cells, _ = cells.cut(1, at_cd[source, 1])
    raise ValueError(f"hanging nodes are left after {ROUNDS} rounds of cuts, at {len(cells.block_c)} cells")


def _hanging(cells: Cells) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Cells that must be cut, across which direction, at which parameter of the element."""
    c, k = np.nonzero(cells.lonely_ck)
    start, end = cells.corner_ck[c, k], cells.corner_ck[c, (k + 1) % 4]
    vertex, first = np.unique(np.concatenate([start, end]), return_index=True)
    corner = np.concatenate([k, (k + 1) % 4])[first]
    random, x = cells.points(np.tile(c, 2)[first], np.stack([np.isin(corner, (1, 2)), corner > 1], -1).astype(float))
    samples = np.linspace(0.0, 1.0, 9)
    along = _on_sides(cells, np.repeat(c, 9), np.repeat(k, 9), np.tile(samples, len(c)))
    side_random, side_x = (part.reshape(len(c), 9, -1) for part in along)
    radius = 1.1 * np.linalg.norm(side_x - side_x[:, 4:5], axis=2).max(1)
    near = cKDTree(x).query_ball_point(side_x[:, 4], radius)
    side = np.repeat(np.arange(len(c)), [len(found) for found in near])
    v = np.concatenate([*near, []]).astype(int)
    inside = (vertex[v] != start[side]) & (vertex[v] != end[side])
    side, v = side[inside], v[inside]
    tau = samples[np.argmin(np.linalg.norm(side_random[side] - random[v][:, None], axis=2), axis=1)]
    tau, distance = _closest(cells, c[side], k[side], tau, random[v])
    on = (distance < SAME) & (tau > SAME) & (tau < 1.0 - SAME)
    cut, direction = c[side[on]], k[side[on]] % 2
    ends = cells.box_cds[cut, direction]
    return cut, direction, ends[:, 0] + tau[on] * (ends[:, 1] - ends[:, 0])


def _on_sides(cells: Cells, c: np.ndarray, k: np.ndarray, tau: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Points at tau in [0, 1] along the side's own parameter."""
    fixed = np.isin(k, (1, 2)).astype(float)
    return cells.points(c, np.where((k % 2 == 0)[:, None], np.stack([tau, fixed], -1), np.stack([fixed, tau], -1)))


def _closest(
    cells: Cells, c: np.ndarray, k: np.ndarray, tau: np.ndarray, goal: np.ndarray, step: float = 1e-4
) -> tuple[np.ndarray, np.ndarray]:
    """Parameter and distance of the closest point on each side, in random coordinates, by Gauss and Newton."""
    for _ in range(8):
        ahead, behind = (_on_sides(cells, c, k, tau + h)[0] for h in (step, -step))
        slope = (ahead - behind) / (2.0 * step)
        miss = goal - _on_sides(cells, c, k, tau)[0]
        tau = np.clip(tau + np.sum(miss * slope, 1) / np.maximum(np.sum(slope**2, 1), np.finfo(float).tiny), 0.0, 1.0)
    return tau, np.linalg.norm(goal - _on_sides(cells, c, k, tau)[0], axis=1)
