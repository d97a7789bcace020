"""T-meshes made of lines: grids, inserted lines, refined rectangles, and tilings by rectangles.

All lengths here are parameters (knot values); indices stay inside. A line that reaches the boundary of the domain
runs on through the frame.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from iga.tsplines.tmesh import DEGREE, TMesh, painted
from iga.tsplines.tspline import faces

#: Names of the directions in which a line may run.
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
    breaks_s, breaks_t : rising knot values; the ends are repeated four times.
    multiplicity_s, multiplicity_t : how often each inner value is there, one number or one for each of them.

    Raises
    ------
    ValueError : breaks that do not rise, or a multiplicity above 3.
    """
    knots_i, knots_j = _open(breaks_s, multiplicity_s, "s"), _open(breaks_t, multiplicity_t, "t")
    m_s, m_t = len(knots_i), len(knots_j)
    return TMesh(knots_i, knots_j, np.ones((m_s - 1, m_t), dtype=bool), np.ones((m_s, m_t - 1), dtype=bool))


def with_line(
    mesh: TMesh, direction: str, at: float, between: tuple[float, float] | None = None, times: int = 1
) -> TMesh:
    """The T-mesh in which at least ``times`` lines run at ``at`` over the whole range ``between``.

    Parameters
    ----------
    direction : "vertical" (``at`` is a value of s, the range one of t) or "horizontal".
    at : a new knot value inside the domain or one that is there.
    between : where the line starts and ends, each on a line of the other direction; all through if left out.
    times : multiplicity, 1 to 3.

    Raises
    ------
    ValueError : a line outside the domain, or one whose ends lie on no line.
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
    """The same for many lines at once, each row (at, from, to); they may end on one another.

    Raises
    ------
    ValueError : a line outside the domain, or one whose ends lie on no line.
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


def band(mesh: TMesh, rectangle: tuple[float, float, float, float], levels: int = 1) -> TMesh:
    """The T-mesh whose faces that touch a rectangle (s0, s1, t0, t1) are cut in four, ``levels`` times over.

    Nothing makes it analysis-suitable; see `iga.tsplines.bisection`.

    Raises
    ------
    ValueError : a rectangle that lies outside the domain.
    """
    s0, s1, t0, t1 = rectangle
    if not (s0 <= s1 and t0 <= t1):
        raise ValueError(f"a rectangle is s0 <= s1, t0 <= t1, got ({s0:.6g}, {s1:.6g}, {t0:.6g}, {t1:.6g})")
    for _ in range(levels):
        i0, i1, j0, j1 = faces(mesh).T
        a0, a1, b0, b1 = mesh.knots_i[i0], mesh.knots_i[i1], mesh.knots_j[j0], mesh.knots_j[j1]
        hit = (a0 <= s1) & (a1 >= s0) & (b0 <= t1) & (b1 >= t0)
        if not np.any(hit):
            raise ValueError(f"the rectangle ({s0:.6g}, {s1:.6g}) x ({t0:.6g}, {t1:.6g}) touches no face")
        a0, a1, b0, b1 = a0[hit], a1[hit], b0[hit], b1[hit]
        upright, level = np.stack([(a0 + a1) / 2, b0, b1], -1), np.stack([(b0 + b1) / 2, a0, a1], -1)
        mesh = with_lines(mesh, upright, level)
    return mesh


def from_rectangles(box_ek: np.ndarray) -> TMesh:
    """The T-mesh of a rectangle that is tiled by rectangles.

    Parameters
    ----------
    box_ek : (n_e, 4) rows s0, s1, t0, t1; sides that lie on one line have the very same float.

    Raises
    ------
    ValueError : an empty box, a gap or an overlap; the message has the coordinates.
    """
    box_ek = np.asarray(box_ek, dtype=float)
    if box_ek.ndim != 2 or box_ek.shape[1] != 4 or len(box_ek) == 0 or not np.all(np.isfinite(box_ek)):
        raise ValueError(f"rectangles are rows of four finite numbers s0, s1, t0, t1, got shape {box_ek.shape}")
    s0, s1, t0, t1 = box_ek.T
    flat = np.flatnonzero((s1 <= s0) | (t1 <= t0))
    if flat.size:
        raise ValueError(f"the rectangle ({_pair(box_ek[flat[0], :2])}) x ({_pair(box_ek[flat[0], 2:])}) has no area")
    _check_tiling(box_ek)
    outline = tensor_grid(np.array([s0.min(), s1.max()]), np.array([t0.min(), t1.max()]))
    inner_s, inner_t = s0 > s0.min(), t0 > t0.min()
    return with_lines(outline, np.stack([s0, t0, t1], -1)[inner_s], np.stack([t0, s0, s1], -1)[inner_t])


def _open(breaks: np.ndarray, multiplicity: int | Sequence[int], name: str) -> np.ndarray:
    """Knots with fourfold ends and the inner ones as often as asked for."""
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
    """Knots in which every value ``at`` is there ``times`` times at least, with the edges that were drawn.

    Both arrays of edges have their first axis along the knots: ``along`` from knot to knot, ``across`` at knots.
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
    """Lines as index spans (from, to, line), over all copies of the knots at which they end."""
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
    """Spans drawn back from copies of the end knots that are not drawn through there.

    ``crossing`` (m - 1, n) are the edges of the other direction, its first axis across the spans.
    """
    start, end, line = spans.T.copy()
    through = crossing[:-1] & crossing[1:]
    for _ in range(DEGREE - 1):
        start += ~through[line - 1, start] & (along[start + 1] == along[start]) & (start > 0)
        end -= ~through[line - 1, end] & (along[end - 1] == along[end]) & (end < len(along) - 1)
    return np.stack([start, end, line], -1)


def _check_tiling(box_ek: np.ndarray) -> None:
    """Every place lies in one rectangle and no more.

    How many rectangles hold a place is the sum of signs over the corners to its lower left; so it is one everywhere
    if the signs of all corners cancel but for those of the outline.
    """
    s, t = np.unique(box_ek[:, :2]), np.unique(box_ek[:, 2:])
    i_ek, j_ek = np.searchsorted(s, box_ek[:, :2]), np.searchsorted(t, box_ek[:, 2:])
    corner = (i_ek[:, :, None] * len(t) + j_ek[:, None, :]).reshape(-1, 4)
    place, number = np.unique(corner, return_inverse=True)
    sign = np.bincount(number.ravel(), np.tile([1.0, -1.0, -1.0, 1.0], len(box_ek)))
    outline = {0: 1.0, len(t) - 1: -1.0, (len(s) - 1) * len(t): -1.0, len(s) * len(t) - 1: 1.0}
    left = sign != 0.0
    if dict(zip(place[left].tolist(), sign[left].tolist(), strict=True)) == outline:
        return
    change = np.zeros(len(s) * len(t), dtype=int)
    change[place] = sign
    times = change.reshape(len(s), len(t)).cumsum(0).cumsum(1)[:-1, :-1]
    i, j = np.argwhere(times != 1)[0]
    what = "no rectangle covers" if times[i, j] == 0 else f"{times[i, j]} rectangles cover"
    raise ValueError(f"{what} ({_pair(s[i : i + 2])}) x ({_pair(t[j : j + 2])})")


def _pair(values: np.ndarray) -> str:
    return f"{values[0]:.6g}, {values[1]:.6g}"
