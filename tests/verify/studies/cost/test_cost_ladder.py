"""What accuracy costs, run after run: ladders that end, what else is tried, and the whole study."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from math import inf, nan
from pathlib import Path
from types import SimpleNamespace

import pytest
from made_up_costs import NURBS, SCENE, a_row, against, made_up, outcome

from iga.bases.names import BASES
from verify.cli import main
from verify.methods.zone_resolution import expected
from verify.runs.jobs import Job, Outcome
from verify.scene.load import load_scene
from verify.studies import frame
from verify.studies.cost import ladder as ladder_of
from verify.studies.cost import reference as reference_of
from verify.studies.cost import study as study_of
from verify.studies.cost.contenders import best, between, few_steps, other_models
from verify.studies.cost.findings import LEVELS, cheapest
from verify.studies.cost.ladder import BEAM_FAMILIES, FAMILIES, LADDER, Family, Try, ladder, ladders
from verify.studies.cost.reference import reference_jobs
from verify.studies.cost.row import Row, row
from verify.studies.cost.study import climb
from verify.support.checked_files import read_table
from verify.support.refusal import NotRun


def test_rungs_divide_the_process_zone_as_they_say() -> None:
    for name in ("tspline-p3", "nurbs-p3", "lagrange-p3"):
        family = next(one for one in FAMILIES if one.name == name)
        rungs = ladder(SCENE, family)
        assert all(
            b.size / a.size == pytest.approx(LADDER.ratio, rel=0.01) for a, b in zip(rungs, rungs[1:], strict=False)
        )
        last = rungs[-1].job("dcb-czm1", SCENE).solved
        assert expected(last, family.solver).elements == pytest.approx(family.first * LADDER.ratio**7, rel=0.15)
    assert [one.steps for one in ladder(SCENE, BEAM_FAMILIES[0])] == [80, 40, 150]


def test_every_run_repeats_what_the_study_was_given() -> None:
    scene = load_scene("dcb-czm1", ["load.opening=1.0"])
    job = Try(NURBS, 0, 600, "auto", repeat=2).job("dcb-czm1", scene, ("load.opening=1.0",))
    repeated = load_scene("dcb-czm1", job.overrides)
    assert repeated == job.solved and repeated.load.opening == (1.0,)
    assert (repeated.discretization.dofs, repeated.discretization.interface_points) == (600, 5)
    assert repeated.discretization.steps == "auto" and job.variant.endswith("nurbs-p3-600-auto-steps-again-2")


def test_methods_that_cannot_are_left_out_with_a_sentence(monkeypatch: pytest.MonkeyPatch) -> None:
    few = tuple(f for f in FAMILIES if f.name in ("tspline-adaptive", "nurbs-p2", "dolfinx-p1", "dolfinx-p2"))
    monkeypatch.setattr(ladder_of, "FAMILIES", few)
    monkeypatch.setattr("verify.methods.dolfinx.dolfinx_installed", lambda: False)
    found, why = ladders("peel-60", load_scene("peel-60"), ())
    assert [family.name for family in found] == ["nurbs-p2", "beam", "beam-3"]
    assert why == [
        "tspline-adaptive: left out: only the mesh of a dcb follows the process zone",
        "dolfinx: not run: DOLFINx is not installed",
    ]


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
    rungs = {
        family: [Try(family, i, 100 * 2**i, 40) for i in range(4)]
        for family in (Family(method, method, 3, 1.0) for method in told)
    }
    runner = Climber(told)
    assert climb(rungs, runner, runner.rows)
    assert {method: sum(one.family.method == method for one in runner.done) for method in told} == {
        "nurbs": 3, "dolfinx": 3, "lagrange": 4
    }  # fmt: skip
    hurried = Climber(told, most=5)
    assert not climb(rungs, hurried, hurried.rows) and len(hurried.done) == 6


def test_a_degree_that_another_beats_by_far_goes_no_further() -> None:
    last = a_row("dolfinx", 0.004, 10.0, degree=4)
    assert study_of._finished(last, [last, a_row("dolfinx", 0.004, 6.5, degree=2)])
    assert not study_of._finished(last, [last, a_row("dolfinx", 0.004, 6.8, degree=2)])
    assert not study_of._finished(last, [last, a_row("nurbs", 0.004, 1.0)]), "methods do not end each other"


def test_a_ladder_has_patience_with_the_quickest_accurate_run() -> None:
    """Of any method, but with a mesh; and no longer than the longest that a run may take."""
    finest, patience = min(LEVELS.values()), study_of.LIMITS.patience
    accurate, quick = a_row("nurbs", 0.9 * finest, 3.0), a_row("lagrange", 2.0 * finest, 0.01)
    theory = a_row("beam", 0.1 * finest, 0.001, dofs=0)
    for part, ends in ((0.99, False), (1.01, True)):
        last = a_row("dolfinx", 0.02, part * patience * 3.0)
        assert study_of._finished(last, [last, accurate, quick, theory]) == ends
        assert not study_of._finished(last, [last, quick, theory])
        slow = a_row("dolfinx", 0.02, part * study_of.LIMITS.longest)
        assert study_of._finished(slow, [slow]) == ends
    done = a_row("dolfinx", 0.99 * study_of.LIMITS.enough * finest, 1.0)
    assert study_of._finished(done, [done])
    assert not study_of._finished(replace(done, curve_error=1.01 * study_of.LIMITS.enough * finest), [done])


def test_more_is_tried_where_it_may_pay() -> None:
    tries = {Try(NURBS, i, size, 80): a_row("nurbs", e, t, size) for i, (size, e, t) in enumerate(
        [(300, 0.02, 1.0), (420, 0.008, 1.2), (590, 0.002, 1.5), (830, 0.0008, 1.7)])}  # fmt: skip
    sizes = [one.size for one in best(tries)]
    assert sizes == [420, 590, 830]
    assert [one.size for one in best(tries, 1.3)] == [420, 590, 830]
    assert [one.size for one in between(tries)] == [355, 498, 700]
    first = next(iter(tries))
    assert [one.steps for one in first.with_few_steps("0.1%")] == ["auto", "auto-0.02"]
    assert [one.steps for one in first.with_other_steps()] == [40, 150]
    job = replace(first, steps="auto-0.02").job("dcb-czm1", SCENE)
    fewer = load_scene(job.source, job.overrides)
    assert fewer.discretization.steps == "auto" and fewer.discretization.bend == 0.02 and fewer.effects.search == "auto"
    assert [
        *Try(BEAM_FAMILIES[0], 0, 0, 80).with_few_steps("1%"),
        *Try(BEAM_FAMILIES[0], 0, 0, 80).with_other_steps(),
    ] == []


def test_other_models_of_dolfinx_are_tried_on_its_best_meshes_and_the_next_coarser_ones() -> None:
    family = next(one for one in FAMILIES if one.name == "dolfinx-p2")
    runs = {
        Try(family, i, size, 80): a_row("dolfinx", error, seconds, size, 2)
        for i, (size, error, seconds) in enumerate([(56, 0.02, 1.0), (78, 0.002, 1.5), (110, 0.0008, 2.0)])
    } | {Try(NURBS, 0, 420, 80): a_row("nurbs", 0.0005, 1.0)}
    tried = other_models(runs)
    assert {one.size for one in tried} == {56, 78, 110} and {one.family for one in tried} == {family}
    assert {one.model for one in tried if one.size == 56} == {"more-points"}
    asked = {one.model: one.job("dcb-czm1", SCENE).solved.dolfinx for one in tried if one.size == 78}
    assert (asked["fewer-points"].interface_points, asked["more-points"].interface_points) == (3, 7)
    assert asked["more-layers"].layers == 2 and asked["more-layers"].elements == 78


def test_few_steps_are_tried_on_the_coarsest_meshes_that_may_win() -> None:
    """For every accuracy the two coarsest of a family, none that is twice as slow as the method's quickest."""
    slow = Family("nurbs", "nurbs", 4, 1.0)
    tries = {
        Try(NURBS, i, size, 80): a_row("nurbs", error, seconds, size)
        for i, (size, error, seconds) in enumerate(
            [(300, 0.02, 1.0), (420, 0.011, 1.2), (590, 0.002, 1.5), (830, 0.0011, 1.7), (900, 0.0009, 2.0)]
        )
    } | {
        Try(slow, 0, 500, 80): a_row("nurbs", 0.002, 2.9, 500, 4),
        Try(slow, 1, 700, 80): a_row("nurbs", 0.001, 3.6, 700, 4),
    }
    tried = {(one.family.degree, one.size, one.steps) for one in few_steps(tries)}
    assert tried == {
        *((3, size, steps) for size in (420, 590) for steps in LADDER.few_steps["1%"]),
        *((3, size, steps) for size in (590, 830) for steps in LADDER.few_steps["0.3%"]),
        *((3, size, steps) for size in (830, 900) for steps in LADDER.few_steps["0.1%"]),
        *((4, 500, steps) for steps in LADDER.few_steps["0.3%"]),
    }
    coarse, counted = Try(NURBS, 0, 9, 80), Try(NURBS, 0, 8, 40)
    assert few_steps({coarse: a_row("nurbs", 0.5, 1.0), counted: a_row("nurbs", 0.001, 1.0, asked="40")}) == []


