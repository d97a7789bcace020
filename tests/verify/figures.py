"""Figures as they were drawn, before they become text of a page."""

from __future__ import annotations

import re
from collections.abc import Iterator
from itertools import combinations
from types import ModuleType

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.container import BarContainer
from matplotlib.figure import Figure
from matplotlib.text import Text
from matplotlib.transforms import Bbox

#: Points: least and largest size of letters, of the widths of lines, of marks.
LETTERS, WIDTHS, MARKS = (6.0, 8.5), (0.2, 5.5), (1.5, 8.0)

#: What is drawn fills so much of the width and the height of its axes; a third where several share their scales.
FILLED = 0.55


class Drawn(list[tuple[str, Figure]]):
    """Title and figure of all drawings of some modules, in the order in which they were made."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, *modules: ModuleType, filled: float = FILLED) -> None:
        super().__init__()
        self._filled = filled
        for module in modules:
            monkeypatch.setattr(module, "to_svg", self._keep)

    def _keep(self, figure: Figure, key: str, title: str, *more: float, **options: float) -> str:
        self.append((title, figure))
        found = unreadable(figure, self._filled)
        assert not found, f"{title}: {found}"
        width, height = figure.get_size_inches()
        assert height < 1.02 * width, f"{title}: higher than wide"
        return f"<svg>{key}</svg>"

    def axes(self, words: str, number: int = 0) -> Axes:
        """The axes of the only figure whose title has these words."""
        (figure,) = [figure for title, figure in self if words in title]
        return figure.axes[number]


def legend(figure: Figure) -> list[str]:
    """The names in the legends of a figure."""
    legends = [axes.get_legend() for axes in figure.axes if axes.get_legend() is not None] + figure.legends
    return [text.get_text() for one in legends for text in one.get_texts()]


def unreadable(figure: Figure, filled: float = FILLED) -> list[str]:
    """What a reader could not make out: cut off, on top of something else, too small, too large, out of view."""
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    renderer, found = canvas.get_renderer(), []
    width, height = figure.get_size_inches()
    edges = figure.get_tightbbox(renderer)
    margin = min(edges.x0, edges.y0, width - edges.x1, height - edges.y1)
    if margin < -0.06:  # a number at the end of an axis may stand out by so much
        found.append(f"cut off: {edges} of {width} x {height} inches")
    texts = [(text, text.get_window_extent(renderer)) for text in _texts(figure)]
    for text, _ in texts:
        if not LETTERS[0] <= text.get_fontsize() <= LETTERS[1]:
            found.append(f"{text.get_text()!r} in {text.get_fontsize()} points")
    for (one, here), (other, there) in combinations(texts, 2):
        if _meet(here, there):
            found.append(f"{one.get_text()!r} on {other.get_text()!r}")
    for (i, one), (j, other) in combinations(enumerate(figure.axes), 2):
        if _meet(one.get_window_extent(renderer), other.get_window_extent(renderer)):
            found.append(f"axes {i} on axes {j}")
    for axes in figure.axes:
        found += [*_lines(axes), *_empty(axes, filled if len(figure.axes) == 1 else 0.35 * filled)]
        named = axes.get_legend_handles_labels()[1]
        if named and axes.get_legend() is None and not figure.legends and width > 4.0:  # others share that of a row
            found.append("names without a legend")
        for axis in (axes.xaxis, axes.yaxis) if len(figure.axes) == 1 and axes.axison else ():
            numbers = [text for text in axis.get_ticklabels() if re.fullmatch(r"[−\d.]+", text.get_text())]
            if numbers and not axis.label.get_text():
                found.append("numbers of which nobody says what they are")
        if (scale := getattr(axes, "_colorbar", None)) is not None and scale.outline.get_visible():
            found.append("a frame around the scale of colours")
        bars = [bar for group in axes.containers if isinstance(group, BarContainer) for bar in group]
        boxes = [bar.get_window_extent(renderer) for bar in bars]
        found += ["a bar on a bar" for here, there in combinations(boxes, 2) if _meet(here, there)]
    return found


def _texts(figure: Figure) -> Iterator[Text]:
    """All words that are drawn."""
    ticks = {id(t) for axis in figure.findobj(Axis) for minor in (0, 1) for t in axis.get_ticklabels(minor=bool(minor))}
    shown = {id(t.label1) for axis in figure.findobj(Axis) if _seen(axis) for t in axis._update_ticks()}
    for text in figure.findobj(Text):
        if text.get_visible() and text.get_text().strip() and (id(text) not in ticks or id(text) in shown):
            yield text


def _seen(axis: Axis) -> bool:
    return axis.get_visible() and axis.axes.axison


def _lines(axes: Axes) -> Iterator[str]:
    x, y = (sorted(limits) for limits in (axes.get_xlim(), axes.get_ylim()))
    for line in axes.lines:
        name, points = line.get_label(), np.column_stack(line.get_data())
        drawn = line.get_linestyle() != "None" and line.get_linewidth() > 0
        if drawn and not WIDTHS[0] <= line.get_linewidth() <= WIDTHS[1]:
            yield f"line {name} {line.get_linewidth()} points wide"
        if (
            line.get_marker() not in ("None", "", None)
            and line.get_markersize()
            and not MARKS[0] <= line.get_markersize() <= MARKS[1]
        ):
            yield f"marks of {name} of {line.get_markersize()} points"
        if line.get_transform() == axes.transData and len(points):
            seen = (points >= (x[0], y[0])) & (points <= (x[1], y[1]))
            if not seen.all(axis=1).any():
                yield f"line {name} out of view"


def _empty(axes: Axes, least: float) -> Iterator[str]:
    """Axes of which what is drawn fills only a small part, either way."""
    if not axes.axison or hasattr(axes, "_colorbar"):
        return
    if not axes.has_data():
        yield "axes in which nothing is drawn"
        return
    box = axes.dataLim.transformed(axes.transData).transformed(axes.transAxes.inverted())
    for way, (low, high) in {"width": (box.x0, box.x1), "height": (box.y0, box.y1)}.items():
        filled = min(high, 1.0) - max(low, 0.0)
        if high > low and filled < least:
            yield f"{filled:.0%} of the {way} of the axes are filled"


def _meet(here: Bbox, there: Bbox) -> bool:
    """Whether two boxes share more than a pixel in both directions."""
    common = Bbox.intersection(here, there)
    return common is not None and min(common.width, common.height) > 1.0
