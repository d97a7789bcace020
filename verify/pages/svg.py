"""SVG of matplotlib as a part of the page: nothing in it that is not seen, and what is seen in few bytes.

Numbers are rounded to what can be seen, lines go by steps, the markers of a series are one path, a page says a style
once.
"""

from __future__ import annotations

import base64
import io
import re
import struct
from collections import Counter
from collections.abc import Iterable
from html import escape
from zlib import compress, crc32

import numpy as np
from PIL import Image

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
    svg = re.sub(r"(?<=data:image/png;base64,)[^\"]*", _few_colours, svg)
    svg = _private_ids(svg, key)
    svg = _without_empty_groups(svg)
    width, height = _VIEW.findall(svg)[0]
    head = (
        f'<svg class="plot" role="img" aria-labelledby="{key}-t" viewBox="0 0 {width} {height}" '
        f'preserveAspectRatio="xMidYMid meet"><title id="{key}-t">{escape(title)}</title>'
    )
    return head + svg[svg.index(">") + 1 :]


def short_numbers(match: re.Match[str]) -> str:
    """Coordinates to a hundredth of a point, and lines to a tenth, by steps: the rest are digits that nobody sees."""
    text = re.sub(r"\s+", " ", re.sub(r"(\.\d\d)\d+", r"\1", match[0]))
    data = text.removeprefix(' d="').removesuffix('"').strip()
    if not data or text == data or _TRIPLE.sub("", data).strip():  # no path data, or curves
        return text
    if max(abs(float(number)) for number in re.findall(r"-?[\d.]+", data)) < 10:  # a marker: its shape would suffer
        return text
    return f' d="{_by_steps(data)}"'


def _by_steps(data: str) -> str:
    """Straight path data by the steps from point to point, to a tenth of a point; rounding does not add up."""
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
    return _written(_merged(steps), 10)


def _merged(steps: Iterable[tuple[str, int, int]]) -> list[tuple[str, int, int]]:
    """Without steps to the same place, and with those that go on along an axis as one."""
    kept: list[tuple[str, int, int]] = []
    for letter, dx, dy in steps:
        before, bx, by = kept[-1] if kept else ("", 0, 0)
        along = before == letter == "L" and (bx == dx == 0 and by * dy >= 0 or by == dy == 0 and bx * dx >= 0)
        if along:
            kept[-1] = ("L", bx + dx, by + dy)
        elif letter != "L" or dx or dy or before == "M":  # a line of no length is a dot
            kept.append((letter, dx, dy))
    return kept


def _written(steps: Iterable[tuple[str, int, int]], unit: int) -> str:
    """Path data of relative steps, M, L and z, in parts of a point: ``unit`` of them are a point."""
    text, before = [], ""
    for letter, dx, dy in steps:
        x, y = (re.sub(r"^(-?)0\.", r"\1.", f"{value / unit:g}") for value in (dx, dy))
        line = {"M": "m", "z": "z"}.get(letter, "h" if dy == 0 else "v" if dx == 0 else "l")
        numbers = {"h": x, "v": y, "z": ""}.get(line, f"{x} {y}")
        text.append(f" {numbers}" if before == line == "l" else line + numbers)
        before = line
    return re.sub(r" (?=-)|(?<=\.\d) (?=\.)|(?<=\.\d\d) (?=\.)", "", "".join(text))


def _with_joined_markers(svg: str) -> str:
    """The markers of one series as one path, where they are of one colour; what defined them goes with the last."""
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
    """A shape in its style at these tenths of a point; empty where one path would look different."""
    fill, stroke = style.get("fill", "black"), style.get("stroke", "none")
    if len({fill, stroke} - {"none"}) > 1:  # edges of those below would be seen on those above
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
    said = "; ".join(f"{name}: {value}" for name, value in style.items())
    return f'<path d="{data}" style="{said}"/>'


def _points(data: str) -> list[tuple[str, str, str]]:
    return [(letter or "z", x, y) for letter, x, y in _TRIPLE.findall(data)]


