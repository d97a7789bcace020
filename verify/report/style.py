"""Colours, line styles and the way a matplotlib figure becomes SVG that follows the page.

Figures are drawn with stand-in colours; in the SVG each is replaced by a CSS custom property, so that one figure serves
the light page, the dark page and the print. The pairs in ``PALETTE`` are the only place where a colour is written.
"""

from __future__ import annotations

import base64
import io
import re
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from html import escape
from typing import Any
from zlib import crc32

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LinearSegmentedColormap
from matplotlib.figure import Figure
from PIL import Image

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
    "nurbs": ("#0072b2", "#5bb8f0"),
    "tspline": ("#4b3fa0", "#b0a5ff"),
    "lagrange": ("#bf5400", "#ff9a52"),
    "dolfinx": ("#00805e", "#3dd1a5"),
    "beam": ("#b0478f", "#ee9ad2"),
    "lefm": ("#6b7280", "#a0a9b5"),
    "phase-mesh": ("#b9c4d0", "#566373"),
    "phase-basis": ("#8fa3b8", "#7a8da3"),
    "phase-assembly": ("#3f6f9f", "#79aee0"),
    "phase-factor": ("#d9a441", "#e8bd6a"),
    "phase-solve": ("#a3672b", "#c88b4f"),
    "phase-other": ("#dfe3e8", "#3d4652"),
}

_STAND_IN = {name: f"#0a0b{i + 1:02x}" for i, name in enumerate(PALETTE)}

METHODS = ("dolfinx", "nurbs", "tspline", "lagrange", "beam", "lefm")
METHOD_NAMES = {
    "nurbs": "NURBS",
    "tspline": "T-spline",
    "lagrange": "Lagrange",
    "dolfinx": "DOLFINx",
    "beam": "cohesive beam",
    "lefm": "LEFM limit",
}
PHASES = ("mesh", "basis", "assembly", "factor", "solve", "other")

#: Width of a figure in inches; every figure is drawn at the size that makes 8 pt text readable where it is shown.
THIRD, HALF, WIDE = 3.3, 4.6, 9.4

# A stress near zero is transparent: it takes the page's own colour, light or dark.
STRESS_MAP = LinearSegmentedColormap.from_list(
    "stress",
    [(0.0, "#1668b8ff"), (0.25, "#3b8ad6b0"), (0.5, "#8a929c18"), (0.75, "#e5742fb0"), (1.0, "#c8480cff")],
)

_RC = {
    "font.family": "sans-serif",
    "font.sans-serif": ["DejaVu Sans"],
    "font.size": 8.0,
    "axes.titlesize": 8.0,
    "axes.titleweight": "normal",
    "axes.titlelocation": "left",
    "axes.labelsize": 8.0,
    "axes.linewidth": 0.6,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "axes.axisbelow": True,
    "axes.formatter.useoffset": False,
    "axes.formatter.limits": (-3, 5),
    "axes.unicode_minus": True,
    "grid.linewidth": 0.5,
    "xtick.labelsize": 7.5,
    "ytick.labelsize": 7.5,
    "xtick.major.width": 0.6,
    "ytick.major.width": 0.6,
    "xtick.major.size": 3.0,
    "ytick.major.size": 3.0,
    "legend.frameon": False,
    "legend.fontsize": 7.5,
    "svg.fonttype": "none",
    "svg.hashsalt": "debond",
    "path.simplify": True,
    "figure.facecolor": "none",
    "axes.facecolor": "none",
    "savefig.facecolor": "none",
    "mathtext.fontset": "dejavusans",
    "text.parse_math": False,  # units are the user's own text
}


@dataclass(frozen=True)
class Panel:
    """One figure of the page."""

    svg: str
    caption: str
    size: str = "half"  # wide, half or third of the page


@dataclass(frozen=True)
class Line:
    """How one run is drawn, the same in every figure."""

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


_BASE_LINES = {
    "dolfinx": Line("dolfinx", 3.4, (), 0.5, 2.0),
    "nurbs": Line("nurbs", 1.2, (), 1.0, 4.0),
    "tspline": Line("tspline", 1.2, (), 1.0, 4.2),
    "lagrange": Line("lagrange", 1.1, (5.0, 2.0), 1.0, 3.8),
    "beam": Line("beam", 1.5, (1.2, 1.8), 1.0, 4.5),
    "lefm": Line("lefm", 0.8, (4.0, 3.0), 1.0, 1.5),
}


