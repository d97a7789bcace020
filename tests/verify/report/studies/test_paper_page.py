"""Pages of the paper's figures: what stands in their tables and curves is what the runs have."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest

pytest.importorskip("matplotlib")
pytest.importorskip("jinja2")

from figures import Drawn  # noqa: E402
from matplotlib.axes import Axes  # noqa: E402
from matplotlib.colors import to_hex  # noqa: E402

from tests.verify.studies.paper import test_figure9 as nine  # noqa: E402
from tests.verify.studies.paper.test_paper import as_stated, stopped_in, world  # noqa: E402
from verify.curves.curve import envelope  # noqa: E402
from verify.methods.names import METHODS  # noqa: E402
from verify.pages.style import METHOD_NAMES, colour, line  # noqa: E402
from verify.report.studies import paper, paper_figures  # noqa: E402
from verify.scene.load import load_scene  # noqa: E402
from verify.studies.paper.plan import BEAMS, BONDS, PAPER_LAWS, Case  # noqa: E402
from verify.studies.paper.study import Study, Trial  # noqa: E402

STOPPED = Case("nurbs", "dcb-czm2", 280)
NEVER_RUN = Case("lagrange", "dcb-czm1", 280, 8)


def told(text: str) -> float:
    """The number of a cell, of one in per cent as a fraction."""
    value = float(text.replace("\u00a0", " ").replace("\u202f", "").replace("−", "-").split()[0])
    return value / 100 if text.endswith("%") else value


@pytest.fixture
def study() -> Study:
    """One run stopped, one was never made, and one left nothing."""
    whole = stopped_in(world(), STOPPED)
    empty = Case("tspline", "dcb-czm1", 1956, 8, 1e3)
    trials = [t for t in whole.trials if t.case != NEVER_RUN]
    return replace(
        whole, trials=tuple(Trial(empty, None, "failed: signal 9") if t.case == empty else t for t in trials)
    )


@pytest.mark.parametrize("measure", ["error", "oscillation"])
def test_a_cell_has_what_its_run_has(study: Study, measure: str) -> None:
    section = paper.section(study, "figures")
    table = section.tables[list(paper.TABLE_TITLES).index(measure)]
    assert table.heading == f"{paper.TABLE_TITLES[measure]} by number of interface points"
    laws = {f"{PAPER_LAWS[law]}, {dofs} unknowns": (law, dofs) for law in PAPER_LAWS for dofs in (280, 1956)}
    seen = set()
    assert set(dict(table.groups)) == set(laws)
    assert [head.name for head in table.heads] == ["Basis", "Penalty", "2 points", "8 points"]
    for name, rows in table.groups:
        for row in rows:
            (basis,) = [name for name in METHODS if METHOD_NAMES[name] == row.head.name]
            assert row.head.line == line(basis)
            (penalty, _), *cells = row.cells
            for points, (text, lost) in zip((2, 8), cells, strict=True):
                case = Case(basis, *laws[name], points, 1e3 if penalty == "1000" else 1e5)
                trial, _ = study.trial(case), seen.add(case)
                if trial is None:
                    assert (case, text, lost) == (NEVER_RUN, "–", False)
                elif trial.complete:
                    assert told(text) == pytest.approx(as_stated(case)[measure], rel=0.05) and not lost
                else:
                    assert lost and text == ("stopped" if case == STOPPED else "no curve")
    assert len(seen) == 48


def test_a_row_of_all_runs_has_measures_sizes_and_time(study: Study) -> None:
    section = paper.section(study, "figures")
    ((_, rows),) = section.runs.groups
    assert len(rows) == len(study.trials) == 47 and len(section.runs.heads) == 10
    assert "45 of 47 runs came to their end" in section.lead and len(section.stopped) == 2
    for row, trial in zip(rows, study.trials, strict=True):
        assert row.head.folder == f"{trial.case.scene}/{trial.case.variant}"
        assert row.head.name.startswith(f"{PAPER_LAWS[trial.case.scene]}, {trial.case.dofs} unknowns")
        assert (", penalty 1000" in row.head.name) == (trial.case.penalty == 1e3)
        *measures, dofs, steps, taken_back, time, status = (text for text, _ in row.cells)
        assert status == trial.status
        values = (trial.error, trial.oscillation, trial.variation, trial.peak)
        for text, value in zip(measures, values, strict=True):
            assert text == "–" if np.isnan(value) else told(text) == pytest.approx(value, rel=0.05)
        if trial.result is None:
            assert (dofs, steps, taken_back, time) == ("–",) * 4
        else:
            assert (dofs, steps, taken_back) == ("280", "150", "0") and told(time) == 2.5


def test_the_example_repeats_the_first_run(study: Study) -> None:
    words = paper.section(study, "figures").example.split()
    case, overrides = study.trials[0].case, [b for a, b in zip(words, words[1:], strict=False) if a == "--set"]
    assert words[:5] == ["debond", "solve", case.scene, "--method", case.basis]
    scene = load_scene(case.scene, overrides)
    assert (scene.discretization.dofs, scene.discretization.interface_points) == (case.dofs, case.points)
    assert scene.interface.penalty == case.penalty


def test_a_problem_without_a_converged_curve_is_told(study: Study) -> None:
    """Its runs were measured against nothing."""
    known = {problem: one for problem, one in study.references.items() if problem != ("dcb-czm2", 1e3)}
    unknown = {"error": np.nan, "oscillation": np.nan, "variation": np.nan, "peak": np.nan}
    trials = tuple(t if t.case.problem in known else replace(t, **unknown) for t in study.trials)
    lines = paper.section(replace(study, references=known, trials=trials), "figures").references
    without = [text for text in lines if "no converged curve" in text]
    assert len(lines) == 4 and len(without) == 1 and without[0].startswith("CZM 2, penalty 1000: ")
    assert all("a coarser mesh is 0.0010\u00a0% from it" in text for text in lines if text not in without)


def of_colour(axes: Axes, ink: str) -> list[np.ndarray]:
    """Points (n, 2) of the lines in one colour, single marks left out."""
    return [
        np.column_stack(one.get_data()) for one in axes.lines if one.get_color() == ink and len(one.get_xdata()) > 1
    ]


def test_curves_are_paths_envelopes_limit_and_converged_curve(study: Study, monkeypatch: pytest.MonkeyPatch) -> None:
    drawn = Drawn(monkeypatch, paper_figures)
    groups = paper_figures.figures(study, "figures")
    assert [len(group.panels) for group in groups] == [6, 6, 2, 6, 4]
    axes = drawn.axes(f"Load against opening, {METHOD_NAMES['nurbs']}, CZM 2, 280 unknowns")
    result = study.trial(STOPPED).result
    path, under_control = of_colour(axes, colour(line("nurbs").colour))
    assert np.array_equal(path, np.column_stack([result.opening, result.load]))
    assert np.array_equal(under_control, np.column_stack(envelope(result.opening, result.load)))
    (cross,) = [one for one in axes.lines if len(one.get_xdata()) == 1]
    assert cross.get_marker() == "x" and (cross.get_xdata()[0], cross.get_ydata()[0]) == tuple(path[-1])
    (converged,) = of_colour(axes, colour("muted"))
    reference = study.references[STOPPED.problem].result
    assert np.array_equal(converged, np.column_stack([reference.opening, reference.load]))
    (limit,) = of_colour(axes, colour(line("lefm").colour))
    assert np.array_equal(limit, np.column_stack(study.limits["dcb-czm2"]))
    whole = drawn.axes(f"Load against opening, {METHOD_NAMES['nurbs']}, CZM 1, 280 unknowns")
    assert all(len(one.get_xdata()) > 1 for one in whole.lines), "a cross where nothing stopped"


def test_the_same_axes_hold_every_curve_of_a_law_and_mesh(study: Study, monkeypatch: pytest.MonkeyPatch) -> None:
    drawn = Drawn(monkeypatch, paper_figures)
    paper_figures.figures(study, "figures")
    frames = {}
    for title, figure in drawn:
        if title.startswith("Load against opening, "):
            law_and_mesh = title.split(", ", 2)[2]
            (axes,) = figure.axes
            frames.setdefault(law_and_mesh, set()).add((axes.get_xlim(), axes.get_ylim()))
            highest = max(float(np.max(one.get_ydata())) for one in axes.lines)
            assert axes.get_xlim() == (0.0, 3.0) and axes.get_ylim()[0] <= 0.0 and highest < axes.get_ylim()[1]
            assert axes.get_xlabel() == "opening (mm)" and axes.get_ylabel() == "load (N)"
    assert len(frames) == 4 and all(len(frame) == 1 for frame in frames.values())


def test_deviations_are_bumps_of_the_runs(monkeypatch: pytest.MonkeyPatch) -> None:
    """Every curve of the made-up world is off the true one by a constant factor, and so is the converged one."""
    study, drawn = world(), Drawn(monkeypatch, paper_figures)
    paper_figures.figures(study, "figures")
    axes = drawn.axes("Deviation of the load from the converged curve, CZM 1, 1956 unknowns")
    reference = as_stated(Case("tspline", "dcb-czm1", 1956, 8))["bump"]
    for basis in ("tspline", "nurbs", "lagrange"):
        ((x, off),) = [np.transpose(points) for points in of_colour(axes, colour(line(basis).colour))]
        bump = as_stated(Case(basis, "dcb-czm1", 1956))["bump"]
        assert off == pytest.approx(100 * ((1 + bump) / (1 + reference) - 1), abs=1e-9) and x[-1] == 3.0
    (band,) = axes.patches
    ends = band.get_window_extent().transformed(axes.transData.inverted())
    assert (ends.y0, ends.y1) == pytest.approx((-1e-3, 1e-3), rel=1e-6)


@pytest.mark.parametrize("measure", ["error", "oscillation"])
def test_measures_are_drawn_over_the_number_of_points(
    study: Study, measure: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    drawn = Drawn(monkeypatch, paper_figures)
    paper_figures.figures(study, "figures")
    words = {"error": "curve distance (%) against", "oscillation": "oscillation (%) against"}[measure]
    (axes,) = [figure.axes[0] for title, figure in drawn if words in title and title.endswith("CZM 1")]
    for basis in ("tspline", "nurbs", "lagrange"):
        lines = [one for one in axes.lines if to_hex(one.get_color()) == to_hex(colour(line(basis).colour))]
        assert [one.get_label() == METHOD_NAMES[basis] for one in lines] == [True, False], "the finer mesh first, named"
        assert [one.is_dashed() for one in lines] == [False, True]
        for one, dofs in zip(lines, (1956, 280), strict=True):
            trials = [study.trial(Case(basis, "dcb-czm1", dofs, points)) for points in (2, 8)]
            values = [100 * getattr(t, measure) if t else np.nan for t in trials]
            assert list(one.get_xdata()) == [2, 8] and np.allclose(one.get_ydata(), values, equal_nan=True)
    assert axes.get_yscale() == "log"
    highest = max(float(np.nanmax(one.get_ydata())) for one in axes.lines)
    top = axes.transAxes.inverted().transform(axes.transData.transform((2.0, highest)))[1]
    assert 0.75 < top < 0.9, "above it there is room for the names"


def test_a_sweep_is_stronger_with_more_points(study: Study, monkeypatch: pytest.MonkeyPatch) -> None:
    drawn = Drawn(monkeypatch, paper_figures)
    paper_figures.figures(study, "figures")
    axes = drawn.axes(f"by number of interface points, {METHOD_NAMES['tspline']}, CZM 1")
    ours = [one for one in axes.lines if one.get_color() == colour(line("tspline").colour)]
    assert [one.get_label() for one in ours] == ["2 points", "8 points"]
    assert [one.get_alpha() for one in ours] == sorted(one.get_alpha() for one in ours) and ours[-1].get_alpha() == 1.0
    once = drawn.axes(f"by number of interface points, {METHOD_NAMES['lagrange']}, CZM 1")
    assert [one.get_label() for one in once.lines if "points" in str(one.get_label())] == ["2 points"]


def test_what_stands_below_a_panel_is_what_its_run_has(study: Study, monkeypatch: pytest.MonkeyPatch) -> None:
    Drawn(monkeypatch, paper_figures)
    lost = replace(study, trials=tuple(t for t in study.trials if t.case != Case("nurbs", "dcb-czm1", 280)))
    captions = {one.caption for one in paper_figures.figures(lost, "figures")[0].panels}
    assert f"{METHOD_NAMES['nurbs']}, CZM 1. Not run." in captions
    assert f"{METHOD_NAMES['nurbs']}, CZM 2. Stopped: no step is small enough." in captions
    expected = as_stated(Case("tspline", "dcb-czm1", 280))
    (text,) = [c for c in captions if c.startswith(f"{METHOD_NAMES['tspline']}, CZM 1.")]
    error, wave = (told(one) for one in re.findall(r"[\d.]+\u00a0%", text))
    assert (error, wave) == pytest.approx((expected["error"], expected["oscillation"]), rel=0.05)


def test_a_table_of_bonds_has_what_the_runs_have() -> None:
    study = nine.world()
    stopped = Trial(Case("nurbs", "peel-80"), nine.made_up("peel-80", status="stopped: at once"), "stopped: at once")
    trials = [stopped if t.case == stopped.case else t for t in study.trials]
    trials = [t for t in trials if t.case != Case("lagrange", "peel-60")]
    study = replace(
        study, trials=tuple(trials), references={b: r for b, r in study.references.items() if b != ("peel-100", None)}
    )
    section = paper.section(study, "nine")
    (table,) = section.tables
    tables = {title: {row.head.name: row.cells for row in rows} for title, rows in table.groups}
    assert [head.name for head in table.heads] == ["Bond", *(METHOD_NAMES[b] for b in nine.BASES), "Converged"]
    assert section.stopped == (f"{METHOD_NAMES['nurbs']}, 80\u00a0mm: stopped: at once",)
    assert "10 of 11 runs came to their end" in section.lead
    known = [text for text in section.references if "no converged curve" not in text]
    assert len(known) == 3 and all("Bond 100" not in text for text in known)
    expected = {
        "Curve distance": lambda basis, bond: nine.SIZE.get(basis, 1e-5),
        "Oscillation on the propagation branch": lambda basis, bond: nine.SIZE.get(basis, 1e-5),
        "Peak load": lambda basis, bond: float(np.max(nine.made_up(bond).load)),
        "Elements in the process zone": lambda basis, bond: 4.0 if basis else np.nan,
        "Wall time": lambda basis, bond: 25.0,
    }
    for title, value in expected.items():
        for bond in BONDS:
            cells = tables[title][f"{int(bond.removeprefix('peel-'))}\u00a0mm"]
            for basis, (text, lost) in zip((*nine.BASES, ""), cells, strict=True):
                if (basis, bond) == ("nurbs", "peel-80"):
                    assert (text, lost) == ("stopped", True)
                elif (basis, bond) in (("lagrange", "peel-60"), ("", "peel-100")) or np.isnan(value(basis, bond)):
                    assert (text, lost) == ("–", False)
                else:
                    assert told(text) == pytest.approx(value(basis, bond), rel=0.05) and not lost, (title, bond, basis)
    steps = tables["Steps, and steps taken back"]["60\u00a0mm"]
    assert [text for text, _ in steps] == ["650, 0", "650, 0", "–", "650, 0"]


def test_figure_9_names_every_bond_at_its_peak(monkeypatch: pytest.MonkeyPatch) -> None:
    study, drawn = nine.world(), Drawn(monkeypatch, paper_figures)
    groups = paper_figures.figures(study, "nine")
    assert [len(group.panels) for group in groups] == [3, 4]
    axes = drawn.axes(f"by bond length, {METHOD_NAMES['nurbs']}")
    names = {t.get_text(): t.xy for t in axes.texts}
    for bond in BONDS:
        result = nine.made_up(bond)
        top = int(np.argmax(result.load))
        assert names[f"{bond.removeprefix('peel-')}\u00a0mm"] == pytest.approx(
            (result.opening[top], result.load[top]), rel=1e-2
        )
    assert len(of_colour(axes, colour("muted"))) == len(of_colour(axes, colour(line("lefm").colour))) == 4
    assert len(of_colour(axes, colour(line("nurbs").colour))) == 8
    highest = max(float(np.max(one.get_ydata())) for one in axes.lines)
    assert axes.get_ylim()[0] == 0.0 and highest <= axes.get_ylim()[1] <= 1.2 * highest
    assert axes.get_xlim() == (0.0, max(max(scene.load.opening) for scene in nine.SCENES.values()))
    caption = groups[0].panels[1].caption
    assert caption.count("0.30\u00a0%") == 2 and caption.startswith(METHOD_NAMES["nurbs"])


def test_without_runs_there_is_nothing_but_the_reason() -> None:
    empty = Study(BEAMS, {}, (), {}, {}, {})
    found = paper.section(empty, "figures")
    assert found.left_out and found.figures == () == found.tables and (found.runs, found.example) == (None, "")


def test_below_figure_9_nothing_is_told_of_runs_that_are_none(monkeypatch: pytest.MonkeyPatch) -> None:
    whole = nine.world()
    Drawn(monkeypatch, paper_figures)
    others = tuple(t for t in whole.trials if t.case.basis != "nurbs")
    unknown = tuple(replace(t, error=np.nan) for t in whole.trials if t.case.basis == "nurbs")
    case = Case("nurbs", "peel-80")
    stopped = Trial(case, nine.made_up(case.scene, status="stopped: at once"), "stopped: at once")
    for trials in ((*others, stopped), others + unknown):
        panels = paper_figures.figures(replace(whole, trials=trials), "nine")[0].panels
        told = {panel.caption.split(".")[0]: panel.caption for panel in panels}
        assert told[METHOD_NAMES["nurbs"]] == f"{METHOD_NAMES['nurbs']}. "
        assert "from the converged curves, oscillation" in told[METHOD_NAMES["tspline"]]


def test_deviations_of_figure_9_are_those_of_its_runs(monkeypatch: pytest.MonkeyPatch) -> None:
    """Over the whole programme, in per cent, of every basis, and about the uncertainty of what is converged."""
    bumps = {"tspline": 0.001, "nurbs": -0.003, "lagrange": 0.006}
    study = nine.world(lambda case: {"bump": bumps[case.basis]})
    drawn = Drawn(monkeypatch, paper_figures)
    panels = paper_figures.figures(study, "nine")[1].panels
    assert [panel.caption for panel in panels] == [f"Bond {bond.removeprefix('peel-')}\u00a0mm." for bond in BONDS]
    for bond in BONDS:
        axes = drawn.axes(f"Deviation of the load from the converged curve, {bond}")
        for basis, bump in bumps.items():
            ((x, off),) = [np.transpose(points) for points in of_colour(axes, colour(line(basis).colour))]
            assert off == pytest.approx(100 * bump, abs=1e-6) and x[-1] == pytest.approx(6.5)
        assert axes.get_xlabel() == "displacement (mm)" and len(axes.patches) == 1


def test_groups_of_figures_say_what_they_show(study: Study, monkeypatch: pytest.MonkeyPatch) -> None:
    Drawn(monkeypatch, paper_figures)
    groups = paper_figures.figures(study, "figures")
    assert [group.title for group in groups] == [
        "Figure 6: load against opening with 280 unknowns",
        "Figure 7: load against opening with 1956 unknowns",
        "Apart from the converged curve with 1956 unknowns",
        "Figure 8: 2 to 8 interface points, 280 unknowns",
        "Error and oscillation against the number of points",
    ]
    assert [len(group.panels) for group in groups] == [6, 6, 2, 6, 4]
    assert all(group.note.endswith(".") for group in groups)
