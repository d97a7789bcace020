"""SVG of matplotlib reduced for a page: without invisible parts, in few bytes.

Numbers are rounded to visible digits, paths use relative steps, the markers of a series are one path, images are
lossless WebP, and a style that occurs twice becomes a class.
"""

from __future__ import annotations

import base64
import io
import re
from collections import Counter
from collections.abc import Iterable
from html import escape
from zlib import crc32

import numpy as np
from PIL import Image, features

_TRIPLE = re.compile(r"([ML]) (\S+) (\S+)|z")
_USES = re.compile(
    r'<use xlink:href="#([^"]*)" x="[^"]*" y="[^"]*"( style="[^"]*")/>(?:<use xlink:href="#\1"[^>]*\2/>)*'
)
_VIEW = re.compile(r'viewBox="0 0 ([\d.]+) ([\d.]+)"')
_STYLE = re.compile(r' style="([^"]*)"')
_LARGEST = 20.0  # half a marker, in points


def adapted(svg: str, key: str, title: str) -> str:
    """The SVG element alone, in the font of the page; its ids carry ``key``, its title is ``title``."""
    svg = svg[svg.index("<svg") :]
    svg = re.sub(r"<metadata>.*?</metadata>\s*", "", svg, flags=re.DOTALL)
    svg = re.sub(r"font-family: [^;\"]*", "font-family: inherit", svg)
    svg = re.sub(r"font: ((?:[a-z0-9.]+ )*?)([\d.]+)px [^;\"]*", r"font-size: \2px", svg)
    svg = re.sub(r"<defs>\s*<style.*?</style>\s*</defs>", "", svg, flags=re.DOTALL)  # as the page says of all paths
    svg = re.sub(r' d="[^"]*"|<(?:use|text) [^>]*>', short_numbers, svg)
    svg = re.sub(r">\s+<", "><", svg)
    svg = re.sub(r' transform="rotate\(-?0 [-\d. ]+\)"', "", svg)
    svg = re.sub(r'<path d="[^"]*" style="fill: none"/>', "", svg)  # neither filled nor stroked
    svg = _with_joined_markers(svg)
    svg = re.sub(r"data:image/png;base64,([^\"]*)", _as_webp, svg)
    svg = _private_ids(svg, key)
    svg = _without_empty_groups(svg)
    width, height = _VIEW.findall(svg)[0]
    head = (
        f'<svg class="plot" role="img" aria-labelledby="{key}-t" viewBox="0 0 {width} {height}" '
        f'preserveAspectRatio="xMidYMid meet"><title id="{key}-t">{escape(title)}</title>'
    )
    return head + svg[svg.index(">") + 1 :]


def short_numbers(match: re.Match[str]) -> str:
    """Coordinates to a hundredth of a point, and lines to a tenth, by relative steps: further digits are invisible."""
    text = re.sub(r"\s+", " ", re.sub(r"(\.\d\d)\d+", r"\1", match[0]))
    data = text.removeprefix(' d="').removesuffix('"').strip()
    if not data or text == data or _TRIPLE.sub("", data).strip():  # no path data, or curves
        return text
    if max(abs(float(number)) for number in re.findall(r"-?[\d.]+", data)) < 10:  # a marker: its shape would suffer
        return text
    return f' d="{_by_steps(data)}"'


def _by_steps(data: str) -> str:
    """Straight path data as relative steps in tenths of a point, without accumulation of rounding errors."""
    pen = start = (0, 0)
    steps: list[tuple[str, int, int]] = []
    for letter, *point in _TRIPLE.findall(data):
        if not letter:
            steps.append(("z", 0, 0))
            pen = start
            continue
        x, y = (round(10 * float(value)) for value in point)
        steps.append((letter, x - pen[0], y - pen[1]))
        pen = x, y
        start = pen if letter == "M" else start
    return _written(steps, 10)


