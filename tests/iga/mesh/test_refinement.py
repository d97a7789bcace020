"""Refinement of extracted meshes: same geometry, a larger space, hanging nodes cut through, edges that add up."""

from dataclasses import replace

import numpy as np
import pytest
from boundary import boundary_chains
from hypothesis import given
from random_tmeshes import suitable_tmeshes
from refinement import bezier_refined, conforming, halved
from tmeshes import half_fine
from unstructured import polygon_mesh

from iga.bases.bspline import KnotVector, open_knots
from iga.bases.nurbs import nurbs_mesh, nurbs_rectangle
from iga.elements.shape_functions import block_basis
from iga.mesh.bernstein import bernstein
from iga.mesh.edges import element_sides
from iga.mesh.extraction import ElementBlock, Mesh
from iga.mesh.quadrature import gauss, square
from iga.tsplines.tspline import tspline_rectangle


def area(mesh):
    rule = square(gauss(14), gauss(14))
    return sum(np.sum(block_basis(mesh, block, *rule).dV_eq) for block in mesh.blocks)


def annulus(n=3):
    """A quarter of a ring from radius 1 to 2, exact: a quadratic rational arc."""
    kv_s, kv_t = open_knots(np.linspace(0, 1, 2), 2), open_knots(np.linspace(0, 1, n + 1), 2)
    radius = 1.0 + kv_t.greville
    arc, w = np.array([[1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]), np.array([1.0, np.sqrt(0.5), 1.0])
    P = radius[:, None, None] * arc[::-1]
    return nurbs_mesh(kv_s, kv_t, P.reshape(-1, 2), np.tile(w, len(radius)))


def places(mesh, points):
    """Places (n_e, n_q, 2) of the same points of all elements, block by block."""
    weights = np.ones(len(points))
    return np.concatenate([block_basis(mesh, block, points, weights).X_eqI for block in mesh.blocks])


def moments(mesh):
    """Integrals of 1, x, y, x^2, x y, y^2 over a mesh without weights."""
    rule = square(gauss(8), gauss(8))
    parts = [block_basis(mesh, block, *rule) for block in mesh.blocks]
    x, y = np.concatenate([part.X_eqI.reshape(-1, 2) for part in parts]).T
    return np.stack([x**0, x, y, x * x, x * y, y * y]) @ np.concatenate([part.dV_eq.ravel() for part in parts])


def lonely(mesh):
    """How many sides share their edge with no other."""
    return len(element_sides(mesh).lone)


def two_degrees():
    """A bicubic square and a biquartic rectangle, joined C0."""
    cubic = nurbs_rectangle(open_knots(np.array([0.0, 1.0]), 3), open_knots(np.array([0.0, 1.0]), 3))
    elevated = np.linalg.inv(bernstein(4, np.linspace(0, 1, 5))) @ bernstein(3, np.linspace(0, 1, 5))  # (5, 4)
    trace = 4 * np.arange(4) + 3
    P, n = [cubic.P_AI], 16
    conn, C = list(trace), np.zeros((4 + 20, 25))
    C[:4, ::5] = elevated.T
    for row, (j, i) in enumerate(np.ndindex(5, 4)):
        P.append([[1 + (i + 1) / 2, j / 4]])
        conn.append(n)
        C[4 + row, 5 * j + i + 1] = 1.0
        n += 1
    left = cubic.blocks[0]
    right = ElementBlock((4, 4), C[None], np.array(conn)[None])
    return Mesh(np.concatenate(P), np.ones(n), (left, right))


def in_two_blocks(mesh):
    """The same mesh with the first third of its elements in a block of its own."""
    (block,), third = mesh.blocks, mesh.elements // 3
    parts = (slice(None, third), slice(third, None))
    blocks = tuple(ElementBlock(block.degrees, block.C_eab[part], block.conn_ea[part]) for part in parts)
    return replace(mesh, blocks=blocks, chains={})


MESHES = {
    "nurbs": lambda: nurbs_rectangle(
        KnotVector(3, np.array([0, 0, 0, 0, 1, 2, 2, 2, 5, 5, 5, 5.0])), open_knots(np.array([0, 0.2, 1]), 3)
    ),
    "linear across": lambda: nurbs_rectangle(
        open_knots(np.array([0.0, 1.0, 3.0]), 3), open_knots(np.linspace(0.0, 2.0, 3), 1)
    ),
    "annulus": annulus,
    "pentagon": lambda: polygon_mesh(5, 3),
    "t-spline": lambda: in_two_blocks(tspline_rectangle(half_fine(6))),
    "two degrees": two_degrees,
}


@pytest.mark.parametrize("name", MESHES)
def test_the_geometry_stays_and_with_it_every_field(name, rng):
    """Random control points and weights are a random field: that it is met exactly is that the spaces are nested."""
    mesh = MESHES[name]()
    refined = bezier_refined(mesh)
    assert area(refined) == pytest.approx(area(mesh), rel=1e-13)
    field = replace(mesh, P_AI=mesh.P_AI + 0.01 * rng.standard_normal(mesh.P_AI.shape))
    polynomial = replace(field, w_A=np.ones(len(mesh.w_A)))
    assert moments(bezier_refined(polynomial)) == pytest.approx(moments(polynomial), rel=1e-12)
    field, points = replace(field, w_A=mesh.w_A * rng.uniform(0.5, 2.0, mesh.w_A.shape)), rng.random((9, 2))
    before, after = (places(body, points) for body in (halved(conforming(field)), bezier_refined(field)))
    assert np.max(np.abs(before - after)) < 1e-13
    degree = max(max(block.degrees) for block in mesh.blocks)
    assert refined.blocks[0].degrees == (degree, degree)


@pytest.mark.parametrize("n", [2, 4, 8])
def test_hanging_nodes_are_cut_through(n):
    """The lines of the lower half go on to the top."""
    mesh = tspline_rectangle(half_fine(n))
    found = conforming(mesh)
    full = 2 * n * (n + n // 2)
    assert found.elements == full and lonely(found) == 2 * (2 * n + n + n // 2)
    assert (mesh.elements < full) == (n > 4), "the extensions alone reach two rows up"


def test_hanging_nodes_of_different_levels():
    """Long elements beside short ones, over two rows: 1 : 3 : 6."""
    mesh = _rows_of(np.array([1, 3, 6]))
    assert lonely(mesh) > 2 * 3 + 1 + 6
    found = conforming(mesh)
    assert found.elements == 18 and lonely(found) == 2 * 6 + 2 * 3
    assert area(bezier_refined(mesh, 0)) == pytest.approx(3.0, rel=1e-14)
    assert [len(chain.side_c) for chain in boundary_chains(mesh)] == [1 + 6 + 2 * 3]
    assert len(np.unique(element_sides(mesh).hanging[:, 0])) == 2 + 3


@given(suitable_tmeshes())
def test_elements_of_any_t_mesh_are_a_conforming_disk(mesh):
    """Vertices, edges and elements add up by Euler's formula, and the space of the T-spline is still there."""
    body = tspline_rectangle(mesh)
    found = conforming(body)
    sides = element_sides(found)
    vertices, edges = sides.vertex_kv.max() + 1, sides.edge_k.max() + 1
    assert vertices - edges + found.elements == 1
    assert np.all(np.bincount(sides.edge_k) <= 2)
    refined = bezier_refined(body, 0)
    assert area(refined) == pytest.approx(area(body), rel=1e-12)


def _rows_of(counts):
    """Rows of linear elements on the span of the first one's functions: constant and linear along the row."""
    C, conn = [], []
    P = np.array([(x, y) for y in range(len(counts) + 1) for x in (0.0, 1.0)])
    for y, count in enumerate(counts):
        for e in range(count):
            ends = np.array([e, e + 1.0]) / count
            along = np.stack([1 - ends, ends])  # functions x Bernstein
            C.append(np.kron(np.eye(2), along))
            conn.append(2 * y + np.arange(4))
    return Mesh(P, np.ones(len(P)), (ElementBlock((1, 1), np.array(C), np.array(conn)),))


def test_edges_with_the_same_ends_are_told_apart():
    """Two halves of a ring: the two arcs of the hole have the same ends."""
    arc = np.array([(1.0, 0.0), (0.0, 2.0), (-1.0, 0.0)])
    P_AI = np.concatenate([2.0 * arc, arc, -2.0 * arc[1:2], -arc[1:2]])
    conn_ea = np.array([[0, 1, 2, 3, 4, 5], [2, 6, 0, 5, 7, 3]])
    ring = Mesh(P_AI, np.ones(8), (ElementBlock((2, 1), np.broadcast_to(np.eye(6), (2, 6, 6)), conn_ea),))
    assert lonely(ring) == 4 and [len(chain.side_c) for chain in boundary_chains(ring)] == [2, 2]
    assert area(bezier_refined(ring, 0)) == pytest.approx(area(ring), rel=1e-14)


def test_a_crack_is_not_healed():
    """Two squares that touch: apart while they have control points of their own, one where they share them."""
    one = nurbs_rectangle(open_knots(np.array([0.0, 1.0]), 3), open_knots(np.array([0.0, 1.0]), 3))
    P = np.concatenate([one.P_AI, one.P_AI + [1.0, 0.0]])
    block = one.blocks[0]
    C, conn = np.concatenate([block.C_eab] * 2), np.concatenate([block.conn_ea, block.conn_ea + 16])
    apart = Mesh(P, np.ones(32), (ElementBlock((3, 3), C, conn),))
    joined = conn.copy()
    joined[1, ::4] = conn[0, 3::4]
    together = replace(apart, blocks=(ElementBlock((3, 3), C, joined),))
    assert [len(chain.side_c) for chain in boundary_chains(apart)] == [4, 4]
    assert [len(chain.side_c) for chain in boundary_chains(together)] == [6]
    assert len(bezier_refined(apart).P_AI) == 2 * 49 and len(bezier_refined(together).P_AI) == 2 * 49 - 7


def test_coefficients_of_nine_digits_still_join():
    body = tspline_rectangle(half_fine(8))
    blocks = tuple(replace(block, C_eab=np.round(block.C_eab, 9)) for block in body.blocks)
    rounded = replace(body, blocks=blocks, P_AI=np.round(body.P_AI, 9))
    assert len(bezier_refined(rounded, 0).P_AI) == len(bezier_refined(body, 0).P_AI) == (3 * 16 + 1) * (3 * 12 + 1)
