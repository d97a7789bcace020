"""Rows of a study of the cost: what cannot be measured, and what they say together."""

from __future__ import annotations

import os
import re
from dataclasses import fields, replace
from math import isnan
from pathlib import Path

import numpy as np
import pytest

from tests.verify.studies.cost.test_cost import NURBS, SCENE, a_row, against, made_up, profile
from verify.runs import environment
from verify.runs.jobs import Outcome
from verify.scene.load import load_scene
from verify.studies import frame
from verify.studies.cost import reference as reference_of
from verify.studies.cost import study as study_of
from verify.studies.cost.findings import cheapest
from verify.studies.cost.ladder import Try
from verify.studies.cost.row import Row, _middle, traction_error


def test_of_a_theory_alone_nothing_is_called_the_cheapest() -> None:
    found = cheapest([a_row("beam", 1e-4, 0.1), a_row("nurbs", 0.02, 1.0)], "1%")
    assert found.best is None and found.ratio == {} and list(found.of_method) == ["beam"]
    assert found.summary() == {"method": None, "ratio": {}}


def test_without_a_zone_there_is_no_error_of_tractions() -> None:
    exact = (profile(0.0), profile(0.0))
    assert isnan(traction_error(exact, exact[:1])) and traction_error(exact, exact) == 0.0
    for damage in (np.zeros(exact[0].s_q.size), np.ones(exact[0].s_q.size)):
        without = (replace(exact[0], damage_q=damage), exact[1])
        assert isnan(traction_error(without, exact)) and isnan(traction_error(exact, without))


@pytest.mark.parametrize(
    ("last", "why"), [(None, "not run: too coarse"), (made_up(status="stopped: here"), "stopped: here")]
)
def test_without_a_reference_nothing_is_measured(last, why: str, tmp_path: Path, monkeypatch, capsys) -> None:
    """What stands in the way is said; whatever is run has one thread."""
    threads = []
    for name in environment.THREADS:
        monkeypatch.setenv(name, "7")

    def run_all(plan, out, jobs, scheduler=None):
        threads.append([os.environ[name] for name in environment.THREADS])
        for i, job in enumerate(plan):
            whole = i + 1 < len(plan)
            yield Outcome(job, made_up() if whole else last, "" if whole or last is not None else why)

    monkeypatch.setattr(study_of, "run_all", run_all)
    monkeypatch.setattr(frame, "run_all", run_all)
    monkeypatch.setattr(reference_of, "dolfinx_installed", lambda: False)
    assert study_of.cost("dcb-czm1", SCENE, (), tmp_path, 2) is None
    said = capsys.readouterr().err
    assert re.search(rf"no converged reference, so that nothing can be measured: reference/\S+: {why}", said)
    assert threads == [["1"] * 3] and not list(tmp_path.iterdir())


def test_the_reference_is_one_arm_where_the_arms_are_alike(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(reference_of, "dolfinx_installed", lambda: False)
    alike = {"dcb-czm1": (), "peel-80": (), "mismatch": ("discretization.mismatch=1.37",)}
    for name, words in alike.items():
        scene = load_scene("peel-80" if name == "peel-80" else "dcb-czm1", words)
        own, other = reference_of.reference_jobs(name, scene, words)
        halved = ["effects.symmetry=true" in job.overrides for job in own]
        assert halved == [name == "dcb-czm1"] * len(own) and len(own) == 3 and other == ()
        assert all(set(words) <= set(job.overrides) and job.variant.startswith("reference/") for job in own)
        sizes = [job.solved.discretization.dofs for job in own]
        assert sizes == sorted(set(sizes)), "from coarse to fine"


def test_what_is_timed_runs_alone_and_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Until the time is over: what has begun comes to its end, nothing else is begun."""
    asked, now = [], [0.0]

    def run_all(plan, out, jobs, scheduler=None):
        for job in plan:
            asked.append((job.variant, jobs, out))
            now[0] += 10.0
            yield Outcome(job, made_up())

    monkeypatch.setattr(study_of, "run_all", run_all)
    monkeypatch.setattr(frame, "run_all", run_all)
    monkeypatch.setattr(study_of, "monotonic", lambda: now[0])
    tries = [Try(NURBS, i, size, 80) for i, size in enumerate((300, 420, 590, 830))]
    runner = study_of.Runner("dcb-czm1", SCENE, (), tmp_path, against(), start=0.0)
    assert runner(tries[:2]) and not runner(tries, seconds=25.0) and list(runner.found) == tries[:3]
    assert runner(tries, seconds=45.0) and runner(tries, seconds=0.0), "nothing is left to do"
    assert len(asked) == 4 and {(jobs, out) for _, jobs, out in asked} == {(1, tmp_path)}
    again = [replace(tries[1], repeat=number) for number in (1, 2)]
    assert runner(again) and runner.again(tries[1]) == [tries[1], *again] and list(runner.rows) == tries
    assert [found.times for found in runner.rows.values()] == [1, 3, 1, 1]


def test_the_chart_shows_errors_in_per_cent_and_everything_else_as_it_is() -> None:
    """Every axis is a column of the rows, and its name says its unit."""
    pytest.importorskip("matplotlib")
    pytest.importorskip("jinja2")
    from verify.studies.cost.page import X_AXES, Y_AXES

    columns = {field.name for field in fields(Row)}
    assert {key for key, _, _ in (*X_AXES, *Y_AXES)} <= columns
    assert all(factor == 1 and "%" not in name for _, name, factor in X_AXES) and X_AXES[0][0] == "seconds"
    assert all(factor == 100 and name.endswith("(%)") for _, name, factor in Y_AXES) and Y_AXES[0][0] == "curve_error"


def test_the_middle_of_a_zone_is_where_half_of_the_damage_is() -> None:
    """Linear between the two points on either side of it, the last ones where there are several."""
    s = np.array([0.0, 1.0, 3.0, 4.0, 8.0])
    for damage, place in (
        ([1.0, 1.0, 0.8, 0.3, 0.0], 3.6),
        ([1.0, 0.2, 0.9, 0.5, 0.0], 4.0),
        ([0.6, 0.4, 0.3, 0.2, 0.0], 0.5),
        ([1.0, 0.9, 0.7, 0.6, 0.4], 6.0),
    ):
        found = replace(profile(0.0), s_q=s, damage_q=np.array(damage), traction_q=0 * s, gap_q=0 * s)
        assert _middle(found) == pytest.approx(place)
    whole = replace(profile(0.0), s_q=s, damage_q=np.ones(5), traction_q=0 * s, gap_q=0 * s)
    assert isnan(_middle(whole)) and isnan(_middle(replace(whole, damage_q=np.full(5, 0.5))))
