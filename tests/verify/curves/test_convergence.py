"""Order, Richardson and grid convergence index: published triples and sequences with a known limit."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from verify.curves.convergence import assess, observed_order

NARROW = (1.0, 1.5, 2.0)
WIDE = (1.0, 2.0, 2.0 * np.sqrt(4500 / 980))  # 18000, 4500 and 980 cells


@pytest.mark.parametrize(
    ("size", "value", "order", "limit", "gci"),
    [  # Celik, Ghia, Roache, Freitas (2008), J. Fluids Eng. 130, 078001, table 1
        (NARROW, (6.063, 5.972, 5.863), 1.53, 6.1685, 0.022),
        (WIDE, (10.7880, 10.7250, 10.6050), 0.75, 10.8801, 0.011),
        (WIDE, (6.0042, 5.9624, 6.0909), 1.51, 6.0269, 0.005),
    ],
)
def test_published_triples(size, value, order, limit, gci):
    found = assess(size, value)
    assert found.order == pytest.approx(order, abs=0.005)
    assert found.limit == pytest.approx(limit, abs=1e-4)
    assert found.gci == pytest.approx(gci, abs=0.0005)


@given(st.floats(0.5, 6.0), st.floats(1.2, 3.0), st.floats(1.2, 3.0), st.floats(-5.0, 5.0), st.floats(0.1, 2.0))
def test_power_law_is_recovered_at_any_ratios(p, r21, r32, limit, c):
    h = 0.1 * np.array([1.0, r21, r21 * r32])
    value = limit + c * h**p
    if abs(value[1] - value[0]) < 1e-5:
        return  # the differences are rounding
    assert observed_order(h, value) == pytest.approx(p, rel=1e-5)
    found = assess(h, value)
    assert found.asymptotic
    assert found.limit == pytest.approx(limit, abs=1e-6)


def test_meshes_come_in_any_order_and_more_than_three():
    h = np.array([0.4, 0.1, 0.05, 0.2])
    found = assess(h, 2.0 + 3.0 * h**2)
    assert found.asymptotic and found.order == pytest.approx(2.0) and found.limit == pytest.approx(2.0)


H = np.array([1.0, 2.0, 4.0, 8.0])


def growing(factor: float) -> np.ndarray:
    """Differences that grow by 2^1.7, and by 2^(1.7 factor) on the coarser meshes."""
    return 100.0 + np.cumsum([0.0, 1.0, 2.0**1.7, 2.0 ** (1.7 + 1.7 * factor)])


@pytest.mark.parametrize(
    ("value", "word"),
    [
        ((1.0, 1.1, 1.05), "oscillate"),
        ((1.0, 1.2, 1.3), "settle"),
        ((1.0, 1.0, 1.0), "do not change"),
        ((1.0, 1.0, 1.1), "no order"),
        (1.0 + 2e-2 * H + 1e-3 * H**4, "coarser"),
        (growing(0.89), f"order {1.7 * 0.89:.2f} on the coarser meshes"),
        (growing(0.91), ""),  # orders of successive triples may differ by a tenth
        (growing(1.09), ""),
        (growing(1.11), f"order {1.7 * 1.11:.2f} on the coarser meshes"),
    ],
)
def test_says_why_a_sequence_is_not_asymptotic(value, word):
    found = assess(H[: len(value)], value)
    assert found.asymptotic == (not word) and word in found.verdict


def test_the_index_is_five_quarters_of_the_error_that_the_order_implies():
    """The relative error of f = 1 + c h^p on the finest mesh is known; the index is over the value, not the limit."""
    h, p, c = np.array([0.1, 0.2, 0.4]), 2.5, 3.0
    found, error = assess(h, 1.0 + c * h**p), c * 0.1**p
    assert found.error == pytest.approx(error) and found.gci == pytest.approx(1.25 * error / (1.0 + error))
    around = assess(h, c * h**p)
    assert np.isnan(around.error) or around.error > 1e6, "nothing is relative to a limit of zero"
    assert np.isnan(assess(h, c * (h**p - 0.1**p)).gci), "nor to a value of zero"


@pytest.mark.parametrize("size", [(0.0, 1.0, 2.0), (-1.0, 1.0, 2.0), (1.0, 1.0, 2.0), (1.0, 2.0, 2.0), (1.0, 2.0)])
def test_refuses_sizes_that_are_none_or_the_same_or_two(size):
    with pytest.raises(ValueError, match="at least three different positive numbers"):
        assess(size, (1.0, 1.1, 1.4)[: len(size)])


def test_no_order_fits_differences_that_no_power_has():
    """A mesh a little coarser changes much, one that is much coarser next to nothing more."""
    assert np.isnan(observed_order((1.0, 1.1, 4.0), (1.0, 2.0, 2.0 + 1e-6)))
