"""Load-opening curves of anybody: whatever is in a file, `compare` and `verify --with` answer with a sentence."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from made_up_runs import ENVIRONMENT, curve, limit, scene_report
from odd_inputs import CURVES, DRAWN, QUIET, answered, few_and_many

from verify import verification
from verify.checks.foreign_curves import joined, read_curves
from verify.curves.read import Reading
from verify.diagnosis import classify
from verify.methods import plugins
from verify.result import Result
from verify.runs.jobs import Job, Outcome
from verify.studies import frame
from verify.support.refusal import Refusal

pytestmark = pytest.mark.filterwarnings("error")

PLAIN = b"opening,load\n0,0\n1,2\n3,1\n"
SCENE = "dcb-czm1-linear"


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A folder to stand in, in which runs are made up and no page is drawn."""
    known = {"nurbs": Result("nurbs", curve(1e-3)), "beam": Result("beam", curve()), "lefm": limit()}

    def found(job: Job) -> Result:
        size = 1.0 + 0.01 * sum(map(ord, job.variant)) / 1000  # every run is another one
        steps = {name: size * column if name == "load" else column for name, column in curve().items()}
        return Result("nurbs", steps, elements=job.solved.discretization.dofs)

    def runs(plan: list[Job], *_: object) -> list[Outcome]:
        return [Outcome(job, known.get(job.method), "" if job.method in known else "not run") for job in plan]

    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(verification, "run_all", runs)
    monkeypatch.setattr(frame, "run", lambda plan, *_: {job: Outcome(job, found(job)) for job in plan})
    monkeypatch.setattr(verification, "write_page", lambda *_: None)
    monkeypatch.setattr(plugins, "entry_points", lambda group: [])  # which all packages are searched for
    return tmp_path


#: No stiffness to speak of; no load over the common part; numbers at the ends of their range.
ENDS = [
    ("opening\tload\n0\t0\n1\t1", "opening\tload\n0\t0\n1\t1d-310\n0\t0\n2\t1"),
    ("opening\tload\n0\t0\n1\t1", "opening\tload\n0\t0\n1\t1d-152\n0\t1"),
    ("opening,load\n0,0\n1,1e308\n2,-1e308\n", "opening,load\n0,0\n5e-324,5e-324\n"),
    ("opening,load\n0,0\n1,1e308\n2,1e308\n", "opening,load\n0,0\n1,1e-308\n2,1e-308\n"),
    ("opening,load\n0,0\n1e200,1e200\n", "opening,load\n0,0\n1e200,1e200\n"),
    ("opening,load\n-1e308,0\n1e308,1e308\n", "opening,load\n0,0\n1,1\n"),
]


@pytest.mark.parametrize(("a", "b"), ENDS)
def test_compare_at_the_ends_of_the_range(a, b, folder, capsys):
    compared(a.encode(), b.encode(), folder, capsys)


def compared(a: bytes, b: bytes, folder: Path, capsys: pytest.CaptureFixture) -> None:
    (folder / "a.csv").write_bytes(a)
    (folder / "b.csv").write_bytes(b)
    code, said = answered(capsys, "compare", "a.csv", "b.csv", "--curve-tol", "0.1", "--peak-tol", "0.1")
    known = (".csv:", " A: ", " B: ", "A and B: ", "A ends at", "begin: ", "curve error ", "peak load differs")
    known += ("distance of the ", " of leg ", "along leg ", "The work that leg ")
    assert code == 0 or any(words in said for words in known), said


def judged(text: bytes, folder: Path, capsys: pytest.CaptureFixture) -> None:
    (folder / "a.csv").write_bytes(text)
    (folder / "out" / "verdict.json").unlink(missing_ok=True)
    code, said = answered(capsys, "verify", SCENE, "--with", "mine=a.csv", "--out", "out")
    assert said.startswith("debond: a.csv") if code == 2 else (folder / "out" / "verdict.json").exists()


def stated(text: bytes, folder: Path, capsys: pytest.CaptureFixture) -> None:
    """A statement, or one that cannot be made, on runs that are made up."""
    (folder / "a.csv").write_bytes(text)
    (folder / "out" / "validation.json").unlink(missing_ok=True)
    words = ["--set", "uncertainty.material.young=0.02", "--set", "uncertainty.data.opening=0.01", "--at", "1,2.5"]
    code, said = answered(capsys, "validate", SCENE, "--with", "mine=a.csv", *words, "--out", "out")
    assert said.startswith("debond: a.csv") if code == 2 else (folder / "out" / "validation.json").exists()


@pytest.fixture
def bare(folder, monkeypatch):
    """Without pages, and without the solutions of a diagnosis, which take a second a curve."""
    monkeypatch.setattr(frame, "write_page", lambda *_: None)
    monkeypatch.setattr(classify.Search, "causes", lambda _: [])
    return folder


def judged_without_diagnosis(text: bytes, bare: Path, capsys: pytest.CaptureFixture) -> None:
    judged(text, bare, capsys)


def stated_without_page(text: bytes, bare: Path, capsys: pytest.CaptureFixture) -> None:
    stated(text, bare, capsys)


test_compare, test_compare_many = few_and_many(compared, a=CURVES, b=CURVES | st.just(PLAIN))
test_verify_with, _ = few_and_many(judged, text=CURVES)
_, test_verify_with_many = few_and_many(judged_without_diagnosis, text=CURVES)
test_validate_with, _ = few_and_many(stated_without_page, text=CURVES)


@given(text=DRAWN)
@example(text=b"opening,load\n0,0\n0.0,0.5\n1.0,1.0\n")  # the load begins with a jump
@settings(max_examples=5, suppress_health_check=QUIET)
def test_the_page_of_a_statement_is_drawn(text, folder, capsys):
    stated(text, folder, capsys)


@pytest.mark.slow
@given(text=DRAWN)
@settings(max_examples=100, suppress_health_check=QUIET)
def test_pages_of_odd_curves(text, tmp_path):
    pytest.importorskip("matplotlib")
    pytest.importorskip("jinja2")
    from verify import report

    (tmp_path / "a.csv").write_bytes(text)
    try:
        curves = read_curves([f"mine={tmp_path / 'a.csv'}"], Reading())
    except Refusal:
        return
    given = scene_report()
    bare = tuple(replace(run, result=replace(run.result, snapshots=())) for run in given.runs)
    report.write(
        report.Findings((joined(replace(given, runs=bare), curves, tmp_path),), ENVIRONMENT), tmp_path / "report.html"
    )


@pytest.mark.parametrize("number", ["1e31", "-1e300", "1.7e308"])
def test_numbers_beyond_all_units_are_no_curve(number, folder, capsys):
    """They overflowed where the page was drawn, when all runs had been made."""
    (folder / "a.csv").write_text(f"opening,load\n0,0\n1,{number}\n2,1\n")
    code, said = answered(capsys, "verify", SCENE, "--with", "a.csv", "--out", "out")
    assert code == 2 and "must hold numbers of a size <= 1e+30, and openings up to 1e-30 or more, got" in said
    assert not (folder / "out").exists()
    (folder / "a.csv").write_text("opening,load\n0,0\n1e-31,1\n2e-31,1\n")
    assert "got openings up to 2e-31" in answered(capsys, "verify", SCENE, "--with", "a.csv", "--out", "out")[1]
