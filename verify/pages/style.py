"""Colours, line styles, parts of several figures, and their SVG, which follows the colours of the page.

Figures are drawn with stand-in colours; in the SVG each is replaced by a CSS custom property, so that one figure serves
the light page, the dark page and the print. Colours are written in ``PALETTE`` alone, but for those of methods and
bases, which are in their records.
"""

from __future__ import annotations

import io
import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from html import escape
from pathlib import Path
from textwrap import fill
from typing import Any

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.colors import LinearSegmentedColormap
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullFormatter
from matplotlib.transforms import Bbox

from verify.methods.names import METHODS
from verify.methods.plugins import find
from verify.support.timing import PHASES

#: name: (light, dark). The methods follow Okabe and Ito 2008, whose colours stay apart in all common colour blindness;
#: two of them are darker here, so that text in them has a contrast of 4.5 with the page.
PALETTE = {
    "ink": ("#1b2330", "#e4e8ee"),
    "muted": ("#566171", "#a3aebc"),
    "rule": ("#d5dbe3", "#39424e"),
    "paper": ("#ffffff", "#12161c"),
    "panel": ("#f5f7f9", "#1a2028"),
    "accent": ("#2b5c8a", "#8dbbe6"),
    "good": ("#1f7a4d", "#5fce97"),
    "bad": ("#b3261e", "#ff8a7d"),
    "zone": ("#e6b400", "#e6b400"),
    **{name: one.look.colours for name, one in METHODS.items() if one.look.colours},
    "other-1": ("#6b5d00", "#d6c34a"),  # codes of others, in turn
    "other-2": ("#a3123f", "#ff9bb3"),
    "other-3": ("#006d77", "#63cdd6"),
    "other-4": ("#7d4427", "#d9a283"),
    "other-5": ("#3f4a5a", "#b5c0cf"),
    "phase-mesh": ("#b9c4d0", "#566373"),
    "phase-basis": ("#8fa3b8", "#7a8da3"),
    "phase-assembly": ("#3f6f9f", "#79aee0"),
    "phase-factor": ("#d9a441", "#e8bd6a"),
    "phase-solve": ("#a3672b", "#c88b4f"),
    "phase-other": ("#dfe3e8", "#3d4652"),
}

_STAND_IN = {name: f"#0a0b{i + 1:02x}" for i, name in enumerate(PALETTE)}

#: In the order of tables and legends.
IN_TABLES = tuple(sorted(METHODS, key=lambda name: METHODS[name].look.place))
METHOD_NAMES = {name: one.label + " limit" * one.is_limit for name, one in METHODS.items()}
SHOWN_PHASES = (*PHASES, "other")

#: Widths of figures in inches, for which 8 pt text is readable at the size shown.
THIRD, HALF, WIDE = 3.3, 4.6, 9.4

#: Margin in inches around a drawing, as a browser's font may be larger than that of the layout.
_FIGURE_PADDING = 0.04

# Stresses near zero are transparent and have the colour of the page.
STRESS_MAP = LinearSegmentedColormap.from_list(
    "stress",
    [(0.0, "#1668b8ff"), (0.25, "#3b8ad6b0"), (0.5, "#8a929c18"), (0.75, "#e5742fb0"), (1.0, "#c8480cff")],
)

#: The settings of figures.
_SETTINGS = Path(__file__).with_name("page.mplstyle")

#: What is replaced in the SVG of matplotlib, in this order: pattern and replacement.
_CHANGES = (
    (r"<metadata>.*?</metadata>|<defs>\s*<style.*?</style>\s*</defs>", ""),  # the page says of all paths how lines join
    (r"font: (?:[a-z0-9.]+ )*?([\d.]+)px [^;\"]*", r"font-size: \1px"),
    (r" ?font-family: [^;\"]*;?", ""),
    (r'(?<=<g) id="[^"]*"| id="image\w+"| transform="rotate\(-0 [-\d. ]+\)"', ""),  # nothing refers to them
    (r"\s*\n([A-Zz]) ?", r"\1"),
    (r">\s+<", "><"),
)
#: Decimals of a point that are invisible.
_INVISIBLE = re.compile(r"(\d\d\.\d|\.\d\d)\d+")
_STYLE = re.compile(r' style="([^"]*)"')


@dataclass(frozen=True)
class Panel:
    """One figure of the page."""

    svg: str
    caption: str
    size: str = "half"  # wide, half or third of the page

    @staticmethod
    def of(figure: Figure, key: str, title: str, caption: str, size: str = "half") -> Panel:
        """A drawing, with ``key`` and ``title`` as of `to_svg`."""
        return Panel(to_svg(figure, key, title), caption, size)


@dataclass(frozen=True)
class Line:
    """The line style of a run, the same in every figure."""

    colour: str  # name in PALETTE
    width: float
    dashes: tuple[float, ...]  # on, off, ... in points; empty: solid
    alpha: float
    order: float

    def options(self) -> dict[str, Any]:
        """Keyword arguments for ``Axes.plot``."""
        style = (0, self.dashes) if self.dashes else "solid"
        return {
            "color": colour(self.colour),
            "linewidth": self.width,
            "linestyle": style,
            "alpha": self.alpha,
            "zorder": self.order,
        }


def line(method: str, repeat: int = 0) -> Line:
    """Style of the ``repeat``-th run of a method: further runs of the same method get thinner and fainter."""
    look = find(method).look
    fade = 0.6**repeat
    width, alpha = max(look.width * fade, 0.6), look.alpha * max(fade, 0.4)
    return Line(method if look.colours else "ink", width, look.dashes, alpha, look.order - 0.1 * repeat)


