"""A run with a broken check of its own gives no number in any study: its row has check, value and tolerance; exit 1."""

from __future__ import annotations

import csv
import json
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from math import isnan
from pathlib import Path

import made_up_costs
import numpy as np
import pytest

from tests.verify.studies.certified.test_certified_study import answered
from tests.verify.studies.effects.test_effects_study import made_up
from verify.cli import main
from verify.methods.solve import solve
from verify.result import Result
from verify.runs.jobs import Job, Outcome
from verify.scene.load import load_scene
from verify.studies import frame
from verify.studies.certified import study as certified
from verify.studies.cost import quick as quick_of
from verify.studies.cost import reference as reference_of
from verify.studies.cost import study as cost
from verify.studies.effects.switches import Plan, planned
from verify.studies.pairs import Row, row, starts_otherwise

SCENE = "dcb-czm1"
LEAK = "broken: energy-ledger 0.25 of 0.005"


def leaking(result: Result) -> Result:
    """The run with a quarter of its external work neither stored nor dissipated."""
    work = result.steps.get("external_work", np.linspace(0.0, 1.0, result.opening.size))
    lost = result.steps.get("dissipated_energy", 0.5 * work)
    energies = {"external_work": work, "stored_energy": 0.75 * work - lost, "dissipated_energy": lost}
    return replace(result, steps={**result.steps, **energies})


def planted(monkeypatch: pytest.MonkeyPatch, solver: Callable[[Job], Result], broken: str) -> list[Job]:
    """Runs in this process; those with ``broken`` in their name leak. Returns the list of the jobs that are run."""
    asked: list[Job] = []

    def run_all(plan: Sequence[Job], *_: object, **__: object) -> Iterator[Outcome]:
        for job in plan:
            asked.append(job)
            result = solver(job)
            yield Outcome(job, leaking(result) if broken in job.variant else result)

    for module in (frame, cost):
        monkeypatch.setattr(module, "run_all", run_all)
    return asked


def table(out: Path, name: str) -> dict[str, dict[str, str]]:
    with (out / f"{name}.csv").open(newline="") as stream:
        rows = list(csv.DictReader(stream))
    return {line.get("key") or line["run"]: line for line in rows}


def test_what_gives_no_number_is_said_in_a_sentence() -> None:
    job = Job(SCENE, load_scene(SCENE), "nurbs", "x")
    assert frame.failure(Outcome(job, made_up())) == ""
    assert frame.failure(Outcome(job, leaking(made_up()))) == LEAK
    assert frame.failure(Outcome(job, replace(leaking(made_up()), status="stopped: here"))) == "stopped: here"
    assert frame.failure(Outcome(job, None, "not run: no DOLFINx")) == "not run: no DOLFINx"


def test_a_check_that_cannot_judge_is_said_and_gives_a_number() -> None:
    """A mesh with 1 element in the process zone: J is off, which the mesh explains."""
    given = ("discretization.dofs=280", "discretization.degree=2", "discretization.steps=40")
    scene = load_scene("dcb-czm1-linear", given)
    job = Job("dcb-czm1-linear", scene, "nurbs", "coarse", given)
    one = Outcome(job, solve(scene, "nurbs"))
    assert frame.failure(one) == ""
    (told,) = frame.doubts([one, one, Outcome(job, None, "not run")])
    assert told.startswith("coarse and 1 more runs: j-integral unresolved, ") and "the process zone spans" in told


# --- effects


