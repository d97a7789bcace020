"""What a verification says to other programs: ``verdict.json``, as a user of it would read it."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import pytest
from made_up_runs import scene_report

from verify import verification
from verify.checks.judgement import NO_DEMANDS, judged
from verify.cli import main
from verify.runs import verdict_file
from verify.runs.jobs import Job
from verify.verdict import Check


def written(out: Path, *reports, included=()) -> dict:
    verdict_file.write(out, reports, judged(reports, NO_DEMANDS), included)
    return json.loads((out / "verdict.json").read_text())


def test_every_check_names_its_scene_method_and_run(tmp_path):
    given = scene_report()
    found = written(tmp_path, given)
    assert found["passed"] is True and len(found["checks"]) == len(given.checks)
    pair = next(check for check in found["checks"] if check["name"] == "curve")
    assert pair == {
        "scene": "dcb-czm1",
        "method": "nurbs",
        "subject": "nurbs / dolfinx",
        "name": "curve",
        "value": 1.2e-3,
        "tolerance": 3e-3,
        "kind": "cross-code",
        "passed": True,
        "state": "holds",
        "run": "dcb-czm1/nurbs",
        "against": "dcb-czm1/dolfinx",
        "meaning": "Two codes draw the same curve.",
    }
    assert {run["folder"] for run in found["runs"]} == {run.folder for run in given.runs}
    assert found["versions"]["numpy"] and found["threads"] >= 1 and found["machine"]["cores"] >= 1


def test_counts_by_kind_and_a_single_failure_fails(tmp_path):
    lost = Check("completed", "nurbs", float("nan"), 1e-9, "exact", "The run ended with a result.")
    given = replace(scene_report(), checks=(*scene_report().checks, lost))
    found = written(tmp_path, given, included=["cost"])
    assert found["passed"] is False
    counts = found["counts"]
    assert (counts["checks"], counts["passed"], counts["failed"]) == (7, 6, 1)
    assert counts["of_kind"]["exact"] == {"checks": 5, "passed": 4, "failed": 1, "unresolved": 0}
    assert counts["of_kind"]["regression"] == {"checks": 0, "passed": 0, "failed": 0, "unresolved": 0}
    assert found["checks"][6]["value"] is None and not found["checks"][6]["passed"]  # JSON has no NaN
    assert found["included"] == ["cost"]


def test_a_run_without_result_says_why(tmp_path):
    given = scene_report()
    gone = replace(given.runs[0], result=None, left_out="not run: DOLFINx is not installed", key="")
    (run,) = written(tmp_path, replace(given, runs=(gone,)))["runs"]
    assert (run["status"], run["hash"], run["seconds"]) == ("not run: DOLFINx is not installed", None, None)


@pytest.fixture
def beam_alone(monkeypatch):
    """Scenes are solved by the beam and LEFM only, which takes no time."""
    both = ("beam", "lefm")
    monkeypatch.setattr(
        "verify.verification.planned", lambda source, scene, *_: [Job(source, scene, m, m) for m in both]
    )


#: A folder and a unit that would be a script, if anybody let them; a file's name cannot have a slash.
HOSTILE = "<script>alert(1)<"
TEXT = "</script><script>alert(2)</script>"
SCENE = """
units = "N, mm, %s"
specimen = { kind = "dcb", length = 14.0, arm_thickness = 0.2, precrack = 4.0 }
material = { young = 120e3, poisson = 0.2 }
interface = { strength = 4.0, toughness = 0.1, ductility = 12.5 }
load = { opening = 3.0 }
effects = { kinematics = "linear" }

[[published]]
quantity = "peak"
value = 0.55
tolerance = 0.05
source = "%s"
"""


def test_texts_of_a_scene_stay_texts_from_its_file_to_every_output(tmp_path, beam_alone, capsys):
    pytest.importorskip("matplotlib")
    pytest.importorskip("jinja2")
    file = tmp_path / HOSTILE / "script>.toml"
    file.parent.mkdir()
    file.write_text(SCENE % (TEXT, TEXT))
    out = tmp_path / "out"
    assert main(["verify", str(file), "--no-ladder", "--out", str(out), "--jobs", "1", "--format", "md"]) == 0
    page = (out / "report.html").read_text()
    assert "<script>alert" not in page and page.count("</script>") == page.count("<script")
    assert "&lt;script&gt;alert(1)&lt;/script&gt;.toml" in page.replace("<span>", "").replace("</span>", "")
    assert page.count("&lt;/script&gt;&lt;script&gt;alert(2)") >= 3  # source, units in words and on the drawings
    text = (out / "report.md").read_text()
    outside = "".join(part for i, part in enumerate(text.split("`")) if i % 2 == 0)  # commands stand as code
    assert "alert(2)" in outside and "<script" not in outside.replace("\\<", "")
    (run, _) = json.loads((out / "verdict.json").read_text())["runs"]
    assert HOSTILE in run["command"] and len(run["hash"]) == 20
    assert (out / run["folder"] / "curve.csv").exists()


def test_a_name_that_is_no_name_is_refused(tmp_path, capsys):
    file = tmp_path / "scene.toml"
    file.write_text(f'name = "{TEXT}"\n' + SCENE % ("MPa", "here"))
    assert main(["verify", str(file), "--out", str(tmp_path / "out")]) == 2
    said = capsys.readouterr().err
    assert "name: " in said and "Traceback" not in said


def test_verdict_is_written_without_the_packages_of_the_report(tmp_path, beam_alone, monkeypatch):
    monkeypatch.setattr(verification, "write_page", lambda *what: None)
    assert main(["verify", "dcb-czm1-linear", "--no-ladder", "--out", str(tmp_path), "--jobs", "1"]) == 0
    found = json.loads((tmp_path / "verdict.json").read_text())
    assert found["passed"] and {check["run"] for check in found["checks"]} >= {"dcb-czm1-linear/beam"}
