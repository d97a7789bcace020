"""What accuracy costs, run after run: the grid, which runs come next, and the whole study."""

from __future__ import annotations

import json
import os
import re
from dataclasses import replace
from math import inf, nan
from types import SimpleNamespace

import pytest
from made_up_costs import NURBS, SCENE, a_row, against, ladder, made_up, outcome, planted

from verify import verification
from verify.checks.judgement import NO_DEMANDS, judged
from verify.cli import main
from verify.methods.zone_resolution import expected
from verify.runs import environment, verdict_file
from verify.runs.jobs import Job, Outcome
from verify.scene.load import load_scene
from verify.studies import frame
from verify.studies.cost import plan as plan_of
from verify.studies.cost import reference as reference_of
from verify.studies.cost import study as study_of
from verify.studies.cost.findings import cheapest
from verify.studies.cost.grid import BEAM_FAMILIES, FAMILIES, GRID, Family, Meshes, Try, meshes, of_plugins
from verify.studies.cost.plan import LEVELS, QUICK, WHOLE_STUDY, Plan
from verify.studies.cost.row import Row, row
from verify.studies.cost.study import UNFINISHED, Study, first, moves, searched, turn
from verify.support.checked_files import read_table

DOLFINX = next(one for one in FAMILIES if one.name == "dolfinx-p2")
SIZES = tuple(float(round(100 * 1.4 ** (0.5 * i))) for i in range(15))


def of_methods(*families: Family) -> list[Meshes]:
    return [Meshes(family, SIZES) for family in families]


def rows(*known: tuple[Family, int, int | str, float, float], model: str = "") -> dict[Try, Row]:
    """Rows of meshes by their places: family, place, steps, error, seconds."""
    made = {}
    for family, at, steps, error, seconds in known:
        one = Try(family, SIZES[at] if family.degree else 0.0, steps, model=model)
        made[one] = a_row(family.method, error, seconds, int(one.size), family.degree, str(steps))
    return made


def told(tries: list[Try]) -> set[tuple[int, int | str, str]]:
    return {(SIZES.index(one.size), one.steps, one.model) for one in tries}


# --- the grid


@pytest.mark.parametrize("name", ["tspline-p3", "lagrange-p3", "dolfinx-p2"])
def test_meshes_divide_the_process_zone_as_they_say(name):
    family = next(one for one in FAMILIES if one.name == name)
    grid = meshes(SCENE, family)
    assert grid.sizes[2] / grid.sizes[0] == pytest.approx(GRID.ratio, rel=0.05) and len(grid.sizes) >= 14
    last = Try(family, grid.sizes[-1], 80).job("dcb-czm1", SCENE).solved
    assert expected(last, family.solver).elements == pytest.approx(family.first * GRID.ratio**7, rel=0.15)


def test_every_run_repeats_what_the_study_was_given():
    scene = load_scene("dcb-czm1", ["load.opening=1.0"])
    job = Try(NURBS, 600, "auto-0.02", repeat=2).job("dcb-czm1", scene, ("load.opening=1.0",))
    repeated = load_scene("dcb-czm1", job.overrides)
    assert repeated == job.solved and repeated.load.opening == (1.0,) and repeated.effects.search == "auto"
    mesh = repeated.discretization
    assert (mesh.dofs, mesh.interface_points, mesh.steps, mesh.bend) == (600, 5, "auto", 0.02)
    asked = Try(DOLFINX, 78, 80, model="more-points").job("dcb-czm1", SCENE).solved.dolfinx
    assert (asked.interface_points, asked.elements) == (7, 78)


