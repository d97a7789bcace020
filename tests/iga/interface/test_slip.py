"""How far points have slid along the master: an objective scalar, its two variations, its sign and its limit."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from bent_specimens import flexure
from hypothesis import assume, given
from hypothesis import strategies as st

from iga.delamination.solution import build
from iga.interface.interface import Interface, settled
from iga.interface.response import forces, traction
from iga.interface.surface import surface
from iga.laws.laws import ShapedLaw
from iga.laws.mode_ratio import ModeRatio
from iga.specimen.bond import between
from tests.iga.bases.test_splines import quarter_annulus
from tests.iga.interface.test_gpts import LAW, LOWER, PAIRS, UPPER, Rig, bent, nurbs, rig

SLIDING = ShapedLaw(ModeRatio((0.4, 0.9), (4.0, 6.0), (LAW.stiffness[0], 9.0 * LAW.stiffness[0])), 5e3, friction=0.4)

FACES = ["upper", "lower"]
slaves = pytest.mark.parametrize("slave", FACES)
pairs = pytest.mark.parametrize("name", PAIRS)


@cache
def sliding(name: str, slave: str) -> Rig:
    return rig(*PAIRS[name], slave, law=SLIDING)


def turned(x_Ai: np.ndarray, degrees: float) -> np.ndarray:
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    return x_Ai @ np.array([[c, s], [-s, c]])


@slaves
@pairs
def test_where_nothing_has_moved_no_point_has_slid(name, slave):
    """But by the rounding of a place that is searched for again, where the meshes do not match."""
    interface = sliding(name, slave).interface
    none_d, stays = np.zeros(interface.P_AI.size), settled(interface)
    assert not interface.rest.slip.s_q.any() and not stays.contact(none_d).slip.s_q.any()
    assert np.abs(interface.contact(none_d, interface.pairing).slip.s_q).max() < 1e-14


@slaves
@pairs
@given(angle=st.floats(-180.0, 180.0), slide=st.floats(-2.0, 2.0), gap=st.floats(-0.1, 0.2), away=st.floats(-9.0, 9.0))
def test_a_motion_of_the_whole_does_not_slide(name, slave, angle, slide, gap, away):
    """From rest there is no slip, and from a bent state with slip there is the same; nor do the tractions turn it."""
    one = sliding(name, slave)
    interface, P_AI = one.interface, one.interface.P_AI
    still = interface.contact((turned(P_AI, angle) + away - P_AI).ravel(), interface.pairing)
    assert np.abs(still.slip.s_q).max() < 1e-12 and np.abs(still.g_q).max() < 1e-12
    x_Ai = P_AI + bent(one, gap, slide, 0.2, 0.0, np.random.default_rng(3), 0.1).reshape(-1, 2)
    here, there = (interface.contact((x - P_AI).ravel(), None) for x in (x_Ai, turned(x_Ai, angle) + away))
    assert np.abs(here.slip.s_q - there.slip.s_q).max() < 1e-11


def beside(interface: Interface, u_d: np.ndarray, v_d: np.ndarray, h: float):
    """Contacts at a state and on both sides of it, and the points (n_q,) that do not change what they meet."""
    start = interface.contact(u_d, interface.pairing).pairing
    here, ahead, behind = (interface.contact(u_d + part * h * v_d, start) for part in (0.0, 1.0, -1.0))

    def met(touch):
        xi_q = touch.pairing.xi_q
        return np.stack([touch.pairing.c_q, touch.on_q, xi_q == 0.0, xi_q == 1.0])

    same_q = np.all([(met(touch) == met(here)).all(0) for touch in (ahead, behind)], axis=0)
    return here, ahead, behind, same_q


def variation_errors(interface: Interface, u_d: np.ndarray, rng, h: float = 1e-6) -> tuple[float, float]:
    """Errors of the rows of gap and slip against differences of them, and of the curvature against differences of the
    rows, each in parts of the largest difference."""
    v_d, n_dof = rng.standard_normal(u_d.size), u_d.size
    here, ahead, behind, same_q = beside(interface, u_d, v_d, h)
    assume(same_q.sum() > 0.5 * len(same_q))
    rate_qc = (ahead.jump_qc - behind.jump_qc)[same_q] / (2.0 * h)
    found_qc = np.stack([here.gap_rows.rates(v_d), here.slip.rows.rates(v_d)], axis=1)[same_q]
    first = np.abs(found_qc - rate_qc).max() / np.abs(rate_qc).max()
    p_q, t_q = np.where(same_q & here.on_q, rng.standard_normal((2, len(same_q))), 0.0)
    share_q = np.where(here.on_q, here.share_q, 1.0)  # forces fade with it
    changes = [
        touch.gap_rows.forces(p_q * touch.share_q / share_q, n_dof)
        + touch.slip.rows.forces(t_q * touch.share_q / share_q, n_dof)
        for touch in (ahead, behind)
    ]
    expected_d, product_d = (changes[0] - changes[1]) / (2.0 * h), np.zeros(n_dof)
    K_qdd, dof_qd = here.curvature(np.stack([p_q, t_q], axis=1)), here.slip.rows.dof_qd
    np.add.at(product_d, dof_qd, (K_qdd @ v_d[dof_qd][..., None])[..., 0])
    return float(first), float(np.abs(product_d - expected_d).max() / np.abs(expected_d).max())


@slaves
@pairs
@given(
    gap=st.floats(-0.1, 0.2),
    slide=st.floats(-3.0, 3.0),
    bend=st.floats(-0.3, 0.3),
    angle=st.sampled_from([0.0, 70.0, -110.0]) | st.floats(-180.0, 180.0),
    wedge=st.floats(-0.05, 0.3),
    held=st.booleans(),
    seed=st.integers(0, 2**31),
)
def test_both_variations_in_any_state(name, slave, gap, slide, bend, angle, wedge, held, seed):
    """Open and closed, slid by several elements and over the ends, bent and turned, one face at an angle to the other,
    every point bonded or some; degrees 1 to 4, meshes that do not match."""
    rng, one = np.random.default_rng(seed), sliding(name, slave)
    interface = replace(one.interface, bonded_q=held | (np.arange(one.interface.points) % 3 > 0))
    first, second = variation_errors(interface, bent(one, gap, slide, bend, angle, rng, wedge), rng)
    assert first < 1e-6 and second < 1e-6


@slaves
@pairs
def test_the_share_of_points_that_slide_off_fades_at_its_rate(name, slave):
    rng, one, fading = np.random.default_rng(5), sliding(name, slave), 0
    for slide in np.linspace(-3.0, 3.0, 41):
        u_d = bent(one, 0.05, slide, 0.1, 0.0, rng, 0.1)
        v_d = rng.standard_normal(u_d.size)
        here, ahead, behind, same_q = beside(one.interface, u_d, v_d, 1e-6)
        q, rate_q = np.flatnonzero(same_q), (ahead.share_q - behind.share_q) / 2e-6
        fading += np.count_nonzero(rate_q[q])
        assert here.share_rates(v_d, q) == pytest.approx(rate_q[q], abs=1e-5 * max(np.abs(rate_q).max(), 1.0))
    assert fading > 0


@slaves
@given(angle=st.floats(-180.0, 180.0), gap=st.floats(-0.02, 0.05), slide=st.floats(-0.5, 0.5), seed=st.integers(0, 99))
def test_both_variations_on_exact_circles(slave, angle, gap, slide, seed):
    """Rational sides: the way along a circle of radius 2 by an angle, whichever ring the points are on."""
    rng, one = (
        np.random.default_rng(seed),
        rig(quarter_annulus(2.0, 3.0, 5), quarter_annulus(1.0, 2.0, 3), slave, law=SLIDING),
    )
    P_AI, upper_A = one.interface.P_AI, one.upper_A
    x_AI = np.where(upper_A[:, None], (1.0 + 0.5 * gap) * turned(P_AI, np.degrees(slide)), P_AI)
    inside_q = one.interface.contact((x_AI - P_AI).ravel(), None).pairing.on_q
    s_q = one.interface.contact((x_AI - P_AI).ravel(), None).slip.s_q
    radius = 2.0 if slave == "upper" else 2.0 + gap
    assert np.allclose(np.abs(s_q[inside_q]), radius * abs(slide), rtol=1e-9, atol=1e-12)
    u_d = (turned(x_AI, angle) + 1e-4 * rng.standard_normal(x_AI.shape) - P_AI).ravel()
    first, second = variation_errors(one.interface, u_d, rng)
    assert first < 1e-6 and second < 1e-6


POSES = [{}, {"angle": 37.0}, {"mirror": True}, {"angle": 37.0, "mirror": True, "shift": (1e4, -3e3)}]


@slaves
@pytest.mark.parametrize("pose", POSES, ids=["as it is", "turned", "mirrored", "all"])
@pytest.mark.parametrize("kinematics", ["linear", "finite"])
@pytest.mark.parametrize("basis", ["nurbs", "lagrange", "tspline"])
def test_a_slip_is_positive_where_the_upper_body_moves_away_from_the_origin(basis, kinematics, pose, slave):
    problem = flexure(basis=basis, kinematics=kinematics, slave=slave, dofs=700, mismatch=1.37, **pose)
    specimen = build(problem)
    interface, u_Ai = specimen.system.interface, np.zeros_like(specimen.system.interface.P_AI)
    for along, across in ((0.3, 0.02), (-7.0, -0.02)):
        u_Ai[specimen.bodies[0].points] = np.array([along, across]) @ specimen.pose.axes_kI
        touch = interface.contact(u_Ai.ravel(), interface.pairing)
        assert np.abs(touch.slip.s_q - along).max() < 1e-9 and np.abs(touch.g_q - across).max() < 1e-9


@slaves
@pairs
def test_the_limit_of_small_displacements_is_the_slip_of_linear_kinematics(name, slave, rng):
    """What differs falls with the square of the displacements; so do the slopes along the slave."""
    interface = sliding(name, slave).interface
    v_d, left = rng.standard_normal(interface.P_AI.size), []
    for size in (1e-3, 5e-4, 2.5e-4):
        found = []
        for one in (interface, settled(interface)):
            touch = one.contact(size * v_d, one.pairing)
            found.append(np.stack([touch.g_q, touch.slip.s_q, *one.slopes(size * v_d, touch)]))
        left.append(np.abs(found[0] - found[1]).max(1))
    order = np.log2(np.array(left[:-1]) / left[1:])
    assert np.all(np.abs(order - 2.0) < 0.2), order


def test_the_jump_does_not_depend_on_which_face_is_the_master(rng):
    """On matching meshes what differs falls with the third power of the displacements; in the frame of the master,
    where points only touch, with the second one."""
    both = [rig(*(nurbs(9, 3, side) for side in (UPPER, LOWER)), slave, law=SLIDING).interface for slave in FACES]
    v_d, orders = rng.standard_normal(both[0].P_AI.size), []
    for bonded in (True, False):
        left, sizes = [], (2e-3, 1e-3, 5e-4)
        for size in sizes:
            jumps = [
                replace(one, bonded_q=np.full(one.points, bonded)).contact(size * v_d, one.pairing).jump_qc
                for one in both
            ]
            left.append(np.abs(jumps[0] - jumps[1] * (1.0, -1.0))[4:-4].max())
        orders.append(np.log2(np.array(left[:-1]) / left[1:]))
    assert np.all(np.abs(orders[0] - 3.0) < 0.2) and np.all(np.abs(orders[1] - 2.0) < 0.2), orders


@slaves
@pytest.mark.parametrize("stays", [False, True])
@pairs
def test_slopes_are_those_of_gap_and_slip_along_the_slave(name, stays, slave, rng):
    """Points beside each other on the sides of the slave, by their distance in the reference configuration."""
    one, faces = sliding(name, slave), ("bottom", "top")
    both = [
        surface(mesh, mesh.chains[face], first)
        for mesh, face, first in zip(PAIRS[name], faces, (0, one.upper_A.sum()), strict=True)
    ]
    ours, theirs = both if slave == "upper" else both[::-1]
    u_d, c, found = bent(one, 0.05, 0.2, 0.1, 20.0, rng, 0.1), np.arange(1, ours.sides - 1), []
    for xi in (0.37, 0.37 - 1e-5, 0.37 + 1e-5):
        interface = between(ours, theirs, one.interface.P_AI, SLIDING, (c, np.full(c.size, xi), np.ones(c.size)))
        interface = settled(interface) if stays else interface
        found.append((interface, interface.contact(u_d, interface.pairing)))
    (middle, here), (first, before), (last, after) = found
    dX_q, same_q = (last.X_qi - first.X_qi)[:, 0], before.pairing.c_q == after.pairing.c_q
    assert same_q.sum() > 0.7 * c.size
    for rate_q, jump_q in zip(middle.slopes(u_d, here), (after.jump_qc - before.jump_qc).T, strict=True):
        expected_q = (jump_q / dX_q)[same_q]
        assert np.allclose(rate_q[same_q], expected_q, rtol=0, atol=1e-6 * np.abs(expected_q).max())


@slaves
@pairs
@given(gap=st.floats(-0.1, 0.1), slide=st.floats(-2.0, 2.0), angle=st.floats(-180.0, 180.0), seed=st.integers(0, 2**31))
def test_forces_and_moments_of_any_tractions_are_in_balance(name, slave, gap, slide, angle, seed):
    """Pull and friction along the surface, on points that face the master, have slid off it or fade."""
    rng, one = np.random.default_rng(seed), sliding(name, slave)
    interface, u_d = one.interface, bent(one, gap, slide, 0.2, angle, rng, 0.1)
    touch = interface.contact(u_d, interface.pairing)
    pull = traction(interface, touch, interface.start(), touch.g_q < 0.0)
    some_q = touch.share_q * rng.standard_normal(interface.points)
    some = replace(pull, f_qc=np.stack([pull.p_q, some_q], axis=1))
    x_Ai = interface.P_AI + u_d.reshape(-1, 2)
    for one_pull in (pull, some):
        R_Ai = forces(interface, touch, one_pull, u_d.size).reshape(-1, 2)
        scale = np.abs(R_Ai).sum()
        assert np.all(np.abs(R_Ai.sum(0)) <= 1e-12 * scale)
        assert abs(np.sum(x_Ai[:, 0] * R_Ai[:, 1] - x_Ai[:, 1] * R_Ai[:, 0])) <= 1e-11 * scale
