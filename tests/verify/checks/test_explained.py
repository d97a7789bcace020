"""Curves of other codes in a report: a diagnosis after a failure, what a pass cannot show after a pass."""

from __future__ import annotations

import json

import numpy as np
import pytest
from recorded_runs import recorded, scene_of

from verify.checks.explained import explained
from verify.checks.judgement import NO_DEMANDS, judged
from verify.checks.table import not_held
from verify.diagnosis.classify import diagnose
from verify.result import Result
from verify.runs import verdict_file
from verify.testing import assert_curves_close
from verify.verdict import Check, Run, SceneReport, worst_of_each

SCENE = scene_of("fine")


@pytest.fixture
def right():
    return recorded("fine")


def report(right: Result, opening: np.ndarray, off: float) -> SceneReport:
    runs = [Run("NURBS", "nurbs", right), Run("mine", "mine", Result("mine", {"opening": opening, "load": right.load}))]
    check = Check("curve", "mine / nurbs", off, 0.005, "cross-code", "")
    return explained(SceneReport(SCENE, tuple(runs), (check,)), ["mine"])


def test_a_curve_that_fails_has_a_diagnosis_in_the_verdict_and_no_remark(right, tmp_path, monkeypatch):
    """Among the causes of a curve alone, which take no solutions."""

    def of_the_curve(name, curve, expected, scene, tolerance, out):
        assert scene == SCENE
        return diagnose(name, curve, expected, None, tolerance, out)

    monkeypatch.setattr("verify.checks.explained.diagnose", of_the_curve)
    found = report(right, right.opening + 0.04, 0.05)
    assert [one.causes[0].name for one in found.diagnoses] == ["toe"]
    assert not found.remarks and found.verdicts == (found.diagnoses[0].sentence,)
    verdict_file.write(tmp_path, [found], judged([found], NO_DEMANDS))
    (said,) = json.loads((tmp_path / "verdict.json").read_text())["diagnosis"]
    assert said["scene"] == SCENE.name and said["causes"][0]["name"] == "toe"
    assert set(said["causes"][0]) == {"name", "amount", "unit", "error_with", "error_without"}


def test_a_curve_that_passes_is_told_what_it_cannot_show(right):
    found = report(right, right.opening, 0.0)
    assert not found.diagnoses
    (remark,) = found.remarks
    assert found.verdicts[0].startswith("mine: agrees, 1 of 1 checks hold")
    assert "its strains are finite, not small" in remark and "strength off by 1 %" in remark
    assert "precrack off" not in remark or "plane strain" not in remark


def test_a_test_of_other_projects_says_why(right):
    with pytest.raises(AssertionError, match="does not agree, because all loads are 5 % higher"):
        assert_curves_close((right.opening, 1.05 * right.load), right, curve=0.005, scene=SCENE)


def test_a_check_that_fails_against_several_partners_is_one_line():
    def check(partner: str, value: float) -> Check:
        return Check("curve", f"mine / {partner}", value, 0.005, "cross-code", "")

    found = [("s", check("nurbs", 0.1)), ("s", check("dolfinx", 0.3)), ("s", check("beam", 0.001))]
    assert worst_of_each(found) == [("s", found[1][1], 1)]
    (line,) = not_held(found)
    assert "mine / dolfinx" in line and line.endswith("and 1 more of its partners")