def test_a_plug_in_that_names_its_degrees_has_the_meshes_of_dolfinx(monkeypatch):
    """Its rows need opening and load alone, and it counts its steps."""
    made = {"mine": SimpleNamespace(degrees={2: 1.0}), "plain": SimpleNamespace()}
    found = {name: SimpleNamespace(load=lambda one=one: one) for name, one in made.items()}
    monkeypatch.setattr("verify.methods.plugins.plugins", lambda: found)
    (mine,) = of_plugins()
    own, theirs = (meshes(SCENE, family) for family in (mine, DOLFINX))
    assert own.sizes == theirs.sizes
    one, other = (first(grid, WHOLE_STUDY)[0] for grid in (own, theirs))
    assert one.job("dcb-czm1", SCENE).overrides == other.job("dcb-czm1", SCENE).overrides
    assert [few.steps for few in own.few_steps(one, 0.01)] == [80, 40]
    result = made_up()
    bare = replace(result, steps={name: result.steps[name] for name in ("opening", "load")})
    assert row(one, [outcome(bare)], against()).measured


# --- which runs come next

COARSE = (NURBS, 0, 80, 0.05, 1.0)


@pytest.mark.parametrize(
    ("known", "goes_on"),
    [
        ([], True),
        ([(BEAM_FAMILIES[0], 0, 80, 1e-5, 0.001)], True),
        ([(NURBS, 4, 80, 0.0005, 1.0)], False),
        ([(Family("nurbs", "nurbs", 4, 1.0), 0, 80, 0.0005, 0.9)], False),
        ([(Family("nurbs", "nurbs", 4, 1.0), 0, 80, 0.0005, 2.2)], True),
        ([(DOLFINX, 4, 80, 0.0005, 0.6)], True),
        ([(DOLFINX, 4, 80, 0.0005, 0.2)], False),
        ([(Family("nurbs", "nurbs", 4, 1.0), 0, "auto", 0.0005, 0.1)], True),
    ],
    ids=["alone", "a beam", "reached", "beaten", "may win", "slower", "far too slow", "few steps come later"],
)
def test_a_family_is_refined_while_one_of_its_runs_may_win(known, goes_on):
    """Held against its method and, with more patience, against all with a mesh: not against the beam, whose runs have
    unknowns, too, and not at equal steps against few."""
    found = moves(rows(COARSE, *known), of_methods(NURBS), replace(WHOLE_STUDY, aims=("0.1%",)))
    assert ((2, 80, "") in told([one for one in found if one.family == NURBS])) is goes_on


def test_a_code_of_others_is_refined_however_quick_ours_are():
    """To its own best mesh and steps; not where another run of its own is quicker."""
    moose, ours = Family("moose", "moose", 2, 1.0), (NURBS, 4, 80, 0.0005, 0.01)
    known, aim = (moose, 0, 80, 0.05, 5.0), replace(WHOLE_STUDY, aims=("0.1%",))
    assert told(moves(rows(ours, known), of_methods(moose), aim)) == {(2, 80, "")}
    beaten = moves(rows(ours, known, (moose, 4, 80, 0.0005, 3.0)), of_methods(moose), aim)
    assert (2, 80, "") not in told(beaten)


def test_a_run_that_stops_is_passed_and_the_longest_is_the_last():
    for known, goes_on in (((nan, nan), True), ((0.05, 0.99 * WHOLE_STUDY.longest), False), ((0.011, 20.0), True)):
        found = moves(rows((NURBS, 0, 80, *known)), of_methods(NURBS), WHOLE_STUDY)
        assert bool(found) is goes_on


def test_from_the_cheapest_the_search_goes_to_what_takes_less_time():
    """And to other models of DOLFINx, from the cheapest of its degrees alone, once its few steps are known."""
    aim = replace(WHOLE_STUDY, aims=("0.3%",))
    ladder = [(DOLFINX, 2, 80, 0.02, 1.0), (DOLFINX, 4, 80, 0.002, 1.2)]
    models = {(4, 80, "fewer-points"), (3, 80, "more-points"), (3, 80, "more-layers")}
    steps = {(3, 80, ""), (4, "auto-0.02", ""), (4, "auto-0.05", "")}
    assert told(moves(rows(*ladder), of_methods(DOLFINX), aim)) == steps
    ladder += [(DOLFINX, 4, "auto-0.05", 0.006, 0.5), (DOLFINX, 4, "auto-0.02", 0.006, 0.6)]
    assert told(moves(rows(*ladder), of_methods(DOLFINX), aim)) == {(3, 80, "")} | models
    beaten = rows(*ladder, (replace(DOLFINX, degree=3), 0, 80, 0.002, 1.1))
    assert moves(beaten, of_methods(DOLFINX), aim) == []


