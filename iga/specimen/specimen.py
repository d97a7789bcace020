"""A discrete specimen: its system, its bodies, and what evaluates its states.

The dead load acts on a whole end face, at its corner away from the interface, or in its middle.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from iga.elements.bulk import Solid, joined
from iga.interface.interface import Interface
from iga.interface.surface import surface
from iga.mesh.extraction import Mesh
from iga.specimen.body import Body, bodies, mean_row, slope_row
from iga.specimen.bond import FACING, Joint, bond, control_points, faces, probe, slave_number
from iga.specimen.layout import Layout, Load
from iga.specimen.patch import PatchRows, patch_rows
from iga.specimen.pose import Pose
from iga.specimen.problem import Debonding, smooth, touches
from iga.specimen.solid import HALVES, Met, held_across, met_on_lines, widened
from iga.system.bulk import BULKS, ElementBulk
from iga.system.system import System
from iga.tsplines.tmesh import TMesh

#: Parameters on a side of a face at which a point load may act: both ends, and the middle.
PLACES = 257


def pulled_row(body: Body, end: str, at: str, pose: Pose, axis: int, n_dof: int) -> np.ndarray:
    """Row (n_dof,) of the displacement at the load of a body, along (0) or across (1) the specimen.

    Parameters
    ----------
    end : the loaded face, "left" or "right".
    at : "face" (mean over the face), "node" (its corner away from the interface) or "hinge" (mid-thickness).
    """
    direction_i = pose.axes_kI[axis]
    if at == "face":
        return mean_row(body.ends[end], direction_i, n_dof)
    face = body.surface(end)
    c_q = np.repeat(np.arange(face.sides), PLACES)
    (r_qb,) = face.coefficients(c_q, np.tile(np.linspace(0.0, 1.0, PLACES), face.sides), 0)
    N_qa, conn_qa = face.functions(c_q, r_qb), face.conn_ca[c_q]
    X_qI = np.einsum("qa,qaI->qI", N_qa, body.mesh.P_AI[conn_qa - body.first])
    height_q = np.abs(pose.own(X_qI)[:, 1])
    place = height_q.max() if at == "node" else 0.5 * (height_q.min() + height_q.max())
    q = int(np.argmin(np.abs(height_q - place)))
    row_Ai = np.zeros((n_dof // 2, 2))
    row_Ai[conn_qa[q]] = N_qa[q, :, None] * direction_i
    return row_Ai.ravel()


@dataclass(frozen=True)
class Drawn:
    """Meshes of the modelled bodies in the specimen's own frame, upper first, and T-meshes of T-splines.

    They are made for a crack that ends at the distance ``path_end`` from the loaded end.
    """

    meshes: tuple[Mesh, ...]
    tmeshes: tuple[TMesh, ...]
    path_end: float


@dataclass(frozen=True)
class Supports:
    """What holds a specimen: springs of stiffness spring_r (n_r,) on the displacements ``springs_rd @ u``, and clamps.

    ``free_d`` (n_dof,) is False where a degree of freedom is fixed. ``rollers`` are the supports of the layout, whose
    springs come first.
    """

    springs_rd: np.ndarray
    spring_r: np.ndarray
    free_d: np.ndarray
    rollers: tuple[PatchRows, ...] = ()


@dataclass(frozen=True)
class Specimen:
    """A system, its bodies (upper first), pose, layout, and meshes in the specimen's own frame.

    ``copies`` is the number of parts like the modelled one: 2 where one body represents both, 4 of a solid, of whose
    width a half is modelled. ``load_at`` is where on the end face the load acts (see
    `pulled_row`). ``probe`` has two points, at the tip and at the far end of the bond. ``faces`` are samples of
    all facing surfaces, bonded or not; None where the programme cannot close them. ``ends`` are the end faces as a bulk
    of elements, with the sign of their strain energy in the J-integral. ``rollers`` are the rows of the layout's
    supports.
    """

    system: System
    bodies: tuple[Body, ...]
    pose: Pose
    layout: Layout
    drawn: Drawn
    copies: float
    width: float
    load_at: str
    upper_is_slave: bool
    probe: Interface
    faces: Interface | None
    ends: ElementBulk
    rollers: tuple[PatchRows, ...] = ()

    @property
    def meshes(self) -> tuple[Mesh, ...]:
        return tuple(body.mesh for body in self.bodies)

    @cached_property
    def slope_rows(self) -> tuple[np.ndarray, ...]:
        """Rows (n_dof,) of the mean slopes of the bodies' loaded faces, zero without one."""
        n, axes_kI = self.system.n_dof, self.pose.axes_kI
        loads = (self.layout.load_on(number) for number in range(len(self.bodies)))
        return tuple(
            np.zeros(n) if load is None else slope_row(body.ends[load.side], axes_kI[0], axes_kI[1], n)
            for body, load in zip(self.bodies, loads, strict=True)
        )

    @cached_property
    def loads(self) -> tuple[PatchRows, ...]:
        """Rows of the loads on the modelled bodies."""
        acting = [load for load in self.layout.loads if load.body is None or load.body < len(self.bodies)]
        return tuple(patch_rows(self.bodies, load, self.pose, self.system.n_dof) for load in acting)

    @cached_property
    def sampled(self) -> tuple[Solid, ...]:
        """All blocks on a grid of points an element, for pictures."""
        return joined([solid for body in self.bodies for solid in body.sampled])

    @cached_property
    def sampled_places(self) -> tuple[np.ndarray, ...]:
        """Places of these points (n_e, n_q, d) in the specimen's own frame."""
        return tuple(self.pose.own(solid.basis.X_eqI) for solid in self.sampled)

    @cached_property
    def face_row(self) -> np.ndarray:
        """Row (n_dof,) of the displacement along the specimen at the load on the upper body."""
        load = self.layout.loads[0]
        return pulled_row(self.bodies[load.body or 0], load.side, self.load_at, self.pose, 0, self.system.n_dof)

    @cached_property
    def beside_probe(self) -> np.ndarray:
        """Points of the interface nearest to those of the probe: their search starts there."""
        return self.system.interface.beside(self.probe.X_qi)

    @cached_property
    def ordered(self) -> tuple[np.ndarray, np.ndarray]:
        """Distances (n_q,) of the interface's points, rising, and the points in this order."""
        s_q = self.distance(self.system.interface.X_qi)
        order = np.argsort(s_q)
        return s_q[order], order

    @cached_property
    def places(self) -> tuple[np.ndarray, np.ndarray]:
        """The interface's points (n_q, d) and the upper body's control points (n_A, d), in the specimen's own frame."""
        interface = self.system.interface
        return self.pose.own(interface.X_qi), self.pose.own(interface.P_AI[self.bodies[0].points])

    def distance(self, X: np.ndarray) -> np.ndarray:
        """Distance (...,) of places (..., d) from the loaded end."""
        return self.layout.distance(self.pose.own(X)[..., 0])


