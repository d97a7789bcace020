"""Methods of other packages: found by their entry points, run like the others, and when broken no more than a row."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from verify import verification
from verify.cli import main
from verify.methods import names, plugins
from verify.methods.method import Failure
from verify.methods.plugins import known_methods
from verify.methods.solve import solve
from verify.result import Result
from verify.runs.fingerprint import fingerprint
from verify.runs.folder import read_columns, read_result
from verify.runs.jobs import left_out
from verify.scene.load import load_scene
from verify.studies.one_scene import planned
from verify.support.refusal import NotRun
from verify.verification import Subjects, verify

LINEAR = "dcb-czm1-linear"
PROJECT = Path(__file__).resolve().parents[3]

MODULE = """
import numpy as np
from verify.methods.solve import solve as debond
from verify.result import Result

def curve(scene, factor=1.0):
    found = debond(scene, "beam")
    return {"opening": found.opening, "load": factor * found.load}

def good(scene, on_step):
    steps = curve(scene)
    for opening, load in zip(*steps.values()):
        on_step({"opening": opening, "load": load})
    return Result("anything", steps)

def silent(scene, on_step):
    return Result("silent", {name: values[1:] for name, values in curve(scene).items()})

def wrong(scene, on_step):
    return Result("wrong", curve(scene, 1.05))

def raises(scene, on_step):
    on_step({"opening": 0.0, "load": 0.0})
    on_step({"opening": 0.1, "load": 1.0})
    raise ZeroDivisionError("the matrix was singular")

def no_result(scene, on_step):
    return curve(scene)

def picky(scene, on_step):
    raise AssertionError("not to be called")

picky.unsuitable = lambda scene: "specimen.kind: must be peel" if scene.specimen.kind == "dcb" else ""
number = 3
"""

ENTRIES = """[debond.methods]
good = fakecode:good
silent = fakecode:silent
wrong = fakecode:wrong
raises = fakecode:raises
no-result = fakecode:no_result
picky = fakecode:picky
number = fakecode:number
absent = fakecode_that_is_not_there:solve
lost = fakecode:lost
nurbs = fakecode:good
"""


@pytest.fixture
def package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A distribution as pip leaves it, found by this process and by those that it starts."""
    place = tmp_path / "site"
    about = place / "fakecode-0.3.dist-info"
    about.mkdir(parents=True)
    (about / "METADATA").write_text("Metadata-Version: 2.1\nName: fakecode\nVersion: 0.3\n")
    (about / "entry_points.txt").write_text(ENTRIES)
    (place / "fakecode.py").write_text(MODULE)
    monkeypatch.syspath_prepend(str(place))
    paths = [str(place), str(PROJECT), *filter(None, [os.environ.get("PYTHONPATH")])]
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join(paths))
    monkeypatch.delitem(sys.modules, "fakecode", raising=False)
    yield place
    sys.modules.pop("fakecode", None)


def test_a_method_of_another_package_is_one_like_the_others(package: Path, tmp_path: Path) -> None:
    assert known_methods()["good"] == "plug-in of fakecode 0.3"
    assert main(["solve", LINEAR, "--method", "good", "--fields", "--out", str(tmp_path / "run")]) == 0
    about = json.loads((tmp_path / "run" / "result.json").read_text())
    beam = solve(load_scene(LINEAR), "beam")
    assert about["method"] == "good" and about["status"] == "complete" and about["seconds"]["total"] > 0
    assert about["peak_load"] == pytest.approx(beam.load.max())
    assert [name for name, check in about["checks"].items() if not check["passed"]] == []
    curve = read_columns(tmp_path / "run" / "curve.csv")
    assert np.array_equal(curve["load"], beam.load) and curve["opening"][0] == 0.0
    assert np.isnan(curve["crack_length"][1:]).all(), "unknown is not zero"
    assert set(read_result(tmp_path / "run").steps) == {"opening", "load"}