def _repeated(outline: list[tuple[str, int, int]], at: list[tuple[int, int]]) -> list[tuple[str, int, int]]:
    """Relative steps of an outline, given by points about the origin, at several places."""
    pen = start = (0, 0)
    steps = []
    for x0, y0 in at:
        for letter, x, y in outline:
            point = start if letter == "z" else (x0 + x, y0 + y)
            steps.append((letter, point[0] - pen[0], point[1] - pen[1]))
            pen, start = point, point if letter == "M" else start
    return steps


def _radius(shape: str) -> float:
    """Of a disc about the origin that is drawn by curves; 0 where the shape is none."""
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
    """Groups that say nothing, of which every tick is in three, are left out with what closes them."""
    says: list[bool] = []

    def kept(match: re.Match[str]) -> str:
        if match[0] != "</g>":
            says.append(match[0] != "<g>")
        keep = says.pop() if match[0] == "</g>" else says[-1]
        return match[0] if keep else ""

    return re.sub(r"<g>|<g [^>]*[^/]>|</g>", kept, svg.replace("<g/>", ""))


def with_classes(page: str) -> str:
    """Styles that come more than once in the figures of a page as classes, whose rules end its style sheet.

    The head is read by every browser; a figure may stand in ``<noscript>``, which is read without scripts alone.
    Two names in front of a rule let it win over that of the page for all paths, as a style would.

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


def _few_colours(match: re.Match[str]) -> str:
    """An image whose colours fit into a palette with that palette: the same pixels in a third of the bytes."""
    with Image.open(io.BytesIO(base64.b64decode(match[0]))) as image:
        pixels = np.asarray(image.convert("RGBA"))
    pixels = np.ascontiguousarray(np.where(pixels[..., 3:] > 0, pixels, 0))  # what is not seen has one colour
    colours, number = np.unique(pixels.view(np.uint32), return_inverse=True)
    if len(colours) > 256:
        return match[0]
    palette = colours.view(np.uint8).reshape(-1, 4)
    order = np.argsort(palette[:, 0].astype(int) - palette[:, 2], kind="stable")  # as a map goes from blue to red
    text = base64.b64encode(_png(np.argsort(order)[number].reshape(pixels.shape[:2]), palette[order])).decode()
    return min(text, match[0], key=len)


def _png(colour_yx: np.ndarray, palette: np.ndarray) -> bytes:
    """An image (PNG, ISO/IEC 15948) by what changes from pixel to pixel, its filter 1, which Pillow has for no palette.

    Parameters
    ----------
    colour_yx : rows of the palette (n <= 256, 4), red, green, blue, alpha
    """
    changes = np.diff(colour_yx.astype(np.uint8), axis=1, prepend=np.uint8(0))  # modulo 256
    rows = np.pad(changes, ((0, 0), (1, 0)), constant_values=1)
    height, width = colour_yx.shape
    chunks = {
        b"IHDR": struct.pack(">IIBBBBB", width, height, 8, 3, 0, 0, 0),
        b"PLTE": palette[:, :3].tobytes(),
        b"tRNS": palette[:, 3].tobytes(),
        b"IDAT": compress(rows.tobytes(), 9),
        b"IEND": b"",
    }
    made = (struct.pack(">I", len(d)) + name + d + struct.pack(">I", crc32(name + d)) for name, d in chunks.items())
    return b"\x89PNG\r\n\x1a\n" + b"".join(made)


def _private_ids(svg: str, key: str) -> str:
    """Drop the ids that nothing refers to, and make the others unique in the page."""
    used = dict.fromkeys(re.findall(r'(?:url\(#|href="#)([^)"]+)', svg))
    short = {name: f"p{crc32(key.encode()):x}-{i}" for i, name in enumerate(used)}  # hundreds of markers repeat them

    def rename(match: re.Match[str]) -> str:
        return f' id="{short[match[1]]}"' if match[1] in used else ""

    svg = re.sub(r' id="([^"]*)"', rename, svg)
    svg = re.sub(r"url\(#([^)]+)\)", lambda match: f"url(#{short[match[1]]})", svg)
    return re.sub(r'(?:xlink:)?href="#([^"]+)"', lambda match: f'href="#{short[match[1]]}"', svg)