def discretised(problem: Debonding, drawn: Drawn, supports: Callable[[tuple[Body, ...]], Supports]) -> Specimen:
    """Discrete system of a specimen with all that is needed to read results from its states."""
    pose, layout, arms = problem.pose, problem.layout, 2.0 if problem.symmetry else 1.0
    # mirror images that are not modelled are counted in the width: forces and energies are those of all bodies
    copies, width = (HALVES * arms, 1.0) if problem.solid else (arms, problem.width)
    meshes = tuple(widened(problem, mesh) for mesh in drawn.meshes) if problem.solid else drawn.meshes
    parts = bodies(meshes, _elasticity(problem, drawn), pose, copies * width, smooth(problem))
    P_AI, held = control_points(parts), supports(parts)
    loads = [load for load in layout.loads if load.body is None or load.body < len(parts)]
    pulled = [arms * load.share * _load_row(problem, parts, load, P_AI.size) for load in loads]
    met, free_d = _met(problem, parts, drawn.meshes), held.free_d
    if problem.solid:
        free_d = free_d & ~held_across(problem, P_AI)
    bulk = BULKS[problem.kinematics]
    system = System(
        bulk=bulk(joined([solid for body in parts for solid in body.solids])),
        interface=met.bond,
        load_d=np.sum(pulled, axis=0),
        hold_d=_hold_row(loads, pulled, pose.d),
        free_d=free_d,
        x_d=np.repeat(pose.own(P_AI)[:, 0], pose.d),
        ahead_d=np.tile(pose.axes_kI[0], len(P_AI)),
        springs_rd=held.springs_rd,
        spring_r=held.spring_r,
    )
    return Specimen(
        system=system,
        bodies=parts,
        pose=pose,
        layout=layout,
        drawn=drawn,
        copies=copies,
        width=problem.width,
        load_at=problem.load_at,
        upper_is_slave=slave_number(problem, parts) == 0,
        probe=met.probe,
        faces=met.faces,
        ends=bulk(_ends(parts, layout, copies * width / problem.width)),
        rollers=held.rollers,
    )


