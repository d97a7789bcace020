"""A field on sampling grids as an image in which every pixel has one colour of the map.

Semi-transparent cells would blend where they touch. So the values are painted first as opaque grey levels, and then
replaced by the colours, which are transparent near zero.
"""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import TriMesh
from matplotlib.figure import Figure
from matplotlib.tri import Triangulation

from verify.pages.strokes import sides, strokes
from verify.pages.style import STRESS_MAP, colour

_DPI = 150
_CELLS = 2  # per sampling interval in each direction: two triangles are not a bilinear cell
_BAND = 4  # grey levels of one colour: a quarter of the bytes, and no visible steps
_MANY_ELEMENTS = 900  # above this number outlines become pixels

Limits = tuple[float, float]


def paint(
    axes: Axes, x_euvi: np.ndarray, value_euv: np.ndarray, limit: float, frame: tuple[Limits, Limits], dpi: int = _DPI
) -> None:
    """Fill the axes with a field and its element outlines, and set their limits.

    Parameters
    ----------
    x_euvi : positions (n_e, m, m, 2) of the sampling grids
    value_euv : (n_e, m, m), coloured from -limit to limit
    frame : limits of the axes along x and y
    """
    x, y = frame
    levels = _grey_levels(x_euvi, value_euv, limit, frame, inches(axes), dpi)
    pixels = STRESS_MAP(np.rint(levels[..., 0] / _BAND) * _BAND / 255.0)
    pixels[..., 3] *= levels[..., 3] > 0
    axes.imshow(pixels, extent=(*x, *y), aspect="auto", interpolation="none", zorder=1)
    many = len(x_euvi) > _MANY_ELEMENTS
    ink = "#808a96" if many else colour("ink")  # pixels cannot follow the colours of the page
    sides_nki = sides(x_euvi)
    lines_pi = strokes(sides_nki[seen(sides_nki, frame)])  # one path takes fewer bytes than many
    axes.plot(*lines_pi.T, color=ink, linewidth=0.25, alpha=0.7, zorder=2, rasterized=many)
    axes.set(xlim=x, ylim=y)


def inches(axes: Axes) -> tuple[float, float]:
    """Width and height of the axes."""
    box, figure = axes.get_position(), axes.figure
    assert isinstance(figure, Figure)
    width, height = figure.get_size_inches()
    return width * box.width, height * box.height


def _grey_levels(
    x_euvi: np.ndarray,
    value_euv: np.ndarray,
    limit: float,
    frame: tuple[Limits, Limits],
    size: tuple[float, float],
    dpi: int,
) -> np.ndarray:
    """Image (rows, columns, 4): grey from 0 at -limit to 255 at limit, alpha 0 where there is no element."""
    x_ni, value_n = _finer(x_euvi).reshape(-1, 2), _finer(value_euv[..., None]).ravel()
    corners_nk = _corners(len(x_euvi), _CELLS * (x_euvi.shape[1] - 1) + 1)
    corners_nk = corners_nk[seen(x_ni[corners_nk], frame)]
    triangles_tk = np.concatenate([corners_nk[:, :3], corners_nk[:, [0, 2, 3]]])
    figure = Figure(figsize=size, dpi=dpi, facecolor="none")
    axes = figure.add_axes((0, 0, 1, 1), xlim=frame[0], ylim=frame[1])
    axes.set_axis_off()
    if len(triangles_tk):
        grid = Triangulation(*x_ni.T, triangles_tk)
        axes.add_collection(TriMesh(grid, array=value_n, cmap="gray", clim=(-limit, limit)), autolim=False)
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    return np.asarray(canvas.buffer_rgba())


def _corners(elements: int, points: int) -> np.ndarray:
    """Points (n, 4) around every cell of as many grids, with so many ``points`` in each direction."""
    at = np.arange(elements * points**2).reshape(elements, points, points)
    return np.stack([at[:, :-1, :-1], at[:, 1:, :-1], at[:, 1:, 1:], at[:, :-1, 1:]], axis=-1).reshape(-1, 4)


def _finer(values: np.ndarray) -> np.ndarray:
    """Bilinear refinement of the sampling grids (n_e, m, m, c)."""
    points = values.shape[1]
    at = np.linspace(0, points - 1, _CELLS * (points - 1) + 1)
    weights = np.maximum(1 - np.abs(at[:, None] - np.arange(points)), 0)
    return np.einsum("Uu,Vv,euvc->eUVc", weights, weights, values, optimize=True)


def seen(lines_nki: np.ndarray, frame: tuple[Limits, Limits]) -> np.ndarray:
    """Whether the box around each line (n, k, 2) meets the frame: bool (n,)."""
    low, high = lines_nki.min(axis=1), lines_nki.max(axis=1)
    least, most = np.transpose(frame)
    return np.all((high >= least) & (low <= most), axis=1)
