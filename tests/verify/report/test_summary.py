"""What the top of the page says of all scenes, and the same in Markdown."""

from __future__ import annotations

import re
from dataclasses import replace
from types import SimpleNamespace

import pytest

pytest.importorskip("matplotlib")
pytest.importorskip("jinja2")

from made_up_costs import SCENE, a_row, against  # noqa: E402
from made_up_runs import ENVIRONMENT, made_up, run, scene_report  # noqa: E402

from verify.methods.dolfinx import DOLFINX_MISSING, DOLFINX_WAYS  # noqa: E402
from verify.pages.text import percent  # noqa: E402
from verify.report import markdown  # noqa: E402
from verify.report.section import Section, section  # noqa: E402
from verify.report.summary import Summary, summarise
from verify.report.tally import headline  # noqa: E402
from verify.studies.cost.price import Price  # noqa: E402
from verify.verdict import Check, Counts, Run, SceneReport  # noqa: E402

FAILS = Check("j-integral", "lagrange", 0.02, 0.005, "exact", "J is the area under the traction law.")


def early(one: Run) -> Run:
    steps = {name: column[:60] for name, column in one.result.steps.items()}
    return replace(one, result=replace(one.result, steps=steps, status="stopped: here", snapshots=()))


@pytest.fixture(scope="module")
def scenes() -> tuple[Section, ...]:
    """One as it should be; in the other DOLFINx is missing, one run stopped, one has no curve, and a check fails."""
    whole = scene_report("first")
    nurbs, lagrange, _, beam, lefm = (replace(one, result=replace(one.result, snapshots=())) for one in whole.runs)
    coarse = run("second", "Lagrange p=3, 978 unknowns", made_up("lagrange", 2e-2, 5.0, 978, 0))
    empty = replace(nurbs, label="T-spline", method="tspline", folder="second/tspline")
    nothing = replace(empty.result, steps={k: c[:1] for k, c in empty.result.steps.items()}, status="stopped: at once")
    runs = (
        early(nurbs), lagrange, coarse, beam, lefm,
        Run("DOLFINx", "dolfinx", None, DOLFINX_MISSING), replace(empty, result=nothing),
    )  # fmt: skip
    second = replace(scene_report("second"), runs=runs, checks=(*whole.checks[:1], FAILS))
    first = replace(whole, runs=tuple(replace(one, result=replace(one.result, snapshots=())) for one in whole.runs))
    return section(first, "one"), section(second, "two")


@pytest.fixture(scope="module")
def summary(scenes: tuple[Section, ...]) -> Summary:
    return summarise(scenes)


@pytest.mark.parametrize(
    ("counts", "words"),
    [
        ((0, 0, 0, 1), "No check was made on 1 scene"),
        ((0, 0, 0, 0), "No check was made on 0 scenes"),
        ((1, 0, 0, 1), "The one check holds on 1 scene"),
        ((2, 0, 0, 2), "All 2 checks hold on 2 scenes"),
        ((1, 1, 0, 2), "1 broken of 2 checks on 2 scenes"),
        ((2, 2, 1, 1), "2 broken and 1 unresolved of 5 checks on 1 scene"),
    ],
)
def test_the_verdict_is_one_line(counts: tuple[int, ...], words: str) -> None:
    held, broken, unresolved, *places = counts
    assert headline(Counts(held + broken + unresolved, held, broken, unresolved), *places) == words


def test_counts_and_failures_are_of_all_scenes(scenes: tuple[Section, ...], summary: Summary) -> None:
    assert summary.headline == "1 broken of 8 checks on 2 scenes" and summary.tone == "bad"
    assert summary.not_held == (("two", "second", FAILS),)
    assert {t.kind: (t.counts.total, t.counts.broken) for t in summary.tallies} == {
        "exact": (6, 1), "analytical": (1, 0), "certified": (0, 0), "cross-code": (1, 0), "regression": (0, 0),
    }  # fmt: skip
    assert summarise(scenes[:1]).tone == "good" and summarise(()).tone == "none"


