"""The SVG of matplotlib as a part of a page: in its font, without what is not drawn, in few bytes."""

from __future__ import annotations

import re
from html import escape

#: What is replaced, in this order: pattern and replacement.
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


def adapted(svg: str, key: str, title: str) -> str:
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
