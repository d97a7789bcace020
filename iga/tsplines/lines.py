"""T-meshes made of lines: the full grid, and lines inserted into it.

Arguments are parameters (knot values), not indices. A line that reaches the boundary of the domain continues through
the frame.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from iga.tsplines.tmesh import DEGREE, TMesh, painted

#: Directions of a line.
DIRECTIONS = ("vertical", "horizontal")


def tensor_grid(
    breaks_s: np.ndarray,
    breaks_t: np.ndarray,
    multiplicity_s: int | Sequence[int] = 1,
    multiplicity_t: int | Sequence[int] = 1,
) -> TMesh:
    """The full grid: the T-mesh of a tensor-product B-spline.

    Parameters
    ----------
    breaks_s, breaks_t : increasing knot values; the ends get multiplicity 4.
    multiplicity_s, multiplicity_t : multiplicity of the inner values, one number or one for each of them.

    Raises
    ------
    ValueError : breaks that do not increase, or a multiplicity above 3.
    """
    knots_i, knots_j = _open(breaks_s, multiplicity_s, "s"), _open(breaks_t, multiplicity_t, "t")
    m_s, m_t = len(knots_i), len(knots_j)
    return TMesh(knots_i, knots_j, np.ones((m_s - 1, m_t), dtype=bool), np.ones((m_s, m_t - 1), dtype=bool))


def with_line(
    mesh: TMesh, direction: str, at: float, between: tuple[float, float] | None = None, times: int = 1
) -> TMesh:
    """The T-mesh with at least ``times`` lines at ``at`` over the range ``between``.

    Parameters
    ----------
    direction : "vertical" (``at`` is a value of s, the range one of t) or "horizontal".
    at : a knot value inside the domain, new or existing.
    between : ends of the line, each on a line of the other direction; default: the whole domain.
    times : multiplicity, 1 to 3.

    Raises
    ------
    ValueError : a line outside the domain, or one that does not end on other lines.
    """
    if direction not in DIRECTIONS:
        raise ValueError(f"a line runs {' or '.join(DIRECTIONS)}, got {direction!r}")
    if not 1 <= times <= DEGREE:
        raise ValueError(f"a line may be there 1 to {DEGREE} times, got {times}")
    along = mesh.knots_j if direction == "vertical" else mesh.knots_i
    low, high = (along[0], along[-1]) if between is None else between
    span = np.array([[at, low, high]])
    none = np.empty((0, 3))
    vertical, horizontal = (span, none) if direction == "vertical" else (none, span)
    return with_lines(mesh, vertical, horizontal, times=times)


def with_lines(mesh: TMesh, vertical_nk: np.ndarray, horizontal_nk: np.ndarray, times: int = 1) -> TMesh:
    """The T-mesh with many more lines, rows (at, from, to) of both arrays (n, 3); they may end on one another.

    Raises
    ------
    ValueError : a line outside the domain, or one that does not end on other lines.
    """
    _check_inside(vertical_nk, mesh.knots_i, mesh.knots_j, "vertical")
    _check_inside(horizontal_nk, mesh.knots_j, mesh.knots_i, "horizontal")
    knots_i, across, up = _with_knots(mesh.knots_i, mesh.across_ij, mesh.up_ij, vertical_nk[:, 0], times)
    knots_j, up, across = _with_knots(mesh.knots_j, up.T, across.T, horizontal_nk[:, 0], times)
    up, across = up.T, across.T
    upright = _index_spans(vertical_nk, knots_i, knots_j, times, "vertical")
    level = _index_spans(horizontal_nk, knots_j, knots_i, times, "horizontal")
    shape = len(knots_i), len(knots_j)
    drawn_up = up | painted(upright, shape[::-1]).T
    drawn_across = across | painted(level, shape)
    upright = _ended(upright, drawn_across, knots_j)
    level = _ended(level, drawn_up.T, knots_i)
    up = up | painted(upright, shape[::-1]).T
    across = across | painted(level, shape)
    return TMesh(knots_i, knots_j, across, up)


def _open(breaks: np.ndarray, multiplicity: int | Sequence[int], name: str) -> np.ndarray:
    """Knots with end multiplicity 4 and the given inner multiplicities."""
    breaks = np.asarray(breaks, dtype=float)
    if breaks.ndim != 1 or breaks.size < 2 or not np.all(np.diff(breaks) > 0.0):
        raise ValueError(f"breaks in {name} must be two numbers or more that rise, got {breaks}")
    inner = np.broadcast_to(np.asarray(multiplicity, dtype=int), (breaks.size - 2,))
    if np.any(inner < 1) or np.any(inner > DEGREE):
        raise ValueError(f"multiplicities in {name} must be 1 to {DEGREE}, got {multiplicity}")
    return np.repeat(breaks, np.concatenate([[DEGREE + 1], inner, [DEGREE + 1]]))


def _check_inside(line_nk: np.ndarray, knots: np.ndarray, along: np.ndarray, name: str) -> None:
    at, low, high = line_nk.T
    outside = np.flatnonzero(~((at > knots[0]) & (at < knots[-1])))
    if outside.size:
        raise ValueError(f"a {name} line must lie inside ({_pair(knots[[0, -1]])}), got {at[outside[0]]:.6g}")
    empty = np.flatnonzero(~((low < high) & (low >= along[0]) & (high <= along[-1])))
    if empty.size:
        n = empty[0]
        raise ValueError(
            f"the {name} line at {at[n]:.6g} must run between two values in ({_pair(along[[0, -1]])}) that rise, "
            f"got ({low[n]:.6g}, {high[n]:.6g})"
        )


def _with_knots(
    knots: np.ndarray, along: np.ndarray, across: np.ndarray, at: np.ndarray, times: int
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Knots in which the values ``at`` have at least the multiplicity ``times``, with the existing edges.

    The first axis of both arrays of edges runs along the knots: ``along`` from knot to knot, ``across`` at knots.
    """
    wanted = np.unique(at)
    there = np.searchsorted(knots, wanted, side="right") - np.searchsorted(knots, wanted)
    fresh = np.repeat(wanted, np.maximum(times - there, 0))
    place = np.arange(len(knots)) + np.searchsorted(fresh, knots)
    old = np.zeros(len(knots) + len(fresh), dtype=bool)
    old[place] = True
    finer = np.empty(len(old))
    finer[old], finer[~old] = knots, fresh
    drawn = np.zeros((len(old), across.shape[1]), dtype=bool)
    drawn[place] = across
    return finer, along[np.cumsum(old)[:-1] - 1], drawn


