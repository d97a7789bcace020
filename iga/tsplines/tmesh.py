"""The index T-mesh of a bicubic T-spline: two lists of knots and the unit edges between their indices.

It determines anchors, local knot vectors, T-junctions and their extensions (Sederberg, Zheng, Bakenov, Nasri 2003;
Scott, Li, Sederberg, Hughes 2012).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

#: Degree of the functions, local knots on either side of an anchor, and index lines of the frame outside the domain.
DEGREE, BESIDE, FRAME = 3, 2, 2


class NotSuitable(ValueError):
    """A T-mesh that is not analysis-suitable: its functions may not add up to 1, or be linearly dependent."""


@dataclass(frozen=True)
class TMesh:
    """An index T-mesh.

    ``knots_i`` (m_s,) and ``knots_j`` (m_t,) are the global knots, with end multiplicity 4. ``across_ij``
    (m_s - 1, m_t) is True if the mesh has the unit edge from (i, j) to (i + 1, j), ``up_ij`` (m_s, m_t - 1) if it has
    that from (i, j) to (i, j + 1). The domain lies within the third lines from each side; the two lines outside are the
    frame, in which every line that reaches it continues. The four lines of an end knot are complete.

    Raises
    ------
    ValueError : arrays of different sizes, decreasing knots, end knots of another multiplicity, gaps in the frame, or a
        line that does not end on another line.
    """

    knots_i: np.ndarray
    knots_j: np.ndarray
    across_ij: np.ndarray
    up_ij: np.ndarray

    def __post_init__(self) -> None:
        for name in ("knots_i", "knots_j"):
            object.__setattr__(self, name, np.asarray(getattr(self, name), dtype=float))
        for knots, along, name in ((self.knots_i, self.across_ij, "s"), (self.knots_j, self.up_ij.T, "t")):
            _check_knots(knots, name)
            if len(along) != len(knots) - 1:
                raise ValueError(f"{len(knots)} knots in {name} ask for {len(knots) - 1} unit edges, got {len(along)}")
        if self.across_ij.shape[1] != len(self.knots_j) or self.up_ij.shape[0] != len(self.knots_i):
            raise ValueError(f"edges {self.across_ij.shape} and {self.up_ij.shape} are not of one mesh")
        for along, name in ((self.across_ij, "horizontal"), (self.up_ij.T, "vertical")):
            _check_frame(along, name)
        _check_ends(self)

    def _repr_html_(self) -> str:
        from iga.notebook import drawn

        text = f"T-mesh in its parameters: {len(self.anchors)} functions, {len(self.junctions)} T-junctions"
        return drawn(self.edges(), text)

    @cached_property
    def crossed_ij(self) -> np.ndarray:
        """Mask (m_s, m_t) of the points on vertical lines, which a horizontal ray intersects."""
        return _touched(self.up_ij.T).T

    @cached_property
    def levelled_ij(self) -> np.ndarray:
        """Mask (m_s, m_t) of the points on horizontal lines."""
        return _touched(self.across_ij)

    @cached_property
    def anchors(self) -> np.ndarray:
        """Indices (n_A, 2) of the vertices in the domain, the anchors of the functions; i runs fastest."""
        inside = self.crossed_ij & self.levelled_ij
        return np.argwhere(inside[FRAME:-FRAME, FRAME:-FRAME].T)[:, ::-1] + FRAME

    @cached_property
    def local_indices(self) -> tuple[np.ndarray, np.ndarray]:
        """Knot indices (n_A, 5) of the anchors along s and along t: their own, and the next two lines on each side."""
        i, j = self.anchors.T
        across = neighbours(self.crossed_ij, i, j)
        up = neighbours(self.levelled_ij.T, j, i)
        return across, up

    @cached_property
    def local_knots(self) -> tuple[np.ndarray, np.ndarray]:
        """Local knot vectors (n_A, 5) along s and along t."""
        across, up = self.local_indices
        return self.knots_i[across], self.knots_j[up]

    @cached_property
    def junctions(self) -> np.ndarray:
        """T-junctions (n_T, 3): indices i, j and the missing edge (0 right, 1 left, 2 up, 3 down)."""
        i, j = self.anchors.T
        edges = self._edges(i, j)
        three = edges.sum(1) == 3
        return np.stack([i, j, np.argmin(edges, axis=1)], -1)[three]

    def edges(self) -> np.ndarray:
        """End points (n, 2, 2), in knot values, of all unit edges of positive length."""
        i, j = np.nonzero(self.across_ij[:, FRAME:-FRAME] & (np.diff(self.knots_i) > 0.0)[:, None])
        k, m = np.nonzero(self.up_ij[FRAME:-FRAME] & (np.diff(self.knots_j) > 0.0))
        j, k = j + FRAME, k + FRAME
        s = np.stack([np.append(self.knots_i[i], self.knots_i[k]), np.append(self.knots_i[i + 1], self.knots_i[k])], -1)
        t = np.stack([np.append(self.knots_j[j], self.knots_j[m]), np.append(self.knots_j[j], self.knots_j[m + 1])], -1)
        return np.unique(np.stack([s, t], -1), axis=0)

    @cached_property
    def extensions(self) -> tuple[np.ndarray, np.ndarray]:
        """Extensions (n, 3) of the T-junctions, horizontal ones (i0, i1, j) and vertical ones (j0, j1, i).

        They reach over two lines towards the missing edge and one line back (degree 3; Li, Scott 2013).
        """
        i, j, missing = self.junctions.T
        level, upright = missing < 2, missing >= 2
        return (
            _reach(self.crossed_ij, i[level], j[level], missing[level] == 0),
            _reach(self.levelled_ij.T, j[upright], i[upright], missing[upright] == 2),
        )

    def crossings(self) -> np.ndarray:
        """Points (n, 2), in knot values, at which a horizontal and a vertical extension intersect, ends included."""
        level, upright = self.extensions
        m_t = len(self.knots_j)
        (i_h, j_h, _), (j_v, i_v, _) = span_points(level), span_points(upright)
        i, j = np.divmod(np.intersect1d(i_h * m_t + j_h, i_v * m_t + j_v), m_t)
        return np.stack([self.knots_i[i], self.knots_j[j]], -1)

    @property
    def suitable(self) -> bool:
        """Analysis-suitable: no two extensions intersect (Scott, Li, Sederberg, Hughes 2012; Li, Scott 2013)."""
        return len(self.crossings()) == 0

    def extended(self) -> tuple[np.ndarray, np.ndarray]:
        """Unit edges including the extensions, ``across_ij`` and ``up_ij``."""
        level, upright = self.extensions
        m_s, m_t = len(self.knots_i), len(self.knots_j)
        across = painted(level, (m_s, m_t)) | self.across_ij
        up = painted(upright, (m_t, m_s)).T | self.up_ij
        return across, up

    def _edges(self, i: np.ndarray, j: np.ndarray) -> np.ndarray:
        """Whether edges (n, 4) start at inner points to the right, left, up and down."""
        return np.stack([self.across_ij[i, j], self.across_ij[i - 1, j], self.up_ij[i, j], self.up_ij[i, j - 1]], -1)


def require_suitable(mesh: TMesh) -> None:
    """Refuse a T-mesh that is not analysis-suitable.

    Raises
    ------
    NotSuitable : names the first crossing by its coordinates.
    """
    crossings = mesh.crossings()
    if len(crossings):
        s, t = crossings[0]
        more = f" and {len(crossings) - 1} more" if len(crossings) > 1 else ""
        raise NotSuitable(
            f"the T-mesh is not analysis-suitable: extensions of T-junctions meet at ({s:.6g}, {t:.6g}){more}; "
            "prolong one of the two lines to the next one"
        )


def _check_knots(knots: np.ndarray, name: str) -> None:
    values, count = np.unique(knots, return_counts=True)
    if not np.all(np.isfinite(knots)) or np.any(np.diff(knots) < 0.0):
        raise ValueError(f"knots in {name} must be finite and not fall")
    if len(values) < 2 or count[0] != DEGREE + 1 or count[-1] != DEGREE + 1:
        raise ValueError(f"the end knots in {name} must be there {DEGREE + 1} times, got {count[0]} and {count[-1]}")
    if np.any(count[1:-1] > DEGREE):
        raise ValueError(f"inner knots in {name} may be there {DEGREE} times at most, got {count[1:-1].max()}")


def _check_frame(along: np.ndarray, name: str) -> None:
    """Check the frame: complete lines along it, and no gap across it; the first axis of ``along`` runs along lines."""
    if not np.all(along[:, : DEGREE + 1]) or not np.all(along[:, -DEGREE - 1 :]):
        raise ValueError(f"the {name} lines of the end knots must be drawn in full")
    for outer, inner, first in ((along[0], along[1], along[2]), (along[-1], along[-2], along[-3])):
        if np.any(outer != inner) or np.any(first & ~inner):
            raise ValueError(f"a {name} line that reaches the frame must go through it")


def _check_ends(mesh: TMesh) -> None:
    """Check that lines inside end on other lines: no dangling ends, no corners."""
    right, left = mesh.across_ij[1:, 1:-1], mesh.across_ij[:-1, 1:-1]
    up, down = mesh.up_ij[1:-1, 1:], mesh.up_ij[1:-1, :-1]
    for ends, other, direction in ((right ^ left, up & down, "horizontal"), (up ^ down, right & left, "vertical")):
        loose = np.argwhere(ends & ~other) + 1
        if len(loose):
            s, t = mesh.knots_i[loose[0, 0]], mesh.knots_j[loose[0, 1]]
            raise ValueError(
                f"a {direction} line of the T-mesh ends at ({s:.6g}, {t:.6g}), where no other runs through"
            )


def _touched(along: np.ndarray) -> np.ndarray:
    """Mask of the points on lines whose unit edges run along the first axis."""
    points = np.zeros((along.shape[0] + 1, along.shape[1]), dtype=bool)
    points[:-1] |= along
    points[1:] |= along
    return points


def neighbours(hit: np.ndarray, i: np.ndarray, j: np.ndarray, reach: int = BESIDE) -> np.ndarray:
    """Indices (n, 2 reach + 1), along the first axis, of the next ``reach`` True points on both sides of (i, j)."""
    length = hit.shape[0]
    place = np.flatnonzero(hit.T)
    rank = np.searchsorted(place, j * length + i)
    return place[rank[:, None] + np.arange(-reach, reach + 1)] - (j * length)[:, None]


def _reach(hit: np.ndarray, i: np.ndarray, j: np.ndarray, forwards: np.ndarray) -> np.ndarray:
    """Extensions (n, 3) from, to, line: over two True points forwards (or backwards) and one the other way."""
    left2, left, _, right, right2 = neighbours(hit, i, j).T
    return np.stack([np.where(forwards, left, left2), np.where(forwards, right2, right), j], -1)


def painted(spans: np.ndarray, shape: tuple[int, int]) -> np.ndarray:
    """Unit edges (m - 1, n) that spans (from, to, line) cover among points (m, n)."""
    along, line, _ = span_points(spans - [0, 1, 0])
    edges = np.zeros((shape[0] - 1, shape[1]), dtype=bool)
    edges[along, line] = True
    return edges


def span_points(spans: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """All points of spans (from, to, line), ends included: index along the line, line, number of the span."""
    start, end, line = spans.T
    number = np.repeat(np.arange(len(spans)), end - start + 1)
    return start[number] + counting(end - start + 1), line[number], number


def counting(lengths: np.ndarray) -> np.ndarray:
    """The integers 0 .. n - 1 for each n in ``lengths``, one after the other."""
    return np.arange(lengths.sum()) - np.repeat(np.cumsum(lengths) - lengths, lengths)
