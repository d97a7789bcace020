"""All studies from their runs to their files; and a run with a broken check of its own gives no number in any of them:
its row has check, value and tolerance, and the command exits with 1."""

from __future__ import annotations

import csv
import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields
from pathlib import Path

import numpy as np
import pytest
from made_up_costs import SCENE, ladder, leaking, made_up, planted

from tests.verify.studies.certified.test_certified_study import answered
from verify.cli import main
from verify.methods.solve import solve
from verify.result import Result
from verify.runs.jobs import Job, Outcome
from verify.scene.load import load_scene
from verify.studies import frame, pairs
from verify.studies.certified import study as certified
from verify.studies.cost import plan as plan_of
from verify.studies.cost import reference as reference_of
from verify.studies.cost import study as cost
from verify.studies.cost.row import Row as CostRow

LEAK = "broken: energy-ledger 0.25 of 0.005"


def of_effects(job: Job) -> Result:
    """Without finite kinematics 1 % less load in a third of the time."""
    linear = "effects.kinematics=linear" in job.overrides
    return made_up(0.99 if linear else 1.0, seconds={"total": 1.0 if linear else 3.0 + 0.1 * job.repeat})


def of_viscosity(job: Job) -> Result:
    """A viscosity lifts the load; it takes less time."""
    v = job.solved.interface.viscosity
    return made_up(1.0 + v, end=job.scene.load.opening[-1], seconds={"total": 2.0 - v})


@dataclass(frozen=True)
class Told:
    """A study: the command, what stands in for its solvers, the type of its rows, and runs by a part of their name that
    break, each with what is said of them and the number of rows without a number."""

    words: tuple[str, ...]
    solver: Callable[[Job], Result]
    row: type
    broken: Mapping[str, tuple[str, int]]


STUDIES = {
    "effects": Told(("dcb-czm1",), of_effects, pairs.Row, {
        "irreversible": (f"irreversible damage: irreversible = false: {LEAK}", 1),
        "effects/nurbs": (f"contact: contact = true: {LEAK}", 6),
    }),
    "vary": Told(("enf-as4peek", "--set", "interface.viscosity=0,0.001,0.01"), of_viscosity, pairs.Row, {
        "viscosity-0.001": (f"interface.viscosity 0.001: interface.viscosity = 0.001: {LEAK}", 1),
        "viscosity-0": (f"interface.viscosity 0.01: interface.viscosity = 0.01: {LEAK}", 3),
    }),
    "cost": Told(("dcb-czm1",), ladder, CostRow, {"cost/nurbs-p2": (f"-80-steps: {LEAK}", 8)}),
}  # fmt: skip


@pytest.fixture(autouse=True)
def few_families(monkeypatch):
    few = tuple(one for one in plan_of.FAMILIES if one.name in ("nurbs-p2", "nurbs-p3", "tspline-p3"))
    monkeypatch.setattr(plan_of, "FAMILIES", few)
    monkeypatch.setattr(reference_of, "dolfinx_installed", lambda: False)


def rows_of(out: Path, name: str) -> list[dict[str, str]]:
    with (out / f"{name}.csv").open(newline="") as stream:
        return list(csv.DictReader(stream))


@pytest.mark.parametrize("name", STUDIES)
def test_a_study_from_runs_to_files(name, tmp_path, monkeypatch, capsys):
    told = STUDIES[name]
    asked = planted(monkeypatch, told.solver)
    assert main([name, *told.words, "--out", str(tmp_path), "--jobs", "2"]) == 0
    printed = capsys.readouterr().out
    assert printed.endswith(f"written: {tmp_path / name}.csv\n")
    rows, about = rows_of(tmp_path, name), json.loads((tmp_path / f"{name}.json").read_text())
    assert list(rows[0]) == [field.name for field in fields(told.row)]
    assert {row["status"] for row in rows} == {"complete"}
    assert about["scene"]["name"] == told.words[0] and about["unresolved"] == [] and about["threads"] == 1
    timed = {(jobs, scheduler) for job, jobs, scheduler in asked if job.repeat}
    assert timed == {(1, None)} and 2 in {jobs for _, jobs, _ in asked}, "what is timed runs alone"
    assert len({job.place for job, *_ in asked}) == len(asked)
    pytest.importorskip("matplotlib")
    page = (tmp_path / "report.html").read_text()
    assert page.count("<svg") >= 2 and f": {told.words[0]}</title>" in page
    assert "http://" not in page.replace("http://www.w3.org", "") and "https://" not in page


@pytest.mark.parametrize(
    ("name", "broken"), [(name, broken) for name, told in STUDIES.items() for broken in told.broken]
)
def test_a_broken_run_has_no_number(name, broken, tmp_path, monkeypatch, capsys):
    told, (said, count) = STUDIES[name], STUDIES[name].broken[broken]
    asked = planted(monkeypatch, told.solver, broken)
    assert main([name, *told.words, "--out", str(tmp_path)]) == 1
    assert said in capsys.readouterr().out and said in (tmp_path / f"{name}.json").read_text()
    rows = [row for row in rows_of(tmp_path, name) if row["status"] != "complete"]
    assert len(rows) == count and all(LEAK in row["status"] for row in rows)
    numbers = [field.name for field in fields(told.row) if field.type == "float"]
    assert {row[key] for row in rows for key in numbers} == {"nan"}
    assert LEAK in (tmp_path / "report.html").read_text()
    assert not [job for job, *_ in asked if job.repeat and broken in job.variant], "it is not timed"


