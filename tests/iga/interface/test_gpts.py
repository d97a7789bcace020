"""Two surfaces of any meshes: the complete tangent in any deformed state, and forces that do not jump at an end."""

from dataclasses import dataclass

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from iga.bases.bspline import open_knots
from iga.bases.lagrange import lagrange_rectangle
from iga.bases.nurbs import nurbs_rectangle
from iga.interface.closest_point import PROJECTION
from iga.interface.interface import Interface
from iga.interface.response import forces, stiffness, traction
from iga.interface.surface import surface
from iga.laws.law import History, Law
from iga.laws.laws import ShapedLaw
from iga.mesh.extraction import Mesh
from iga.mesh.quadrature import gauss
from iga.specimen.bond import between, everywhere
from iga.specimen.tmesh_strip import Strip, strip_tmesh
from iga.tsplines.tspline import tspline_rectangle
from tests.iga.bases.test_splines import quarter_annulus

LAW = ShapedLaw.opening(strength=4.0, toughness=0.4, ductility=4.0, penalty=5e3)

#: gap in units of g_max, history in the same units
STATES = {
    "elastic": (0.6, 0.0),
    "softening": (2.0, 1.0),
    "unloading": (1.5, 2.5),
    "open": (6.0, 1.0),
    "closed": (-0.4, 0.0),
    "closed after damage": (-0.4, 2.5),
}


def nurbs(elements: int, degree: int, through: tuple[float, float], length: float = 6.0) -> Mesh:
    breaks = np.linspace(0.0, length, elements + 1)
    return nurbs_rectangle(open_knots(breaks, degree), open_knots(np.array(through), 2))


def lagrange(elements: int, degree: int, through: tuple[float, float]) -> Mesh:
    return lagrange_rectangle(np.linspace(0.0, 6.0, elements + 1), np.array(through), degree)


def tspline(elements: int, through: tuple[float, float]) -> Mesh:
    halved = np.arange(elements) % 3 == 1
    strip = Strip(np.linspace(0.0, 6.0, elements + 1), halved)
    return tspline_rectangle(strip_tmesh(strip, through, top=through[1] == 0.0))


UPPER, LOWER = (0.0, 0.5), (-0.5, 0.0)
#: Upper and lower body, meeting on Y = 0.
PAIRS = {
    "tspline on lagrange 2": (tspline(9, UPPER), lagrange(7, 2, LOWER)),
    "nurbs 2 on nurbs 3": (nurbs(10, 2, UPPER), nurbs(7, 3, LOWER)),
    "lagrange 3 on tspline": (lagrange(5, 3, UPPER), tspline(8, LOWER)),
    "lagrange 1 on nurbs 4": (lagrange(9, 1, UPPER), nurbs(5, 4, LOWER)),
}


@dataclass(frozen=True)
class Rig:
    """An interface between two bodies, and which control points belong to the upper one."""

    interface: Interface
    upper_A: np.ndarray


def rig(upper: Mesh, lower: Mesh, slave: str, faces=("bottom", "top"), points: int = 2, law: Law = LAW) -> Rig:
    P_AI = np.concatenate([upper.P_AI, lower.P_AI])
    surfaces = [
        surface(mesh, mesh.chains[face], first)
        for mesh, face, first in zip((upper, lower), faces, (0, len(upper.P_AI)), strict=True)
    ]
    ours, theirs = surfaces if slave == "upper" else surfaces[::-1]
    places = everywhere(np.arange(ours.sides), gauss(points))
    return Rig(between(ours, theirs, P_AI, law, places), np.arange(len(P_AI)) < len(upper.P_AI))


def bent(rig: Rig, gap: float, slide: float, bend: float, angle: float, rng, wedge: float = 0.0) -> np.ndarray:
    """Both bodies bent along one wave, the upper one slid along it and lifted off, by ``wedge`` at an angle, the whole
    turned; some noise."""
    X, Y = rig.interface.P_AI.T
    s, t = X + np.where(rig.upper_A, slide, 0.0), Y + np.where(rig.upper_A, gap + wedge * X, 0.0)
    slope = 0.9 * bend * np.cos(0.9 * s)
    n = np.stack([-slope, np.ones_like(slope)], -1) / np.sqrt(1 + slope**2)[:, None]
    x = np.stack([s, bend * np.sin(0.9 * s)], -1) + t[:, None] * n
    c, d = np.cos(np.radians(angle)), np.sin(np.radians(angle))
    return (x @ np.array([[c, d], [-d, c]]) + 1e-4 * rng.standard_normal(x.shape) - rig.interface.P_AI).ravel()