def test_a_solver_that_reports_nothing_leaves_a_whole_curve(package: Path, tmp_path: Path) -> None:
    assert main(["solve", LINEAR, "--method", "silent", "--out", str(tmp_path / "run")]) == 0
    expected = solve(load_scene(LINEAR), "beam")
    for found in (read_columns(tmp_path / "run" / "curve.csv"), solve(load_scene(LINEAR), "silent").steps):
        assert np.array_equal(found["opening"], expected.opening) and np.array_equal(found["load"], expected.load)


BROKEN = {
    "number": "fakecode:number must be callable, got int",
    "absent": "fakecode_that_is_not_there:solve cannot be imported, ModuleNotFoundError: No module named",
    "lost": "fakecode:lost cannot be imported, AttributeError: module 'fakecode' has no attribute 'lost'",
}


@pytest.mark.parametrize("method", BROKEN)
def test_a_broken_one_is_one_sentence(
    method: str, package: Path, tmp_path: Path, capsys: pytest.CaptureFixture
) -> None:
    assert main(["solve", LINEAR, "--method", method, "--out", str(tmp_path / "run")]) == 1
    said = capsys.readouterr().err
    assert said.startswith(f"debond: not run: plug-in {method} of fakecode 0.3: {BROKEN[method]}")
    assert said.count("\n") == 1 and "Traceback" not in said and "conda" not in said
    job = next(job for job in planned(LINEAR, load_scene(LINEAR)) if job.method == method)
    assert left_out(job).startswith(f"not run: plug-in {method} of fakecode 0.3")


def test_one_that_is_not_made_for_a_scene_says_so(package: Path, tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    assert main(["solve", LINEAR, "--method", "picky", "--out", str(tmp_path / "run")]) == 2
    assert "picky: specimen.kind: must be peel" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("method", "why"),
    [
        ("raises", "ZeroDivisionError: the matrix was singular"),
        ("no-result", "TypeError: must return a verify.result.Result, got dict"),
    ],
)
def test_one_that_fails_is_a_run_that_stopped(
    method: str, why: str, package: Path, tmp_path: Path, capsys: pytest.CaptureFixture
) -> None:
    assert main(["solve", LINEAR, "--method", method, "--out", str(tmp_path / "run")]) == 1
    status = json.loads((tmp_path / "run" / "result.json").read_text())["status"]
    assert f"plug-in {method} of fakecode 0.3: {why} (an error in the plug-in: see error.log)" in status
    assert "Traceback" not in capsys.readouterr().err
    assert why.partition(":")[0] in (tmp_path / "run" / "error.log").read_text()


def test_a_method_of_debond_cannot_be_replaced(package: Path) -> None:
    assert known_methods()["nurbs"] == names.METHODS["nurbs"].what
    with pytest.raises(NotRun, match="its name must be a word of its own"):
        plugins.plugins()["nurbs"].load()


def test_two_of_one_name_are_none(package: Path) -> None:
    second = package / "other-1.dist-info"
    second.mkdir()
    (second / "METADATA").write_text("Metadata-Version: 2.1\nName: other\nVersion: 1\n")
    (second / "entry_points.txt").write_text("[debond.methods]\ngood = fakecode:wrong\n")
    with pytest.raises(NotRun, match="plug-in good of .* and .*: the name is there 2 times"):
        solve(load_scene(LINEAR), "good")


def test_its_name_is_known_where_names_are_asked_for(package: Path, capsys: pytest.CaptureFixture) -> None:
    assert main(["solve", LINEAR, "--method", "goood"]) == 2
    assert 'did you mean "good"?' in capsys.readouterr().err
    assert main(["doctor"]) == 0
    said = capsys.readouterr().out.splitlines()
    assert "good: works (fakecode 0.3)" in said
    assert any(line.startswith("absent: does not work, plug-in absent of fakecode 0.3") for line in said)
    assert main(["scenes"]) == 0
    assert "method of another package: good (fakecode 0.3)" in capsys.readouterr().out


