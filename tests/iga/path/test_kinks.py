"""Which point reaches a kink of the law next, on states made up for the purpose."""

from types import SimpleNamespace

import numpy as np
import pytest

from iga.laws.laws import LAWS, ShapedLaw
from iga.path.kinks import Kink, first_kink
from iga.path.step_length import _past_kink

LAW = ShapedLaw.opening(strength=4.0, toughness=0.1, ductility=12.5, penalty=1e5)  # g_u 0.05, g_max 0.004


def event(*points):
    """`first_kink` for points given as (gap, history, rate)."""
    return first_kink(np.array(LAW.kinks), *np.array(points, dtype=float).T)


@pytest.mark.parametrize(
    ("gap", "history", "kink"),
    [
        (0.0, 0.0, LAW.g_max),  # never loaded
        (0.001, 0.003, LAW.g_max),  # elastic: what it has seen below the strength is no history
        (-0.002, 0.0, LAW.g_max),  # closed
        (0.01, 0.02, 0.02),  # unloaded: back to the envelope
        (-0.001, 0.02, 0.02),  # unloaded and closed
        (0.02, 0.02, LAW.g_u),  # softening
        (0.02 * (1.0 - 1e-12), 0.02, LAW.g_u),  # softening, but for a rounding
    ],
)
def test_the_next_kink_of_one_point(gap, history, kink):
    found, away = event((gap, history, 2.0))
    assert found == Kink(0, pytest.approx(kink, rel=1e-12))
    assert away == pytest.approx((kink - gap) / 2.0, rel=1e-12)


def test_the_nearest_along_the_path_comes_first_and_not_the_nearest_gap():
    far_but_fast, near_but_slow = (0.0, 0.0, 1.0), (0.003, 0.003, 0.1)
    assert event(near_but_slow, far_but_fast)[0].q == 1
    assert event(far_but_fast, near_but_slow)[0].q == 0
    assert event((0.003, 0.003, 0.5), (0.0, 0.0, 1.0))[0].q == 0


@pytest.mark.parametrize("rate", [0.0, -1.0])
@pytest.mark.parametrize(("gap", "history"), [(0.0, 0.0), (0.01, 0.02), (0.02, 0.02)])
def test_a_point_that_does_not_open_has_no_kink_ahead(gap, history, rate):
    assert event((gap, history, rate)) is None
    assert event((gap, history, rate), (0.0, 0.0, 1e-3))[0].q == 1


@pytest.mark.parametrize("history", [LAW.g_u, 3.0 * LAW.g_u])
def test_a_broken_point_has_no_kink_any_more(history):
    assert event((history, history, 1.0)) is None
    assert event((0.0, history, 1.0)) is None, "closed again and opening"
    assert event((history, history, 1e6), (0.0, 0.0, 1e-6))[0].q == 1


def test_what_is_past_a_kink_is_little_against_both_branches():
    """A nearly brittle law: the softening branch is far shorter than the elastic one."""
    brittle = ShapedLaw.opening(strength=4.0, toughness=0.1, ductility=1.01, penalty=1e5)
    one = np.zeros(1)
    for law in (LAW, brittle, LAWS["trapezoidal"].opening(4.0, 0.1, 12.5, 1e5)):
        touch = SimpleNamespace(g_q=one, share_q=one + 1.0, on_q=one == 0.0)
        system = SimpleNamespace(interface=SimpleNamespace(law=law, bonded_q=one == 0.0))
        point = SimpleNamespace(
            response=SimpleNamespace(contact=touch, x_q=one, back_q=one),
            state=SimpleNamespace(k_q=one),
            tangent=SimpleNamespace(rate_q=one + 2.0),
        )
        q, onto, past = _past_kink(system, point)
        assert q == 0 and onto == pytest.approx(law.g_max / 2.0, rel=1e-12)
        assert 0.0 < past - onto < 0.5 * 0.01 * min(law.g_max, law.g_u - law.g_max)
        system.interface.bonded_q = one != 0.0
        assert _past_kink(system, point) is None, "points without cohesion have no kink"


def test_on_a_way_from_gaps_to_gaps_points_off_the_envelope_have_the_kinks_ahead_of_their_history():
    """A way that ends before them has none; where points reach several kinks the first one counts."""
    start = np.array([0.01, 0.0, 0.0])
    history, way = np.array([0.02, 0.0, LAW.g_u]), np.array([0.1, 0.008, 1.0])
    found, part = first_kink(np.array(LAW.kinks), start, history, way, reloading=False)
    assert found == Kink(0, LAW.g_u) and part == pytest.approx(0.4)
    found, part = first_kink(np.array(LAW.kinks), start, history, np.array([0.01, 0.008, 1.0]), reloading=False)
    assert found == Kink(1, LAW.g_max) and part == pytest.approx(0.5)