def test_a_near_miss_has_a_finer_neighbour():
    """0.315 % where 0.3 % is asked: one mesh finer, or more steps, would do; not so if it is slower already."""
    aim, hit = replace(WHOLE_STUDY, aims=("0.3%",)), (DOLFINX, 4, 80, 0.002, 1.2)
    miss = DOLFINX, 4, "auto-0.05", 0.00315
    for error, seconds, tried in ((0.00315, 0.6, True), (0.00315, 1.21, False), (0.0046, 0.6, False)):
        found = told(moves(rows(hit, (*miss[:3], error, seconds)), of_methods(DOLFINX), aim))
        assert ({(5, "auto-0.05", ""), (4, "auto-0.02", "")} <= found) is tried
    at_equal_steps = moves(rows((DOLFINX, 4, 80, 0.002, 1.2), (DOLFINX, 3, 80, 0.0032, 1.1)), of_methods(DOLFINX), aim)
    assert (3, "auto-0.05", "") in told(at_equal_steps)


def test_the_search_finds_the_cheapest_of_the_whole_grid():
    """Errors of mesh and steps that add up: the least time of all runs is met within a fifth, by a third of them."""
    left = {"80": 0.0001, "40": 0.0004, "auto": 0.0002, "auto-0.02": 0.0009, "auto-0.05": 0.0022, "auto-0.1": 0.006}
    spent = {"80": 1.0, "40": 0.7, "auto": 0.5, "auto-0.02": 0.25, "auto-0.05": 0.2, "auto-0.1": 0.17}

    def solved(one: Try) -> Row:
        steps, n = str(one.steps), one.size / 100.0
        each = 0.3 + n * spent[steps]
        return a_row("nurbs", 0.04 * n**-3 + left[steps], each, int(one.size), one.family.degree, steps)

    grids, known = of_methods(NURBS), {}
    tries = first(grids[0], WHOLE_STUDY)
    while tries:
        known.update((one, solved(one)) for one in tries)
        tries = moves(known, grids, WHOLE_STUDY)
    every = [solved(Try(NURBS, size, steps)) for size in SIZES for steps in GRID.steps]
    assert len(known) < 0.35 * len(every)
    for level in LEVELS:
        found, best = (cheapest(ones, level).best for ones in ([*known.values()], every))
        assert found is not None and best is not None and found.seconds <= 1.2 * best.seconds, level


def test_what_may_win_is_timed_again_in_turns():
    """Of every method, at its best and at equal steps, all in one turn, until each has had its turns."""
    aim = replace(WHOLE_STUDY, aims=("0.3%",))
    found = rows(
        (NURBS, 4, 80, 0.002, 1.2), (NURBS, 4, "auto-0.05", 0.0025, 0.30), (NURBS, 5, "auto-0.05", 0.002, 0.34),
        (NURBS, 6, "auto-0.05", 0.001, 0.36), (NURBS, 3, "auto-0.1", 0.0035, 0.1), (DOLFINX, 4, "auto", 0.002, 2.0),
        (DOLFINX, 5, 80, 0.001, 3.0), (DOLFINX, 6, 80, 0.001, 3.1),
    )  # fmt: skip
    chosen = [0, 1, 2, 5, 6]
    assert {*turn(found, aim)} == {replace(one, repeat=1) for i, one in enumerate(found) if i in chosen}
    timed = {one: replace(known, times=1 + aim.turns * (i in chosen)) for i, (one, known) in enumerate(found.items())}
    assert turn(timed, aim) == []


# --- the whole study


