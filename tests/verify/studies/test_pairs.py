"""``debond effects`` and ``debond vary``: which runs, what two of them tell, and the charts."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import isnan

import numpy as np
import pytest
from made_up_costs import leaking
from made_up_costs import made_up as curve

from tests.verify.figures import Drawn
from tests.verify.made_up_studies import pair
from verify.cli import main
from verify.curves.of_run import cubics, distance
from verify.result import Result
from verify.runs.jobs import Outcome
from verify.scene.load import load_scene
from verify.studies import effects, pairs_page, vary
from verify.studies.frame import power
from verify.studies.pairs import TIMES, Pair, Plan, Row, apart, change, changes, row, signed, starts_otherwise

SCENE = load_scene("dcb-czm1")


def made_up(scale: float = 1.0, seconds: float | None = 2.0, **about) -> Result:
    return curve(scale, n=120, seconds=None if seconds is None else {"total": seconds}, **about)


def of_effects(name: str = "dcb-czm1", method: str = "nurbs", given: Sequence[str] = ()) -> Plan:
    return effects.planned(name, load_scene(name, given), method, given)


def overrides(plan: Plan) -> dict[str, tuple[str, ...]]:
    """Of every pair, the last override of both sides."""
    return {one.key: tuple((job.overrides or ("as it is",))[-1] for job in (one.one, one.other)) for one in plan.pairs}


# --- which runs


def test_every_effect_is_switched_from_what_the_scene_has():
    plan = of_effects()
    assert overrides(plan) == {
        "kinematics": ("as it is", "effects.kinematics=linear"),
        "contact": ("as it is", "effects.contact=false"),
        "irreversible": ("as it is", "effects.irreversible=false"),
        "symmetry": ("effects.symmetry=true", "as it is"),
        "search": ("as it is", "effects.search=false"),
        "plane": ("specimen.plane=solid", "as it is"),
    }
    again = list(plan.again())
    assert plan.left_out == () and len(plan.jobs) == 7 and len(again) == 7 * TIMES
    assert len({job.task().key for job in (*plan.jobs, *again)}) == 7 * (TIMES + 1)
    assert [job.repeat for job in again[:7]] == [1] * 7, "all of them one after the other, and then again"
    given = ("effects.kinematics=auto", "effects.contact=auto", "load.opening=0.2")
    automatic = of_effects(given=given)
    assert overrides(automatic)["kinematics"] == ("effects.kinematics=finite", given[-1])
    assert overrides(automatic)["contact"] == (given[-1], "effects.contact=false")
    assert all(job.overrides[:3] == given and job.solved.load.opening == (0.2,) for job in automatic.jobs)


@pytest.mark.parametrize(
    ("name", "method", "reason"),
    [
        ("peel-60", "nurbs", "symmetry: left out: effects.symmetry: must be false for a peel"),
        ("dcb-czm1", "beam", "symmetry: left out: beam always has it"),
        ("dcb-czm1", "lefm", "contact: left out: lefm never has it"),
    ],
)
def test_what_a_scene_does_not_admit_is_left_out_in_words(name, method, reason, monkeypatch):
    plan = of_effects(name, method)
    assert any(text.startswith(reason) for text in plan.left_out)
    assert len(plan.pairs) + len(plan.left_out) == 7
    monkeypatch.setattr(effects, "left_out", lambda job: "not run: too large")
    assert not of_effects(name, method).pairs


@pytest.mark.parametrize(
    ("text", "values"),
    [
        ("0,1e-3,0.1", ["0", "1e-3", "0.1"]),
        ("[1,2],[1,3]", ["[1,2]", "[1,3]"]),
        ("[[1,2],[3,4]]", ["[[1,2],[3,4]]"]),
        ('"a,b",c', ['"a,b"', "c"]),
    ],
)
def test_values_of_a_key(text, values):
    assert vary.VALUES.findall(text) == values


def test_every_combination_is_held_against_the_first():
    words = ["interface.strength=5", "discretization.dofs=900,600", "effects.kinematics=linear,finite"]
    plan = vary.planned("dcb-czm1", words, "nurbs")
    solved = [one.one.solved for one in plan.pairs]
    chosen = [(scene.discretization.dofs, scene.effects.kinematics) for scene in solved]
    assert chosen == [(900, "linear"), (900, "finite"), (600, "linear"), (600, "finite")]
    assert {scene.interface.strength for scene in solved} == {5.0} and len({job.place for job in plan.jobs}) == 4
    assert {one.other for one in plan.pairs} == {plan.base} == {plan.pairs[0].one}
    assert not any(one.scene_has for one in plan.pairs), "the scene has 1956 unknowns"
    assert plan.pairs[1].name == "discretization.dofs 900, effects.kinematics finite" == plan.pairs[1].value
    kinematics = vary.planned("dcb-czm1", words[::2], "nurbs").pairs
    assert [one.scene_has for one in kinematics] == [False, True]
    assert [(one.key, one.value, one.against) for one in kinematics] == [
        ("effects.kinematics", "linear", "linear"), ("effects.kinematics", "finite", "linear")
    ]  # fmt: skip


def test_what_auto_chooses_otherwise_is_said():
    words = ["effects.kinematics=auto", "effects.contact=auto", "load.opening=3.0,0.05"]
    (said,) = [line for line in vary.planned("dcb-czm1", words, "nurbs").left_out if "kinematics" in line]
    assert said == "load.opening 0.05: effects.kinematics is linear by itself, and finite for load.opening 3.0"


def test_ranks_are_runs_of_their_own_under_mpirun(monkeypatch):
    monkeypatch.setattr("shutil.which", lambda name: f"/bin/{name}")
    monkeypatch.setattr(vary, "left_out", lambda job: "")
    pairs = vary.planned("dcb-czm1", [], "dolfinx", (1, 2)).pairs
    assert [(found.name, found.value) for found in pairs] == [("ranks 1", "1"), ("ranks 2", "2")]
    one, two = (found.one for found in pairs)
    assert one.task().key != two.task().key and one.task().program[0] == "verify"
    assert two.task().program[:3] == ("verify.studies.vary", "2", "solve")
    assert vary.under_mpirun("2", ["solve"])[:3] == ["mpirun", "-n", "2"]


@pytest.mark.parametrize(
    ("command", "words", "said"),
    [
        ("effects", ["dcb-czm1", "--set", "effects.contact=3"], 'effects.contact: must be true or false, or "auto"'),
        ("vary", ["dcb-czm1", "--set", "discretization.dofs=900"], "--set: must give a key several values"),
        ("vary", ["dcb-czm1", "--ranks", "1,2"], "--ranks: is only for --method dolfinx, got nurbs"),
        ("vary", ["dcb-czm1", "--method", "lefm", "--set", "load.opening=[1.0,0.5],[1.0]"], "must only increase"),
    ],
)
def test_bad_input_is_refused_before_any_work(command, words, said, tmp_path, capsys):
    assert main([command, *words, "--out", str(tmp_path / "out")]) == 2
    assert said in capsys.readouterr().err and not (tmp_path / "out").exists()


def test_a_dry_run_says_what_would_be_run_and_what_not(tmp_path, capsys):
    assert main(["effects", "peel-60", "--out", str(tmp_path / "out"), "--dry-run"]) == 0
    said = capsys.readouterr().out
    assert "peel-60/effects/nurbs-kinematics-linear " in said and "20 of 20 runs to do: about" in said
    assert "symmetry: left out: " in said and not (tmp_path / "out").exists()


# --- two runs


def test_changes_are_with_over_without():
    found = changes(made_up(1.02), made_up(lost=0.5), (3.0,))
    keys = ("curve_change", "peak_change", "end_change", "work_change")
    assert [found[key] for key in keys] == pytest.approx([0.02] * 4, rel=1e-6)
    assert found["dissipated_change"] == pytest.approx(1.04, rel=1e-6)
    assert isnan(changes(made_up(), made_up(lost=0.0), (3.0,))["dissipated_change"])
    assert changes(made_up(lost=1e-12), made_up(lost=0.0), (3.0,))["dissipated_change"] == 0.0
    assert change(3.0, -2.0, 1.0) == -2.5
    assert [signed(x) for x in (0.0068, -0.0031, 1.04, 0.0, 3e-9)] == ["+0.68 %", "-0.31 %", "+100 %", "0 %", "0 %"]


def there_and_back(back: float) -> Result:
    """P = d up to 1, and (1 + back) d on the way down to 0.5 and up again to 2."""
    d = np.concatenate([np.linspace(0.0, 1.0, 401), np.linspace(1.0, 0.5, 201)[1:], np.linspace(0.5, 2.0, 601)[1:]])
    load = np.where((np.arange(d.size) > 400) & (d < 1.0), 1.0 + back, 1.0) * d
    return Result("nurbs", {"opening": d, "load": load})


def test_what_changes_on_unloading_alone_is_a_change_of_the_curve():
    """An envelope has no unloading: it would be told from the loads beyond the first leg alone."""
    ours, plain, way = there_and_back(0.1), there_and_back(0.0), (1.0, 0.5, 2.0)
    assert distance(cubics(ours), plain) < 1e-12 < apart(ours, plain, way)
    assert apart(ours, plain, way) == pytest.approx(0.1, rel=0.01)
    assert apart(made_up(1.1), made_up(), (3.0,)) == pytest.approx(0.1)


def of(one: Pair, with_it: Sequence[Result | None], without: Sequence[Result | None], stopped: str = "") -> Row:
    """The row of a pair whose runs end so; each with its repetitions."""
    sides = {one.one: with_it, one.other: without}
    outcomes = {job: [Outcome(job, result, stopped) for result in results] for job, results in sides.items()}
    return row(one, {job: o[0] for job, o in outcomes.items()}, {job: o[1:] for job, o in outcomes.items()})


def of_pair(key: str, *runs: Sequence[Result | None], stopped: str = "") -> Row:
    return of(next(one for one in of_effects().pairs if one.key == key), *runs, stopped)


def test_a_row_in_words():
    slow, fast = made_up(1.0068), made_up()
    found = of_pair("kinematics", [slow, *(replace(slow, seconds={"total": t}) for t in (6.2, 6.3))], [fast, fast])
    assert found.sentence == (
        "finite kinematics: curve 0.68 %, +0.68 % peak load, +0.68 % load at the end, +0.68 % dissipated energy, "
        "+0.68 % work, 3.1 x time"
    )
    assert found.scene_has and (found.seconds, found.seconds_against, found.times) == (6.2, 2.0, 1)
    busy = of_pair("symmetry", [fast, fast], [fast, *(made_up(seconds=t) for t in (4.0, 9.0))])
    assert busy.sentence.endswith("0.5 x time (equal runs differ by up to 2.2 x)") and not busy.scene_has
    assert "no dissipated energy to compare" in of_pair("irreversible", [fast, fast], [made_up(lost=0.0)] * 2).sentence
    untimed = of_pair("contact", [fast, fast], [made_up(seconds=None)] * 2)
    assert untimed.complete and untimed.sentence.endswith(", no time")


def test_a_run_that_stopped_keeps_its_row():
    found = of_pair("contact", [made_up()] * 2, [made_up(status="stopped: here")] * 2)
    assert not found.complete and isnan(found.end_change)
    assert found.sentence == "contact: contact = false: stopped: here"
    gone = of_pair("contact", [None], [made_up()] * 2, stopped="failed: signal 9")
    assert gone.sentence == "contact: contact = true: failed: signal 9" and isnan(gone.time_ratio)
    assert (
        "contact = true: broken: energy-ledger 0.25 of 0.005"
        in of_pair("contact", [leaking(made_up())], [made_up()]).status
    )


def test_a_row_has_the_counts_of_its_quickest_run():
    other = vary.planned("dcb-czm1", ["discretization.dofs=900,600"], "nurbs").pairs[1]
    parts = {"mesh": 0.5, "basis": 0.5, "total": 3.0}
    run = replace(made_up(1.02), dofs=600, rejected_steps=4, peak_memory_mb=90.0, seconds=parts)
    found = of(other, [run, replace(run, seconds=parts | {"total": 2.21}), run], [made_up(dofs=900)] * 2)
    counts = (found.dofs, found.steps, found.newton_iterations, found.rejected_steps, found.times)
    assert counts == (600, 120, 484, 4, 1)
    assert found.iteration == pytest.approx(1.21 / 484) and found.time_ratio == pytest.approx(2.21 / 2.0)
    assert found.time_spread == pytest.approx(3.0 / 2.21) and signed(found.peak_change) == "+2 %"


@pytest.mark.parametrize(("key", "guarded"), [("irreversible", True), ("viscosity", True), ("friction", False)])
@pytest.mark.parametrize("scene", ["enf-as4peek", "slb", "mmb50-as4peek"])
def test_what_acts_on_damage_alone_does_not_change_the_slope_at_rest(scene, key, guarded):
    """A precrack that sticks without any check of its own: 45 % more stiffness by reversible damage."""
    plan = of_effects(scene)
    one = next(found for found in plan.pairs if found.key == key)
    stiff, right = (made_up(scale, end=plan.base.scene.load.opening[-1]) for scale in (1.45, 1.0))
    found = of(one, [right], [stiff])
    said = "one of both runs is wrong: at rest, without any damage, the stiffness with it is -31 % off"
    assert found.complete is not guarded and found.status == (said if guarded else "complete")
    assert isnan(found.peak_change) is guarded and of(one, [right], [right]).complete


def test_slopes_at_rest_may_differ_by_rounding():
    one, other = made_up(), made_up(1.0 + 1e-8, condition=1e9)
    assert starts_otherwise(one, other) == [] and starts_otherwise(one, replace(other, condition=1e6)) != []
    assert starts_otherwise(one, Result("x", {"opening": one.opening, "load": one.load})) == []


# --- many runs


def meshes() -> list[Row]:
    return [
        pair("dofs", str(n), "8000", dofs=n, iteration=1e-5 * n**1.25, peak_memory_mb=90.0 + 0.01 * n)
        for n in (8000, 4000, 2000, 1000)
    ]


def test_time_and_memory_grow_with_the_unknowns():
    (said,) = vary.growth(meshes())
    assert said.startswith("1000 to 8000 unknowns: an iteration takes N^1.25 +- 0.00, 0.76 s at the end")
    assert said.endswith("memory grows by 10 MB for every thousand")
    assert vary.growth(meshes()[:2]) == [] == vary.growth([replace(one, dofs=1000) for one in meshes()])
    scattered = [1e-5 * n**1.25 * (1.1 if i % 2 else 0.9) for i, n in enumerate((1000, 2000, 4000, 8000))]
    exponent, error = power([1000, 2000, 4000, 8000], scattered)
    assert abs(exponent - 1.25) < 2.0 * error < 0.4
    assert np.isnan(power([1, 2], [1.0, 2.0])).all()


def test_numbers_are_drawn_as_lines_and_words_as_bars(monkeypatch, tmp_path):
    drawn = Drawn(monkeypatch, pairs_page)
    rows = [replace(one, curve_change=10.0 / one.dofs, seconds=1e-3 * one.dofs) for one in meshes()]
    stopped = replace(rows[0], value="500", status="stopped: here")
    pairs_page.write(vary.Study(SCENE, (*rows, stopped), (), method="nurbs"), tmp_path / "lines.html")
    (_, changes), (_, costs) = drawn
    curve = next(line for line in changes.axes[0].lines if line.get_label() == "curve")
    assert [*curve.get_xdata()] == [8000, 4000, 2000, 1000]
    assert curve.get_ydata() == pytest.approx([0.125, 0.25, 0.5, 1.0])
    time = next(line for line in costs.axes[0].lines if line.get_label() == "time")
    assert time.get_ydata() == pytest.approx([1.0, 0.5, 0.25, 0.125])
    assert "stopped: here" in (tmp_path / "lines.html").read_text()
    words = [replace(one, name=name, value=name) for one, name in zip(rows[:2], ("linear", "finite"), strict=True)]
    pairs_page.write(vary.Study(SCENE, tuple(words), (), method="nurbs"), tmp_path / "bars.html")
    changes, times = (figure.axes[0] for _, figure in drawn[2:])
    assert [text.get_text() for text in changes.get_yticklabels()] == ["linear", "finite"]
    widths = [bar.get_width() for bar in changes.containers[0]]
    assert widths == pytest.approx([100 * one.curve_change for one in words])
    (bars,) = times.containers
    assert [bar.get_x() + bar.get_width() for bar in bars] == pytest.approx([one.time_ratio for one in words])
