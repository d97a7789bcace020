"""Projection on curved surfaces, and the complete tangent of the interface in every state it can be in."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from iga.bases.lagrange import lagrange_rectangle
from iga.dcb import Problem, build
from iga.interface.closest_point import PROJECTION, closest_points, nearest_samples
from iga.interface.interface import SettledInterface
from iga.interface.response import Tractions, forces, traction
from iga.interface.surface import surface
from iga.laws.law import History
from tests.iga.bases.test_splines import quarter_annulus


def project(surface, x, y):
    return closest_points(surface, x, y, nearest_samples(surface, x, y))


def position(surface, pairing, y):
    (r,) = surface.coefficients(pairing.c_q, pairing.xi_q, 0)
    return np.einsum("qb,qbi->qi", r, surface.bezier_points(y)[pairing.c_q])


ARCS = [quarter_annulus(1.0, 2.0, refine) for refine in (0, 4)]


@given(st.sampled_from(ARCS), st.floats(0.02, np.pi / 2 - 0.02), st.floats(0.8, 6.0))
def test_closest_points_on_a_circle_lie_on_the_ray_from_its_centre(mesh, angle, radius):
    """From inside and outside of the exact circle; the gap along the normal is the difference of the radii."""
    arc = surface(mesh, mesh.chains["top"], 0)
    ray = np.array([[np.cos(angle), np.sin(angle)]])
    pairing = project(arc, radius * ray, mesh.P_AI)
    assert np.all(pairing.on_q)
    assert np.max(np.abs(position(arc, pairing, mesh.P_AI) - 2.0 * ray)) < 1e-11


def test_points_beyond_the_ends_are_marked_and_held_at_the_end():
    mesh = lagrange_rectangle(np.linspace(0, 3, 4), np.array([0.0, 1.0]), 3)
    bottom = surface(mesh, mesh.chains["bottom"], 0)
    x = np.array([[-0.5, -0.1], [0.2, 0.3], [2.9, -0.2], [3.4, 0.1]])
    pairing = project(bottom, x, mesh.P_AI)
    assert pairing.on_q.tolist() == [False, True, True, False]
    assert np.allclose(
        position(bottom, pairing, mesh.P_AI), np.stack([np.clip(x[:, 0], 0, 3), 0 * x[:, 0]], -1), atol=1e-12
    )


@pytest.mark.parametrize("degree", [1, 2, 3])
def test_closest_points_on_a_wavy_surface_with_kinks_beat_every_sample(degree, rng):
    mesh = lagrange_rectangle(np.linspace(0, 6, 7), np.array([0.0, 1.0]), degree)
    y = mesh.P_AI + np.stack([0 * mesh.P_AI[:, 0], 0.3 * np.sin(2.0 * mesh.P_AI[:, 0])], -1)
    top = surface(mesh, mesh.chains["top"], 0)
    x = np.stack([rng.uniform(0.1, 5.9, 60), 1.4 + rng.uniform(-0.2, 0.6, 60)], -1)
    found = np.linalg.norm(x - position(top, project(top, x, y), y), axis=1)
    c, xi = np.repeat(np.arange(6), 401), np.tile(np.linspace(0, 1, 401), 6)
    (r,) = top.coefficients(c, xi, 0)
    samples = np.einsum("qb,qbi->qi", r, top.bezier_points(y)[c])
    best = np.min(np.linalg.norm(x[:, None] - samples[None], axis=2), axis=1)
    assert np.all(found < best + 1e-3)


PROBLEM = Problem(
    length=6.0,
    arm_thickness=0.5,
    precrack=2.0,
    E1=1000.0,
    E2=900.0,
    G12=300.0,
    nu12=0.2,
    strength=4.0,
    toughness=0.4,
    ductility=4.0,
    penalty=5e3,
    opening=(1.0,),
    dofs=800,
)


def deformed(system, opening: float, shift: float, rng) -> np.ndarray:
    """Both arms bent along one curve, the upper one slid along it by ``shift`` and lifted off by ``opening``."""
    X, Y = system.interface.P_AI.T
    upper = np.arange(len(X)) < len(X) // 2
    s, t = X + np.where(upper, shift, 0.0), Y + np.where(upper, opening, 0.0)
    slope = 0.225 * np.cos(0.9 * s)
    n = np.stack([-slope, np.ones_like(slope)], -1) / np.sqrt(1 + slope**2)[:, None]
    x = np.stack([s, 0.25 * np.sin(0.9 * s)], -1) + t[:, None] * n
    return (x - system.interface.P_AI + 1e-5 * rng.standard_normal(x.shape)).ravel()


def test_the_gap_does_not_change_when_everything_turns(rng):
    system = build(PROBLEM).system
    interface = system.interface
    u = deformed(system, 0.05, 0.1, rng).reshape(-1, 2)
    Q = np.array([[0.8, -0.6], [0.6, 0.8]])
    turned = (interface.P_AI + u) @ Q.T - interface.P_AI
    start = system.start().pairing
    before, after = interface.contact(u.ravel(), start), interface.contact(turned.ravel(), start)
    assert np.max(np.abs(before.g_q - after.g_q)) < 1e-12
    assert np.allclose(before.n_qi @ Q.T, after.n_qi, atol=1e-10)


def test_gaps_are_the_distances_between_positions_however_far_the_projection_has_slid(rng):
    """Within a side and from side to side, whatever the gap is put together from; of bodies that begin apart, too."""
    system = build(PROBLEM).system
    touching, above = system.interface, np.arange(len(system.interface.P_AI)) < len(system.interface.P_AI) // 2
    for shift, elsewhere, lifted in ((0.005, 0.0, 0.0), (0.11, 1.0, 0.0), (0.9, 1.0, 0.0), (0.005, 0.0, 0.02)):
        interface = replace(touching, P_AI=touching.P_AI + np.outer(above, [0.0, lifted]), near=None)
        start = interface.pairing
        u = deformed(system, 0.05, shift, rng)
        x, touch = interface.P_AI + u.reshape(-1, 2), interface.contact(u, start)
        assert np.mean(touch.pairing.c_q != start.c_q) == pytest.approx(elsewhere, abs=0.2)
        apart = interface.at_slave(x) - position(interface.master, touch.pairing, x)
        assert np.max(np.abs(touch.g_q - np.sum(apart * touch.n_qi, 1))) < 1e-13


def test_interface_forces_are_in_balance_when_meshes_do_not_match(rng):
    """The traction acts along the line from a point to its projection: forces and moments cancel on any two meshes."""
    system = build(PROBLEM).system
    interface = system.interface
    u = deformed(system, 0.04, 0.3, rng)
    touch = interface.contact(u, system.start().pairing)
    p_q, none_q = touch.on_q * rng.standard_normal(interface.points), np.zeros(interface.points)
    pull = Tractions(p_q[:, None], np.zeros((p_q.size, 1, 1)), History(none_q), interface.law, touch.jump_qc)
    R = forces(interface, touch, pull, system.n_dof).reshape(-1, 2)
    x = interface.P_AI + u.reshape(-1, 2)
    scale = np.abs(R).sum()
    assert np.all(np.abs(R.sum(0)) < 1e-12 * scale)
    assert abs(np.sum(x[:, 0] * R[:, 1] - x[:, 1] * R[:, 0])) < 1e-11 * scale


def test_a_point_off_the_master_is_free():
    system = build(PROBLEM).system
    interface = system.interface
    u = np.zeros((system.n_dof // 2, 2))
    u[: len(u) // 2] = [1.0, 0.1]
    touch = interface.contact(u.ravel(), system.start().pairing)
    X = interface.master.bezier_points(interface.P_AI)[-1, :, 0]
    beyond = interface.X_qi[:, 0] + 1.0 - PROBLEM.length
    gone = beyond > PROJECTION.free * (X[-1] - X[0])
    assert np.array_equal(~touch.on_q, gone) and gone.any()
    assert np.array_equal(~touch.pairing.on_q, beyond > 0.0)
    pull = traction(interface, touch, interface.start(), touch.g_q < 0)
    assert not any(one_q[gone].any() for one_q in (pull.p_q, pull.dp_q, pull.history.d))


def test_partners_that_stay_are_searched_for_once(monkeypatch):
    """Where gaps change in proportion all is known of the points, and what reads them asks for no search."""
    probe = build(replace(PROBLEM, kinematics="linear")).probe
    monkeypatch.setattr("iga.interface.interface.nearest_samples", lambda *given: pytest.fail("searched for again"))
    assert isinstance(probe, SettledInterface) and np.all(probe.pairing.on_q)
    probe.contact(np.zeros(probe.P_AI.size), probe.pairing)
