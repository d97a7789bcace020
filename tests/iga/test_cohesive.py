"""The bilinear law: its shape, its history, its energies and its tangent."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from iga.cohesive import BilinearLaw

LAW = BilinearLaw(strength=4.0, toughness=0.1, ductility=12.5, penalty=1e5)


@st.composite
def laws(draw, **fixed):
    size = {"strength": draw(st.floats(0.1, 100.0)), "toughness": draw(st.floats(1e-3, 10.0))}
    return BilinearLaw(**size, ductility=draw(st.floats(1.01, 1e3)), penalty=draw(st.floats(1.0, 1e8)), **fixed)


def walk(law: BilinearLaw, gaps: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Tractions along a path of gaps and the history after each, committed as it goes."""
    p, k = np.zeros_like(gaps), np.zeros_like(gaps)
    now = np.zeros(1)
    for i, g in enumerate(gaps):
        p[i : i + 1], _, now = law.traction(np.array([g]), now)
        k[i] = now[0]
    return p, k


@given(laws())
def test_corner_points_and_area_of_the_envelope(law):
    assert np.isclose(law.envelope(np.array(law.g_max)), law.strength, rtol=1e-12)
    assert abs(law.envelope(np.array(law.g_u))) < 1e-12 * law.strength
    assert np.isclose(law.work(np.array(3 * law.g_u)), law.toughness, rtol=1e-12)
    corners = np.array([0.0, law.g_max, law.g_u])
    assert np.isclose(np.trapezoid(law.envelope(corners), corners), law.toughness, rtol=1e-12)


@given(laws(), st.lists(st.floats(-0.5, 1.5), min_size=1, max_size=12))
def test_work_done_is_stored_or_dissipated(law, path):
    """Whatever the path of gaps: the integral of p dg is the energy kept plus the energy lost, which never falls."""
    stops = np.concatenate([[0.0], np.array(path) * law.g_u])
    kinks = np.array([0.0, law.g_max, law.g_u])
    spent, lost_before, k = 0.0, 0.0, np.zeros(1)
    for start, end in zip(stops[:-1], stops[1:], strict=True):
        inner = [c for c in (*kinks, k[0]) if min(start, end) < c < max(start, end)]
        legs = np.array(sorted([start, *inner, end], reverse=bool(end < start)))
        for a, b in zip(legs[:-1], legs[1:], strict=True):
            middle = np.array([0.5 * (a + b)])
            p, _, k = law.traction(middle, k)
            spent += float(p[0]) * (b - a)
            k = np.maximum(k, b)
    cohesive, contact, lost = (float(e[0]) for e in law.energies(stops[-1:], k))
    scale = law.toughness + 0.5 * law.penalty * np.max(stops**2)
    assert abs(spent - cohesive - contact - lost) < 1e-9 * scale
    assert lost >= lost_before - 1e-12 * law.toughness and lost <= law.toughness * (1 + 1e-12)


@given(laws(), st.floats(1.05, 0.95 * 1e3), st.floats(0.0, 1.0))
def test_unloading_goes_along_the_secant_to_the_origin(law, reach, back):
    k = min(reach * law.g_max, 0.99 * law.g_u)
    p, history = walk(law, np.array([k, back * k]))
    assert np.isclose(p[1], back * p[0], rtol=1e-9, atol=1e-12 * law.strength)
    assert history[1] == history[0] == pytest.approx(k)


@pytest.mark.parametrize("irreversible", [True, False])
@pytest.mark.parametrize("contact", [True, False])
@pytest.mark.parametrize("k", [0.0, 0.5, 3.0, 20.0])
@pytest.mark.parametrize("g", [-0.7, 0.3, 2.0, 2.9, 3.1, 5.0, 13.0])
def test_tangent_is_the_derivative_of_the_traction(k, g, contact, irreversible):
    law = BilinearLaw(4.0, 0.1, 12.5, 1e5, contact, irreversible)
    g, k, h = np.array([g * law.g_max]), np.array([k * law.g_max]), 1e-6 * law.g_max
    _, slope, _ = law.traction(g, k)
    difference = (law.traction(g + h, k)[0] - law.traction(g - h, k)[0]) / (2 * h)
    assert np.allclose(slope, difference, rtol=1e-6, atol=1e-6 * law.stiffness)


def test_a_closed_gap_is_resisted_by_the_penalty_and_is_no_damage():
    p, k = walk(LAW, np.array([-1e-3]))
    assert p[0] == pytest.approx(-100.0) and k[0] == 0.0


def test_without_contact_the_secant_continues_to_negative_gaps():
    law = BilinearLaw(4.0, 0.1, 12.5, 1e5, contact=False)
    p, _ = walk(law, np.array([2 * LAW.g_max, -2 * LAW.g_max]))
    assert p[1] == pytest.approx(-p[0])


def test_a_reversible_law_dissipates_nothing():
    law = BilinearLaw(4.0, 0.1, 12.5, 1e5, irreversible=False)
    p, k = walk(law, np.array([2 * law.g_u, 0.5 * law.g_u]))
    assert p[0] == 0.0 and p[1] == pytest.approx(float(law.envelope(np.array(0.5 * law.g_u))))
    cohesive, contact, lost = law.energies(np.array([0.5 * law.g_u]), k[1:])
    assert (
        lost[0] == 0.0 and contact[0] == 0.0 and cohesive[0] == pytest.approx(float(law.work(np.array(0.5 * law.g_u))))
    )
