"""The table of codes of others: distance, verdict with its cause, and the command that makes a row again."""

from dataclasses import replace

import numpy as np
import pytest

from verify.cli import main
from verify.methods.solve import solve
from verify.report import who_agrees
from verify.runs.jobs import Outcome

SCENE = "dcb-czm1-linear"


def test_rows_have_distance_cause_and_command(tmp_path, monkeypatch):
    right = solve(SCENE, "beam")
    wrong = replace(right, steps={**right.steps, "load": 1.03 * right.load})
    half = replace(right, steps={name: one[:40] for name, one in right.steps.items()}, status="stopped: no convergence")

    def outcome(job):
        result = {"nurbs": right, "scikit-fem": right, "moose": wrong, "oofem": half}.get(job.method)
        return Outcome(job, result, "" if result is not None else "only for a dcb", failed=job.method == "pyfem")

    monkeypatch.setattr(who_agrees.frame, "run", lambda plan, folder: {job: outcome(job) for job in plan})
    monkeypatch.setattr(who_agrees, "AGREED_ON", ((SCENE, ("interface.penalty=1e3",)),))
    names = ["scikit-fem", "moose", "oofem", "akantu", "pyfem"]
    page = who_agrees.who_agrees(names, tmp_path).read_text().replace("\u00a0", " ")
    rows = {line.split("|")[2].strip(): line for line in page.splitlines() if line.startswith("|")}
    assert "agrees" in rows["scikit-fem"] and "| 0 %" in rows["scikit-fem"]
    assert "all loads are 3 % higher" in rows["moose"] and "| 3.0 %" in rows["moose"]
    assert f"debond verify {SCENE} --set interface.penalty=1e3 --peers moose" in rows["moose"]
    assert "no convergence" in rows["oofem"] and "only for a dcb" in rows["pyfem"] and "akantu" not in rows
    assert "OOFEM 2.6.0.dev1" in page and len((tmp_path / "who-agrees.csv").read_text().splitlines()) == 5


@pytest.mark.parametrize("words", [["report", "moose"], ["report"], ["report", "abacus"]])
def test_without_codes_there_is_nothing_to_report(words, tmp_path, monkeypatch, capsys):
    monkeypatch.setenv("DEBOND_CACHE", str(tmp_path))
    assert main(["peers", *words, "--out", str(tmp_path / "out")]) == 2
    said = capsys.readouterr().err
    assert "install" in said or "must be one of" in said
    assert np.size(list(tmp_path.glob("out/*"))) == 0
