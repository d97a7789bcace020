"""The page of a scene: what stands in its tables and what its figures draw is what the runs have."""

from __future__ import annotations

import re
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

pytest.importorskip("matplotlib")
pytest.importorskip("jinja2")

from figures import Drawn  # noqa: E402
from made_up_runs import limit, made_up, run, scene_report  # noqa: E402
from matplotlib.axes import Axes  # noqa: E402
from scipy.interpolate import CubicHermiteSpline  # noqa: E402

from verify.curves.curve import PROPAGATION, curve_error, oscillation, peak  # noqa: E402
from verify.methods.dolfinx import DOLFINX_MISSING  # noqa: E402
from verify.pages.style import SHOWN_PHASES, colour  # noqa: E402
from verify.pages.text import NO_VALUE, percent, quantity  # noqa: E402
from verify.report import cost
from verify.report import section as section_of  # noqa: E402
from verify.report.figures import curves  # noqa: E402
from verify.report.figures.agreement import path  # noqa: E402
from verify.report.figures.entry import entries  # noqa: E402
from verify.report.section import RunRow, Section, section  # noqa: E402
from verify.result import Result  # noqa: E402
from verify.verdict import Check, Run, SceneReport  # noqa: E402

NAME = "dcb-czm1"


def early(result: Result, steps: int = 60) -> Result:
    """The run up to one of its steps."""
    cut = {name: column[:steps] for name, column in result.steps.items()}
    return replace(result, steps=cut, status="stopped: no convergence", rejected_steps=7, snapshots=())


