"""From one T-mesh to another: exact where the new space holds the field, of full order where it does not."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from random_tmeshes import breaks, marked, markings, walked_values
from tmeshes import initial, transferred

from iga.specimen.tmesh_strip import Strip, strip_tmesh
from iga.tsplines.lines import tensor_grid
from iga.tsplines.transfer import collocation, transfer
from iga.tsplines.tspline import extracted, greville, tspline_mesh

some = settings(max_examples=40, deadline=None)
few = settings(max_examples=15, deadline=None)


@st.composite
def strip_pairs(draw):
    """Two strips on the same elements, halved where and as often as they like."""
    x, through, top = draw(breaks()), (-0.5, 1.0), draw(st.booleans())
    halved = st.lists(st.booleans(), min_size=len(x) - 1, max_size=len(x) - 1)
    both = (Strip(x, np.array(draw(halved)), draw(st.integers(1, 3))) for _ in range(2))
    return tuple(strip_tmesh(strip, through, top) for strip in both)


@st.composite
def bisection_pairs(draw):
    """Two T-meshes bisected from one grid, each in its own places."""
    start, steps = draw(markings())
    both = []
    for _ in range(2):
        mesh = start
        for places in draw(st.permutations(steps)):
            mesh = mesh.refined(marked(mesh, places))
        both.append(mesh.tmesh)
    return tuple(both)


@st.composite
def grid_pairs(draw):
    """Two tensor grids of one domain whose inner knots have nothing to do with one another."""
    (s0, *_, s1), (t0, *_, t1) = draw(breaks()), draw(breaks())
    inner = st.lists(st.sampled_from(np.linspace(0.0, 1.0, 13)[1:-1]), max_size=4, unique=True).map(sorted)
    cuts = [np.concatenate([[0.0], draw(inner), [1.0]]) for _ in range(4)]
    s, t = ([a * (1.0 - x) + b * x for x in two] for a, b, two in ((s0, s1, cuts[:2]), (t0, t1, cuts[2:])))
    return tuple(tensor_grid(*pair) for pair in zip(s, t, strict=True))


pairs = st.one_of(strip_pairs(), bisection_pairs(), grid_pairs())


def blossoms_of_powers(knots_A5: np.ndarray) -> np.ndarray:
    """Coefficients (4, n_A) of 1, x, x^2, x^3: the polar forms at the three inner local knots (Ramshaw 1989)."""
    a, b, c = knots_A5[:, 1:4].T
    return np.stack([np.ones_like(a), (a + b + c) / 3.0, (a * b + b * c + c * a) / 3.0, a * b * c])


def powers(mesh) -> np.ndarray:
    """Control values (n_A, 16) of all products of powers up to the third, with no use of any Bezier element."""
    s, t = (blossoms_of_powers(knots) for knots in mesh.local_knots)
    return (s[:, None] * t[None]).reshape(16, -1).T


@some
@given(pairs)
def test_cubics_are_carried_over_exactly_whatever_the_meshes(pair):
    """Control values of a polynomial become those of the same polynomial: finer, coarser or neither."""
    old, new = pair
    found, exact = transfer(old, new) @ powers(old), powers(new)
    assert np.abs((found - exact) / np.abs(exact).max(0).clip(1e-300)).max() < 1e-11


@some
@given(pairs)
def test_a_mesh_to_itself_is_the_identity(pair):
    for mesh in pair:
        assert np.abs(transfer(mesh, mesh).toarray() - np.eye(len(mesh.anchors))).max() < 1e-11


@few
@given(markings(steps=3), st.integers(0, 2**32 - 1))
def test_a_rational_body_is_the_same_on_finer_meshes(drawn, seed):
    """Curved, with weights: its points by Cox-de Boor on the old knots and on the new ones."""
    (mesh, steps), rng = drawn, np.random.default_rng(seed)
    old, finer = mesh.tmesh, mesh
    for places in steps:
        finer = finer.refined(marked(finer, places))
    new = finer.tmesh
    x_A = greville(old)
    body = tspline_mesh(old, x_A + 0.1 * np.sin(3.0 * x_A[:, ::-1]), rng.uniform(0.5, 2.0, len(x_A)))
    other = transferred(old, body, new)
    corners = [(knots[0], knots[-1]) for knots in (old.knots_i, old.knots_j)]
    x_qi = np.stack([rng.uniform(*ends, 50) for ends in corners], -1)
    assert np.abs(walked_values(old, x_qi) - walked_values(new, x_qi) @ transfer(old, new)).max() < 1e-13
    before, after = (
        (walked_values(tmesh, x_qi) @ (m.w_A[:, None] * m.P_AI)) / (walked_values(tmesh, x_qi) @ m.w_A)[:, None]
        for tmesh, m in ((old, body), (new, other))
    )
    assert np.abs(after - before).max() < 1e-12 * np.abs(before).max()


def coarse(n: int):
    """A T-mesh of n x n elements on the unit square, bisected over and over in a band across its diagonal."""
    mesh = initial(np.linspace(0.0, 1.0, n + 1), np.linspace(0.0, 1.0, n + 1))
    for width in (0.2, 0.1):
        middle = mesh.box_ek.reshape(-1, 2, 2).mean(2)
        mesh = mesh.refined(np.flatnonzero(np.abs(middle.sum(1) - 1.0) < width))
    return mesh.tmesh


def test_the_functional_of_a_function_reads_no_further_than_its_support():
    """A control value of the new mesh depends on those old functions alone that live on one element of its support."""
    fine, mesh = tensor_grid(*(np.linspace(0.0, 1.0, 33),) * 2), coarse(4)
    matrix = transfer(fine, mesh)
    matrix.data[np.abs(matrix.data) < 1e-14] = 0.0
    matrix.eliminate_zeros()
    support = np.array([[k[0], k[-1]] for k in np.concatenate(mesh.local_knots)]).reshape(2, -1, 2)
    x = greville(fine)
    for A in range(len(mesh.anchors)):
        read = x[matrix.indices[matrix.indptr[A] : matrix.indptr[A + 1]]]
        for axis in (0, 1):
            low, high = support[axis, A]
            assert np.all(read[:, axis] >= low - 2.0 / 32) and np.all(read[:, axis] <= high + 2.0 / 32)


def test_points_on_lines_and_corners_belong_to_an_element_that_touches_them():
    mesh = coarse(4)
    box_ek = extracted(mesh).box_ek
    corners = np.stack([mesh.knots_i[box_ek[:, :2]], mesh.knots_j[box_ek[:, 2:]]], -1).reshape(-1, 2)
    assert np.abs(collocation(mesh, corners).sum(1) - 1.0).max() < 1e-14
    assert np.abs(collocation(mesh, corners) @ greville(mesh) - corners).max() < 1e-14


@pytest.mark.parametrize(("s", "t"), [((0.0, 2.0), (0.0, 1.0)), ((0.0, 1.0), (-1.0, 1.0))])
def test_other_domains_are_refused(s, t):
    old, new = tensor_grid(np.array([0.0, 1.0]), np.array([0.0, 1.0])), tensor_grid(np.array(s), np.array(t))
    with pytest.raises(ValueError, match="must share their domain"):
        transfer(old, new)