def colour(name: str) -> str:
    """The stand-in of a palette colour for figures."""
    return _STAND_IN[name]


def custom_properties(dark: bool) -> str:
    """CSS declarations of the palette."""
    return " ".join(f"--{name}: {pair[int(dark)]};" for name, pair in PALETTE.items())


@contextmanager
def drawing() -> Iterator[None]:
    """The figure settings of the report, for the block."""
    inks = {key: colour("muted") for key in ("axes.edgecolor", "xtick.color", "ytick.color", "hatch.color")}
    inks |= {key: colour("ink") for key in ("text.color", "axes.labelcolor", "lines.color", "patch.edgecolor")}
    with matplotlib.rc_context({**inks, "grid.color": colour("rule")}, _SETTINGS):
        yield


def panel(width: float, height: float, left: float = 0.57, top: float = 0.17) -> tuple[Figure, Axes]:
    """A figure of one pair of axes with fixed margins, so that panels line up (lengths in inches)."""
    figure, bottom = Figure(figsize=(width, height)), 0.43
    place = (left / width, bottom / height, 1 - (left + 0.1) / width, 1 - (bottom + top) / height)
    return figure, figure.add_axes(place)


def sheet_of(figure: Figure) -> Bbox:
    """Bounding box in inches of the figure with all tick labels and axis labels, which are broken into lines first.

    Units are free text, and the length of numbers depends on them, so no fixed margin is sufficient.
    """
    for axes in figure.axes:
        size = axes.get_window_extent()
        for label, room in ((axes.xaxis.label, size.width), (axes.yaxis.label, size.height)):
            text, columns = label.get_text(), len(label.get_text())
            while columns > 1 and not label.get_parse_math() and max(label.get_window_extent().size) > room:
                columns -= 1  # within words if necessary
                label.set_text(fill(text, columns))
    return Bbox.union([figure.bbox_inches, figure.get_tightbbox().padded(_FIGURE_PADDING)])


def to_svg(figure: Figure, key: str, title: str) -> str:
    """The figure as an inline SVG element that follows the colours and the font of the page.

    Parameters
    ----------
    key : unique in the page; ids inside the SVG carry it, as all figures share one document.
    title : read out by screen readers in place of the drawing.
    """
    buffer, sheet = io.StringIO(), sheet_of(figure)
    shown = None if np.array_equal(sheet.extents, figure.bbox_inches.extents) else sheet
    none = {"Date": None, "Creator": None}
    with matplotlib.rc_context({"svg.hashsalt": key}):  # ids of a figure are its own
        figure.savefig(buffer, format="svg", dpi=180, transparent=True, metadata=none, bbox_inches=shown)
    svg = buffer.getvalue()
    for name, stand_in in _STAND_IN.items():
        svg = svg.replace(stand_in, f"var(--{name})")
    return _adapted(svg, key, title)


def _adapted(svg: str, key: str, title: str) -> str:
    """The SVG element alone, named by ``title``; ``key`` is unique in the page. Styles are classes, told once."""
    for pattern, replacement in _CHANGES:
        svg = re.sub(pattern, replacement, svg, flags=re.DOTALL)
    svg = re.sub("<[^>]*>", lambda tag: _INVISIBLE.sub(r"\1", tag[0]), svg)
    head, content = re.split("(?<=>)", svg[svg.index("<svg") :], maxsplit=1)
    styles = {style: f"s{i}" for i, style in enumerate(dict.fromkeys(_STYLE.findall(content)))}
    content = _STYLE.sub(lambda found: f' class="{styles[found[1]]}"', content)
    rules = "".join(f"#{key} .{name}{{{style}}}" for style, name in styles.items())
    box = re.findall(r'viewBox="[^"]*"', head)[0]
    return (
        f'<svg class="plot" id="{key}" role="img" aria-labelledby="{key}-t" {box}>'
        f'<title id="{key}-t">{escape(title)}</title><style>{rules}</style>{content}'
    )


def plain(part: Axis) -> None:
    """Ticks at 1, 2, 5, 10, ... with plain numbers."""
    part.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    part.set_major_formatter(lambda value, _: f"{value:g}")
    part.set_minor_formatter(NullFormatter())


def phase_bars(axes: Axes, labels: Sequence[str], seconds: Mapping[str, Sequence[float]]) -> tuple[np.ndarray, ...]:
    """Stacked bars of the seconds by phase, one per label, the first on top. Returns positions and ends of the bars."""
    at, left = np.arange(len(labels))[::-1], np.zeros(len(labels))
    for name, width in seconds.items():
        axes.barh(at, width, 0.62, left, color=colour(f"phase-{name}"), linewidth=0, label=name)
        left += width
    axes.set_yticks(at, labels)
    axes.grid(False, axis="y")
    return at, left


def name_points(axes: Axes, places: np.ndarray, names: Sequence[str], inks: Sequence[str]) -> None:
    """Write a name beside each point (n, 2), one line above the other; the limits of the axes must be final."""
    at, line, height = axes.transData.transform(places) * 72.0 / axes.figure.dpi, 9.5, -np.inf  # points
    middle = np.mean(axes.get_window_extent().intervalx) * 72.0 / axes.figure.dpi
    for i in np.argsort(at[:, 1]):
        height, left = max(at[i, 1], height + line), at[i, 0] < middle
        shift = 7.0 if left else -7.0, height - at[i, 1] - 3.0
        align = "left" if left else "right"
        axes.annotate(names[i], places[i], shift, textcoords="offset points", color=inks[i], ha=align)