def test_a_scene_that_is_none_is_refused_and_a_dry_run_leaves_nothing(tmp_path: Path, capsys, monkeypatch) -> None:
    out = tmp_path / "out"
    assert main(["cost", "nothing", "--out", str(out)]) == 2
    monkeypatch.setattr(ladder_of, "FAMILIES", (NURBS,))
    assert main(["cost", "dcb-czm1-linear", "--out", str(out), "--dry-run", "--jobs", "2"]) == 0
    said = capsys.readouterr().out
    assert "dcb-czm1-linear/cost/nurbs-p3-" in said and "runs to do, 2 at a time: about" in said
    assert not out.exists()


@pytest.mark.parametrize("seconds", [inf, 0.0])
def test_a_study_from_ladder_to_files(seconds: float, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys) -> None:
    """Runs that need no solver, whose error falls as the third power of the unknowns."""
    monkeypatch.setattr(ladder_of, "FAMILIES", (NURBS,))
    monkeypatch.setattr(reference_of, "dolfinx_installed", lambda: False)
    limits = replace(study_of.LIMITS, climb=seconds, vary=seconds, repeat=seconds)
    monkeypatch.setattr(study_of, "LIMITS", limits)
    asked: list[Job] = []

    def run_all(plan, out, jobs, scheduler=None):
        for job in plan:
            asked.append(job)
            size = job.solved.discretization.dofs
            yield Outcome(job, made_up(1.0 + (60.0 / size) ** 3, dofs=size, elements=size, n=120))

    monkeypatch.setattr(study_of, "run_all", run_all)
    monkeypatch.setattr(frame, "run_all", run_all)
    monkeypatch.setattr(frame, "write_page", lambda module, study, path: None)
    found = study_of.cost("dcb-czm1", SCENE, (), tmp_path, 2)
    rows = read_table(tmp_path / "cost.csv", Row)
    assert (tmp_path / "cost.json").exists() and "written: " in capsys.readouterr().out
    if seconds == 0.0:
        assert any("The time allowed" in text for text in found.left_out) and len(asked) < 12
        return
    assert found.left_out == () and len({job.place for job in asked}) == len(asked)
    cheap = cheapest(rows, "0.1%").of_method["nurbs"]
    assert cheap.times == study_of.LIMITS.times and cheap.dofs >= 580
    few = {"auto", "auto-0.02", "auto-0.05", "auto-0.1"}
    assert {one.asked for one in rows if one.method == "nurbs"} == {"80", *few, "40", "150"}


