"""Names beside the points of a chart, placed without overlaps."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes

#: In points: width of a letter, height of a line, half the size of a marker, gap between marker and name.
_LETTER, _LINE, _MARKER, _GAP = 4.9, 9.5, 4.0, 7.0
#: Possible places of a name, best first: the end of the name beside the point, height of the baseline over the point.
_SIDES = (("left", 4.0), ("right", 4.0), ("left", -11.0), ("right", -11.0), ("center", 8.0), ("center", -16.0))

Box = tuple[float, float, float, float]


def name_points(axes: Axes, places: Sequence[tuple[float, float]], names: Sequence[str], inks: Sequence[str]) -> None:
    """Write a name beside each point; the scales and limits of the axes must be final.

    Parameters
    ----------
    places : coordinates of the points in the data of ``axes``
    names, inks : text and colour of each point
    """
    to_points = 72.0 / axes.figure.dpi
    at = [(to_points * x, to_points * y) for x, y in axes.transData.transform(np.asarray(places, float))]
    left, bottom, right, top = (to_points * value for value in axes.get_window_extent().extents)
    markers = [(x - _MARKER, y - _MARKER, x + _MARKER, y + _MARKER) for x, y in at]
    written: list[Box] = []
    for number, (point, name, ink) in enumerate(zip(at, names, inks, strict=True)):
        others = [*markers[:number], *markers[number + 1 :], *written]
        sides = _SIDES if point[0] < 0.5 * (left + right) else (_SIDES[3], *_SIDES)
        boxes = [_box(point, side, rise, _LETTER * len(name)) for side, rise in sides]
        misplaced = [_misplaced(box, (left, bottom, right, top), others) for box in boxes]
        best = misplaced.index(min(misplaced))  # the first of them
        side, rise = sides[best]
        written.append(boxes[best])
        shift = {"left": _GAP, "right": -_GAP, "center": 0.0}[side], rise
        axes.annotate(name, places[number], shift, textcoords="offset points", color=ink, ha=side)


def _box(point: Sequence[float], side: str, rise: float, width: float) -> Box:
    """Left, bottom, right and top of a name, in points."""
    left = point[0] + {"left": _GAP, "right": -_GAP - width, "center": -0.5 * width}[side]
    bottom = point[1] + rise - 2.0  # descenders
    return left, bottom, left + width, bottom + _LINE


def _misplaced(box: Box, inside: Box, others: Sequence[Box]) -> float:
    """Area of a box that lies outside the axes or overlaps other boxes."""
    area = (box[2] - box[0]) * (box[3] - box[1])
    return sum(_overlap(box, one) for one in others) + area - _overlap(box, inside)


def _overlap(one: Box, other: Box) -> float:
    """Area that two boxes share."""
    width = min(one[2], other[2]) - max(one[0], other[0])
    height = min(one[3], other[3]) - max(one[1], other[1])
    return max(width, 0.0) * max(height, 0.0)
