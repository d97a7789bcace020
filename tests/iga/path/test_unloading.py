"""Programmes that unload and reload: nothing is healed; secants and contact are those of recorded runs."""

from dataclasses import replace

import numpy as np
import pytest
from paths import CZM1, loads, run, stops

from iga.path.point import End


def test_a_programme_that_unloads_to_zero_has_not_come_apart():
    """Without load, most of the bond broken; and the little that is left carries again."""
    system, points, end = run(replace(CZM1, opening=(4.3, 0.0, 1e-4, 3.0)))
    broken = points[-1].state.k_q >= system.interface.law.g_u
    assert end == End("complete", end.rejected) and points[-1].opening == 3.0
    at_zero = next(p for p in points[1:] if p.opening == 0.0)
    assert np.mean(broken) > 0.5 and abs(at_zero.state.load) < 1e-9 * max(loads(points))
    assert points[-1].state.load > 0.05 * max(loads(points))


#: Openings at which the curves with and without unloading are compared, and one so small that it is none.
STOPS, NEARLY = (1.5, 1.6, 1.8, 2.0, 2.2, 2.5, 3.0), 1e-3


@pytest.fixture(scope="module", params=["linear", pytest.param("finite", marks=pytest.mark.slow)])
def reloaded(request):
    """There, back to nothing, there again and on; a mesh without snap-backs."""
    return run(replace(CZM1, dofs=800, kinematics=request.param, opening=(1.5, NEARLY, 0.0, *STOPS)))


def test_reloading_meets_the_curve_again(reloaded):
    """Beyond 1.5 the same loads as without having been back."""
    system, points, _ = reloaded
    _, straight, _ = run(replace(CZM1, dofs=800, kinematics="linear" if system.linear else "finite", opening=STOPS))
    worst = 0.0
    for opening in STOPS:
        again, alone = points[stops(points, opening)[-1]], straight[stops(straight, opening)[-1]]
        worst = max(worst, abs(again.state.load / alone.state.load - 1.0))
        assert again.energies.dissipated == pytest.approx(alone.energies.dissipated, rel=2e-3)
    print(f"{'linear' if system.linear else 'finite'}: loads after reloading within {worst:.1e}")
    assert worst < 2e-3
