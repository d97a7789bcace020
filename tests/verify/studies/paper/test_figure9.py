"""Figure 9: statements follow the numbers, its runs are those that are made anyway, and a small study for real."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from verify.methods.solve import solve
from verify.result import Result
from verify.runs.jobs import Outcome
from verify.scene.load import load_scene
from verify.studies import one_scene
from verify.studies.paper import plan as plans
from verify.studies.paper.plan import BONDS, STRIPS, Case, strips
from verify.studies.paper.statements import branch_distance, lines, statements
from verify.studies.paper.study import Reference, Study, Trial, limit, measured, trial, zone

BASES = ("tspline", "nurbs", "lagrange")
SCENES = {bond: load_scene(bond) for bond in BONDS}
SIZE = {"tspline": 0.001, "nurbs": 0.003, "lagrange": 0.006}
TOUGHNESS = 0.1


def made_up(bond: str, bump: float = 0.0, status: str = "complete") -> Result:
    """A straight rise to where the crack starts, then a branch that all bonds share; off it by ``bump``."""
    opening = np.linspace(0.0, 6.5 if status == "complete" else 4.0, 651)
    start = {"peel-60": 3.5, "peel-80": 2.2, "peel-100": 1.2, "peel-120": 0.54}[bond]
    branch = 3.5 / np.sqrt(np.maximum(opening, start))
    load = (1.0 + bump) * np.minimum(opening / start, 1.0) * branch
    grows = opening >= start
    slope = np.where(grows, TOUGHNESS / (3.5 / np.sqrt(np.maximum(opening, start))), 0.05)
    none = np.zeros(opening.size)
    columns = {
        "opening": opening,
        "load": load,
        "dissipated_energy": np.maximum(opening - start, 0.0) + 1e-3 * opening,
        "tip_opening": np.where(grows, 0.5, 0.0),
        "end_opening": none,
        "damage_front": 100.0 + none,
        "face_slope_top": slope,
        "face_slope_bottom": none,
        "face_energy": none,
    }
    return Result("nurbs", columns, status=status, dofs=3700, elements=700, seconds={"total": 25.0})


def world(change: Callable[[Case], dict[str, float]] = lambda case: {}, **parts: object) -> Study:
    """A study in which every statement holds, but for what is changed."""
    trials = []
    for case in (Case(basis, bond) for bond in BONDS for basis in BASES):
        found = {"error": SIZE[case.basis], "oscillation": SIZE[case.basis], "bump": 0.0, **change(case)}
        trials.append(
            Trial(case, made_up(case.scene, found.pop("bump")), "complete", variation=0.1, peak=0.01, **found)
        )
    whole = {
        "figures": STRIPS,
        "scenes": SCENES,
        "trials": tuple(trials),
        "references": {(bond, None): Reference("a fine run", made_up(bond), 1e-5, 1e-5) for bond in BONDS},
        "limits": {bond: limit(scene) for bond, scene in SCENES.items()},
        "zones": {Case(basis, bond): 4.0 for basis in BASES for bond in BONDS},
        "printed": dict.fromkeys(BASES, 0.02),
    }
    return Study(**{**whole, **parts})


def times(factor: float, measure: str, basis: str) -> Callable[[Case], dict[str, float]]:
    return lambda case: {measure: factor * SIZE[case.basis]} if case.basis == basis else {}


def off(bump: float, *bonds: str) -> Callable[[Case], dict[str, float]]:
    return lambda case: {"bump": bump} if case.scene in bonds else {}


def verdict(study: Study, words: str) -> str:
    (found,) = [s for s in statements(study) if words in s.text]
    return found.verdict


def test_all_are_confirmed_where_all_hold():
    found = statements(world())
    assert {s.text: s.verdict for s in found} == {s.text: "confirmed" for s in found}
    assert len(found) == 12
    assert {s.source for s in found[:4]} == {"the paper"} and "the paper" not in {s.source for s in found[4:]}


@pytest.mark.parametrize(
    ("words", "study"),
    [
        ("T-splines are closer", world(times(100, "error", "tspline"))),
        ("T-splines are smoother", world(times(100, "oscillation", "tspline"))),
        ("NURBS are closer", world(times(100, "error", "nurbs"))),
        ("NURBS are smoother", world(times(100, "oscillation", "nurbs"))),
        ("meshes resolve the process zone", world(zones={Case(b, s): 2.0 for b in BASES for s in BONDS})),
        ("as printed", world(printed=dict.fromkeys(BASES, 5.0))),
    ],
)
def test_a_statement_flips_with_its_numbers(words, study):
    assert verdict(study, words) == "not confirmed"


@pytest.mark.parametrize(
    ("words", "study", "holding"),
    [
        ("draws the converged curve", world(times(10, "error", "lagrange")), "8 of 12"),
        ("A longer bond gives a larger peak", world(off(-0.5, "peel-120")), "9 of 12"),
        ("stays below that of a clamped plate", world(off(0.5, "peel-60")), "13 of 16"),
        ("share one propagation branch", world(off(0.02, "peel-80")), "9 of 12"),
        ("never falls below G_Ic w", world(off(-0.95, "peel-80")), "13 of 16"),
        ("load sin(theta) is G_Ic w", world(off(0.02, "peel-100")), "13 of 16"),
    ],
)
def test_what_does_not_hold_is_counted(words, study, holding):
    """What the converged curves show holds here whatever the bases do."""
    (found,) = [s for s in statements(study) if words in s.text]
    assert found.verdict == "confirmed in part" and found.extent.startswith(holding), found.extent


def test_branches_are_compared_where_both_are_on_them():
    """From 1.3 times the later peak on: before that the shorter bond is not open yet."""
    curves = {bond: (r.opening, r.load) for bond in BONDS for r in [made_up(bond)]}
    assert branch_distance(curves["peel-60"], curves["peel-120"]) < 1e-12
    opening, load = curves["peel-60"]
    early = (opening, np.where(opening < 4.4, 2.0 * load, load))
    late = (opening, np.where(opening > 6.0, 1.1 * load, load))
    assert branch_distance(late, curves["peel-120"]) == pytest.approx(0.1 * np.sqrt(0.5 / 1.95), rel=0.1)
    assert branch_distance(early, curves["peel-120"]) < 1e-12
    assert np.isnan(branch_distance((opening[:300], load[:300]), curves["peel-60"]))


def test_what_the_reference_cannot_tell_is_undecided():
    blind = {bond: replace(known, error=1.0) for bond, known in world().references.items()}
    assert verdict(world(references=blind), "T-splines are closer") == "not tested"
    assert verdict(world(references=blind), "T-splines are smoother") == "confirmed"


def test_the_runs_are_those_that_are_made_anyway(monkeypatch):
    scenes = list(SCENES.items())
    usual = {job for source, scene in scenes for job in one_scene.planned(source, scene)}
    monkeypatch.setattr(plans, "dolfinx_installed", lambda: True)
    more = set(strips(scenes).jobs) - usual
    assert {job.method for job in more} == {"dolfinx"} and len(more) == len(BONDS)
    assert {load_scene(job.source, job.overrides).dolfinx.elements for job in more} == {300}
    monkeypatch.setattr(plans, "dolfinx_installed", lambda: False)
    more = set(strips(scenes).jobs) - usual
    assert {job.method for job in more} == {"nurbs"} and len(more) == 2 * len(BONDS)
    assert {load_scene(job.source, job.overrides).discretization.dofs for job in more} == {7400, 11100}
    every = [job.folder(Path()) for job in {*usual, *more}]
    assert len(every) == len(set(every))


def test_a_full_verification_of_a_peel_asks_for_nothing_that_it_refuses():
    for source, scene in SCENES.items():
        for job in one_scene.planned(source, scene, full=True):
            assert load_scene(source, job.overrides).name == source


def test_the_page_shows_every_basis_bond_and_statement(tmp_path):
    pytest.importorskip("matplotlib")
    pytest.importorskip("jinja2")
    from verify import report

    study = world()
    case = Case("nurbs", "peel-80")
    stopped = made_up("peel-80", status="stopped: no step is small enough")
    lost = trial(case, Outcome(case.job(SCENES["peel-80"]), stopped), study.references["peel-80", None])
    study = replace(study, trials=tuple(lost if t.case == case else t for t in study.trials))
    report.write(report.Findings((), {}, peels=study), tmp_path / "report.html")
    text = (tmp_path / "report.html").read_text()
    assert text.count('<svg class="plot"') == 3 + 4 and text.count('<a href="#figure-9">') == 1
    assert all(s.text in text and s.extent in text for s in statements(study))
    assert "Of 12 statements 12 confirmed; 11 of 12 runs came to their end" in text
    assert text.count("no step is small enough") == 1 and '<td class="absent">stopped</td>' in text
    assert "Figure 9: load against displacement" in text
    assert "4.763\u00a0N" in text, "peak of the longest bond"


def test_without_a_scene_of_the_paper_it_says_so(tmp_path):
    study = measured(strips([("mine.toml", load_scene("peel-60"))]), {})
    (said,) = lines("Figure 9", study)
    assert said == f"Figure 9 of the paper: left out: none of its scenes ({', '.join(BONDS)}) is among those given"
    pytest.importorskip("jinja2")
    from verify import report

    report.write(report.Findings((), {}, peels=study), tmp_path / "report.html")
    assert "left out: none of its scenes" in (tmp_path / "report.html").read_text()


@pytest.mark.slow
def test_a_small_study_for_real(monkeypatch):
    """Two bonds by NURBS, held against finer NURBS, up to where the crack of the shorter one runs."""
    monkeypatch.setattr(plans, "dolfinx_installed", lambda: False)
    small = ["discretization.dofs=1300", "load.opening=2.2", "discretization.steps=40"]
    plan = strips([(bond, load_scene(bond, small)) for bond in BONDS[2:]], ("nurbs",))
    runs = {
        job: Outcome(job, solve(load_scene(job.source, [*small, *job.overrides]), job.method))
        for job in dict.fromkeys(plan.jobs)
    }
    study = measured(plan, runs)
    assert all(t.complete for t in study.trials) and "NURBS, " in study.references["peel-120", None].label
    assert all(0.0 < t.error < 0.02 for t in study.trials)
    for words in ("A longer bond", "clamped plate", "one propagation branch", "never falls below", "as printed"):
        assert verdict(study, words) == "confirmed", words
    assert verdict(study, "NURBS are closer") == "not tested"


def test_of_a_run_that_stopped_no_zone_is_counted() -> None:
    case = Case("nurbs", "peel-60")
    stopped = Trial(case, made_up("peel-60", status="stopped: here"), "stopped: here")
    assert np.isnan(zone(SCENES["peel-60"], stopped))
