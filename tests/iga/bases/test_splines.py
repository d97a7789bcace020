"""Bases: partition of unity, two routes to every value, knot insertion, exact geometry."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from knots import insert_knot, values

from iga.bases.bspline import KnotVector, bezier_extraction, open_knots
from iga.bases.lagrange import lagrange_extraction, lagrange_rectangle
from iga.bases.nurbs import nurbs_mesh, nurbs_rectangle
from iga.elements.shape_functions import block_basis, chain_basis
from iga.mesh.bernstein import bernstein, bernstein_derivative
from iga.mesh.quadrature import gauss, lobatto, square


@st.composite
def knot_vectors(draw):
    """Open knot vectors of degree 1 to 5 with random spans and random inner multiplicities."""
    p = draw(st.integers(1, 5))
    spans = draw(st.lists(st.floats(0.05, 20.0), min_size=1, max_size=7))
    breaks = np.concatenate([[0.0], np.cumsum(spans)]) + draw(st.floats(-10.0, 10.0))
    repeats = [draw(st.integers(1, p)) for _ in breaks[1:-1]]
    inner = np.repeat(breaks[1:-1], repeats)
    return KnotVector(p, np.concatenate([np.repeat(breaks[0], p + 1), inner, np.repeat(breaks[-1], p + 1)]))


@given(st.integers(0, 6), st.floats(0.0, 1.0))
def test_bernstein_polynomials_are_a_partition_of_unity_and_not_negative(p, xi):
    B = bernstein(p, np.array(xi))
    assert abs(B.sum() - 1.0) < 1e-14 and np.all(B >= 0.0)


@pytest.mark.parametrize("order", [1, 2, 3])
@pytest.mark.parametrize("p", [1, 3, 5])
def test_bernstein_derivatives_against_numpy_polynomials(p, order):
    xi = np.linspace(0.0, 1.0, 7)
    for b in range(p + 1):
        coefficients = np.polynomial.polynomial.polyfit(
            np.linspace(0, 1, p + 1), bernstein(p, np.linspace(0, 1, p + 1))[:, b], p
        )
        expected = np.polynomial.polynomial.polyval(xi, np.polynomial.polynomial.polyder(coefficients, order))
        assert np.allclose(bernstein_derivative(p, xi, order)[:, b], expected, atol=1e-10)


@given(knot_vectors())
def test_extraction_equals_cox_de_boor(kv):
    """Polar forms against the recursion, at random points of every span."""
    C, spans, p = bezier_extraction(kv), kv.spans, kv.degree
    xi = np.linspace(0.03, 0.97, 5)
    left, right = kv.knots[spans], kv.knots[spans + 1]
    x = (left[:, None] + (right - left)[:, None] * xi).ravel()
    extracted = np.einsum("eab,qb->eqa", C, bernstein(p, xi)).reshape(len(x), -1)
    full = values(kv, x)
    first = np.repeat(spans - p, len(xi))
    local = np.take_along_axis(full, first[:, None] + np.arange(p + 1), axis=1)
    assert np.max(np.abs(extracted - local)) < 1e-13
    assert np.max(np.abs(full.sum(1) - 1.0)) < 1e-13
    assert np.max(np.abs(full.sum(1) - local.sum(1))) < 1e-13, "a function outside the span is not zero there"


@pytest.mark.parametrize("p", [1, 2, 3, 4, 5])
def test_lagrange_functions_are_one_at_their_node_and_zero_at_the_others(p):
    nodes = np.linspace(0.0, 1.0, p + 1)
    assert np.allclose(bernstein(p, nodes) @ lagrange_extraction(p).T, np.eye(p + 1), atol=1e-12)


@pytest.mark.parametrize("n", range(1, 13))
def test_rules_are_exact_to_their_degree_and_no_further(n):
    for rule, degree in ((gauss, 2 * n - 1), (lobatto, 2 * n - 3)):
        if rule is lobatto and n == 1:
            continue
        x, w = rule(n)
        for k in range(degree + 1):
            assert abs(w @ x**k - 1.0 / (k + 1)) < 1e-13
        assert abs(w @ (2 * x - 1) ** (degree + 1) - 1.0 / (degree + 2)) > 1e-12


def quarter_annulus(inner: float, outer: float, refine: int = 0):
    """Exact quarter annulus, walked clockwise from the Y axis so that the map keeps its orientation."""
    kv_s, kv_t = open_knots(np.array([0.0, 1.0]), 2), open_knots(np.array([0.0, 1.0]), 1)
    arc = np.array([[0.0, 1.0], [1.0, 1.0], [1.0, 0.0]])
    w_s = np.array([1.0, np.sqrt(0.5), 1.0])
    homogeneous = np.concatenate([arc * w_s[:, None], w_s[:, None]], axis=1)
    for x in np.linspace(0, 1, refine + 2)[1:-1]:
        kv_s, T = insert_knot(kv_s, x)
        homogeneous = T @ homogeneous
    w, arc = homogeneous[:, 2], homogeneous[:, :2] / homogeneous[:, 2:]
    return nurbs_mesh(kv_s, kv_t, np.concatenate([inner * arc, outer * arc]), np.concatenate([w, w]))


@pytest.mark.parametrize("refine", [0, 3])
def test_area_and_arc_length_of_an_annulus_are_exact(refine):
    mesh = quarter_annulus(1.0, 2.0, refine)
    (block,) = mesh.blocks
    basis = block_basis(mesh, block, *square(gauss(12), gauss(2)))
    assert abs(basis.dV_eq.sum() - 3 * np.pi / 4) < 1e-12
    (side,) = chain_basis(mesh, mesh.chains["top"], *gauss(12))
    assert abs(side.dV_eq.sum() - np.pi) < 1e-12
    assert np.max(np.abs(basis.N_eqa.sum(-1) - 1.0)) < 1e-14
    assert np.max(np.abs(basis.dN_eqIa.sum(3))) < 1e-12


@settings(max_examples=20, deadline=None)
@given(knot_vectors(), knot_vectors())
def test_rectangles_reproduce_linear_fields(kv_s, kv_t):
    mesh = nurbs_rectangle(kv_s, kv_t)
    (block,) = mesh.blocks
    basis = block_basis(mesh, block, *square(gauss(2), gauss(2)))
    gradient = np.einsum("eqIa,eai->eqIi", basis.dN_eqIa, mesh.P_AI[basis.conn_ea])
    assert np.max(np.abs(gradient - np.eye(2))) < 1e-10
    size = np.ptp(kv_s.knots) * np.ptp(kv_t.knots)
    assert abs(basis.dV_eq.sum() / size - 1.0) < 1e-12


def test_a_mesh_that_is_turned_inside_out_is_refused():
    mesh = lagrange_rectangle(np.array([0.0, 1.0]), np.array([0.0, 1.0]), 1)
    flipped = type(mesh)(mesh.P_AI * [-1.0, 1.0], mesh.w_A, mesh.blocks, mesh.chains)
    with pytest.raises(ValueError, match="inside out"):
        block_basis(flipped, flipped.blocks[0], *square(gauss(2), gauss(2)))


@pytest.mark.parametrize(
    "knots",
    [[0, 0, 1, 1, 1], [0, 0, 0, 0.5, 0.2, 1, 1, 1], [0, 0, 0, 0.5, 0.5, 0.5, 1, 1, 1], [0, 0, 0, np.nan, 1, 1, 1]],
)
def test_bad_knot_vectors_are_refused(knots):
    with pytest.raises(ValueError):
        KnotVector(2, np.array(knots, dtype=float))


def test_functions_that_do_not_sum_to_one_are_divided_by_their_sum(rng):
    """Whatever the weights, also where all are one: as of T-splines that are no partition of unity by themselves."""
    mesh = nurbs_rectangle(open_knots(np.array([0.0, 1.0, 2.5]), 3), open_knots(np.array([0.0, 1.0]), 2))
    (block,), rule = mesh.blocks, (rng.random((5, 2)), np.ones(5))
    a, b = 1.0 + rng.random(2)
    doubled = replace(block, C_eab=a * block.C_eab)
    for weight in (1.0, b, 1.0 / a):
        heavy = replace(mesh, w_A=weight * mesh.w_A)
        found, plain = block_basis(heavy, doubled, *rule), block_basis(mesh, block, *rule)
        for name in ("N_eqa", "dN_eqIa", "dV_eq", "X_eqI"):
            assert getattr(found, name) == pytest.approx(getattr(plain, name), rel=1e-12, abs=1e-12), name


def test_points_and_weights_that_all_share_cannot_be_changed():
    for shared in gauss(3):
        with pytest.raises(ValueError, match="read-only"):
            shared[0] = 0.0


@pytest.mark.parametrize("degrees", [(0,), (2, 0), (-1, 2)])
def test_lagrange_elements_without_a_degree_are_refused(degrees):
    with pytest.raises(ValueError, match="degree: must be >= 1, got"):
        lagrange_rectangle(np.array([0.0, 1.0]), np.array([0.0, 1.0]), *degrees)
