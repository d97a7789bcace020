"""Fits of strength and toughness to curves: what went in comes back, and what a curve does not tell is said."""

from dataclasses import replace

import numpy as np
import pytest
from made_up_tests import NOISY, TESTS, recorded, specimen

from verify.curves.of_run import cubics
from verify.methods.solve import solve
from verify.reduction.coupon import coupon
from verify.reduction.data import Measured
from verify.reduction.reduce import reduce
from verify.reduction.scheme import Settings
from verify.scene.load import load_scene
from verify.studies.reduce.bias import of_run
from verify.studies.reduce.fit import fitted
from verify.studies.reduce.wording import remarks


@pytest.mark.slow
def test_strength_and_toughness_come_back_from_a_run():
    """From a start 40 % off; the run has a tenth more modulus than the scene of the fit."""
    truth = load_scene("dcb-as4peek", ("interface.strength=30", "material.E1=134970.0"))
    start = load_scene("dcb-as4peek", ("interface.strength=50",))
    rows = of_run(truth, solve(truth, "beam"))
    assert rows is not None
    fit = fitted(replace(rows, coupon=coupon(start)), start)
    assert fit.values["strength"].value == pytest.approx(30.0, rel=0.01) and fit.values[
        "toughness"
    ].value == pytest.approx(0.969, rel=2e-3)
    assert fit.values["strength"].half_width < 0.02 * 30.0 and "cannot be identified" not in " ".join(fit.sentences)


@pytest.mark.slow
def test_what_the_linear_part_takes_for_a_toe_is_fitted_away():
    """A test without slack whose bond gives way in its linear part: rows of the model itself, from their start on."""
    overrides = ("interface.strength=30", 'effects.kinematics="linear"', "load.opening=6", "beam.in_a_zone=12")
    truth = load_scene("dcb-as4peek", overrides)
    opening, load = cubics(solve(truth, "beam"))
    found = reduce(Measured("test", opening, load, np.full(opening.size, np.nan)), coupon(truth))
    assert found.toe < -0.02 and any("which is no slack" in text for text in remarks(found))
    fit = fitted(found, truth)
    assert fit.values["strength"].value == pytest.approx(30.0, rel=0.01) and fit.values[
        "toughness"
    ].value == pytest.approx(0.969, rel=1e-3)
    assert abs(fit.values["toe"].value) < 0.002


@pytest.mark.slow
def test_a_brittle_curve_does_not_tell_the_strength():
    """Of fracture mechanics, with noise: infinite strength fits as well as a large one."""
    test = recorded("dcb", replace(NOISY, noise=0.02, rows=300))
    found = reduce(test, specimen("dcb"), Settings(machine=NOISY.machine))
    scene = load_scene("dcb-as4peek", ("interface.strength=100", 'effects.kinematics="linear"'))
    fit = fitted(found, scene)
    assert abs(fit.values["toughness"].value - TESTS["dcb"][1]) < max(fit.values["toughness"].half_width, 0.02)
    assert "the strength cannot be identified" in fit.sentences[-1] and np.isfinite(fit.misfit)


@pytest.mark.slow
def test_a_law_that_does_not_describe_the_test_gets_no_interval():
    """Of fibres that bridge, with noise of 0.5 %, by a law of one line down."""
    table = [[0.0005, 31.5], [0.02, 1.46], [0.8, 0.0]]
    of = ("specimen.length=150", "specimen.precrack=50", "specimen.arm_thickness=2.5", "load.opening=12")
    linear = (*of, 'effects.kinematics="linear"')
    run = solve(load_scene("dcb-as4peek", (f'interface={{law="tabular", table={table}}}', *linear)), "beam")
    d = np.linspace(0.0, 12.0, 600)
    P = np.interp(d, run.opening, run.load)
    P += 0.005 * P.max() * np.random.default_rng(0).standard_normal(d.size)
    scene = load_scene("dcb-as4peek", linear)
    fit = fitted(reduce(Measured("test", d, P, np.full(d.size, np.nan)), coupon(scene)), scene)
    assert "this law does not describe the test" in fit.sentences[-1] and fit.misfit > fit.explained > 0.005
    assert all(np.isnan(value.half_width) for value in fit.values.values())
