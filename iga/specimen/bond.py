"""The bonded part of the interface between two bodies: quadrature points of the slave on the surface of the master."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from iga.interface.interface import Interface, settled
from iga.interface.laws import TractionLaw
from iga.interface.lumping import chained, lumped, paired
from iga.interface.surface import Surface
from iga.mesh.quadrature import QUADRATURE, Rule, gauss
from iga.specimen.body import Body
from iga.specimen.problem import Debonding, unloads

#: Surface by which each body, upper and lower, meets the other.
FACING = ("bottom", "top")

#: Samples of the gap on each side, where it is looked at whether faces pass through each other.
FACE_SAMPLES = 5

#: Part of a side that is too little to touch.
SLIVER = 1e-6


def bond(
    problem: Debonding,
    bodies: tuple[Body, ...],
    extent: tuple[float, float],
    touching: tuple[float, float] | None = None,
) -> Interface:
    """Interface over the ``extent`` (from, to) in the specimen's own coordinate along it; one body meets its mirror.

    Beyond the bond the bodies may touch from end to end of ``touching``, which holds the extent, at p + 1 points a
    side, which in lumped interfaces meet the same control points for good.
    """
    found = _bonded(problem, bodies, extent, touching)
    return settled(found) if stays(problem) else found


def _bonded(
    problem: Debonding, bodies: tuple[Body, ...], extent: tuple[float, float], touching: tuple[float, float] | None
) -> Interface:
    lumps, free = problem.interface_rule == "lumped", gauss(problem.degree + 1)
    held = _everywhere(
        problem, bodies, extent, free if lumps else QUADRATURE[problem.interface_rule](problem.interface_points)
    )
    parts = [held]
    if touching is not None:
        ends = (min(touching), min(extent)), (max(extent), max(touching))
        before, after = (_between(problem, bodies, part, free) for part in ends)
        parts = [part for part in (before, held, after) if len(part[0])]
    if lumps:
        found = [(lumped if part is held else paired)(_interface(problem, bodies, *part)) for part in parts]
    else:
        found = [_interface(problem, bodies, *(np.concatenate(values) for values in zip(*parts, strict=True)))]
    whole = chained(found)
    if touching is None:
        return whole
    points = [one.points for one in found] if lumps else [len(part[0]) for part in parts]
    return replace(whole, bonded_q=np.repeat([part is held for part in parts], points))


def stays(problem: Debonding) -> bool:
    """Whether closest points and normals stay what they are before anything moves."""
    return problem.kinematics == "linear" or not problem.search


def probe(problem: Debonding, bodies: tuple[Body, ...], extent: tuple[float, float], interface: Interface) -> Interface:
    """Points at the two ends of the bond, in the order of ``extent``; they meet the master beside the bond's own."""
    c = _bonded_sides(problem, bodies, extent)
    X_ck = _ends(problem, bodies)[c]
    at = np.array([np.argmin(np.abs(X_ck - X)) for X in extent])
    found = _interface(problem, bodies, c[at // 2], at % 2.0, np.full(2, 0.5))
    if interface.pairing is not None:
        found = replace(found, near=interface.pairing[interface.beside(found.X_qi)])
    return settled(found) if stays(problem) else found


def faces(problem: Debonding, bodies: tuple[Body, ...], extent: tuple[float, float]) -> Interface | None:
    """Samples from end to end of the faces that are opposite to each other, ends of elements included.

    None where the programme never goes down: no gap closes then.
    """
    if not unloads(problem):
        return None
    even = np.linspace(0.0, 1.0, FACE_SAMPLES), np.full(FACE_SAMPLES, 1.0 / FACE_SAMPLES)
    found = _interface(problem, bodies, *_between(problem, bodies, (min(extent), max(extent)), even))
    return settled(found) if stays(problem) else found


def _everywhere(
    problem: Debonding, bodies: tuple[Body, ...], extent: tuple[float, float], rule: Rule
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Sides c_q, parameters xi_q and weights w_q (n_q,) of a rule on every bonded side of the slave."""
    return everywhere(_bonded_sides(problem, bodies, extent), rule)


def _bonded_sides(problem: Debonding, bodies: tuple[Body, ...], extent: tuple[float, float]) -> np.ndarray:
    """Sides of the slave whose middle lies on the bond."""
    face, P_AI = _slave(problem, bodies), control_points(bodies)
    (middle,) = face.coefficients(np.arange(face.sides), np.full(face.sides, 0.5), 0)
    X_c = problem.pose.own(np.einsum("cb,cbi->ci", middle, face.bezier_points(P_AI)))[:, 0]
    return np.flatnonzero((X_c > min(extent)) & (X_c < max(extent)))


def _ends(problem: Debonding, bodies: tuple[Body, ...]) -> np.ndarray:
    """Where along the specimen the sides of the slave begin and end (n_c, 2)."""
    face, P_AI = _slave(problem, bodies), control_points(bodies)
    X_ckI = face.bezier_points(P_AI)[:, [0, -1]] / face.w_cb[:, [0, -1], None]
    return problem.pose.own(X_ckI)[..., 0]


def _between(
    problem: Debonding, bodies: tuple[Body, ...], part: tuple[float, float], rule: Rule
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The same on what lies of each side in a ``part`` of the specimen, as if its parameter ran evenly."""
    X_ck = _ends(problem, bodies)
    at_ck = np.clip((np.array(part) - X_ck[:, :1]) / (X_ck[:, 1:] - X_ck[:, :1]), 0.0, 1.0)
    start, length = at_ck.min(1), np.ptp(at_ck, axis=1)
    c_q, xi_q, w_q = everywhere(np.flatnonzero(length > SLIVER), rule)
    return c_q, start[c_q] + length[c_q] * xi_q, length[c_q] * w_q


def _interface(
    problem: Debonding, bodies: tuple[Body, ...], c_q: np.ndarray, xi_q: np.ndarray, w_q: np.ndarray
) -> Interface:
    face, P_AI, alone = _slave(problem, bodies), control_points(bodies), len(bodies) == 1
    master = None if alone else _facing(bodies, 1 - slave_number(problem, bodies))
    return replace(
        between(face, master, P_AI, problem.law, (c_q, xi_q, w_q), problem.width),
        mirror_i=problem.pose.axes_kI[1] if alone else None,
    )


def between(
    slave: Surface,
    master: Surface | None,
    P_AI: np.ndarray,
    law: TractionLaw,
    places: tuple[np.ndarray, np.ndarray, np.ndarray],
    width: float = 1.0,
) -> Interface:
    """Interface between any two surfaces, each a chain of element sides.

    Parameters
    ----------
    P_AI : (n_A, 2) control points of the whole model, in which both surfaces are numbered.
    places : sides c_q, parameters xi_q and weights w_q (n_q,) of the points on the slave (see `everywhere`).
    """
    c_q, xi_q, w_q = places
    r0, r1 = slave.coefficients(c_q, xi_q, 1)
    X_qi, tangent_qi = (np.einsum("qb,qbi->qi", r, slave.bezier_points(P_AI, c_q)) for r in (r0, r1))
    dA_q = np.linalg.norm(tangent_qi, axis=1) * w_q * width
    return Interface(slave.functions(c_q, r0), slave.conn_ca[c_q], dA_q, X_qi, P_AI, law, master)


def everywhere(c: np.ndarray, rule: Rule) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Sides, parameters and weights (n_q,) of the points of a rule on every one of some sides."""
    xi, w = rule
    return np.repeat(c, len(xi)), np.tile(xi, len(c)), np.tile(w, len(c))


def control_points(bodies: tuple[Body, ...]) -> np.ndarray:
    """Control points (n_A, 2) of the whole model, in place."""
    return np.concatenate([body.mesh.P_AI for body in bodies])


def slave_number(problem: Debonding, bodies: tuple[Body, ...]) -> int:
    """0 where the upper body's points are projected, 1 where the lower one's are."""
    return int(problem.slave == "lower" and len(bodies) > 1)


def _slave(problem: Debonding, bodies: tuple[Body, ...]) -> Surface:
    return _facing(bodies, slave_number(problem, bodies))


def _facing(bodies: tuple[Body, ...], number: int) -> Surface:
    return bodies[number].surface(FACING[number])
