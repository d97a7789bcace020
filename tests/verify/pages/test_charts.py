"""Charts of studies, of two curves and of meshes, as recorded beside; names of points that lie close."""

from dataclasses import replace

import matplotlib
import numpy as np
import pytest

pytest.importorskip("matplotlib")
pytest.importorskip("jinja2")

from figures import Drawn, facts, overlaps  # noqa: E402
from made_up_costs import a_row  # noqa: E402

from iga.bases.bspline import open_knots  # noqa: E402
from iga.bases.nurbs import nurbs_rectangle  # noqa: E402
from iga.tsplines.lines import tensor_grid  # noqa: E402
from iga.tsplines.tspline import greville, tspline_mesh  # noqa: E402
from tests.verify.studies.hard.test_hard import FAKE, stub  # noqa: E402
from verify.command_line.mesh import drawing as mesh_drawing  # noqa: E402
from verify.command_line.mesh.facts import MeshFacts  # noqa: E402
from verify.curves.compare import compare  # noqa: E402
from verify.pages import style  # noqa: E402
from verify.report import comparison  # noqa: E402
from verify.studies.cost import figures as charts  # noqa: E402
from verify.studies.hard import page as hard_page  # noqa: E402
from verify.studies.hard.case import Case, runs  # noqa: E402
from verify.studies.hard.one import run_case  # noqa: E402

#: Error, seconds and unknowns of a ladder of each of two methods, and one run off the ladders.
ROWS = [
    *(a_row("nurbs", 0.08 / 4**i, 0.5 * 2**i, 250 * 2**i) for i in range(4)),
    *(a_row("dolfinx", 0.03 / 4**i, 2.0 * 3**i, 500 * 2**i, 2) for i in range(3)),
    a_row("nurbs", 0.0004, 1.25, 1000, 3, "160"),
]


def test_charts_of_cost_and_of_two_curves(monkeypatch, data_regression):
    drawn = Drawn(monkeypatch, charts, comparison)
    charts.work_precision(ROWS, "key")
    d = np.linspace(0.0, 2.0, 81)
    load = d * (3.0 - d)
    comparison.page(compare((d, load * (1.0 + 0.04 * (d > 1.0))), (d, load)), ("mine.csv", "theirs.csv"), (), (), ())
    data_regression.check({title: facts(figure) for title, figure in drawn})


@pytest.mark.parametrize("many", [1, 8, 9])
def test_every_run_of_a_hard_case_is_drawn(many, tmp_path, monkeypatch, data_regression):
    """In its own line and named, where they are few; one alone with what displacement control would show."""
    drawn = Drawn(monkeypatch, hard_page)
    scenes = runs("dcb-czm1-linear", {f"v{i}": (f"load.opening={2.0 + i}",) for i in range(many)})
    case = Case("fake", FAKE.hard, scenes)
    panel = hard_page._figure(case, run_case(case, "nurbs", tmp_path / "fake" / "nurbs", stub), tmp_path)
    data_regression.check({"caption": panel.caption, **facts(drawn[0][1])})


@pytest.mark.parametrize("marked", [False, True])
def test_pictures_of_meshes(marked, data_regression):
    """Marks are named where there are any; the title is above, and all is to scale."""
    tmesh = tensor_grid(np.arange(4.0), np.arange(4.0))
    shown = MeshFacts(tspline_mesh(tmesh, greville(tmesh) * [1.0, 0.7]))
    shown.__dict__["junctions"] = np.array([[1.0, 0.35], [2.0, 0.7]] if marked else []).reshape(-1, 2)
    shown.__dict__["extraordinary"] = [(5, np.array([1.5, 1.05]))] if marked else []
    with matplotlib.rc_context(mesh_drawing._SHEET_STYLE):
        data_regression.check(facts(mesh_drawing.mesh_figure(shown, "a mesh of nine elements", marked)))


def test_sides_are_curves_where_they_bend_by_a_millionth():
    """Of their length; otherwise their ends are enough."""
    kv, scale = open_knots([0.0, 1.0], 3), 20.0
    body = nurbs_rectangle(kv, kv)
    for bend, points in ((0.0, 2), (0.97e-6, 2), (1.03e-6, 17)):
        P_AI = scale * body.P_AI
        P_AI[(body.P_AI[:, 1] == 0.0) & (body.P_AI[:, 0] % 1.0 > 0.0), 1] = scale * bend / 0.75
        curves = mesh_drawing._curves(MeshFacts(replace(body, P_AI=P_AI)))
        assert [len(curve) for curve in curves] == [2, 2, points, 2]


@pytest.mark.parametrize(
    "places",
    [
        {"NURBS": (7.8, 0.052), "T-spline": (94.0, 0.027), "Lagrange": (22.0, 0.57), "cohesive beam": (5.6, 0.056)},
        {"NURBS": (1.0, 0.05), "T-spline": (1.1, 0.05), "Lagrange": (1.0, 0.06), "cohesive beam": (9.0, 0.5)},
        {"NURBS 489": (1.0, 0.12), "NURBS 978": (1.0, 0.11), "Lagrange": (40.0, 0.1), "beam": (0.1, 0.12)},
    ],
)
def test_names_of_points_that_lie_close_do_not_meet(places):
    with style.drawing():
        figure, axes = style.panel(style.HALF, 2.5)
        at = np.array(list(places.values()))
        axes.plot(*at.T, "o")
        axes.set(xscale="log", yscale="log")
        axes.margins(0.3, 0.3)
        axes.autoscale_view()
        style.name_points(axes, at, list(places), [style.colour("ink")] * len(places))
        figure.canvas.draw()
        assert {text.get_text() for text in axes.texts} == set(places) and overlaps(axes) == []


@pytest.mark.parametrize(("low", "high"), [(0.3, 70.0), (2e-4, 9.0), (15.0, 4000.0)])
def test_logarithmic_axes_have_plain_numbers_at_1_2_and_5(low, high):
    with style.drawing():
        figure, axes = style.panel(style.HALF, 3.0)
        axes.plot([low, high], [low, high])
        axes.set(xscale="log")
        style.plain(axes.xaxis)
        figure.canvas.draw()
    left, right = axes.get_xlim()
    shown = [(tick.get_loc(), tick.label1.get_text()) for tick in axes.xaxis._update_ticks() if tick.label1.get_text()]
    wanted = [m * 10.0**e for e in range(-6, 6) for m in (1, 2, 5) if left <= m * 10.0**e <= right]
    assert np.allclose([at for at, _ in shown], wanted) and len(wanted) >= 5
    assert [float(text) for _, text in shown] == pytest.approx(wanted) and "e" not in "".join(t for _, t in shown)
