"""Programmes that unload, reload and close: secants of the damage, contact that holds, and nothing healed."""

from dataclasses import replace

import numpy as np
import pytest
from paths import BOTH, CZM1, ledger, loads, run, stops
from scipy.sparse import coo_array, csc_array
from scipy.sparse.linalg import spsolve

from iga.elements.bulk import full_matrices, stiffness_of_batches
from iga.path.point import End
from iga.system.system import respond


def test_a_programme_that_unloads_to_zero_has_not_come_apart():
    """Without load, most of the bond broken; and the little that is left carries again."""
    system, points, end = run(replace(CZM1, opening=(4.3, 0.0, 1e-4, 3.0)))
    broken = points[-1].state.k_q >= system.interface.law.g_u
    assert end == End("complete", end.rejected) and points[-1].opening == 3.0
    at_zero = next(p for p in points[1:] if p.opening == 0.0)
    assert np.mean(broken) > 0.5 and abs(at_zero.state.load) < 1e-9 * max(loads(points))
    assert points[-1].state.load > 0.05 * max(loads(points))


def stiffness(system, closed_q, k_q):
    """Matrix of the reference configuration with frozen damage, put together from its parts."""
    shape, bulk, parts = (system.n_dof, system.n_dof), system.bulk, []
    for solid, d in zip(bulk.solids, bulk.element_dofs, strict=True):
        for e, K in stiffness_of_batches(solid, bulk.kinematics.moduli):
            parts.append(_scattered(full_matrices(K), d[e], shape))
    interface, start = system.interface, system.start()
    touch = respond(system, start, decide=False).contact
    secant_q = np.where(closed_q, interface.law.penalty, interface.law.secant(k_q)) * interface.dA_q
    rows = touch.gap_rows.G_qd
    parts.append(_scattered(secant_q[:, None, None] * rows[:, :, None] * rows[:, None, :], touch.dof_qd, shape))
    for a_d, k in zip(system.springs_rd, system.spring_r, strict=True):
        parts.append(coo_array(k * np.outer(a_d, a_d)))
    return csc_array(sum(part.tocsc() for part in parts))


def _scattered(K_eij, dofs_ei, shape):
    row, column = np.broadcast_arrays(dofs_ei[:, :, None], dofs_ei[:, None, :])
    return coo_array((K_eij.ravel(), (row.ravel(), column.ravel())), shape=shape)


def secant_slope(system, closed_q, k_q):
    """Load over opening with frozen damage, by an independent linear solve."""
    assert np.all(system.free_d)
    u_d = spsolve(stiffness(system, closed_q, k_q), system.load_d)
    return 1.0 / float(system.load_d @ u_d)


#: Openings at which the curves with and without unloading are compared, and one so small that it is none.
STOPS, NEARLY = (1.5, 1.6, 1.8, 2.0, 2.2, 2.5, 3.0), 1e-3


@pytest.fixture(scope="module", params=["linear", "finite"])
def reloaded(request):
    """There, back to nothing, there again and on; a mesh without snap-backs."""
    return run(replace(CZM1, dofs=800, kinematics=request.param, opening=(1.5, NEARLY, 0.0, *STOPS)))


def test_unloading_has_the_secant_stiffness_of_the_damage(reloaded):
    """Every slope to nearly nothing and back in linear kinematics; in finite kinematics next to no load."""
    system, points, end = reloaded
    (top, again), (nearly,), bottom = stops(points, 1.5), stops(points, NEARLY), stops(points, 0.0)[-1]
    assert end.status == "complete" and top < nearly < bottom < again
    law, worst, linear = system.interface.law, 0.0, system.linear
    damage = law.damage(points[top].state.k_q)
    assert np.any(damage == 1.0) and np.any((damage > 0.0) & (damage < 1.0))
    for i in (*range(top + 1, bottom), *range(bottom + 1, again)) if linear else (nearly,):
        point = points[i]
        assert np.array_equal(point.state.k_q, points[top].state.k_q), "damage grows below what has been seen"
        exact = secant_slope(system, point.response.contact.g_q < 0.0, point.state.k_q)
        worst = max(worst, abs(point.slope / exact - 1.0))
        assert point.state.load == pytest.approx(exact * point.opening, rel=1e-6)
    print(f"{'linear' if linear else 'finite'}: slope against independent secant {worst:.1e}")
    assert worst < 1e-6
    assert abs(points[bottom].state.load) < 1e-9 * max(loads(points))


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


@pytest.mark.parametrize(
    ("basis", "kinematics"),  # in finite kinematics the fast tests press faces in tests/verify/studies/hard
    [pytest.param(*one, marks=pytest.mark.slow if "finite" in one else ()) for one in BOTH],
)
def test_closing_is_held_by_contact(basis, kinematics):
    """Pressed together by 0.002 and opened again: penetration is pressure by penalty, a tenth with ten times."""
    deepest = []
    for penalty in (1e7, 1e8):
        problem = replace(CZM1, basis=basis, kinematics=kinematics, penalty=penalty, dofs=400)
        system, points, end = run(replace(problem, opening=(1.0, -0.002, 1.2)), steps=15)
        assert end.status == "complete" and not end.separated and points[-1].opening == 1.2
        pressed = points[stops(points, -0.002)[0]]
        g_q, p_q = pressed.response.contact.g_q, pressed.response.p_q
        assert pressed.state.load < 0.0 and np.min(p_q) < 0.0
        assert np.argmin(system.interface.X_qi[p_q < 0.0, 0]) == np.argmin(p_q[p_q < 0.0]), "not held at the loaded end"
        assert np.all(-g_q[g_q < 0.0] <= -p_q[g_q < 0.0] / penalty * (1.0 + 1e-9))
        force = float(system.interface.dA_q @ p_q)
        assert force == pytest.approx(pressed.state.load, rel=1e-6 if kinematics == "linear" else 1e-2)
        assert ledger(system, points) < 0.01
        deepest.append(-float(np.min(g_q)))
    print(f"{basis}, {kinematics}: penetration {deepest}")
    assert deepest[0] / deepest[1] == pytest.approx(10.0, rel=0.5)
