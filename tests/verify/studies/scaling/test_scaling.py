"""``debond scaling``: exponents, what is said of many ranks, which runs, and the growth of the solver itself."""

from __future__ import annotations

import csv
import json
import re
import shutil
import sys
from dataclasses import fields, replace
from math import inf, isnan, nan
from pathlib import Path

import numpy as np
import pytest

from verify.cli import main
from verify.result import Result
from verify.runs.jobs import Outcome, run_all
from verify.scene.load import load_scene
from verify.studies import frame
from verify.studies.frame import repeated
from verify.studies.scaling import plan as plan_of
from verify.studies.scaling import ranks as ranks_of
from verify.studies.scaling.growth import fit, serial_part, shared
from verify.studies.scaling.plan import SIZES, Run, elements, planned, sizes
from verify.studies.scaling.row import Row, row
from verify.studies.scaling.study import Study, scaling

SCENE = load_scene("dcb-czm1")

#: Seconds of an iteration for every unknown, megabytes of the program and for every unknown, of the made-up runs.
EACH, PROGRAM, MB = 1e-5, 90.0, 0.01

#: Load average before and after.
LOAD = (0.25, 0.75)


@pytest.fixture
def two_cores(monkeypatch: pytest.MonkeyPatch) -> None:
    """A machine with DOLFINx, mpirun and two cores."""
    monkeypatch.setattr("verify.methods.dolfinx.dolfinx_installed", lambda: True)
    monkeypatch.setattr(plan_of, "cores", lambda: 2)
    monkeypatch.setattr(plan_of.shutil, "which", lambda name: f"/usr/bin/{name}")


def made_up(run: Run, power: float = 1.0) -> Result:
    """Four iterations; more ranks share the assembly and nothing else, and wait 10 ms an iteration for one another."""
    n = run.solved.discretization.dofs if run.method == "nurbs" else 24 * run.solved.dolfinx.elements + 12
    whole = 4 * EACH * n**power * (1.0 + 0.1 * run.repeat)
    parts = {"assembly": 0.5 / run.ranks, "factor": 0.3, "solve": 0.1, "other": 0.1}
    seconds = {"mesh": 1.0, "basis": 2.0} | {name: part * whole for name, part in parts.items()}
    seconds["other"] += 0.04 * (run.ranks > 1)
    return Result(
        run.method,
        {
            "opening": np.linspace(0.0, run.solved.load.opening[-1], 3),
            "load": np.zeros(3),
            "newton_iterations": np.array([0.0, 3.0, 1.0]),
        },
        dofs=n,
        elements=n // 12,
        seconds=seconds | {"total": sum(seconds.values())},
        jit_seconds=0.5,
        peak_memory_mb=PROGRAM + MB * n,
    )


def made_up_rows(power: float = 1.0) -> tuple[Row, ...]:
    return tuple(row(run, [Outcome(run, made_up(run, power))]) for run in planned("dcb-czm1", SCENE)[0])


# --- exponents


def test_the_exponent_of_a_power_law_and_its_error() -> None:
    n = np.array([2e3, 4e3, 1e4, 3e4, 1e5])
    exact = fit(n, 3.0 * n**1.2)
    assert (exact.exponent, exact.factor) == pytest.approx((1.2, 3.0)) and exact.error < 1e-10
    rng = np.random.default_rng(4)
    noisy = [fit(n, n**1.2 * np.exp(0.05 * rng.standard_normal(n.size))) for _ in range(4000)]
    found, errors = (np.array([getattr(one, key) for one in noisy]) for key in ("exponent", "error"))
    assert np.mean(found) == pytest.approx(1.2, abs=0.002)
    assert np.sqrt(np.mean(errors**2)) == pytest.approx(np.std(found), rel=0.03)


def test_too_few_points_have_no_exponent() -> None:
    for values in ([1.0, 2.0], [1.0, np.nan, 2.0], [1.0, 0.0, 2.0], []):
        assert isnan(fit([1.0, 2.0, 3.0][: len(values)], values).exponent)
    assert isnan(fit([5.0, 5.0, 5.0], [1.0, 2.0, 3.0]).exponent)


@pytest.mark.parametrize("ranks", [2, 7])
def test_the_part_that_is_not_shared_gives_back_the_speed_up(ranks: int) -> None:
    for serial in (0.0, 0.3, 1.0, 1.7):
        amdahl = 1.0 / (serial + (1.0 - serial) / ranks)
        assert serial_part(amdahl, ranks) == pytest.approx(serial)
    assert serial_part(0.5, ranks) > 1.0, "slower than one rank"
    assert serial_part(0.0, ranks) == inf and isnan(serial_part(-1.0, ranks)) and isnan(serial_part(nan, ranks))


