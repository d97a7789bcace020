"""J over the end opening gives the traction back, and the end opening is that of two cantilevers."""

import numpy as np
import pytest
from made_up_tests import specimen

from verify.reduction.bridging import end_opening, falling
from verify.theory.law import KNOWN_LAWS

W = np.geomspace(0.02, 3.0, 400)


def test_end_opening_is_that_of_cantilevers():
    """delta - 2 theta a_0 + P a_0^3 / (3 E I) of the part of the arms in front of the bond, P alone on it."""
    of, P, a, E = specimen("dcb"), np.array([30.0, 40.0]), np.array([40.0, 60.0]), 1.2e5
    L, EI = a + of.correction, E * of.width * of.h**3 / 12.0
    delta, theta = 2.0 * P * L**3 / (3.0 * EI), P * L**2 / (2.0 * EI)
    w = delta - 2.0 * theta * of.precrack + P * of.precrack**3 / (3.0 * EI)
    assert end_opening(of, P, a, E) == pytest.approx(w, rel=1e-12)


@pytest.mark.parametrize("lines", [[(1.5, 2.0)], [(2.0, 0.4), (0.8, 2.4)], []])
def test_the_law_comes_back_from_its_integral(lines):
    J = 0.3 + sum((s * (np.minimum(W, e) - np.minimum(W, e) ** 2 / (2.0 * e)) for s, e in lines), np.zeros(W.size))
    law, total = falling(W, J), sum(0.5 * s * e for s, e in lines)
    assert law.tip == pytest.approx(0.3, rel=0.01) and law.above(0.0) == pytest.approx(total, rel=0.01, abs=1e-6)
    table = KNOWN_LAWS["tabular"](1.0, 1.0, 2.0, 1.0, table=law.table)
    assert table.toughness == pytest.approx(0.3 + total, rel=0.01) and (np.diff(np.array(law.table)[:, 1]) < 0.0).all()
    for w in (W[0], 0.1, 0.35):
        true = sum(s * max(1.0 - w / e, 0.0) for s, e in lines)
        assert law.traction(w) == pytest.approx(true, rel=0.03, abs=1e-6)
        assert table.traction(w) == pytest.approx(law.traction(w), rel=1e-9, abs=1e-9)


def test_what_the_test_did_not_open_is_beyond_it():
    """The end of a line of which the test saw the first half."""
    law = falling(W, 0.3 + 0.8 * (W - W**2 / 12.0))
    assert law.above(law.last) == pytest.approx(0.6, rel=0.2)
