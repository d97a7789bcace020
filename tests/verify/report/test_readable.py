"""Figures of every page can be read: nothing is cut off, on top of something else, too small or out of view."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("matplotlib")
pytest.importorskip("jinja2")

import matplotlib  # noqa: E402
from figures import Drawn, legend, unreadable  # noqa: E402
from made_up_runs import scene_report  # noqa: E402
from matplotlib.axes import Axes  # noqa: E402
from matplotlib.cm import ScalarMappable  # noqa: E402

from iga.bases.bspline import open_knots  # noqa: E402
from iga.bases.nurbs import nurbs_rectangle  # noqa: E402
from iga.tsplines.lines import tensor_grid  # noqa: E402
from iga.tsplines.tspline import greville, tspline_mesh  # noqa: E402
from tests.verify.studies.hard.test_hard import FAKE, stub  # noqa: E402
from verify.command_line.mesh import drawing as mesh_drawing  # noqa: E402
from verify.command_line.mesh.facts import MeshFacts  # noqa: E402
from verify.pages import parts  # noqa: E402
from verify.pages.style import HALF, PALETTE, colour, panel  # noqa: E402
from verify.pages.style import drawing as settings  # noqa: E402
from verify.report import cost
from verify.report.figures import curves, drawing, fields, meshes
from verify.report.section import section  # noqa: E402
from verify.studies.hard import page as hard_page  # noqa: E402
from verify.studies.hard.case import Case, runs  # noqa: E402
from verify.studies.hard.one import run_case  # noqa: E402

PAGE = (cost, curves, drawing, fields, meshes)


@pytest.mark.parametrize(
    ("spoil", "words"),
    [
        (lambda axes: axes.set_xlabel("a label that is far longer than the figure is wide " * 3), "cut off"),
        (lambda axes: axes.text(0.5, 0.5, "small", fontsize=4), "'small' in 4"),
        (lambda axes: [axes.text(0.5, 0.5, text) for text in ("one", "other")], "'one' on 'other'"),
        (lambda axes: axes.figure.add_axes((0.5, 0.5, 0.2, 0.2)), "axes 0 on axes 1"),
        (lambda axes: axes.plot([0, 1], [0, 1], linewidth=9, label="thick"), "thick 9"),
        (lambda axes: axes.plot([0, 1], [0, 1], "o", markersize=0.5, label="dots"), "dots of 0.5"),
        (lambda axes: axes.plot([0, 1], [7, 7], label="high") and axes.set_ylim(0, 1), "high out of view"),
        (lambda axes: axes.barh([0.0, 0.2], [1.0, 1.0], 0.8), "a bar on a bar"),
        (lambda axes: axes.figure.colorbar(ScalarMappable(), ax=axes), "a frame around the scale"),
    ],
)
def test_what_cannot_be_read_is_told(spoil: Callable[[Axes], object], words: str) -> None:
    with settings():
        figure, axes = panel(HALF, 3.0)
        axes.plot([0.0, 1.0], [0.0, 1.0], "o-", markersize=3.0)
        axes.set(xlabel="opening", ylabel="load")
        assert unreadable(figure) == []
        spoil(axes)
        assert any(words in told for told in unreadable(figure))


def test_figures_of_a_beam_can_be_read(monkeypatch: pytest.MonkeyPatch) -> None:
    drawn = Drawn(monkeypatch, *PAGE)
    section(scene_report(), "beam")
    assert len(drawn) > 12
    for words in ("Meshes of all runs", "beam-deformed", "beam-opening"):
        axes = drawn.axes(words)
        assert axes.get_xlim() == pytest.approx((-0.14, 14.14)), "a hundredth of it is left beside it"
        low, high = axes.get_ylim()
        box, to_scale = axes.get_window_extent(), pytest.approx(14.28 / (high - low))
        assert high == pytest.approx(-low) and (words.startswith("Mesh") or box.width / box.height == to_scale)


# --- parts of several figures


@pytest.mark.parametrize(("low", "high"), [(0.3, 70.0), (2e-4, 9.0), (15.0, 4000.0)])
def test_logarithmic_axes_have_plain_numbers_at_1_2_and_5(low: float, high: float) -> None:
    with settings():
        figure, axes = panel(HALF, 3.0)
        axes.plot([low, high], [low, high])
        axes.set(xscale="log", yscale="log", xlabel="x", ylabel="y")
        parts.plain(axes.xaxis)
        parts.plain(axes.yaxis)
        figure.canvas.draw()
    for axis, (left, right) in ((axes.xaxis, axes.get_xlim()), (axes.yaxis, axes.get_ylim())):
        shown = [(tick.get_loc(), tick.label1.get_text()) for tick in axis._update_ticks() if tick.label1.get_text()]
        wanted = [m * 10.0**e for e in range(-6, 6) for m in (1, 2, 5) if left <= m * 10.0**e <= right]
        assert np.allclose([at for at, _ in shown], wanted) and len(wanted) >= 5
        assert [float(text) for _, text in shown] == pytest.approx(wanted) and "e" not in "".join(t for _, t in shown)


# --- studies


# --- hard cases


@pytest.mark.parametrize("many", [1, 2, 8, 9])
def test_every_run_of_a_hard_case_is_drawn(many: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """In its own line and named, where they are few; one alone with what displacement control would show."""
    drawn = Drawn(monkeypatch, hard_page)
    case = Case(
        "fake", FAKE.hard, runs("dcb-czm1-linear", {f"v{i}": (f"load.opening={2.0 + i}",) for i in range(many)})
    )
    said = hard_page._figure(case, run_case(case, "nurbs", tmp_path / "fake" / "nurbs", stub), tmp_path)
    axes = drawn.axes("Load against opening, fake")
    paths = [one for one in axes.lines if one.get_label() != "displacement control"]
    assert sorted(round(max(one.get_xdata()), 9) for one in paths) == [2.0 + i for i in range(many)]
    assert len(axes.lines) - len(paths) == (many == 1) and (axes.get_legend() is not None) == (many <= 8)
    looks = {(one.get_color(), str(one._dash_pattern)) for one in paths}
    assert len(looks) == (many if many <= 8 else 1), "each can be told from the others, or none"
    assert {look[0] for look in looks} <= {colour(name) for name in PALETTE}
    words = "the path, and dashed" if many == 1 else f"{many} runs. A cross marks the end"
    assert said.caption.startswith("NURBS: ") and words in said.caption


@pytest.mark.parametrize("control", [False, True])
@pytest.mark.parametrize("marked", [False, True])
@pytest.mark.parametrize("stretch", [0.7, 0.1])
def test_pictures_of_meshes_can_be_read(control: bool, marked: bool, stretch: float) -> None:
    """Marks are named where there are any, whatever the shape of the body; the title is above, and all is to scale."""
    tmesh = tensor_grid(np.arange(4.0), np.arange(4.0))
    mesh = tspline_mesh(tmesh, greville(tmesh) * [1.0, stretch])
    facts = MeshFacts(mesh)
    facts.__dict__["junctions"] = np.array([[1.0, 0.5 * stretch], [2.0, 1.0 * stretch]] if marked else []).reshape(
        -1, 2
    )
    facts.__dict__["extraordinary"] = [(5, np.array([1.5, 1.5 * stretch]))] if marked else []
    with matplotlib.rc_context(mesh_drawing._SHEET_STYLE):
        figure = mesh_drawing.mesh_figure(facts, "a mesh of nine elements", control)
        assert unreadable(figure) == []
    marks = ["2 T-junctions", "extraordinary points, with their valence"]
    assert legend(figure) == [*["control points"] * control, *marks * marked]
    (axes,) = figure.axes
    low, high = np.transpose([axes.get_xlim(), axes.get_ylim()])
    assert np.all(mesh.P_AI > low) and np.all(mesh.P_AI < high)
    assert [text.get_text() for text in axes.texts] == ["5"] * marked
    box = axes.get_window_extent()
    assert box.width / box.height == pytest.approx(np.divide(*(high - low)), rel=0.02), "to scale"
    assert figure.get_size_inches()[0] == 7.0 and 1.2 <= figure.get_size_inches()[1] <= 8.1


def test_sides_are_curves_where_they_bend_by_a_millionth() -> None:
    """Of their length; otherwise their ends are enough. The outline of an element goes once around it."""
    kv, scale = open_knots([0.0, 1.0], 3), 20.0
    body = nurbs_rectangle(kv, kv)
    for bend, points in ((0.0, 2), (0.97e-6, 2), (1.03e-6, 17)):
        P_AI = scale * body.P_AI
        inner = (body.P_AI[:, 1] == 0.0) & (body.P_AI[:, 0] % 1.0 > 0.0)
        P_AI[inner, 1] = scale * bend / 0.75
        facts = MeshFacts(replace(body, P_AI=P_AI))
        curves = mesh_drawing._curves(facts)
        assert [len(curve) for curve in curves] == [2, 2, points, 2]
        assert max(curves[2][:, 1]) == pytest.approx(scale * bend * (points > 2), rel=1e-6, abs=1e-12)
        x, y = mesh_drawing._outline(curves, 0).T
        area = 0.5 * np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y)
        assert area == pytest.approx(scale**2, rel=1e-5), "walked with the element on the left"