# --- which runs


def test_the_ladders_span_the_sizes_asked_for(two_cores: None) -> None:
    runs, left_out = planned("dcb-czm1", SCENE)
    assert sizes()[0] == SIZES.smallest and sizes()[-1] == SIZES.largest and len(sizes()) == SIZES.rungs
    for method in ("nurbs", "dolfinx"):
        alone = [run for run in runs if run.method == method and run.ranks == 1]
        assert [run.bare for run in alone] == [True] + [False] * SIZES.rungs
        for run, size in zip(alone, (SIZES.bare, *sizes()), strict=True):
            has = SCENE.effects.model_copy(
                update={"search": method == "nurbs", "shear": False}
            )  # the other one never searches
            assert run.solved.load.opening == (0.015,) and run.solved.effects == has
            if method == "dolfinx":
                assert made_up(run).dofs == pytest.approx(size, abs=24)
    more = [run for run in runs if run.ranks > 1]
    assert [(run.ranks, run.variant) for run in more] == [
        (2, "scaling/dolfinx-20913-2-ranks"), (2, "scaling/dolfinx-100000-2-ranks")
    ]  # fmt: skip
    assert left_out == ("4, 8, 16 ranks: left out: 2 cores here",)
    again = repeated(runs, range(SIZES.times))
    assert len({run.task().key for run in again}) == len(again) == SIZES.times * len(runs)
    task = more[0].task()
    assert task.program[:4] == ("verify.studies.scaling.ranks", "2", "solve", "dcb-czm1") and task.lane == "dolfinx"


def test_the_sizes_of_a_peel_count_both_bodies(two_cores: None) -> None:
    scene = load_scene("peel-60")
    n = elements(scene, 50_000)
    assert plan_of._unknowns(scene, n) == pytest.approx(50_000, rel=0.01)


def test_a_short_programme_has_the_effects_of_the_whole(two_cores: None) -> None:
    """A few steps of it alone would be found linear."""
    given = ("effects.kinematics=auto", "effects.contact=auto")
    for run in planned("dcb-czm1", load_scene("dcb-czm1", given), given)[0]:
        assert run.solved.effects.kinematics == "finite" and run.solved.effects.contact is True
    given = ("effects.symmetry=true",)
    arms = {run.method: run.solved.effects.symmetry for run in planned("dcb-czm1", load_scene("dcb-czm1", given))[0]}
    assert arms == {"nurbs": True, "dolfinx": False}, "a model that has both arms"


def test_what_others_published_of_the_whole_programme_is_no_part_of_a_short_one(two_cores: None) -> None:
    scene = load_scene("compdam-dcb")
    assert scene.published and all(run.solved.published == () for run in planned("compdam-dcb", scene)[0])