def _met(problem: Debonding, parts: tuple[Body, ...], meshes: tuple[Mesh, ...]) -> Met:
    bonded, facing = problem.layout.bonded, problem.layout.facing
    touching = facing if touches(problem) and facing != bonded else None
    if problem.solid:
        return met_on_lines(problem, parts, meshes, touching)
    joint = Joint.of(problem, parts)
    pairs = bond(joint, bonded, touching)
    return Met(pairs, probe(joint, bonded, pairs), faces(joint, facing))


def _hold_row(loads: Sequence[Load], pulled: Sequence[np.ndarray], d: int) -> np.ndarray:
    """The part (n_dof,) of the load in one place: that of one end face, or at the control point on a long side that
    takes most of it, as a patch of many elements would couple all their unknowns."""
    first = loads[0]
    here = [(load.side, load.extent) == (first.side, first.extent) for load in loads]
    row_d = np.sum(np.array(pulled)[here], axis=0)
    if first.side not in ("top", "bottom"):
        return row_d
    place = np.arange(row_d.size) // d
    return np.where(place == place[np.argmax(np.abs(row_d))], row_d, 0.0)


def _load_row(problem: Debonding, parts: tuple[Body, ...], load: Load, n_dof: int) -> np.ndarray:
    """Row (n_dof,) of the displacement that is conjugate to a load."""
    if load.body is None or load.couple or load.side in ("top", "bottom"):
        return patch_rows(parts, load, problem.pose, n_dof).mean_d
    return pulled_row(parts[load.body], load.side, problem.load_at, problem.pose, 1, n_dof)


def _elasticity(problem: Debonding, drawn: Drawn) -> tuple[np.ndarray, ...]:
    """Elasticity matrix of every modelled body; bodies of one material share it."""
    upper, lower = (body.moduli for body in problem.layout.bodies)
    D = upper.stiffness(problem.plane)
    both = D, D if lower == upper else lower.stiffness(problem.plane)
    return both[: len(drawn.meshes)]


def _ends(parts: tuple[Body, ...], layout: Layout, copies: float) -> tuple[Solid, ...]:
    """The end faces whose strain energy enters the J-integral, with its sign in the lengths of their points."""
    ends = ("left", "right") if layout.bonded[0] < layout.bonded[1] else ("right", "left")
    return joined(
        [
            Solid(replace(basis, dV_eq=sign * copies * basis.dV_eq), body.D)
            for body in parts
            for end, sign in zip(ends, (1.0, -1.0), strict=True)
            for basis in body.ends[end]
        ]
    )


def element_length(specimen: Specimen) -> float:
    """Longest element side on the expected crack path, of either body: it limits the resolution of a process zone."""
    layout, longest = specimen.layout, 0.0
    for mesh, side in zip(specimen.drawn.meshes, FACING, strict=False):
        face = surface(mesh, mesh.chains[side], 0)
        Q_cbI = face.bezier_points(mesh.P_AI) / face.w_cb[..., None]
        start_cI, end_cI = Q_cbI[:, 0], Q_cbI[:, -1]
        middle_c = layout.distance(0.5 * (start_cI + end_cI)[:, 0])
        met = (middle_c > layout.free_length) & (middle_c < specimen.drawn.path_end)
        longest = max(longest, float(np.linalg.norm(end_cI - start_cI, axis=1)[met].max(initial=0.0)))
    return longest
