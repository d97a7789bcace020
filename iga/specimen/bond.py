"""The bonded part of the interface between two bodies: quadrature points of the slave on the surface of the master."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from iga.interface.interface import Interface, SearchedInterface, paired, settled
from iga.interface.lumping import lumped
from iga.interface.surface import Surface
from iga.laws.law import Law
from iga.mesh.quadrature import QUADRATURE, Rule, gauss
from iga.specimen.body import Body
from iga.specimen.problem import Debonding, unloads

#: Sides c_q, parameters xi_q and weights w_q (n_q,) of points on a surface.
Places = tuple[np.ndarray, np.ndarray, np.ndarray]

#: Surface by which each body, upper and lower, meets the other.
FACING = ("bottom", "top")

#: Samples of the gap on each side, between which faces may pass through each other unnoticed.
FACE_SAMPLES = 5

#: Parts of a side that are shorter than this fraction of it have no points for contact.
SLIVER = 1e-6


@dataclass(frozen=True)
class Joint:
    """The surfaces at which the bodies meet, ``slave`` and ``master``; one body alone meets its mirror image.

    ``P_AI`` (n_A, 2) control points of the whole model, in which both surfaces are numbered; ``forward_i`` (2,) is the
    direction in which the slave slides where the upper body moves away from X = 0.
    """

    problem: Debonding
    slave: Surface
    master: Surface | None
    P_AI: np.ndarray
    forward_i: np.ndarray

    @staticmethod
    def of(problem: Debonding, bodies: tuple[Body, ...]) -> Joint:
        number = slave_number(problem, bodies)
        forward_i = problem.pose.axes_kI[0] * (1.0 if number == 0 else -1.0)
        surfaces = [body.surface(name) for body, name in zip(bodies, FACING, strict=False)]
        master = surfaces[1 - number] if len(bodies) > 1 else None
        return Joint(problem, surfaces[number], master, control_points(bodies), forward_i)

    @cached_property
    def ends_ck(self) -> np.ndarray:
        """Where along the specimen the sides of the slave begin and end (n_c, 2)."""
        X_ckI = self.slave.bezier_points(self.P_AI)[:, [0, -1]] / self.slave.w_cb[:, [0, -1], None]
        return self.problem.pose.own(X_ckI)[..., 0]

    def sides(self, extent: tuple[float, float]) -> np.ndarray:
        """Sides of the slave with their middle in an extent of the specimen."""
        every_c = np.arange(self.slave.sides)
        (middle,) = self.slave.coefficients(every_c, np.full(every_c.size, 0.5), 0)
        X_cI = np.einsum("cb,cbi->ci", middle, self.slave.bezier_points(self.P_AI))
        X_c = self.problem.pose.own(X_cI)[:, 0]
        return np.flatnonzero((X_c > min(extent)) & (X_c < max(extent)))

    def within(self, extent: tuple[float, float], rule: Rule) -> Places:
        """A rule on the part of each side that lies in an extent, as if its parameter ran evenly."""
        X_ck = self.ends_ck
        at_ck = np.clip((np.array(extent) - X_ck[:, :1]) / (X_ck[:, 1:] - X_ck[:, :1]), 0.0, 1.0)
        start, length = at_ck.min(1), np.ptp(at_ck, axis=1)
        c_q, xi_q, w_q = everywhere(np.flatnonzero(length > SLIVER), rule)
        return c_q, start[c_q] + length[c_q] * xi_q, length[c_q] * w_q

    def interface(self, places: Places) -> Interface:
        """The interface with points at these places."""
        problem = self.problem
        if self.master is not None:
            found = between(self.slave, self.master, self.P_AI, problem.law, places, problem.width)
            return replace(found, forward_i=self.forward_i)
        points = _points(self.slave, self.P_AI, places, problem.width)
        n_qi = np.broadcast_to(problem.pose.axes_kI[1], points["X_qi"].shape)
        return paired(points["conn_qa"], 2.0 * points["N_qa"], n_qi, law=problem.law, **points)

    def simulated(self, interface: Interface) -> Interface:
        """An interface with the pairs and normals of the reference configuration where the problem asks for these."""
        keeps = self.problem.kinematics == "linear" or not self.problem.search
        return settled(interface) if keeps else interface


def bond(joint: Joint, extent: tuple[float, float], touching: tuple[float, float] | None = None) -> Interface:
    """Interface over the ``extent`` (from, to) in the specimen's own coordinate along it.

    Beyond the bond the bodies may touch within the range ``touching``, which contains the extent, at p + 1 points on
    each side of an element. In lumped interfaces these points face fixed control points.
    """
    problem, free = joint.problem, gauss(joint.problem.degree + 1)
    lumps = problem.interface_rule == "lumped"
    rule = free if lumps else QUADRATURE[problem.interface_rule](problem.interface_points)
    parts = [(everywhere(joint.sides(extent), rule), True)]
    if touching is not None:
        before = joint.within((min(touching), min(extent)), free), False
        after = joint.within((max(extent), max(touching)), free), False
        parts = [part for part in (before, *parts, after) if len(part[0][0])]
    if lumps:
        found: Interface = lumped(*(_bonded(joint.interface(places), held) for places, held in parts))
    else:
        c_q, xi_q, w_q = (np.concatenate([places[i] for places, _ in parts]) for i in range(3))
        held_q = np.repeat([held for _, held in parts], [len(places[0]) for places, _ in parts])
        found = _bonded(joint.interface((c_q, xi_q, w_q)), held_q)
    return joint.simulated(found)


def probe(joint: Joint, extent: tuple[float, float], interface: Interface) -> Interface:
    """An interface of two points, the ends of the bond, in the order of ``extent``; they are searched for on the master
    from the pairing of the nearest points of the bond."""
    c = joint.sides(extent)
    X_ck = joint.ends_ck[c]
    at = np.array([np.argmin(np.abs(X_ck - X)) for X in extent])
    found = joint.interface((c[at // 2], at % 2.0, np.full(2, 0.5)))
    if isinstance(found, SearchedInterface) and interface.pairing is not None:
        found = replace(found, near=interface.pairing[interface.beside(found.X_qi)])
    return joint.simulated(found)


def faces(joint: Joint, extent: tuple[float, float]) -> Interface | None:
    """Samples from end to end of the faces that are opposite to each other, ends of elements included.

    None where the opening never decreases, so that no gap closes.
    """
    if not unloads(joint.problem):
        return None
    even = np.linspace(0.0, 1.0, FACE_SAMPLES), np.full(FACE_SAMPLES, 1.0 / FACE_SAMPLES)
    return joint.simulated(joint.interface(joint.within((min(extent), max(extent)), even)))


def between(
    slave: Surface, master: Surface, P_AI: np.ndarray, law: Law, places: Places, width: float = 1.0
) -> SearchedInterface:
    """Interface between any two surfaces, each a chain of element sides.

    Parameters
    ----------
    P_AI : (n_A, 2) control points of the whole model, in which both surfaces are numbered.
    places : points on the slave (see `everywhere`).
    """
    return SearchedInterface(**_points(slave, P_AI, places, width), law=law, master=master)


def _points(slave: Surface, P_AI: np.ndarray, places: Places, width: float) -> dict[str, Any]:
    """Fields of an `Interface` that its points alone determine."""
    c_q, xi_q, w_q = places
    r0, r1, r2 = slave.coefficients(c_q, xi_q, 2)
    jet = (np.einsum("qb,qbi->qi", r, slave.bezier_points(P_AI, c_q)) for r in (r0, r1, r2))
    X_qi, tangent_qi, bend_qi = jet
    m_q1 = np.sum(tangent_qi**2, axis=1)[:, None]
    faster_q1 = np.sum(tangent_qi * bend_qi, axis=1)[:, None] / m_q1  # logarithmic derivative of the speed
    return {
        "N_qa": slave.functions(c_q, r0),
        "dN_qa": slave.functions(c_q, r1 / m_q1**0.5),
        "d2N_qa": slave.functions(c_q, (r2 - faster_q1 * r1) / m_q1),
        "conn_qa": slave.conn_ca[c_q],
        "dA_q": np.linalg.norm(tangent_qi, axis=1) * w_q * width,
        "X_qi": X_qi,
        "P_AI": P_AI,
        "bonded_q": np.ones(len(c_q), dtype=bool),
        "forward_i": np.array([1.0, 0.0]),
    }


def _bonded(interface: Interface, held_q: np.ndarray | bool) -> Interface:
    return replace(interface, bonded_q=np.broadcast_to(held_q, interface.dA_q.shape))


def everywhere(c: np.ndarray, rule: Rule) -> Places:
    """The points of a rule on every one of some sides c."""
    xi, w = rule
    return np.repeat(c, len(xi)), np.tile(xi, len(c)), np.tile(w, len(c))


def control_points(bodies: tuple[Body, ...]) -> np.ndarray:
    """Control points (n_A, 2) of the whole model, in place."""
    return np.concatenate([body.mesh.P_AI for body in bodies])


def slave_number(problem: Debonding, bodies: tuple[Body, ...]) -> int:
    """0 where the upper body's points are projected, 1 where the lower one's are."""
    return int(problem.slave == "lower" and len(bodies) > 1)
