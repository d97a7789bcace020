"""Figures as SVG: less in them than matplotlib wrote, and the same to be seen."""

from __future__ import annotations

import base64
import io
import re

import numpy as np
import pytest

pytest.importorskip("matplotlib")

from matplotlib.axes import Axes  # noqa: E402
from matplotlib.figure import Figure  # noqa: E402
from PIL import Image  # noqa: E402

from verify.pages.style import STRESS_MAP, to_svg  # noqa: E402
from verify.pages.svg import _radius, short_numbers, with_classes  # noqa: E402

#: Colours and limits of figures, of which one colour comes once.
LOOKS = (("#123456", (0.0, 1.0)), ("#123456", (0.0, 1.1)), ("#abcdef", (0.0, 1.2)))

NUMBER = re.compile(r"-?(?:\d+\.?\d*|\.\d+)")


def points(data: str) -> list[np.ndarray]:
    """Points (n, 2) of every part of a path of relative m, l, h, v and z."""
    pen, parts = np.zeros(2), []
    for letter, text in re.findall(r"([mlhvz])([^a-z]*)", data):
        numbers = [float(value) for value in NUMBER.findall(text)]
        steps = {"h": [(x, 0) for x in numbers], "v": [(0, y) for y in numbers], "z": [(0, 0)]}.get(letter)
        for step in np.reshape(numbers, (-1, 2)) if steps is None else steps:
            pen = parts[-1][0] if letter == "z" else pen + step
            if letter == "m":
                parts.append([])
            parts[-1].append(pen)
    return [np.array(part) for part in parts]


def drawn(*series: dict, limits: tuple[float, float] = (0.0, 1.0)) -> tuple[str, list[np.ndarray]]:
    """Series of markers as SVG, and where each of their points is in it."""
    figure = Figure(figsize=(4.0, 2.0))
    axes: Axes = figure.add_axes((0.1, 0.2, 0.8, 0.7))
    axes.set_axis_off()
    x, places = np.linspace(0.1, 0.9, 30), []
    for i, options in enumerate(series):
        axes.plot(x, x**2 + 0.01 * i, linestyle="none", **options)
    axes.set(xlim=limits, ylim=limits)
    svg = to_svg(figure, "key", "title")
    for i in range(len(series)):
        at = axes.transData.transform(np.column_stack([x, x**2 + 0.01 * i])) * 72 / figure.dpi
        places.append(at * [1, -1] + [0, 144.0])
    return svg, places


def paths(svg: str) -> list[list[np.ndarray]]:
    return [points(data) for data in re.findall(r'<path d="([^"]*)"', svg)]


def test_steps_of_a_drawn_line_add_up_to_its_points() -> None:
    """Path data of a figure, by the steps between points, are where matplotlib had put them, to a tenth of a point."""
    at = np.column_stack([np.linspace(20, 300, 400), 80 + 60 * np.sin(np.linspace(0, 9, 400))])
    data = "M " + " L ".join(f"{x:.6f} {y:.6f}" for x, y in at)
    text = short_numbers(re.match(r' d="[^"]*"', f' d="{data}"'))
    (found,) = points(text)
    assert len(found) > 390 and np.abs(found[[0, -1]] - at[[0, -1]]).max() < 0.051
    assert np.abs(np.interp(at[:, 0], *found.T) - at[:, 1]).max() < 0.2 and len(text) < 0.4 * len(data)
    marker = ' d="M -1.5 1.25 L 1.5 1.25 L 0.25 -1.5 z"'
    for kept in (marker, ' d=""'):
        assert short_numbers(re.match(r' d="[^"]*"', kept)) == kept


