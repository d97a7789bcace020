"""``debond effects``: which runs, what two of them tell, and the files."""

from __future__ import annotations

import csv
import json
from dataclasses import fields, replace
from math import isnan
from pathlib import Path

import numpy as np
import pytest

from verify.cli import main
from verify.curves.of_run import cubics, distance
from verify.result import Result
from verify.runs.jobs import Job, Outcome
from verify.scene.load import load_scene
from verify.studies import frame
from verify.studies.effects.study import effects
from verify.studies.effects.switches import Plan, planned
from verify.studies.pairs import TIMES, Row, apart, change, changes, jobs_of, legs, row, signed, timed

SCENE = load_scene("dcb-czm1")


def made_up(scale: float = 1.0, dissipated: float = 1.0, seconds: float = 2.0, **about) -> Result:
    """P = s d exp(-d) to an opening of 3, with its exact slopes and energies."""
    d = np.linspace(0.0, 3.0, 121)
    work = scale * (1.0 - (1.0 + d) * np.exp(-d))
    steps = {
        "opening": d, "load": scale * d * np.exp(-d), "load_slope": scale * (1.0 - d) * np.exp(-d),
        "heading": np.ones(d.size), "dissipated_energy": dissipated * work, "external_work": work,
        "newton_iterations": np.ones(d.size),
    }  # fmt: skip
    return Result("nurbs", steps, seconds={"total": seconds}, **about)


def overrides(plan: Plan) -> dict[str, tuple[str, str]]:
    """Of every pair, the last override of both sides."""
    last = {
        pair.key: tuple(job.overrides[-1:] or ("as it is",) for job in (pair.one, pair.other)) for pair in plan.pairs
    }
    return {key: (a[0], b[0]) for key, (a, b) in last.items()}


# --- which runs


def test_every_effect_is_switched_from_what_the_scene_has() -> None:
    plan = planned("dcb-czm1", SCENE, "nurbs")
    assert overrides(plan) == {
        "kinematics": ("as it is", "effects.kinematics=linear"),
        "contact": ("as it is", "effects.contact=false"),
        "irreversible": ("as it is", "effects.irreversible=false"),
        "symmetry": ("effects.symmetry=true", "as it is"),
        "search": ("as it is", "effects.search=false"),
    }
    assert plan.left_out == () and len(every := jobs_of(plan.pairs)) == 6 and len({job.place for job in every}) == 6
    again = timed(every)
    assert len(again) == 6 * TIMES and len({job.task().key for job in (*every, *again)}) == 6 * (TIMES + 1)
    assert [job.repeat for job in again[:5]] == [1] * 5, "all of them one after the other, and then again"


def test_what_is_automatic_is_switched_from_what_it_stands_for() -> None:
    given = ("effects.kinematics=auto", "effects.contact=auto", "load.opening=0.2")
    plan = planned("dcb-czm1", load_scene("dcb-czm1", given), "nurbs", given)
    assert overrides(plan)["kinematics"] == ("effects.kinematics=finite", given[-1])
    assert overrides(plan)["contact"] == (given[-1], "effects.contact=false")
    assert all(job.overrides[:3] == given for job in jobs_of(plan.pairs))
    for pair in plan.pairs:
        for job in (pair.one, pair.other):
            assert load_scene("dcb-czm1", job.overrides).load.opening == (0.2,)


@pytest.mark.parametrize(
    ("name", "method", "reason"),
    [
        ("peel-60", "nurbs", "symmetry: left out: effects.symmetry: must be false for a peel"),
        ("dcb-czm1", "beam", "symmetry: left out: beam always has it"),
        ("dcb-czm1", "lefm", "contact: left out: lefm never has it"),
        ("dcb-czm1", "lefm", "irreversible damage: left out: lefm always has it"),
    ],
)
def test_what_a_scene_does_not_admit_is_left_out_in_words(name: str, method: str, reason: str) -> None:
    plan = planned(name, load_scene(name), method)
    assert any(text.startswith(reason) for text in plan.left_out)
    assert len(plan.pairs) + len(plan.left_out) == 5


# --- two runs


