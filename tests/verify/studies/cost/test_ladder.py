"""What accuracy costs, run after run: ladders that end, what else is tried, and the whole study."""

from __future__ import annotations

import json
import os
import re
from dataclasses import replace
from math import inf, nan
from pathlib import Path
from types import SimpleNamespace

import pytest
from made_up_costs import NURBS, SCENE, a_row, against, ladder, made_up, outcome, planted

from iga.bases.names import BASES
from verify.cli import main
from verify.methods.zone_resolution import expected
from verify.runs import environment
from verify.scene.load import load_scene
from verify.studies import frame
from verify.studies.cost import ladder as ladder_of
from verify.studies.cost import reference as reference_of
from verify.studies.cost import study as study_of
from verify.studies.cost.contenders import best, between, few_steps, other_models
from verify.studies.cost.findings import LEVELS, cheapest
from verify.studies.cost.ladder import BEAM_FAMILIES, FAMILIES, LADDER, Family, Try, ladders
from verify.studies.cost.row import Row, row
from verify.studies.cost.study import LIMITS, _finished, climb
from verify.support.checked_files import read_table
from verify.support.refusal import NotRun


def of_name(name: str) -> Family:
    return next(one for one in FAMILIES if one.name == name)


# --- meshes


@pytest.mark.parametrize("name", ["tspline-p3", "nurbs-p3", "lagrange-p3"])
def test_rungs_divide_the_process_zone_as_they_say(name: str) -> None:
    family = of_name(name)
    sizes = [one.size for one in ladder_of.ladder(SCENE, family)]
    assert [b / a for a, b in zip(sizes, sizes[1:], strict=False)] == pytest.approx([LADDER.ratio] * 7, rel=0.01)
    last = ladder_of.ladder(SCENE, family)[-1].job("dcb-czm1", SCENE).solved
    assert expected(last, family.solver).elements == pytest.approx(family.first * LADDER.ratio**7, rel=0.15)
    assert [one.steps for one in ladder_of.ladder(SCENE, BEAM_FAMILIES[0])] == [80, 40, 150]


def test_every_run_repeats_what_the_study_was_given() -> None:
    scene = load_scene("dcb-czm1", ["load.opening=1.0"])
    job = Try(NURBS, 0, 600, "auto-0.02", repeat=2).job("dcb-czm1", scene, ("load.opening=1.0",))
    repeated = load_scene("dcb-czm1", job.overrides)
    assert repeated == job.solved and repeated.load.opening == (1.0,) and repeated.effects.search == "auto"
    mesh = repeated.discretization
    assert (mesh.dofs, mesh.interface_points, mesh.steps, mesh.bend) == (600, 5, "auto", 0.02)
    assert job.variant.endswith("nurbs-p3-600-auto-0.02-steps-again-2")


def test_methods_that_cannot_are_left_out_with_a_sentence(monkeypatch: pytest.MonkeyPatch) -> None:
    few = tuple(map(of_name, ("tspline-adaptive", "nurbs-p2", "dolfinx-p1", "dolfinx-p2")))
    monkeypatch.setattr(ladder_of, "FAMILIES", few)
    monkeypatch.setattr("verify.methods.dolfinx.dolfinx_installed", lambda: False)
    found, why = ladders("peel-60", load_scene("peel-60"), ())
    assert [family.name for family in found] == ["nurbs-p2", "beam", "beam-3"]
    assert why == [
        "tspline-adaptive: left out: only the mesh of a dcb follows the process zone",
        "dolfinx: not run: DOLFINx is not installed",
    ]


def test_the_higher_the_degree_the_fewer_elements_a_process_zone_begins_with() -> None:
    for method in {one.method for one in FAMILIES}:
        first = {one.degree: one.first for one in FAMILIES if one.method == method}
        assert [*first] == sorted(first) and [*first.values()] == sorted(first.values(), reverse=True)
    assert {one.degree for one in FAMILIES if one.solver == "tspline"} == {3} and len({*FAMILIES}) == len(FAMILIES)
    assert {one.solver for one in FAMILIES} == {"dolfinx", *(name for name, basis in BASES.items() if basis.coarsest)}