def _index_spans(line_nk: np.ndarray, knots: np.ndarray, along: np.ndarray, times: int, name: str) -> np.ndarray:
    """Lines as index spans (from, to, line), up to the last copy of the knots at which they end."""
    at, low, high = line_nk.T
    start, end = np.searchsorted(along, low), np.searchsorted(along, high, side="right") - 1
    for values, index in ((low, start), (high, end)):
        loose = np.flatnonzero(along[np.minimum(index, len(along) - 1)] != values)
        if loose.size:
            place = (at[loose[0]], values[loose[0]])
            s, t = place if name == "vertical" else place[::-1]
            raise ValueError(f"a {name} line cannot end at ({s:.6g}, {t:.6g}), where no other runs through")
    first = np.searchsorted(knots, at)
    return np.concatenate([np.stack([start, end, first + copy], -1) for copy in range(times)])


def _ended(spans: np.ndarray, crossing: np.ndarray, along: np.ndarray) -> np.ndarray:
    """Spans shortened to the outermost copy of their end knots at which a line of the other direction exists.

    ``crossing`` (m - 1, n) are the edges of the other direction; its first axis runs across the spans.
    """
    start, end, line = spans.T.copy()
    through = crossing[:-1] & crossing[1:]
    for _ in range(DEGREE - 1):
        start += ~through[line - 1, start] & (along[start + 1] == along[start]) & (start > 0)
        end -= ~through[line - 1, end] & (along[end - 1] == along[end]) & (end < len(along) - 1)
    return np.stack([start, end, line], -1)


def _pair(values: np.ndarray) -> str:
    return f"{values[0]:.6g}, {values[1]:.6g}"
