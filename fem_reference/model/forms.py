"""The weak form: two elastic bodies, the bond between them, the load on their end faces."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import basix.ufl
import numpy as np
import ufl
from dolfinx import fem, mesh
from petsc4py import PETSc

from fem_reference.dolfinx_api import entity_maps
from fem_reference.model.mesh import TwoBodies
from fem_reference.problem.problem import Debonding
from fem_reference.problem.specimen import Face, Specimen

BOND = 1


@dataclass(frozen=True)
class WeakForm:
    """UFL forms on the parent mesh; lists are blocks (upper, lower).

    ``internal`` and ``bulk`` are the internal forces of the bodies and their tangent; ``load`` the nodal forces of a
    unit load; ``slope`` the mean du_y/dX of each loaded face as a functional; ``face_energy`` the strain energy on the
    end faces per unit width, signed as in the J-integral.
    """

    internal: list
    bulk: list
    load: list
    slope: list
    energy: ufl.Form
    face_energy: ufl.Form
    maps: object


class BondForms(NamedTuple):
    """Functionals of the displacements at the points of the interface, for `fem_reference.model.bond`.

    ``functionals`` (one row of blocks, bilinear) is the gap or, where the bond slides, the jump from the lower to the
    upper face and, where kinematics is finite too, the X-derivative of the mean of both faces; ``slopes`` their
    X-derivatives, where the bond slides. ``weight`` and ``position`` are integrals of 1 and of X. Each test function is
    1 at one point for one of its ``per_point`` functionals, and 0 elsewhere.
    """

    functionals: list
    slopes: list | None
    weight: ufl.Form
    position: ufl.Form
    per_point: int


def bulk_points(degree: int) -> int:
    """Gauss points per direction in an element, exact for the quadratic part of the energy on rectangles.

    The quartic part of the energy is underintegrated; one more point changes no load by more than 1e-6 of it.
    """
    return degree + 1


def displacements(bodies: TwoBodies, degree: int) -> tuple[fem.Function, fem.Function]:
    """Vector Lagrange functions on the upper and the lower body."""
    upper, lower = (fem.Function(fem.functionspace(body.mesh, ("Lagrange", degree, (2,)))) for body in bodies.pair)
    return upper, lower


def weak_form(
    problem: Debonding, specimen: Specimen, bodies: TwoBodies, displacement: tuple[fem.Function, fem.Function]
) -> WeakForm:
    """All forms of the problem.

    Materials and sizes enter as constants, so that the compiled forms are shared by all specimens of the same degree
    and kinematics.
    """
    domain, finite, (u, w) = bodies.parent, problem.kinematics == "finite", displacement
    V = ufl.MixedFunctionSpace(u.function_space, w.function_space)
    v, d = ufl.TestFunctions(V), ufl.TrialFunctions(V)
    width = constant(domain, problem.width)
    D = [constant(domain, body.D_IJ) for body in specimen.bodies]
    W = [energy_density(u_body, D_body, finite) for u_body, D_body in zip(displacement, D, strict=True)]
    dx, ds, _ = _measures(bodies, problem)

    def over_faces(density: Callable, part: Callable[[Face], float]) -> ufl.Form:
        """Sum over the end faces of the integral of a density, a function of the body, times a factor of the face."""
        return sum(constant(domain, part(face)) * density(face.body) * ds(i) for i, face in enumerate(specimen.faces))

    def per_length(face: Face) -> float:
        return face.load / specimen.bodies[face.body].thickness

    stored = width * (W[0] * dx(0) + W[1] * dx(1))
    virtual_work = ufl.derivative(stored, u, v[0]) + ufl.derivative(stored, w, v[1])
    tangent = ufl.derivative(virtual_work, u, d[0]) + ufl.derivative(virtual_work, w, d[1])
    return WeakForm(
        internal=ufl.extract_blocks(virtual_work),
        bulk=ufl.extract_blocks(tangent),
        load=ufl.extract_blocks(over_faces(lambda i: v[i][1], per_length)),
        slope=ufl.extract_blocks(over_faces(lambda i: v[i][1].dx(0), lambda face: abs(per_length(face)))),
        energy=stored,
        face_energy=over_faces(lambda i: W[i], lambda face: face.energy),
        maps=entity_maps(domain, (*bodies.pair, bodies.bond), bodies.interface_quads),
    )


def bond_forms(problem: Debonding, bodies: TwoBodies, displacement: tuple[fem.Function, fem.Function]) -> BondForms:
    """The forms of gap, jump and mean tangent. A point has one functional in mode I, two where the bond slides, four
    where kinematics is finite too."""
    slides, finite = problem.law.slides, problem.kinematics == "finite"
    components = (0, 1) if slides else (1,)
    count = 4 if slides and finite else len(components)
    degree = 2 * problem.bond_points - 1
    point = basix.ufl.quadrature_element("interval", value_shape=(count,), degree=degree)
    q = ufl.TestFunction(fem.functionspace(bodies.bond.mesh, point))("+")
    _, _, dS = _measures(bodies, problem)

    def at_points(v: ufl.core.expr.Expr, side: str, sign: float) -> ufl.Form:
        """Form of the functionals of ``v``, the displacements or their derivatives by X, the part of one body."""
        parts = [sign * v[i](side) for i in components]
        if count == 4:
            parts += [0.5 * v.dx(0)[i](side) for i in components]
        return ufl.inner(ufl.as_vector(parts), q) * dS(BOND)

    v, w = (ufl.TrialFunction(u.function_space) for u in displacement)
    one = ufl.inner(ufl.as_vector([1.0] * count), q)
    X = ufl.SpatialCoordinate(bodies.parent)("+")[0]
    return BondForms(
        functionals=[at_points(v, "+", 1.0), at_points(w, "-", -1.0)],
        slopes=[at_points(v.dx(0), "+", 1.0), at_points(w.dx(0), "-", -1.0)] if slides else None,
        weight=one * dS(BOND),
        position=X * one * dS(BOND),
        per_point=count,
    )


def constant(domain: mesh.Mesh, value: float | np.ndarray) -> fem.Constant:
    """A number or an array that a compiled form reads when it is assembled."""
    return fem.Constant(domain, np.asarray(value, dtype=PETSc.ScalarType))


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
    """sigma = F S F^T / det F with the in-plane F (change of thickness neglected); S in linear kinematics."""
    if not finite:
        return second_stress(u, D, finite)
    F = ufl.Identity(2) + ufl.grad(u)
    return F * second_stress(u, D, finite) * F.T / ufl.det(F)


def _measures(bodies: TwoBodies, problem: Debonding) -> tuple[ufl.Measure, ufl.Measure, ufl.Measure]:
    bulk = {"quadrature_degree": 2 * bulk_points(problem.degree) - 1}
    bond = {"quadrature_degree": 2 * problem.bond_points - 1}
    cells = list(enumerate(bodies.cells))
    faces = [(i, facets.ravel()) for i, facets in enumerate(bodies.faces)]
    quads = [(BOND, np.ascontiguousarray(bodies.interface_quads).ravel())]
    return (
        ufl.Measure("dx", domain=bodies.parent, subdomain_data=cells, metadata=bulk),
        ufl.Measure("ds", domain=bodies.parent, subdomain_data=faces, metadata=bulk),
        ufl.Measure("dS", domain=bodies.parent, subdomain_data=quads, metadata=bond),
    )