def residual_at(interface: Interface, u_d: np.ndarray, start, k_q, closed_q) -> np.ndarray:
    touch = interface.contact(u_d, start)
    return forces(interface, touch, traction(interface, touch, History(k_q), closed_q), u_d.size)


def tangent_error(
    interface: Interface, u_d: np.ndarray, k_q: np.ndarray, rng, require=assume, h: float = 1e-6
) -> float:
    """Largest difference of tangent and central difference in a random direction, over the largest entry of it.

    Only where no point changes its side or its branch of the law within the difference.
    """
    start = interface.contact(u_d, interface.pairing).pairing
    touch, v = interface.contact(u_d, start), rng.standard_normal(u_d.size)
    closed_q = touch.g_q < 0.0
    for sign in (-1.0, 1.0):
        near = interface.contact(u_d + sign * h * v, start)
        require(np.array_equal(near.pairing.c_q, touch.pairing.c_q))
        require(np.array_equal(near.pairing.on_q, touch.pairing.on_q))
        kinks = np.array([0.0, LAW.g_max, LAW.g_u]), k_q
        require(all(np.array_equal(near.g_q > kink, touch.g_q > kink) for kink in (*kinks[0], kinks[1])))
    pull = traction(interface, touch, History(k_q), closed_q)
    K_qdd, d_qd = stiffness(interface, touch, pull), touch.dof_qd
    product = np.zeros(u_d.size)
    np.add.at(product, d_qd, (K_qdd @ v[d_qd][..., None])[..., 0])
    plus, minus = (residual_at(interface, u_d + sign * h * v, start, k_q, closed_q) for sign in (1.0, -1.0))
    difference = (plus - minus) / (2.0 * h)
    return float(np.abs(product - difference).max() / max(np.abs(difference).max(), 1e-6 * LAW.stiffness[0]))


@pytest.mark.parametrize("slave", ["upper", "lower"])
@pytest.mark.parametrize("name", PAIRS)
@given(
    state=st.sampled_from(sorted(STATES)),
    slide=st.floats(-1.0, 1.0),
    bend=st.floats(-0.3, 0.3),
    angle=st.sampled_from([0.0, 70.0, -110.0, 180.0]) | st.floats(-180.0, 180.0),
    seed=st.integers(0, 2**31),
)
def test_tangent_in_any_state(name, slave, state, slide, bend, angle, seed):
    """Curved, turned and slid by up to an element and more, so that some points are past the ends of the master."""
    rng, (gap, history) = np.random.default_rng(seed), STATES[state]
    one = rig(*PAIRS[name], slave)
    u_d = bent(one, gap * LAW.g_max, slide, bend, angle, rng)
    k_q = np.full(one.interface.points, history * LAW.g_max)
    assert tangent_error(one.interface, u_d, k_q, rng) < 1e-6


@pytest.mark.parametrize("slave", ["upper", "lower"])
@given(
    over=st.floats(0.0, PROJECTION.free + 0.05),
    angle=st.sampled_from([0.0, 70.0]),
    pull=st.booleans(),
    seed=st.integers(0, 2**31),
)
def test_tangent_past_the_end(slave, over, angle, pull, seed):
    """One point after the other slides off the end of a bent master; in the fading part the matrix is not symmetric."""
    rng = np.random.default_rng(seed)
    one = rig(nurbs(9, 3, UPPER), nurbs(6, 3, LOWER), slave)
    end = one.interface.master.bezier_points(one.interface.P_AI)[-1][:, 0]
    beyond = over * (end[-1] - end[0]) + 6.0 - one.interface.X_qi[-1, 0]
    u_d = bent(one, (0.6 if pull else -0.4) * LAW.g_max, beyond if slave == "upper" else -beyond, 0.2, angle, rng)
    assert tangent_error(one.interface, u_d, np.zeros(one.interface.points), rng) < 1e-6


