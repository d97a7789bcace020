"""Points that lose their partner and find one again, points beyond the ends, and what a projection costs."""

import numpy as np
import pytest
from boundary import boundary_chains
from hypothesis import given
from hypothesis import strategies as st

from iga.bases.bspline import open_knots
from iga.bases.lagrange import lagrange_rectangle
from iga.bases.nurbs import nurbs_rectangle
from iga.interface import closest_point
from iga.interface.closest_point import PROJECTION, Pairing, closest_points, nearest_samples
from iga.interface.surface import surface
from iga.mesh.extraction import Chain
from tests.iga.bases.test_splines import quarter_annulus


def position(surface, pairing, y):
    (r,) = surface.coefficients(pairing.c_q, pairing.xi_q, 0)
    return np.einsum("qb,qbi->qi", r, surface.bezier_points(y, pairing.c_q))


def at(c: int, xi: float, n: int) -> Pairing:
    """All of n points at one place."""
    return Pairing(np.full(n, c), np.full(n, xi), np.ones(n, dtype=bool))


def wavy(sides: int, degree: int = 3, side: str = "top"):
    """A surface of unit elements with waves of six elements, and its control points."""
    mesh = nurbs_rectangle(open_knots(np.linspace(0.0, sides, sides + 1), degree), open_knots(np.array([-1.0, 0.0]), 1))
    y = mesh.P_AI + np.stack([0.0 * mesh.P_AI[:, 0], 0.3 * np.sin(mesh.P_AI[:, 0])], -1)
    return surface(mesh, mesh.chains[side], 0), y