def test_a_plug_in_that_names_its_degrees_has_the_meshes_of_dolfinx(monkeypatch: pytest.MonkeyPatch) -> None:
    """Others have none. Its rows need opening and load alone, and few steps are not tried, as it counts them."""

    def missing() -> None:
        raise NotRun("not run: it does not import")

    made = {"mine": lambda: SimpleNamespace(degrees={2: 1.0}), "plain": lambda: SimpleNamespace(), "broken": missing}
    monkeypatch.setattr(ladder_of, "plugins", lambda: {name: SimpleNamespace(load=load) for name, load in made.items()})
    (mine,) = ladder_of.of_plugins()
    own, theirs = (ladder_of.ladder(SCENE, family) for family in (mine, of_name("dolfinx-p2")))
    assert [one.size for one in own] == [one.size for one in theirs] != []
    assert own[0].job("dcb-czm1", SCENE).overrides == theirs[0].job("dcb-czm1", SCENE).overrides
    assert not list(own[0].with_few_steps("1%")) and list(own[0].with_other_steps())
    result = made_up()
    bare = replace(result, steps={name: result.steps[name] for name in ("opening", "load")})
    found = row(own[0], [outcome(bare)], against())
    assert found.measured and found.curve_error < 0.002
    assert set(cheapest([found, a_row("nurbs", 0.001, 1.0)], "1%").codes) == {"iga"}


# --- how far a ladder goes


class Climber:
    """Runs that take and miss what they are told to, by family and rung."""

    def __init__(self, told: dict[str, list[tuple[float, float]]], most: float = inf) -> None:
        self.told, self.done, self.most = told, [], most

    def __call__(self, tries) -> bool:
        self.done += [one for one in tries if one not in self.done]
        return len(self.done) < self.most

    def rows(self) -> dict[Try, Row]:
        return {one: a_row(one.family.method, *self.told[one.family.method][one.rung], one.size) for one in self.done}


def test_a_ladder_ends_where_it_is_accurate_or_too_slow() -> None:
    told = {
        "nurbs": [(0.02, 1.0), (0.004, 1.5), (0.0006, 2.0), (inf, inf)],
        "dolfinx": [(0.05, 5.0), (0.03, 10.0), (0.02, 30.0), (0.01, 60.0)],
        "lagrange": [(0.02, 1.0), (0.01, 1.0), (nan, 1.0), (0.003, 1.0)],
    }
    families = (Family(method, method, 3, 1.0) for method in told)
    rungs = {family: [Try(family, i, 100 * 2**i, 40) for i in range(4)] for family in families}
    runner = Climber(told)
    assert climb(rungs, runner, runner.rows)
    counts = {method: sum(one.family.method == method for one in runner.done) for method in told}
    assert counts == {"nurbs": 3, "dolfinx": 3, "lagrange": 4}
    hurried = Climber(told, most=5)
    assert not climb(rungs, hurried, hurried.rows) and len(hurried.done) == 6


FINEST = min(LEVELS.values())
ACCURATE, QUICK = a_row("nurbs", 0.9 * FINEST, 3.0), a_row("lagrange", 2.0 * FINEST, 0.01)
THEORY = a_row("beam", 0.1 * FINEST, 0.001, dofs=0)
PATIENCE = 3.0 * LIMITS.patience


@pytest.mark.parametrize(
    ("last", "others", "ends"),
    [
        (a_row("dolfinx", 0.004, 10.0, degree=4), [a_row("dolfinx", 0.004, 6.5, degree=2)], True),
        (a_row("dolfinx", 0.004, 10.0, degree=4), [a_row("dolfinx", 0.004, 6.8, degree=2)], False),
        (a_row("dolfinx", 0.004, 10.0, degree=4), [a_row("nurbs", 0.004, 1.0)], False),
        (a_row("dolfinx", 0.02, 0.99 * PATIENCE), [ACCURATE, QUICK, THEORY], False),
        (a_row("dolfinx", 0.02, 1.01 * PATIENCE), [ACCURATE, QUICK, THEORY], True),
        (a_row("dolfinx", 0.02, 1.01 * PATIENCE), [QUICK, THEORY], False),
        (a_row("dolfinx", 0.02, 0.99 * LIMITS.longest), [], False),
        (a_row("dolfinx", 0.02, 1.01 * LIMITS.longest), [], True),
        (a_row("dolfinx", 0.99 * LIMITS.enough * FINEST, 1.0), [], True),
        (a_row("dolfinx", 1.01 * LIMITS.enough * FINEST, 1.0), [], False),
    ],
)
def test_a_ladder_has_patience_with_the_quickest_accurate_run(last: Row, others: list[Row], ends: bool) -> None:
    """Of any method, but with a mesh; of its own method it is beaten by far; and no run is longer than the longest."""
    assert _finished(last, [last, *others]) is ends


# --- what else is tried


def tries(*known: tuple[float, float, float], family: Family = NURBS) -> dict[Try, Row]:
    """Rows of meshes by size, error and seconds."""
    return {
        Try(family, i, size, 80): a_row(family.method, error, seconds, size, family.degree)
        for i, (size, error, seconds) in enumerate(known)
    }


