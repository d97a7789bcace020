"""Curves, meshes and tables as HTML for a notebook, without scripts or style sheets, in the colour of the text around.

A notebook has a light or a dark background, and does not say which.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from html import escape
from math import ceil, floor, log10

import numpy as np
from numpy.typing import ArrayLike

WIDTH, HEIGHT = 460, 260
#: Room for numbers and labels left of and below the axes, and beyond their ends.
MARGIN_LEFT, BELOW, BEYOND = 64, 42, 12
#: Tick marks of an axis at most.
TICKS = 6
#: Least height of a drawing of bodies over its width; flatter ones are drawn higher than they are.
FLATTEST = 0.15


@dataclass(frozen=True)
class Drawn:
    """A curve by its name; ``behind`` others it is wide and faint, in the colour of the text."""

    name: str
    opening: ArrayLike
    load: ArrayLike
    behind: bool = False

    @property
    def style(self) -> str:
        """Its stroke; the blue has a contrast of 3 and more with white and with black."""
        look = 'stroke="currentColor" stroke-width="5" stroke-opacity=".35"'
        return look if self.behind else 'stroke="#2b82d9" stroke-width="1.8"'


def chart(curves: Sequence[Drawn]) -> str:
    """Load over opening as an SVG element, with a legend where there are several curves."""
    points = [np.stack([np.ravel(np.asarray(v, dtype=float)) for v in (one.opening, one.load)], -1) for one in curves]
    points = [one[np.isfinite(one).all(axis=1)] for one in points]
    x, y = (_Axis.of(np.concatenate([one[:, i] for one in points]), *ends) for i, ends in enumerate(_ENDS))
    marks = [*(_mark(x, y, at, True) for at in x.ticks), *(_mark(x, y, at, False) for at in y.ticks)]
    lines = []
    for curve, at in sorted(zip(curves, points, strict=True), key=lambda pair: not pair[0].behind):
        places = " ".join(f"{x.place(d):.1f},{y.place(P):.1f}" for d, P in at)
        lines.append(f'<polyline fill="none" {curve.style} points="{places}"/>')
    names = " and ".join(one.name for one in curves)
    return (
        f'<svg role="img" width="{WIDTH}" height="{HEIGHT}" viewBox="0 0 {WIDTH} {HEIGHT}" font-size="12" '
        f'fill="currentColor" style="max-width: 100%"><title>{escape(f"Load over opening: {names}")}</title>'
        f"{''.join(marks)}{''.join(lines)}{_legend(curves) if len(curves) > 1 else ''}"
        f'<text x="{WIDTH - BEYOND}" y="{HEIGHT - 6}" text-anchor="end">opening</text>'
        f'<text x="4" y="{BEYOND + 2}">load</text></svg>'
    )


def drawn(lines: Iterable[ArrayLike], text: str, wide: Iterable[ArrayLike] = ()) -> str:
    """Lines (n, 2) of a body or a mesh as an SVG element above a text, those of ``wide`` on top in blue."""
    thin, thick = ([np.reshape(np.asarray(one, dtype=float), (-1, 2)) for one in some] for some in (lines, wide))
    low, high = (get(np.concatenate([np.zeros((0, 2)), *thin, *thick]), 0) for get in (np.min, np.max))
    across, up = np.maximum(high - low, 1e-300)
    higher = max(1.0, FLATTEST * across / up)
    scale = min((WIDTH - 2 * BEYOND) / across, HEIGHT / (higher * up))
    tall = higher * up * scale + 2 * BEYOND
    strokes = [(one, 'stroke="currentColor" stroke-width=".8"') for one in thin]
    strokes += [(one, 'stroke="#2b82d9" stroke-width="3"') for one in thick]
    paths = []
    for one, look in strokes:
        x, y = ((one - low) * (scale, higher * scale)).T
        places = " ".join(f"{a:.1f},{b:.1f}" for a, b in zip(BEYOND + x, tall - BEYOND - y, strict=True))
        paths.append(f'<polyline fill="none" {look} points="{places}"/>')
    text += f"; heights are drawn {higher:.3g} times as large" * bool(higher > 1.0)
    return (
        f'<svg role="img" width="{WIDTH}" height="{tall:.0f}" viewBox="0 0 {WIDTH} {tall:.0f}" '
        f'style="max-width: 100%"><title>{escape(text)}</title>{"".join(paths)}</svg><p>{escape(text)}</p>'
    )


def grids(X_euvi: np.ndarray) -> list[np.ndarray]:
    """The four sides of every element of grids of points (n_e, n, m, 2)."""
    sides = X_euvi[:, 0], X_euvi[:, -1], X_euvi[:, :, 0], X_euvi[:, :, -1]
    return [line for side in sides for line in side]


def table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Rows of text below a head."""

    def row(cells: Sequence[str], tag: str) -> str:
        made = (f'<{tag} style="text-align: left; padding-right: 1em">{escape(text)}</{tag}>' for text in cells)
        return f"<tr>{''.join(made)}</tr>"

    body = "".join(row(cells, "td") for cells in rows)
    return f"<table><thead>{row(head, 'th')}</thead><tbody>{body}</tbody></table>"


@dataclass(frozen=True)
class _Axis:
    """Values from ``low`` to ``high`` at pixels from ``start`` to ``end``."""

    low: float
    high: float
    start: float
    end: float

    @staticmethod
    def of(values: np.ndarray, start: float, end: float) -> _Axis:
        """From the least to the largest value, zero included."""
        low, high = float(np.min(values, initial=0.0)), float(np.max(values, initial=0.0))
        return _Axis(low, high if high > low else low + 1.0, start, end)

    def place(self, value: float) -> float:
        return self.start + (value - self.low) / (self.high - self.low) * (self.end - self.start)

    @property
    def ticks(self) -> list[float]:
        """Multiples of 1, 2 or 5 times a power of ten."""
        length = self.high - self.low
        unit = 10.0 ** floor(log10(length / TICKS))
        step = unit * next(times for times in (1, 2, 5, 10) if length / (times * unit) < TICKS)
        return [i * step for i in range(ceil(self.low / step), floor(self.high / step) + 1)]


#: Pixels of both axes, the origin first.
_ENDS = (MARGIN_LEFT, WIDTH - BEYOND), (HEIGHT - BELOW, 2 * BEYOND)


def _mark(x: _Axis, y: _Axis, at: float, upright: bool) -> str:
    """A line of the grid with its number, at a value of x where it is upright."""
    axis, other = (x, y) if upright else (y, x)
    here, ends = axis.place(at), (other.start, other.end)
    a, b = ((here, end) if upright else (end, here) for end in ends)
    text = (here, y.start + 17) if upright else (x.start - 6, here + 4)
    anchor = "middle" if upright else "end"
    return (
        f'<path d="M{a[0]:.1f} {a[1]:.1f}L{b[0]:.1f} {b[1]:.1f}" stroke="currentColor" '
        f'stroke-opacity="{0.6 if at == 0 else 0.15}"/>'
        f'<text x="{text[0]:.1f}" y="{text[1]:.1f}" text-anchor="{anchor}">{at:.4g}</text>'
    )


def _legend(curves: Sequence[Drawn]) -> str:
    """A stroke and the name of every curve, in the upper right corner."""
    parts = []
    for i, curve in enumerate(curves):
        y = 3 * BEYOND + 18 * i
        parts.append(f'<path d="M{WIDTH - 40} {y}h26" fill="none" {curve.style}/>')
        parts.append(f'<text x="{WIDTH - 46}" y="{y + 4}" text-anchor="end">{escape(curve.name)}</text>')
    return "".join(parts)