@pytest.mark.slow
def test_a_small_study_for_real(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys) -> None:
    """Two ladders to an opening of 1, and again: the second call runs nothing."""
    few = tuple(replace(f, first=2.0) for f in FAMILIES if f.name in ("nurbs-p2", "tspline-p3"))
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
    assert all(one.nonzeros > 0 for one in rows if one.measured and not one.method.startswith("beam"))
    best = found["cheapest"]["1%"]["run"]
    assert next(one.times for one in rows if one.run == best) == study_of.LIMITS.times
    capsys.readouterr()
    assert main(command) == 0
    assert str(read_table(tmp_path / "cost.csv", Row)) == str(rows)  # some numbers are NaN
    assert not re.search(r"\b1 of", capsys.readouterr().err), "a run is made again"


def test_families_are_the_methods_with_the_degrees_that_they_have() -> None:
    """T-splines are cubic; the higher the degree, the fewer elements a process zone begins with."""
    degrees: dict[str, list[int]] = {}
    for one in FAMILIES:
        degrees.setdefault(one.method, []).append(one.degree)
    known = {
        "tspline": [3],
        "tspline-adaptive": [3],
        "nurbs": [2, 3, 4],
        "lagrange": [2, 3, 4],
        "dolfinx": [1, 2, 3, 4],
    }
    assert degrees == known | {name: list(basis.coarsest) for name, basis in BASES.items() if basis.coarsest}
    for method in degrees:
        first = [one.first for one in FAMILIES if one.method == method]
        assert first == sorted(first, reverse=True) and 0.5 <= first[-1] <= first[0] <= 4.0
    assert len({one.name for one in FAMILIES}) == len(FAMILIES)
    assert [(one.name, one.degree, one.beam, one.adaptive) for one in BEAM_FAMILIES] == [
        ("beam", 0, True, False), ("beam-3", 0, True, False),
    ]  # fmt: skip


