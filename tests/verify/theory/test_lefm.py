"""The theories of the DCB without a process zone, against each other and against known values."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.special import ellipeinc, ellipkinc, logit

from verify.result import CURVE_COLUMNS, steps_from_rows
from verify.theory import elastica
from verify.theory.lefm import LEFM_THEORIES as ALL
from verify.theory.lefm import LefmProblem, chi, solve

THEORIES = ALL[2]
DCB = LefmProblem(14.0, 0.2, 4.0, 1.0, 120e3, 120e3, 50e3, 0.1, 3.0)

STRIP = replace(DCB, length=150.0, arm_thickness=2.0, precrack=30.0, young=250e3, opening=6.0, arms=1)
EVERY = [(arms, theory) for arms in (2, 1) for theory in ALL[arms]]


def of(arms, theory):
    problem = replace({2: DCB, 1: STRIP}[arms], theory=theory)
    return replace(problem, opening=60.0) if theory == "kendall" else problem


def steps(problem):
    return steps_from_rows(solve(problem).rows)


def test_simple_peak_is_the_known_one():
    s = steps(replace(DCB, theory="simple"))
    assert s["load"].max() == pytest.approx(np.sqrt(0.1 * 80.0) / 4.0, rel=1e-12)
    assert s["opening"][s["load"].argmax()] == pytest.approx(2 * s["load"].max() * 4.0**3 / (3 * 80.0), rel=1e-12)


@pytest.mark.parametrize(("arms", "theory"), EVERY)
def test_rows(arms, theory):
    problem = of(arms, theory)
    s = steps(problem)
    assert (
        set(CURVE_COLUMNS) <= set(s) and s["opening"][-1] == pytest.approx(problem.opening) and len(s["opening"]) == 151
    )
    assert all(s[name][0] == 0.0 for name in CURVE_COLUMNS if name != "crack_length")
    assert s["crack_length"][0] == problem.precrack and s["dissipated_energy"][-1] > 0.0
    assert np.all(np.diff(s["opening"]) > 0.0) and np.all(np.diff(s["crack_length"]) > -1e-12)
    tolerance = 1e-4 if theory == "factors" else 1e-12
    gap = s["external_work"] - s["stored_energy"] - s["dissipated_energy"]
    assert np.abs(gap).max() < tolerance * s["external_work"][-1]


@pytest.mark.parametrize(("arms", "theory"), EVERY)
def test_work_and_slope_belong_to_the_load(arms, theory):
    s = steps(replace(of(arms, theory), points=2000))
    h, P, growing = np.diff(s["opening"]), s["load"], s["dissipated_energy"] > 1e-9
    work = h * (P[1:] + P[:-1]) / 2 + h**2 / 12 * (s["load_slope"][:-1] - s["load_slope"][1:])
    one_branch = (growing[:-1] == growing[1:]) & ((P[:-1] > 0.0) == (P[1:] > 0.0))
    assert np.abs(np.diff(s["external_work"]) - work)[one_branch].max() < 1e-9 * s["external_work"][-1]


def test_the_step_on_which_the_crack_begins_to_grow_closes_the_ledger():
    """By the slope of growth at its start; the slope of loading would leave a hundred times as much open."""
    s = steps(replace(DCB, theory="factors", points=75))
    gap = s["external_work"] - s["stored_energy"] - s["dissipated_energy"]
    first = np.flatnonzero(s["dissipated_energy"] > 1e-9)[0]
    assert abs(gap[first] - gap[first - 1]) < 2e-6 * s["external_work"][-1]


@pytest.mark.parametrize("precrack", [0.05, 0.3, 1.0])
@pytest.mark.parametrize("theory", THEORIES)
def test_a_crack_that_grows_early_closes_the_ledger_by_straight_lines(theory, precrack):
    """Its peak lies in the first 2e-5 to 1e-2 of the programme, and is a row; equal steps would miss 1 to 1500 %."""
    s = steps(replace(DCB, theory=theory, precrack=precrack))
    gap = np.append(0.0, np.cumsum(np.diff(s["opening"]) * (s["load"][1:] + s["load"][:-1]) / 2))
    gap -= s["stored_energy"] + s["dissipated_energy"]
    assert np.all(np.abs(gap) <= 1e-3 * np.maximum.accumulate(s["external_work"]))
    top = int(s["load"].argmax())
    assert s["crack_length"][top] == pytest.approx(precrack) and s["crack_length"][top + 1] > precrack


@pytest.mark.parametrize(
    ("arms", "theory"), [(2, "simple"), (2, "corrected"), (2, "elastica"), (1, "simple"), (1, "elastica")]
)
def test_j_is_the_toughness_while_the_crack_grows(arms, theory):
    s = steps(of(arms, theory))
    J = s["load"] * (np.abs(s["face_slope_top"]) + np.abs(s["face_slope_bottom"])) / DCB.width
    assert J[s["dissipated_energy"] > 1e-9] == pytest.approx(0.1, rel=1e-12)


def test_chi_of_an_isotropic_arm():
    assert chi(DCB) == pytest.approx(0.6452, abs=1e-4)


def test_small_openings_of_all_agree_with_beam_theory():
    small = replace(DCB, opening=1e-3)
    simple, corrected = steps(replace(small, theory="simple")), steps(replace(small, theory="corrected"))
    assert steps(replace(small, theory="elastica"))["load"] == pytest.approx(simple["load"], rel=1e-7)
    assert steps(replace(small, theory="factors"))["load"] == pytest.approx(corrected["load"], rel=1e-7)


@pytest.mark.parametrize("opening", [0.05, 0.1, 0.2])
def test_factors_are_the_elastica_to_second_order(opening):
    """Very slender arms, for which the correction of the crack length is nothing; r = opening / a from 0.05 to 0.2."""
    slender = LefmProblem(100.0, 1e-3, 1.0, 1.0, 1e12, 1e12, 5e11, 1e4, opening)
    end = [steps(replace(slender, theory=theory))["load"][-1] for theory in ("factors", "elastica", "corrected")]
    assert end[0] / end[1] - 1 == pytest.approx(-2 * chi(slender) * 1e-3 * 1.5, abs=0.5 * opening**4 + 1e-4)


def test_elastica_against_legendre_integrals():
    """Bisshopp and Drucker: alpha = F(k) - F(k, phi), deflection 1 - 2 (E(k) - E(k, phi)) / alpha."""
    S = np.sin(np.radians([10.0, 30.0, 60.0, 85.0]))
    k2 = (1 + S) / 2
    phi = np.arcsin(1 / np.sqrt(2 * k2))
    alpha = ellipkinc(np.pi / 2, k2) - ellipkinc(phi, k2)
    deflection = 1 - 2 * (ellipeinc(np.pi / 2, k2) - ellipeinc(phi, k2)) / alpha
    length, end = elastica.shape(logit(S))
    np.testing.assert_allclose(length / np.sqrt(2), alpha, rtol=1e-12)
    np.testing.assert_allclose(end / length, deflection, rtol=1e-11)


def test_crack_that_reaches_the_end_stops():
    found = solve(replace(DCB, opening=6.0))
    assert found.status == "complete" and found.rows[-1]["crack_length"] <= 14.0
    assert found.ending == f"separated at opening {found.rows[-1]['opening']:.6g}"


@pytest.mark.parametrize("opening", [(1.0, 0.5, 3.0), 0.0])
def test_refuses_unloading(opening):
    with pytest.raises(ValueError, match="load.opening"):
        solve(replace(DCB, opening=opening))


def test_refuses_openings_beyond_the_factors():
    with pytest.raises(ValueError, match="elastica"):
        solve(replace(DCB, arm_thickness=0.01, opening=10.0, theory="factors"))


def test_strip_begins_to_peel_at_the_plate_limit():
    s = steps(replace(STRIP, theory="simple"))
    assert s["load"].max() == pytest.approx(np.sqrt(2 * 0.1 * STRIP.bending) / 30.0, rel=1e-12)
    at = int(s["load"].argmax())
    assert s["opening"][at] == pytest.approx(s["load"][at] * 30.0**3 / (3 * STRIP.bending), rel=1e-12)
    assert steps(replace(STRIP, theory="elastica"))["load"].max() == pytest.approx(s["load"].max(), rel=2e-3)


def test_a_strip_is_an_arm_of_a_dcb_of_twice_the_toughness():
    for theory in ("simple", "elastica"):
        one = steps(replace(STRIP, theory=theory))
        two = steps(replace(STRIP, theory=theory, arms=2, toughness=0.2, opening=12.0))
        assert one["load"] == pytest.approx(two["load"], rel=1e-9)
        assert 2 * one["opening"] == pytest.approx(two["opening"], rel=1e-12)


def test_kendall_of_a_strip_that_stretches():
    s = steps(replace(STRIP, young=0.5, opening=60.0, theory="kendall"))
    P = s["load"][-1]
    assert P + P**2 / (2 * 0.5 * 2.0) == pytest.approx(0.1, rel=1e-12) and P < 0.96 * 0.1
    assert s["opening"][-1] == pytest.approx(s["crack_length"][-1] * (1 + P / (0.5 * 2.0)), rel=1e-12)


@pytest.mark.parametrize(("arms", "theory"), [(1, "corrected"), (1, "factors"), (2, "kendall")])
def test_refuses_theories_of_the_other_specimen(arms, theory):
    with pytest.raises(ValueError, match="theory"):
        solve(replace(STRIP, arms=arms, theory=theory))