#: Of methods of other packages and of other codes.
OTHERS = Line("ink", 1.3, (6.0, 1.5, 1.2, 1.5), 1.0, 4.7)


def line(method: str, repeat: int = 0) -> Line:
    """Style of the ``repeat``-th run of a method: further runs of the same method get thinner and fainter."""
    base = _BASE_LINES.get(method, OTHERS)
    fade = 0.6**repeat
    width, alpha = max(base.width * fade, 0.6), base.alpha * max(fade, 0.4)
    return Line(base.colour, width, base.dashes, alpha, base.order - 0.1 * repeat)


def colour(name: str) -> str:
    """The stand-in for a palette colour, to be used in figures."""
    return _STAND_IN[name]


def custom_properties(dark: bool) -> str:
    """CSS declarations of the palette."""
    return " ".join(f"--{name}: {pair[int(dark)]};" for name, pair in PALETTE.items())


@contextmanager
def drawing() -> Iterator[None]:
    """The figure settings of the report, for the block."""
    inks = {key: colour("muted") for key in ("axes.edgecolor", "xtick.color", "ytick.color", "hatch.color")}
    inks |= {key: colour("ink") for key in ("text.color", "axes.labelcolor", "lines.color", "patch.edgecolor")}
    with matplotlib.rc_context({**_RC, **inks, "grid.color": colour("rule")}):
        yield


def panel(width: float, height: float, left: float = 0.57, top: float = 0.17) -> tuple[Figure, Axes]:
    """A figure of one pair of axes with fixed margins, so that panels line up (lengths in inches)."""
    figure, bottom = Figure(figsize=(width, height)), 0.43
    place = (left / width, bottom / height, 1 - (left + 0.1) / width, 1 - (bottom + top) / height)
    return figure, figure.add_axes(place)


def to_svg(figure: Figure, key: str, title: str, dpi: float = 180.0) -> str:
    """The figure as an inline SVG element that follows the colours and the font of the page.

    Parameters
    ----------
    key : unique in the page; ids inside the SVG carry it, as all figures share one document.
    title : read out by screen readers in place of the drawing.
    """
    buffer = io.StringIO()
    figure.savefig(buffer, format="svg", dpi=dpi, transparent=True, metadata={"Date": None, "Creator": None})
    return _adapt(buffer.getvalue(), key, title)


def _adapt(svg: str, key: str, title: str) -> str:
    svg = svg[svg.index("<svg") :]
    svg = re.sub(r"<metadata>.*?</metadata>\s*", "", svg, flags=re.DOTALL)
    for name, stand_in in _STAND_IN.items():
        svg = svg.replace(stand_in, f"var(--{name})")
    svg = re.sub(r"font-family: [^;\"]*", "font-family: inherit", svg)
    svg = re.sub(r"font: ((?:[a-z0-9.]+ )*?)([\d.]+)px [^;\"]*", r"font-size: \2px", svg)
    svg = svg.replace("*{stroke-linejoin: round; stroke-linecap: butt}", "")
    svg = re.sub(r' d="[^"]*"|<use [^>]*>', _short_numbers, svg)
    svg = re.sub(r">\s+<", "><", svg)
    svg = re.sub(r' transform="rotate\(-?0 [-\d. ]+\)"', "", svg)
    svg = re.sub(r'<use [^>]*style="([^"]*)"/>(?:<use [^>]*style="\1"/>)+', _shared_style, svg)
    svg = re.sub(r"(?<=data:image/png;base64,)[^\"]*", _few_colours, svg)
    svg = _private_ids(svg, key)
    svg = _classes(_without_empty_groups(svg))
    width, height = re.search(r'viewBox="0 0 ([\d.]+) ([\d.]+)"', svg).groups()
    head = (
        f'<svg class="plot" role="img" aria-labelledby="{key}-t" viewBox="0 0 {width} {height}" '
        f'preserveAspectRatio="xMidYMid meet"><title id="{key}-t">{escape(title)}</title>'
    )
    return head + svg[svg.index(">") + 1 :]