def test_the_overview_has_a_column_for_every_method_and_run_of_it(
    scenes: tuple[Section, ...], summary: Summary
) -> None:
    names = {(column.method, column.name) for column in summary.columns}
    methods = [column.method for column in summary.columns]
    assert methods == ["dolfinx", "nurbs", "tspline", "lagrange", "lagrange", "beam", "lefm"]
    assert {name for method, name in names if method == "lagrange"} == {
        "Lagrange p=3, 1952 unknowns", "Lagrange p=3, 978 unknowns",
    }  # fmt: skip
    assert ("dolfinx", "DOLFINx") in names
    (_, one), (_, two) = (
        (row, dict(zip([column.name for column in summary.columns], cells, strict=True))) for row, cells in summary.rows
    )
    assert {name: cell.tone for name, cell in one.items() if cell.tone} == {
        "DOLFINx": "reference", "T-spline": "absent", "Lagrange p=3, 978 unknowns": "absent", "LEFM limit": "limit",
    }  # fmt: skip
    heads = {name: (cell.head, cell.tone) for name, cell in two.items()}
    assert heads["DOLFINx"] == ("not run", "absent") and heads["cohesive beam"] == ("reference", "reference")
    assert heads["T-spline"] == ("no curve", "absent")
    assert heads["LEFM limit"] == ("limit, not compared", "limit")
    errors = {entry.label: percent(entry.agreement.error) for entry in scenes[1].entries if entry.agreement}
    assert heads["NURBS"] == (f"{errors['NURBS p=3, 1952 unknowns']}, stopped", "stopped")
    coarse = two["Lagrange p=3, 978 unknowns"]
    assert (coarse.head, coarse.tail, coarse.run) == (
        errors["Lagrange p=3, 978 unknowns"],
        "5.0\u00a0s, 978 unknowns",
        "lagrange",
    )
    assert two["cohesive beam"].tail == "0.30\u00a0s"


def test_a_sentence_tells_the_worst_scene_of_a_method_and_how_far_it_came(
    scenes: tuple[Section, ...], summary: Summary
) -> None:
    said = {one.text.split(":")[0]: one for one in summary.sentences if ":" in one.text}
    lagrange = {s.anchor: next(e for e in s.entries if e.method == "lagrange") for s in scenes}
    worst = max(lagrange, key=lambda anchor: lagrange[anchor].agreement.error)
    text = said["Lagrange p=3, 1952 unknowns"].text
    assert f"load within {percent(lagrange[worst].agreement.error)} of the reference (DOLFINx or " in text.replace(
        "cohesive beam or DOLFINx", "DOLFINx or cohesive beam"
    )
    assert f"(most on {'first' if worst == 'one' else 'second'})" in text and "over the whole curve" in text
    assert (
        text.endswith("9.4\u00a0s a scene.") and said["Lagrange p=3, 1952 unknowns"].target == f"{worst}-run-lagrange"
    )
    assert "as far as its runs came" in said["NURBS"].text
    only = said["Lagrange p=3, 978 unknowns"].text
    assert "(most on" not in only and f"of {scenes[1].reference.name} over" in only
    assert "the reference of this page" in said["DOLFINx"].text and said["DOLFINx"].target == "one-run-dolfinx"
    assert summary.sentences[-1].text.startswith("LEFM is the limit")
    without = replace(scenes[0].report, runs=scenes[0].report.runs[:2])
    assert not any("LEFM" in one.text for one in summarise((section(without, "one"),)).sentences)


def test_reasons_are_told_once_with_their_scenes(scenes: tuple[Section, ...], summary: Summary) -> None:
    assert f"DOLFINx: {DOLFINX_MISSING} (second)" in summary.missing
    assert "NURBS p=3, 1952 unknowns stopped: here (second)" in summary.missing and summary.ways == DOLFINX_WAYS
    assert summarise(scenes[:1]).missing == () == summarise(scenes[:1]).ways
    twice = summarise((scenes[1], replace(scenes[1], anchor="three")))
    assert f"DOLFINx: {DOLFINX_MISSING} (all scenes)" in twice.missing
    assert len(twice.missing) == len(summarise(scenes[1:]).missing)


def tables(lines: list[str]) -> list[list[list[str]]]:
    """Cells of every Markdown table, its rule left out."""
    found: list[list[list[str]]] = [[]]
    for text in lines:
        if text.startswith("| "):
            found[-1].append([cell.strip() for cell in re.split(r"(?<!\\)\|", text)[1:-1]])
        elif found[-1]:
            found.append([])
    return [[rows[0], *rows[2:]] for rows in found if rows]