def test_what_is_not_there_is_left_out_in_words(two_cores: None, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(plan_of, "cores", lambda: 1)
    assert "2, 4, 8, 16 ranks: left out: 1 core here" in planned("dcb-czm1", SCENE)[1]
    monkeypatch.setattr(plan_of.shutil, "which", lambda name: None)
    assert "more than 1 rank: left out: mpirun is not installed" in planned("dcb-czm1", SCENE)[1]
    monkeypatch.setattr("verify.methods.dolfinx.dolfinx_installed", lambda: False)
    runs, left_out = planned("dcb-czm1", SCENE)
    assert {run.method for run in runs} == {"nurbs"}
    assert left_out == ("dolfinx: not run: DOLFINx is not installed",)


def test_ranks_are_started_by_mpirun_in_the_place_of_the_process(monkeypatch: pytest.MonkeyPatch) -> None:
    became: list[tuple[str, list[str]]] = []
    monkeypatch.setattr(ranks_of.shutil, "which", lambda name: f"/usr/bin/{name}")
    monkeypatch.setattr(ranks_of.os, "execvp", lambda *words: became.append(words))
    ranks_of.main(["2", "solve", "dcb-czm1"])
    words = ["mpirun", "-n", "2", sys.executable, "-P", "-m", "verify", "solve", "dcb-czm1"]
    assert became == [("mpirun", words)]
    monkeypatch.setattr(ranks_of.shutil, "which", lambda name: None)
    with pytest.raises(SystemExit, match="mpirun is not installed"):
        ranks_of.main(["2", "solve"])


# --- what rows say


def test_a_row_is_an_iteration_without_what_is_paid_once(two_cores: None) -> None:
    run = next(run for run in planned("dcb-czm1", SCENE)[0] if run.variant == "scaling/nurbs-2000")
    found = row(run, [Outcome(again, made_up(again)) for again in (replace(run, repeat=1), run)])
    assert found.iteration == pytest.approx(EACH * 2000) and found.spread == pytest.approx(1.1)
    assert (found.assembly, found.newton_iterations, found.times) == (pytest.approx(0.5 * EACH * 2000), 4, 2)
    assert found.set_up == pytest.approx(2.5) and found.measured
    gone = row(run, [Outcome(run, None, "failed: signal 9")])
    assert not gone.measured and gone.status == "failed: signal 9"
    short = row(run, [Outcome(run, replace(made_up(run), status="stopped: here"))])
    assert not short.measured and short.status == "stopped: here"


def test_growth_with_and_without_the_memory_of_the_program(two_cores: None) -> None:
    study = Study(SCENE, made_up_rows(1.2), (), LOAD)
    for fits in study.growth.values():
        assert fits["iteration"].exponent == pytest.approx(1.2) == fits["factor"].exponent
        assert fits["model_memory_mb"].exponent == pytest.approx(1.0, abs=0.03)
        assert fits["peak_memory_mb"].exponent < 0.8, "the program's own hides how the mesh grows"
    assert study.program_mb("nurbs") == pytest.approx(PROGRAM + MB * SIZES.bare)


def test_two_ranks_that_share_the_assembly_alone(two_cores: None) -> None:
    rows = made_up_rows()
    few, most = shared(rows)
    assert most.speed_up["assembly"] == pytest.approx(2.0) and most.serial["assembly"] == pytest.approx(0.0, abs=1e-9)
    assert most.speed_up["factor"] == pytest.approx(1.0) and most.serial["factor"] == pytest.approx(1.0)
    assert few.speed_up["iteration"] < most.speed_up["iteration"], "the waiting weighs more on the smaller size"
    assert most.efficiency == most.speed_up["iteration"] / 2


def test_doubtful_times_are_told(two_cores: None) -> None:
    rows = made_up_rows()
    assert Study(SCENE, rows, (), LOAD).busy == []
    slow = [replace(one, iteration=3 * one.iteration, spread=1.5) if one.ranks > 1 else one for one in rows]
    differ, slower = Study(SCENE, tuple(slow), (), LOAD).busy
    assert slower.startswith("More ranks were slower than one")
    assert differ.startswith("Equal runs differ by up to 1.5 x")


# --- the whole


def test_a_study_from_runs_to_files(two_cores: None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys) -> None:
    asked: list[int] = []

    def pretended(plan, out, jobs, scheduler):
        asked.append(jobs)
        for run in plan:
            yield Outcome(run, made_up(run))

    monkeypatch.setattr(frame, "run_all", pretended)
    found = scaling("dcb-czm1", SCENE, (), tmp_path)
    assert found.complete and asked == [1], "one run at a time"
    said = capsys.readouterr().out
    assert "nurbs, degree 3, 2000 to 100000 unknowns: an iteration takes N^1.00 +- 0.00 (1 s at the end)" in said
    assert "4, 8, 16 ranks: left out" in said and "on 2 ranks: 1.3 x as fast (assembly 2 x), efficiency 66%" in said
    with (tmp_path / "scaling.csv").open(newline="") as stream:
        lines = list(csv.DictReader(stream))
    assert list(lines[0]) == [field.name for field in fields(Row)] and len(lines) == 2 * (SIZES.rungs + 1) + 2
    about = json.loads((tmp_path / "scaling.json").read_text())
    assert about["growth"]["dolfinx"]["iteration"]["exponent"] == pytest.approx(1.0)
    assert len(about["strong_scaling"]) == 2 and about["left_out"]
    pytest.importorskip("matplotlib")
    page = (tmp_path / "report.html").read_text()
    assert page.count("<svg") == 3 and "And on many ranks?" in page and "None were tried" in page
    assert re.search(r"the serial part f = 0\.\d+ were", page) and "about 5 ranks" in page
    assert "http://" not in page.replace("http://www.w3.org", "") and "https://" not in page


def test_one_rank_says_nothing_of_many(two_cores: None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(plan_of, "cores", lambda: 1)

    def pretended(plan, out, jobs, scheduler):
        for run in plan:
            stopped = replace(made_up(run), status="stopped: here")
            yield Outcome(run, stopped if run.variant.startswith("scaling/nurbs-2000") else made_up(run))

    monkeypatch.setattr(frame, "run_all", pretended)
    found = scaling("dcb-czm1", SCENE, (), tmp_path)
    assert not found.complete and found.shared == []
    pytest.importorskip("matplotlib")
    page = (tmp_path / "report.html").read_text()
    assert "has no result on many ranks" in page and "And on many ranks?" not in page and "stopped: here" in page


def test_bad_input_is_refused_and_a_dry_run_leaves_nothing(
    two_cores: None, tmp_path: Path, capsys: pytest.CaptureFixture, monkeypatch: pytest.MonkeyPatch
) -> None:
    out = tmp_path / "out"
    for words, said in (
        (["nothing"], "neither a packaged scene nor a file"),
        (["dcb-czm1", "--set", "effects.contact=3"], 'effects.contact: must be true, false or "auto", got 3'),
    ):
        assert main(["scaling", *words, "--out", str(out)]) == 2
        assert said in capsys.readouterr().err
    assert main(["scaling", "dcb-czm1", "--out", str(out), "--dry-run"]) == 0
    said = capsys.readouterr().out
    assert "dcb-czm1/scaling/dolfinx-100000-2-ranks " in said and "32 of 32 runs to do: about" in said
    monkeypatch.setenv("OMPI_COMM_WORLD_SIZE", "2")
    assert main(["scaling", "dcb-czm1", "--out", str(out)]) == 2
    assert "scaling: must be started in 1 process" in capsys.readouterr().err and not out.exists()


@pytest.mark.slow
def test_two_ranks_through_the_sweep_find_the_load_of_one(tmp_path: Path) -> None:
    pytest.importorskip("dolfinx", reason="DOLFINx is not installed")
    if shutil.which("mpirun") is None:
        pytest.skip("mpirun is not installed")
    one = next(run for run in planned("dcb-czm1", SCENE)[0] if run.variant == "scaling/dolfinx-2000")
    both = {outcome.job: outcome for outcome in run_all([one, replace(one, ranks=2, variant="two")], tmp_path, 1)}
    alone, together = (both[job].result for job in sorted(both, key=lambda job: job.ranks))
    assert alone is not None and together is not None and alone.complete and together.complete
    assert together.load == pytest.approx(alone.load, rel=1e-8, abs=1e-8 * alone.load.max())
    assert together.dofs == alone.dofs


@pytest.fixture(scope="module")
def measured(tmp_path_factory: pytest.TempPathFactory) -> dict:
    """The growth of the ``iga`` solver on this machine."""
    out = tmp_path_factory.mktemp("scaling")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("verify.methods.dolfinx.dolfinx_installed", lambda: False)
        assert main(["scaling", "dcb-czm1", "--out", str(out)]) == 0
    return json.loads((out / "scaling.json").read_text())


@pytest.mark.slow
def test_growth_of_the_solver_itself(measured: dict) -> None:
    """From 2,000 to 100,000 unknowns: the time of an iteration within N^1.25, the memory within N^1.15."""
    growth = {what: one["exponent"] for what, one in measured["growth"]["nurbs"].items()}
    assert 0.7 < growth["iteration"] <= 1.25
    assert 0.0 < growth["peak_memory_mb"] <= growth["model_memory_mb"] <= 1.15


@pytest.mark.slow
def test_memory_of_a_hundred_thousand_unknowns(measured: dict) -> None:
    largest = max(measured["measured"], key=lambda one: one["dofs"])
    assert largest["dofs"] == pytest.approx(100_000, rel=0.02)
    assert largest["peak_memory_mb"] <= 1500.0


def test_cores_are_those_that_a_process_may_use(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ranks_of.os, "sched_getaffinity", lambda process: {0, 3, 5}, raising=False)
    monkeypatch.setattr(ranks_of.os, "cpu_count", lambda: 16)
    assert ranks_of.cores() == 3
    monkeypatch.delattr(ranks_of.os, "sched_getaffinity")
    assert ranks_of.cores() == 16
    monkeypatch.setattr(ranks_of.os, "cpu_count", lambda: None)
    assert ranks_of.cores() == 1


def test_of_one_code_nothing_is_said_of_many_ranks(two_cores: None) -> None:
    alone = tuple(one for one in made_up_rows() if one.method == "nurbs")
    study = Study(SCENE, alone, (), LOAD)
    assert study.shared == []
    assert study.summary()["load_average"] == [0.25, 0.75] and list(study.growth) == ["nurbs"]
