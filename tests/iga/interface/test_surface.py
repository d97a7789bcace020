"""Surfaces as chains of rational curves: values, slopes, neighbours, and what is none."""

from dataclasses import replace

import numpy as np
import pytest
from boundary import boundary_chains

from iga.bases.bspline import open_knots
from iga.bases.lagrange import lagrange_rectangle
from iga.bases.nurbs import nurbs_mesh, nurbs_rectangle
from iga.interface.surface import normal, surface
from iga.mesh.extraction import ElementBlock


def curved(rng):
    """A patch with weights of its own, and its top side."""
    kv_s, kv_t = open_knots(np.array([0.0, 1.0, 1.5, 4.0]), 3), open_knots(np.array([0.0, 1.0]), 3)
    P_AI = nurbs_rectangle(kv_s, kv_t).P_AI
    mesh = nurbs_mesh(kv_s, kv_t, P_AI + 0.05 * rng.standard_normal(P_AI.shape), 1.0 + rng.random(len(P_AI)))
    return mesh, surface(mesh, mesh.chains["top"], 0)


def position(curve, P_AI, c_q, xi_q):
    (r_qb,) = curve.coefficients(c_q, xi_q, 0)
    return np.einsum("qa,qaI->qI", curve.functions(c_q, r_qb), P_AI[curve.conn_ca[c_q]])


def test_a_rational_surface_has_the_slopes_and_curvatures_of_its_positions(rng):
    mesh, curve = curved(rng)
    assert curve.sides == 3 and not curve.polynomial and curve.degree == 3
    c, xi, h = np.array([0, 1, 2, 2]), np.array([0.2, 0.5, 0.31, 0.8]), 1e-4
    H_qbI = curve.bezier_points(mesh.P_AI)[c]
    X, X_t, X_tt = (np.einsum("qb,qbI->qI", v, H_qbI) for v in curve.coefficients(c, xi, 2))
    before, here, after = (position(curve, mesh.P_AI, c, xi + d) for d in (-h, 0.0, h))
    assert here == pytest.approx(X, abs=1e-13) and len(curve.coefficients(c, xi, 1)) == 2
    assert (after - before) / (2 * h) == pytest.approx(X_t, abs=1e-6)
    assert (after - 2 * here + before) / h**2 == pytest.approx(X_tt, abs=1e-4)
    n = normal(X_t, curve.outward)
    assert np.sum(n * n, 1) == pytest.approx(np.ones(4)) and np.abs(np.sum(n * X_t, 1)).max() < 1e-14


@pytest.mark.parametrize("number", [0, 2, 3, 4])
def test_bezier_points_of_some_sides_are_those_of_all(number, rng):
    mesh, curve = curved(rng)
    c = rng.integers(0, 3, number)
    assert np.allclose(curve.bezier_points(mesh.P_AI, c), curve.bezier_points(mesh.P_AI)[c], rtol=0, atol=1e-15)


def test_sides_follow_each_other_around_a_loop_and_end_where_a_chain_ends(rng):
    mesh, curve = curved(rng)
    (chain,) = boundary_chains(mesh)
    loop, c = surface(mesh, chain, 0), np.array([0, 1, 2])
    assert not curve.closed and curve.following(c, np.array([1, 1, 1])).tolist() == [1, 2, 2]
    assert curve.following(c, np.array([-1, -1, -5])).tolist() == [0, 0, 0]
    assert loop.closed and loop.sides == 8
    assert loop.following(np.array([7, 0, 3]), np.array([1, -1, 9])).tolist() == [0, 7, 4]
    one = nurbs_rectangle(*[open_knots(np.array([0.0, 1.0]), 1)] * 2)
    assert not surface(one, one.chains["top"], 0).closed


def test_a_chain_of_two_degrees_is_none():
    mesh = lagrange_rectangle(np.linspace(0.0, 3.0, 4), np.linspace(0.0, 1.0, 2), 2)
    (block,), bottom = mesh.blocks, mesh.chains["bottom"]
    first = ElementBlock(block.degrees, block.C_eab[:1], block.conn_ea[:1])
    rest = ElementBlock((3, 2), block.C_eab[1:], block.conn_ea[1:])
    chain = replace(bottom, block_c=np.array([0, 1, 1]), element_c=np.array([0, 0, 1]))
    with pytest.raises(ValueError, match=r"a surface needs sides of one degree, got degrees \[2, 3\]"):
        surface(replace(mesh, blocks=(first, rest)), chain, 0)


def test_on_a_side_as_many_functions_live_as_it_has_coefficients():
    """What rounding leaves of the others is nothing."""
    mesh = lagrange_rectangle(np.linspace(0.0, 3.0, 4), np.linspace(0.0, 1.0, 2), 2)
    (block,), bottom = mesh.blocks, mesh.chains["bottom"]
    whole = surface(mesh, bottom, 7)
    above = np.flatnonzero(np.all(mesh.P_AI[block.conn_ea[1]][:, 1:] > 0.9, axis=1))[0]
    for rest, lives in ((0.9e-13, False), (1.1e-13, True)):
        C_eab = block.C_eab.copy()
        C_eab[1, above, 0] += rest
        spoilt = replace(mesh, blocks=(replace(block, C_eab=C_eab),))
        if lives:
            with pytest.raises(ValueError, match=r"a side of degree 2 must carry 3 functions, got \[.*3.*, .*4.*\]"):
                surface(spoilt, bottom, 7)
        else:
            assert np.array_equal(surface(spoilt, bottom, 7).conn_ca, whole.conn_ca) and whole.conn_ca.min() >= 7