@pytest.fixture
def alone(monkeypatch):
    """NURBS and the beam, without DOLFINx, and no page."""
    monkeypatch.setattr(plan_of, "FAMILIES", (NURBS,))
    monkeypatch.setattr("verify.methods.dolfinx.dolfinx_installed", lambda: False)
    monkeypatch.setattr(reference_of, "dolfinx_installed", lambda: False)
    monkeypatch.setattr(frame, "write_page", lambda module, study, path: None)


@pytest.mark.parametrize("seconds", [inf, 0.0])
def test_a_study_from_its_reference_to_its_rows(seconds, tmp_path, alone, monkeypatch):
    asked = planted(monkeypatch, ladder)
    found = searched("dcb-czm1", SCENE, (), tmp_path, 2, Plan(seconds=seconds))
    if seconds == 0.0:
        assert found.left_out == (UNFINISHED,) and len(asked) == 4 and found.sentence.endswith(UNFINISHED)
        return
    assert found.left_out == () and len({job.place for job, *_ in asked}) == len(asked)
    assert {jobs for job, jobs, _ in asked if job.variant.startswith("cost/")} == {1}, "what is timed runs alone"
    cheap = cheapest(found.rows, "0.1%").of_method["nurbs"]
    assert cheap.times == 1 + WHOLE_STUDY.turns and cheap.dofs >= 580


def test_a_verification_begins_where_its_runs_say(tmp_path, alone, monkeypatch):
    """A run that is 100 times nearer than asked, with 7 elements in a zone: the search begins coarser, not coarsest."""
    asked = planted(monkeypatch, ladder)
    verified = Outcome(Job("dcb-czm1", SCENE, "nurbs", "nurbs"), made_up(1.003, n=120))
    plan = replace(QUICK, families=(replace(NURBS, first=1.0),))
    found = searched("dcb-czm1", SCENE, (), tmp_path, 1, plan, [verified])
    sizes = [job.solved.discretization.dofs for job, *_ in asked if job.variant.startswith("cost/nurbs")]
    assert found is not None and sizes[0] > meshes(SCENE, plan.families[0]).sizes[3]
    assert {one.asked for one in found.rows if one.method == "nurbs"} >= {"80", "auto-0.02", "auto-0.05"}
    assert "0.3\u00a0%" in found.ways and found.price()["runs"][0]["method"] == "nurbs"


def test_methods_that_cannot_are_left_out_with_a_sentence(tmp_path, alone, monkeypatch):
    adaptive = next(one for one in FAMILIES if one.adaptive)
    planted(monkeypatch, lambda job: made_up(n=120))
    monkeypatch.setattr(study_of, "run_all", lambda plan, out, jobs: (
        Outcome(job, None, "not run: no DOLFINx") if job.method == "dolfinx" else Outcome(job, made_up(n=120))
        for job in plan
    ))  # fmt: skip
    found = searched(
        "peel-60", load_scene("peel-60", ["load.opening=3.0"]), (), tmp_path, 1, Plan(families=(adaptive, DOLFINX))
    )
    assert found.left_out == (
        "tspline-adaptive: left out: only the mesh of a dcb follows the process zone", "dolfinx: not run: no DOLFINx",
    )  # fmt: skip
    assert {one.method for one in found.rows} == {"beam", "beam-3"}


@pytest.mark.parametrize("status", ["stopped: here", "not run: too coarse"])
def test_without_a_reference_nothing_is_measured(status, tmp_path, alone, monkeypatch, capsys):
    """What stands in the way is said; whatever is run has one thread."""
    for name in environment.THREADS:
        monkeypatch.setenv(name, "7")
    asked = planted(monkeypatch, lambda job: made_up(status=status))
    assert study_of.cost("dcb-czm1", SCENE, (), tmp_path, 2) is None
    said = rf"no converged reference of dcb-czm1, so that nothing can be measured: reference/\S+: {status}"
    assert re.search(said, capsys.readouterr().err)
    assert [os.environ[name] for name in environment.THREADS] == ["1"] * 3
    assert len(asked) == 3 and not list(tmp_path.iterdir())