def test_more_is_tried_where_it_may_pay() -> None:
    found = tries((300, 0.02, 1.0), (420, 0.008, 1.2), (590, 0.002, 1.5), (830, 0.0008, 1.7))
    assert [one.size for one in best(found)] == [420, 590, 830] == [one.size for one in best(found, 1.3)]
    assert [one.size for one in between(found)] == [355, 498, 700]
    first, beam = next(iter(found)), Try(BEAM_FAMILIES[0], 0, 0, 80)
    assert [one.steps for one in first.with_few_steps("0.1%")] == ["auto", "auto-0.02"]
    assert [one.steps for one in first.with_other_steps()] == [40, 150]
    assert [*beam.with_few_steps("1%"), *beam.with_other_steps()] == []


def test_runs_that_may_only_have_come_out_late_are_timed_again() -> None:
    """What a machine does besides takes some milliseconds, which short runs are lost in; a run that was timed once may
    be half as long again, one that was timed twice has had its chance."""

    def rungs(*seconds: tuple[float, int], within: tuple[float, ...] = ()) -> set[int]:
        made = (replace(a_row("nurbs", 0.002, each), times=times) for each, times in seconds)
        return {one.rung for one in best({Try(NURBS, i, 500, 40): one for i, one in enumerate(made, 1)}, *within)}

    short = ((0.020, 2), (0.024, 2), (0.045, 2), (0.056, 2))
    assert rungs(*short) == {1} and rungs(*short, within=(LIMITS.close, LIMITS.close)) == {1, 2}
    assert rungs(*short, within=(LIMITS.close, LIMITS.close, LIMITS.late)) == {1, 2, 3}
    once = ((0.40, 2), (0.60, 1), (0.60, 2), (0.48, 2), (0.70, 1))
    assert rungs(*once, within=(LIMITS.close, LIMITS.once)) == {1, 2, 4}


def test_other_models_of_dolfinx_are_tried_on_its_best_meshes_and_the_next_coarser_ones() -> None:
    family = of_name("dolfinx-p2")
    found = tries((56, 0.02, 1.0), (78, 0.002, 1.5), (110, 0.0008, 2.0), family=family) | tries((420, 0.0005, 1.0))
    tried = other_models(found)
    assert {one.size for one in tried} == {56, 78, 110} and {one.family for one in tried} == {family}
    assert {one.model for one in tried if one.size == 56} == {"more-points"}
    asked = {one.model: one.job("dcb-czm1", SCENE).solved.dolfinx for one in tried if one.size == 78}
    assert (asked["fewer-points"].interface_points, asked["more-points"].interface_points) == (3, 7)
    assert asked["more-layers"].layers == 2 and asked["more-layers"].elements == 78


def test_few_steps_are_tried_on_the_coarsest_meshes_that_may_win() -> None:
    """For every accuracy the two coarsest of a family, none that is twice as slow as the method's quickest."""
    found = tries((300, 0.02, 1.0), (420, 0.011, 1.2), (590, 0.002, 1.5), (830, 0.0011, 1.7), (900, 0.0009, 2.0))
    found |= tries((500, 0.002, 2.9), (700, 0.001, 3.6), family=Family("nurbs", "nurbs", 4, 1.0))
    wanted = {"1%": [(3, 420), (3, 590)], "0.3%": [(3, 590), (3, 830), (4, 500)], "0.1%": [(3, 830), (3, 900)]}
    assert {(one.family.degree, one.size, one.steps) for one in few_steps(found)} == {
        (*mesh, steps) for level, meshes in wanted.items() for mesh in meshes for steps in LADDER.few_steps[level]
    }
    counted = {Try(NURBS, 0, 8, 40): a_row("nurbs", 0.001, 1.0, asked="40")}
    assert few_steps(tries((9, 0.5, 1.0)) | counted) == []


# --- the whole study


def test_a_scene_that_is_none_is_refused_and_a_dry_run_leaves_nothing(tmp_path: Path, capsys, monkeypatch) -> None:
    out = tmp_path / "out"
    assert main(["cost", "nothing", "--out", str(out)]) == 2
    monkeypatch.setattr(ladder_of, "FAMILIES", (NURBS,))
    assert main(["cost", "dcb-czm1-linear", "--out", str(out), "--dry-run", "--jobs", "2"]) == 0
    said = capsys.readouterr().out
    assert "dcb-czm1-linear/cost/nurbs-p3-" in said and "runs to do, 2 at a time: about" in said
    assert not out.exists()


