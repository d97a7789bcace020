"""``debond vary``: its runs, what their rows tell, its charts, and what it refuses."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from tests.verify.figures import Drawn
from tests.verify.made_up_studies import pair
from tests.verify.studies.effects.test_effects_study import made_up
from verify.cli import main
from verify.runs.jobs import Outcome
from verify.scene.load import load_scene
from verify.studies import pairs_page
from verify.studies.pairs import Row, row, signed
from verify.studies.vary import ranks
from verify.studies.vary.plan import VALUES, planned
from verify.studies.vary.study import Study, chosen_otherwise, growth, power


@pytest.mark.parametrize(
    ("text", "values"),
    [
        ("1", ["1"]),
        ("0,1e-3,0.1", ["0", "1e-3", "0.1"]),
        ("linear,finite", ["linear", "finite"]),
        ("[1,2],[1,3]", ["[1,2]", "[1,3]"]),
        ("[[1,2],[3,4]]", ["[[1,2],[3,4]]"]),
        ('"a,b",c', ['"a,b"', "c"]),
    ],
)
def test_values_of_a_key(text: str, values: list[str]) -> None:
    assert VALUES.findall(text) == values


def test_every_combination_is_held_against_the_first() -> None:
    words = ["interface.strength=5", "discretization.dofs=900,600", "effects.kinematics=linear,finite"]
    plan = planned("dcb-czm1", words, "nurbs")
    solved = [one.one.solved for one in plan.pairs]
    chosen = [(scene.discretization.dofs, scene.effects.kinematics) for scene in solved]
    assert chosen == [(900, "linear"), (900, "finite"), (600, "linear"), (600, "finite")]
    assert {scene.interface.strength for scene in solved} == {5.0}
    assert {one.other for one in plan.pairs} == {plan.pairs[0].one} and len({one.one.place for one in plan.pairs}) == 4
    assert not any(one.scene_has for one in plan.pairs), "the scene has 1956 unknowns"
    kinematics = planned("dcb-czm1", ["interface.strength=5", "effects.kinematics=linear,finite"], "nurbs").pairs
    assert [one.scene_has for one in kinematics] == [False, True]
    assert plan.pairs[1].name == "discretization.dofs 900, effects.kinematics finite" == plan.pairs[1].value


def test_a_single_key_gives_its_values_alone() -> None:
    plan = planned("dcb-czm1", ["discretization.dofs=900,600"], "nurbs")
    assert [(one.key, one.value, one.against) for one in plan.pairs] == [
        ("discretization.dofs", "900", "900"), ("discretization.dofs", "600", "900")
    ]  # fmt: skip


def test_what_auto_chooses_otherwise_is_said() -> None:
    words = ["effects.kinematics=auto", "effects.contact=auto", "load.opening=3.0,0.05"]
    (said,) = [line for line in chosen_otherwise(planned("dcb-czm1", words, "nurbs")) if "kinematics" in line]
    assert said == "load.opening 0.05: effects.kinematics is linear by itself, and finite for load.opening 3.0"


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ([], "--set: must give a key several values"),
        (["--set", "discretization.dofs=900"], "--set: must give a key several values"),
        (["--set", "interface.strength=5,-1"], "interface.strength: must be > 0, got -1"),
        (["--set", "interface.strenth=5,6"], "did you mean"),
        (["--set", "discretization.dofs=", "--set", "interface.strength=5,6"], "discretization.dofs"),
        (["--ranks", "1,2"], "--ranks: is only for --method dolfinx, got nurbs"),
        (["--method", "lefm", "--set", "load.opening=[1.0,0.5],[1.0]"], "load.opening: must only increase"),
    ],
)
def test_bad_input_is_refused_before_any_work(words: list[str], said: str, tmp_path: Path, capsys) -> None:
    assert main(["vary", "dcb-czm1", *words, "--out", str(tmp_path / "out")]) == 2
    assert said in capsys.readouterr().err and not (tmp_path / "out").exists()


def test_ranks_are_runs_of_their_own_under_mpirun(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("shutil.which", lambda name: f"/bin/{name}")
    monkeypatch.setattr("verify.studies.vary.plan.left_out", lambda job: "")
    one, two = (pair.one for pair in planned("dcb-czm1", [], "dolfinx", (1, 2)).pairs)
    assert one.task().key != two.task().key and one.task().program[0] == "verify"
    assert two.task().program[:3] == ("verify.studies.vary.ranks", "2", "solve")
    assert ranks.command("2", ["solve"])[:3] == ["mpirun", "-n", "2"]


def test_a_row_has_the_counts_of_its_fastest_run() -> None:
    plan = planned("dcb-czm1", ["discretization.dofs=900,600"], "nurbs")
    first, other = plan.pairs[0].one, plan.pairs[1].one
    parts = {"mesh": 0.5, "basis": 0.5, "total": 3.0}
    counted = {"newton_iterations": np.ones(121)}
    run = made_up(1.02)
    run = replace(run, steps={**run.steps, **counted}, dofs=600, rejected_steps=4, peak_memory_mb=90.0, seconds=parts)
    base = made_up()
    base = replace(base, steps={**base.steps, **counted}, dofs=900)
    runs = {first: [base, base], other: [run, replace(run, seconds=parts | {"total": 2.21}), run]}
    outcomes = {job: [Outcome(job, one) for one in results] for job, results in runs.items()}
    found = row(plan.pairs[1], {job: o[0] for job, o in outcomes.items()}, {job: o[1:] for job, o in outcomes.items()})
    assert (found.dofs, found.steps, found.newton_iterations, found.rejected_steps, found.times) == (
        600,
        120,
        121,
        4,
        1,
    )
    assert found.iteration == pytest.approx(1.21 / 121) and found.time_ratio == pytest.approx(2.21 / 2.0)
    assert found.time_spread == pytest.approx(3.0 / 2.21) and signed(found.peak_change) == "+2 %"


def ladder() -> list[Row]:
    return [
        pair("dofs", str(n), "8000", dofs=n, iteration=1e-5 * n**1.25, peak_memory_mb=90.0 + 0.01 * n)
        for n in (8000, 4000, 2000, 1000)
    ]


def test_time_and_memory_grow_with_the_unknowns() -> None:
    (said,) = growth(ladder())
    assert said.startswith("1000 to 8000 unknowns: an iteration takes N^1.25 +- 0.00, 0.76 s at the end")
    assert said.endswith("memory grows by 10 MB for every thousand")
    assert growth(ladder()[:2]) == [] == growth([replace(one, dofs=1000) for one in ladder()])
    scattered = [1e-5 * n**1.25 * (1.1 if i % 2 else 0.9) for i, n in enumerate((1000, 2000, 4000, 8000))]
    exponent, error = power([1000, 2000, 4000, 8000], scattered)
    assert abs(exponent - 1.25) < 2.0 * error < 0.4
    assert np.isnan(power([1, 2], [1.0, 2.0])).all()


def test_numbers_are_drawn_as_lines_and_words_as_bars(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    drawn, scene = Drawn(monkeypatch, pairs_page), load_scene("dcb-czm1")
    rows = [replace(one, curve_change=10.0 / one.dofs, seconds=1e-3 * one.dofs) for one in ladder()]
    stopped = replace(rows[0], value="500", status="stopped: here")
    pairs_page.write(Study(scene, (*rows, stopped), (), method="nurbs"), tmp_path / "lines.html")
    (_, changes), (_, costs) = drawn
    curve = next(line for line in changes.axes[0].lines if line.get_label() == "curve")
    assert [*curve.get_xdata()] == [8000, 4000, 2000, 1000]
    assert curve.get_ydata() == pytest.approx([0.125, 0.25, 0.5, 1.0])
    time = next(line for line in costs.axes[0].lines if line.get_label() == "time")
    assert time.get_ydata() == pytest.approx([1.0, 0.5, 0.25, 0.125])
    assert "stopped: here" in (tmp_path / "lines.html").read_text()
    words = [replace(one, name=name, value=name) for one, name in zip(rows[:2], ("linear", "finite"), strict=True)]
    pairs_page.write(Study(scene, tuple(words), (), method="nurbs"), tmp_path / "bars.html")
    changes, times = (figure.axes[0] for _, figure in drawn[2:])
    assert [text.get_text() for text in changes.get_yticklabels()] == ["linear", "finite"]
    widths = [bar.get_width() for bar in changes.containers[0]]
    assert widths == pytest.approx([100 * one.curve_change for one in words])
    (bars,) = times.containers
    assert [bar.get_x() + bar.get_width() for bar in bars] == pytest.approx([one.time_ratio for one in words])
