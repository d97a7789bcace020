"""The picture of a mesh: Bezier elements with their curved sides, T-junctions and extraordinary points marked."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.figure import Figure

from iga.mesh.extraction import SIDES
from verify.command_line.mesh.facts import MeshFacts
from verify.pages.style import PALETTE

#: Inches: width of the picture, its largest height, margin, and height of title and legend.
_WIDTH, _MOST_HEIGHT, _SHEET_MARGIN, _TITLE_HEIGHT = 7.0, 7.0, 0.15, 0.45

#: Points on a curved side; deviation, over the length, below which a side is drawn straight.
_SIDE_SAMPLES, _STRAIGHT_SIDE = 17, 1e-6

_SHEET_STYLE = {"font.family": "sans-serif", "font.size": 8.0, "svg.fonttype": "none", "svg.hashsalt": "debond"}


def light(name: str) -> str:
    """A colour of the palette on white paper."""
    return PALETTE[name][0]


def draw(axes: Axes, facts: MeshFacts, control: bool = False, ink: Callable[[str], str] = light) -> None:
    """Draw a mesh to scale.

    Parameters
    ----------
    control : whether the control points are drawn too.
    ink : colour of a name in the palette of the report.
    """
    sides, curves = facts.sides, _curves(facts)
    common = min(tuple(block.degrees) for block in facts.mesh.blocks)
    odd = [number for number, block in enumerate(facts.mesh.blocks) if tuple(block.degrees) != common]
    other = np.flatnonzero(np.isin(sides.block_k[:: len(SIDES)], odd))
    if other.size:
        label = f"degrees other than {common[0]} and {common[1]}"
        around = [[*SIDES].index(name) for name in ("BOTTOM", "RIGHT", "TOP", "LEFT")]  # counter-clockwise
        outlines = [np.concatenate([curves[len(SIDES) * e + i] for i in around]) for e in other]
        axes.add_collection(PolyCollection(outlines, color=ink("zone"), alpha=0.25, linewidth=0, label=label))
    k, opposite, t = sides.opposite
    shared_k = sides.shared_k.copy()
    shared_k[k[(t == 0.5) & (k > opposite)]] = False  # the other of the two is drawn
    axes.add_collection(
        LineCollection([curves[k] for k in np.flatnonzero(shared_k)], color=ink("accent"), linewidth=0.5)
    )
    outer = [curves[k] for k in np.flatnonzero(~sides.shared_k)]
    axes.add_collection(LineCollection(outer, color=ink("ink"), linewidth=1.1, capstyle="round"))
    if control:
        axes.plot(*facts.mesh.P_AI.T, ".", color=ink("muted"), markersize=2.5, label="control points")
    if len(facts.junctions):
        label = f"{len(facts.junctions)} T-junctions"
        axes.plot(*facts.junctions.T, "o", color=ink("bad"), markersize=3.5, markeredgewidth=0, label=label)
    if facts.extraordinary:
        X = np.array([x for _, x in facts.extraordinary])
        axes.plot(*X.T, "D", color=ink("tspline"), markersize=4.5, label="extraordinary points, with their valence")
        for valence, x in facts.extraordinary:
            style: dict[str, Any] = {"color": ink("tspline"), "fontweight": "bold", "textcoords": "offset points"}
            axes.annotate(str(valence), (x[0], x[1]), xytext=(4, 4), **style)
    axes.set_aspect("equal")
    axes.set_axis_off()


def mesh_figure(facts: MeshFacts, title: str, control: bool = False) -> Figure:
    """A figure of the mesh with a legend."""
    X = np.concatenate([curve for curve in _curves(facts)])
    if control:
        X = np.concatenate([X, facts.mesh.P_AI])
    low, high = X.min(0), X.max(0)
    extent = np.maximum(high - low, 1e-3 * max((high - low).max(), np.finfo(float).tiny))
    scale = min((_WIDTH - 2 * _SHEET_MARGIN) / extent[0], (_MOST_HEIGHT - _TITLE_HEIGHT) / extent[1])
    height = max(scale * extent[1] + _SHEET_MARGIN + 2 * _TITLE_HEIGHT, 1.2)
    figure = Figure(figsize=(_WIDTH, height))
    axes = figure.add_axes(
        (_SHEET_MARGIN / _WIDTH, _TITLE_HEIGHT / height, 1 - 2 * _SHEET_MARGIN / _WIDTH, 1 - 2 * _TITLE_HEIGHT / height)
    )
    draw(axes, facts, control)
    pad = 0.01 * extent.max()
    axes.set(xlim=(low[0] - pad, high[0] + pad), ylim=(low[1] - pad, high[1] + pad))
    figure.text(_SHEET_MARGIN / _WIDTH, 1 - 0.25 / height, title, color=light("ink"), parse_math=False)
    handles, labels = axes.get_legend_handles_labels()
    if handles:
        figure.legend(handles, labels, loc="lower left", ncols=3, frameon=False, labelcolor=light("muted"))
    return figure


def save(facts: MeshFacts, path: Path, title: str, control: bool = False) -> None:
    """Write the picture in the format of the suffix: svg, png or pdf.

    Raises
    ------
    OSError : the path cannot be written to.
    """
    with matplotlib.rc_context(_SHEET_STYLE):
        figure = mesh_figure(facts, title, control)
        stamp = {"svg": {"Date": None, "Creator": None}, "pdf": {"CreationDate": None}}.get(path.suffix[1:].lower())
        figure.savefig(path, dpi=200, facecolor=light("paper"), metadata=stamp)


def _curves(facts: MeshFacts) -> list[np.ndarray]:
    """Points (n, 2) on every side: two on a straight side, more on a curved one."""
    sides = facts.sides
    t, k = np.linspace(0.0, 1.0, _SIDE_SAMPLES), np.arange(len(sides.H_kbI))
    X_knI = sides.points(np.repeat(k, _SIDE_SAMPLES), np.tile(t, len(k)))[:, :2].reshape(len(k), _SIDE_SAMPLES, 2)
    chord = X_knI[:, -1] - X_knI[:, 0]
    away = X_knI - X_knI[:, :1]
    bent = np.abs(chord[:, None, 0] * away[..., 1] - chord[:, None, 1] * away[..., 0]).max(1)
    straight = bent <= _STRAIGHT_SIDE * np.sum(chord * chord, 1)
    return [X_nI[[0, -1]] if flat else X_nI for X_nI, flat in zip(X_knI, straight, strict=True)]
