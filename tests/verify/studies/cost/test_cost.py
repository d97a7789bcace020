"""What accuracy costs: references with a known limit, rows with known answers, what they say, a page."""

from __future__ import annotations

import json
import re
from dataclasses import fields, replace
from math import isnan, nan

import numpy as np
import pytest
from made_up_costs import NURBS, SCENE, a_row, against, made_up, outcome

from verify.result import Snapshot
from verify.runs.folder import write_csv
from verify.scene.load import load_scene
from verify.studies.cost import reference as reference_of
from verify.studies.cost.findings import cheapest, levels, of_equal_steps, orders, pareto
from verify.studies.cost.grid import Family, Try
from verify.studies.cost.reference import reference, reference_jobs
from verify.studies.cost.row import Row, errors, row, traction_error
from verify.studies.cost.study import Study
from verify.support.checked_files import read_table

# --- the reference


def of_meshes(*scales: float):
    return [outcome(made_up(scale, elements=n, n=300)) for n, scale in zip((50, 100, 200), scales, strict=False)]


@pytest.mark.parametrize(("p", "most"), [(1.3, 1.6), (2.0, 1.6), (4.0, 22.0)])
def test_three_meshes_tell_their_order_and_their_uncertainty(p, most):
    """Curves (1 + h^p) f on h = 1/50, 1/100, 1/200: the error h^p of the finest is bounded; no order above 2 counts."""
    found = reference(of_meshes(*(1.0 + (10.0 / n) ** p for n in (50, 100, 200))), [])
    assert found.order == pytest.approx(p, abs=0.03)
    for name in ("curve", "peak"):
        assert 1.0 < found.uncertainty[name] / (10.0 / 200) ** p < most
    assert "No other code" in found.sentence and isnan(found.apart)


def test_meshes_that_do_not_converge_get_a_cautious_uncertainty():
    """Three times that of a first order over the range of their values."""
    found = reference(of_meshes(1.01, 0.988, 1.0), [])
    assert isnan(found.order) and found.uncertainty["curve"] == pytest.approx(0.012, rel=0.01)


def test_another_code_agrees_within_both_uncertainties_or_not():
    own = of_meshes(*(1.0 + 100.0 / n**2 for n in (50, 100, 200)))
    for far, agrees in ((1.006, True), (1.03, False)):
        found = reference(own, [outcome(made_up(far + 0.002)), outcome(made_up(far))])
        assert found.agrees is agrees and ("is " if agrees else "not within") in found.sentence
    assert reference([*own[:2], outcome(None, "not run")], []) is None


@pytest.mark.parametrize(
    ("name", "given", "halved"),
    [("dcb-czm1", (), True), ("peel-80", (), False), ("dcb-czm1", ("discretization.mismatch=1.37",), False)],
)
def test_the_reference_is_cubic_and_one_arm_where_the_arms_are_alike(name, given, halved, monkeypatch):
    monkeypatch.setattr(reference_of, "dolfinx_installed", lambda: True)
    own, other = reference_jobs(name, load_scene(name, given), given)
    assert {job.method for job in own} == {"nurbs"} and {job.method for job in other} == {"dolfinx"}
    assert {job.solved.discretization.degree for job in own} == {3} == {job.solved.dolfinx.degree for job in other}
    assert ["effects.symmetry=true" in job.overrides for job in own] == [halved] * 3 and len(other) == 2
    assert all({*given} <= {*job.overrides} and job.variant.startswith("reference/") for job in (*own, *other))
    sizes = [job.solved.discretization.dofs for job in own]
    assert sizes == sorted(set(sizes)), "from coarse to fine"
    monkeypatch.setattr(reference_of, "dolfinx_installed", lambda: False)
    assert reference_jobs(name, load_scene(name, given), given)[1] == ()


# --- one run


