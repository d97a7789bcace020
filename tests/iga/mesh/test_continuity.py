"""How smooth functions are across the sides of elements, hanging nodes included."""

import numpy as np
import pytest
from iga_files import SMALL, small

from iga.bases.bspline import KnotVector, open_knots
from iga.bases.lagrange import lagrange_rectangle
from iga.bases.nurbs import nurbs_mesh
from iga.files.iga_format import mesh
from iga.files.iga_reader import read_iga
from iga.mesh.continuity import jumps, space_derivatives
from iga.mesh.edges import element_sides
from iga.tsplines.lines import tensor_grid, with_lines
from iga.tsplines.tspline import tspline_rectangle

ZERO = 1e-11


def curved(kv_s, kv_t, rng):
    """A surface of smooth functions with weights whose sides are curves."""
    n_s, n_t = kv_s.functions, kv_t.functions
    X, Y = np.meshgrid(kv_s.greville, kv_t.greville)
    P_AI = np.stack([X + 0.1 * np.sin(Y), Y + 0.1 * np.cos(X)], -1).reshape(-1, 2)
    return nurbs_mesh(kv_s, kv_t, P_AI, 0.8 + 0.4 * rng.random(n_s * n_t))


def test_smooth_splines(rng):
    kv = open_knots(np.linspace(0.0, 1.0, 5), 3)
    body = curved(kv, kv, rng)
    k, jump_no = jumps(body, element_sides(body))
    assert len(k) == 2 * 2 * 3 * 4
    assert jump_no.max() < ZERO


@pytest.mark.parametrize(("multiplicity", "order"), [(1, 2), (2, 1), (3, 0)])
def test_repeated_knots(multiplicity, order, rng):
    """A knot m times in a cubic: continuous up to the derivative 3 - m, and no further."""
    kv_s = KnotVector(3, np.array([0.0] * 4 + [0.4] * multiplicity + [1.0] * 4))
    body = curved(kv_s, open_knots(np.array([0.0, 1.0]), 3), rng)
    k, jump_no = jumps(body, element_sides(body))
    assert len(k) == 2
    assert jump_no[:, : order + 1].max() < ZERO
    assert order == 2 or jump_no[:, order + 1].min() > 0.1


def test_derivatives_reproduce_the_position(rng):
    """Functions weighted with the control points give X and Y: first derivatives are unit vectors, second ones zero."""
    body = curved(open_knots(np.linspace(0.0, 1.0, 4), 3), open_knots(np.linspace(0.0, 1.0, 3), 2), rng)
    sides = element_sides(body)
    k = rng.integers(0, len(sides.block_k), 50)
    t = rng.random(50)
    N, N_X, N_Y, N_XX, N_XY, N_YY = space_derivatives(body, sides, k, t)
    assert N @ body.P_AI == pytest.approx(sides.points(k, t)[:, :2], abs=1e-14)
    assert N_X @ body.P_AI == pytest.approx(np.tile([1.0, 0.0], (50, 1)), abs=1e-12)
    assert N_Y @ body.P_AI == pytest.approx(np.tile([0.0, 1.0], (50, 1)), abs=1e-12)
    for second in (N_XX, N_XY, N_YY):
        assert abs(second).max() > 1.0 and np.abs(second @ body.P_AI).max() < 1e-10


def test_second_derivatives_are_slopes_of_the_first(rng):
    """Along a side, by a difference quotient: d(N_X)/dt = N_XX dX/dt + N_XY dY/dt."""
    body = curved(open_knots(np.linspace(0.0, 1.0, 4), 3), open_knots(np.linspace(0.0, 1.0, 3), 2), rng)
    sides, h = element_sides(body), 1e-5
    k = np.arange(len(sides.block_k))
    t = 0.1 + 0.8 * rng.random(len(k))
    X_t, Y_t, _ = ((sides.points(k, t + h) - sides.points(k, t - h)) / (2 * h)).T
    ahead, behind = (space_derivatives(body, sides, k, t + sign * h) for sign in (1.0, -1.0))
    _, _, _, N_XX, N_XY, N_YY = (matrix.toarray() for matrix in space_derivatives(body, sides, k, t))
    slope_X, slope_Y = ((ahead[i] - behind[i]).toarray() / (2 * h) for i in (1, 2))
    scale = np.abs(N_XX).max()
    assert N_XX * X_t[:, None] + N_XY * Y_t[:, None] == pytest.approx(slope_X, abs=1e-6 * scale)
    assert N_XY * X_t[:, None] + N_YY * Y_t[:, None] == pytest.approx(slope_Y, abs=1e-6 * scale)


def test_lagrange_is_continuous_only():
    body = lagrange_rectangle(np.linspace(0.0, 2.0, 4), np.linspace(0.0, 1.0, 3), 2)
    _, jump_no = jumps(body, element_sides(body))
    assert jump_no[:, 0].max() < ZERO and jump_no[:, 1].min() > 1.0


def test_across_hanging_nodes():
    """A T-spline is C2 across its T-junctions too."""
    breaks = np.linspace(0.0, 1.0, 9)
    line = np.array([(0.4375, 0.375, 0.625)])
    body = tspline_rectangle(with_lines(tensor_grid(breaks, breaks), line, np.empty((0, 3))))
    sides = element_sides(body)
    _, jump_no = jumps(body, sides)
    assert len(sides.hanging) == 2 and jump_no.max() < ZERO


def test_bilinear_elements_with_a_hanging_node(tmp_path):
    body = mesh(read_iga(small(tmp_path, SMALL)))
    _, jump_no = jumps(body, element_sides(body))
    assert jump_no[:, 0].max() < ZERO and jump_no[:, 1].min() > 0.1


def test_one_element_has_no_inner_side():
    body = lagrange_rectangle(np.array([0.0, 1.0]), np.array([0.0, 1.0]), 2)
    k, jump_no = jumps(body, element_sides(body))
    assert k.size == 0 and jump_no.shape == (0, 3)