def _written(steps: Iterable[tuple[str, int, int]], unit: int) -> str:
    """Path data of relative steps M, L and z, whose numbers are in 1 / ``unit`` of a point."""
    text, before = [], ""
    for letter, dx, dy in steps:
        x, y = (re.sub(r"^(-?)0\.", r"\1.", f"{value / unit:g}") for value in (dx, dy))
        line = {"M": "m", "z": "z"}.get(letter, "h" if dy == 0 else "v" if dx == 0 else "l")
        numbers = {"h": x, "v": y, "z": ""}.get(line, f"{x} {y}")
        text.append(f" {numbers}" if before == line == "l" else line + numbers)
        before = line
    return re.sub(r" (?=-)|(?<=\.\d) (?=\.)|(?<=\.\d\d) (?=\.)", "", "".join(text))


def _with_joined_markers(svg: str) -> str:
    """Replace the markers of a series by one path where they have one colour; unused definitions are removed."""
    shapes = {name: rest for name, *rest in re.findall(r'<path id="([^"]*)" d="([^"]*)"(?: style="([^"]*)")?/>', svg)}
    most = np.array(_VIEW.findall(svg)[0], float)

    def joined(match: re.Match[str]) -> str:
        at = np.array(re.findall(r' x="([^"]*)" y="([^"]*)"', match[0]), float)
        seen = np.all((at > -_LARGEST) & (at < most + _LARGEST), axis=1)
        if match[1] not in shapes or not seen.any():
            return match[0] if seen.any() else ""
        shape, own = shapes[match[1]]
        style = _declared(match[2].removeprefix(' style="').removesuffix('"')) | _declared(own)
        return _series(shape, style, [(x, y) for x, y in np.rint(10 * at[seen]).astype(int).tolist()]) or match[0]

    svg = _USES.sub(joined, svg)
    used = set(re.findall(r'href="#([^"]*)"', svg))

    def needed(match: re.Match[str]) -> str:
        return match[0] if match[1] in used else ""

    return re.sub(r'<path id="([^"]*)"[^>]*/>', needed, svg).replace("<defs></defs>", "")


def _series(shape: str, style: dict[str, str], at: list[tuple[int, int]]) -> str:
    """A shape at positions in tenths of a point as one path; empty where that would look different."""
    fill, stroke = style.get("fill", "black"), style.get("stroke", "none")
    if len({fill, stroke} - {"none"}) > 1:  # one path would show edges that upper markers hide
        return ""
    at = [point for point, before in zip(at, [None, *at], strict=False) if point != before]
    if not _TRIPLE.sub("", shape).strip():
        outline = [(letter, round(100 * float(x or 0)), round(100 * float(y or 0))) for letter, x, y in _points(shape)]
        data = _written(_repeated(outline, [(10 * x, 10 * y) for x, y in at]), 100)
    elif (radius := _radius(shape)) and fill != "none":
        width = 2 * radius + (float(style.get("stroke-width", 1)) if stroke != "none" else 0)
        faint = {"stroke-opacity": style["fill-opacity"]} if "fill-opacity" in style else {}
        others = {name: value for name, value in style.items() if name == "opacity"}
        style = {"fill": "none", "stroke": fill, "stroke-width": f"{width:.3g}", "stroke-linecap": "round"}
        style |= faint | others
        data = _written(_repeated([("M", 0, 0), ("L", 0, 0)], at), 10)
    else:
        return ""
    declarations = "; ".join(f"{name}: {value}" for name, value in style.items())
    return f'<path d="{data}" style="{declarations}"/>'


def _points(data: str) -> list[tuple[str, str, str]]:
    return [(letter or "z", x, y) for letter, x, y in _TRIPLE.findall(data)]


def _repeated(outline: list[tuple[str, int, int]], at: list[tuple[int, int]]) -> list[tuple[str, int, int]]:
    """Relative steps of an outline, given by points about the origin, at several positions."""
    pen = start = (0, 0)
    steps = []
    for x0, y0 in at:
        for letter, x, y in outline:
            point = start if letter == "z" else (x0 + x, y0 + y)
            steps.append((letter, point[0] - pen[0], point[1] - pen[1]))
            pen, start = point, point if letter == "M" else start
    return steps