def test_closed_and_straight_parts_of_a_path_stay_where_they_are() -> None:
    """After z the next part counts from where the closed one began; steps along an axis are short."""
    text = ' d="M 20 30 L 30 30 L 40 30 L 40 50 L 40 45 z M 25 31 L 25.04 31 M 60.5 70 L 60.5 70.4 L 61.8 70.4 "'
    short = short_numbers(re.match(r' d="[^"]*"', text))
    box, dot, corner = points(short)
    assert box.tolist() == [[20, 30], [30, 30], [40, 30], [40, 50], [40, 45], [20, 30]]
    assert np.allclose(dot, [[25, 31], [25, 31]]) and np.allclose(corner, [[60.5, 70], [60.5, 70.4], [61.8, 70.4]])
    assert short == ' d="m20 30h10h10v20v-5zm5 1h0m35.5 39v.4h1.3"'


def test_dots_of_a_series_are_one_path_with_round_ends() -> None:
    svg, (at,) = drawn({"marker": ".", "markersize": 4.0, "color": "#123456", "alpha": 0.5})
    (dots,) = paths(svg)
    assert "<use" not in svg and "<defs><path" not in svg and "stroke-linecap: round" in svg
    assert "stroke: #123456" in svg and "fill: none" in svg and "stroke-opacity: 0.5" in svg
    assert float(re.search(r"stroke-width: ([\d.]+)", svg)[1]) == pytest.approx(
        0.5 * 4.0 + 1.0, abs=0.01
    )  # and its edge
    assert all(np.array_equal(dot[0], dot[1]) and len(dot) == 2 for dot in dots)
    assert np.abs(np.array([dot[0] for dot in dots]) - at).max() < 0.061


def test_other_markers_of_a_series_are_one_path_with_their_outline() -> None:
    square = {"marker": "s", "markersize": 5.0, "markeredgewidth": 0.0, "color": "#123456"}
    svg, (squares, crosses) = drawn(square, {"marker": "x", "markersize": 4.0, "color": "#654321"})
    found = paths(svg)
    assert "<use" not in svg and len(found) == 2 and [len(one) for one in found] == [30, 60]
    centres = np.array([one[:4].mean(axis=0) for one in found[0]])
    assert np.abs(centres - squares).max() < 0.061
    assert all(np.allclose(np.ptp(one, axis=0), 5.0) and len(one) == 5 for one in found[0])
    for arm in (found[1][::2], found[1][1::2]):
        assert np.abs(np.array([one.mean(axis=0) for one in arm]) - crosses).max() < 0.061
        assert all(np.allclose(np.ptp(one, axis=0), 4.0) for one in arm)


def test_markers_with_edges_of_another_colour_stay_apart() -> None:
    svg, _ = drawn({"marker": "o", "color": "#123456", "markeredgecolor": "#ffffff"})
    assert svg.count("<use") == 30 and svg.count("<defs><path") == 1


def test_an_area_between_curves_stays_what_it_is() -> None:
    figure = Figure(figsize=(4.0, 2.0))
    axes = figure.add_axes((0.1, 0.2, 0.8, 0.7))
    axes.set_axis_off()
    axes.fill_between([0.0, 0.5, 1.0], [0.2, 0.1, 0.0], [0.3, 0.9, 1.0], color="#123456", linewidth=0)
    svg = to_svg(figure, "key", "title")
    assert len(re.findall(r'<path id="[^"]*" d="m', svg)) == svg.count("<use") == 1


def test_markers_that_are_out_of_sight_are_left_out() -> None:
    svg, _ = drawn({"marker": ".", "color": "#123456"}, limits=(0.0, 0.2))
    (dots,) = paths(svg)
    assert 4 <= len(dots) < 15
    assert paths(drawn({"marker": ".", "color": "#123456"}, limits=(-9.0, -8.0))[0]) == []


def test_scattered_points_have_their_own_colours() -> None:
    figure = Figure(figsize=(4.0, 2.0))
    axes = figure.add_axes((0.1, 0.2, 0.8, 0.7))
    axes.set_axis_off()
    at, inks = np.linspace(0.0, 1.0, 30), 10 * ["#123456", "#abcdef", "#654321"]
    axes.scatter(at, at, s=9.0, color=inks)
    svg = to_svg(figure, "key", "title")
    assert re.findall("stroke: (#[0-9a-f]{6})", svg) == inks and "<use" not in svg
    assert [len(dots) for dots in paths(svg)] == 30 * [1]