def test_a_curve_of_another_code_cannot_take_its_name(package: Path, tmp_path: Path, capsys) -> None:
    (tmp_path / "good.csv").write_text("opening,load\n0,0\n1,1\n")
    assert main(["verify", LINEAR, "--with", str(tmp_path / "good.csv"), "--out", str(tmp_path / "out")]) == 2
    assert "--with: a name must not be a method's, got 'good'" in capsys.readouterr().err


def test_a_changed_solver_is_run_again(package: Path) -> None:
    scene = load_scene(LINEAR)
    first = fingerprint(scene, "good")
    assert fingerprint(scene, "good") == first
    (package / "fakecode.py").write_text(MODULE + "# another line\n")
    assert fingerprint(scene, "good") != first


def test_verify_judges_it_and_a_broken_one_costs_nothing(
    package: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture
) -> None:
    scene, seen = load_scene(LINEAR), []
    monkeypatch.setattr(verification, "write_page", lambda module, findings, *others: seen.extend(findings.reports))
    all_jobs = list(planned(LINEAR, scene))
    assert [job.method for job in all_jobs][: len(names.METHODS)] == list(names.METHODS)

    def only(*names: str) -> None:
        monkeypatch.setattr(verification, "planned", lambda *a: [j for j in jobs if j.method in names])

    jobs = [job for job in planned(LINEAR, scene) if job.method in ("beam", "good", "absent", "wrong")]
    jobs = [type(job)(job.source, scene, job.method, job.variant) for job in jobs]
    only("beam", "good", "absent")  # of all orders
    assert verify(Subjects([(LINEAR, scene)]), tmp_path, jobs=1)
    found = {(check.name, check.subject): check for check in seen[-1].checks}
    assert found["beam-curve", "good / beam"].value < 1e-6 and found["beam-curve", "good / beam"].kind == "analytical"
    assert found["end", "good"].passed
    assert "not run: plug-in absent" in capsys.readouterr().out
    only("beam", "wrong")
    assert not verify(Subjects([(LINEAR, scene)]), tmp_path, jobs=1)
    failed = [check for check in seen[-1].checks if not check.passed]
    others = {(check.name, check.subject) for check in failed if check.kind != "certified"}
    pairs = ("wrong / beam", "wrong / beam-3")
    curves = {("beam-curve", pairs[0]), ("plane-curve", pairs[1])}
    assert others == curves | {("farthest-point", pair) for pair in pairs}
    assert {check.subject for check in failed} == {*pairs, "wrong"}


def test_nothing_is_imported_to_list_methods(package: Path) -> None:
    program = "import sys; from verify.methods.plugins import known_methods; assert 'good' in known_methods(); "
    program += "sys.exit('fakecode' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", program], env=os.environ | {}).returncode == 0


class Given:
    """A plug-in whose solver is at hand."""

    package, entries = "fakecode 1.0", ()

    def __init__(self, solver) -> None:
        self.solver = solver

    def load(self):
        return self.solver


@pytest.mark.parametrize(
    ("steps", "why"),
    [
        ({"opening": [0.0, 1.0]}, "ValueError: the steps must have load, got opening"),
        ({}, "ValueError: the steps must have load and opening, got none"),
        ({"opening": [0.0, 1.0], "load": [0.0]}, "ValueError: the steps must be columns of one length, got"),
        ({"opening": [[0.0, 1.0]], "load": [[0.0, 1.0]]}, "ValueError: the steps must be columns of one length, got"),
        ({"opening": [0.0, np.nan], "load": [0.0, 1.0]}, "ValueError: opening and load must be finite"),
        ({"opening": [0.0, 1.0], "load": [0.0, np.inf]}, "ValueError: opening and load must be finite"),
    ],
)
def test_a_result_that_is_no_curve_is_a_fault(steps: dict, why: str, monkeypatch: pytest.MonkeyPatch) -> None:
    solver = Given(lambda scene, on_step: Result("mine", steps))
    monkeypatch.setattr(plugins, "plugins", lambda: {"mine": solver})
    with pytest.raises(Failure) as fault:
        solve(load_scene(LINEAR), "mine")
    assert str(fault.value).startswith(f"plug-in mine of fakecode 1.0: {why}")