@pytest.mark.slow
def test_a_small_study_for_real(tmp_path, monkeypatch, capsys):
    """Two families to an opening of 1, and again: the second call runs nothing."""
    few = tuple(replace(one, first=2.0) for one in FAMILIES if one.name in ("nurbs-p2", "tspline-p3"))
    monkeypatch.setattr(plan_of, "FAMILIES", few)
    monkeypatch.setattr(reference_of, "dolfinx_installed", lambda: False)
    command = ["cost", "dcb-czm1-linear", "--set", "load.opening=1.0", "--out", str(tmp_path)]
    assert main(command) == 0
    known = read_table(tmp_path / "cost.csv", Row)
    found = json.loads((tmp_path / "cost.json").read_text())
    assert {one.method for one in known} == {"nurbs", "tspline", "beam", "beam-3"}
    assert found["reference"]["uncertainty"]["curve"] < 0.001
    assert found["cheapest"]["0.3%"]["method"] in ("nurbs", "tspline")
    capsys.readouterr()
    assert main(command) == 0
    assert str(read_table(tmp_path / "cost.csv", Row)) == str(known)  # some numbers are NaN
    assert not re.search(r"\b1 of (?!1 runs are at hand)", capsys.readouterr().err), "a run is made again"


# --- the price of a verification


@pytest.mark.parametrize(
    ("words", "names"),
    [
        ([], ["dcb-czm1"]),
        (["--set", "load.opening=2.0"], []),
        (["--no-ladder"], []),
        (["--ladder", "peel-60", "--ladder", "dcb-czm2"], ["peel-60", "dcb-czm2"]),
    ],
)
def test_options_choose_the_scenes(words, names, tmp_path, monkeypatch):
    seen = []
    monkeypatch.setattr(verification, "would_run", lambda subjects, out, jobs: seen.append(subjects) or [])
    assert main(["verify", "dcb-czm1", *words, "--dry-run", "--out", str(tmp_path / "out")]) == 0
    assert [source for source, _ in seen[0].ladders] == names


def test_both_options_are_refused(capsys):
    assert main(["verify", "dcb-czm1", "--no-ladder", "--ladder", "peel-60"]) == 2
    assert "--no-ladder: must be left out with --ladder peel-60" in capsys.readouterr().err


def test_the_verdict_has_the_price_of_every_scene(tmp_path):
    """The cheapest of each code, at its best and at equal steps; 1 % where nothing reaches 0.3 %."""
    fine = (a_row("nurbs", 0.002, 0.2, 432, 2, "auto"), a_row("nurbs", 0.001, 0.5, 504, 2),
            a_row("lagrange", 0.002, 0.4, 732, 2, "auto"), a_row("dolfinx", 0.002, 0.7, 1044, 2))  # fmt: skip
    coarse = tuple(replace(one, curve_error=0.008) for one in fine)
    prices = [Study(scene, made, (), against()) for scene, made in ((SCENE, fine), (load_scene("peel-60"), coarse))]
    verdict_file.write(tmp_path, (), judged((), NO_DEMANDS), (), prices)
    price = json.loads((tmp_path / "verdict.json").read_text())["price"]
    assert price["ratio"] == pytest.approx(3.5) and price["ratio_at_equal_steps"] == pytest.approx(1.4)
    assert [run["dofs"] for run in price["runs"]] == [432, 1044] and price["curve_error"] == 0.003
    assert price["ways"] == (
        "The cheapest way on dcb-czm1 (dcb) to 1\u00a0% in 0.2\u00a0s with NURBS, degree 2 of 432 unknowns, to "
        "0.3\u00a0% in 0.2\u00a0s with NURBS, degree 2 of 432 unknowns, to 0.1\u00a0% in 0.5\u00a0s with NURBS, degree "
        "2 of 504 unknowns."
    )
    assert [(one["scene"], one["curve_error"]) for one in price["others"]] == [("peel-60", 0.01)]
