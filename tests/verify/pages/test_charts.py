"""Charts of studies and of two curves: the points that are drawn are the numbers that were found."""

from __future__ import annotations

import numpy as np
import pytest

pytest.importorskip("matplotlib")
pytest.importorskip("jinja2")

from figures import Drawn, legend, unreadable  # noqa: E402
from made_up_costs import a_row  # noqa: E402

from verify.curves.compare import compare  # noqa: E402
from verify.curves.curve import envelope  # noqa: E402
from verify.pages.parts import name_points  # noqa: E402
from verify.pages.style import HALF, colour, drawing, panel  # noqa: E402
from verify.report import comparison  # noqa: E402
from verify.studies.cost import figures as charts  # noqa: E402

#: Error, seconds and unknowns of a ladder of each of two methods, and one run off the ladders.
ROWS = [
    *(a_row("nurbs", 0.08 / 4**i, 0.5 * 2**i, 250 * 2**i) for i in range(4)),
    *(a_row("dolfinx", 0.03 / 4**i, 2.0 * 3**i, 500 * 2**i, 2) for i in range(3)),
    a_row("nurbs", 0.0004, 1.25, 1000, 3, "160"),
]


def points(axes, ink: str, marker: str | None = None) -> list[tuple[float, float]]:
    """All points of the lines in one colour, of one marker where that is told."""
    lines = [one for one in axes.lines if one.get_color() == colour(ink) and marker in (None, one.get_marker())]
    return [tuple(map(float, point)) for one in lines for point in zip(*one.get_data(), strict=True)]


def alike(found: list[tuple[float, float]], expected: list[tuple[float, float]]) -> bool:
    return len(found) == len(expected) and np.allclose(found, expected, rtol=1e-9, atol=0.0)


def test_every_run_is_a_point_of_error_and_time(monkeypatch: pytest.MonkeyPatch) -> None:
    drawn = Drawn(monkeypatch, charts)
    charts.work_precision(ROWS, "key")
    axes = drawn.axes("Curve error against time")
    for method, ink, marker in (("nurbs", "nurbs", "o"), ("dolfinx", "dolfinx", "s")):
        expected = [(row.seconds, 100 * row.curve_error) for row in ROWS if row.method == method]
        assert alike(sorted(points(axes, ink, marker)), sorted(expected))
        own = [row for row in ROWS if row.method == method]
        (front,) = [one for one in axes.lines if one.get_color() == colour(ink) and one.get_linestyle() == "-"]
        x, y = front.get_data()
        assert len(x) > 2 and list(x) == sorted(x) and list(y) == sorted(y, reverse=True)
        for at, off in zip(x, y, strict=True):
            assert not any(row.seconds <= at and 100 * row.curve_error < off for row in own)
        for row in own:
            assert any(at <= row.seconds and off <= 100 * row.curve_error for at, off in zip(x, y, strict=True))
    assert legend(axes.figure) == ["DOLFINx, degree 2", "NURBS, degree 3"]
    levels = sorted(set(one.get_ydata()[0] for one in axes.lines if one.get_color() == colour("rule")))
    assert levels == pytest.approx([0.1, 0.3, 1.0])
    assert axes.get_xscale() == axes.get_yscale() == "log"


@pytest.mark.parametrize(
    "places",
    [
        {"NURBS": (7.8, 0.052), "T-spline": (94.0, 0.027), "Lagrange": (22.0, 0.57), "cohesive beam": (5.6, 0.056)},
        {"NURBS": (1.0, 0.05), "T-spline": (1.1, 0.05), "Lagrange": (1.0, 0.06), "cohesive beam": (9.0, 0.5)},
        {"NURBS 489": (1.0, 0.12), "NURBS 978": (1.0, 0.11), "Lagrange": (40.0, 0.1), "beam": (0.1, 0.12)},
    ],
)
def test_names_of_points_that_lie_close_do_not_meet(places: dict[str, tuple[float, float]]) -> None:
    with drawing():
        figure, axes = panel(HALF, 2.5)
        for place in places.values():
            axes.plot(*place, "o", color=colour("ink"), markersize=6)
        axes.set(xscale="log", yscale="log", xlabel="wall time (s)", ylabel="distance (%)")
        axes.margins(0.3, 0.3)
        axes.minorticks_off()
        axes.autoscale_view()
        name_points(axes, np.array(list(places.values())), list(places), [colour("ink")] * len(places))
        assert {text.get_text() for text in axes.texts} == set(places)
        assert [said for said in unreadable(figure) if any(repr(name) in said for name in places)] == []


def test_ladders_are_drawn_with_their_orders(monkeypatch: pytest.MonkeyPatch) -> None:
    drawn = Drawn(monkeypatch, charts)
    charts.error_and_unknowns(ROWS, {"nurbs-p3": 2.0, "dolfinx-p2": np.nan}, "key")
    axes = drawn.axes("Curve error against unknowns")
    assert alike(points(axes, "nurbs"), [(250 * 2**i, 8.0 / 4**i) for i in range(4)])
    assert alike(points(axes, "dolfinx"), [(500 * 2**i, 3.0 / 4**i) for i in range(3)])
    assert [t.get_text() for t in axes.get_legend().get_texts()] == ["DOLFINx, degree 2", "NURBS, degree 3: 2.0"]


# --- two curves


def test_two_curves_and_their_difference(monkeypatch: pytest.MonkeyPatch) -> None:
    drawn = Drawn(monkeypatch, comparison)
    d = np.linspace(0.0, 2.0, 81)
    load = d * (3.0 - d) + 0.0
    found = compare((d, load * (1.0 + 0.04 * (d > 1.0))), (d, load))
    comparison.page(found, ("mine.csv", "theirs.csv"), (), (), ())
    axes = drawn.axes("Load against opening of mine.csv and theirs.csv")
    for part, ink in ((found.a, "lagrange"), (found.b, "dolfinx")):
        path, under_control, top = [o for o in axes.lines if o.get_color() == colour(ink)]
        assert np.array_equal(path.get_xdata(), part.opening) and np.array_equal(path.get_ydata(), part.load)
        assert np.array_equal(
            np.column_stack(under_control.get_data()), np.column_stack(envelope(part.opening, part.load))
        )
        assert (top.get_xdata()[0], top.get_ydata()[0]) == (part.peak_opening, part.peak_load)
    assert [t.get_text() for t in axes.get_legend().get_texts()] == ["B: theirs.csv", "A: mine.csv"]
    off = drawn.axes("Difference of the loads")
    gap = 100 * (found.load_a_n - found.load_b_n) / found.b.peak_load
    lines = [o for o in off.lines if len(o.get_xdata()) == gap.size]
    assert len(lines) == 1 and lines[0].get_ydata() == pytest.approx(gap)
    (ring,) = [o for o in off.lines if o.get_color() == colour("bad")]
    at = int(np.argmax(np.abs(gap)))
    assert (ring.get_xdata()[0], ring.get_ydata()[0]) == pytest.approx((found.opening_n[at], gap[at]))
    assert ring.get_ydata()[0] == pytest.approx(4.0, rel=0.05)
