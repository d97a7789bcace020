"""Pages from templates, in HTML or Markdown: texts are escaped, and undefined names are errors."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cache
from pathlib import Path

from jinja2 import ChoiceLoader, Environment, PackageLoader, StrictUndefined
from markupsafe import Markup

from verify.pages.style import custom_properties
from verify.pages.text import number, plain, symbols, tone

_CSS = Path(__file__).with_name("page.css")


def rendered(package: str, template: str, filters: Mapping[str, Callable], /, **content: object) -> str:
    """Render a template of a package.

    Parameters
    ----------
    filters : functions of the template, beside ``svg``, ``number``, ``symbols`` and ``tone``
    content : variables of the template, beside the palettes ``light`` and ``dark`` and the style sheet ``css``
    """
    jinja = _environment(package, template.endswith(".md.j2"))
    jinja.filters |= filters
    return jinja.get_template(template).render(
        light=Markup(custom_properties(dark=False)),
        dark=Markup(custom_properties(dark=True)),
        css=Markup(_CSS.read_text(encoding="utf-8")),
        **content,
    )


@cache
def _environment(package: str, markdown: bool) -> Environment:
    jinja = Environment(
        loader=ChoiceLoader([PackageLoader(package, "."), PackageLoader("verify", ".")]),  # parts of other pages
        autoescape=not markdown,
        finalize=_plain if markdown else None,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    # drawings are safe: `verify.pages` has escaped their texts
    jinja.filters |= {"svg": Markup, "number": number, "symbols": symbols, "tone": tone}
    return jinja


def _plain(value: object) -> object:
    """A text for Markdown, unless it is Markdown already."""
    return value if isinstance(value, Markup) else plain(value)
