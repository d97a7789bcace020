"""Curves and tables in notebooks: well-formed, to scale, in the colour of the text, and to be read in a browser."""

from __future__ import annotations

import re
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from browser import Browser, found

from verify.curves.compare import compare
from verify.result import Result
from verify.support.notebook import BELOW, BEYOND, HEIGHT, MARGIN_LEFT, WIDTH, Drawn, chart, table
from verify.verdict import Check, Checks

OPENING = np.linspace(0.0, 3.0, 61)
LOAD = OPENING / (0.1 + OPENING**2)
RESULT = Result("nurbs & <more>", {"opening": OPENING, "load": LOAD}, dofs=280)
COMPARISON = compare((OPENING, 1.03 * LOAD), (OPENING, LOAD), names=("mine", "nurbs"))
CHECKS = Checks(
    (
        Check("energy-ledger", "nurbs", 1e-4, 5e-3, "exact", "Nothing is lost."),
        Check("j-integral", "nurbs", 0.1, 1e-2, "exact", "J is the area.", unresolved="the mesh is too coarse"),
    )
)


def lines(svg: str) -> list[np.ndarray]:
    """Points (n, 2) of every curve."""
    return [np.array(one.replace(",", " ").split(), float).reshape(-1, 2) for one in re.findall(r'points="(.*?)"', svg)]


def test_a_chart_is_to_scale_from_the_origin() -> None:
    (points,) = lines(chart([Drawn("a", OPENING, LOAD)]))
    x = MARGIN_LEFT + OPENING / 3.0 * (WIDTH - BEYOND - MARGIN_LEFT)
    y = HEIGHT - BELOW - LOAD / LOAD.max() * (HEIGHT - BELOW - 2 * BEYOND)
    assert np.allclose(points, np.stack([x, y], 1), atol=0.051)


@pytest.mark.parametrize("load", [np.zeros(3), np.array([0.0, np.nan, 1e-300]), -1e9 * np.ones(3), np.zeros(0)])
def test_any_curve_is_drawn(load: np.ndarray) -> None:
    svg = ElementTree.fromstring(chart([Drawn("a", np.arange(load.size), load)]))
    marks = [one.text for one in svg.iter("text") if re.fullmatch(r"-?[\d.]+(e[-+]\d+)?", one.text or "")]
    assert 4 <= len(marks) <= 16 and "0" in marks


def test_results_are_well_formed_and_escaped_and_have_no_ink_of_their_own() -> None:
    for shown in (RESULT, COMPARISON, CHECKS):
        text = shown._repr_html_()
        ElementTree.fromstring(f"<div>{text}</div>")
        assert set(re.findall(r'(?:fill|stroke)="(.*?)"', text)) <= {"none", "currentColor", "#2b82d9"}
        assert "<script" not in text and "<style" not in text
    assert "nurbs &amp; &lt;more&gt;, 280 unknowns, 61 points, peak load" in RESULT._repr_html_()
    assert ">+3 %<" in COMPARISON._repr_html_() and ">mine against nurbs<" in COMPARISON._repr_html_()
    assert "the mesh is too coarse" in CHECKS._repr_html_() and "Nothing is lost." in CHECKS._repr_html_()
    assert table(("a",), [("<b>",)]).count("&lt;b&gt;") == 1
    empty = Result("beam", {"opening": OPENING[:0], "load": LOAD[:0]})
    assert repr(RESULT).startswith("<Result: nurbs") and repr(empty) == "<Result: beam, no point, complete>"


@pytest.mark.skipif(found() is None, reason="there is no Chromium")
def test_charts_are_read_on_light_and_dark(tmp_path: Path) -> None:
    page = tmp_path / "cells.html"
    body = "".join(f"<div>{shown._repr_html_()}</div>" for shown in (RESULT, COMPARISON, CHECKS))
    dark = "@media (prefers-color-scheme: dark) { body { color: #ddd; background: #111 } }"
    style = f"body {{ color: #222; background: #fff }} {dark}"
    page.write_text(f"<!DOCTYPE html><meta charset='utf-8'><style>{style}</style><body>{body}</body>")
    with Browser(found(), tmp_path / "profile") as browser:
        for scheme, ink in (("light", "rgb(34, 34, 34)"), ("dark", "rgb(221, 221, 221)")):
            browser.media(scheme=scheme)
            browser.open(page)
            fills = "[...new Set([...document.querySelectorAll('svg text')].map((t) => getComputedStyle(t).fill))]"
            assert browser.ask(fills) == [ink] and browser.complaints == []
            outside = """[...document.querySelectorAll('svg text, svg polyline')].filter((one) => {
                const a = one.getBoundingClientRect(), b = one.closest('svg').getBoundingClientRect()
                return a.left < b.left || a.right > b.right || a.top < b.top || a.bottom > b.bottom
            }).map((one) => one.textContent || 'curve')"""
            assert browser.ask(outside) == []
            browser.picture(tmp_path / f"{scheme}.png")