def _short_numbers(match: re.Match[str]) -> str:
    """Coordinates to a hundredth of a point: a quarter of the page would be digits that nobody sees."""
    text = re.sub(r"\s+", " ", re.sub(r"(\.\d\d)\d+", r"\1", match[0]))
    return re.sub(r"M [-\d.]+ [-\d.]+(?: L [-\d.]+ [-\d.]+)+", _steps, text)


def _steps(match: re.Match[str]) -> str:
    """Straight pieces by the steps from point to point, to a tenth of a point; rounding does not add up."""
    at = [round(10 * float(value)) for value in re.findall(r"-?[\d.]+", match[0])]
    if max(map(abs, at)) < 100:  # a marker: its shape would suffer
        return match[0]
    steps = [value - before for before, value in zip(at, at[2:], strict=False)]
    return f"M{at[0] / 10:g} {at[1] / 10:g}l" + " ".join(f"{step / 10:g}" for step in steps)


def _shared_style(match: re.Match[str]) -> str:
    """Markers of one curve: their style once for all of them."""
    style = f' style="{match[1]}"'
    return f"<g{style}>{match[0].replace(style, '')}</g>"


def _without_empty_groups(svg: str) -> str:
    """Groups that say nothing, of which every tick is in three, are left out with what closes them."""
    says: list[bool] = []

    def kept(match: re.Match[str]) -> str:
        if match[0] != "</g>":
            says.append(match[0] != "<g>")
        keep = says.pop() if match[0] == "</g>" else says[-1]
        return match[0] if keep else ""

    return re.sub(r"<g>|<g [^>]*[^/]>|</g>", kept, svg.replace("<g/>", ""))


def _classes(svg: str) -> str:
    """Styles that come more than once as classes, named by what they say: the same in all figures of a page.

    Two names in front of a rule let it win over that of the page for all paths, as a style would.
    """
    often = [style for style, count in Counter(re.findall(r' style="([^"]*)"', svg)).items() if count > 1]
    names = {style: f"s{crc32(style.encode()):x}" for style in often}
    rules = "".join(f".plot .{name}{{{style}}}" for style, name in names.items())

    def named(match: re.Match[str]) -> str:
        return f' class="{names[match[1]]}"' if match[1] in names else match[0]

    svg = re.sub(r' style="([^"]*)"', named, svg)
    return svg.replace('<style type="text/css"></style>', f"<style>{rules}</style>", 1)


def _few_colours(match: re.Match[str]) -> str:
    """An image whose colours fit into a palette with that palette: the same pixels in half the bytes."""
    with Image.open(io.BytesIO(base64.b64decode(match[0]))) as image:
        pixels = np.asarray(image.convert("RGBA"))
    pixels = np.where(pixels[..., 3:] > 0, pixels, 0)  # what is not seen has one colour
    colours, number = np.unique(pixels.reshape(-1, 4), axis=0, return_inverse=True)
    if len(colours) > 256:
        return match[0]
    small, buffer = Image.fromarray(number.reshape(pixels.shape[:2]).astype(np.uint8), "P"), io.BytesIO()
    small.putpalette(colours[:, :3].tobytes())
    small.save(buffer, "PNG", optimize=True, transparency=colours[:, 3].tobytes())
    text = base64.b64encode(buffer.getvalue()).decode()
    return min(text, match[0], key=len)


def _private_ids(svg: str, key: str) -> str:
    """Drop the ids that nothing refers to, and make the others unique in the page."""
    used = dict.fromkeys(re.findall(r'(?:url\(#|href="#)([^)"]+)', svg))
    short = {name: f"p{crc32(key.encode()):x}-{i}" for i, name in enumerate(used)}  # hundreds of markers repeat them

    def rename(match: re.Match[str]) -> str:
        return f' id="{short[match[1]]}"' if match[1] in used else ""

    svg = re.sub(r' id="([^"]*)"', rename, svg)
    svg = re.sub(r"url\(#([^)]+)\)", lambda match: f"url(#{short[match[1]]})", svg)
    return re.sub(r'(?:xlink:)?href="#([^"]+)"', lambda match: f'href="#{short[match[1]]}"', svg)