@pytest.mark.parametrize("sides", [7, 300, 5000])
def test_a_stale_pairing_is_as_good_as_a_fresh_one(sides, rng):
    """From either end of the chain, however many sides away the partner is now."""
    top, y = wavy(sides)
    x = np.stack([rng.uniform(0.0, sides, 200), rng.uniform(0.4, 0.9, 200)], -1)
    fresh = closest_points(top, x, y, nearest_samples(top, x, y))
    if sides * 8 > PROJECTION.most:  # the samples alone do not see every wave
        near = np.clip(x[:, 0].astype(int), 0, sides - 1)
        fresh = closest_points(top, x, y, Pairing(near, x[:, 0] - near, np.ones(200, dtype=bool)))
    for start in (at(0, 0.0, 200), at(sides - 1, 1.0, 200), at(sides // 2, 0.4, 200)):
        found = closest_points(top, x, y, start)
        away = np.linalg.norm(position(top, found, y) - position(top, fresh, y), axis=1)
        # between two crests of a wave either one may be met
        assert np.mean(away < 1e-9) > 0.8 and away.max() < 7.0


@pytest.mark.parametrize("xi", [0.0, 1e-16, 1e-9, 1.0 - 1e-9, 1.0 - 1e-16, 1.0])
@pytest.mark.parametrize("x", [2.997, 3.003])
def test_a_point_leaves_its_side_from_next_to_an_end_as_from_the_end(xi, x):
    """An end of the side that is near is no sign that the partner is."""
    top, y = wavy(7)
    point = np.array([[x, 0.9]])
    c = 2 if xi > 0.5 else 3
    found, fresh = (closest_points(top, point, y, start) for start in (at(c, xi, 1), at(int(x), 0.5, 1)))
    assert position(top, found, y) == pytest.approx(position(top, fresh, y), abs=1e-12)


def test_points_that_cross_to_the_next_side_are_followed_with_all_others(monkeypatch):
    """By plain Newton, on either hand, to where the careful search finds them."""
    top, y = wavy(12)
    here = np.arange(0.6, 11.0, 0.25)
    points = [np.stack([here + slid, np.full(here.size, 0.9)], -1) for slid in (0.0, 0.3, -0.3)]
    start = closest_points(top, points[0], y, nearest_samples(top, points[0], y))
    wanted = [closest_points(top, x, y, nearest_samples(top, x, y)) for x in points[1:]]
    monkeypatch.setattr(closest_point, "_along_chain", None)
    for x, far in zip(points[1:], wanted, strict=True):
        near = closest_points(top, x, y, start)
        assert np.count_nonzero(near.c_q != start.c_q) > 8
        assert np.array_equal(near.c_q, far.c_q) and near.xi_q == pytest.approx(far.xi_q, abs=1e-9)


def test_a_point_comes_back_to_a_straight_surface_after_any_way(rng):
    mesh = lagrange_rectangle(np.linspace(0.0, 400.0, 401), np.array([0.0, 1.0]), 2)
    top = surface(mesh, mesh.chains["top"], 0)
    pairing = at(10, 0.5, 1)
    for x in (-500.0, 900.0, 399.5, 0.2, -1e-3, 250.0, 1e4, 3.0):
        pairing = closest_points(top, np.array([[x, 1.3]]), mesh.P_AI, pairing)
        assert pairing.on_q[0] == (0.0 <= x <= 400.0)
        assert position(top, pairing, mesh.P_AI)[0] == pytest.approx([np.clip(x, 0.0, 400.0), 1.0], abs=1e-9)


@given(st.floats(0.05, 1.5), st.floats(0.05, 1.5), st.floats(1.05, 3.0))
def test_a_point_on_the_wrong_side_of_an_arc_is_not_kept_where_the_distance_is_largest(here, there, radius):
    """From inside of the circle, beyond its centre, the place opposite is the farthest: Newton would stay there."""
    mesh = quarter_annulus(1.0, 2.0, 4)
    arc = surface(mesh, mesh.chains["top"], 0)
    ray = np.array([[np.cos(there), np.sin(there)]])
    start = closest_points(arc, 2.0 * np.array([[np.cos(here), np.sin(here)]]), mesh.P_AI, at(2, 0.5, 1))
    found = closest_points(arc, radius * ray, mesh.P_AI, start)
    assert found.on_q[0] and np.max(np.abs(position(arc, found, mesh.P_AI) - 2.0 * ray)) < 1e-10
    beyond = closest_points(arc, -0.5 * ray, mesh.P_AI, found)
    ends = np.array([[0.0, 2.0], [2.0, 0.0]])
    nearest = ends[np.argmin(np.linalg.norm(ends + 0.5 * ray, axis=1))]
    assert not beyond.on_q[0] and position(arc, beyond, mesh.P_AI)[0] == pytest.approx(nearest, abs=1e-12)


@pytest.mark.parametrize("start", [(0, 0.5), (1, 0.5), (0, 1.0), (1, 0.0), (3, 0.2)])
def test_on_a_kink_a_point_keeps_to_one_side_wherever_it_comes_from(start):
    """A roof: above its ridge every point meets the ridge, on the side to which it leans."""
    mesh = lagrange_rectangle(np.array([-2.0, -1.0, 0.0, 1.0, 2.0]), np.array([0.0, 1.0]), 1)
    y = mesh.P_AI - np.stack([0.0 * mesh.P_AI[:, 0], 0.5 * np.abs(mesh.P_AI[:, 0])], -1)
    top = surface(mesh, mesh.chains["top"], 0)
    x = np.array([[-0.02, 1.5], [0.02, 1.5], [0.1, 2.0]])
    found = closest_points(top, x, y, at(*start, 3))
    assert np.all(found.on_q) and np.allclose(position(top, found, y), [0.0, 1.0], atol=1e-14)
    assert found.c_q.tolist() == [1, 2, 2]


def test_a_closed_chain_has_no_ends(rng):
    """Around the whole boundary of a body, over the corner where its chain begins."""
    mesh = lagrange_rectangle(np.linspace(0.0, 3.0, 4), np.linspace(0.0, 1.0, 2), 2)
    (chain,) = boundary_chains(mesh)
    loop = surface(mesh, chain, 0)
    assert loop.closed and not surface(mesh, mesh.chains["top"], 0).closed
    x = np.array([[0.3, -0.1], [-0.1, 0.4], [3.2, 0.7], [1.7, 1.1]])
    for c in range(loop.sides):
        found = closest_points(loop, x, mesh.P_AI, at(c, 0.5, 4))
        assert np.all(found.on_q)
        assert np.allclose(position(loop, found, mesh.P_AI), [[0.3, 0.0], [0.0, 0.4], [3.0, 0.7], [1.7, 1.0]])


def test_a_chain_can_be_cut_anywhere():
    """Three sides out of the middle of one: points beyond them are beyond the ends."""
    top, y = wavy(12)
    mesh = nurbs_rectangle(open_knots(np.linspace(0.0, 12, 13), 3), open_knots(np.array([-1.0, 0.0]), 1))
    whole = mesh.chains["top"]
    part = surface(mesh, Chain(whole.block_c[4:7], whole.element_c[4:7], whole.side_c[4:7], whole.outward), 0)
    x = np.array([[1.0, 0.8], [5.3, 0.1], [9.0, 0.9]])
    found, all_of_it = (closest_points(s, x, y, nearest_samples(s, x, y)) for s in (part, top))
    assert found.on_q.tolist() == [False, True, False] and np.all(all_of_it.on_q)
    assert found.c_q[1] == all_of_it.c_q[1] - 4 and found.xi_q[1] == pytest.approx(all_of_it.xi_q[1], abs=1e-12)