@pytest.mark.parametrize("slave", ["upper", "lower"])
@given(angle=st.floats(-180.0, 180.0), gap=st.floats(-0.3, 0.9), slide=st.floats(-0.5, 0.5), seed=st.integers(0, 2**31))
def test_tangent_on_exact_circles(slave, angle, gap, slide, seed):
    """Rational sides, a ring in a ring."""
    rng = np.random.default_rng(seed)
    outer, inner = quarter_annulus(2.0, 3.0, 5), quarter_annulus(1.0, 2.0, 3)
    one = rig(outer, inner, slave)
    x = one.interface.P_AI.copy()
    x[one.upper_A] *= 1.0 + 0.5 * gap * LAW.g_max
    turn = np.where(one.upper_A, 0.2 * slide, 0.0) + np.radians(angle)
    x = np.stack([np.cos(turn) * x[:, 0] - np.sin(turn) * x[:, 1], np.sin(turn) * x[:, 0] + np.cos(turn) * x[:, 1]], -1)
    u_d = (x + 1e-4 * rng.standard_normal(x.shape) - one.interface.P_AI).ravel()
    assert tangent_error(one.interface, u_d, np.zeros(one.interface.points), rng) < 1e-6


@pytest.mark.parametrize("slave", ["upper", "lower"])
@pytest.mark.parametrize("gap", [0.8, -0.4])
def test_forces_do_not_jump_where_a_point_slides_off_the_end(gap, slave, rng):
    """Small steps over the end: the largest change of the forces falls with the length of a step."""
    one = rig(nurbs(9, 3, UPPER), nurbs(6, 3, LOWER), slave, points=1)
    interface, changes = one.interface, {}
    seed = rng.integers(2**31)
    for steps in (40, 200):
        pairing, before, change = interface.pairing, None, 0.0
        for slide in np.linspace(0.0, 1.0, steps):
            u_d = bent(
                one, gap * LAW.g_max, slide if slave == "upper" else -slide, 0.2, 30.0, np.random.default_rng(seed)
            )
            touch = interface.contact(u_d, pairing)
            pairing = touch.pairing
            R_d = forces(interface, touch, traction(interface, touch, interface.start(), touch.g_q < 0.0), u_d.size)
            change = max(change, 0.0 if before is None else float(np.abs(R_d - before).max()))
            before = R_d
        changes[steps] = change
    assert changes[200] < 0.25 * changes[40], changes


@pytest.mark.parametrize("slave", ["upper", "lower"])
def test_forces_and_moments_are_in_balance_past_the_end(slave, rng):
    """The continuation of the master is carried by its last side: no force and no moment comes from nowhere."""
    one = rig(*PAIRS["tspline on lagrange 2"], slave)
    end = 6.0 - one.interface.X_qi[:, 0].max()
    for over in (0.02, 0.1, 0.15):
        slide = end + over
        u_d = bent(one, 0.6 * LAW.g_max, slide if slave == "upper" else -slide, 0.25, 70.0, rng)
        touch = one.interface.contact(u_d, one.interface.pairing)
        assert np.any(~touch.pairing.on_q & touch.on_q), "a point is held beyond the end"
        pull = traction(one.interface, touch, one.interface.start(), touch.g_q < 0.0)
        R, x = forces(one.interface, touch, pull, u_d.size).reshape(-1, 2), one.interface.P_AI + u_d.reshape(-1, 2)
        assert np.all(np.abs(R.sum(0)) < 1e-12 * np.abs(R).sum())
        assert abs(np.sum(x[:, 0] * R[:, 1] - x[:, 1] * R[:, 0])) < 1e-11 * np.abs(R).sum()


def test_flush_ends_keep_their_points_whatever_rounding_does(rng):
    """Ends that move by 1e-3 of an element past each other carry as if they did not."""
    one = rig(nurbs(9, 3, UPPER), nurbs(9, 3, LOWER), "upper", points=8)
    for slide in (-1e-3, 1e-15, 1e-3, PROJECTION.held * 6.0 / 9.0):
        u_d = bent(one, 0.5 * LAW.g_max, slide, 0.0, 37.0, np.random.default_rng(1))
        touch = one.interface.contact(u_d, one.interface.pairing)
        assert np.all(touch.share_q == 1.0)
