"""Methods of other packages: found by their entry points, run like the others, and when broken no more than a row."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
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
from verify.scene.schema import Scene
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
def package(tmp_path, monkeypatch):
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


@pytest.mark.parametrize("name", ["good", "silent"])
def test_a_method_of_another_package_is_one_like_the_others(name, package, tmp_path):
    """Whether its solver reports its rows or not."""
    assert known_methods()[name] == "plug-in of fakecode 0.3"
    assert main(["solve", LINEAR, "--method", name, "--fields", "--out", str(tmp_path / "run")]) == 0
    about = json.loads((tmp_path / "run" / "result.json").read_text())
    beam = solve(load_scene(LINEAR), "beam")
    assert about["method"] == name and about["status"] == "complete" and about["seconds"]["total"] > 0
    assert about["peak_load"] == pytest.approx(beam.load.max())
    assert [name for name, check in about["checks"].items() if not check["passed"]] == []
    curve = read_columns(tmp_path / "run" / "curve.csv")
    assert np.array_equal(curve["load"], beam.load) and curve["opening"][0] == 0.0
    assert np.isnan(curve["crack_length"][1:]).all(), "unknown is not zero"
    assert set(read_result(tmp_path / "run").steps) == {"opening", "load"}


@pytest.mark.parametrize(
    ("method", "code", "words"),
    [
        ("number", 1, "not run: {who} fakecode:number must be callable, got int"),
        (
            "absent",
            1,
            "not run: {who} fakecode_that_is_not_there:solve cannot be imported, ModuleNotFoundError",
        ),
        (
            "lost",
            1,
            "not run: {who} fakecode:lost cannot be imported, AttributeError: module 'fakecode' has",
        ),
        ("picky", 2, "picky: specimen.kind: must be peel"),
        ("raises", 1, "{who} ZeroDivisionError: the matrix was singular (an error in the plug-in: see error.log)"),
        ("no-result", 1, "{who} TypeError: must return a verify.result.Result, got dict (an error in the plug-in"),
    ],
)
def test_a_broken_one_is_one_sentence(method, code, words, package, tmp_path, capsys):
    assert main(["solve", LINEAR, "--method", method, "--out", str(tmp_path / "run")]) == code
    said, words = capsys.readouterr().err, words.format(who=f"plug-in {method} of fakecode 0.3:")
    assert words in said and "Traceback" not in said and "conda" not in said
    if words.startswith("not run"):
        job = next(job for job in planned(LINEAR, load_scene(LINEAR)) if job.method == method)
        assert said == f"debond: {left_out(job)}\n"
    if "error.log" in words:
        assert words.split(": ")[1] in (tmp_path / "run" / "error.log").read_text()
        assert words in json.loads((tmp_path / "run" / "result.json").read_text())["status"]


def test_names_are_words_of_their_own_and_there_once(package):
    assert known_methods()["nurbs"] == names.METHODS["nurbs"].what
    with pytest.raises(NotRun, match="its name must be a word of its own"):
        plugins.plugins()["nurbs"].load()
    second = package / "other-1.dist-info"
    second.mkdir()
    (second / "METADATA").write_text("Metadata-Version: 2.1\nName: other\nVersion: 1\n")
    (second / "entry_points.txt").write_text("[debond.methods]\ngood = fakecode:wrong\n")
    with pytest.raises(NotRun, match="plug-in good of .* and .*: the name is there 2 times"):
        solve(load_scene(LINEAR), "good")


def test_its_name_is_known_where_names_are_asked_for(package, capsys):
    assert main(["solve", LINEAR, "--method", "goood"]) == 2
    assert 'did you mean "good"?' in capsys.readouterr().err
    assert main(["doctor"]) == 0
    said = capsys.readouterr().out.splitlines()
    assert "good: works (fakecode 0.3)" in said
    assert any(line.startswith("absent: does not work, plug-in absent of fakecode 0.3") for line in said)
    assert main(["scenes"]) == 0
    assert "method of another package: good (fakecode 0.3)" in capsys.readouterr().out


def test_a_changed_solver_is_run_again(package):
    scene = load_scene(LINEAR)
    first = fingerprint(scene, "good")
    assert fingerprint(scene, "good") == first
    (package / "fakecode.py").write_text(MODULE + "# another line\n")
    assert fingerprint(scene, "good") != first


def test_verify_judges_it_and_a_broken_one_costs_nothing(package, tmp_path, monkeypatch, capsys):
    scene, seen = load_scene(LINEAR), []
    monkeypatch.setattr(verification, "write_page", lambda module, findings, *others: seen.extend(findings.reports))

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


def test_nothing_is_imported_to_list_methods(package):
    program = "import sys; from verify.methods.plugins import known_methods; assert 'good' in known_methods(); "
    program += "sys.exit('fakecode' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", program], env=os.environ | {}).returncode == 0


@dataclass(frozen=True)
class Given(plugins.Plugin):
    """A plug-in that is at hand: it reports rows and returns steps."""

    rows: tuple = ()
    steps: Mapping[str, object] = field(default_factory=dict)

    def load(self) -> plugins.Solver:
        def solver(scene: Scene, on_step: Callable) -> Result:
            for row in self.rows:
                on_step(dict(zip(("opening", "load", "crack_length"), row, strict=False)))
            return Result("anything", self.steps)

        return solver


@pytest.fixture
def given(monkeypatch):
    """Solves by a plug-in with these rows and steps: the result, and the rows that a listener hears of."""

    def solved(*rows: tuple, **steps: object) -> tuple[Result, list]:
        monkeypatch.setattr(
            plugins, "plugins", lambda: {"mine": Given("mine", "fakecode 1.0", (), rows=rows, steps=steps)}
        )
        heard: list = []
        return solve(load_scene(LINEAR), "mine", heard.append), [tuple(row.values()) for row in heard]

    return solved


TWO = {"opening": [0.5, 1.0], "load": [2.0, 1.0]}


@pytest.mark.parametrize(
    ("rows", "steps", "why"),
    [
        ((), {"opening": [0.0, 1.0]}, "the steps must have load, got opening"),
        ((), {}, "the steps must have load and opening, got none"),
        ((), {"opening": [0.0, 1.0], "load": [0.0]}, "the steps must be columns of one length, got"),
        ((), {"opening": [[0.0, 1.0]], "load": [[0.0, 1.0]]}, "the steps must be columns of one length, got"),
        ((), {"opening": [0.0, 1.0], "load": [0.0, np.inf]}, "opening and load must be finite"),
        ([(0.5,)], TWO, "a row must have load, got opening"),
        ([(0.0, 0.0), (0.5, np.nan)], TWO, "opening and load of a row must be finite, got 0.5 and nan"),
        ([(0.5, 4.0), (1.0, 2.0)], TWO, "but load in row 1 was reported as 4 and returned as 2"),
        ([(1.0, 1.0)], TWO, "but opening in row 1 was reported as 1 and returned as 0.5"),
        ([(0.5, 2.0), (1.0, 1.0), (1.5, 0.5)], TWO, "4 rows were reported, but 3 steps returned"),
    ],
)
def test_what_is_no_curve_or_was_not_reported_is_a_fault(rows, steps, why, given):
    with pytest.raises(Failure, match=f"plug-in mine of fakecode 1.0: ValueError: .*{why}"):
        given(*rows, **steps)


@pytest.mark.parametrize("count", [0, 1, 2])
def test_a_path_begins_at_zero_and_all_of_it_is_heard(count, given):
    """Whatever the solver has reported, up to rounding in single precision."""
    told = [(0.5, np.float32(1 / 3)), (1.0, 0.2)][:count]
    found, heard = given(*told, opening=[0.5, 1.0], load=[1 / 3, 0.2])
    assert np.allclose(heard, [(0.0, 0.0), (0.5, 1 / 3), (1.0, 0.2)], atol=1e-7)
    assert found.opening.tolist() == [0.0, 0.5, 1.0] and found.load.tolist() == [0.0, 1 / 3, 0.2]
    assert found.method == "mine" and found.peak_memory_mb > 0.0 and found.seconds["total"] >= 0.0


def test_what_the_steps_do_not_have_is_not_known_after_the_last_reported_row(given):
    _, heard = given((0.5, 2.0, 4.0), **TWO)
    assert heard[1] == (0.5, 2.0, 4.0) and heard[2][:2] == (1.0, 1.0) and np.isnan(heard[2][2])


def test_a_module_that_nobody_can_find_has_no_files(monkeypatch):
    assert plugins._files("no_such_module_at_all") == []
    made = ModuleType("made_while_running")  # has no specification, which is an error to who asks for it
    made.__spec__ = None
    monkeypatch.setitem(sys.modules, "made_while_running", made)
    assert plugins._files("made_while_running") == []
