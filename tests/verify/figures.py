"""Figures as they were drawn, before they become text of a page, and what is in them in a few words."""

from __future__ import annotations

from collections.abc import Iterable
from types import ModuleType
from typing import Any

import numpy as np
import pytest
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.colors import to_hex, to_rgba
from matplotlib.figure import Figure
from matplotlib.transforms import Bbox

from verify.pages import style
from verify.pages.style import PALETTE, colour

#: How many points of a line are told.
TOLD = 5


class Drawn(list[tuple[str, Figure]]):
    """Title and figure of all drawings of some modules, in the order in which they were made."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, *modules: ModuleType) -> None:
        super().__init__()
        for module in (style, *modules):
            monkeypatch.setattr(module, "to_svg", self._keep, raising=False)

    def _keep(self, figure: Figure, key: str, title: str, *more: float, **options: float) -> str:
        self.append((title, figure))
        return f"<svg>{key}</svg>"

    def axes(self, words: str, number: int = 0) -> Axes:
        """The axes of the only figure whose title has these words."""
        (figure,) = [figure for title, figure in self if words in title]
        return figure.axes[number]


def legend(figure: Figure) -> list[str]:
    """The names in the legends of a figure."""
    legends = [axes.get_legend() for axes in figure.axes if axes.get_legend() is not None] + figure.legends
    return [text.get_text() for one in legends for text in one.get_texts()]


def overlaps(axes: Axes) -> list[str]:
    """Pairs of texts in the axes that share more than a pixel in both directions."""
    texts = [(text.get_text(), text.get_window_extent()) for text in axes.texts]
    pairs = [(a, b, Bbox.intersection(x, y)) for i, (a, x) in enumerate(texts) for b, y in texts[:i]]
    return [f"{a} on {b}" for a, b, common in pairs if common is not None and min(common.width, common.height) > 1.0]


def facts(figure: Figure) -> dict[str, Any]:
    """What is drawn: axes with labels and limits, points of lines, extents of areas, texts and where they stand."""
    every = [*figure.axes, *(child for axes in figure.axes for child in axes.child_axes)]
    return {"inches": _numbers(figure.get_size_inches()), "legend": legend(figure), "axes": [*map(_axes, every)]}


def _axes(axes: Axes) -> dict[str, Any]:
    ways = {
        way: f"{axis.get_label_text()}: {_numbers(axis.get_view_interval())}, {axis.get_scale()}"
        for way, axis in (("x", axes.xaxis), ("y", axes.yaxis))
    }
    lines = [f"{_name(one)} {_look(one)} {_points(np.asarray(one.get_xydata(), float))}" for one in axes.lines]
    inks = [(one, _ink(one.get_facecolor()), _ink(one.get_edgecolor())) for one in (*axes.collections, *axes.patches)]
    areas = [f"{_name(one)} {inner} in {edge} {_points(_outline(one))}" for one, inner, edge in inks]
    images = [f"image {_numbers(one.get_extent())} of {one.get_array().shape[:2]} pixels" for one in axes.images]
    texts = [f"{one.get_text()} @ {_numbers(one.get_position())} {_arrow(one)}".strip() for one in axes.texts]
    return {"title": axes.get_title(loc="left") or axes.get_title(), **ways, "drawn": [*lines, *areas, *images, *texts]}


def _name(part: Artist) -> str:
    return str(part.get_label()).lstrip("_").replace("child", "#")


def _look(line: Any) -> str:
    return f"{_ink(line.get_color())} {_numbers([line.get_linewidth()])} {line.get_linestyle()} {line.get_marker()}"


def _ink(code: Any) -> str:
    """The name of a colour in the palette, with its opacity where it is an area's."""
    rgba = np.append(np.ravel(to_rgba(code) if isinstance(code, str) else code), (0.0,) * 4)[:4]
    names = {to_hex(colour(name)): name for name in PALETTE}
    return " ".join([names.get(to_hex(rgba), to_hex(rgba)), *([] if isinstance(code, str) else [_numbers(rgba[3:])])])


def _outline(area: Any) -> np.ndarray:
    if hasattr(area, "get_paths"):
        return np.concatenate([path.vertices for path in area.get_paths()] or [np.zeros((0, 2))])
    return area.get_path().transformed(area.get_patch_transform()).vertices


def _arrow(text: Any) -> str:
    return f"from {_numbers(text.xyann)} to {_numbers(text.xy)}" if getattr(text, "arrow_patch", None) else ""


def _points(points: np.ndarray) -> str:
    points = points[np.isfinite(points).all(axis=1)]
    told = points[np.linspace(0, len(points) - 1, min(len(points), TOLD)).astype(int)]
    return f"{len(points)} points, {'; '.join(map(_numbers, told))}"


def _numbers(values: Iterable[float]) -> str:
    return " ".join(f"{0.0 if abs(value) < 1e-9 else value:.4g}" for value in np.ravel(list(values)).tolist())
