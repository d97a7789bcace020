"""Lines of a mesh as long paths: each side once, continued from element to element.

Outlines of elements would draw every side twice and take three quarters of the bytes of a page.
"""

from __future__ import annotations

import numpy as np

#: Distance, over the largest coordinate, within which two points coincide.
_SAME_PLACE = 1e-7

#: Cosine of the angle between two sides that continue each other.
_STRAIGHT_ON = 0.8


def sides(x_euvi: np.ndarray) -> np.ndarray:
    """Sides of the elements (n, m, 2), each once, from sampling grids (n_e, m, m, 2)."""
    sides_nki = np.concatenate([x_euvi[:, :, 0], x_euvi[:, -1], x_euvi[:, :, -1], x_euvi[:, 0]])
    names_nki = _names(sides_nki)
    first, last = names_nki[:, 0], names_nki[:, -1]
    back = (first[:, 0] > last[:, 0]) | ((first[:, 0] == last[:, 0]) & (first[:, 1] > last[:, 1]))
    sides_nki, names_nki = (np.where(back[:, None, None], given[:, ::-1], given) for given in (sides_nki, names_nki))
    return sides_nki[np.unique(names_nki.reshape(len(names_nki), -1), axis=0, return_index=True)[1]]


def strokes(lines_nki: np.ndarray) -> np.ndarray:
    """Points (n_p, 2) of one path over all lines (n, k, 2), with NaN between strokes."""
    if not len(lines_nki):
        return np.zeros((0, 2))
    onward, ends = _onward(lines_nki), np.arange(2 * len(lines_nki))
    used: np.ndarray = np.zeros(len(lines_nki), bool)
    parts: list[np.ndarray] = []
    for start in [*ends[onward < 0], *ends]:  # closed strokes come last, as they have no first end
        end = start
        while end >= 0 and not used[end // 2]:
            line = lines_nki[end // 2][:: -1 if end % 2 else 1]
            parts.append(line if end == start else line[1:])
            used[end // 2] = True
            end = onward[end ^ 1]
        if end != start:
            parts.append(np.full((1, 2), np.nan))
    return np.concatenate(parts)


def _onward(lines_nki: np.ndarray) -> np.ndarray:
    """For each end of a line, 2 n and 2 n + 1, the end of the line that continues it straight, or -1: (2 n,)."""
    names = _names(lines_nki[:, [0, -1]]).reshape(-1, 2)
    points = np.unique(names, axis=0, return_inverse=True)[1].ravel()
    away = np.stack([lines_nki[:, 1] - lines_nki[:, 0], lines_nki[:, -2] - lines_nki[:, -1]], axis=1).reshape(-1, 2)
    away = away / np.maximum(np.linalg.norm(away, axis=1, keepdims=True), np.finfo(float).tiny)
    order = np.argsort(points, kind="stable")
    rank = np.zeros_like(points)
    rank[order] = np.arange(len(points)) - np.searchsorted(points[order], points[order])
    ends = np.full((points.max() + 1, rank.max() + 1), -1)
    ends[points, rank] = np.arange(len(points))
    away_pai = np.where(ends[..., None] >= 0, away[ends], 0.0)
    cosine_pab = np.einsum("pai,pbi->pab", away_pai, away_pai)
    best = np.argmin(cosine_pab, axis=2)
    mutual = np.take_along_axis(best, best, axis=1) == np.arange(best.shape[1])
    straight = mutual & (cosine_pab.min(axis=2) < -_STRAIGHT_ON)
    onward = np.full(len(points), -1)
    onward[ends[straight]] = np.take_along_axis(ends, best, axis=1)[straight]
    return onward


def _names(x: np.ndarray) -> np.ndarray:
    """Integer coordinates, equal for coinciding points."""
    largest = float(np.abs(x).max(initial=0.0)) or 1.0
    return np.rint(x / (_SAME_PLACE * largest)).astype(np.int64)