def test_a_run_is_measured_in_every_way():
    found = errors(made_up(1.01, n=60), against())
    assert found["chords"] == pytest.approx(0.01, rel=0.03) and found["cubics"] == pytest.approx(0.01, rel=1e-3)
    assert found["curve_error"] == min(found["chords"], found["cubics"])
    assert found["peak_error"] == pytest.approx(0.01, rel=1e-3)
    assert found["energy_error"] == pytest.approx(0.01, rel=1e-9)
    assert found["oscillation"] < 1e-3 < errors(made_up(wave=0.02), against())["oscillation"]
    few = errors(made_up(n=25), against())
    assert few["curve_error"] == few["cubics"] < 1e-4 < 1e-3 < few["chords"], "slopes make up for few steps"


def test_times_are_the_least_of_the_turns_without_compiling():
    slow = made_up(jit_seconds=0.4)
    first = replace(slow, seconds={**slow.seconds, "total": 1.0})  # at another moment than its turns
    quick = replace(slow, seconds={**slow.seconds, "basis": 0.45, "total": 2.0})
    found = row(Try(NURBS, 500, 40), [outcome(first), outcome(slow), outcome(quick)], against())
    assert (found.times, found.seconds, found.jit_seconds) == (3, pytest.approx(1.6), 0.4)
    assert found.basis == pytest.approx(0.05) and found.newton_iterations == 164
    started = replace(slow, seconds={**slow.seconds, "basis": 0.0, "solve": 2.0, "total": 2.0})  # another program
    found = row(Try(Family("moose", "moose", 2, 1.0), 500, 40), [outcome(started)], against())
    assert (found.seconds, found.basis, found.solve) == pytest.approx((1.6, 0.0, 1.6))


def test_a_run_that_stopped_has_no_error_and_is_never_cheapest():
    for bad, said in (
        (outcome(made_up(status="stopped: here")), "stopped: here"),
        (outcome(None, "signal 9"), "signal 9"),
    ):
        found = row(Try(NURBS, 500, 40), [bad], against())
        assert isnan(found.curve_error) and not found.measured and found.status == said
        assert cheapest([found], "1%").best is None and pareto([found]) == []


def profile(shift: float = 0.0, scale: float = 1.0) -> Snapshot:
    s = np.linspace(0.0, 10.0, 401)
    damage = np.clip((6.0 + shift - s) / 2.0, 0.0, 1.0)
    grids = {"X_euvi": np.zeros((0, 1, 1, 2)), "u_euvi": np.zeros((0, 1, 1, 2)), "stress_euv": np.zeros((0, 1, 1))}
    return Snapshot(1.0, 1.0, s, damage, scale * 4.0 * np.exp(-((s - 6.0 - shift) ** 2)), damage, **grids)


def test_tractions_are_compared_wherever_the_zone_has_come_to():
    exact = (profile(), profile())
    assert traction_error(exact, exact) == 0.0 and traction_error((profile(0.313), profile()), exact) < 1e-3
    assert 0.02 < traction_error((profile(0.313, 1.1), profile()), exact) < 0.1
    for damage in (0.0, 1.0):  # without a zone there is nothing to compare
        without = (replace(exact[0], damage_q=np.full(exact[0].s_q.size, damage)), exact[1])
        assert isnan(traction_error(without, exact)) and isnan(traction_error(exact, without))
    assert isnan(traction_error((), exact)) and isnan(traction_error(exact, exact[:1]))


def test_cost_csv_keeps_its_contract(tmp_path):
    rows = [a_row("nurbs", 0.002, 3.0), row(Try(NURBS, 9, "auto"), [outcome(None, "no, not run")], against())]
    write_csv(tmp_path / "cost.csv", Row, rows)
    head = (tmp_path / "cost.csv").read_text().splitlines()[0]
    assert head.startswith("method,degree,dofs,curve_error,peak_error,oscillation,seconds,")
    assert str(read_table(tmp_path / "cost.csv", Row)) == str(rows), "NaN is read as NaN"


# --- what the rows say

ROWS = [
    a_row("nurbs", 0.009, 1.0, 300), a_row("nurbs", 0.0029, 2.0, 500), a_row("nurbs", 0.0008, 4.0, 900),
    a_row("tspline", 0.0025, 1.6, 400), a_row("dolfinx", 0.002, 8.0, 1400, 2),
    a_row("dolfinx", 0.0021, 6.0, 1400, 2, "20"), a_row("beam", 0.0005, 0.1, 0, 0), a_row("lagrange", nan, 0.1),
]  # fmt: skip


