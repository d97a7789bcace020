"""The solid specimen: the plane one over half of its width, from the middle (Z = 0) to the edge, and its bond.

Z = 0 is a plane of symmetry. The bond is a face of Gauss points, which keep their partners. Of two equal arms that open
the upper one meets its mirror image on Y = 0, and the gap is twice the displacement along the normal in either
kinematics. Two bodies slide along X and Z; in finite kinematics their points search for the other body on lines
(`iga.interface.in_lines`).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from iga.bases.bspline import bezier_extraction, open_knots
from iga.elements.shape_functions import SideBasis, chain_basis
from iga.interface.contact import Contact, Rows
from iga.interface.in_lines import Lines, in_lines
from iga.interface.interface import FACES_TOUCH, Interface, SearchedInterface, SettledInterface
from iga.interface.slip_in_plane import LEAST_SLIP, InPlaneContact
from iga.interface.surface import EXTRACTED
from iga.mesh.bernstein import bernstein
from iga.mesh.extraction import Chain, Mesh, Spans, prism
from iga.mesh.quadrature import QUADRATURE, Rule, gauss, square
from iga.specimen.body import Body
from iga.specimen.bond import FACE_SAMPLES, FACING, Joint, bond, control_points, faces, probe
from iga.specimen.pose import Pose
from iga.specimen.problem import Debonding, unloads

#: Modelled parts of the width: the other one is its mirror image.
HALVES = 2.0
#: Components of a unit normal below it are rounding.
SMALL_COMPONENT = 1e-12


@dataclass(frozen=True)
class Across:
    """Elements across half of the width.

    ``graded``: length of the one in the middle over that at the edge, where the front turns. Where a problem does not
    say their number, the one at the edge is at most ``edge`` times the thickness of an arm long, and there are at most
    ``most``.
    """

    graded: float = 6.0
    edge: float = 0.5
    most: int = 40


ACROSS = Across()


def breaks_across(problem: Debonding) -> np.ndarray:
    """Element boundaries from Z = 0 to the edge, each element shorter than the one before by the same factor."""
    half, thickness = 0.5 * problem.width, min(body.thickness for body in problem.layout.bodies)

    def lengths(n: int) -> np.ndarray:
        sizes = np.geomspace(ACROSS.graded, 1.0, n) if n > 1 else np.ones(1)
        return half * sizes / sizes.sum()

    n = problem.elements_width
    if n is None:
        fine = (n for n in range(1, ACROSS.most) if lengths(n)[-1] <= ACROSS.edge * thickness)
        n = next(fine, ACROSS.most)
    return np.concatenate([[0.0], np.cumsum(lengths(n))[:-1], [half]])


def functions_across(problem: Debonding) -> int:
    """Number of functions from the middle to the edge."""
    return len(breaks_across(problem)) - 1 + problem.degree_width


def widened(problem: Debonding, mesh: Mesh) -> Mesh:
    """The solid of a plane mesh."""
    knots = open_knots(breaks_across(problem), problem.degree_width)
    first = knots.spans - problem.degree_width
    conn_ea = first[:, None] + np.arange(problem.degree_width + 1)
    return prism(mesh, Spans(bezier_extraction(knots), conn_ea), knots.greville)


def held_across(problem: Debonding, P_AI: np.ndarray) -> np.ndarray:
    """Mask (n_dof,) of the displacements across the width that are zero: in the middle, or everywhere."""
    fixed_Ai = np.zeros(P_AI.shape, dtype=bool)
    fixed_Ai[:, 2] = (P_AI[:, 2] == 0.0) | (problem.lateral == "held")
    return fixed_Ai.ravel()


def searches(problem: Debonding, parts: tuple[Body, ...]) -> bool:
    """Whether the points of two solids search for each other."""
    return len(parts) > 1 and problem.kinematics == "finite" and problem.search


class Met(NamedTuple):
    """Where the bodies meet: the bond, its ends, and samples of all faces (see `iga.specimen.specimen.Specimen`)."""

    bond: Interface
    probe: Interface
    faces: Interface | None


def met_on_lines(
    problem: Debonding, parts: tuple[Body, ...], meshes: tuple[Mesh, ...], touching: tuple[float, float] | None
) -> Met:
    """The plane specimen of plane ``meshes``, in its own frame, on lines at Gauss points across the width; its ends on
    the line in the middle."""
    flat = replace(problem, plane="strain", angle=0.0, mirror=False, shift=(0.0, 0.0))
    firsts = np.cumsum([0, *(len(mesh.P_AI) for mesh in meshes)])
    plane = tuple(Body(mesh, int(first), (), {}, np.eye(3)) for mesh, first in zip(meshes, firsts, strict=False))
    joint, extent = Joint.of(replace(flat, width=1.0), plane), problem.layout.bonded
    pairs, P_AI, pose = bond(joint, extent, touching), control_points(parts), problem.pose

    def lined(interface: Interface, rule: Rule, elements: slice = slice(None)) -> Interface:
        assert isinstance(interface, SearchedInterface)
        return in_lines(interface, _lines(problem, rule, elements), P_AI, pose.axes_kI, pose.origin)

    even = np.linspace(0.0, 1.0, FACE_SAMPLES), np.full(FACE_SAMPLES, 1.0 / FACE_SAMPLES)
    middle, sampled = (np.zeros(1), np.ones(1)), faces(joint, problem.layout.facing)
    return Met(
        lined(pairs, gauss(problem.degree_width + 1)),
        lined(probe(joint, extent, pairs), middle, slice(1)),
        None if sampled is None else lined(sampled, even),
    )


def _lines(problem: Debonding, rule: Rule, elements: slice) -> Lines:
    """Lines at the points of a rule on some of the elements across the width."""
    breaks, (at, weight) = breaks_across(problem), rule
    knots = open_knots(breaks, problem.degree_width)
    M_eqa = (bernstein(problem.degree_width, at) @ bezier_extraction(knots).swapaxes(1, 2))[elements]
    conn_ea = (knots.spans - problem.degree_width)[elements, None] + np.arange(problem.degree_width + 1)
    Z_eq = (M_eqa @ knots.greville[conn_ea][..., None])[..., 0]
    w_eq = HALVES * np.diff(breaks)[elements, None] * weight
    each = len(at)
    return Lines(
        Z_eq.ravel(), w_eq.ravel(), M_eqa.reshape(-1, M_eqa.shape[2]), np.repeat(conn_ea, each, 0), len(knots.greville)
    )


def solid_bond(
    problem: Debonding, parts: tuple[Body, ...], extent: tuple[float, float], touching: tuple[float, float] | None
) -> SettledInterface:
    """The bond over an extent (from, to) along the specimen; beyond it bodies may touch within ``touching``."""
    rule = QUADRATURE[problem.interface_rule](problem.interface_points)
    chains = _within(problem.pose, parts, touching or extent)
    found = _on_faces(problem, parts, chains, rule, gauss(problem.degree_width + 1))
    X_q = problem.pose.own(found.X_qi)[:, 0]
    return replace(found, bonded_q=(X_q > min(extent)) & (X_q < max(extent)))


def solid_probe(problem: Debonding, parts: tuple[Body, ...], extent: tuple[float, float]) -> SettledInterface:
    """Points in the middle of the width, the ends of the bond first and last, in the order of ``extent``."""
    chains = _within(problem.pose, parts, extent)
    X_f = problem.pose.own(_at(parts[0], chains[0], 0.5, 0.0))[:, 0]
    middle = np.arange(0, len(X_f), len(breaks_across(problem)) - 1)
    ends = middle[[np.argmin(np.abs(X_f[middle] - X)) for X in extent]]
    place = np.array([0.0, 1.0])[:: 1 if extent[0] < extent[1] else -1], np.ones(2)
    return _on_faces(problem, parts, tuple(_some(chain, ends) for chain in chains), place, (np.zeros(1), np.ones(1)))


def solid_faces(problem: Debonding, parts: tuple[Body, ...], extent: tuple[float, float]) -> SettledInterface | None:
    """Samples of the faces from end to end; None where the opening never decreases."""
    if not unloads(problem):
        return None
    even = np.linspace(0.0, 1.0, FACE_SAMPLES), np.full(FACE_SAMPLES, 1.0 / FACE_SAMPLES)
    return _on_faces(problem, parts, _within(problem.pose, parts, extent), even, even)


def longest_on_path(pose: Pose, body: Body, extent: tuple[float, float]) -> float:
    """Length of the longest element of the face along a part of the specimen."""
    (chain,) = _within(pose, (body,), extent)
    start, end = (pose.own(_at(body, chain, at, 0.0))[:, 0] for at in (0.0, 1.0))
    return float(np.abs(end - start).max(initial=0.0))


def _within(pose: Pose, parts: tuple[Body, ...], extent: tuple[float, float]) -> tuple[Chain, ...]:
    """The faces on Y = 0 of each body with their middle in an extent."""
    chains = []
    for body, side in zip(parts, FACING, strict=False):
        X_f = pose.own(_at(body, body.mesh.chains[side], 0.5, 0.5))[:, 0]
        chains.append(_some(body.mesh.chains[side], np.flatnonzero((X_f > min(extent)) & (X_f < max(extent)))))
    return tuple(chains)


def _some(chain: Chain, f: np.ndarray) -> Chain:
    return Chain(chain.block_c[f], chain.element_c[f], chain.side_c[f], chain.outward)


def _at(body: Body, chain: Chain, along_X: float, across: float) -> np.ndarray:
    """Place (n_f, 3) of a point on each of some faces."""
    (basis,) = chain_basis(body.mesh, chain, np.array([[along_X, across]]), np.ones(1))
    return basis.X_eqI[:, 0]


def _on_faces(
    problem: Debonding, parts: tuple[Body, ...], chains: tuple[Chain, ...], along_X: Rule, across: Rule
) -> SettledInterface:
    """Points of a rule on each of some faces of the upper body, which meet those of the lower one, or their mirror
    image.

    Raises
    ------
    ValueError : elements of the bodies that do not meet face to face.
    """
    axes_kI, P_AI, points = problem.pose.axes_kI, control_points(parts), square(along_X, across)
    sides = [chain_basis(body.mesh, chain, *points)[0] for body, chain in zip(parts, chains, strict=True)]
    conn_qa, N_qa, dN_qa, X_qi = _living(sides[0], axes_kI[0])
    both_qa, D_qa, dD_qa = conn_qa, 2.0 * N_qa, 2.0 * dN_qa
    if len(parts) > 1:
        below_qa, M_qa, dM_qa, Y_qi = _living(sides[1], axes_kI[0])
        if X_qi.shape != Y_qi.shape or np.abs(X_qi - Y_qi).max() > FACES_TOUCH * np.ptp(P_AI):
            raise ValueError("elements of two solids must meet face to face")
        both_qa = np.hstack([conn_qa, below_qa + parts[1].first])
        D_qa, dD_qa = np.hstack([N_qa, -M_qa]), np.hstack([dN_qa, -dM_qa])
    n_i, law = axes_kI[1], problem.law
    used_k = np.arange(3) if law.slides else np.flatnonzero(np.abs(n_i) > SMALL_COMPONENT)

    def rows(by_qa: np.ndarray, direction_i: np.ndarray) -> Rows:
        dof_qak, G_qak = 3 * both_qa[..., None] + used_k, by_qa[..., None] * direction_i[used_k]
        return Rows(dof_qak.reshape(len(X_qi), -1), G_qak.reshape(len(X_qi), -1))

    normals_qi, still_q = np.broadcast_to(n_i, X_qi.shape), np.zeros(len(X_qi))
    at_rest = Contact(None, still_q, normals_qi, still_q + 1.0, rows(D_qa, n_i))
    if law.slides:
        ways, least = (rows(D_qa, axes_kI[0]), rows(D_qa, axes_kI[2])), LEAST_SLIP * float(np.ptp(P_AI))
        at_rest = InPlaneContact.at_rest(normals_qi, at_rest.gap_rows, ways, least)
    return SettledInterface(
        N_qa=N_qa,
        dN_qa=dN_qa,
        d2N_qa=np.zeros_like(dN_qa),
        conn_qa=conn_qa,
        dA_q=HALVES * sides[0].dV_eq.ravel(),
        X_qi=X_qi,
        P_AI=P_AI,
        law=law,
        bonded_q=np.ones(len(X_qi), dtype=bool),
        forward_i=axes_kI[0],
        at_rest=at_rest,
        by_length=tuple(rows(dD_qa, axes_kI[k]) for k in (1, 0, 2)),
    )


def _living(basis: SideBasis, ahead_I: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Control points, functions and derivatives ahead (n_q, n_a) of those that do not vanish, and places (n_q, 3)."""
    alive_ea = np.abs(basis.N_eqa).max(1) > EXTRACTED
    n_e, n_q, _ = basis.N_eqa.shape
    a_ea = np.argsort(~alive_ea, axis=1, kind="stable")[:, : int(alive_ea.sum(1).max())]
    conn_ea = np.take_along_axis(basis.conn_ea, a_ea, axis=1)
    ahead_eqa = np.einsum("eqIa,I->eqa", basis.dN_eqIa, ahead_I)
    N_eqa, dN_eqa = (np.take_along_axis(v, a_ea[:, None], axis=2) for v in (basis.N_eqa, ahead_eqa))
    flat = n_e * n_q
    return (
        np.repeat(conn_ea, n_q, axis=0),
        N_eqa.reshape(flat, -1),
        dN_eqa.reshape(flat, -1),
        basis.X_eqI.reshape(flat, 3),
    )