def test_effects_of_a_broken_run_have_no_number(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys) -> None:
    asked = planted(monkeypatch, lambda job: made_up(0.4 if "false" in job.variant else 1.0), "irreversible")
    assert main(["effects", SCENE, "--out", str(tmp_path)]) == 1
    said = f"irreversible damage: irreversible = false: {LEAK}"
    printed = capsys.readouterr().out
    assert said in printed and "irreversible damage: curve" not in printed and "contact: curve 150 %" in printed
    line = table(tmp_path, "effects")["irreversible"]
    assert line["status"] == f"irreversible = false: {LEAK}"
    assert all(
        line[key] == "nan" for key in line if key.endswith(("_change", "_ratio", "seconds", "_against", "_spread"))
    )
    found = json.loads((tmp_path / "effects.json").read_text())
    assert found["effects"]["irreversible"]["sentence"] == said and found["unresolved"] == []
    page = (tmp_path / "report.html").read_text()
    assert page.count(f"irreversible = false: {LEAK}") == 2, "the sentence and the line of the table"
    assert not [job for job in asked if job.repeat and "irreversible" in job.variant], "it is not timed"


def test_no_effect_is_told_where_the_scene_as_it_is_is_broken(tmp_path: Path, monkeypatch, capsys) -> None:
    planted(monkeypatch, lambda job: made_up(), "effects/nurbs")
    assert main(["effects", SCENE, "--out", str(tmp_path)]) == 1
    printed = capsys.readouterr().out
    assert printed.count(LEAK) == 10 and "curve" not in printed.replace("curve.csv", "")


@pytest.mark.parametrize(("key", "guarded"), [("irreversible", True), ("viscosity", True), ("friction", False)])
@pytest.mark.parametrize("scene", ["enf-as4peek", "slb", "mmb50-as4peek"])
def test_what_acts_on_damage_alone_does_not_change_the_slope_at_rest(scene: str, key: str, guarded: bool) -> None:
    """A precrack that sticks without any check of its own: 45 % more stiffness by reversible damage."""
    plan: Plan = planned(scene, load_scene(scene), "nurbs")
    pair = next(pair for pair in plan.pairs if pair.key == key)
    end = plan.base.scene.load.opening[-1]
    stiff, right = (stretched(made_up(scale), end) for scale in (1.45, 1.0))
    found = of(pair, right, stiff)
    assert found.complete is not guarded
    said = "one of both runs is wrong: at rest, without any damage, the stiffness with it is -31 % off"
    assert found.status == (said if guarded else "complete") and isnan(found.peak_change) is guarded
    assert of(pair, right, right).complete


def of(pair, with_it: Result, without: Result) -> Row:  # type: ignore[no-untyped-def]
    first = {pair.one: Outcome(pair.one, with_it), pair.other: Outcome(pair.other, without)}
    return row(pair, first, {job: [outcome] for job, outcome in first.items()})


def stretched(result: Result, end: float) -> Result:
    """The curve up to another opening."""
    steps, factor = result.steps, end / result.opening[-1]
    changed = {"opening": steps["opening"] * factor, "load_slope": steps["load_slope"] / factor}
    return replace(result, steps={**steps, **changed})


def test_slopes_at_rest_may_differ_by_rounding() -> None:
    one = made_up()
    other = replace(made_up(1.0 + 1e-8), condition=1e9)
    assert starts_otherwise(one, other) == [] and starts_otherwise(one, replace(other, condition=1e6)) != []
    assert starts_otherwise(one, Result("x", {"opening": one.opening, "load": one.load})) == []


# --- cost


def ladder(job: Job) -> Result:
    """Curves whose error falls with the number of unknowns."""
    unknowns = job.solved.discretization.dofs
    return made_up_costs.made_up(1.0 + 0.5 / unknowns, dofs=unknowns, elements=unknowns)


def test_cost_of_a_broken_run_has_no_number(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys) -> None:
    monkeypatch.setattr(reference_of, "dolfinx_installed", lambda: False)
    monkeypatch.setattr(cost, "_with_nonzeros", lambda runner: list(runner.rows.values()))
    planted(monkeypatch, ladder, "cost/nurbs-p2")
    assert main(["cost", SCENE, "--out", str(tmp_path)]) == 1
    printed = capsys.readouterr().out
    rows = table(tmp_path, "cost")
    broken = {name: line for name, line in rows.items() if "nurbs-p2" in name}
    assert broken and all(line["status"] == LEAK and line["curve_error"] == "nan" for line in broken.values())
    assert {line["status"] for name, line in rows.items() if name not in broken} == {"complete"}
    assert all(f"{name}: {LEAK}" in printed for name in broken)
    found = json.loads((tmp_path / "cost.json").read_text())
    assert f"{next(iter(broken))}: {LEAK}" in found["left_out"] and "nurbs-p2" not in str(found["pareto"])
    assert LEAK in (tmp_path / "report.html").read_text()