def test_changes_are_with_over_without() -> None:
    found = changes(made_up(1.02, 1.0), made_up(1.0, 0.5), (3.0,))
    assert found["curve_change"] == pytest.approx(0.02, rel=1e-6)
    for key in ("peak_change", "end_change", "work_change"):
        assert found[key] == pytest.approx(0.02, rel=1e-6)
    assert found["dissipated_change"] == pytest.approx(1.04, rel=1e-6)
    assert isnan(changes(made_up(), made_up(dissipated=0.0), (3.0,))["dissipated_change"])
    assert changes(made_up(dissipated=1e-12), made_up(dissipated=0.0), (3.0,))["dissipated_change"] == 0.0
    assert change(3.0, -2.0, 1.0) == -2.5


def there_and_back(back: float) -> Result:
    """P = d up to 1, and (1 + back) d on the way down to 0.5 and up again to 2."""
    d = np.concatenate([np.linspace(0.0, 1.0, 401), np.linspace(1.0, 0.5, 201)[1:], np.linspace(0.5, 2.0, 601)[1:]])
    load = np.where((np.arange(d.size) > 400) & (d < 1.0), 1.0 + back, 1.0) * d
    return Result("nurbs", {"opening": d, "load": load})


def test_what_changes_on_unloading_alone_is_a_change_of_the_curve() -> None:
    """An envelope has no unloading: it would be told from the loads beyond the first leg alone."""
    ours, plain, way = there_and_back(0.1), there_and_back(0.0), (1.0, 0.5, 2.0)
    assert distance(cubics(ours), plain) < 1e-12 < apart(ours, plain, way)
    back = onward = (1.0 - 0.5**3) / 3.0  # the integral of d^2 over both ways between 0.5 and 1
    wanted = 0.1 * ((back + onward) / (1.0 / 3.0 + back + (2.0**3 - 0.5**3) / 3.0)) ** 0.5
    assert apart(ours, plain, way) == pytest.approx(wanted, rel=0.01)
    assert len(legs(ours, way)) == 3 and len(legs(made_up(), way)) == 1, "a run that did not come back"
    assert apart(made_up(1.1), made_up(), (3.0,)) == pytest.approx(0.1)


def of_pair(key: str, with_it: list[Result | None], without: list[Result | None], stopped: str = "") -> Row:
    plan = planned("dcb-czm1", SCENE, "nurbs")
    pair = next(pair for pair in plan.pairs if pair.key == key)
    outcomes = {
        job: [Outcome(job, one, stopped) for one in results]
        for job, results in ((pair.one, with_it), (pair.other, without))
    }
    first, again = ({job: ones[part] for job, ones in outcomes.items()} for part in (0, slice(1, None)))
    return row(pair, first, again)


def test_a_row_in_words() -> None:
    slow, fast = made_up(1.0068), made_up()
    times = {"with_it": [slow, *(replace(slow, seconds={"total": t}) for t in (6.2, 6.3))], "without": [fast, fast]}
    found = of_pair("kinematics", **times)
    assert found.sentence == (
        "finite kinematics: curve 0.68 %, +0.68 % peak load, +0.68 % load at the end, +0.68 % dissipated energy, "
        "+0.68 % work, 3.1 x time"
    )
    assert found.scene_has and (found.seconds, found.seconds_against, found.times) == (6.2, 2.0, 1)
    busy = of_pair("symmetry", [fast, fast], [fast, *(made_up(seconds=t) for t in (4.0, 9.0))])
    assert busy.sentence.endswith("0.5 x time (equal runs differ by up to 2.2 x)") and not busy.scene_has
    bare = of_pair("irreversible", [fast, fast], [made_up(dissipated=0.0)] * 2)
    assert "no dissipated energy to compare with" in bare.sentence


def test_a_run_that_stopped_keeps_its_row() -> None:
    short = replace(made_up(), status="stopped: here")
    found = of_pair("contact", [made_up()] * 2, [short] * 2)
    assert (
        not found.complete and found.sentence == "contact: contact = false: stopped: here" and isnan(found.end_change)
    )
    gone = of_pair("contact", [None], [made_up()] * 2, "failed: signal 9")
    assert gone.sentence == "contact: contact = true: failed: signal 9" and isnan(gone.time_ratio)
    untimed = of_pair("contact", [made_up()] * 2, [replace(made_up(), seconds=None)] * 2)
    assert untimed.complete and untimed.sentence.endswith(", no time")


