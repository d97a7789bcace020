"""What the top of the page says of all scenes, and the same in Markdown."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

pytest.importorskip("matplotlib")
pytest.importorskip("jinja2")

from made_up_runs import ENVIRONMENT, made_up, run, scene_report  # noqa: E402

from verify import report  # noqa: E402
from verify.methods.dolfinx import DOLFINX_MISSING, DOLFINX_WAYS  # noqa: E402
from verify.pages.table import Table  # noqa: E402
from verify.pages.text import percent  # noqa: E402
from verify.report.section import Section, section  # noqa: E402
from verify.report.summary import Summary, summarise
from verify.report.tally import headline  # noqa: E402
from verify.verdict import Check, Counts, Run, SceneReport  # noqa: E402

FAILS = Check("j-integral", "lagrange", 0.02, 0.005, "exact", "J is the area under the traction law.")


def bare(given: SceneReport) -> SceneReport:
    """Without fields, which take long to draw."""
    runs = (replace(one, result=replace(one.result, snapshots=())) for one in given.runs)
    return replace(given, runs=tuple(runs))


def reports() -> tuple[SceneReport, SceneReport]:
    """One as it should be; in the other DOLFINx is missing, one run stopped, one has no curve, and a check fails."""
    first, second = bare(scene_report("first")), bare(scene_report("second"))
    nurbs, lagrange, _, beam, lefm = second.runs
    coarse = run("second", "Lagrange p=3, 978 unknowns", made_up("lagrange", 2e-2, 5.0, 978, 0))
    early, nothing = (
        replace(nurbs.result, steps={k: c[:rows] for k, c in nurbs.result.steps.items()}, status=f"stopped: {where}")
        for rows, where in ((60, "here"), (1, "at once"))
    )
    empty = replace(nurbs, label="T-spline", method="tspline", folder="second/tspline", result=nothing)
    missing = Run("DOLFINx", "dolfinx", None, DOLFINX_MISSING)
    runs = (replace(nurbs, result=early), lagrange, coarse, beam, lefm, missing, empty)
    return first, replace(second, runs=runs, checks=(*second.checks[:1], FAILS))


@pytest.fixture(scope="module")
def scenes() -> tuple[Section, ...]:
    return tuple(section(one, anchor) for one, anchor in zip(reports(), ("one", "two"), strict=True))


@pytest.fixture(scope="module")
def summary(scenes: tuple[Section, ...]) -> Summary:
    return summarise(scenes)


def texts(table: Table) -> list[list[str]]:
    return [[cell.text.replace("\u00a0", " ") for cell in row] for row in table.cells()]


@pytest.mark.parametrize(
    ("counts", "words"),
    [
        ((0, 0, 0, 1), "No check was made on 1 scene"),
        ((0, 0, 0, 0), "No check was made on 0 scenes"),
        ((1, 0, 0, 1), "The one check holds on 1 scene"),
        ((2, 0, 0, 2), "All 2 checks hold on 2 scenes"),
        ((2, 2, 1, 1), "2 broken and 1 unresolved of 5 checks on 1 scene"),
    ],
)
def test_the_verdict_is_one_line(counts: tuple[int, ...], words: str) -> None:
    held, broken, unresolved, *places = counts
    assert headline(Counts(held + broken + unresolved, held, broken, unresolved), *places) == words


def test_counts_and_failures_are_of_all_scenes(scenes, summary: Summary) -> None:
    assert summary.headline == "1 broken of 8 checks on 2 scenes" and summary.tone == "bad"
    lost = ["✗ broken", "second", "j-integral", "lagrange", "0.02", "0.005", "exact"]
    assert texts(summary.not_held) == [lost] and summary.not_held.cells()[0][1].link == "#two-checks"
    held = {
        "exact": "5 of 6",
        "analytical": "1 of 1",
        "certified": "none",
        "cross-code": "1 of 1",
        "regression": "none",
    }
    assert {row[0]: row[1] for row in texts(summary.kinds)} == held
    assert summarise(scenes[:1]).tone == "good" and summarise(()).tone == "none"


def test_the_overview_has_a_column_for_every_run_of_a_method(scenes: tuple[Section, ...], summary: Summary) -> None:
    titles = [getattr(column.title, "text", column.title) for column in summary.overview.columns]
    assert titles == [
        "Scene", "DOLFINx", "NURBS", "T-spline", "Lagrange p=3, 1952 unknowns", "Lagrange p=3, 978 unknowns",
        "cohesive beam", "LEFM limit", "Checks",
    ]  # fmt: skip
    first, second = summary.overview.cells()
    of = {title: (a, b) for title, a, b in zip(titles, first, second, strict=True)}
    errors = {(i, e.label): e.agreement.error for i, s in enumerate(scenes) for e in s.entries if e.agreement}
    assert (of["DOLFINx"][0].text, of["DOLFINx"][1].text) == ("reference", DOLFINX_MISSING)
    assert of["NURBS"][0].text == percent(errors[0, "NURBS p=3, 1952 unknowns"]) and of["NURBS"][0].tone == ""
    assert of["NURBS"][1].text == f"{percent(errors[1, 'NURBS p=3, 1952 unknowns'])}, stopped"
    assert of["NURBS"][1].tone == "bad", "a number of a part of the curve is seen to be one"
    assert (of["T-spline"][0].text, of["T-spline"][1].text) == ("–", "no step")
    assert of["Lagrange p=3, 978 unknowns"][0].text == "–" and of["LEFM limit"][0].text == "limit, not compared"
    assert of["NURBS"][0].below.replace("\u00a0", " ") == "8.7 s, 1952 unknowns"
    assert of["NURBS"][0].link == "#one-run-nurbs" and of["Scene"][1].link == "#two"
    assert [(cell.text, cell.below) for cell in of["Checks"]] == [("✓ holds", "6 of 6"), ("✗ broken", "1 of 2")]


def test_a_sentence_tells_the_worst_scene_of_a_method_and_how_far_it_came(scenes, summary: Summary) -> None:
    said = {one.text.split(":")[0]: one for one in summary.sentences if ":" in one.text}
    lagrange = {s.report.scene.name: next(e for e in s.entries if e.method == "lagrange") for s in scenes}
    worst = max(lagrange, key=lambda name: lagrange[name].agreement.error)
    text = said["Lagrange p=3, 1952 unknowns"].text
    assert f"load within {percent(lagrange[worst].agreement.error)} of the reference (" in text
    assert f"(most on {worst}); 9.4\u00a0s a scene." in text and "over the whole curve" in text
    assert "as far as its runs came" in said["NURBS"].text
    assert "the reference of this page" in said["DOLFINx"].text and said["DOLFINx"].link == "#one-run-dolfinx"
    assert summary.sentences[-1].text.startswith("LEFM is the limit")


def test_reasons_are_told_once_with_their_scenes(scenes: tuple[Section, ...], summary: Summary) -> None:
    assert f"DOLFINx: {DOLFINX_MISSING} (second)" in summary.missing and summary.ways == DOLFINX_WAYS
    assert "NURBS p=3, 1952 unknowns stopped: here (second)" in summary.missing
    assert summarise(scenes[:1]).missing == () == summarise(scenes[:1]).ways
    twice = summarise((scenes[1], replace(scenes[1], anchor="three")))
    assert f"DOLFINx: {DOLFINX_MISSING} (all scenes)" in twice.missing


def test_without_a_reference_no_distance_is_told() -> None:
    given = bare(scene_report())
    alone = SceneReport(given.scene, tuple(one for one in given.runs if one.method in ("nurbs", "lefm")), ())
    found = summarise((section(alone, "one"),))
    assert texts(found.overview)[0][1:] == ["no reference", "limit, not compared", "none"]
    assert not any("load within" in one.text for one in found.sentences)


def test_the_page_and_markdown_have_every_table(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Written by one object each, so that cells are equal; here that none is left out of either."""
    made: list[Table] = []
    monkeypatch.setattr(Table, "html", lambda table, html=Table.html: made.append(table) or html(table))
    report.write(report.Findings(reports(), ENVIRONMENT), tmp_path / "report.html", text=True)
    text = (tmp_path / "report.md").read_text()
    inputs = {"specimen", "material", "interface", "isogeometric mesh", "DOLFINx mesh"}
    told = [table for table in made if table.caption not in inputs]
    assert len(told) == 3 + 2 * 5 + 1, "at the top; methods, zones, toughness, checks, runs of each; at the end"
    for table in told:
        assert table.markdown() in text, table.caption
    assert "**1 broken of 8 checks on 2 scenes.**" in text and all(f"- {way[:20]}" in text for way in DOLFINX_WAYS)