def test_markdown_has_the_numbers_of_the_page(scenes: tuple[Section, ...], summary: Summary) -> None:
    lines = markdown.lines(summary, scenes, (), ENVIRONMENT)
    text = "\n".join(lines)
    assert lines[2] == f"**{summary.headline}.**"
    assert "- second: broken: j-integral of lagrange, value 0.02, tolerance 0.005 (exact)" in lines
    assert all(f"- {way}" in text.replace("\\", "") for way in (*summary.missing, *summary.ways))
    overview, kinds, *rest = tables(lines)
    assert overview[0] == ["Scene", *(column.name for column in summary.columns), "Checks"]
    assert [row[-1] for row in overview[1:]] == ["6 of 6 hold", "1 of 2 hold"]
    for row, (_, cells) in zip(overview[1:], summary.rows, strict=True):
        assert row[1:-1] == [", ".join(filter(None, (cell.head, cell.tail))) for cell in cells]
    assert [row[1] for row in kinds[1:]] == ["5 of 6", "1 of 1", "none", "1 of 1", "none"]
    methods = next(rows for rows in rest if rows[0][0] == "Method")
    assert methods[0][1:6] == ["Curve distance", "Oscillation", "Peak load", "at opening", "Unknowns"]
    for cells, row in zip(methods[1:], scenes[0].rows, strict=True):
        dofs = str(row.entry.result.dofs or "–")
        assert cells[1:] == [row.error, row.oscillation, row.peak, row.peak_opening, dofs, row.steps, row.seconds]
    second = [rows for rows in rest if rows[0][0] == "Method"][1]
    missing = next(cells for cells in second if cells[0] == "DOLFINx")
    assert missing[1:] == [DOLFINX_MISSING, *[""] * 6]
    judged = [rows for rows in rest if rows[0][0] == "Kind"]
    assert [len(rows) - 1 for rows in judged] == [6, 2]
    assert judged[1][2][2:] == ["[lagrange](<./second/lagrange/>)", "0.02", "0.005", "✗ **broken**"]
    assert judged[0][1][-1] == "✓ holds"
    assert tables(lines)[-1][1:] == [[name, value] for name, value in ENVIRONMENT.items()]


def test_markdown_begins_with_the_price(scenes: tuple[Section, ...]) -> None:
    price = Price(SCENE, against(), (a_row("nurbs", 0.002, 0.2, 432, 2), a_row("dolfinx", 0.002, 0.8, 756, 2)))
    lines = markdown.lines(summarise(scenes, (price,)), scenes, (), {})
    assert lines[4] == f"**What accuracy costs.** {price.sentence}" and "4 × as long" in lines[4]


def test_markdown_lines_repeat_every_run(scenes: tuple[Section, ...], summary: Summary) -> None:
    keyed = replace(scenes[0].report.runs[0], key="0123abcd")
    one = section(replace(scenes[0].report, runs=(keyed, replace(keyed, folder="", command="", key=""))), "one")
    repeated = [text for text in markdown.lines(summary, (one,), (), {}) if text.startswith("- NURBS p=3")]
    whole = next(text for text in repeated if "hash" in text)
    assert whole.endswith(f"[first/nurbs](<./first/nurbs/>); hash `0123abcd`; `{keyed.command}`")
    assert any(text.endswith(": complete") for text in repeated)


def included(**changes: object) -> SimpleNamespace:
    plain = {
        "title": "Cost", "command": "cost", "has_page": False, "outdated": False, "prefix": "cost", "lead": ("It is.",),
        "pairs": (), "hard": (), "bases": {},
    }  # fmt: skip
    return SimpleNamespace(**plain | changes)


def test_markdown_of_a_study_tells_its_page_and_its_age(summary: Summary) -> None:
    def said(**changes: object) -> list[str]:
        return markdown.lines(summary, (), (included(**changes),), {})

    link, age = "[Its own page](<./cost/report.html>)", "The solvers have changed since this study was made."
    assert link not in said() and age not in said() and "- It is." in said()
    assert link in said(has_page=True) and age not in said(has_page=True)
    assert age in said(outdated=True) and link not in said(outdated=True)

    def cell(basis: str, passed: bool | None) -> tuple[SimpleNamespace, str]:
        verdict = SimpleNamespace(runs=(SimpleNamespace(seconds=1.5), SimpleNamespace(seconds=2.0)))
        return SimpleNamespace(
            basis=basis, verdict=None if passed is None else verdict, passed=passed, why="signal 9"
        ), ""

    case = SimpleNamespace(
        case=SimpleNamespace(name="slender"), cells=(cell("a", True), cell("b", False), cell("c", None))
    )
    bases = {"a": "A", "b": "B", "c": "C", "d": "D"}
    (rows,) = [rows for rows in tables(said(hard=(case,), bases=bases)) if rows[0][0] == "Case"]
    assert rows == [["Case", *"ABCD"], ["slender", "✓ holds, 3.5\u00a0s", "✗ **broken**, 3.5\u00a0s", "signal 9", "–"]]


def test_without_a_reference_no_distance_is_told() -> None:
    report = scene_report()
    alone = SceneReport(report.scene, tuple(one for one in report.runs if one.method in ("nurbs", "lefm")), ())
    found = summarise((section(alone, "one"),))
    ((_, cells),) = found.rows
    assert [cell.head for cell in cells] == ["no reference", "limit, not compared"]
    assert not any("load within" in one.text for one in found.sentences)
