"""T-meshes drawn: lines, Bezier elements, T-junctions and anchors, in knot values or on the body."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.lines import Line2D

from iga.mesh.extraction import SIDES, Mesh
from iga.tsplines.tmesh import FRAME, TMesh
from iga.tsplines.transfer import collocation
from verify.pages.style import colour

_STEPS = 8  # straight pieces of a curved line, from knot to knot
_MANY = 4000  # from so many lines or dots on they become pixels

LINES = {"color": colour("ink"), "linewidth": 0.5, "zorder": 3}
_OUTLINE = {"color": colour("ink"), "linewidth": 1.1, "zorder": 3.2}
_EXTENSIONS = {"color": colour("tspline"), "linewidth": 0.6, "linestyle": (0, (2.5, 1.8)), "zorder": 2.5}
JUNCTIONS = {"color": colour("bad"), "marker": "s", "markersize": 3.0, "markeredgewidth": 0.0, "zorder": 5}
_ANCHORS = {"color": colour("accent"), "marker": "o", "markersize": 2.2, "markeredgewidth": 0.0, "zorder": 4}
_ZONE = {"color": colour("zone"), "linewidth": 5.0, "alpha": 0.75, "zorder": 2, "capstyle": "butt"}


@dataclass(frozen=True)
class Zone:
    """An interval along a side of the domain, "LEFT", "RIGHT", "BOTTOM" or "TOP", in lengths as drawn."""

    side: str
    start: float
    end: float


def draw_tmesh(
    axes: Axes,
    tmesh: TMesh,
    mesh: Mesh | None = None,
    zone: Zone | None = None,
    stretched: bool = False,
    dots: bool = True,
) -> None:
    """Draw a T-mesh.

    Parameters
    ----------
    mesh : the T-spline; the picture is on its body then, and in knot values without.
    zone : what to shade along one side; lengths run with the side's own parameter, from where it starts.
    stretched : fill the axes; lengths are to scale in both directions if not.
    dots : whether anchors are drawn, too.

    Raises
    ------
    ValueError : a zone that is not on the side it names.
    """
    solid, dashed, outline = _runs(tmesh)
    curves = _curves(tmesh, mesh, solid), _curves(tmesh, mesh, dashed), _curves(tmesh, mesh, outline)
    for lines, style, label in zip(
        curves, (LINES, _EXTENSIONS, _OUTLINE), ("T-mesh", "extensions", "outline"), strict=True
    ):
        axes.add_collection(LineCollection(lines, label=label, rasterized=len(lines) > _MANY, **style))
    if dots:
        _dots(axes, _placed(tmesh, mesh, tmesh.anchors), "anchors", _ANCHORS)
    _dots(axes, _placed(tmesh, mesh, tmesh.junctions[:, :2]), "T-junctions", JUNCTIONS)
    if zone is not None:
        axes.add_collection(LineCollection([_along(tmesh, mesh, zone)], label="zone", **_ZONE))
    axes.grid(False)
    axes.autoscale_view()
    axes.set_aspect("auto" if stretched else "equal")


def legend_entries(tmesh: TMesh, zone: str = "", dots: bool = True) -> list[Line2D]:
    """What a legend of the drawing says; ``zone`` names what is shaded."""
    entries = [Line2D([], [], label="line of the T-mesh", **LINES)]
    if len(tmesh.junctions):
        entries.append(Line2D([], [], label="extension: Bézier elements end here, too", **_EXTENSIONS))
        entries.append(Line2D([], [], label="T-junction", linestyle="none", **JUNCTIONS))
    if dots:
        entries.append(Line2D([], [], label="anchor of a function", linestyle="none", **_ANCHORS))
    if zone:
        style = {key: value for key, value in _ZONE.items() if key != "capstyle"}
        entries.append(Line2D([], [], label=zone, **style))
    return entries


def _runs(tmesh: TMesh) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Lines (n, 4) as index boxes i0, i1, j0, j1: those of the T-mesh, those of the extensions alone, the outline."""
    drawn = tmesh.across_ij, tmesh.up_ij
    alone = tuple(edges & ~there for edges, there in zip(tmesh.extended(), drawn, strict=True))
    solid, dashed = (_inside(tmesh, across, up) for across, up in (drawn, alone))
    i, j = len(tmesh.knots_i) - FRAME - 1, len(tmesh.knots_j) - FRAME - 1
    outline = [(FRAME, i, FRAME, FRAME), (FRAME, i, j, j), (FRAME, FRAME, FRAME, j), (i, i, FRAME, j)]
    return solid, dashed, np.array(outline)