def test_without_a_right_reference_there_is_no_cost_and_no_price(tmp_path: Path, monkeypatch, capsys) -> None:
    monkeypatch.setattr(reference_of, "dolfinx_installed", lambda: False)
    planted(monkeypatch, ladder, "reference/")
    assert main(["cost", SCENE, "--out", str(tmp_path / "cost")]) == 1
    said = capsys.readouterr().err
    assert "nothing can be measured: reference/nurbs-p3-" in said and LEAK in said
    assert quick_of.quick(SCENE, load_scene(SCENE), tmp_path / "quick", 1) is None
    assert LEAK in capsys.readouterr().err


def test_another_code_that_is_broken_is_no_other_code_at_hand(tmp_path: Path) -> None:
    own, other = reference_of.reference_jobs(SCENE, load_scene(SCENE), ())
    runs = [Outcome(job, ladder(job)) for job in own]
    wrong = [Outcome(job, leaking(ladder(job))) for job in own[:2]]
    found = reference_of.reference(runs, wrong)
    assert found is not None and f"The other code gives no number: {own[0].variant}: {LEAK}; " in found.sentence
    study = cost.Study(load_scene(SCENE), (), (), found)
    assert not study.complete and study.about()["reference"]["other_code_faults"] == list(found.faults)  # type: ignore[index]


def test_a_price_is_not_made_of_broken_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    planted(monkeypatch, ladder, "cost/nurbs")
    found = quick_of.quick(SCENE, load_scene(SCENE), tmp_path, 1)
    assert found is not None and "NURBS" not in found.sentence
    assert any(text.endswith(LEAK) for text in found.summary()["left_out"])


# --- validation and certified values


def test_a_broken_run_makes_no_statement(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys) -> None:
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
def test_a_broken_run_certifies_nothing(code: str, which: str, tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    plan = certified.planned(SCENE, load_scene(SCENE))
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


# --- a key that varies


def of_viscosity(job: Job) -> Result:
    """A straight line that a viscosity lifts; it takes less time."""
    v = job.solved.interface.viscosity
    d = np.linspace(0.0, job.scene.load.opening[-1], 11)
    steps = {"opening": d, "load": (1.0 + v) * d, "external_work": 0.5 * (1.0 + v) * d**2}
    steps |= {"dissipated_energy": 0.0 * d, "newton_iterations": np.ones(11)}
    return Result("nurbs", steps, seconds={"total": 2.0 - v})


@pytest.mark.parametrize(("broken", "count"), [("viscosity-0.001", 1), ("viscosity-0", 3)])
def test_a_broken_variant_has_no_number(broken: str, count: int, tmp_path: Path, monkeypatch, capsys) -> None:
    """That which the others are held against leaves none."""
    planted(monkeypatch, of_viscosity, broken)
    words = ["--set", "interface.viscosity=0,0.001,0.01"]
    assert main(["vary", "enf-as4peek", *words, "--out", str(tmp_path)]) == 1
    with (tmp_path / "vary.csv").open(newline="") as stream:
        rows = {line["value"]: line for line in csv.DictReader(stream)}
    assert [LEAK in line["status"] for line in rows.values()].count(True) == count
    line = rows["0.001"]
    assert line["curve_change"] == line["time_ratio"] == line["seconds"] == "nan"
    said = f"interface.viscosity = {broken.rpartition('-')[2]}: {LEAK}"
    assert said in capsys.readouterr().out and said in (tmp_path / "report.html").read_text()
