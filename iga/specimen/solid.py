"""The solid specimen: the plane one over half of its width, from the middle (Z = 0) to the edge, and its bond.

It is a quarter of two equal arms: Z = 0 is a plane of symmetry, and the upper arm meets its mirror image on Y = 0. The
bond is a face of Gauss points, on which the gap is twice the displacement along the normal, in either kinematics.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from iga.bases.bspline import bezier_extraction, open_knots
from iga.elements.shape_functions import SideBasis, chain_basis
from iga.interface.contact import Contact, Rows
from iga.interface.interface import SettledInterface
from iga.interface.surface import EXTRACTED
from iga.mesh.extraction import Chain, Mesh, Spans, prism
from iga.mesh.quadrature import QUADRATURE, Rule, gauss, square
from iga.specimen.body import Body
from iga.specimen.bond import FACE_SAMPLES
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


def solid_bond(problem: Debonding, body: Body, extent: tuple[float, float]) -> SettledInterface:
    """The bond over an extent (from, to) along the specimen."""
    rule = QUADRATURE[problem.interface_rule](problem.interface_points)
    return _on_face(problem, body, _within(problem.pose, body, extent), rule, gauss(problem.degree_width + 1))


def solid_probe(problem: Debonding, body: Body, extent: tuple[float, float]) -> SettledInterface:
    """Points in the middle of the width, the ends of the bond first and last, in the order of ``extent``."""
    faces = _within(problem.pose, body, extent)
    X_f = problem.pose.own(_at(body, faces, 0.5, 0.0))[:, 0]
    middle = np.arange(0, len(X_f), len(breaks_across(problem)) - 1)
    ends = middle[[np.argmin(X_f[middle]), np.argmax(X_f[middle])]]
    place = np.array([0.0, 1.0]), np.ones(2)
    return _on_face(problem, body, _some(faces, ends), place, (np.zeros(1), np.ones(1)))


def solid_faces(problem: Debonding, body: Body, extent: tuple[float, float]) -> SettledInterface | None:
    """Samples of the faces from end to end; None where the opening never decreases."""
    if not unloads(problem):
        return None
    even = np.linspace(0.0, 1.0, FACE_SAMPLES), np.full(FACE_SAMPLES, 1.0 / FACE_SAMPLES)
    return _on_face(problem, body, _within(problem.pose, body, extent), even, even)


def longest_on_path(pose: Pose, body: Body, extent: tuple[float, float]) -> float:
    """Length of the longest element of the face along a part of the specimen."""
    faces = _within(pose, body, extent)
    start, end = (pose.own(_at(body, faces, at, 0.0))[:, 0] for at in (0.0, 1.0))
    return float(np.abs(end - start).max(initial=0.0))


def _within(pose: Pose, body: Body, extent: tuple[float, float]) -> Chain:
    """The faces of the upper arm on Y = 0 with their middle in an extent."""
    chain = body.mesh.chains["bottom"]
    X_f = pose.own(_at(body, chain, 0.5, 0.5))[:, 0]
    return _some(chain, np.flatnonzero((X_f > min(extent)) & (X_f < max(extent))))


def _some(chain: Chain, f: np.ndarray) -> Chain:
    return Chain(chain.block_c[f], chain.element_c[f], chain.side_c[f], chain.outward)


def _at(body: Body, faces: Chain, along_X: float, across: float) -> np.ndarray:
    """Place (n_f, 3) of a point on each of some faces."""
    (basis,) = chain_basis(body.mesh, faces, np.array([[along_X, across]]), np.ones(1))
    return basis.X_eqI[:, 0]


def _on_face(problem: Debonding, body: Body, faces: Chain, along_X: Rule, across: Rule) -> SettledInterface:
    """Points of a rule on each of some faces, which meet their mirror image."""
    (basis,) = chain_basis(body.mesh, faces, *square(along_X, across))
    (ahead_i, n_i) = problem.pose.axes_kI[:2]
    conn_qa, N_qa, dN_qa, X_qi = _living(basis, ahead_i)
    across_it = np.flatnonzero(np.abs(n_i) > SMALL_COMPONENT)  # the gap depends on no other components

    def gap_rows(by_qa: np.ndarray) -> Rows:
        dof_qai = 3 * conn_qa[..., None] + across_it
        return Rows(dof_qai.reshape(len(X_qi), -1), (2.0 * by_qa[..., None] * n_i[across_it]).reshape(len(X_qi), -1))

    closed_q, ahead = np.zeros(len(X_qi)), gap_rows(dN_qa)
    return SettledInterface(
        N_qa=N_qa,
        dN_qa=dN_qa,
        d2N_qa=np.zeros_like(dN_qa),
        conn_qa=conn_qa,
        dA_q=HALVES * basis.dV_eq.ravel(),
        X_qi=X_qi,
        P_AI=body.mesh.P_AI,
        law=problem.law,
        bonded_q=np.ones(len(X_qi), dtype=bool),
        forward_i=ahead_i,
        at_rest=Contact(None, closed_q, np.broadcast_to(n_i, X_qi.shape), closed_q + 1.0, gap_rows(N_qa)),
        by_length=(ahead, ahead),
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
