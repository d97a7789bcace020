"""Studies of other commands on the page of a verification, and the same page in Markdown."""

import json
import re
from dataclasses import replace

import pytest

pytest.importorskip("matplotlib")
pytest.importorskip("jinja2")

import made_up_studies  # noqa: E402
from made_up_runs import ENVIRONMENT, scene_report  # noqa: E402

from verify import report  # noqa: E402
from verify.cli import main  # noqa: E402
from verify.report.studies.included import section  # noqa: E402
from verify.studies.found import found_in, named  # noqa: E402
from verify.support.refusal import Refusal  # noqa: E402


@pytest.fixture
def out(tmp_path):
    made_up_studies.cost(tmp_path / "cost", scene="</script><b>")
    made_up_studies.effects(tmp_path / "effects")
    made_up_studies.hard(tmp_path / "hard")
    made_up_studies.vary(tmp_path / "vary")
    return tmp_path


def bare(given):
    """A report without fields, which take long to draw."""
    runs = tuple(replace(run, result=replace(run.result, snapshots=())) for run in given.runs if run.method != "lefm")
    return replace(given, runs=runs)


def test_studies_are_found_by_what_they_left(out):
    assert [(one.command, one.folder.name) for one in found_in(out)] == [
        ("cost", "cost"), ("effects", "effects"), ("hard", "hard"), ("vary", "vary")
    ]  # fmt: skip
    (out / "cost" / "cost.csv").unlink()
    assert [one.command for one in found_in(out)] == ["effects", "hard", "vary"]


def test_a_folder_without_a_study_is_refused(tmp_path, capsys):
    with pytest.raises(Refusal, match="--include: must be a folder that debond cost, effects, vary or hard has"):
        named([tmp_path])
    assert main(["verify", "dcb-czm1", "--include", str(tmp_path / "none"), "--out", str(tmp_path / "out")]) == 2
    assert "--include: " in capsys.readouterr().err and not (tmp_path / "out").exists()


def test_page_has_chart_effects_and_matrix_and_no_text_becomes_markup(out):
    report.write(report.Findings((bare(scene_report()),), ENVIRONMENT, included=found_in(out)), out / "report.html")
    page = (out / "report.html").read_text()
    data = json.loads(re.search(r'class="rows">(.*?)</script>', page, re.DOTALL)[1])
    assert [row["dofs"] for row in data["rows"]] == [500, 2000, 2700]  # what stopped is no point
    assert "What accuracy costs: &lt;/script&gt;&lt;b&gt;" in page
    assert '<a href="./cost/%3C/script%3E%3Cb%3E/cost/nurbs-p3-500/">NURBS, degree 3</a>' in page
    assert "1.25" in page and "symmetry = true: stopped" in page and "Reference: cubic NURBS, 9000 unknowns" in page
    assert "0 of 1 hard cases hold" in page and "./hard/coarse-czm2/nurbs/base/curve.csv" in page
    assert page.count("takes no part in the verdict") == 4


def test_a_cost_study_without_a_run_that_came_to_its_end_has_no_chart(out):
    header, *_, stopped = (out / "cost" / "cost.csv").read_text().splitlines()
    (out / "cost" / "cost.csv").write_text(f"{header}\n{stopped}\n")
    report.write(report.Findings((), ENVIRONMENT, included=found_in(out)), out / "report.html")
    page = (out / "report.html").read_text()
    assert "Curve error 1%: no run is that accurate." in page and 'class="rows"' not in page


def test_rows_of_the_chart_cannot_end_their_script(out):
    rows = (out / "cost" / "cost.csv").read_text()
    (out / "cost" / "cost.csv").write_text(rows.replace("cost/nurbs-p3-500", "</script><script>alert(1)</script>"))
    report.write(report.Findings((), ENVIRONMENT, included=found_in(out)), out / "report.html")
    page = (out / "report.html").read_text()
    assert "<script>alert" not in page and page.count("<script") == page.count("</script>")
    data = json.loads(re.search(r'class="rows">(.*?)</script>', page, re.DOTALL)[1])
    assert data["rows"][0]["run"] == "</script><script>alert(1)</script>"


@pytest.mark.parametrize("source", ["", "another"])
def test_a_study_of_other_sources_says_so(tmp_path, source):
    (study,) = named([made_up_studies.cost(tmp_path / "cost", source=source)])
    report.write(report.Findings((), ENVIRONMENT, included=[study]), tmp_path / "report.html")
    assert ("solvers have changed" in (tmp_path / "report.html").read_text()) == bool(source)


def test_tables_of_studies_have_their_numbers_on_the_page_and_in_markdown(out):
    by_command = {one.command: section(one, out, one.command) for one in found_in(out)}
    effects, matrix = (by_command[name].tables[0] for name in ("effects", "hard"))
    cells = [[cell.text for cell in row] for row in effects.cells()]
    assert cells[0][:5] == ["contact", "true", "false", "yes", "1 %"] and cells[1] == [
        "symmetry",
        "symmetry = true: stopped",
    ]
    (case,) = matrix.cells()
    assert case[0].text == "coarse-czm2" and {cell.text for cell in case[1:]} == {"✗ broken", "✓ holds"}
    nurbs = next(cell for cell in case if "/nurbs/" in cell.link)
    assert nurbs.link == "./hard/coarse-czm2/nurbs/base/curve.csv" and "40 steps, 2 taken back" in nurbs.below
    report.write(report.Findings((), ENVIRONMENT, included=found_in(out)), out / "report.html", text=True)
    page, text = (out / "report.html").read_text(), (out / "report.md").read_text()
    for table in (effects, matrix):
        assert table.html() in page and table.markdown() in text
