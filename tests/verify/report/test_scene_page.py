"""The section of a scene: what stands in its tables and what its figures draw is what the runs have."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

pytest.importorskip("matplotlib")
pytest.importorskip("jinja2")

from figures import Drawn  # noqa: E402
from made_up_runs import made_up, run, scene_report  # noqa: E402
from matplotlib.axes import Axes  # noqa: E402

from verify.curves.curve import PROPAGATION, curve_error, oscillation, peak  # noqa: E402
from verify.methods.dolfinx import DOLFINX_MISSING  # noqa: E402
from verify.pages.style import SHOWN_PHASES, colour  # noqa: E402
from verify.pages.table import Table  # noqa: E402
from verify.pages.text import percent, quantity  # noqa: E402
from verify.report import cost
from verify.report import section as section_of  # noqa: E402
from verify.report.figures import curves  # noqa: E402
from verify.report.figures.entry import Entry, entries  # noqa: E402
from verify.report.section import Section, checks, section  # noqa: E402
from verify.result import Result  # noqa: E402
from verify.verdict import Check, Run, SceneReport  # noqa: E402

NAME = "dcb-czm1"


@pytest.fixture(scope="module")
def report() -> SceneReport:
    """With a run that stopped, one that was not made and one that has no step."""
    whole = scene_report()
    early, empty = (
        replace(one, steps={n: c[:rows] for n, c in one.steps.items()}, status=f"stopped: {why}", snapshots=())
        for one, rows, why in (
            (made_up("nurbs", 4e-3, 2.1, 978, 56), 60, "no convergence"),
            (made_up("tspline", 0.0, 1.0, 10, 10), 1, "at once"),
        )
    )
    more = (
        run(NAME, "NURBS p=3, 978 unknowns", replace(early, rejected_steps=7)),
        Run("T-splines", "tspline", empty),
        Run("DOLFINx p=3", "dolfinx", None, DOLFINX_MISSING),
    )
    return replace(whole, runs=(*whole.runs, *more))


@pytest.fixture(scope="module")
def made(report: SceneReport) -> tuple[Section, Drawn]:
    """The page, and its figures before they become text."""
    with pytest.MonkeyPatch.context() as patch:
        drawn = Drawn(patch, curves, cost)
        return section(report, NAME), drawn


@pytest.fixture
def page(made: tuple[Section, Drawn]) -> Section:
    return made[0]


@pytest.fixture
def drawn(made: tuple[Section, Drawn]) -> Drawn:
    return made[1]


def by_first(table: Table) -> dict[str, list[str]]:
    """Texts of the cells by that of the first one, with plain spaces."""
    rows = ([cell.text.replace("\u00a0", " ") for cell in row] for row in table.cells())
    return {row[0]: row[1:] for row in rows}


def test_a_row_has_the_numbers_of_its_run(page: Section, report: SceneReport) -> None:
    reference = next(one.result for one in report.runs if one.method == "dolfinx")
    base = reference.opening, reference.load
    rows = [[cell.text.replace("\u00a0", " ") for cell in row] for row in page.methods.cells()]
    found = {entry.label: row[1:] for entry, row in zip(page.entries, rows, strict=True)}
    results = {entry.label: entry.run.result for entry in page.entries}
    compared = ("NURBS p=3, 1952 unknowns", "Lagrange p=3, 1952 unknowns", "cohesive beam", "NURBS p=3, 978 unknowns")
    for name in compared:
        result, row = results[name], found[name]
        curve, end = (result.opening, result.load), float(result.opening[-1])
        extent = "" if result.complete else f" up to {quantity(end, 'mm', 3)}"
        (x, P), ripple = peak(curve), oscillation(curve, base, end)["rms"]
        numbers = (percent(curve_error(curve, base, end)) + extent, percent(ripple), quantity(P, "N", 4))
        assert row[:4] == [text.replace("\u00a0", " ") for text in (*numbers, quantity(x, "mm", 3))], name
        assert row[7] == str(4 * (len(result.opening) - 1)) and row[9] == "180 MB"
    assert (
        found["NURBS p=3, 1952 unknowns"][4:7] == ["1952", "224", "150"]
        and found["NURBS p=3, 1952 unknowns"][8] == "8.7 s"
    )
    assert found["NURBS p=3, 978 unknowns"][6] == "59 + 7 rejected"
    assert found["DOLFINx p=2, 2700 unknowns"][:2] == ["reference", "–"] and found["LEFM"][:2] == [
        "limit, not compared",
        "–",
    ]
    assert found["DOLFINx p=3"] == [DOLFINX_MISSING] and found["T-splines"] == ["no converged step"]
    ended = {name: row[1] for name, row in by_first(page.runs).items()}
    assert ended["NURBS p=3, 978 unknowns"] == "stopped: no convergence" and ended["LEFM"] == "complete"
    assert page.stopped and all(row[0] != "its code knows" for row in by_first(page.runs).values())


def test_what_is_missing_has_a_note(page: Section, report: SceneReport) -> None:
    assert set(page.notes) == {
        f"DOLFINx p=3: {DOLFINX_MISSING}",
        "NURBS p=3, 978 unknowns stopped: no convergence",
        "T-splines stopped: at once",
    }
    alone = replace(report, runs=tuple(one for one in report.runs if one.method in ("nurbs", "lefm")))
    without = section(alone, NAME)
    assert without.reference is None and by_first(without.methods)["LEFM"][0] == "limit, not compared"
    assert any(note.startswith("No distance between curves") for note in without.notes)
    lost = SimpleNamespace(label="beam", run=SimpleNamespace(result=None, left_out=""), is_reference=True)
    assert list(section_of._notes([lost])) == ["beam: not run"]


def test_figures_are_those_that_the_runs_give(page: Section, report: SceneReport) -> None:
    assert {one.title: len(one.panels) for one in page.figures} == {
        "Load and opening": 2,
        "Oscillation and J-integral": 2,
        "Traction along the interface": 3,
        "Meshes": 1,
        "Deformed meshes and stress": 1,
        "The opening crack": 1,
        "Energy": 2,
        "Cost": 2,
    }
    assert [one.title for one in page.figures if not one.folded] == ["Load and opening"]
    legends = {one.title: {entry.method for entry in one.legend} for one in page.figures}
    assert legends["Load and opening"] == {"nurbs", "lagrange", "dolfinx", "beam", "lefm"}
    assert legends["Energy"] == legends["Load and opening"] - {"lefm"}
    alone = section(replace(report, runs=report.runs[:1]), NAME)
    assert {one.title: len(one.panels) for one in alone.figures}["Oscillation and J-integral"] == 1
    assert section(replace(report, runs=report.runs[-1:]), NAME).figures == ()


@pytest.mark.parametrize(
    ("value", "tolerance", "used"),
    [(0.5, 1.0, "50 %"), (-0.5, 1.0, "50 %"), (3.0, 1.0, "all"), (0.0, 0.0, "0 %"), (1e-9, 0.0, "all")],
)
def test_a_check_shows_how_much_of_its_tolerance_it_uses(report, value: float, tolerance: float, used: str) -> None:
    check = Check("j-integral", "nurbs / dolfinx", value, tolerance, "exact", "It holds.")
    held = abs(value) <= tolerance
    (row,) = checks(replace(report, checks=(check,)), "one", held).cells()
    assert row[5].text.replace("\u00a0", " ") == used and row[6].tone == ("good" if held else "bad")
    assert row[2].link == "#one-run-nurbs" and checks(replace(report, checks=(check,)), "one", not held).cells() == []


def test_checks_stand_by_kind_and_name_and_names_that_fail_apart(report: SceneReport) -> None:
    fails = Check("j-integral", "lagrange", 0.02, 5e-3, "exact", "J is the area under the traction law.")
    vague = Check("curve", "beam", 1.0, 5e-3, "cross-code", "Two codes draw the same curve.", 0.1, "too coarse")
    given = replace(report, checks=(vague, *report.checks, fails))
    names = [[cell.text for cell in row[:3]] for row in checks(given, "one", held=True).cells()]
    assert names == [
        ["energy-ledger", "exact", "nurbs"],
        ["interface-force", "exact", "nurbs"],
        ["beam-curve", "analytical", "nurbs / beam"],
    ]
    rows = checks(given, "one", held=False).cells()
    assert [row[2].text for row in rows] == ["nurbs", "dolfinx", "lagrange", "beam", "nurbs / dolfinx"]
    assert (rows[3][3].below, rows[3][6].text, rows[3][6].below) == ("± 0.1", "? unresolved", "too coarse")


# --- figures


def lines_of(axes: Axes, entry: Entry) -> list[np.ndarray]:
    """Points of the lines of a run."""
    style = entry.line.options()
    same = [o for o in axes.lines if (o.get_color(), o.get_linewidth()) == (style["color"], style["linewidth"])]
    return [np.column_stack(one.get_data()) for one in same if len(one.get_xdata()) > 1]


def curves_of(report: SceneReport) -> list[Entry]:
    return [entry for entry in entries(report) if entry.agreement is not None]


def test_the_load_of_every_run_is_drawn_to_its_end(report: SceneReport, drawn: Drawn) -> None:
    axes = drawn.axes("Load against opening, ")
    for entry in curves_of(report):
        (points,) = lines_of(axes, entry)
        assert np.array_equal(points, np.column_stack([entry.result.opening, entry.result.load])), entry.label
    (cross,) = [one for one in axes.lines if len(one.get_xdata()) == 1]
    stopped = next(entry.result for entry in curves_of(report) if not entry.complete)
    assert (cross.get_xdata()[0], cross.get_ydata()[0]) == (stopped.opening[-1], stopped.load[-1])
    own = max(float(entry.result.load.max()) for entry in curves_of(report) if entry.method != "lefm")
    assert axes.get_ylim()[0] == 0.0 and own < axes.get_ylim()[1] <= 1.4 * own
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("opening (mm)", "load (N)")
    near = drawn.axes("near the peak")
    for x, P in (peak((e.result.opening, e.result.load)) for e in curves_of(report) if e.method != "lefm"):
        (left, right), (low, high) = near.get_xlim(), near.get_ylim()
        assert left < x < right and low < P < high and P - low > 2 * (high - P)


def test_a_load_below_zero_is_not_cut_off(report: SceneReport, monkeypatch: pytest.MonkeyPatch) -> None:
    figures, first = Drawn(monkeypatch, curves, cost), report.runs[0]
    pushed = replace(first.result, steps={**first.result.steps, "load": first.result.load - 0.25})
    curves.loads(report.scene, curves_of(replace(report, runs=(replace(first, result=pushed),))), "key")
    assert figures.axes("Load against opening, ").get_ylim()[0] < float(np.min(pushed.load)) < -0.24


def test_deviations_are_from_the_reference_and_between_steps_those_of_the_cubics(
    report: SceneReport, monkeypatch: pytest.MonkeyPatch
) -> None:
    """P = x (6 - x) and P (1 ± x / 50): off by ±2 x per cent. Chords of these steps would be off by 0.3 % more."""
    P, share = np.polynomial.Polynomial([0.0, 6.0, -1.0]), np.polynomial.Polynomial([0.0, 0.02])
    kinds = (("dolfinx", P, 5.0, 13), ("nurbs", P * (1 + share), 4.5, 18), ("beam", P * (1 - share), 5.5, 22))
    runs = []
    for method, load, end, steps in kinds:
        x = np.linspace(0.0, end, steps + 1)
        columns = {"opening": x, "load": load(x), "load_slope": load.deriv()(x), "heading": np.ones_like(x)}
        runs.append(run(NAME, method, Result(method, columns)))
    reference, *others = entries(replace(report, runs=tuple(runs)))
    figures = Drawn(monkeypatch, curves)
    curves.oscillation(report.scene, [reference, *others], reference, "deviation")
    axes = figures.axes("Oscillation of the load")
    for entry, sign in zip(others, (1, -1), strict=True):
        ((x, per_cent),) = [points.T for points in lines_of(axes, entry)]
        assert per_cent == pytest.approx(sign * 2.0 * x, abs=0.03)
        assert (x[0], x[-1]) == pytest.approx((3.0 * PROPAGATION, min(5.0, entry.result.opening[-1])), rel=0.01)
    assert lines_of(axes, reference) == [] and curves.oscillation(report.scene, [reference], reference, "key") is None


def test_the_parts_of_the_energy_fill_the_work_of_the_load(report: SceneReport, drawn: Drawn) -> None:
    """Stacked: each begins where the one below ends, the last one ends at the work."""
    axes, steps = drawn.axes("Energies against opening, NURBS p=3, 1952"), report.runs[0].result.steps
    names = [one.get_label() for one in axes.collections]
    assert names == ["dissipated", "stored in the interface", "stored in the bodies"]
    x, lost = steps["opening"], steps["dissipated_energy"]
    bounds = [np.zeros(x.size), lost, lost + steps["cohesive_energy"], lost + steps["stored_energy"]]
    for band, low, high in zip(axes.collections, bounds, bounds[1:], strict=False):
        corners = band.get_paths()[0].vertices
        for y in (low, high):
            for at in (20, 75, 149):
                assert np.abs(corners - (x[at], y[at])).max(axis=1).min() < 1e-12, (band.get_label(), at)
    (work,) = [one for one in axes.lines if one.get_label() == "work of the load"]
    assert np.array_equal(work.get_ydata(), steps["external_work"])


def test_what_ledgers_miss_is_relative_to_the_work(report: SceneReport, drawn: Drawn) -> None:
    """The made-up ones lose 1e-5 of what is dissipated; LEFM has none."""
    axes = drawn.axes("Gap of the energy ledger")
    for entry in curves_of(report):
        found = lines_of(axes, entry)
        assert len(found) == (entry.method != "lefm")
        for x, gap in (points.T for points in found):
            steps = {name: np.interp(x, entry.result.opening, column) for name, column in entry.result.steps.items()}
            lost = steps["external_work"] - steps["stored_energy"]
            assert gap == pytest.approx(1e-5 * lost / steps["external_work"], rel=1e-6)


def test_bars_of_time_are_as_long_as_their_phases(report: SceneReport, drawn: Drawn) -> None:
    axes = drawn.axes("Wall time by phase")
    timed, ends = [entry for entry in curves_of(report) if entry.result.seconds], {}
    for container in axes.containers:
        for entry, bar in zip(timed, container, strict=True):
            assert bar.get_x() == pytest.approx(ends.get(entry.label, 0.0))
            assert bar.get_width() == pytest.approx(entry.result.seconds[container.get_label()])
            ends[entry.label] = bar.get_x() + bar.get_width()
    assert ends == pytest.approx({entry.label: entry.result.seconds["total"] for entry in timed})
    plain = Result("nurbs", {}, seconds={"mesh": 1.0, "solve": 2.0, "total": 5.0})
    assert cost.total_seconds(plain) == 5.0 == sum(cost.phase_seconds(plain).values())
    assert cost.total_seconds(replace(plain, seconds={"mesh": 1.0, "solve": 2.0})) == 3.0
    assert np.isnan(cost.total_seconds(replace(plain, seconds={}))) and set(cost.phase_seconds(plain)) == set(
        SHOWN_PHASES
    )


def test_error_and_time_of_every_run_that_has_both(report: SceneReport, drawn: Drawn) -> None:
    axes = drawn.axes("Curve error against time")
    points = {(one.get_xdata()[0], one.get_ydata()[0]) for one in axes.lines}
    judged = [e for e in curves_of(report) if e.agreement.error > 0 and e.result.seconds]
    assert points == {(e.result.seconds["total"], 100 * e.agreement.error) for e in judged} and len(judged) == 4
    assert len(axes.texts) == 4 and axes.get_xscale() == axes.get_yscale() == "log"


def test_j_is_drawn_over_the_toughness_and_enlarged_where_it_has_settled(report: SceneReport, drawn: Drawn) -> None:
    axes = drawn.axes("J-integral over toughness")
    (inset,) = axes.child_axes
    scene, entry = report.scene, next(e for e in curves_of(report) if e.method == "nurbs")
    steps = entry.result.steps
    slopes = np.abs(steps["face_slope_top"]) + np.abs(steps["face_slope_bottom"])
    J = (steps["load"] * slopes / scene.specimen.width - steps["face_energy"]) / scene.interface.toughness
    for where in (axes, inset):
        (points,) = lines_of(where, entry)
        assert np.array_equal(points, np.column_stack([entry.result.opening, J]))
    (start, end), (low, high) = inset.get_xlim(), inset.get_ylim()
    assert 0.6 < start < 1.0 and end == 3.0 and low < 0.995 and high - 1.0 == pytest.approx(1.5 * (1.0 - low))
    assert colour("nurbs") in {one.get_color() for one in inset.lines}
