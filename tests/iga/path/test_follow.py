"""The path as a whole: snap-backs, separation, the programme, and what rounding does to it."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from paths import CZM1, column, decided, ledger, loads, run

import iga.path.follow
from iga.path.solver import DEFAULT

#: Fast ones have every basis, strength and kinematics.
SNAPPING = [
    ("nurbs", 6.0, "finite"),
    ("lagrange", 20.0, "linear"),
    ("tspline", 6.0, "linear"),
    pytest.param("nurbs", 20.0, "finite", marks=pytest.mark.slow),
    pytest.param("lagrange", 20.0, "finite", marks=pytest.mark.slow),
]


@pytest.mark.parametrize(("basis", "strength", "kinematics"), SNAPPING)
def test_snap_backs_are_followed(basis, strength, kinematics):
    """Zones of one element down to a tenth: the whole way, in balance, and never back in damage."""
    system, points, end = run(replace(CZM1, basis=basis, strength=strength, kinematics=kinematics))
    law = system.interface.law
    assert end.status == "complete" and not end.separated and points[-1].opening == 3.0
    assert np.any(column(points, "heading") < 0.0) and np.any(np.diff(column(points, "opening")) < 0.0)
    gap = ledger(system, points)
    residuals = [decided(system, a, b) for a, b in zip(points[:-1], points[1:], strict=True)]
    print(f"{len(points)} points, {end.rejected} taken back, ledger {gap:.1e}, residual {max(residuals):.1e}")
    assert gap < 0.01
    assert max(residuals) <= DEFAULT.settle and max(p.residuals[-1] for p in points[1:]) < 1e-9
    k_pq = np.array([p.state.k_q for p in points])
    assert np.all(np.diff(k_pq, axis=0) >= 0.0) and np.any(k_pq[-1] > law.g_u)
    assert np.all(k_pq >= np.array([p.response.contact.g_q for p in points]))
    spent = np.array([p.energies.dissipated for p in points])
    assert np.all(np.diff(spent) >= -1e-12 * spent[-1])


@pytest.mark.parametrize(("basis", "kinematics", "strength"), [("nurbs", "finite", 6.0), ("lagrange", "linear", 4.0)])
def test_a_specimen_that_comes_apart_ends_the_path(basis, kinematics, strength):
    """The crack runs through the far end: back in opening, to no load, and that is told."""
    system, points, end = run(replace(CZM1, basis=basis, strength=strength, kinematics=kinematics, opening=(8.0,)))
    law, last = system.interface.law, points[-1]
    assert end.status == "complete" and end.separated
    assert last.opening < max(column(points, "opening")) < 8.0
    assert abs(last.state.load) < 1e-3 * max(loads(points))
    # it may end a hair before the last point that carries is open altogether
    whole = int(np.sum(last.state.k_q < 0.99 * law.g_u))
    spent = last.energies.dissipated / (law.pure_modes[0][1] * float(system.interface.dA_q.sum()))
    print(f"{whole} of {last.state.k_q.size} points not broken, {spent:.3f} of the bond's toughness dissipated")
    assert whole <= 1 and ledger(system, points) < 0.01


@pytest.mark.parametrize(
    ("broken", "load", "d_load", "slope", "separated"),
    [
        (0.6, 0.0, -1.0, -5.0, True),
        (0.6, 0.9e-3, -1.0, -5.0, True),
        (0.6, -0.9e-3, -1.0, -5.0, True),
        (0.6, 1.1e-3, -1.0, -5.0, False),
        (0.5, 0.0, -1.0, -5.0, False),
        (0.6, 0.0, 0.5, 5.0, False),
        (0.6, 0.0, 0.5, 0.9e-3 / 3.0, True),
        (0.6, 0.0, 0.5, -0.9e-3 / 3.0, True),
        (0.6, 0.0, 0.5, 1.1e-3 / 3.0, False),
    ],
)
@pytest.mark.parametrize("bonded", [False, True])
def test_what_has_come_apart_carries_nothing_and_will_not(broken, load, d_load, slope, separated, bonded):
    """More than half of the bond broken, no load, and none that the path brings over its reach of 3; the peak is 1."""
    k_q = np.where(np.arange(10) < 10 * broken, 2.0, 1.9)
    bonded_q, area_q = np.ones(10, dtype=bool), np.ones(10)
    if bonded:  # as many points that only touch count for nothing
        k_q, area_q, bonded_q = np.append(k_q, np.zeros(10)), np.ones(20), np.arange(20) < 10
    interface = SimpleNamespace(dA_q=area_q, bonded_q=bonded_q, law=SimpleNamespace(failed=2.0))
    for way in (1.0, -1.0):  # by pulling, or by pressing
        state, tangent = SimpleNamespace(k_q=k_q, load=way * load), SimpleNamespace(d_load=way * d_load)
        point = SimpleNamespace(state=state, tangent=tangent, slope=slope)
        assert iga.path.follow._separated(SimpleNamespace(interface=interface), point, 3.0, 1.0, way) == separated


@pytest.mark.parametrize(
    ("programme", "way"),
    [
        ((3.0,), (3.0,)),
        ((1.5, -0.1, 3.0), (1.5, 0.0, -0.1, 0.0, 3.0)),
        ((1.5, 0.0, -0.1), (1.5, 0.0, -0.1)),
        ((-1.0, -2.0), (-1.0, -2.0)),
    ],
)
def test_a_programme_stops_wherever_it_passes_through_zero(programme, way):
    assert iga.path.follow.by_way_of_zero(programme) == way
