"""The laws of checks and beam against their own definition."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from verify.support.refusal import Refusal
from verify.theory.law import KNOWN_LAWS, Exponential, KnownLaw, Law, Softened

positive = st.floats(0.01, 100.0)


@st.composite
def laws(draw):
    return Softened(draw(positive), draw(positive), draw(st.floats(1.01, 1e3)), draw(st.floats(1.0, 1e6)))


def test_reference_values():
    law = Softened(4.0, 0.1, 12.5, 1e5)
    assert (law.g_open, law.g_peak, law.stiffness) == pytest.approx((0.05, 0.004, 1000.0))
    gap = np.array([-1e-3, 0.0, 0.002, 0.004, 0.027, 0.05, 1.0])
    np.testing.assert_allclose(law.traction(gap), [-100.0, 0.0, 2.0, 4.0, 2.0, 0.0, 0.0], atol=1e-13)


@given(laws(), st.floats(0.0, 2.0), st.floats(-0.5, 1.0))
def test_unloading_follows_the_secant_to_the_origin(law, largest, share):
    history = largest * law.g_open
    gap = share * history
    secant = law.secant(history) * gap if gap >= 0.0 else law.penalty * gap
    assert law.traction(gap, history) == pytest.approx(secant, rel=1e-12, abs=1e-12 * law.strength)
    peak = float(law.traction(history))
    assert law.secant(history) * history == pytest.approx(peak, rel=1e-9, abs=1e-12 * law.strength)


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


#: Fibres that bridge a crack: a peak, then a long tail.
FIBRES = ((0.004, 4.0), (0.01, 1.0), (0.03, 0.8), (0.2, 0.0))


@st.composite
def shapes(draw):
    """Laws of every name."""
    numbers = draw(positive), draw(positive), draw(st.floats(1.01, 1e3)), draw(st.floats(1.0, 1e6))
    name = draw(st.sampled_from(sorted(KNOWN_LAWS)))
    part, decay = st.floats(0.1, 0.9), draw(st.floats(0.2, 9.0))
    keys = {"plateau": draw(part), "knee": draw(part), "knee_traction": draw(part), "decay": decay, "table": FIBRES}
    return KNOWN_LAWS[name](*numbers, **keys if name != "exponential" else {})


def corners(law):
    """Openings and tractions of onset, corners and failure."""
    opening = law.g_peak + law.way * law.shape.corners
    return opening, law.traction(opening)


@given(shapes(), st.floats(0.0, 1.2))
def test_area_of_every_law_is_the_integral_of_its_traction(law, share):
    assert isinstance(law, KnownLaw) and 0.0 < law.g_peak < law.g_open
    assert law.area(2.0 * law.g_open) == pytest.approx(law.toughness, rel=1e-12)
    end = share * law.g_open
    kinks = [
        law.g_peak,
        law.g_open,
        *(np.geomspace(1e-3, 40, 400) * law.g_0 if isinstance(law, Exponential) else corners(law)[0]),
    ]
    ends = sorted({0.0, *(k for k in kinks if k < end), end})
    nodes, weights = np.polynomial.legendre.leggauss(8)
    integral = sum(
        0.5 * (b - a) * weights @ law.traction(0.5 * (a + b) + 0.5 * (b - a) * nodes) for a, b in pairwise(ends)
    )
    assert law.area(end) == pytest.approx(integral, rel=1e-9, abs=1e-12 * law.toughness)


@given(shapes())
def test_every_law_begins_at_its_stiffness_and_loses_its_toughness(law):
    assert law.traction(0.5 * law.g_peak) == pytest.approx(0.5 * law.stiffness * law.g_peak, rel=1e-12)
    history = np.linspace(0.0, 1.1 * law.g_open, 4001)
    damage, lost = law.damage(history), law.dissipated(history)
    assert np.all(np.diff(damage) >= -1e-12) and (damage[0], damage[-1]) == (0.0, 1.0)
    assert np.all(np.diff(lost) >= -1e-12 * law.toughness) and lost[-1] == pytest.approx(law.toughness)
    assert law.dissipated(law.g_peak) == pytest.approx(0.0, abs=1e-9 * law.toughness)
    strongest = law.g_0 if isinstance(law, Exponential) else law.g_peak
    assert law.traction(strongest) == pytest.approx(law.strength, rel=1e-12)


def test_reference_values_of_other_shapes():
    flat = KNOWN_LAWS["trapezoidal"](4.0, 0.1, 12.5, 1e5)  # g_max 0.004; w = (0.05 - 0.004) / 1.5
    at = [0.004, 0.004 + 0.023 / 1.5, 0.004 + 0.046 / 1.5]
    np.testing.assert_allclose(corners(flat), [at, [4.0, 4.0, 0.0]], atol=1e-12)
    np.testing.assert_allclose(flat.traction([0.002, 0.01, flat.g_open - 0.0023 / 1.5]), [2.0, 4.0, 0.4])
    table = KNOWN_LAWS["tabular"](1.0, 1.0, 2.0, 1e5, table=FIBRES)
    assert (table.strength, table.g_peak, table.g_open, table.stiffness) == pytest.approx((4.0, 0.004, 0.2, 1000.0))
    assert table.toughness == pytest.approx(0.008 + 0.015 + 0.018 + 0.068)
    assert Law(table.strength, table.toughness, table.ductility, 1e5).g_peak == pytest.approx(0.004)
    soft = Exponential(4.0, 0.1, 12.5, 1e5)  # NEML2 golds at x = 1 and 3: p / p_max = 1, 3 / e^2
    np.testing.assert_allclose(soft.traction(soft.g_0 * np.array([1.0, 3.0])), [4.0, 12.0 / np.e**2], rtol=1e-13)
    assert KNOWN_LAWS["trapezoidal"](4.0, 0.1, 12.5, 1e5, plateau=0.0).g_open == pytest.approx(0.05)


@pytest.mark.parametrize(
    ("table", "sentence"),
    [
        ((), "table: must be two or more pairs"),
        (((1.0, 1.0),), "table: must be two or more pairs"),
        (((1.0, 1.0), (np.inf, 0.0)), "table: must be two or more pairs"),
        (((0.0, 0.0), (1.0, 1.0), (2.0, 0.0)), "table: openings must rise from above 0, got"),
        (((1.0, 1.0), (1.0, 0.0)), "table: openings must rise from above 0, got"),
        (((1.0, 1.0), (2.0, 0.5)), "table: tractions must be > 0 and the last one 0, got"),
        (((1.0, 1.0), (2.0, -0.5), (3.0, 0.0)), "table: tractions must be > 0 and the last one 0, got"),
        (((1.0, 1.0), (2.0, 2.5), (3.0, 0.0)), "table: traction / opening must fall from pair to pair, got"),
    ],
)
def test_refused_tables(table, sentence):
    with pytest.raises(Refusal, match=sentence):
        KNOWN_LAWS["tabular"](1.0, 1.0, 2.0, 1.0, table=table)