@pytest.mark.parametrize("seconds", [inf, 0.0])
def test_a_study_from_ladder_to_rows(seconds: float, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ladder_of, "FAMILIES", (NURBS,))
    monkeypatch.setattr(reference_of, "dolfinx_installed", lambda: False)
    monkeypatch.setattr(study_of, "LIMITS", replace(LIMITS, climb=seconds, vary=seconds, repeat=seconds))
    monkeypatch.setattr(frame, "write_page", lambda module, study, path: None)
    asked = planted(monkeypatch, ladder)
    found = study_of.cost("dcb-czm1", SCENE, (), tmp_path, 2)
    if seconds == 0.0:
        assert any("The time allowed" in text for text in found.left_out) and len(asked) < 12
        return
    assert found.left_out == () and len({job.place for job, *_ in asked}) == len(asked)
    cheap = cheapest(found.rows, "0.1%").of_method["nurbs"]
    assert cheap.times == LIMITS.times and cheap.dofs >= 580
    few = {"auto", "auto-0.02", "auto-0.05", "auto-0.1"}
    assert {one.asked for one in found.rows if one.method == "nurbs"} == {"80", *few, "40", "150"}


@pytest.mark.parametrize("status", ["stopped: here", "not run: too coarse"])
def test_without_a_reference_nothing_is_measured(status: str, tmp_path: Path, monkeypatch, capsys) -> None:
    """What stands in the way is said; whatever is run has one thread."""
    for name in environment.THREADS:
        monkeypatch.setenv(name, "7")
    monkeypatch.setattr(reference_of, "dolfinx_installed", lambda: False)
    asked = planted(monkeypatch, lambda job: made_up(status=status))
    assert study_of.cost("dcb-czm1", SCENE, (), tmp_path, 2) is None
    said = capsys.readouterr().err
    assert re.search(
        rf"no converged reference of dcb-czm1, so that nothing can be measured: reference/\S+: {status}", said
    )
    assert [os.environ[name] for name in environment.THREADS] == ["1"] * 3
    assert len(asked) == 3 and not list(tmp_path.iterdir())


def test_what_is_timed_runs_alone_and_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Until the time is over: what has begun comes to its end, nothing else is begun."""
    now = [0.0]

    def tick(job) -> object:
        now[0] += 10.0
        return made_up()

    asked = planted(monkeypatch, tick)
    monkeypatch.setattr(study_of, "monotonic", lambda: now[0])
    first = [Try(NURBS, i, size, 80) for i, size in enumerate((300, 420, 590, 830))]
    runner = study_of.Runner("dcb-czm1", SCENE, (), tmp_path, against(), (), start=0.0)
    assert runner(first[:2]) and not runner(first, seconds=25.0) and list(runner.found) == first[:3]
    assert runner(first, seconds=45.0) and runner(first, seconds=0.0), "nothing is left to do"
    assert len(asked) == 4 and {jobs for _, jobs, _ in asked} == {1}
    assert runner([replace(first[1], repeat=number) for number in (1, 2)]) and list(runner.rows) == first
    assert [found.times for found in runner.rows.values()] == [1, 3, 1, 1]


@pytest.mark.slow
def test_a_small_study_for_real(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys) -> None:
    """Two ladders to an opening of 1, and again: the second call runs nothing."""
    few = tuple(replace(of_name(name), first=2.0) for name in ("nurbs-p2", "tspline-p3"))
    monkeypatch.setattr(ladder_of, "FAMILIES", few)
    monkeypatch.setattr(ladder_of, "LADDER", replace(ladder_of.LADDER, rungs=4))
    monkeypatch.setattr(reference_of, "MESHES", replace(reference_of.MESHES, zone=(3.0, 6.0, 12.0)))
    monkeypatch.setattr(reference_of, "dolfinx_installed", lambda: False)
    command = ["cost", "dcb-czm1-linear", "--set", "load.opening=1.0", "--out", str(tmp_path)]
    assert main(command) == 0
    rows = read_table(tmp_path / "cost.csv", Row)
    found = json.loads((tmp_path / "cost.json").read_text())
    assert {one.method for one in rows} == {"nurbs", "tspline", "beam", "beam-3"}
    assert found["reference"]["uncertainty"]["curve"] < 0.001
    assert found["cheapest"]["0.3%"]["method"] in ("nurbs", "tspline")
    quickest = found["cheapest"]["1%"]["run"]
    assert next(one.times for one in rows if one.run == quickest) == LIMITS.times
    capsys.readouterr()
    assert main(command) == 0
    assert str(read_table(tmp_path / "cost.csv", Row)) == str(rows)  # some numbers are NaN
    assert not re.search(r"\b1 of", capsys.readouterr().err), "a run is made again"