def test_numbers_with_their_sign() -> None:
    assert [signed(x) for x in (0.0068, -0.0031, 1.04, 0.0, 3e-9, -0.25)] == [
        "+0.68 %", "-0.31 %", "+100 %", "0 %", "0 %", "-25 %"
    ]  # fmt: skip


# --- the whole


def test_a_study_from_runs_to_files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys) -> None:
    """Runs that need no solver: without finite kinematics 1 % less load in a third of the time."""
    asked: list[tuple[Job, int, str | None]] = []

    def run_all(plan, out, jobs, scheduler=None):
        for job in plan:
            asked.append((job, jobs, scheduler))
            linear = "effects.kinematics=linear" in job.overrides
            yield Outcome(job, made_up(0.99 if linear else 1.0, seconds=1.0 if linear else 3.0 + 0.1 * job.repeat))

    monkeypatch.setattr(frame, "run_all", run_all)
    found = effects(planned("dcb-czm1", SCENE, "nurbs"), tmp_path, 2, "tcp://here:1")
    assert found.complete and "finite kinematics: curve 1 %, +1 % peak load" in capsys.readouterr().out
    assert {(jobs, scheduler) for job, jobs, scheduler in asked if job.repeat == 0} == {(2, "tcp://here:1")}
    assert {(jobs, scheduler) for job, jobs, scheduler in asked if job.repeat} == {(1, None)}, "timed here, alone"
    with (tmp_path / "effects.csv").open(newline="") as stream:
        rows = {line["key"]: line for line in csv.DictReader(stream)}
    assert list(next(iter(rows.values()))) == [field.name for field in fields(Row)]
    assert float(rows["kinematics"]["time_ratio"]) == pytest.approx(3.1)
    assert float(rows["kinematics"]["end_change"]) == pytest.approx(1 / 0.99 - 1)
    about = json.loads((tmp_path / "effects.json").read_text())
    assert set(about["effects"]) == {"kinematics", "contact", "irreversible", "symmetry", "search"}
    assert about["effects"]["kinematics"]["sentence"].endswith("3.1 x time") and about["method"] == "nurbs"
    assert about["simulated"]["kinematics"] == "finite" and about["left_out"] == []
    pytest.importorskip("matplotlib")
    page = (tmp_path / "report.html").read_text()
    assert page.count("<svg") == 2 and "3.1 ×" in page and "+1 %" in page and "What each effect does: dcb-czm1" in page
    assert "http://" not in page.replace("http://www.w3.org", "") and "https://" not in page


def test_bad_input_is_refused_and_a_dry_run_leaves_nothing(tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    out = tmp_path / "out"
    for words, said in (
        (["nothing"], "neither a packaged scene nor a file"),
        (["dcb-czm1", "--method", "bem"], "--method: must be"),
        (["dcb-czm1", "--set", "effects.contact=3"], 'effects.contact: must be true or false, or "auto", got 3'),
        (["dcb-czm1", "--method", "lefm", "--set", "load.opening=[1.0, 0.5]"], "load.opening: must only increase"),
    ):
        assert main(["effects", *words, "--out", str(out)]) == 2
        assert said in capsys.readouterr().err
    assert main(["effects", "peel-60", "--out", str(out), "--dry-run"]) == 0
    said = capsys.readouterr().out
    assert "peel-60/effects/nurbs-kinematics-linear " in said and "16 of 16 runs to do: about" in said
    assert "symmetry: left out: " in said and not out.exists()


@pytest.mark.slow
def test_a_small_study_for_real(tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
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


def test_what_cannot_be_run_here_is_left_out_with_the_reason(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("verify.studies.effects.switches.left_out", lambda job: "not run: too large")
    plan = planned("dcb-czm1", SCENE, "nurbs")
    assert plan.pairs == () and len(plan.left_out) == 5
    assert all(reason.endswith(": left out: not run: too large") for reason in plan.left_out)
