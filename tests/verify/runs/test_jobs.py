"""Runs as a sweep does them: what is left out, what repeats them, what became of them."""

import json
from dataclasses import replace
from pathlib import Path

import pytest

from verify.checks.identities import OF_THE_ZONE
from verify.methods.solve import prepare
from verify.runs.jobs import Job, _in_short, dry_run, left_out, outcome
from verify.runs.run import run
from verify.runs.store import Store
from verify.runs.sweep import OUTPUT_FOLDER, Done
from verify.scene.load import load_scene
from verify.verdict import Check, Counts, Run, SceneReport, counted

SCENE = load_scene("dcb-czm1")
JOB = Job("my scene.toml", SCENE, "nurbs", "coarse", ("discretization.dofs=600", "load.opening=2"))


def test_a_job_is_repeated_by_its_command():
    words = [
        "solve",
        "my scene.toml",
        "--method",
        "nurbs",
        "--set",
        "discretization.dofs=600",
        "--set",
        "load.opening=2",
    ]
    assert JOB.command(Path("out")) == [*words, "--fields", "--frames", "0", "--out", "out/dcb-czm1/coarse"]
    assert replace(JOB, fields=False).command(Path("out")) == [*words, "--out", "out/dcb-czm1/coarse"]
    assert (JOB.solved.discretization.dofs, JOB.solved.load.opening) == (600, (2.0,)) and JOB.scene is SCENE
    task = JOB.task()
    assert task.program[:2] == ("verify", "solve") and task.program[-1] == OUTPUT_FOLDER and task.lane == ""
    assert (task.place, task.proof) == ("dcb-czm1/coarse", "result.json") and task.seconds > 0.0
    assert replace(JOB, method="dolfinx", overrides=()).task().lane == "dolfinx"
    others = (replace(JOB, fields=False), replace(JOB, repeat=1), replace(JOB, overrides=()))
    assert len({task.key, *(other.task().key for other in others)}) == 4
    assert replace(JOB, variant="else").task().key == task.key, "the name of a run is not what it rests on"


def test_what_cannot_be_done_here_is_left_out_in_words(tmp_path, monkeypatch):
    monkeypatch.setattr("verify.methods.dolfinx.dolfinx_installed", lambda: False)
    without, turning = Job("x", SCENE, "dolfinx", "a"), Job("x", SCENE, "lefm", "b", ("load.opening=[1.0, 0.5]",))
    whys = [left_out(job) for job in (JOB, without, turning)]
    assert whys[0] == "" and all(why.startswith("not run: ") and why.count("not run") == 1 for why in whys[1:])
    *lines, last = dry_run([without, JOB, turning], tmp_path, 1)
    assert lines[0].split(maxsplit=1) == ["dcb-czm1/a", whys[1]] and lines[1].split(maxsplit=1)[1] == whys[2]
    assert lines[2].startswith("dcb-czm1/coarse ") and "about" in lines[2] and len(lines) == 3
    assert last.startswith("1 of 1 runs to do: about ")


def test_of_coarse_meshes_nothing_is_judged_that_rests_on_the_zone():
    check = Check(next(iter(OF_THE_ZONE)), "nurbs", 0.1, 0.01, "exact", "")
    mesh = replace(JOB, overrides=("discretization.dofs=600",))
    assert [job.meant_for(check) for job in (mesh, JOB, replace(JOB, overrides=()))] == [False, True, True]
    assert mesh.meant_for(replace(check, name="ledger"))


def test_a_run_that_left_no_result_or_a_damaged_one_has_failed(tmp_path):
    done = Done(JOB.task(), tmp_path, "failed: signal 9")
    gone = outcome(JOB, done)
    assert (gone.result, gone.left_out, gone.failed) == (None, "failed: signal 9", True)
    assert _in_short(gone) == "failed: signal 9"
    for text in ("", json.dumps({"method": "nurbs"})):
        (tmp_path / "result.json").write_text(text)
        wrong = outcome(JOB, done)
        assert wrong.result is None and wrong.failed and wrong.left_out.startswith("failed: ")
        assert "result.json: must be as debond has written it" in wrong.left_out and _in_short(wrong) == wrong.left_out
    small = replace(JOB, method="lefm", overrides=("load.opening=0.1",))
    result, _ = run(prepare(small.solved, "lefm"), tmp_path)
    kept = outcome(small, done)
    assert kept.result is not None and kept.result.complete and not kept.failed and kept.left_out == ""
    assert _in_short(kept).startswith(f"complete, peak load {result.load.max():.5g}, ") and result.load.max() < 0.9


def test_a_result_that_cannot_be_kept_is_an_error_and_not_lost(tmp_path):
    """Something else stands in its place; where the same result does, that stays."""
    store = Store(tmp_path)
    first, second, third = (store.begin(key) for key in ("a", "a", "b"))
    (first / "proof").write_text("first")
    store.keep(first, "a")
    (second / "proof").write_text("second")
    store.keep(second, "a")
    assert (store.folder("a") / "proof").read_text() == "first" and not second.exists() and store.whole("a")
    store.folder("b").write_text("no folder")
    (third / "proof").write_text("third")
    with pytest.raises(OSError):
        store.keep(third, "b")
    assert (third / "proof").read_text() == "third" and not store.whole("b")
    store.set_aside("a")
    assert (store.failed("a") / "proof").read_text() == "first" and not store.whole("a")
    store.give_up(third, "a")
    assert (store.failed("a") / "proof").read_text() == "third"
    assert store.failed("a").stat().st_mode & 0o777 == 0o755, "as readable as any folder"


def test_a_check_holds_is_broken_or_cannot_judge():
    good, bad = (Check("ledger", "a / nurbs", value, 0.01, "exact", "") for value in (-0.01, 0.011))
    runs = tuple(Run(name, "nurbs", None, folder=f"scene/{name}" if name == "a" else "") for name in ("a", "b"))
    whole = SceneReport(SCENE, runs, (good, good))
    coarse = replace(bad, unresolved="three elements in the process zone resolve it")
    assert [check.state for check in (good, bad, coarse)] == ["holds", "broken", "unresolved"] and not coarse.passed
    assert counted((good, good, bad, coarse)) == Counts(4, held=2, broken=1, unresolved=1)
    assert whole.judged(good) == runs and whole.judged(replace(good, subject="nurbs / other / a")) == runs[::-1]
    assert not replace(good, value=float("nan")).passed
