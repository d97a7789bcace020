"""What accuracy costs: references with a known limit, rows with known answers, what they say, a page."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from math import isnan, nan
from pathlib import Path

import numpy as np
import pytest
from made_up_costs import NURBS, SCENE, a_row, against, made_up, outcome

from verify.curves.of_run import distance
from verify.result import Snapshot
from verify.runs.folder import write_csv
from verify.scene.load import load_scene
from verify.studies.cost.contenders import best
from verify.studies.cost.findings import cheapest, growth, of_equal_steps, orders, pareto, table
from verify.studies.cost.ladder import Try
from verify.studies.cost.nonzeros import nonzeros
from verify.studies.cost.reference import _index, reference
from verify.studies.cost.row import Row, errors, row, traction_error
from verify.studies.cost.study import LIMITS, Study
from verify.support.checked_files import read_table

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
    read = read_table(tmp_path / "cost.csv", Row)
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
    assert "curve error <= 0.3%: DOLFINx takes 3.8 × as long as iga each at its best, " in "\n".join(lines)
    assert "DOLFINx takes 5 × as long as iga with 80 steps asked of both" in "\n".join(lines)
    assert not any(line.startswith("curve error <= 0.1%:") for line in lines), "no other code is that accurate"


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


# --- page and files


def test_the_page_says_it_and_carries_the_rows(tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    pytest.importorskip("jinja2")
    from verify.studies.cost.page import write

    study = Study(SCENE, tuple(ROWS), ("lefm: a <limit>",), against())
    write(study, tmp_path / "report.html")
    page = (tmp_path / "report.html").read_text()
    assert "Curve error 0.3%: T-spline, degree 3, 400 unknowns" in page and "DOLFINx 3.8 ×" in page
    assert "a &lt;limit&gt;" in page and page.count("<svg") >= 6
    assert "http://" not in page.replace("http://www.w3.org", "") and "https://" not in page
    data = json.loads(re.search(r'class="rows">(.*?)</script>', page, re.DOTALL)[1])
    assert len(data["rows"]) == sum(one.measured for one in ROWS)
    assert len(page) < 1_000_000


def test_runs_that_may_only_have_come_out_late_are_timed_again() -> None:
    """What a machine does besides takes no share of a run but some milliseconds, which short ones are lost in."""
    seconds = {1: 0.020, 2: 0.024, 3: 0.045, 4: 0.056}
    rows = {Try(NURBS, rung, 500, 40): a_row("nurbs", 0.002, each) for rung, each in seconds.items()}
    assert {one.rung for one in best(rows, LIMITS.close, LIMITS.close, LIMITS.late)} == {1, 2, 3}
    assert {one.rung for one in best(rows, LIMITS.close, LIMITS.close)} == {1, 2} and [
        one.rung for one in best(rows)
    ] == [1]


def test_a_run_that_was_timed_once_may_be_half_as_long_again() -> None:
    """One that was timed twice has had its chance."""
    seconds = {1: (0.40, 2), 2: (0.60, 1), 3: (0.60, 2), 4: (0.48, 2), 5: (0.70, 1)}
    rows = {
        Try(NURBS, rung, 500, 40): replace(a_row("nurbs", 0.002, each), times=times)
        for rung, (each, times) in seconds.items()
    }
    assert {one.rung for one in best(rows, LIMITS.close, LIMITS.once)} == {1, 2, 4}


def test_cost_json_names_the_cheapest_and_the_front(tmp_path: Path) -> None:
    found = Study(SCENE, tuple(ROWS), (), against()).summary()
    assert list(found["cheapest"]) == ["1%", "0.3%", "0.1%"]
    assert found["cheapest"]["0.3%"]["method"] == "tspline" and found["cheapest"]["0.3%"]["dofs"] == 400
    assert found["cheapest_at_equal_steps"]["0.3%"]["ratio"]["dolfinx"] == pytest.approx(5.0)
    assert found["pareto"][0]["method"] == "beam" and found["reference"]["uncertainty"]["curve"] == 1e-4


@pytest.mark.parametrize(("name", "dofs"), [("dcb-czm1", 280), ("peel-60", 600)])
def test_entries_of_the_tangent_are_those_that_forces_depend_on(name: str, dofs: int) -> None:
    """Counted against differences of the residual at a state without symmetry, column after column."""
    from iga.system.system import respond
    from verify.methods.solve import prepare

    scene = load_scene(name, [f"discretization.dofs={dofs}"])
    solver, problem = prepare(scene, "nurbs").problem
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


def test_one_number_that_does_not_converge_is_as_uncertain_as_it_differs() -> None:
    """Three times the largest difference of the finest from the others, over the finest; finest last."""
    assert _index((4.0, 2.0, 1.0), (2.2, 1.7, 2.0)) == pytest.approx(3.0 * 0.3 / 2.0)
    assert _index((4.0, 2.0, 1.0), (1.5, 2.1, -2.0)) == pytest.approx(3.0 * 4.1 / 2.0)
