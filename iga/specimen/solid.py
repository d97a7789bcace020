"""The solid specimen: the plane one over half of its width, from the middle (Z = 0) to the edge, and its bond.

Z = 0 is a plane of symmetry. The bond is that of the plane specimen on lines at Gauss points across the width
(`iga.interface.in_lines`), whose points keep their partners or search for them as those of the plane do.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from iga.bases.bspline import bezier_extraction, open_knots
from iga.interface.in_lines import Lines, in_lines
from iga.interface.interface import Interface
from iga.mesh.bernstein import bernstein
from iga.mesh.extraction import Mesh, Spans, prism
from iga.mesh.quadrature import Rule, gauss
from iga.specimen.body import Body
from iga.specimen.bond import FACE_SAMPLES, Joint, bond, control_points, faces, probe
from iga.specimen.problem import Debonding

#: Modelled parts of the width: the other one is its mirror image.
HALVES = 2.0


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
    # with a search, by which all of the reference configuration is known
    flat = replace(problem, plane="strain", width=1.0, kinematics="finite", search=True)
    flat = replace(flat, angle=0.0, mirror=False, shift=(0.0, 0.0))
    firsts = np.cumsum([0, *(len(mesh.P_AI) for mesh in meshes)])
    plane = tuple(Body(mesh, int(first), (), {}, np.eye(3)) for mesh, first in zip(meshes, firsts, strict=False))
    joint, extent = Joint.of(flat, plane), problem.layout.bonded
    pairs, P_AI, pose = bond(joint, extent, touching), control_points(parts), problem.pose
    search = problem.kinematics == "finite" and problem.search

    def lined(interface: Interface, rule: Rule, elements: slice = slice(None)) -> Interface:
        return in_lines(interface, _lines(problem, rule, elements), P_AI, pose.axes_kI, pose.origin, search)

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