def test_figures_say_nothing_in_vain_and_their_images_keep_every_pixel() -> None:
    """Groups that say nothing, rotations by nothing: gone. Images lose bytes and no colour."""
    values = np.random.default_rng(1).integers(0, 200, (60, 200)) / 199.0
    pixels = STRESS_MAP(values)
    pixels[:9, :, 3] = 0.0
    figure = Figure(figsize=(4.0, 2.0))
    axes = figure.add_axes((0.1, 0.2, 0.8, 0.7))
    axes.imshow(pixels, aspect="auto", interpolation="none")
    svg = to_svg(figure, "key", "title")
    assert "<g>" not in svg and "rotate(-0" not in svg
    assert 'fill: none"/>' not in svg and "<style" not in svg
    (data,) = re.findall(r"data:image/webp;base64,([^\"]*)", svg)
    with Image.open(io.BytesIO(base64.b64decode(data))) as image:
        found = np.asarray(image.convert("RGBA"))
    expected = np.round(255 * pixels).astype(int)
    seen = expected[..., 3] > 0
    assert found.shape == expected.shape and not found[~seen][:, 3].any()
    assert np.abs(found.astype(int) - expected)[seen].max() <= 1


def test_a_page_says_a_style_once() -> None:
    """As a class, whose rule is that style; what is no figure keeps its own."""
    figures = [drawn({"marker": "s", "color": colour}, limits=limits)[0].rstrip() for colour, limits in LOOKS]
    bar = '<b style="width: 3%"></b>'
    page = with_classes(f"<style>p {{}}\n</style>{bar}{bar}<p>{'</p><p>'.join(figures)}</p>")
    assert page.count(bar) == 2 and page.count("<style>") == 1
    plots = re.findall(r'<svg class="plot".*?</svg>', page, re.DOTALL)
    rules = dict(re.findall(r"[.]plot [.](s\d+)[{]([^}]*)[}]", page.partition("</style>")[0]))
    again = [re.sub(r' class="(s\d+)"', lambda m: f' style="{rules[m[1]]}"', plot) for plot in plots]
    assert again == figures
    styles = re.findall(r' style="([^"]*)"', "".join(plots))
    assert len(styles) == len(set(styles)) == 1 and "#abcdef" in styles[0] and rules
    assert with_classes(bar + bar) == bar + bar
    with pytest.raises(ValueError, match="style sheet"):
        with_classes("".join(figures))


def test_a_disc_is_what_curves_of_one_radius_enclose() -> None:
    disc = "M 0 -2 C 1.1 -2 2 -1.1 2 0 C 2 1.1 1.1 2 0 2 C -1.1 2 -2 1.1 -2 0 C -2 -1.1 -1.1 -2 0 -2 z"
    assert _radius(disc) == pytest.approx(2.0)
    assert _radius(disc.replace("C -2 -1.1 -1.1 -2 0 -2 ", "L 0 -2 ")) == 0.0, "a side is straight"
    assert _radius(disc.replace("2 0 C 2", "2.5 0 C 2")) == 0.0, "no disc"
    assert _radius("M 0 -2 C 1.1 -2 2 -1.1 2 z") == 0.0, "a curve has three points"


@pytest.mark.parametrize(("edge", "size"), [({"markeredgewidth": 0.0}, 4.0), ({"markeredgewidth": 1.5}, 5.5)])
def test_a_dot_is_as_large_as_its_disc_and_its_edge(edge: dict, size: float) -> None:
    svg, _ = drawn({"marker": "o", "markersize": 4.0, "color": "#123456", **edge})
    assert float(re.search(r"stroke-width: ([\d.]+)", svg)[1]) == pytest.approx(size, abs=0.02)
