"""How far a crack is expected to run in arms that are bent."""

import numpy as np
import pytest
from bent_specimens import ARM, MODES, PRESSED, flexure

from iga.delamination.bent import BENT, crack_end, moments
from iga.specimen.layout import Load, Support

GUIDED = Support(None, "right"), Support(None, "right", couple=True)
OPENING = 0.8


@pytest.mark.parametrize(("lower", "mode", "released", "turned"), [(1.0, 0, 2.0, 2.0), (-1.0, 1, 1.5, 1.5)])
def test_a_crack_under_end_moments_runs_at_the_toughness_of_its_mode(lower, mode, released, turned):
    """``2 w G = n M^2 / EI``: in opening of two arms, in sliding less that of both as one, 4 EI of 8. The rotation that
    the moments work on grows by as much along the crack."""
    loads = Load(0, "left", -1.0, couple=True), Load(1, "left", lower, couple=True)
    problem = flexure(loads=loads, supports=GUIDED, bonded=(20.0, 102.0), opening=(OPENING,))
    EI = 25.4 * ARM.moduli.axial("strain") * ARM.thickness**3 / 12.0
    moment = (2.0 * 25.4 * MODES.toughness[mode] * EI / released) ** 0.5
    as_one = (2.0 - turned) * 102.0 * moment / EI
    expected = max((BENT.slack * OPENING - as_one) * EI / (turned * moment), 20.0)
    assert crack_end(problem) == pytest.approx(expected, abs=102.0 / BENT.places)


def test_a_load_in_the_middle_bends_by_half_of_it_from_the_middle_of_a_roller_on():
    X = np.array([10.0, 45.0])
    assert moments(flexure().layout, X).sum(0) == pytest.approx(0.5 * (X - 0.25), rel=1e-12)


def test_a_programme_may_bend_the_arms_both_ways():
    """The upper arm alone is pulled off where the load is turned round and the crack has passed it."""
    pressed, turned = crack_end(flexure()), crack_end(flexure(loads=(Load(0, "top", 1.0, PRESSED),)))
    assert turned > pressed + 5.0
    assert crack_end(flexure(opening=(-6.0,))) == turned == crack_end(flexure(opening=(5.0, -6.0)))
    assert crack_end(flexure(opening=(6.0, -2.0))) == pressed
