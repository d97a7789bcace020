"""A drawing in a page: nothing that is read is lost, ids are its own, and it is small."""

from __future__ import annotations

import re

import numpy as np
import pytest

pytest.importorskip("matplotlib")

from verify.pages.style import HALF, STRESS_MAP, colour, drawing, panel, to_svg  # noqa: E402


def drawn(key: str) -> str:
    """Every kind of thing that pages draw."""
    x = np.linspace(0.0, 1.0, 500)
    with drawing():
        figure, axes = panel(HALF, 3.0)
        axes.plot(x, np.sin(40.0 * x), color=colour("nurbs"))
        axes.plot(x[::9], x[::9], "o-", color=colour("lagrange"), label="a <name> & more, 0.12345")
        axes.fill_between(x, x**2, x, color=colour("zone"), alpha=0.5)
        axes.scatter(x[::50], x[::50], c=x[::50])
        axes.imshow(np.linspace(0.0, 1.0, 25).reshape(5, 5), cmap=STRESS_MAP, extent=(0.2, 0.4, 0.2, 0.4), zorder=9)
        axes.set(xlim=(0.1, 0.8), xlabel="opening (mm)", ylabel="100.125")
        axes.legend()
        return to_svg(figure, key, "A & B")


def test_what_is_referred_to_is_there_and_belongs_to_one_figure():
    one, other = drawn("one"), drawn("other")
    ids = [re.findall(r'id="([^"]*)"', svg) for svg in (one, other)]
    used = set(re.findall(r'(?:url\(#|href="#)([^)"]+)', one))
    assert used <= set(ids[0]) and any(name in one for name in re.findall(r"<clipPath id=\"([^\"]*)", one))
    assert len({*ids[0], *ids[1]}) == len(ids[0]) + len(ids[1]), "all figures share one document"
    assert drawn("one") == one


def test_texts_keep_their_digits_and_lines_lose_what_is_invisible():
    svg = drawn("key")
    assert {"a &lt;name&gt; &amp; more, 0.12345", "100.125", "opening (mm)"} <= set(re.findall(">([^<]+)</text>", svg))
    assert '<title id="key-t">A &amp; B</title>' in svg and "DejaVu" not in svg
    assert not re.search(r' d="[^"]*\.\d{3}', svg) and len(svg) < 40_000


def test_styles_are_classes_of_the_figure_and_colours_are_those_of_the_page():
    svg = drawn("key")
    rules = dict(re.findall(r"#key \.(s\d+)\{([^}]*)\}", svg))
    assert set(re.findall(r'class="(s\d+)"', svg)) == set(rules) and ' style="' not in svg
    assert any("stroke: var(--nurbs)" in rule for rule in rules.values()) and "#0a0b" not in svg
