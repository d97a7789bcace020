"""Two bent arms with a crack are those of the closed forms of mixed-mode tests, to rounding."""

from __future__ import annotations

import pytest

from verify.theory.bent_arms import BentArms, Force

E, H, W, L, A, C, D = 1.2e5, 1.5, 25.0, 50.0, 30.0, 44.4, 20.0
AT_BOTH_ENDS = Force(1, 0.0, False), Force(1, 2 * L, False)
GUIDED = Force(None, 2 * L, False), Force(None, 2 * L, True)
K = 16.0 * W**2 * E * H**3

#: Test -> loads, supports, G for a load of 1, and its part of sliding.
TESTS: dict[str, tuple[tuple[Force, ...], tuple[Force, ...], float, float]] = {
    "dcb": ((Force(0, 0.0, False, 1.0), Force(1, 0.0, False, -1.0)), (), 192.0 * A**2 / K, 0.0),
    "enf": ((Force(0, L, False, -1.0),), AT_BOTH_ENDS, 9.0 * A**2 / K, 1.0),
    "slb": ((Force(0, L, False, -1.0),), (Force(0, 0.0, False), Force(1, 2 * L, False)), 21.0 * A**2 / K, 3.0 / 7.0),
    "els": ((Force(0, 0.0, False, -1.0),), GUIDED, 36.0 * A**2 / K, 1.0),
    "4enf": ((Force(0, D, False, -0.5), Force(0, 2 * L - D, False, -0.5)), AT_BOTH_ENDS, 9.0 * D**2 / K, 1.0),
    "mmb": (
        (Force(0, 0.0, False, C / L), Force(0, L, False, -(C + L) / L)),
        AT_BOTH_ENDS,
        (12.0 * (3 * C - L) ** 2 + 9.0 * (C + L) ** 2) * (A / L) ** 2 / K,
        9.0 * (C + L) ** 2 / (12.0 * (3 * C - L) ** 2 + 9.0 * (C + L) ** 2),
    ),
    "moments": ((Force(0, 0.0, True, -1.0),), GUIDED, 84.0 / K, 3.0 / 7.0),
}


def arms(test: str) -> BentArms:
    loads, supports, _, _ = TESTS[test]
    return BentArms(2 * L, W, (E * H, E * H), (H, H), loads, supports)


@pytest.mark.parametrize("test", TESTS)
def test_the_energy_release_rate_is_that_of_the_closed_form(test):
    release, sliding = arms(test).release(A)
    assert release * arms(test).compliance(A) ** 2 == pytest.approx(TESTS[test][2], rel=1e-9)
    assert sliding == pytest.approx(TESTS[test][3], abs=1e-9)


@pytest.mark.parametrize("test", TESTS)
def test_it_is_the_slope_of_the_compliance(test):
    """2 w G = P^2 dC/da, of arms that differ as well."""
    body = BentArms(2 * L, W, (E * H, 3.0 * E * H), (H, 2.0 * H), *TESTS[test][:2])
    slope = (body.compliance(A + 1e-3) - body.compliance(A - 1e-3)) / 2e-3
    assert 2.0 * W * body.release(A)[0] * body.compliance(A) ** 2 == pytest.approx(slope, rel=1e-4)


@pytest.mark.parametrize(("test", "factor"), [("enf", 3.0), ("slb", 7.0)])
def test_compliances_of_three_point_bending(test, factor):
    known = (2 * L**3 + factor * A**3) / (8 * W * E * H**3)
    assert arms(test).compliance(A) == pytest.approx(known, rel=1e-9)
