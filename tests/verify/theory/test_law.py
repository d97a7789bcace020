"""The bilinear law of checks and beam against its own definition."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from verify.theory.law import Bilinear, Law

positive = st.floats(0.01, 100.0)


@st.composite
def laws(draw):
    return Bilinear(draw(positive), draw(positive), draw(st.floats(1.01, 1e3)), draw(st.floats(1.0, 1e6)))


def test_reference_values():
    law = Bilinear(4.0, 0.1, 12.5, 1e5)
    assert (law.g_open, law.g_peak, law.stiffness) == pytest.approx((0.05, 0.004, 1000.0))
    gap = np.array([-1e-3, 0.0, 0.002, 0.004, 0.027, 0.05, 1.0])
    np.testing.assert_allclose(law.traction(gap), [-100.0, 0.0, 2.0, 4.0, 2.0, 0.0, 0.0], atol=1e-13)


@given(laws())
def test_area_is_the_integral_of_the_traction(law):
    for end in (0.3 * law.g_peak, 0.5 * (law.g_peak + law.g_open), 2.0 * law.g_open, -law.g_peak):
        kinks = [0.0, *(k for k in (law.g_peak, law.g_open) if k < end), end]
        simpson = [law.traction([a, 0.5 * (a + b), b]) @ [1, 4, 1] for a, b in pairwise(kinks)]
        integral = np.diff(kinks) @ simpson / 6
        assert law.area(end) == pytest.approx(integral, rel=1e-9)
    assert law.area(2.0 * law.g_open) == pytest.approx(law.toughness, rel=1e-12)


@given(laws(), st.floats(0.0, 2.0), st.floats(-0.5, 1.0))
def test_unloading_follows_the_secant_to_the_origin(law, largest, share):
    history = largest * law.g_open
    gap = share * history
    secant = law.secant(history) * gap if gap >= 0.0 else law.penalty * gap
    assert law.traction(gap, history) == pytest.approx(secant, rel=1e-12, abs=1e-12 * law.strength)
    peak = float(law.traction(history))
    assert law.secant(history) * history == pytest.approx(peak, rel=1e-9, abs=1e-12 * law.strength)


@given(laws())
def test_dissipation_grows_from_nothing_to_the_toughness(law):
    lost = law.dissipated(np.linspace(0.0, 1.5 * law.g_open, 200))
    assert np.all(np.diff(lost) >= -1e-12 * law.toughness)
    assert lost[0] == 0.0 and lost[-1] == pytest.approx(law.toughness)
    assert law.dissipated(law.g_peak) == pytest.approx(0.0, abs=1e-12 * law.toughness)


def test_without_contact_the_secant_continues():
    law = Bilinear(4.0, 0.1, 12.5, 1e5, contact=False)
    assert law.traction(-1e-3) == pytest.approx(-1.0)
    assert law.traction(-1e-3, history=0.027) == pytest.approx(-1e-3 * float(law.secant(0.027)))
    assert law.area(-1e-3) == pytest.approx(0.5e-3)


@given(laws(), st.floats(-0.5, 3.0))
def test_of_any_law_the_part_below_the_strength_is_known_and_no_other(law, reach):
    """What the plain law says is what the bilinear one says, or nothing."""
    plain = Law(law.strength, law.toughness, law.ductility, law.penalty)
    assert plain.g_peak == pytest.approx(law.g_peak) and plain.stiffness == pytest.approx(law.stiffness)
    gap = reach * law.g_peak
    if gap <= min(plain.g_peak, law.g_peak):
        assert plain.area(gap) == pytest.approx(law.area(gap))
    elif gap > plain.g_peak:
        assert np.isnan(plain.area(gap))