def test_the_cheapest_run_has_a_mesh_and_ratios_to_the_others():
    found = cheapest(ROWS, "0.3%")
    assert (found.best.method, found.best.dofs) == ("tspline", 400)
    assert found.times == pytest.approx({"tspline": 1.0, "nurbs": 1.25, "dolfinx": 3.75, "beam": 0.0625})
    assert cheapest(of_equal_steps(ROWS), "0.3%").times["dolfinx"] == pytest.approx(5.0)
    assert cheapest(ROWS, "0.1%").best.dofs == 900 and "dolfinx" not in cheapest(ROWS, "0.1%").times
    best, equal = levels(ROWS)[1].peer.split(", ")
    assert best == "DOLFINx takes 3.8 × as long as iga each at its best"
    assert equal == "DOLFINx takes 5 × as long as iga with 80 steps asked of both"
    assert levels(ROWS)[2].peer == "", "no other code is that accurate"
    with_moose = levels([*ROWS, a_row("moose", 0.002, 7.2, 1400, 2)])[1]
    assert with_moose.best.others == (
        "7.2\u00a0s with moose, degree 2 of 1400 unknowns is the quickest of other codes: 4.5 × as long as ours"
    )
    assert f" {with_moose.best.others}." in with_moose.said and with_moose.best.codes.keys() == {"iga", "DOLFINx"}
    assert levels(ROWS)[1].best.others == ""
    theory = cheapest([a_row("beam", 1e-4, 0.1), a_row("nurbs", 0.02, 1.0)], "1%")
    assert theory.best is None and list(theory.of_method) == ["beam"]
    assert theory.summary() == {"method": None, "ratio": {}}


def test_no_other_run_beats_one_of_the_front():
    front = pareto(ROWS[:6])
    assert [(one.method, one.dofs) for one in front] == [("nurbs", 300), ("tspline", 400), ("nurbs", 900)]
    for one in front:
        assert not any(o.seconds <= one.seconds and o.curve_error < one.curve_error for o in ROWS[:6])


def test_orders_are_those_that_were_put_in():
    sizes = (200, 400, 800, 1600, 3200)
    rows = [a_row("nurbs", 5.0 * n**-1.7, 1e-3 * n**1.2, n) for n in sizes]
    assert orders(rows, 0.0)["nurbs-p3"] == pytest.approx(1.7)
    assert isnan(orders(rows, 5.0 * 500**-1.7)["nurbs-p3"]), "two meshes above the floor tell no order"


# --- page and files


def test_page_and_file_say_it_and_carry_the_rows(tmp_path):
    pytest.importorskip("matplotlib")
    from verify.studies.cost.page import X_AXES, Y_AXES, write

    study = Study(SCENE, tuple(ROWS), ("lefm: a <limit>",), against())
    write(study, tmp_path / "report.html")
    page = (tmp_path / "report.html").read_text()
    assert "with T-spline, degree 3 of 400 unknowns" in page and "DOLFINx 3.8 ×" in page
    assert "a &lt;limit&gt;" in page and page.count("<svg") >= 2 and len(page) < 1_000_000
    data = json.loads(re.search(r'class="rows">(.*?)</script>', page, re.DOTALL)[1])
    assert len(data["rows"]) == sum(one.measured for one in ROWS)
    found = study.summary()
    assert list(found["cheapest"]) == ["1%", "0.3%", "0.1%"] and found["cheapest"]["0.3%"]["method"] == "tspline"
    assert found["cheapest_at_equal_steps"]["0.3%"]["ratio"]["dolfinx"] == pytest.approx(5.0)
    assert found["pareto"][0]["method"] == "beam" and found["reference"]["uncertainty"]["curve"] == 1e-4
    assert {key for key, _, _ in (*X_AXES, *Y_AXES)} <= {field.name for field in fields(Row)}
    assert {factor for _, _, factor in X_AXES} == {1}
    assert all(factor == 100 and name.endswith("(%)") for _, name, factor in Y_AXES), "errors are in per cent"
