"""The weak form: two elastic bodies, the bond between them, the load on their end faces."""

from __future__ import annotations

from dataclasses import dataclass

import basix.ufl
import numpy as np
import ufl
from dolfinx import fem
from petsc4py import PETSc

from fem_reference.dolfinx_api import entity_maps
from fem_reference.mesh import TwoBodies
from fem_reference.problem import Problem

UPPER, LOWER, BOND = 1, 2, 1


@dataclass(frozen=True)
class WeakForm:
    """UFL forms on the parent mesh; lists are blocks (upper, lower).

    ``internal`` and ``bulk`` are the internal forces of the arms and their tangent; ``load`` the face forces of a unit
    load; ``slope`` the mean du_y/dX of each face as a functional. ``gap`` (one row of blocks), ``weight`` and
    ``position`` are integrals over the bond against functions that are 1 at one of its quadrature points: of the gap as
    a bilinear form, of 1 and of X.
    """

    internal: list
    bulk: list
    load: list
    slope: list
    energy: ufl.Form
    face_energy: ufl.Form
    gap: list
    weight: ufl.Form
    position: ufl.Form
    maps: object


def bulk_points(degree: int) -> int:
    """Gauss points a direction in an element: exact for the linear part on rectangles.

    The quartic part of the energy is integrated less than exactly; a point more moves no load by 1e-6 of itself.
    """
    return degree + 1


def bond_points(degree: int) -> int:
    """Gauss points on an element of the bond: more than smooth tractions need, since the law has kinks inside."""
    return degree + 3


def displacements(bodies: TwoBodies, degree: int) -> tuple[fem.Function, fem.Function]:
    """Vector Lagrange functions, upper and lower arm."""
    upper, lower = (
        fem.Function(fem.functionspace(body.mesh, ("Lagrange", degree, (2,)))) for body in (bodies.upper, bodies.lower)
    )
    return upper, lower


def weak_form(problem: Problem, bodies: TwoBodies, displacement: tuple[fem.Function, fem.Function]) -> WeakForm:
    """All forms of the problem.

    Material and sizes enter as constants: one compiled form serves every problem of the same degree and kinematics.
    """
    domain, finite, (u, w) = bodies.parent, problem.kinematics == "finite", displacement
    V = ufl.MixedFunctionSpace(u.function_space, w.function_space)
    (v_u, v_w), (d_u, d_w) = ufl.TestFunctions(V), ufl.TrialFunctions(V)
    point = basix.ufl.quadrature_element("interval", degree=2 * bond_points(problem.degree) - 1)
    q = ufl.TestFunction(fem.functionspace(bodies.bond.mesh, point))("+")
    width = fem.Constant(domain, PETSc.ScalarType(problem.width))
    face = fem.Constant(domain, PETSc.ScalarType(problem.arm_thickness))
    D = fem.Constant(domain, problem.elasticity_IJ.astype(PETSc.ScalarType))
    dx, ds, dS = _measures(bodies, problem.degree)

    stored = width * (energy_density(u, D, finite) * dx(UPPER) + energy_density(w, D, finite) * dx(LOWER))
    virtual_work = ufl.derivative(stored, u, v_u) + ufl.derivative(stored, w, v_w)
    tangent = ufl.derivative(virtual_work, u, d_u) + ufl.derivative(virtual_work, w, d_w)
    return WeakForm(
        internal=ufl.extract_blocks(virtual_work),
        bulk=ufl.extract_blocks(tangent),
        load=ufl.extract_blocks(v_u[1] / face * ds(UPPER) - v_w[1] / face * ds(LOWER)),
        slope=ufl.extract_blocks(v_u[1].dx(0) / face * ds(UPPER) + v_w[1].dx(0) / face * ds(LOWER)),
        energy=stored,
        face_energy=energy_density(u, D, finite) * ds(UPPER) + energy_density(w, D, finite) * ds(LOWER),
        gap=[
            ufl.TrialFunction(u.function_space)("+")[1] * q * dS(BOND),
            -ufl.TrialFunction(w.function_space)("-")[1] * q * dS(BOND),
        ],
        weight=q * dS(BOND),
        position=ufl.SpatialCoordinate(domain)("+")[0] * q * dS(BOND),
        maps=entity_maps(domain, (bodies.upper, bodies.lower, bodies.bond), bodies.interface_quads),
    )


def strain(u: fem.Function, finite: bool) -> ufl.core.expr.Expr:
    """Green-Lagrange strain, or its linear part."""
    H = ufl.grad(u)
    return 0.5 * (H + H.T + H.T * H) if finite else 0.5 * (H + H.T)


def second_stress(u: fem.Function, D: ufl.core.expr.Expr, finite: bool) -> ufl.core.expr.Expr:
    """S = D : E of the St. Venant-Kirchhoff material."""
    E = strain(u, finite)
    S = D * ufl.as_vector([E[0, 0], E[1, 1], 2 * E[0, 1]])
    return ufl.as_matrix([[S[0], S[2]], [S[2], S[1]]])


def energy_density(u: fem.Function, D: ufl.core.expr.Expr, finite: bool) -> ufl.core.expr.Expr:
    """W = 1/2 S : E, energy per reference volume."""
    return 0.5 * ufl.inner(second_stress(u, D, finite), strain(u, finite))


def cauchy_stress(u: fem.Function, D: ufl.core.expr.Expr, finite: bool) -> ufl.core.expr.Expr:
    """sigma = F S F^T / det F with the in-plane F (the sheet's change of thickness left out); S where linear."""
    if not finite:
        return second_stress(u, D, finite)
    F = ufl.Identity(2) + ufl.grad(u)
    return F * second_stress(u, D, finite) * F.T / ufl.det(F)


def _measures(bodies: TwoBodies, degree: int) -> tuple[ufl.Measure, ufl.Measure, ufl.Measure]:
    bulk = {"quadrature_degree": 2 * bulk_points(degree) - 1}
    bond = {"quadrature_degree": 2 * bond_points(degree) - 1}
    cells = [(UPPER, bodies.upper_cells), (LOWER, bodies.lower_cells)]
    faces = [(UPPER, bodies.upper_face.ravel()), (LOWER, bodies.lower_face.ravel())]
    quads = [(BOND, np.ascontiguousarray(bodies.interface_quads).ravel())]
    return (
        ufl.Measure("dx", domain=bodies.parent, subdomain_data=cells, metadata=bulk),
        ufl.Measure("ds", domain=bodies.parent, subdomain_data=faces, metadata=bulk),
        ufl.Measure("dS", domain=bodies.parent, subdomain_data=quads, metadata=bond),
    )
