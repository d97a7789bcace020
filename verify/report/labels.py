"""Names beside the points of a chart, where they meet neither each other nor another point."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes

#: Points: width of a letter, height of a line, half a marker, and between a marker and its name.
_LETTER, _LINE, _MARKER, _GAP = 4.9, 9.5, 4.0, 7.0
#: Where a name may stand: its end that is beside the point, and its baseline above the point; the best first.
_SIDES = (("left", 4.0), ("right", 4.0), ("left", -11.0), ("right", -11.0), ("center", 8.0), ("center", -16.0))

Box = tuple[float, float, float, float]


def name_points(axes: Axes, places: Sequence[tuple[float, float]], names: Sequence[str], inks: Sequence[str]) -> None:
    """Write a name beside each of the points, whose scales and limits are final.

    Parameters
    ----------
    places : coordinates of the points in the data of ``axes``
    names, inks : text and colour, one a point
    """
    to_points = 72.0 / axes.figure.dpi
    at = axes.transData.transform(np.asarray(places, float)) * to_points
    inside = tuple(axes.get_window_extent().extents * to_points)
    taken = [(x - _MARKER, y - _MARKER, x + _MARKER, y + _MARKER) for x, y in at.tolist()]
    for number, (point, name, ink) in enumerate(zip(at.tolist(), names, inks, strict=True)):
        others = [box for other, box in enumerate(taken) if other != number]
        width = _LETTER * len(name)

        def lost(option: tuple[str, float], point=point, width=width, others=others) -> float:
            box = _box(point, *option, width)
            return sum(_common(box, one) for one in others) + _area(box) - _common(box, inside)

        ahead = _SIDES if point[0] < 0.5 * (inside[0] + inside[2]) else (_SIDES[3], *_SIDES)
        side, rise = min(ahead, key=lost)  # the first of the best
        taken.append(_box(point, side, rise, width))
        shift = {"left": _GAP, "right": -_GAP, "center": 0.0}[side], rise
        axes.annotate(name, places[number], shift, textcoords="offset points", color=ink, ha=side)


def _box(point: Sequence[float], side: str, rise: float, width: float) -> Box:
    """Left, bottom, right and top of a name, in points."""
    left = point[0] + {"left": _GAP, "right": -_GAP - width, "center": -0.5 * width}[side]
    bottom = point[1] + rise - 2.0  # what hangs below the baseline
    return left, bottom, left + width, bottom + _LINE


def _area(box: Box) -> float:
    return (box[2] - box[0]) * (box[3] - box[1])


def _common(one: Box, other: Box) -> float:
    """Area that two boxes share."""
    width = min(one[2], other[2]) - max(one[0], other[0])
    height = min(one[3], other[3]) - max(one[1], other[1])
    return max(width, 0.0) * max(height, 0.0)