def test_a_plug_in_that_names_its_degrees_has_the_meshes_of_dolfinx(monkeypatch: pytest.MonkeyPatch) -> None:
    """Others have none. Its rows need opening and load alone, and few steps are not tried, as it counts them."""

    def missing() -> None:
        raise NotRun("not run: it does not import")

    made = {"mine": lambda: SimpleNamespace(degrees={2: 1.0}), "plain": lambda: SimpleNamespace(), "broken": missing}
    monkeypatch.setattr(ladder_of, "plugins", lambda: {name: SimpleNamespace(load=load) for name, load in made.items()})
    (mine,) = ladder_of.of_plugins()
    dolfinx = next(one for one in FAMILIES if one.name == "dolfinx-p2")
    assert [one.size for one in ladder(SCENE, mine)] == [one.size for one in ladder(SCENE, dolfinx)] != []
    first = ladder(SCENE, mine)[0]
    assert first.job("dcb-czm1", SCENE).overrides == ladder(SCENE, dolfinx)[0].job("dcb-czm1", SCENE).overrides
    assert not list(first.with_few_steps("1%")) and list(first.with_other_steps())
    result = made_up()
    bare = replace(result, steps={name: result.steps[name] for name in ("opening", "load")})
    found = row(first, [outcome(bare)], against())
    assert found.measured and found.curve_error < 0.002
    assert set(cheapest([found, a_row("nurbs", 0.001, 1.0)], "1%").codes) == {"iga"}


def test_the_reference_is_cubic_whatever_code_it_is_of(monkeypatch: pytest.MonkeyPatch) -> None:
    """And of one arm where both are alike."""
    monkeypatch.setattr("verify.studies.cost.reference.dolfinx_installed", lambda: True)
    own, other = reference_jobs("dcb-czm1", load_scene("dcb-czm1"), ())
    assert {job.method for job in own} == {"nurbs"} and {job.method for job in other} == {"dolfinx"}
    assert {job.solved.discretization.degree for job in own} == {3} == {job.solved.dolfinx.degree for job in other}
    sizes = [job.solved.discretization.dofs for job in own]
    assert sizes == sorted(sizes) and len(own) == 3 and len(other) == 2
    assert all(job.solved.effects.symmetry is True for job in own)
    assert all(job.variant.startswith("reference/") for job in (*own, *other))
    strip, _ = reference_jobs("peel-60", load_scene("peel-60"), ())
    assert not any("symmetry" in key for job in strip for key in job.overrides)
    monkeypatch.setattr("verify.studies.cost.reference.dolfinx_installed", lambda: False)
    assert reference_jobs("dcb-czm1", load_scene("dcb-czm1"), ())[1] == ()


def test_entries_are_counted_where_a_run_that_is_measured_does_not_tell_them(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[tuple[str, str]] = []

    def count(scene: str, method: str) -> int:
        asked.append((scene, method))
        return 123

    monkeypatch.setattr(study_of, "nonzeros", count)
    told, untold, failed = (replace(a_row("nurbs", error, 1.0), nonzeros=0) for error in (1e-3, 2e-3, nan))
    rows = {"told": replace(told, nonzeros=7), "untold": untold, "failed": failed}
    job = SimpleNamespace(job=SimpleNamespace(solved="the scene", method="nurbs"))
    runner = SimpleNamespace(rows=rows, found=dict.fromkeys(rows, job))
    counted = list(study_of._with_nonzeros(runner))
    assert [one.nonzeros for one in counted] == [7, 123, 0] and asked == [("the scene", "nurbs")]
