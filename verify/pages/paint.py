"""A field on sampling grids as an image in which every pixel has one colour of the map.

Semi-transparent cells would blend where they touch. So the values are painted first as opaque grey levels, and then
replaced by the colours, which are transparent near zero.
"""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.tri import Triangulation

from verify.pages.style import STRESS_MAP, colour

_DPI = 110
_SHADES = 64  # of the map: a quarter of the bytes, and no visible steps
_MANY_ELEMENTS = 900  # above this number outlines become pixels

Limits = tuple[float, float]


def paint(axes: Axes, x_euvi: np.ndarray, value_euv: np.ndarray, limit: float, frame: tuple[Limits, Limits]) -> None:
    """Fill the axes with a field and its element outlines, and set their limits.

    Parameters
    ----------
    x_euvi : positions (n_e, m, m, 2) of the sampling grids
    value_euv : (n_e, m, m), coloured from -limit to limit
    frame : limits of the axes along x and y
    """
    x, y = frame
    sheet = Figure(figsize=inches(axes), dpi=_DPI, facecolor="none")
    grey = sheet.add_axes((0, 0, 1, 1), xlim=x, ylim=y)
    grey.set_axis_off()
    at = np.arange(value_euv.size).reshape(value_euv.shape)
    a, b, c, d = (part.ravel() for part in (at[:, :-1, :-1], at[:, 1:, :-1], at[:, 1:, 1:], at[:, :-1, 1:]))
    grid = Triangulation(*x_euvi.reshape(-1, 2).T, np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)]))
    grey.tripcolor(grid, value_euv.ravel(), shading="gouraud", cmap="gray", vmin=-limit, vmax=limit)
    grey.set(xlim=x, ylim=y)
    canvas = FigureCanvasAgg(sheet)
    canvas.draw()
    levels = np.asarray(canvas.buffer_rgba())
    pixels = STRESS_MAP.resampled(_SHADES)(levels[..., 0] / 255.0)
    pixels[..., 3] *= levels[..., 3] > 0
    axes.imshow(pixels, extent=(*x, *y), aspect="auto", interpolation="none", zorder=1)
    many = len(x_euvi) > _MANY_ELEMENTS
    ink = "#808a96" if many else colour("ink")  # pixels cannot follow the colours of the page
    lines = one_path(seen(sides(x_euvi), frame))
    axes.plot(*lines.T, color=ink, linewidth=0.25, alpha=0.7, zorder=2, rasterized=many)
    axes.set(xlim=x, ylim=y)


def inches(axes: Axes) -> tuple[float, float]:
    """Width and height of the axes."""
    box, figure = axes.get_position(), axes.figure
    assert isinstance(figure, Figure)
    width, height = figure.get_size_inches()
    return width * box.width, height * box.height


def sides(x_euvi: np.ndarray) -> np.ndarray:
    """Sides of the elements (n, m, 2), each once, from sampling grids (n_e, m, m, 2)."""
    sides_nki = np.concatenate([x_euvi[:, :, 0], x_euvi[:, -1], x_euvi[:, :, -1], x_euvi[:, 0]])
    places = np.rint(sides_nki / (1e-7 * (np.abs(sides_nki).max(initial=0.0) or 1.0)))
    either_way = np.sort(places, axis=1).reshape(len(places), -1)
    return sides_nki[np.unique(either_way, axis=0, return_index=True)[1]]


def seen(lines_nki: np.ndarray, frame: tuple[Limits, Limits]) -> np.ndarray:
    """Those of the lines (n, k, 2) whose box meets the frame."""
    low, high = lines_nki.min(axis=1), lines_nki.max(axis=1)
    least, most = np.transpose(frame)
    return lines_nki[np.all((high >= least) & (low <= most), axis=1)]


def one_path(lines_nki: np.ndarray) -> np.ndarray:
    """Points (n_p, 2) of one path over all lines, NaN between them: it takes fewer bytes than many."""
    return np.concatenate([lines_nki, np.full_like(lines_nki[:, :1], np.nan)], axis=1).reshape(-1, 2)
