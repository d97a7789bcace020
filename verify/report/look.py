"""What the head of every page takes."""

from __future__ import annotations

from pathlib import Path

from markupsafe import Markup

from verify.report.style import custom_properties

_CSS = Path(__file__).with_name("page.css")


def look() -> dict[str, Markup]:
    """The palettes ``light`` and ``dark`` and the style sheet ``css``, by the names that the templates know."""
    return {
        "light": Markup(custom_properties(dark=False)),
        "dark": Markup(custom_properties(dark=True)),
        "css": Markup(_CSS.read_text(encoding="utf-8")),
    }