def _radius(shape: str) -> float:
    """Radius of a disc about the origin given by curves; 0 for any other shape."""
    if set(re.findall("[A-Za-z]", shape)) != {"M", "C", "z"}:
        return 0.0
    numbers = [float(value) for value in re.findall(r"-?\d[\d.]*", shape)]
    if len(numbers) % 6 != 2:
        return 0.0
    curves = np.array(numbers[2:]).reshape(-1, 6)
    radii = np.hypot(np.append(curves[:, 4], numbers[0]), np.append(curves[:, 5], numbers[1]))
    return float(radii.mean()) if np.ptp(radii) < 0.03 + 0.02 * radii.max() else 0.0


def _declared(style: str) -> dict[str, str]:
    return dict(part.split(": ", 1) for part in style.split("; ") if part)


def _without_empty_groups(svg: str) -> str:
    """Remove groups without attributes; matplotlib wraps every tick in three of them."""
    has_attributes: list[bool] = []

    def kept(match: re.Match[str]) -> str:
        if match[0] != "</g>":
            has_attributes.append(match[0] != "<g>")
        keep = has_attributes.pop() if match[0] == "</g>" else has_attributes[-1]
        return match[0] if keep else ""

    return re.sub(r"<g>|<g [^>]*[^/]>|</g>", kept, svg.replace("<g/>", ""))


def with_classes(page: str) -> str:
    """Replace styles that occur more than once in the figures of a page by classes in its style sheet.

    The rules are in the head, as a browser with scripts ignores figures in ``<noscript>``. With two class names a rule
    overrides that of the page for all paths, as a style attribute would.

    Raises
    ------
    ValueError : the page has no style sheet
    """
    figures = r'<svg class="plot".*?</svg>'
    styles = Counter(style for one in re.findall(figures, page, re.DOTALL) for style in _STYLE.findall(one))
    often = [style for style, count in styles.most_common() if count > 1]
    if not often:
        return page
    names = {style: f"s{i}" for i, style in enumerate(often)}
    rules = "".join(f".plot .{name}{{{style}}}" for style, name in names.items())

    def named(match: re.Match[str]) -> str:
        return f' class="{names[match[1]]}"' if match[1] in names else match[0]

    page = re.sub(figures, lambda figure: _STYLE.sub(named, figure[0]), page, flags=re.DOTALL)
    head, end, rest = page.partition("</style>")
    if not end:
        raise ValueError("the page must have a style sheet for the classes of its figures, got none")
    return f"{head}{rules}\n{end}{rest}"


def _as_webp(match: re.Match[str]) -> str:
    """A PNG image as lossless WebP, which has the same pixels in fewer bytes."""
    if not features.check("webp"):
        return match[0]
    made = io.BytesIO()
    with Image.open(io.BytesIO(base64.b64decode(match[1]))) as image:
        image.save(made, "WEBP", lossless=True)
    return f"data:image/webp;base64,{base64.b64encode(made.getvalue()).decode()}"


def _private_ids(svg: str, key: str) -> str:
    """Remove unreferenced ids and make the others unique in the page."""
    used = dict.fromkeys(re.findall(r'(?:url\(#|href="#)([^)"]+)', svg))
    short = {
        name: f"p{crc32(key.encode()):x}-{i}" for i, name in enumerate(used)
    }  # short, as hundreds of markers repeat them

    def rename(match: re.Match[str]) -> str:
        return f' id="{short[match[1]]}"' if match[1] in used else ""

    svg = re.sub(r' id="([^"]*)"', rename, svg)
    svg = re.sub(r"url\(#([^)]+)\)", lambda match: f"url(#{short[match[1]]})", svg)
    return re.sub(r'(?:xlink:)?href="#([^"]+)"', lambda match: f'href="#{short[match[1]]}"', svg)