def test_a_path_that_is_told_begins_at_zero(monkeypatch: pytest.MonkeyPatch) -> None:
    def solver(scene, on_step) -> Result:
        on_step({"opening": 0.5, "load": 2})
        on_step({"opening": 1.0, "load": 1})
        return Result("mine", {"opening": [0.5, 1.0], "load": [2, 1]})

    rows = []
    monkeypatch.setattr(plugins, "plugins", lambda: {"mine": Given(solver)})
    found = solve(load_scene(LINEAR), "mine", lambda row: rows.append(dict(row)))
    assert rows == [{"opening": d, "load": P} for d, P in ((0.0, 0.0), (0.5, 2.0), (1.0, 1.0))]
    assert found.opening.tolist() == [0.0, 0.5, 1.0] and found.load.tolist() == [0.0, 2.0, 1.0]
    assert found.method == "mine" and found.peak_memory_mb > 0.0 and found.seconds["total"] >= 0.0


def test_a_row_without_a_load_is_a_fault_and_so_is_a_judge_that_fails(monkeypatch: pytest.MonkeyPatch) -> None:
    def solver(scene, on_step) -> Result:
        on_step({"opening": 0.5})
        return Result("mine", {"opening": [0.5], "load": [2]})

    monkeypatch.setattr(plugins, "plugins", lambda: {"mine": Given(solver)})
    with pytest.raises(Failure, match="a row must have load, got opening"):
        solve(load_scene(LINEAR), "mine")
    solver.unsuitable = lambda scene: 1 / 0
    with pytest.raises(NotRun, match="not run: plug-in mine of fakecode 1.0: ZeroDivisionError"):
        solve(load_scene(LINEAR), "mine")


@pytest.mark.parametrize(
    ("rows", "why"),
    [
        ([(0.0, 0.0), (0.5, np.nan)], "opening and load of a row must be finite, got 0.5 and nan"),
        ([(0.5, 4.0), (1.0, 2.0)], "but load in row 1 was reported as 4 and returned as 2"),
        ([(1.0, 1.0)], "but opening in row 1 was reported as 1 and returned as 0.5"),
        ([(0.5, 2.0), (1.0, 1.0), (1.5, 0.5)], "4 rows were reported, but 3 steps returned"),
    ],
)
def test_reported_rows_are_those_returned(rows: list, why: str, monkeypatch: pytest.MonkeyPatch) -> None:
    def solver(scene, on_step) -> Result:
        for opening, load in rows:
            on_step({"opening": opening, "load": load})
        return Result("mine", {"opening": [0.5, 1.0], "load": [2, 1]})

    monkeypatch.setattr(plugins, "plugins", lambda: {"mine": Given(solver)})
    with pytest.raises(Failure, match=f"plug-in mine of fakecode 1.0: ValueError: .*{why}"):
        solve(load_scene(LINEAR), "mine")


def test_steps_after_the_last_reported_row_are_reported(monkeypatch: pytest.MonkeyPatch) -> None:
    def solver(scene, on_step) -> Result:
        on_step({"opening": 0.5, "load": np.float32(1 / 3), "crack_length": np.nan})
        return Result("mine", {"opening": [0.5, 1.0], "load": [1 / 3, 0.2]})

    rows = []
    monkeypatch.setattr(plugins, "plugins", lambda: {"mine": Given(solver)})
    solve(load_scene(LINEAR), "mine", rows.append)
    assert [row["opening"] for row in rows] == [0.0, 0.5, 1.0] and rows[2]["load"] == 0.2
    assert np.isnan(rows[2]["crack_length"])


def test_a_module_that_nobody_can_find_has_no_files(monkeypatch: pytest.MonkeyPatch) -> None:
    assert plugins._files("no_such_module_at_all") == []
    made = ModuleType("made_while_running")  # has no specification, which is an error to who asks for it
    made.__spec__ = None
    monkeypatch.setitem(sys.modules, "made_while_running", made)
    assert plugins._files("made_while_running") == []
