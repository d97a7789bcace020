"""Loads and supports on patches of a specimen, drawn beside it."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Arc, Polygon

from verify.pages.style import colour
from verify.pages.text import number
from verify.scene.specimens.delamination import Delamination, Load, Support

#: Inches: length of an arrow, size of a foot, radius of a couple.
_LONG, _FOOT, _TURN = 0.36, 0.12, 0.17


def acting(axes: Axes, body: Delamination, scale: float, outer: tuple[float, float]) -> None:
    """Arrows of loads and feet of supports; ``outer`` are the heights of the outer faces, all in inches."""
    for load in body.loads:
        x, y = _place(body, load, scale, outer)
        label = f"{number(abs(load.share), 3)} P" if abs(load.share) != 1.0 else "P"
        if load.couple:
            _couple(axes, (x - 0.02, y), load.share > 0.0)
            axes.text(x - _TURN - 0.08, y, label, ha="right", va="center", color=colour("bad"))
            continue
        down = load.share < 0.0
        far = y + np.sign(y) * _LONG
        pull(axes, (x, far), y - far) if down == (y > 0.0) else pull(axes, (x, y), far - y)
        axes.text(x + 0.06, far - 0.06 * np.sign(y), label, ha="left", va="center", color=colour("bad"))
    for support in body.supports:
        if support.side in ("top", "bottom"):
            _foot(axes, _place(body, support, scale, outer), support.side == "bottom")
    for side in dict.fromkeys(support.side for support in body.supports if support.side in ("left", "right")):
        couples = [support.couple for support in body.supports if support.side == side]
        _wall(axes, (0.0 if side == "left" else body.lengths[0] * scale, outer), side, all(couples), any(couples))


def pull(axes: Axes, foot: tuple[float, float], length: float) -> None:
    """The arrow of a transverse load."""
    arrow = {"arrowstyle": "-|>", "color": colour("bad"), "linewidth": 1.2, "shrinkA": 0, "shrinkB": 0}
    axes.annotate("", (foot[0], foot[1] + length), foot, arrowprops=arrow, zorder=5)


def _place(body: Delamination, patch: Load | Support, scale: float, outer: tuple[float, float]) -> tuple[float, float]:
    """The middle of a patch."""
    end = 0.0 if patch.side == "left" else body.lengths[patch.body or 0]
    X = (end if patch.extent is None else sum(patch.extent) / 2) * scale
    if patch.side in ("left", "right"):
        return X, sum(outer) / 2 if patch.body is None else outer[patch.body] / 2
    on_bond = (patch.side == "bottom") == (patch.body == 0)
    return X, 0.0 if on_bond else outer[patch.body or 0]


def _foot(axes: Axes, place: tuple[float, float], below: bool) -> None:
    x, y = place
    down = -_FOOT if below else _FOOT
    corners = [(x, y), (x - 0.7 * _FOOT, y + down), (x + 0.7 * _FOOT, y + down)]
    axes.add_patch(Polygon(corners, facecolor=colour("paper"), edgecolor=colour("ink"), linewidth=0.7, zorder=4))
    axes.plot([x - _FOOT, x + _FOOT], 2 * [y + 1.25 * down], color=colour("ink"), linewidth=0.9, zorder=4)


def _couple(axes: Axes, place: tuple[float, float], anticlockwise: bool) -> None:
    """An arc on the left of a face, with its arrow at the lower end where it turns anticlockwise."""
    axes.add_patch(
        Arc(place, 2 * _TURN, 2 * _TURN, theta1=100, theta2=260, color=colour("bad"), linewidth=1.2, zorder=5)
    )
    up = -1.0 if anticlockwise else 1.0
    angle = np.radians(100.0)
    x, y = place[0] + _TURN * np.cos(angle), place[1] + up * _TURN * np.sin(angle)
    arrow = {"arrowstyle": "-|>", "color": colour("bad"), "linewidth": 1.2, "shrinkA": 0, "shrinkB": 0}
    axes.annotate("", (x + 0.09, y), (x - 0.03, y - 0.01 * up), arrowprops=arrow, zorder=5)


def _wall(axes: Axes, place: tuple[float, tuple[float, float]], side: str, alone: bool, turns: bool) -> None:
    """A wall along which an end slides in X."""
    (x, (top, bottom)), out = place, -1.0 if side == "left" else 1.0
    axes.plot([x, x], [bottom - 0.08, top + 0.08], color=colour("ink"), linewidth=1.4, zorder=4)
    axes.plot(*np.array(list(_hatching(x, bottom, top, out))).T, color=colour("muted"), linewidth=0.6)
    words = [*["held in y"] * (not alone), *["does not turn"] * turns]
    note = "\n".join(words)
    beside = "right" if side == "left" else "left"
    axes.text(x + 0.16 * out, 0.0, note, fontsize=7, color=colour("muted"), ha=beside, va="center")


def _hatching(x: float, bottom: float, top: float, out: float) -> Iterator[tuple[float, float]]:
    """One line in a zigzag behind a wall."""
    for y in np.linspace(bottom - 0.08, top + 0.08, 9):
        yield from ((x, y), (x + 0.07 * out, y + 0.06), (x, y))
