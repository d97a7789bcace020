"""Curves and tables in notebooks: well-formed, to scale, in the colour of the text, and to be read in a browser."""

from __future__ import annotations

import re
from functools import cache
from xml.etree import ElementTree

import numpy as np
import pytest
from browser import Browser, found

import iga
from iga import tensor_grid, tspline_rectangle, with_line
from iga.notebook import BELOW, BEYOND, HEIGHT, MARGIN_LEFT, WIDTH, Drawn, chart, drawn, table
from verify.curves.compare import compare
from verify.methods.solve import solve
from verify.result import Result
from verify.scene.load import load_scene
from verify.support.refusal import NotRun
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


def test_a_chart_is_to_scale_from_the_origin():
    (points,) = lines(chart([Drawn("a", OPENING, LOAD)]))
    x = MARGIN_LEFT + OPENING / 3.0 * (WIDTH - BEYOND - MARGIN_LEFT)
    y = HEIGHT - BELOW - LOAD / LOAD.max() * (HEIGHT - BELOW - 2 * BEYOND)
    assert np.allclose(points, np.stack([x, y], 1), atol=0.051)


@pytest.mark.parametrize("load", [np.zeros(3), np.array([0.0, np.nan, 1e-300]), -1e9 * np.ones(3), np.zeros(0)])
def test_any_curve_is_drawn(load):
    svg = ElementTree.fromstring(chart([Drawn("a", np.arange(load.size), load)]))
    marks = [one.text for one in svg.iter("text") if re.fullmatch(r"-?[\d.]+(e[-+]\d+)?", one.text or "")]
    assert 4 <= len(marks) <= 16 and "0" in marks


def test_results_are_well_formed_and_escaped_and_have_no_ink_of_their_own():
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


@cache
def bodies() -> tuple[object, ...]:
    """A scene, both kinds of meshes, a solution and its fields."""
    along, across = np.linspace(0.0, 14.0, 9), np.array([0.0, 0.1, 0.2])
    grid = with_line(tensor_grid(along, across), "horizontal", 0.05, between=(3.5, 10.5))
    run = iga.solve(iga.Dcb(opening=0.2, dofs=200, steps=3, snapshot_openings=(0.2,), **BEAM))
    fields = solve(load_scene("dcb-czm1", ["load.opening=0.2", "discretization.dofs=200"]), "nurbs").snapshots[-1]
    return load_scene("adcb-czmtestkit-a"), grid, tspline_rectangle(grid), run, run.snapshots[0], fields


BEAM = dict(length=14.0, arm_thickness=0.2, precrack=4.0, E1=120e3, nu12=0.2, strength=4.0, toughness=0.1)


@pytest.mark.parametrize("number", range(6))
def test_bodies_meshes_and_fields_are_drawn(number):
    text = bodies()[number]._repr_html_()
    ElementTree.fromstring(f"<div>{text}</div>")
    assert text.count("<polyline") == (3, 55, 4 * 24, 1, 4 * 28, 4 * 28)[number]
    assert set(re.findall(r'(?:fill|stroke)="(.*?)"', text)) <= {"none", "currentColor", "#2b82d9"}


def test_a_body_is_to_scale_and_a_flat_one_is_said_to_be_higher():
    square = [(0, 0), (2, 0), (2, 1), (0, 1), (0, 0)]
    (points,) = lines(drawn([square], "a plate"))
    assert np.ptp(points, axis=0) == pytest.approx([WIDTH - 2 * BEYOND, 0.5 * (WIDTH - 2 * BEYOND)], abs=0.11)
    assert "times as large" not in drawn([square], "a plate")
    assert "heights are drawn 7.5 times as large" in drawn([[(0, 0), (50, 1)]], "a strip")


def test_unequal_arms_have_their_own_thickness():
    scene = load_scene("adcb-czmtestkit-a", ["specimen.arm_thickness=[1.0, 3.0]"])
    upper, lower, bond = lines(scene._repr_html_())[0], lines(scene._repr_html_())[1], lines(scene._repr_html_())[2]
    assert np.ptp(lower[:, 1]) == pytest.approx(3.0 * np.ptp(upper[:, 1]), rel=0.01)
    assert np.ptp(bond[:, 1]) == 0.0 and bond[0, 1] == upper[0, 1]


def test_an_unknown_method_is_told_with_the_nearest():
    with pytest.raises(NotRun, match=r'there is no method tsplines; did you mean "tspline"\?'):
        solve("dcb-czm1", "tsplines")


@pytest.mark.skipif(found() is None, reason="there is no Chromium")
def test_charts_are_read_on_light_and_dark(tmp_path):
    page = tmp_path / "cells.html"
    body = "".join(f"<div>{shown._repr_html_()}</div>" for shown in (RESULT, COMPARISON, CHECKS, *bodies()))
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