@pytest.fixture(scope="module")
def report() -> SceneReport:
    """With a run that stopped, one that was not made and one that has no step."""
    whole = scene_report()
    empty = replace(
        made_up("tspline", 0.0, 1.0, 10, 10), steps={n: c[:1] for n, c in made_up("beam", 0, 1, 0, 0).steps.items()}
    )
    more = (
        run(NAME, "NURBS p=3, 978 unknowns", early(made_up("nurbs", 4e-3, 2.1, 978, 56))),
        Run("T-splines", "tspline", replace(empty, snapshots=(), status="stopped: at once")),
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


def rows(page: Section) -> dict[str, RunRow]:
    return {row.entry.label: row for row in page.rows}


def test_a_row_has_the_numbers_of_its_run(page: Section, report: SceneReport) -> None:
    reference = next(one.result for one in report.runs if one.method == "dolfinx")
    base = reference.opening, reference.load
    found = rows(page)
    assert all(row.modelled != "its code knows" for row in found.values()), "of its own methods the page tells"
    for label in (
        "NURBS p=3, 1952 unknowns",
        "Lagrange p=3, 1952 unknowns",
        "cohesive beam",
        "NURBS p=3, 978 unknowns",
    ):
        row, result = found[label], found[label].entry.result
        curve, end = (result.opening, result.load), float(result.opening[-1])
        extent = "" if result.complete else f" up to {quantity(end, 'mm', 3)}"
        assert row.error == percent(curve_error(curve, base, end)) + extent
        assert row.oscillation == percent(oscillation(curve, base, end)["rms"])
        x, P = peak(curve)
        assert (row.peak_opening, row.peak) == (quantity(x, "mm", 3), quantity(P, "N", 4))
        assert row.newton == str(int(4 * (len(result.opening) - 1))) and row.memory == "180 MB"
    assert found["NURBS p=3, 1952 unknowns"].steps == "150"
    assert found["NURBS p=3, 978 unknowns"].steps == "59 + 7 rejected"
    assert found["NURBS p=3, 978 unknowns"].status == "stopped: no convergence"
    assert found["NURBS p=3, 1952 unknowns"].seconds == "8.7\u00a0s" and found["LEFM"].seconds == "–"


def significant(text: str) -> int:
    """How many digits of a number are told, without zeros at its ends."""
    number = re.match(r"[\d.]*", text.replace("\u202f", "").replace("−", ""))[0]
    return len(number.replace(".", "").strip("0"))


def test_tables_tell_no_more_digits_than_mean_something(page: Section) -> None:
    """The most that a column has, which is that of a number that does not end by itself."""
    of_runs = {"peak": 4, "error": 2, "oscillation": 2, "seconds": 2}
    assert {name: max(significant(getattr(row, name)) for row in page.rows) for name in of_runs} == of_runs
    assert all(significant(row.peak_opening) <= 3 and significant(row.memory) <= 3 for row in page.rows)
    names = ("element", "estimate", "elements")
    assert {name: max(significant(getattr(row, name)) for row in page.zones) for name in names} == dict.fromkeys(
        names, 2
    )
    values = [row.value for _, groups in page.checks for group in groups for row in group.rows]
    assert max(map(significant, values)) <= 3


def test_what_is_not_compared_says_why(page: Section, report: SceneReport) -> None:
    found = rows(page)
    assert (found["DOLFINx p=2, 2700 unknowns"].error, found["LEFM"].error) == ("reference", "limit, not compared")
    assert found["DOLFINx p=2, 2700 unknowns"].oscillation == found["LEFM"].oscillation == "–"
    assert found["LEFM"].newton == found["LEFM"].memory == "–"
    for label, why in (("DOLFINx p=3", DOLFINX_MISSING), ("T-splines", "no converged step")):
        assert found[label].status == why and found[label].error == found[label].peak == NO_VALUE
    assert set(page.notes) == {
        f"DOLFINx p=3: {DOLFINX_MISSING}",
        "NURBS p=3, 978 unknowns stopped: no convergence",
        "T-splines stopped: at once",
    }
    alone = replace(report, runs=tuple(one for one in report.runs if one.method in ("nurbs", "lefm")))
    without = section(alone, NAME)
    assert without.reference is None and rows(without)["NURBS p=3, 1952 unknowns"].error == "no reference"
    assert any(note.startswith("No distance between curves") for note in without.notes)


def test_runs_stand_in_one_order_and_the_reference_is_the_finest_whole_one(report: SceneReport) -> None:
    found = entries(report)
    assert [entry.method for entry in found][-1] == "lefm" and [entry.method for entry in found][0] == "dolfinx"
    assert [entry.label for entry in found if entry.is_reference] == ["DOLFINx p=2, 2700 unknowns"]
    assert [entry.repeat for entry in found if entry.method == "nurbs"] == [0, 1]
    finer = run(NAME, "finer", made_up("dolfinx", 4e-4, 11.2, 9000, 112))
    finest = run(NAME, "finest", early(made_up("dolfinx", 4e-4, 11.2, 90_000, 112)))
    (chosen,) = [e for e in entries(replace(report, runs=(*report.runs, finer, finest))) if e.is_reference]
    assert chosen.label == "finer"


def test_figures_are_those_that_the_runs_give(page: Section, report: SceneReport) -> None:
    panels = {one.title: len(one.panels) for one in page.figures}
    assert panels == {
        "Load and opening": 2,
        "Oscillation and J-integral": 2,
        "Traction along the interface": 3,
        "Meshes": 1,
        "Deformed meshes and stress": 1,
        "Energy": 2,
        "Cost": 2,
    }
    assert [one.title for one in page.figures if not one.folded] == ["Load and opening"]
    legends = {one.title: {entry.method for entry in one.legend} for one in page.figures}
    assert legends["Load and opening"] == {"nurbs", "lagrange", "dolfinx", "beam", "lefm"}
    assert legends["Energy"] == legends["Load and opening"] - {"lefm"}
    assert legends["Traction along the interface"] == {"nurbs", "lagrange", "dolfinx"}
    alone = section(replace(report, runs=report.runs[:1]), NAME)
    assert {one.title: len(one.panels) for one in alone.figures}["Oscillation and J-integral"] == 1
    assert {one.title: len(one.panels) for one in alone.figures}["Cost"] == 1
    assert section(replace(report, runs=report.runs[-1:]), NAME).figures == ()


@pytest.mark.parametrize(
    ("value", "tolerance", "used"),
    [(0.5, 1.0, 0.5), (-0.5, 1.0, 0.5), (3.0, 1.0, 1.0), (0.0, 0.0, 0.0), (1e-9, 0.0, 1.0), (np.nan, 1.0, 1.0)],
)
def test_a_check_shows_how_much_of_its_tolerance_it_uses(
    report: SceneReport, value: float, tolerance: float, used: float
) -> None:
    check = Check("j-integral", "nurbs / dolfinx", value, tolerance, "exact", "It holds.")
    runs = tuple(replace(one, result=None) for one in report.runs)  # nothing to draw
    page = section(replace(report, runs=runs, checks=(check,)), NAME)
    ((group,),) = [groups for _, groups in page.checks if groups]
    (row,) = group.rows
    assert row.used == used and page.counts.broken == (not check.passed)
    assert [(word, one is not None) for word, one in row.parts] == [("nurbs", True), ("dolfinx", True)]


def test_checks_of_one_name_stand_together_in_the_order_in_which_they_came(page: Section, report: SceneReport) -> None:
    groups = {tally.kind: [group.name for group in found] for tally, found in page.checks}
    assert groups["exact"] == ["j-integral", "energy-ledger", "interface-force"]
    assert groups["cross-code"] == ["curve"] and groups["analytical"] == ["beam-curve"] and groups["regression"] == []
    ((first, *_),) = [found for tally, found in page.checks if tally.kind == "exact"]
    assert [row.check.subject for row in first.rows] == ["nurbs", "dolfinx"]
    assert {tally.kind: tally.counts.total for tally, _ in page.checks} == {
        "exact": 4, "analytical": 1, "certified": 0, "cross-code": 1, "regression": 0,
    }  # fmt: skip


def lines_of(axes: Axes, style: dict) -> list[np.ndarray]:
    """Points of the lines in one colour and width."""
    same = [
        one for one in axes.lines if one.get_color() == style["color"] and one.get_linewidth() == style["linewidth"]
    ]
    return [np.column_stack(one.get_data()) for one in same if len(one.get_xdata()) > 1]


def curves_of(report: SceneReport) -> list:
    return [entry for entry in entries(report) if entry.agreement is not None]


def test_the_load_of_every_run_is_drawn_to_its_end(report: SceneReport, drawn: Drawn) -> None:
    axes = drawn.axes("Load against opening, all methods")
    for entry in curves_of(report):
        (points,) = lines_of(axes, entry.line.options())
        assert np.array_equal(points, np.column_stack(path(entry.result))), entry.label
    (cross,) = [one for one in axes.lines if len(one.get_xdata()) == 1]
    stopped = next(entry.result for entry in curves_of(report) if not entry.complete)
    assert cross.get_marker() == "x"
    assert (cross.get_xdata()[0], cross.get_ydata()[0]) == (stopped.opening[-1], stopped.load[-1])
    own = max(float(entry.result.load.max()) for entry in curves_of(report) if entry.method != "lefm")
    low, high = axes.get_ylim()
    assert low == 0.0 and own < high <= 1.4 * own and axes.get_xlim()[0] == 0.0
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("opening (mm)", "load (N)")
    assert [t.get_text() for t in axes.texts] == ["LEFM limit"]


def test_a_load_below_zero_is_not_cut_off(report: SceneReport, monkeypatch: pytest.MonkeyPatch) -> None:
    figures, first = Drawn(monkeypatch, curves, cost), report.runs[0]
    pushed = replace(first.result, steps={**first.result.steps, "load": first.result.load - 0.25})
    section(replace(report, runs=(replace(first, result=pushed),)), NAME)
    lowest, least = figures.axes("all methods").get_ylim()[0], float(np.min(pushed.load))
    assert 1.2 * least < lowest < least < -0.24


def test_the_peak_is_in_the_middle_of_its_figure(report: SceneReport, drawn: Drawn) -> None:
    axes = drawn.axes("near the peak")
    tops = [peak((e.result.opening, e.result.load)) for e in curves_of(report) if e.method != "lefm"]
    (left, right), (low, high) = axes.get_xlim(), axes.get_ylim()
    for x, P in tops:
        assert left < x < right and low < P < high and P - low > 2 * (high - P)
    dotted = {one.get_color() for one in axes.lines if one.get_marker() == "."}
    assert dotted == {colour(e.line.colour) for e in curves_of(report) if e.method not in ("lefm", "dolfinx")}


def arcs(result: Result) -> CubicHermiteSpline:
    """The load by cubics through the converged steps with the slopes there, of a run that turns nowhere."""
    return CubicHermiteSpline(*(result.steps[name] for name in ("opening", "load", "load_slope")))


def test_deviations_are_from_the_reference_and_in_per_cent(report: SceneReport, drawn: Drawn) -> None:
    axes = drawn.axes("Oscillation of the load")
    reference = next(entry for entry in curves_of(report) if entry.is_reference)
    for entry in curves_of(report):
        found = lines_of(axes, entry.line.options())
        if entry.is_reference or entry.method == "lefm":
            assert found == []
            continue
        assert len(found) == 1, entry.label
        ((x, off),) = [points.T for points in found]
        ours, theirs = (arcs(one.result)(x) for one in (entry, reference))
        assert off == pytest.approx(100 * (ours / theirs - 1), abs=0.05), entry.label
        assert x[-1] == entry.result.opening[-1] and x[0] > peak((reference.result.opening, reference.result.load))[0]


def polynomial_run(label: str, method: str, P: np.polynomial.Polynomial, end: float, steps: int) -> Run:
    """A run whose load is ``P``; cubic arcs between its steps meet a polynomial of degree 3 everywhere."""
    x = np.linspace(0.0, end, steps + 1)
    unknown = dict.fromkeys(limit().steps, np.full_like(x, np.nan))
    return run(NAME, label, Result(method, {**unknown, "opening": x, "load": P(x), "load_slope": P.deriv()(x)}))


def test_between_steps_that_are_far_apart_curves_and_deviations_are_those_of_the_path(
    report: SceneReport, monkeypatch: pytest.MonkeyPatch
) -> None:
    """P = x (6 - x) and P (1 ± x / 50): off by ±2 x per cent. Chords of these steps would be off by 0.3 % more."""
    P, share = np.polynomial.Polynomial([0.0, 6.0, -1.0]), np.polynomial.Polynomial([0.0, 0.02])
    base = polynomial_run("reference", "dolfinx", P, 5.0, 13)
    above, below = P * (1 + share), P * (1 - share)
    runs = (base, polynomial_run("above", "nurbs", above, 4.5, 18), polynomial_run("below", "beam", below, 5.5, 22))
    reference, *others = entries(replace(report, runs=runs))
    figures = Drawn(monkeypatch, curves)
    curves.load_opening(report.scene, [reference, *others], "load")
    curves.oscillation(report.scene, [reference, *others], reference, "deviation")
    loads, off = figures.axes("Load against opening"), figures.axes("Oscillation of the load")
    for entry, load, sign in ((reference, P, 0), (others[0], above, 1), (others[1], below, -1)):
        (points,) = lines_of(loads, entry.line.options())
        assert points[:, 1] == pytest.approx(load(points[:, 0]), abs=1e-12) and len(points) > 60
        if entry is not reference:
            ((x, per_cent),) = [points.T for points in lines_of(off, entry.line.options())]
            assert per_cent == pytest.approx(sign * 2.0 * x, abs=0.03)
            assert (x[0], x[-1]) == pytest.approx((3.0 * PROPAGATION, min(5.0, entry.result.opening[-1])), rel=0.01)


def test_the_parts_of_the_energy_fill_the_work_of_the_load(report: SceneReport, drawn: Drawn) -> None:
    """Stacked: each begins where the one below ends, the last one ends at the work."""
    axes = drawn.axes("Energies against opening, NURBS p=3, 1952 unknowns")
    result = report.runs[0].result
    names = [one.get_label() for one in axes.collections]
    assert names == ["dissipated", "stored in the interface", "stored in the bodies"]
    x = result.opening
    bounds = [np.zeros(x.size), result.steps["dissipated_energy"]]
    bounds.append(bounds[1] + result.steps["cohesive_energy"])
    bounds.append(bounds[1] + result.steps["stored_energy"])
    for band, low, high in zip(axes.collections, bounds, bounds[1:], strict=False):
        corners = band.get_paths()[0].vertices
        for y in (low, high):
            for at in (20, 75, 149):
                gap = np.abs(corners - (x[at], y[at])).max(axis=1).min()
                assert gap < 1e-12, (band.get_label(), at)
    (work,) = [one for one in axes.lines if one.get_label() == "work of the load"]
    assert np.array_equal(work.get_ydata(), result.steps["external_work"])
    assert axes.get_xlim() == (0.0, 3.0) and axes.get_ylim()[0] == 0.0


def test_what_ledgers_miss_is_relative_to_the_work(report: SceneReport, drawn: Drawn) -> None:
    """The made-up ones lose 1e-5 of what is dissipated; LEFM has none."""
    axes = drawn.axes("Gap of the energy ledger")
    for entry in curves_of(report):
        found = lines_of(axes, entry.line.options())
        if entry.method == "lefm":
            assert found == []
            continue
        ((x, gap),) = [points.T for points in found]
        steps = {name: np.interp(x, entry.result.opening, column) for name, column in entry.result.steps.items()}
        lost = steps["external_work"] - steps["stored_energy"]
        assert gap == pytest.approx(1e-5 * lost / steps["external_work"], rel=1e-6)
    assert axes.get_yscale() == "log" and axes.get_ylim()[1] == 0.1


def test_bars_of_time_are_as_long_as_their_phases(report: SceneReport, drawn: Drawn) -> None:
    axes = drawn.axes("Wall time by phase")
    timed = [entry for entry in curves_of(report) if entry.result.seconds]
    assert len(axes.get_yticks()) == len(timed)
    bars = {}
    for container in axes.containers:
        for entry, bar in zip(timed, container, strict=True):
            bars[entry.label, container.get_label()] = (
                bar.get_x(),
                bar.get_width(),
                bar.get_y() + bar.get_height() / 2,
            )
    for place, entry in enumerate(timed):
        total, end = entry.result.seconds["total"], 0.0
        for phase in (phase for phase in SHOWN_PHASES if (entry.label, phase) in bars):
            start, width, y = bars[entry.label, phase]
            assert start == pytest.approx(end) and y == len(timed) - 1 - place, "the first on top"
            assert width == pytest.approx(entry.result.seconds[phase])
            end = start + width
        assert end == pytest.approx(total)
    ticks = dict(zip(axes.get_yticks(), (t.get_text() for t in axes.get_yticklabels()), strict=True))
    assert ticks[len(timed) - 1] == "DOLFINx" and sum("NURBS p=3" in name for name in ticks.values()) == 2


def test_phases_add_up_to_the_total_that_was_recorded() -> None:
    plain = Result("nurbs", {}, seconds={"mesh": 1.0, "solve": 2.0, "total": 5.0})
    assert cost.total_seconds(plain) == 5.0
    phases = cost.phase_seconds(plain)
    assert (phases["mesh"], phases["solve"], phases["other"]) == (1.0, 2.0, 2.0) and sum(phases.values()) == 5.0
    without = replace(plain, seconds={"mesh": 1.0, "solve": 2.0})
    assert cost.total_seconds(without) == 3.0 and sum(cost.phase_seconds(without).values()) == 3.0
    known = replace(plain, seconds={"mesh": 1.0, "other": 0.5, "total": 5.0})
    assert cost.phase_seconds(known)["other"] == 0.5
    assert np.isnan(cost.total_seconds(replace(plain, seconds={})))


def test_error_and_time_of_every_run_that_has_both(report: SceneReport, drawn: Drawn) -> None:
    axes = drawn.axes("Curve error against time")
    points = {(one.get_xdata()[0], one.get_ydata()[0]) for one in axes.lines}
    judged = [e for e in curves_of(report) if e.agreement.error > 0 and e.result.seconds]
    assert points == {(e.result.seconds["total"], 100 * e.agreement.error) for e in judged} and len(judged) == 4
    names = {t.get_text(): t.xy for t in axes.texts}
    assert names["cohesive beam"][0] == 0.3 if "cohesive beam" in names else len(names) == 4
    assert axes.get_xscale() == axes.get_yscale() == "log"
    assert not [*axes.xaxis.get_minorticklocs(), *axes.yaxis.get_minorticklocs()], "every tick has its number"


def test_j_is_drawn_over_the_toughness_and_enlarged_where_it_has_settled(report: SceneReport, drawn: Drawn) -> None:
    axes = drawn.axes("J-integral over toughness")
    (inset,) = axes.child_axes
    scene, entry = report.scene, next(e for e in curves_of(report) if e.method == "nurbs")
    steps = entry.result.steps
    slopes = np.abs(steps["face_slope_top"]) + np.abs(steps["face_slope_bottom"])
    J = (steps["load"] * slopes / scene.specimen.width - steps["face_energy"]) / scene.interface.toughness
    for where in (axes, inset):
        (points,) = lines_of(where, entry.line.options())
        assert np.array_equal(points, np.column_stack([entry.result.opening, J]))
    (start, end), (low, high) = inset.get_xlim(), inset.get_ylim()
    assert 0.6 < start < 1.0 and end == 3.0 and low < 0.995 and high - 1.0 == pytest.approx(1.5 * (1.0 - low))
    settled = J[entry.result.opening >= start]
    assert np.all((low < settled) & (settled < high))


def test_a_run_without_a_converged_step_has_a_note() -> None:
    run = SimpleNamespace(result=made_up("nurbs", 0.0, 1.0, 100, 10), left_out="")
    entry = SimpleNamespace(label="NURBS", run=run, complete=True, agreement=None, is_reference=False)
    lost = SimpleNamespace(label="beam", run=SimpleNamespace(result=None, left_out=""), is_reference=True)
    assert section_of._notes([entry, lost]) == ["NURBS: there is no converged step to show", "beam: not run"]
    (_, said) = section_of._notes([entry])
    assert said == "No distance between curves: neither the DOLFINx nor the beam curve is complete"