@pytest.mark.slow
def test_effects_for_real(tmp_path, capsys):
    """The turn at an opening of 3, and again: the second call runs nothing."""
    command = ["effects", "dcb-czm1", "--set", "discretization.steps=40", "--out", str(tmp_path), "--jobs", "2"]
    assert main(command) == 0
    found = json.loads((tmp_path / "effects.json").read_text())["effects"]
    # physics: 0.25261 against 0.25088 at an opening of 3, on fine meshes
    assert found["kinematics"]["end_change"] == pytest.approx(0.0069, abs=0.001)
    assert found["kinematics"]["time_ratio"] > 2.0 and found["symmetry"]["time_ratio"] < 0.8
    assert abs(found["symmetry"]["curve_change"]) < 1e-3 and found["irreversible"]["curve_change"] < 1e-6
    assert 0.003 < found["contact"]["curve_change"] < 0.01
    before = (tmp_path / "effects.csv").read_text()
    capsys.readouterr()
    assert main(command) == 0
    assert (tmp_path / "effects.csv").read_text() == before
    assert "20 of 20" not in capsys.readouterr().err.replace("at hand", "")


# --- what gives no number


def test_what_gives_no_number_is_said_in_a_sentence():
    job = Job("dcb-czm1", SCENE, "nurbs", "x")
    for outcome, said in (
        (Outcome(job, made_up()), ""),
        (Outcome(job, leaking(made_up())), LEAK),
        (Outcome(job, leaking(made_up(status="stopped: here"))), "stopped: here"),
        (Outcome(job, None, "not run: no DOLFINx"), "not run: no DOLFINx"),
    ):
        assert frame.failure(outcome) == said


def test_a_check_that_cannot_judge_is_said_and_gives_a_number():
    """A mesh with 1 element in the process zone: J is off, which the mesh explains."""
    given = ("discretization.dofs=280", "discretization.degree=2", "discretization.steps=40")
    scene = load_scene("dcb-czm1-linear", given)
    job = Job("dcb-czm1-linear", scene, "nurbs", "coarse", given)
    one = Outcome(job, solve(scene, "nurbs"))
    assert frame.failure(one) == ""
    (told,) = frame.doubts([one, one, Outcome(job, None, "not run")])
    assert told.startswith("coarse and 1 more runs: j-integral unresolved, ") and "the process zone spans" in told


def test_another_code_that_is_broken_is_no_other_code_at_hand():
    own, _ = reference_of.reference_jobs("dcb-czm1", SCENE, ())
    wrong = [Outcome(job, leaking(ladder(job))) for job in own[:2]]
    found = reference_of.reference([Outcome(job, ladder(job)) for job in own], wrong)
    assert found is not None and f"The other code gives no number: {own[0].variant}: {LEAK}; " in found.sentence
    study = cost.Study(SCENE, (), (), found)
    assert not study.complete and study.about()["reference"]["other_code_faults"] == list(found.faults)  # type: ignore[index]


def test_a_broken_run_makes_no_statement(tmp_path, monkeypatch, capsys):
    scene, given = "dcb-czm1-linear", "uncertainty.interface.toughness=0.02"
    found = solve(load_scene(scene, ["interface.toughness=0.103"]), "lefm")
    lab = tmp_path / "lab.csv"
    np.savetxt(lab, np.stack([found.opening, found.load], 1), delimiter=",", header="opening,load", comments="")
    planted(monkeypatch, lambda job: solve(job.solved, "lefm"), "toughness-larger")
    words = ["validate", scene, "--method", "lefm", "--set", given, "--with", str(lab), "--out", str(tmp_path / "v")]
    assert main(words) == 1
    said = f"validation/lefm-interface.toughness-larger: {LEAK}"
    assert said in capsys.readouterr().out
    about = json.loads((tmp_path / "v" / "validation.json").read_text())
    assert about["failures"] == [said] and about["statements"] == []
    assert not (tmp_path / "v" / "validation.csv").read_text().splitlines()[1:]
    assert said in (tmp_path / "v" / "report.html").read_text()


@pytest.mark.parametrize(("code", "which"), [("nurbs", "mesh"), ("dolfinx", "steps"), ("nurbs", "load.at=node")])
def test_a_broken_run_certifies_nothing(code, which, tmp_path, capsys):
    plan = certified.planned("dcb-czm1", SCENE)
    job = plan.codes[code][which][-1]
    outcomes = answered(plan)
    result = outcomes[job].result
    assert certified.judged(plan, outcomes).complete and result is not None
    found = certified.judged(plan, outcomes | {job: Outcome(job, leaking(result))})
    assert found.found == () and not found.complete
    assert len(found.failures) == 1 and found.failures[0].startswith(f"{job.variant}: {LEAK}")
    found.write(tmp_path)
    assert found.failures[0] in capsys.readouterr().out and found.failures[0] in (tmp_path / "report.html").read_text()
    assert json.loads((tmp_path / "certified.json").read_text())["values"] == []
