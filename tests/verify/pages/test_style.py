"""How figures of the page look, whatever they show: colours, lines, axes, and texts that stay texts."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("matplotlib")

from figures import unreadable  # noqa: E402
from matplotlib.axes import Axes  # noqa: E402
from matplotlib.colors import to_rgb  # noqa: E402
from matplotlib.figure import Figure  # noqa: E402

from verify import report  # noqa: E402
from verify.pages.style import (
    HALF,
    IN_TABLES,
    METHOD_NAMES,
    PALETTE,
    PHASES,
    STRESS_MAP,
    colour,
    custom_properties,
    drawing,
    line,
    panel,
    sheet_of,
    to_svg,
)


def plotted(y: tuple[float, float] = (0.0, 1.0), **words: str) -> tuple[Figure, Axes]:
    """A line in a figure of the page."""
    figure, axes = panel(HALF, 2.5)
    axes.plot([0.0, 1.0], y, label="the line", **line("nurbs").options())
    axes.set(**{"xlabel": "opening", "ylabel": "load", **words})
    return figure, axes


def numbers(axes: Axes) -> list[str]:
    axes.figure.canvas.draw()
    assert axes.yaxis.get_offset_text().get_text() == "" or "e" in axes.yaxis.get_offset_text().get_text()
    return [text.get_text() for text in axes.get_yticklabels()]


def luminance(code: str) -> float:
    """Relative, of WCAG 2.1."""
    parts = (c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in to_rgb(code))
    return sum(weight * part for weight, part in zip((0.2126, 0.7152, 0.0722), parts, strict=True))


@pytest.mark.parametrize("dark", [0, 1])
def test_words_in_any_ink_stand_out_from_the_paper(dark: int) -> None:
    """A contrast of 4.5 of what texts are written in, and every colour has a name of its own in the page."""
    paper = luminance(PALETTE["paper"][dark])
    for name in ("ink", "muted", "accent", "good", "bad", *IN_TABLES):
        low, high = sorted((paper, luminance(PALETTE[name][dark])))
        assert (high + 0.05) / (low + 0.05) >= 4.5, name
    assert custom_properties(bool(dark)).split("; ")[0] == f"--ink: {PALETTE['ink'][dark]}"
    assert custom_properties(bool(dark)).count(";") == len(PALETTE) == len({colour(name) for name in PALETTE})
    assert {f"phase-{name}" for name in PHASES} <= set(PALETTE) and set(METHOD_NAMES) == set(IN_TABLES)


def test_an_axis_says_its_numbers_in_full() -> None:
    """No constant is split off; powers of ten where numbers would be longer than five digits before or after."""
    with drawing():
        plain, large, small, least = (numbers(plotted(y)[1]) for y in ((1e4, 10000.5), (0, 9e5), (0, 0.012), (0, 4e-4)))
    assert {"10000.0", "10000.5"} <= set(plain) and "0.012" in small
    assert max(len(text) for text in large) < 5 and max(len(text) for text in least) < 5
    with drawing():
        assert any("−" in text for text in numbers(plotted((-1.0, 1.0))[1]))


def test_a_figure_has_two_spines_a_grid_behind_and_no_boxes() -> None:
    with drawing():
        figure, axes = plotted(ylabel="load ($N$ & <mm>)")
        legend, word = axes.legend(), axes.text(0.5, 0.2, "word")
        assert word.get_size() == 8.0
        axes.set_title("what it shows")
        assert unreadable(figure) == []
        shown = {name for name, spine in axes.spines.items() if spine.get_visible()}
        assert shown == {"left", "bottom"} and not legend.get_frame_on() and axes.get_axisbelow() is True
        assert all(grid.get_visible() for grid in (*axes.get_xgridlines(), *axes.get_ygridlines()))
        assert axes.get_title(loc="left") == "what it shows" and axes.get_title() == ""
        assert [patch.get_facecolor()[3] for patch in (figure.patch, axes.patch)] == [0.0, 0.0]
        sizes = [axes.xaxis.label.get_size(), axes.title.get_size(), *(t.get_size() for t in legend.get_texts())]
        assert sizes == [8.0, 8.0, 7.5] and {t.get_size() for t in axes.get_xticklabels()} == {7.5}
        marks = [tick.tick1line for axis in (axes.xaxis, axes.yaxis) for tick in axis.majorTicks]
        assert {(mark.get_markersize(), mark.get_markeredgewidth()) for mark in marks} == {(3.0, 0.6)}
        assert {spine.get_linewidth() for spine in axes.spines.values()} == {0.6}
        assert {grid.get_linewidth() for grid in axes.get_xgridlines()} == {0.5}
        svg = to_svg(figure, "key", "A & B")
        assert to_svg(figure, "key", "A & B") == svg, "the same every time"
    assert "load ($N$ &amp; &lt;mm>)" in svg.replace("&gt;", ">") and "<text" in svg, "words are words"
    assert '<title id="key-t">A &amp; B</title>' in svg and "#0a0b" not in svg
    used = set(re.findall(r"var\(--([a-z-]+)\)", svg))
    assert {"ink", "muted", "rule", "nurbs"} <= used <= set(PALETTE)


@pytest.mark.parametrize("method", [*IN_TABLES, "code of another"])
def test_further_runs_of_a_method_are_thinner_and_fainter(method: str) -> None:
    """But never so much that they could not be seen; each lies below the one before."""
    runs = [line(method, repeat) for repeat in range(5)]
    assert len({run.colour for run in runs}) == len({run.dashes for run in runs}) == 1
    assert runs[0].colour == (method if method in IN_TABLES else "ink")
    widths, alphas = ([getattr(run, name) for run in runs] for name in ("width", "alpha"))
    assert widths == sorted(widths, reverse=True) and min(widths) >= 0.6 and widths[1] == max(0.6 * widths[0], 0.6)
    assert alphas == sorted(alphas, reverse=True) and min(alphas) == pytest.approx(0.4 * alphas[0])
    assert np.all(np.diff([run.order for run in runs]) < 0.0)
    assert runs[0].options()["linestyle"] == ((0, runs[0].dashes) if runs[0].dashes else "solid")


def test_no_two_methods_look_alike() -> None:
    looks = {(one.colour, one.dashes, one.width) for one in map(line, (*IN_TABLES, "other"))}
    assert len(looks) == len(IN_TABLES) + 1 and max(map(line, IN_TABLES), key=lambda one: one.width) == line("dolfinx")
    assert line("dolfinx").order < min(line(name).order for name in ("nurbs", "tspline", "lagrange", "beam"))


def test_a_stress_of_zero_has_the_colour_of_the_page() -> None:
    """The scale goes from one ink to another, ever less transparent, and as strong on both sides."""
    rgba = STRESS_MAP(np.linspace(0.0, 1.0, 201))
    alpha = rgba[:, 3]
    assert alpha.argmin() in (99, 100, 101) and alpha.min() < 0.12 and alpha[[0, -1]].tolist() == [1.0, 1.0]
    assert np.all(np.diff(alpha[101:]) >= -1e-9) and np.allclose(alpha, alpha[::-1], atol=0.02)
    assert rgba[0, 2] > rgba[0, 0] and rgba[-1, 0] > rgba[-1, 2], "blue is pressed, red is pulled"


def test_panels_line_up_whatever_their_height() -> None:
    places = []
    with drawing():
        for height in (2.0, 4.0):
            figure, axes = panel(HALF, height)
            box = axes.get_position()
            places.append((box.x0 * HALF, box.x1 * HALF, box.y0 * height, (1.0 - box.y1) * height))
            assert sheet_of(figure).extents == pytest.approx([0.0, 0.0, HALF, height], abs=0.05)
    assert np.allclose(places, (0.57, HALF - 0.1, 0.43, 0.17))


def test_a_label_longer_than_its_axis_is_broken_into_lines() -> None:
    """And the sheet is as large as what is drawn, with a little room."""
    with drawing():
        figure, axes = plotted(ylabel="a load in a unit with a name of very many letters and some words more")
        whole = axes.get_ylabel()
        sheet = sheet_of(figure)
        assert "\n" in axes.get_ylabel() and axes.get_ylabel().replace("\n", " ") == whole
        assert axes.yaxis.label.get_window_extent().height <= axes.get_window_extent().height
        drawn = figure.get_tightbbox()
        assert drawn.x0 < 0.0 and sheet.x0 == pytest.approx(drawn.x0 - 0.04) and sheet.x1 >= HALF


def test_a_page_is_dark_on_screens_of_those_who_want_it_and_light_elsewhere(tmp_path: Path) -> None:
    pytest.importorskip("jinja2")
    report.write(report.Findings((), {}), tmp_path / "report.html")
    text = (tmp_path / "report.html").read_text()
    inks = [PALETTE["ink"][dark] for dark in (0, 1)]
    assert f":root {{ --ink: {inks[0]};" in text
    assert f"@media screen and (prefers-color-scheme: dark) {{ :root {{ --ink: {inks[1]};" in text
    assert "{{" not in text and "{%" not in text
