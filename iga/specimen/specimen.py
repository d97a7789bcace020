"""A discrete specimen: its system and what it takes to read it."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from iga.elements.bulk import Solid, element_stiffness, full_matrices, gradient, joined
from iga.elements.kinematics import KINEMATICS
from iga.interface.interface import Interface
from iga.interface.surface import Surface, surface
from iga.mesh.extraction import Mesh
from iga.specimen.body import Body, slope_row
from iga.specimen.load import pulled_row
from iga.specimen.pose import Pose
from iga.system.system import System
from iga.tsplines.tmesh import TMesh


@dataclass(frozen=True)
class Specimen:
    """A system and what it takes to read it: bodies (upper first), pose, and which ends count for what.

    ``loaded`` names the end, "left" or "right", at which the dead load pulls each body; "" where it does not. Where on
    it is ``load_at``, see `iga.specimen.load`.
    Distances along the specimen are counted from the plane ``loaded_at`` of the first of them; the bond begins at the
    distance ``free_length``. ``energy_faces`` (body, end, sign) are those whose strain energy enters the J-integral.
    ``path`` are the distances between which the mesh is made for the crack to run.
    ``probe`` has two points, on the tip of the bond and on its far end. ``copies`` is 2 where one body stands for both.
    ``tmeshes`` are the T-meshes of the bodies in the specimen's own frame, none where the basis is another. ``faces``
    are samples of all that the bodies face of each other, bonded or not, where the programme may close it.
    """

    system: System
    bodies: tuple[Body, ...]
    pose: Pose
    loaded: tuple[str, ...]
    loaded_at: float
    free_length: float
    energy_faces: tuple[tuple[int, str, float], ...]
    upper_is_slave: bool
    copies: float
    probe: Interface
    path: tuple[float, float]
    tmeshes: tuple[TMesh, ...] = ()
    load_at: str = "face"
    faces: Interface | None = None

    @property
    def meshes(self) -> tuple[Mesh, ...]:
        return tuple(body.mesh for body in self.bodies)

    @cached_property
    def slope_rows(self) -> tuple[np.ndarray, ...]:
        """Rows (n_dof,) of the mean slopes of the bodies' loaded faces, zero without one."""
        n, axes_kI = self.system.n_dof, self.pose.axes_kI
        return tuple(
            slope_row(body.face(end), axes_kI[0], axes_kI[1], n) if end else np.zeros(n)
            for body, end in zip(self.bodies, self.loaded, strict=True)
        )

    @cached_property
    def energy_sides(self) -> tuple[Solid, ...]:
        """The ends whose strain energy enters the J-integral, its sign in what each point stands for."""
        return joined(
            [
                Solid(replace(basis, dV_eq=sign * self.copies * basis.dV_eq), self.bodies[number].D)
                for number, end, sign in self.energy_faces
                for basis in self.bodies[number].face(end)
            ]
        )

    @cached_property
    def energy_matrices(self) -> tuple[np.ndarray, ...]:
        """Their stiffness (n_e, 2 n_a, 2 n_a), the sign with it, before anything moves; linear: for good."""
        moduli, at_rest = KINEMATICS[self.system.kinematics].moduli, np.zeros((self.system.n_dof // 2, 2))
        return tuple(
            full_matrices(element_stiffness(side.basis, moduli(side.D, gradient(side.basis, at_rest))))
            for side in self.energy_sides
        )

    @cached_property
    def sampled(self) -> tuple[Solid, ...]:
        """All blocks on a grid of points an element, for pictures."""
        return joined([solid for body in self.bodies for solid in body.sampled])

    @cached_property
    def sampled_places(self) -> tuple[np.ndarray, ...]:
        """Where these points lie, (n_e, n_q, 2), in the specimen's own frame."""
        return tuple(self.pose.own(solid.basis.X_eqI) for solid in self.sampled)

    @cached_property
    def face_row(self) -> np.ndarray:
        """Row (n_dof,) of the displacement along the specimen of where the load acts on the upper body."""
        return pulled_row(self.bodies[0], self.loaded[0], self.load_at, self.pose, 0, self.system.n_dof)

    @cached_property
    def beside_probe(self) -> np.ndarray:
        """Points of the interface next to those of the probe, which meet the master close by."""
        return self.system.interface.beside(self.probe.X_qi)

    @cached_property
    def ordered(self) -> tuple[np.ndarray, np.ndarray]:
        """Distances (n_q,) of the interface's points, rising, and the points in this order."""
        s_q = self.distance(self.system.interface.X_qi)
        order = np.argsort(s_q)
        return s_q[order], order

    @cached_property
    def places(self) -> tuple[np.ndarray, np.ndarray]:
        """The interface's points (n_q, 2) and the upper body's control points (n_A, 2), in the specimen's own frame."""
        interface = self.system.interface
        return self.pose.own(interface.X_qi), self.pose.own(interface.P_AI[self.bodies[0].points])

    def distance(self, X: np.ndarray) -> np.ndarray:
        """Distance (...,) of places (..., 2) from the loaded end, along the specimen."""
        return np.abs(self.pose.own(X)[..., 0] - self.loaded_at)


def element_length(specimen: Specimen) -> float:
    """Longest element side where the crack is to run, of either body: the one that resolves a process zone least."""
    P_AI, first, longest = specimen.system.interface.P_AI, 0, 0.0
    for mesh, side in zip(specimen.meshes, ("bottom", "top"), strict=False):
        start_ci, end_ci = _ends(surface(mesh, mesh.chains[side], first), P_AI)
        middle_c = specimen.distance(0.5 * (start_ci + end_ci))
        met = (middle_c > specimen.path[0]) & (middle_c < specimen.path[1])
        longest = max(longest, float(np.linalg.norm(end_ci - start_ci, axis=1)[met].max(initial=0.0)))
        first += len(mesh.P_AI)
    return longest


def _ends(face: Surface, P_AI: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """First and last point (n_c, 2) of every side."""
    Q_cbi = face.bezier_points(P_AI) / face.w_cb[..., None]
    return Q_cbi[:, 0], Q_cbi[:, -1]
