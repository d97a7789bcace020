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
from fem_reference.model.supports import Displacement
from fem_reference.problem.problem import Debonding
from fem_reference.problem.specimen import Face, Specimen

BOND = 1

#: Side of the interface that a body is on, and its sign in the jump.
BODY_SIDES = (("+", 1.0), ("-", -1.0))

#: Voigt order of the components of stress, by the number of directions.
STRESS_ORDER = {2: ((0, 0), (1, 1), (0, 1)), 3: ((0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1))}


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
    X-derivatives, where the bond slides or has a width; there also the Z-derivative follows that by X. ``weight`` and
    ``positions`` are integrals of 1 and of X and Z. Each test function is
    1 at one point for one of its ``per_point`` functionals, and 0 elsewhere.
    """

    functionals: list
    slopes: list | None
    weight: ufl.Form
    positions: list
    per_point: int


def bulk_points(degree: int) -> int:
    """Gauss points per direction in an element, exact for the quadratic part of the energy on rectangles.

    The quartic part of the energy is underintegrated; one more point changes no load by more than 1e-6 of it.
    """
    return degree + 1


def displacements(bodies: TwoBodies, degree: int) -> Displacement:
    """Vector Lagrange functions on the bodies."""
    shape = (bodies.parent.topology.dim,)
    return tuple(fem.Function(fem.functionspace(body.mesh, ("Lagrange", degree, shape))) for body in bodies.pair)


def weak_form(problem: Debonding, specimen: Specimen, bodies: TwoBodies, displacement: Displacement) -> WeakForm:
    """All forms of the problem; energies are those of the whole specimen, with what is a mirror image of the mesh.

    Materials and sizes enter as constants, so that the compiled forms are shared by all specimens of the same degree
    and kinematics.
    """
    domain, finite, copies = bodies.parent, problem.kinematics == "finite", specimen.copies
    V = ufl.MixedFunctionSpace(*(u.function_space for u in displacement))
    v, d = ufl.TestFunctions(V), ufl.TrialFunctions(V)
    width = constant(domain, problem.width / specimen.depth * copies)
    D = [constant(domain, body.D_IJ) for body in specimen.bodies]
    W = [energy_density(u_body, D_body, finite) for u_body, D_body in zip(displacement, D, strict=True)]
    dx, ds, _ = _measures(bodies, problem)

    def over_faces(density: Callable, part: Callable[[Face], float]) -> ufl.Form:
        """Sum over the end faces of the integral of a density, a function of the body, times a factor of the face."""
        return sum(constant(domain, part(face)) * density(face.body) * ds(i) for i, face in enumerate(specimen.faces))

    def per_length(face: Face) -> float:
        return face.load / specimen.bodies[face.body].thickness / specimen.depth

    stored = width * sum(W_body * dx(i) for i, W_body in enumerate(W))
    virtual_work = sum(ufl.derivative(stored, u, v_body) for u, v_body in zip(displacement, v, strict=True))
    tangent = sum(ufl.derivative(virtual_work, u, d_body) for u, d_body in zip(displacement, d, strict=True))
    return WeakForm(
        internal=ufl.extract_blocks(virtual_work),
        bulk=ufl.extract_blocks(tangent),
        load=ufl.extract_blocks(over_faces(lambda i: v[i][1], lambda face: copies * per_length(face))),
        slope=ufl.extract_blocks(over_faces(lambda i: v[i][1].dx(0), lambda face: abs(per_length(face)))),
        energy=stored,
        face_energy=over_faces(lambda i: W[i], lambda face: copies * face.energy / specimen.depth),
        maps=entity_maps(domain, (*bodies.pair, bodies.bond), bodies.interface_quads),
    )


def bond_forms(problem: Debonding, bodies: TwoBodies, displacement: Displacement) -> BondForms:
    """The forms of gap, jump and mean tangents. A point has one functional in mode I, as many as directions where the
    bond slides, and where kinematics is finite too as many again for each tangent."""
    slides, finite = problem.law.slides, problem.kinematics == "finite"
    dim = bodies.parent.topology.dim
    along = range(0, dim, 2)  # X and, of a solid, Z
    components = range(dim) if slides else (1,)
    count = len(components) * (1 + len(along) * (slides and finite))
    degree = 2 * problem.bond_points - 1
    point = basix.ufl.quadrature_element(bodies.bond.mesh.basix_cell(), value_shape=(count,), degree=degree)
    _, _, dS = _measures(bodies, problem)
    copies = 2.0 / len(displacement)

    def on(e: ufl.core.expr.Expr, side: str) -> ufl.core.expr.Expr:
        return e(side) if len(displacement) > 1 else e

    q = on(ufl.TestFunction(fem.functionspace(bodies.bond.mesh, point)), "+")

    def at_points(v: ufl.core.expr.Expr, body: int) -> ufl.Form:
        """Form of the functionals of ``v``, the displacements or their derivatives by X, the part of one body."""
        side, sign = BODY_SIDES[body]
        parts = [copies * sign * on(v[i], side) for i in components]
        if count > len(components):
            parts += [0.5 * on(v.dx(k)[i], side) for k in along for i in components]
        return ufl.inner(ufl.as_vector(parts), q) * dS(BOND)

    trials = [ufl.TrialFunction(u.function_space) for u in displacement]
    one = ufl.inner(ufl.as_vector([1.0] * count), q)
    X = on(ufl.SpatialCoordinate(bodies.parent), "+")
    return BondForms(
        functionals=[at_points(v, body) for body, v in enumerate(trials)],
        slopes=[at_points(v.dx(0), body) for body, v in enumerate(trials)] if slides or problem.solid else None,
        weight=one * dS(BOND),
        positions=[X[k] * one * dS(BOND) for k in along],
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
    E, order = strain(u, finite), STRESS_ORDER[len(u)]
    S = D * ufl.as_vector([E[i, j] if i == j else 2 * E[i, j] for i, j in order])
    return ufl.as_matrix([[S[order.index((min(i, j), max(i, j)))] for j in range(len(u))] for i in range(len(u))])


def energy_density(u: fem.Function, D: ufl.core.expr.Expr, finite: bool) -> ufl.core.expr.Expr:
    """W = 1/2 S : E, energy per reference volume."""
    return 0.5 * ufl.inner(second_stress(u, D, finite), strain(u, finite))


def cauchy_stress(u: fem.Function, D: ufl.core.expr.Expr, finite: bool) -> ufl.core.expr.Expr:
    """sigma = F S F^T / det F with the in-plane F (change of thickness neglected); S in linear kinematics."""
    if not finite:
        return second_stress(u, D, finite)
    F = ufl.Identity(len(u)) + ufl.grad(u)
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
        ufl.Measure("dS" if len(cells) > 1 else "ds", domain=bodies.parent, subdomain_data=quads, metadata=bond),
    )
