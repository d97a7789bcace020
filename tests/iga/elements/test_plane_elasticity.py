"""Plane elasticity on every kind of mesh: patch tests, known solutions, rates of convergence."""

import numpy as np
import pytest
from boundary import boundary_chains
from iga_files import REAL, real
from knots import insert_knot
from plane_elasticity import (
    no_rigid_motion,
    prescribed,
    solve,
    stiffness,
    traction_forces,
)
from plane_fields import errors, kirsch, smooth, uniform
from tmeshes import half_fine
from unstructured import polygon_mesh

from iga.bases.bspline import KnotVector, open_knots
from iga.bases.names import BASES
from iga.bases.nurbs import nurbs_mesh, nurbs_rectangle
from iga.elements.elasticity import isotropic
from iga.files.iga_format import mesh as mesh_of
from iga.files.iga_reader import read_iga
from iga.mesh.bernstein import bernstein
from iga.mesh.extraction import ElementBlock, Mesh
from iga.tsplines.tspline import tspline_rectangle

SOLID = {"young": 100.0, "poisson": 0.3, "plane": "stress"}
D = isotropic(**SOLID)


def real_mesh(name):
    return mesh_of(read_iga(real(name)))


def ring(n, inner=1.0, outer=2.0):
    """Quarter of a ring in n x n bicubic elements: an exact cubic arc, its knots inserted."""
    r = np.sqrt(0.5)
    quadratic = np.array([[1, 0, 1], [r, r, r], [0, 1, 1]])  # homogeneous
    Q = np.array([quadratic[0], quadratic[0] + 2 * quadratic[1], quadratic[2] + 2 * quadratic[1], quadratic[2]])
    Q[1:3] /= 3.0
    kv = KnotVector(3, np.array([0, 0, 0, 0, 1, 1, 1, 1.0]))
    for x in np.linspace(0, 1, n + 1)[1:-1]:
        kv, T = insert_knot(kv, x)
        Q = T @ Q
    radial = open_knots(np.linspace(inner, outer, n + 1), 3)
    P = radial.greville[:, None] * (Q[:, :2] / Q[:, 2:])[:, None]
    return nurbs_mesh(radial, kv, P.reshape(-1, 2), np.repeat(Q[:, 2], radial.functions))


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


def square_mesh(n):
    return nurbs_rectangle(*[open_knots(np.linspace(0, 1, n + 1), 3)] * 2)


def by_tractions(mesh, exact, chains=None):
    chains = boundary_chains(mesh) if chains is None else chains
    u_Ai = solve(stiffness(mesh, D), traction_forces(mesh, chains, exact.traction), no_rigid_motion(mesh))
    return errors(mesh, D, u_Ai, exact, up_to_rigid=True)


def by_displacements(mesh, exact):
    u_Ai = solve(
        stiffness(mesh, D), np.zeros_like(mesh.P_AI), prescribed(mesh, boundary_chains(mesh), exact.displacement)
    )
    return errors(mesh, D, u_Ai, exact)


MESHES = {
    "nurbs": lambda: square_mesh(3),
    "ring": lambda: ring(3),
    "t-spline": lambda: tspline_rectangle(half_fine(4)),
    "triangle": lambda: polygon_mesh(3, 3),
    "pentagon": lambda: polygon_mesh(5, 3),
    "hexagon": lambda: polygon_mesh(6, 3),
    "two degrees": two_degrees,
}


@pytest.mark.parametrize("solved", [by_tractions, by_displacements])
@pytest.mark.parametrize("name", [*MESHES, *REAL])
def test_patch(name, solved):
    """Any constant stress is found exactly, whether it is asked for by tractions or by displacements."""
    mesh = MESHES[name]() if name in MESHES else real_mesh(name)
    found = solved(mesh, uniform(1.0, -0.4, 0.3, **SOLID))
    assert found.displacement < 1e-10 and found.energy < 1e-10 and found.stress < 1e-10


def rates(meshes, exact):
    """Errors of a family, and the rates of displacement and energy between its members by halves."""
    found = [by_tractions(mesh, exact) for mesh in meshes]
    table = np.array([(e.displacement, e.energy) for e in found])
    return table, np.log2(table[:-1] / table[1:])


EXACT = {
    "smooth": smooth(0.3 + 0.2j, 1.0, 1.0, **SOLID),
    "kirsch": kirsch(1.0, 1.0, **SOLID),
}


@pytest.mark.parametrize(
    ("family", "exact", "level"),
    [
        (square_mesh, "smooth", 5e-6),
        (lambda n: ring(2 * n), "kirsch", 2e-6),
        (lambda n: tspline_rectangle(half_fine(n)), "smooth", 5e-6),
        (lambda n: polygon_mesh(4, n // 2), "smooth", 3e-5),
    ],
    ids=["nurbs", "ring", "t-spline", "square around an ordinary point"],
)
def test_the_rate_is_optimal(family, exact, level):
    """Order p + 1 in L2 and p in energy."""
    meshes = [family(n) for n in (4, 8, 16)]
    table, found = rates(meshes, EXACT[exact])
    assert np.all(np.abs(found[:, 0] - meshes[0].order) < 0.35) and abs(found[-1, 0] - meshes[0].order) < 0.15
    assert abs(found[-1, 1] - (meshes[0].order - 1)) < 0.15
    assert table[-1, 0] < level


@pytest.mark.parametrize(
    ("kind", "degree"),
    [(kind, p) for kind, basis in BASES.items() for p in (1, 2, 4) if p in basis.degrees and not basis.local],
)
def test_every_basis_has_the_order_that_it_promises(kind, degree):
    breaks = (np.linspace(0.0, 1.0, n + 1) for n in (3, 6, 12))
    meshes = [BASES[kind].rectangle((degree, degree), along, along) for along in breaks]
    table, found = rates(meshes, EXACT["smooth"])
    assert [mesh.order for mesh in meshes] == [degree + 1] * 3
    assert np.all(np.abs(found[-1] - [degree + 1, degree]) < 0.1) and table[-1, 0] < 0.1 ** (degree + 1)


@pytest.mark.parametrize(("corners", "level"), [(3, 1.3e-5), (5, 2e-5), (6, 3e-5)])
def test_the_rate_at_an_extraordinary_point(corners, level):
    """2.5 in L2 and 1.5 in energy, whatever the valence: the elements at the point reproduce linear fields only.

    The stress is off by O(h) there, on an area O(h^2), while the other elements would give 4 and 3.
    """
    table, found = rates([polygon_mesh(corners, n) for n in (4, 8, 16)], smooth(0.1 + 0.2j, 2.0, 1.0, **SOLID))
    assert np.all(np.abs(found[:, 0] - 2.5) < 0.12) and np.all(np.abs(found[:, 1] - 1.5) < 0.12)
    assert table[-1, 0] < level
