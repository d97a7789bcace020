"""Which point reaches a kink of the law next, on states made up for the purpose."""

import numpy as np
import pytest

from iga.interface.laws import BilinearLaw
from iga.path.kinks import HAIR, next_event

LAW = BilinearLaw(strength=4.0, toughness=0.1, ductility=12.5, penalty=1e5)  # g_u 0.05, g_max 0.004
AWAY = HAIR * LAW.g_max


def event(*points):
    """`next_event` for points given as (gap, history, rate)."""
    return next_event(LAW, *np.array(points, dtype=float).T)


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
    found = event((gap, history, 2.0))
    assert found.q == 0
    assert found.away == pytest.approx((kink - gap) / 2.0, rel=1e-12)
    assert found.beyond == pytest.approx((kink - gap + AWAY) / 2.0, rel=1e-12)
    assert gap + 2.0 * found.beyond > kink, "a step that ends there must have passed the kink"


def test_the_nearest_along_the_path_comes_first_and_not_the_nearest_gap():
    far_but_fast, near_but_slow = (0.0, 0.0, 1.0), (0.003, 0.003, 0.1)
    assert event(near_but_slow, far_but_fast).q == 1
    assert event(far_but_fast, near_but_slow).q == 0
    assert event((0.003, 0.003, 0.5), (0.0, 0.0, 1.0)).q == 0


@pytest.mark.parametrize("rate", [0.0, -1.0])
@pytest.mark.parametrize(("gap", "history"), [(0.0, 0.0), (0.01, 0.02), (0.02, 0.02)])
def test_a_point_that_does_not_open_has_no_kink_ahead(gap, history, rate):
    assert event((gap, history, rate)) is None
    assert event((gap, history, rate), (0.0, 0.0, 1e-3)).q == 1


@pytest.mark.parametrize("history", [LAW.g_u, 3.0 * LAW.g_u])
def test_a_broken_point_has_no_kink_any_more(history):
    assert event((history, history, 1.0)) is None
    assert event((0.0, history, 1.0)) is None, "closed again and opening"
    assert event((history, history, 1e6), (0.0, 0.0, 1e-6)).q == 1


def test_the_hair_beyond_is_small_against_both_branches():
    """Nearly brittle: the softening branch is far shorter than the elastic one."""
    brittle = BilinearLaw(strength=4.0, toughness=0.1, ductility=1.01, penalty=1e5)
    found = next_event(brittle, np.array([0.0]), np.array([0.0]), np.array([1.0]))
    assert brittle.g_max < found.beyond < brittle.g_max + 0.01 * (brittle.g_u - brittle.g_max)