def _inside(tmesh: TMesh, across: np.ndarray, up: np.ndarray) -> np.ndarray:
    """Lines (n, 4) of the edges, i0, i1, j0, j1, less those on the outline; each place once."""
    level, upright = _straight(across, tmesh.knots_i), _straight(up.T, tmesh.knots_j)
    lines = np.concatenate([level[:, [0, 1, 2, 2]], upright[:, [2, 2, 0, 1]]])
    i0, i1, j0, j1 = lines.T
    s, t = tmesh.knots_i, tmesh.knots_j
    rim = ((i0 == i1) & np.isin(s[i0], s[[0, -1]])) | ((j0 == j1) & np.isin(t[j0], t[[0, -1]]))
    lines = lines[~rim]
    _, first = np.unique(np.concatenate([s[lines[:, :2]], t[lines[:, 2:]]], axis=1), axis=0, return_index=True)
    return lines[np.sort(first)]


def _straight(along: np.ndarray, knots: np.ndarray) -> np.ndarray:
    """Longest runs (n, 3) of unit edges inside the domain, as from, to, line; runs without length are left out."""
    along = along[FRAME:-FRAME, FRAME:-FRAME].astype(np.int8)
    change = np.diff(along, axis=0, prepend=0, append=0)
    line, start = np.nonzero((change == 1).T)
    _, end = np.nonzero((change == -1).T)
    runs = np.stack([start, end, line], -1) + FRAME
    return runs[knots[runs[:, 1]] > knots[runs[:, 0]]]


def _curves(tmesh: TMesh, mesh: Mesh | None, lines: np.ndarray) -> list[np.ndarray]:
    """Points (n, 2) of each line, straight from end to end in knot values and sampled on a body."""
    s, t = tmesh.knots_i, tmesh.knots_j
    if mesh is None:
        return [np.array([[s[i0], t[j0]], [s[i1], t[j1]]]) for i0, i1, j0, j1 in lines]
    pieces = []
    for i0, i1, j0, j1 in lines:
        along = _sampled(s[i0 : i1 + 1]) if j0 == j1 else _sampled(t[j0 : j1 + 1])
        across = np.full_like(along, t[j0] if j0 == j1 else s[i0])
        pieces.append(np.stack([along, across] if j0 == j1 else [across, along], -1))
    if not pieces:
        return []
    placed = _on_body(tmesh, mesh, np.concatenate(pieces))
    return np.split(placed, np.cumsum([len(piece) for piece in pieces])[:-1])


def _sampled(knots: np.ndarray) -> np.ndarray:
    """Knots and equally spaced values between them."""
    knots = np.unique(knots)
    steps = np.arange((len(knots) - 1) * _STEPS + 1) / _STEPS
    return np.interp(steps, np.arange(len(knots)), knots)


def _placed(tmesh: TMesh, mesh: Mesh | None, index_ni: np.ndarray) -> np.ndarray:
    """Places (n, 2) of index points."""
    x_ni = np.stack([tmesh.knots_i[index_ni[:, 0]], tmesh.knots_j[index_ni[:, 1]]], -1)
    return x_ni if mesh is None or len(x_ni) == 0 else _on_body(tmesh, mesh, x_ni)


def _on_body(tmesh: TMesh, mesh: Mesh, x_ni: np.ndarray) -> np.ndarray:
    """Places (n, 2) on the body of points in knot values."""
    N = collocation(tmesh, x_ni)
    return (N @ (mesh.w_A[:, None] * mesh.P_AI)) / (N @ mesh.w_A)[:, None]


def _dots(axes: Axes, x_ni: np.ndarray, label: str, style: dict[str, Any]) -> None:
    axes.plot(*x_ni.T, linestyle="none", label=label, rasterized=len(x_ni) > _MANY, **style)


def _along(tmesh: TMesh, mesh: Mesh | None, zone: Zone) -> np.ndarray:
    """Points (n, 2) of the side between the ends of the zone."""
    fixed, value = SIDES[zone.side]
    knots = tmesh.knots_j if fixed == 0 else tmesh.knots_i
    along = _sampled(knots)
    ends = (tmesh.knots_i, tmesh.knots_j)[fixed]
    x_ni = np.empty((len(along), 2))
    x_ni[:, fixed], x_ni[:, 1 - fixed] = ends[-1] if value else ends[0], along
    x_ni = x_ni if mesh is None else _on_body(tmesh, mesh, x_ni)
    length = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(x_ni, axis=0), axis=1))])
    if not 0.0 <= zone.start < zone.end <= length[-1] * (1 + 1e-9):
        raise ValueError(
            f"a zone on {zone.side} must lie within 0 to {length[-1]:.6g}, got {zone.start:.6g} to {zone.end:.6g}"
        )
    at = np.union1d(length[(length > zone.start) & (length < zone.end)], [zone.start, zone.end])
    return np.stack([np.interp(at, length, x_ni[:, k]) for k in range(2)], -1)
