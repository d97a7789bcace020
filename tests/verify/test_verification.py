"""The main job: who runs, what a crash costs, what is printed, which exit code."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from verify import verification
from verify.checks.between_codes import cross_checks
from verify.checks.identities import IDENTITIES
from verify.checks.judgement import Demands
from verify.checks.orders import ARMS, ARMS_SECOND
from verify.cli import main
from verify.methods.names import METHODS
from verify.methods.plugins import plugins
from verify.methods.reference_mesh import reference_mesh
from verify.result import Result
from verify.runs import sweep
from verify.runs.jobs import Job, Outcome
from verify.scene.load import load_scene
from verify.studies import one_scene
from verify.studies.one_scene import convergence, planned
from verify.verdict import Check, Run, SceneReport
from verify.verification import Subjects, verify

LINEAR = "dcb-czm1-linear"
#: Runs that judge, beside those of the methods.
SECOND = ("dolfinx-second", ARMS, ARMS_SECOND)


@pytest.fixture
def reports(monkeypatch):
    """What the report would have been written from."""
    seen: list[SceneReport] = []
    monkeypatch.setattr(verification, "write_page", lambda module, findings, *others: not seen.extend(findings.reports))
    return seen


def only(monkeypatch: pytest.MonkeyPatch, *jobs: Job) -> None:
    monkeypatch.setattr(verification, "planned", lambda source, scene, *_: [j for j in jobs if j.scene == scene])


@pytest.fixture
def scene():
    return load_scene(LINEAR)


def test_every_method_runs_on_every_scene(scene):
    assert [job.variant for job in planned(LINEAR, scene)] == [*METHODS, *plugins(), *SECOND]
    finite = load_scene("dcb-czm1")
    assert [job.variant for job in planned("dcb-czm1", finite)][-4:] == [*SECOND, "nurbs-matched"]
    full = [job.variant for job in planned(LINEAR, scene, full=True)]
    assert full[len(METHODS) + len(SECOND) + len(plugins()) :] == [
        "dolfinx-p3",
        "tspline-adaptive",
        "nurbs-978",
        "nurbs-489",
    ]


def test_good_runs_make_a_report_and_exit_zero(scene, reports, tmp_path, monkeypatch, capsys):
    only(monkeypatch, Job(LINEAR, scene, "beam", "beam"), Job(LINEAR, scene, "lefm", "lefm"))
    assert verify(Subjects([(LINEAR, scene)]), tmp_path, jobs=2)
    (report,) = reports
    assert [run.method for run in report.runs] == ["beam", "lefm"]
    assert all(run.result.complete for run in report.runs)
    assert report.runs[1].folder == f"{LINEAR}/lefm" and report.runs[1].command.startswith("debond solve ")
    assert (tmp_path / LINEAR / "beam" / "curve.csv").exists()
    said = capsys.readouterr()
    all_ = f"{len(report.checks)} of {len(report.checks)}"
    assert said.out.splitlines()[-1] == f"{all_} checks hold: {tmp_path / 'report.html'}" and len(report.checks) >= 8
    assert "beam: complete" in said.err


def test_runs_of_an_equal_scene_are_judged(scene, reports, tmp_path, monkeypatch):
    only(monkeypatch, Job(LINEAR, load_scene(LINEAR), "lefm", "lefm"))
    assert verify(Subjects([(LINEAR, scene)]), tmp_path, jobs=1)
    assert [run.method for run in reports[0].runs] == ["lefm"] and reports[0].checks


def test_where_nothing_is_checked_nothing_is_verified(scene, reports, tmp_path, monkeypatch, capsys):
    only(monkeypatch)
    assert not verify(Subjects([(LINEAR, scene)]), tmp_path, jobs=1)
    assert "0 of 0 checks hold, and nothing is verified: " in capsys.readouterr().out


def test_a_crash_costs_one_run_and_fails(scene, reports, tmp_path, monkeypatch, capsys):
    only(monkeypatch, Job("gone.toml", scene, "nurbs", "nurbs"), Job(LINEAR, scene, "lefm", "lefm"))
    assert not verify(Subjects([(LINEAR, scene)]), tmp_path, jobs=1)
    (report,) = reports
    assert report.runs[0].result is None and report.runs[0].left_out.startswith("failed: ")
    assert report.runs[1].result is not None
    assert [(check.name, check.subject) for check in report.checks if not check.passed] == [("completed", "nurbs")]
    assert "broken" in capsys.readouterr().out


def test_an_earlier_result_does_not_pass_for_a_crashed_run(scene, reports, tmp_path, monkeypatch):
    only(monkeypatch, Job(LINEAR, scene, "lefm", "lefm"))
    assert verify(Subjects([(LINEAR, scene)]), tmp_path, jobs=1)
    monkeypatch.setattr(sweep, "call", lambda *how: -9)
    assert verify(Subjects([(LINEAR, scene)]), tmp_path, jobs=1), "nothing has changed: there is nothing to run"
    monkeypatch.setattr("verify.runs.fingerprint.source", lambda packages, own=(): "another version")
    assert not verify(Subjects([(LINEAR, scene)]), tmp_path, jobs=1)
    assert not (tmp_path / LINEAR / "lefm" / "curve.csv").exists()


def test_a_failing_check_fails_the_whole(scene, reports, tmp_path, monkeypatch):
    monkeypatch.setitem(IDENTITIES, "energy-ledger", replace(IDENTITIES["energy-ledger"], tolerance=-1.0))
    only(monkeypatch, Job(LINEAR, scene, "lefm", "lefm"))
    assert not verify(Subjects([(LINEAR, scene)]), tmp_path, jobs=1)


@pytest.mark.parametrize(
    ("variant", "state"),
    [("dolfinx", "broken"), ("dolfinx-second", "unresolved"), ("beam", "unresolved"), ("beam-3", "unresolved")],
)
def test_a_run_that_is_there_to_judge_may_stop(scene, tmp_path, variant, state):
    d = np.linspace(0.0, 1.0, 9)
    method = variant if variant in METHODS else variant.partition("-")[0]
    result = Result(method, {"opening": d, "load": d}, "stopped: no equilibrium beyond opening 1")
    report = one_scene.scene_report(scene, [Outcome(Job(LINEAR, scene, method, variant), result)], tmp_path)
    assert [check.state for check in report.checks if check.name == "completed"] == [state]


def test_without_dolfinx_its_rows_say_so_and_nothing_fails(scene, reports, tmp_path, monkeypatch, capsys):
    monkeypatch.setattr("verify.methods.dolfinx.dolfinx_installed", lambda: False)
    both = (Job(LINEAR, scene, "dolfinx", name) for name in ("dolfinx", "dolfinx-second"))
    only(monkeypatch, *both, Job(LINEAR, scene, "lefm", "lefm"))
    assert verify(Subjects([(LINEAR, scene)]), tmp_path, jobs=1)
    assert reports[0].runs[0].left_out == "not run: DOLFINx is not installed"
    said = capsys.readouterr().out
    assert said.count("not run: DOLFINx is not installed") == 1, "once, and not a run"
    assert f"; not judged: dolfinx (DOLFINx is not installed) on {LINEAR}: " in said.splitlines()[-1]
    assert json.loads((tmp_path / "verdict.json").read_text())["not_judged"][0]["subject"] == "dolfinx"
    assert verify(Subjects([(LINEAR, scene)]), tmp_path, jobs=1, demands=Demands(required=("lefm",)))
    for demands in (Demands(required=("dolfinx",)), Demands(strict=True)):
        assert not verify(Subjects([(LINEAR, scene)]), tmp_path, jobs=1, demands=demands)
        assert "dolfinx must have been judged: DOLFINx is not installed" in capsys.readouterr().err


def test_a_scene_that_a_method_is_not_made_for_is_no_failure(reports, tmp_path, monkeypatch):
    scene = load_scene(LINEAR, ["load.opening=[1.0, 0.5]", "effects.irreversible=true"])
    only(monkeypatch, Job(LINEAR, scene, "lefm", "lefm"), Job(LINEAR, scene, "beam", "beam"))
    assert verify(Subjects([(LINEAR, scene)]), tmp_path, jobs=1)
    assert reports[0].runs[0].left_out.startswith("not run: load.opening: must only increase")


def test_three_meshes_give_an_order_and_an_index(scene):
    """Peak loads 1 + h^2 on h = 1/8, 1/4, 1/2 of order two, whose limit is 1."""
    steps = {n: {"opening": np.array([0.0, 1.0]), "load": np.array([0.0, 1 + n**-2.0])} for n in (8, 4, 2)}
    runs = tuple(Run("", "nurbs", Result("nurbs", steps[n], elements=n)) for n in steps)
    (line,) = convergence([SceneReport(scene, runs, ())])
    assert line.startswith(f"{LINEAR}: peak load of 3 NURBS meshes: order 2.00, limit 1, GCI")
    assert convergence([SceneReport(scene, runs[:2], ())]) == []


def test_j_is_no_check_on_a_coarse_mesh_of_a_sequence(scene):
    check = Check("j-integral", "nurbs-489", 0.02, 0.005, "exact", "")
    coarse = Job(LINEAR, scene, "nurbs", "nurbs-489", ("discretization.dofs=489",))
    assert not coarse.meant_for(check)
    assert coarse.meant_for(replace(check, name="energy-ledger"))
    assert Job(LINEAR, scene, "nurbs", "nurbs").meant_for(check)
    assert Job(LINEAR, scene, "tspline", "tspline-adaptive", one_scene.ADAPTIVE).meant_for(check)


def test_runs_are_named_and_kept_with_what_they_were_told(scene, reports, tmp_path, monkeypatch):
    plan = [job for job in planned(LINEAR, scene, full=True) if job.overrides]
    only(monkeypatch, *plan)
    monkeypatch.setattr(verification, "run_all", lambda jobs, *how: [Outcome(job, None, "by nobody") for job in jobs])
    verify(Subjects([(LINEAR, scene)]), tmp_path, jobs=1)
    runs = reports[0].runs
    assert [run.label for run in runs] == [
        "DOLFINx p=2, second mesh", "cohesive beam, order 3", "cohesive beam, order 5", "DOLFINx p=3",
        "T-spline p=3, adaptive", "NURBS p=3", "NURBS p=3",
    ]  # fmt: skip
    assert [reference_mesh(run.scene).degree for run in runs] == [2, 2, 2, 3, 2, 2, 2]
    assert [run.scene.discretization.dofs for run in runs] == [1956, 1956, 1956, 1956, 700, 978, 489]
    assert runs[4].scene.discretization.adaptive and not runs[5].scene.discretization.adaptive


def test_t_splines_that_follow_the_process_zone_are_held_against_both(scene):
    """Tolerances are those of the T-splines at rest: a curve 0.3 % off is near enough to the arms, 0.6 % is not."""
    x = np.linspace(0.0, 3.0, 50)
    for factor, passes in ((1.003, True), (1.006, False)):
        off = {"tspline-adaptive": factor, "tspline": factor} | dict.fromkeys(("beam", "dolfinx", *SECOND), 1.0)
        results = {name: Result(name, {"opening": x, "load": factor * np.sqrt(x)}) for name, factor in off.items()}
        found = {(c.name, c.subject): c for c in cross_checks(scene, results)}
        for name in ("tspline", "tspline-adaptive"):
            assert [found[kind, f"{name} / dolfinx"].passed for kind in ("curve", "peak")] == [passes, passes]
            for kind, judge in (("beam-curve", "beam"), ("plane-curve", "beam-3")):
                assert found[kind, f"{name} / {judge}"].passed == passes


def test_an_interrupt_ends_all_runs(tmp_path):
    command = [sys.executable, "-P", "-m", "verify", "verify", LINEAR, "dcb-czm2-linear"]
    command += ["--jobs", "2", "--out", str(tmp_path)]
    environment = os.environ | {"PYTHONPATH": str(Path(__file__).resolve().parents[2])}
    process = subprocess.Popen(command, stderr=subprocess.PIPE, text=True, env=environment, start_new_session=True)
    deadline = time.monotonic() + 60
    while time.monotonic() < deadline and not list(tmp_path.rglob("curve.csv")):
        time.sleep(0.05)
    process.send_signal(signal.SIGINT)  # to the parent alone, as a script would
    _, said = process.communicate(timeout=30)
    assert process.returncode == 130 and "interrupted" in said and "Traceback" not in said
    deadline = time.monotonic() + 10  # on a busy machine the end of a child takes a moment
    with pytest.raises(ProcessLookupError):  # nobody of its session is left
        while time.monotonic() < deadline:
            os.killpg(process.pid, 0)
            time.sleep(0.05)


@pytest.mark.slow
def test_the_main_job_on_one_scene(tmp_path):
    assert main(["verify", LINEAR, "--out", str(tmp_path)]) == 0
    assert "<svg" in (tmp_path / "report.html").read_text()
