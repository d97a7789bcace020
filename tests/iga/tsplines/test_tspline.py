"""T-splines: functions of analysis-suitable T-meshes are a basis; those of others need not be."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from random_tmeshes import breaks, marked, markings, suitable_tmeshes, walked_values
from tmeshes import made_suitable

from iga.bases.bspline import open_knots
from iga.bases.nurbs import nurbs_mesh
from iga.elements.shape_functions import block_basis, chain_basis
from iga.mesh.bernstein import bernstein, bernstein_derivative, tensor
from iga.mesh.quadrature import gauss, square
from iga.tsplines.lines import tensor_grid, with_line
from iga.tsplines.tmesh import NotSuitable, TMesh
from iga.tsplines.transfer import transfer
from iga.tsplines.tspline import extracted, greville, tspline_mesh, tspline_rectangle

some = settings(max_examples=40, deadline=None)
few = settings(max_examples=20, deadline=None)


@some
@given(suitable_tmeshes(), st.integers(0, 2**32 - 1))
def test_functions_are_a_partition_of_unity(mesh, seed):
    blocks = extracted(mesh).blocks
    assert max(np.abs(block.C_eab.sum(1) - 1.0).max() for block in blocks) < 1e-14
    assert min(block.C_eab.min() for block in blocks) >= 0.0
    assert np.abs(walked_values(mesh, points(mesh, seed)).sum(1) - 1.0).max() < 1e-14


@some
@given(suitable_tmeshes(), st.integers(0, 2**32 - 1))
def test_extraction_is_cox_de_boor(mesh, seed):
    """Bernstein pieces against the recursion on knot vectors that were found by walking the T-mesh."""
    x_qi = points(mesh, seed)
    assert np.abs(values(mesh, x_qi) - walked_values(mesh, x_qi)).max() < 1e-13


@few
@given(markings(steps=4))
def test_spaces_of_bisected_meshes_are_nested(drawn):
    mesh, steps = drawn
    for places in steps:
        finer = mesh.refined(marked(mesh, places))
        assert nesting_error(mesh.tmesh, finer.tmesh) < 1e-13
        assert distance(mesh.tmesh, finer.tmesh) < 1e-13
        mesh = finer


def test_spaces_are_nested_where_extended_meshes_are_and_need_not_be_elsewhere():
    """Li and Scott 2014: a line that shortens the extension of another takes smoothness away on one side only."""
    grid = tensor_grid(np.arange(7.0), np.arange(7.0))
    coarse = with_line(grid, "vertical", 2.5, (0.0, 2.0))
    inside = with_line(coarse, "vertical", 2.5, (2.0, 3.0))
    shorter = with_line(coarse, "horizontal", 2.5)
    assert distance(coarse, inside) < 1e-13 and nesting_error(coarse, inside) < 1e-13
    assert shorter.suitable and distance(coarse, shorter) > 1e-3 and nesting_error(coarse, shorter) > 1e-3


@some
@given(suitable_tmeshes())
def test_rectangles_have_their_area_and_reproduce_linear_fields(mesh):
    body = tspline_rectangle(mesh)
    area = 0.0
    for block in body.blocks:
        basis = block_basis(body, block, *square(gauss(2), gauss(2)))
        gradient = np.einsum("eqIa,eai->eqIi", basis.dN_eqIa, body.P_AI[basis.conn_ea])
        assert np.abs(gradient - np.eye(2)).max() < 1e-10
        area += basis.dV_eq.sum()
    assert area == pytest.approx(np.ptp(mesh.knots_i) * np.ptp(mesh.knots_j), rel=1e-12)
    for side, length in (("bottom", mesh.knots_i), ("right", mesh.knots_j)):
        parts = chain_basis(body, body.chains[side], *gauss(2))
        assert sum(part.dV_eq.sum() for part in parts) == pytest.approx(np.ptp(length), rel=1e-12)


@some
@given(breaks(), breaks(), st.data())
def test_full_grids_are_nurbs(s, t, data):
    n_A = (len(s) + 2) * (len(t) + 2)
    random = np.random.default_rng(data.draw(st.integers(0, 2**32 - 1)))
    P_AI, w_A = random.normal(size=(n_A, 2)), random.uniform(0.5, 2.0, n_A)
    nurbs = nurbs_mesh(open_knots(s, 3), open_knots(t, 3), P_AI, w_A)
    (one,), (other,) = nurbs.blocks, tspline_mesh(tensor_grid(s, t), P_AI, w_A).blocks
    order, sorted_conn = np.argsort(other.conn_ea, axis=1), np.sort(one.conn_ea, axis=1)
    assert np.array_equal(np.take_along_axis(other.conn_ea, order, 1), sorted_conn)
    C_eab = np.take_along_axis(other.C_eab, order[:, :, None], 1)
    expected = np.take_along_axis(one.C_eab, np.argsort(one.conn_ea, axis=1)[:, :, None], 1)
    assert np.abs(C_eab - expected).max() < 1e-12


@some
@given(suitable_tmeshes(), st.integers(0, 2**32 - 1))
def test_derivatives_up_to_the_multiplicity_are_continuous(mesh, seed):
    """Across every knot value, wherever one looks: 3 less the number of its copies there are."""
    random = np.random.default_rng(seed)
    values_A = random.normal(size=len(mesh.anchors))
    for direction, knots, other in (
        ("vertical", mesh.knots_i, mesh.knots_j),
        ("horizontal", mesh.knots_j, mesh.knots_i),
    ):
        for at, copies in zip(*(x[1:-1] for x in np.unique(knots, return_counts=True)), strict=True):
            along = random.uniform(other[0], other[-1])
            size = np.min(np.diff(np.unique(knots)))
            for order in range(3 - copies + 1):
                assert jump(mesh, values_A, direction, at, along, order) < 1e-10 / size**order


@pytest.mark.parametrize(
    ("upright", "level", "crossing", "missed", "functions"),
    [
        ((1.5, 0, 1), (1.5, 1, 2), (1.5, 1.5), 0.05, 16),
        ((0.5, 0, 1), (1.5, 1, 2), (0.5, 1.5), 0.06, 17),
        ((1.5, 0, 1), (1.5, 0, 1), (1.5, 1.5), 0.14, 17),
    ],
)
def test_two_lines_too_many_and_the_sum_is_no_longer_one(upright, level, crossing, missed, functions):
    """T-meshes of two extra lines, neither of which is harmful alone."""
    grid = tensor_grid(np.arange(4.0), np.arange(4.0))
    one, other = with_line(grid, "vertical", *split(upright)), with_line(grid, "horizontal", *split(level))
    assert one.suitable and other.suitable
    both = with_line(one, "horizontal", *split(level))
    assert list(crossing) in both.crossings().tolist()
    with pytest.raises(NotSuitable, match=r"meet at \({:g}, {:g}\)".format(*both.crossings()[0])):
        tspline_mesh(both, greville(both))
    sums = walked_values(both, points(both, 1, 2000)).sum(1)
    assert np.abs(sums - 1.0).max() == pytest.approx(missed, abs=0.006)
    assert max(block.conn_ea.shape[1] for block in extracted(both).blocks) == functions
    closed = made_suitable(both)
    assert np.abs(walked_values(closed, points(both, 1)).sum(1) - 1.0).max() < 1e-14


def test_numbers_of_control_points_and_weights_are_checked():
    mesh = tensor_grid([0.0, 1.0], [0.0, 1.0])
    P_AI = greville(mesh)
    with pytest.raises(ValueError, match="asks for 16 control points and weights, got 15"):
        tspline_mesh(mesh, P_AI[1:])
    with pytest.raises(ValueError, match="weights must be > 0, the smallest is -1"):
        tspline_mesh(mesh, P_AI, np.linspace(-1.0, 1.0, 16))


def split(line: tuple[float, int, int]) -> tuple[float, tuple[float, float]]:
    return line[0], (float(line[1]), float(line[2]))


def points(mesh: TMesh, seed: int, number: int = 60) -> np.ndarray:
    random = np.random.default_rng(seed)
    low, high = ([mesh.knots_i[n], mesh.knots_j[n]] for n in (0, -1))
    return random.uniform(low, high, (number, 2))


def pieces(mesh: TMesh):
    """Every Bezier element as its box in knot values, its coefficients and its functions."""
    found = extracted(mesh)
    for box, number, place in zip(found.box_ek, found.block_e, found.place_e, strict=True):
        block = found.blocks[number]
        yield np.concatenate([mesh.knots_i[box[:2]], mesh.knots_j[box[2:]]]), block.C_eab[place], block.conn_ea[place]


def values(mesh: TMesh, x_qi: np.ndarray) -> np.ndarray:
    """Values (n_q, n_A) of the extracted functions."""
    out = np.zeros((len(x_qi), len(mesh.anchors)))
    for (s0, s1, t0, t1), C_ab, A in pieces(mesh):
        q = np.flatnonzero((x_qi[:, 0] >= s0) & (x_qi[:, 0] < s1) & (x_qi[:, 1] >= t0) & (x_qi[:, 1] < t1))
        if q.size == 0:
            continue
        B = tensor(bernstein(3, (x_qi[q, 0] - s0) / (s1 - s0)), bernstein(3, (x_qi[q, 1] - t0) / (t1 - t0)))
        out[np.ix_(q, A)] = B @ C_ab.T
    return out


def values_at_shared_points(coarse: TMesh, fine: TMesh) -> tuple[np.ndarray, np.ndarray]:
    """Both sets of functions at sixteen points of every element of the two meshes."""
    x_q = gauss(4)[0]
    samples = []
    for mesh in (coarse, fine):
        for (s0, s1, t0, t1), _, _ in pieces(mesh):
            s, t = s0 + (s1 - s0) * x_q, t0 + (t1 - t0) * x_q
            samples.append(np.stack([np.tile(s, 4), np.repeat(t, 4)], -1))
    x_qi = np.concatenate(samples)
    return values(coarse, x_qi), values(fine, x_qi)


def distance(coarse: TMesh, fine: TMesh) -> float:
    """How far the functions of one mesh are from the space of the other, at points of all elements."""
    N_coarse, N_fine = values_at_shared_points(coarse, fine)
    return np.abs(N_fine @ np.linalg.lstsq(N_fine, N_coarse, rcond=None)[0] - N_coarse).max()


def nesting_error(coarse: TMesh, fine: TMesh) -> float:
    """Largest difference between a function and its image in the other space, at points of all elements."""
    N_coarse, N_fine = values_at_shared_points(coarse, fine)
    return np.abs(N_coarse - N_fine @ transfer(coarse, fine)).max()


def one_sided(mesh: TMesh, values_A, direction, at, along, order, side) -> float:
    """Derivative across a line of the given direction, from below it (side 0) or from above (side 1)."""
    across = 0 if direction == "vertical" else 1
    for box, C_ab, A in pieces(mesh):
        (a0, a1), (b0, b1) = box[2 * across :][:2], box[2 - 2 * across :][:2]
        if (a0 if side else a1) == at and b0 <= along < b1:
            B_a = bernstein_derivative(3, np.array(0.0 if side else 1.0), order) / (a1 - a0) ** order
            B_b = bernstein(3, np.array((along - b0) / (b1 - b0)))
            return float((tensor(B_a, B_b) if across == 0 else tensor(B_b, B_a)) @ C_ab.T @ values_A[A])
    return np.nan


def jump(mesh: TMesh, values_A, direction, at, along, order) -> float:
    """Jump of a derivative across a line; none where no element ends there."""
    below, above = (one_sided(mesh, values_A, direction, at, along, order, side) for side in (0, 1))
    return 0.0 if np.isnan(below) and np.isnan(above) else abs(above - below)
