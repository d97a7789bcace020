"""What accuracy costs: references with a known limit, rows with known answers, ladders that end, a page."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from math import inf, isnan, nan
from pathlib import Path

import numpy as np
import pytest

from verify.cli import main
from verify.cost import ladder as ladder_of
from verify.cost import reference as reference_of
from verify.cost import study as study_of
from verify.cost.findings import LEVELS, cheapest, growth, of_equal_steps, orders, pareto, table
from verify.cost.ladder import BEAM, FAMILIES, RATIO, Family, Try, ladder, ladders
from verify.cost.nonzeros import nonzeros
from verify.cost.reference import Reference, distance, reference
from verify.cost.row import Row, errors, read_csv, row, traction_error
from verify.cost.study import Study, climb
from verify.folder import write_csv
from verify.jobs import Job, Outcome
from verify.process_zone import expected
from verify.result import Result, Snapshot
from verify.scene import load_scene

SCENE = load_scene("dcb-czm1")
NURBS = next(family for family in FAMILIES if family.name == "nurbs-p3")


def made_up(scale: float = 1.0, wave: float = 0.0, end: float = 3.0, n: int = 40, **about) -> Result:
    """A curve with its exact slopes: P = s (1 + w sin 20 d) d exp(-d), and its own area as what is dissipated."""
    d = np.linspace(0.0, end, n + 1)
    hill, turn = scale * d * np.exp(-d), 1.0 + wave * np.sin(20.0 * d)
    slope = scale * (1.0 - d) * np.exp(-d) * turn + 20.0 * wave * np.cos(20.0 * d) * hill
    steps = {
        "opening": d, "load": hill * turn, "load_slope": slope, "heading": np.ones(n + 1),
        "dissipated_energy": scale * (1.0 - (1.0 + d) * np.exp(-d)), "newton_iterations": np.full(n + 1, 4.0),
    }  # fmt: skip
    phases = dict.fromkeys(("mesh", "basis", "assembly", "factor", "solve", "other"), 0.5)
    return Result("nurbs", steps, seconds={**phases, "total": 3.0}, **{"dofs": 1000, "elements": 100, **about})


def outcome(result: Result | None, why: str = "") -> Outcome:
    return Outcome(Job("x", SCENE, "nurbs", "x"), result, why, failed=bool(why))


def against(result: Result | None = None) -> Reference:
    sure = {"curve": 1e-4, "peak": 1e-4, "energy": 1e-4}
    return Reference("cubic NURBS", result or made_up(n=400), sure, 2.0)


def a_row(method: str, error: float, seconds: float, dofs: int = 500, degree: int = 3, asked: str = "80") -> Row:
    one = row(Try(Family(method, method, degree, 1.0), 0, dofs, asked), [outcome(made_up())], against())
    parts = {"assembly": 0.5 * seconds, "factor": 0.2 * seconds}
    return replace(one, curve_error=error, seconds=seconds, dofs=dofs, peak_memory_mb=100.0, **parts)


# --- the reference


def test_three_meshes_tell_their_order_and_their_uncertainty() -> None:
    """Curves (1 + h^p) f on h = 1/50, 1/100, 1/200: the true error of the finest is h^p, and is bounded."""
    for p in (1.3, 2.0, 4.0):
        results = [made_up(1.0 + (10.0 / n) ** p, elements=n, n=300) for n in (50, 100, 200)]
        found = reference([outcome(result) for result in results], [])
        assert found.order == pytest.approx(p, abs=0.03)
        for name in ("curve", "peak"):
            assert 1.0 < found.uncertainty[name] / (10.0 / 200) ** p < 1.6
        assert "No other code" in found.sentence and isnan(found.apart)


def test_meshes_that_do_not_converge_get_a_cautious_uncertainty() -> None:
    results = [made_up(1.0 + off, elements=n, n=300) for n, off in ((50, 0.01), (100, -0.012), (200, 0.0))]
    found = reference([outcome(result) for result in results], [])
    assert isnan(found.order) and found.uncertainty["curve"] == pytest.approx(0.036, rel=0.01)


def test_another_code_agrees_within_both_uncertainties_or_not() -> None:
    own = [outcome(made_up(1.0 + 100.0 / n**2, elements=n, n=300)) for n in (50, 100, 200)]
    for far, agrees in ((1.006, True), (1.03, False)):
        found = reference(own, [outcome(made_up(far + 0.002)), outcome(made_up(far))])
        assert found.agrees is agrees and ("is " if agrees else "not within") in found.sentence
    assert reference([*own[:2], outcome(None, "not run")], []) is None


def test_a_specimen_that_comes_apart_early_carries_nothing_afterwards() -> None:
    whole = made_up(n=400)
    early = made_up(end=2.0, n=400, ending="separated at opening 2")
    missing = whole.load[whole.opening > 2.0]
    lost = np.sqrt(np.sum(missing**2) / np.sum(whole.load[1:] ** 2))
    assert distance((early.opening, early.load), whole) == pytest.approx(lost, rel=0.01)
    assert distance((whole.opening, whole.load), early) > 0.0


# --- one run


def test_a_run_is_measured_in_every_way() -> None:
    found = errors(made_up(1.01, n=60), against())
    assert found["chords"] == pytest.approx(0.01, rel=0.03) and found["cubics"] == pytest.approx(0.01, rel=1e-3)
    assert found["curve_error"] == min(found["chords"], found["cubics"])
    assert found["peak_error"] == pytest.approx(0.01, rel=1e-3)
    assert found["energy_error"] == pytest.approx(0.01, rel=1e-9)
    assert found["oscillation"] < 1e-3 < errors(made_up(wave=0.02), against())["oscillation"]


def test_few_steps_cost_nothing_where_their_slopes_are_known() -> None:
    found = errors(made_up(n=25), against())
    assert found["curve_error"] == found["cubics"] < 1e-4 < 1e-3 < found["chords"]


def test_times_are_the_least_and_without_compiling() -> None:
    slow = made_up(jit_seconds=0.4)
    quick = replace(slow, seconds={**slow.seconds, "basis": 0.45, "total": 2.0})
    found = row(Try(NURBS, 0, 500, 40), [outcome(slow), outcome(quick)], against(), nonzeros=7)
    assert (found.times, found.seconds, found.jit_seconds) == (2, pytest.approx(1.6), 0.4)
    assert found.basis == pytest.approx(0.05) and found.nonzeros == 7 and found.newton_iterations == 164


def test_a_run_that_stopped_has_no_error_and_is_never_cheapest() -> None:
    for bad in (outcome(made_up(status="stopped: too coarse")), outcome(None, "failed: signal 9")):
        found = row(Try(NURBS, 0, 500, 40), [bad], against())
        assert isnan(found.curve_error) and not found.measured and ("stopped" in found.status or "9" in found.status)
        assert cheapest([found], "1%").best is None and pareto([found]) == []


def profile(shift: float, scale: float = 1.0) -> Snapshot:
    s = np.linspace(0.0, 10.0, 401)
    damage = np.clip((6.0 + shift - s) / 2.0, 0.0, 1.0)
    grids = {"X_euvi": np.zeros((0, 1, 1, 2)), "u_euvi": np.zeros((0, 1, 1, 2)), "stress_euv": np.zeros((0, 1, 1))}
    return Snapshot(1.0, 1.0, s, damage, scale * 4.0 * np.exp(-((s - 6.0 - shift) ** 2)), damage, **grids)


def test_tractions_are_compared_wherever_the_zone_has_come_to() -> None:
    exact = (profile(0.0), profile(0.0))
    assert traction_error((profile(0.313), profile(0.0)), exact) < 1e-3
    assert 0.02 < traction_error((profile(0.313, 1.1), profile(0.0)), exact) < 0.1
    assert isnan(traction_error((), exact))


def test_cost_csv_keeps_its_contract(tmp_path: Path) -> None:
    rows = [a_row("nurbs", 0.002, 3.0), row(Try(NURBS, 0, 9, "auto"), [outcome(None, "no, not run")], against())]
    write_csv(tmp_path / "cost.csv", Row, rows)
    head = (tmp_path / "cost.csv").read_text().splitlines()[0]
    assert head.startswith("method,degree,dofs,curve_error,peak_error,oscillation,seconds,")
    read = read_csv(tmp_path / "cost.csv")
    assert replace(read[0], traction_error=0.0) == replace(rows[0], traction_error=0.0)
    assert isnan(read[1].curve_error) and read[1].status == "no, not run"


# --- what the rows say

ROWS = [
    a_row("nurbs", 0.009, 1.0, 300), a_row("nurbs", 0.0029, 2.0, 500), a_row("nurbs", 0.0008, 4.0, 900),
    a_row("tspline", 0.0025, 1.6, 400), a_row("dolfinx", 0.002, 8.0, 1400, 2),
    a_row("dolfinx", 0.0021, 6.0, 1400, 2, "20"), a_row("beam", 0.0005, 0.1, 0, 0), a_row("lagrange", nan, 0.1),
]  # fmt: skip


def test_the_cheapest_run_has_a_mesh_and_ratios_to_the_others() -> None:
    found = cheapest(ROWS, "0.3%")
    assert (found.best.method, found.best.dofs) == ("tspline", 400)
    assert found.ratio == pytest.approx({"nurbs": 1.25, "dolfinx": 3.75, "beam": 0.0625})
    assert cheapest(of_equal_steps(ROWS), "0.3%").ratio["dolfinx"] == pytest.approx(5.0)
    assert cheapest(ROWS, "0.1%").best.dofs == 900 and "dolfinx" not in cheapest(ROWS, "0.1%").ratio
    lines = table(ROWS)
    assert any("dolfinx-p2" in line and "3.75 x   5.00 at equal steps" in line for line in lines)
    assert "  not reached: dolfinx, lagrange, tspline" in lines


def test_no_other_run_beats_one_of_the_front() -> None:
    front = pareto(ROWS[:6])
    assert [(one.method, one.dofs) for one in front] == [("nurbs", 300), ("tspline", 400), ("nurbs", 900)]
    for one in front:
        assert not any(o.seconds <= one.seconds and o.curve_error < one.curve_error for o in ROWS[:6])


def test_orders_and_growth_are_those_that_were_put_in() -> None:
    sizes = (200, 400, 800, 1600, 3200)
    rows = [a_row("nurbs", 5.0 * n**-1.7, 1e-3 * n**1.2, n) for n in sizes]
    assert orders(rows, 0.0)["nurbs-p3"] == pytest.approx(1.7)
    assert isnan(orders(rows, 5.0 * 500**-1.7)["nurbs-p3"]), "two meshes above the floor tell no order"
    assert growth(rows)["nurbs-p3"]["iteration"] == pytest.approx(1.2)
    assert growth(rows)["nurbs-p3"]["memory"] == pytest.approx(0.0, abs=1e-12)


# --- ladders


def test_rungs_divide_the_process_zone_as_they_say() -> None:
    for name in ("tspline-p3", "nurbs-p3", "lagrange-p3"):
        family = next(one for one in FAMILIES if one.name == name)
        rungs = ladder(SCENE, family)
        assert all(b.size / a.size == pytest.approx(RATIO, rel=0.01) for a, b in zip(rungs, rungs[1:], strict=False))
        last = rungs[-1].job("dcb-czm1", SCENE).solved
        assert expected(last, family.solver).elements == pytest.approx(family.first * RATIO**7, rel=0.15)
    assert [one.steps for one in ladder(SCENE, BEAM)] == [80, 40, 150]


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
    monkeypatch.setattr("verify.methods.dolfinx_installed", lambda: False)
    found, why = ladders("peel-60", load_scene("peel-60"), ())
    assert [family.name for family in found] == ["nurbs-p2", "beam"]
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
    assert study_of._high_enough(last, [last, a_row("dolfinx", 0.004, 3.9, degree=2)])
    assert not study_of._high_enough(last, [last, a_row("dolfinx", 0.004, 4.1, degree=2)])
    assert not study_of._high_enough(last, [last, a_row("nurbs", 0.004, 1.0)]), "methods do not end each other"


def test_a_ladder_has_patience_with_the_quickest_accurate_run() -> None:
    """Of any method, but with a mesh; and no longer than the longest that a run may take."""
    finest, patience = min(LEVELS.values()), study_of.PATIENCE
    accurate, quick = a_row("nurbs", 0.9 * finest, 3.0), a_row("lagrange", 2.0 * finest, 0.01)
    theory = a_row("beam", 0.1 * finest, 0.001, dofs=0)
    for part, ends in ((0.99, False), (1.01, True)):
        last = a_row("dolfinx", 0.02, part * patience * 3.0)
        assert study_of._high_enough(last, [last, accurate, quick, theory]) == ends
        assert not study_of._high_enough(last, [last, quick, theory])
        slow = a_row("dolfinx", 0.02, part * study_of.LONGEST)
        assert study_of._high_enough(slow, [slow]) == ends
    done = a_row("dolfinx", 0.99 * study_of.ENOUGH * finest, 1.0)
    assert study_of._high_enough(done, [done])
    assert not study_of._high_enough(replace(done, curve_error=1.01 * study_of.ENOUGH * finest), [done])


def test_more_is_tried_where_it_may_pay() -> None:
    tries = {Try(NURBS, i, size, 80): a_row("nurbs", e, t, size) for i, (size, e, t) in enumerate(
        [(300, 0.02, 1.0), (420, 0.008, 1.2), (590, 0.002, 1.5), (830, 0.0008, 1.7)])}  # fmt: skip
    sizes = [one.size for one in study_of._best(tries)]
    assert sizes == [420, 590, 830]
    assert [one.size for one in study_of._best(tries, 1.3)] == [420, 590, 830]
    assert [one.size for one in study_of._between(tries)] == [355, 498, 700]
    first = next(iter(tries))
    assert [one.steps for one in first.with_few_steps()] == ["auto", "auto-0.02", "auto-0.05"]
    assert [one.steps for one in first.with_other_steps()] == [40, 150]
    job = replace(first, steps="auto-0.02").job("dcb-czm1", SCENE)
    fewer = load_scene(job.source, job.overrides)
    assert fewer.discretization.steps == "auto" and fewer.discretization.bend == 0.02 and fewer.effects.search == "auto"
    assert [study_of._worth(found) for found in tries.values()] == [False, True, True, True]
    assert [*Try(BEAM, 0, 0, 80).with_few_steps(), *Try(BEAM, 0, 0, 80).with_other_steps()] == []


# --- the whole


def test_the_page_says_it_and_carries_the_rows(tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    pytest.importorskip("jinja2")
    from verify.cost.page import write

    study = Study(SCENE, against(), tuple(ROWS), ("lefm: a <limit>",))
    write(study, tmp_path / "report.html")
    page = (tmp_path / "report.html").read_text()
    assert "Curve error 0.3%: T-spline, degree 3, 400 unknowns" in page and "DOLFINx 3.8 ×" in page
    assert "a &lt;limit&gt;" in page and page.count("<svg") >= 6
    assert "http://" not in page.replace("http://www.w3.org", "") and "https://" not in page
    data = json.loads(re.search(r'class="rows">(.*?)</script>', page, re.DOTALL)[1])
    assert len(data["rows"]) == sum(one.measured for one in ROWS)
    assert len(page) < 1_000_000


def test_cost_json_names_the_cheapest_and_the_front(tmp_path: Path) -> None:
    found = Study(SCENE, against(), tuple(ROWS), ()).summary()
    assert list(found["cheapest"]) == ["1%", "0.3%", "0.1%"]
    assert found["cheapest"]["0.3%"]["method"] == "tspline" and found["cheapest"]["0.3%"]["dofs"] == 400
    assert found["cheapest_at_equal_steps"]["0.3%"]["ratio"]["dolfinx"] == pytest.approx(5.0)
    assert found["pareto"][0]["method"] == "beam" and found["reference"]["uncertainty"]["curve"] == 1e-4


def test_a_scene_that_is_none_is_refused_and_a_dry_run_leaves_nothing(tmp_path: Path, capsys, monkeypatch) -> None:
    out = tmp_path / "out"
    assert main(["cost", "nothing", "--out", str(out)]) == 2
    monkeypatch.setattr(ladder_of, "FAMILIES", (NURBS,))
    assert main(["cost", "dcb-czm1-linear", "--out", str(out), "--dry-run", "--jobs", "2"]) == 0
    said = capsys.readouterr().out
    assert "dcb-czm1-linear/cost/nurbs-p3-" in said and "runs to do, 2 at a time: about" in said
    assert not out.exists()


@pytest.mark.parametrize(("name", "dofs"), [("dcb-czm1", 280), ("peel-60", 600)])
def test_entries_of_the_tangent_are_those_that_forces_depend_on(name: str, dofs: int) -> None:
    """Counted against differences of the residual at a state without symmetry, column after column."""
    from iga.system import respond
    from verify.problems import iga_problem

    scene = load_scene(name, [f"discretization.dofs={dofs}"])
    solver, problem = iga_problem(scene, "nurbs")
    system = solver.build(problem).system
    start, rng = system.start(), np.random.default_rng(1)
    u_d = 1e-4 * rng.random(system.n_dof)
    columns, count = rng.choice(system.n_dof, 30, replace=False), 0
    for d in columns:
        ends = (replace(start, u_d=u_d + sign * 1e-6 * np.eye(1, system.n_dof, d)[0]) for sign in (1, -1))
        ahead, behind = (respond(system, end, decide=False).internal_d for end in ends)
        count += np.count_nonzero(np.abs(ahead - behind) > 1e-9 * np.max(np.abs(ahead - behind)))
    assert count / columns.size == pytest.approx(nonzeros(scene, "nurbs") / system.n_dof, rel=0.15)
    assert nonzeros(scene, "beam") == 0


@pytest.mark.parametrize("seconds", [inf, 0.0])
def test_a_study_from_ladder_to_files(seconds: float, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys) -> None:
    """Runs that need no solver, whose error falls as the third power of the unknowns."""
    monkeypatch.setattr(ladder_of, "FAMILIES", (NURBS,))
    monkeypatch.setattr(reference_of, "dolfinx_installed", lambda: False)
    for name in ("CLIMB", "VARY", "REPEAT"):
        monkeypatch.setattr(study_of, name, seconds)
    asked: list[Job] = []

    def run_all(plan, out, jobs):
        for job in plan:
            asked.append(job)
            size = job.solved.discretization.dofs
            yield Outcome(job, made_up(1.0 + (60.0 / size) ** 3, dofs=size, elements=size, n=120))

    monkeypatch.setattr(study_of, "run_all", run_all)
    monkeypatch.setattr(study_of, "write_page", lambda module, study, path: None)
    found = study_of.cost("dcb-czm1", SCENE, (), tmp_path, 2)
    rows = read_csv(tmp_path / "cost.csv")
    assert (tmp_path / "cost.json").exists() and "written: " in capsys.readouterr().out
    if seconds == 0.0:
        assert any("The time allowed" in text for text in found.left_out) and len(asked) < 12
        return
    assert found.left_out == () and len({job.place for job in asked}) == len(asked)
    best = cheapest(rows, "0.1%").of_method["nurbs"]
    assert best.times == 3 and best.dofs >= 580
    assert {one.asked for one in rows if one.method == "nurbs"} == {"80", "auto", "auto-0.02", "auto-0.05", "40", "150"}


@pytest.mark.slow
def test_a_small_study_for_real(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys) -> None:
    """Two ladders to an opening of 1, and again: the second call runs nothing."""
    few = tuple(replace(f, first=2.0) for f in FAMILIES if f.name in ("nurbs-p2", "tspline-p3"))
    monkeypatch.setattr(ladder_of, "FAMILIES", few)
    monkeypatch.setattr(ladder_of, "RUNGS", 4)
    monkeypatch.setattr(reference_of, "ZONE", (3.0, 6.0, 12.0))
    monkeypatch.setattr(reference_of, "dolfinx_installed", lambda: False)
    command = ["cost", "dcb-czm1-linear", "--set", "load.opening=1.0", "--out", str(tmp_path)]
    assert main(command) == 0
    rows = read_csv(tmp_path / "cost.csv")
    found = json.loads((tmp_path / "cost.json").read_text())
    assert {one.method for one in rows} == {"nurbs", "tspline", "beam"}
    assert found["reference"]["uncertainty"]["curve"] < 0.001
    assert found["cheapest"]["0.3%"]["method"] in ("nurbs", "tspline")
    assert all(one.nonzeros > 0 for one in rows if one.measured and one.method != "beam")
    best = found["cheapest"]["1%"]["run"]
    assert next(one.times for one in rows if one.run == best) == 3
    capsys.readouterr()
    assert main(command) == 0
    assert read_csv(tmp_path / "cost.csv") == rows
    assert not re.search(r"\b1 of", capsys.readouterr().err), "a run is made again"
