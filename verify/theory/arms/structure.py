"""The arms without their bond: stiffness, loads, supports, and the jump of the interface, linear in the unknowns.

A section of an arm moves by u_x = u - phi (Y - Y_i), u_y = w, with phi anticlockwise. Its energy per length is
(E A u'^2 + E I phi'^2 + kappa G A (w' - phi)^2) / 2. The faces part and slide by

    g = w_1 - w_2,  s = (u_1 + h_1/2 phi_1) - (u_2 - h_2/2 phi_2).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.linalg import null_space

from verify.support.refusal import Refusal
from verify.theory.arms.mesh import ARM_DEGREE, INTERFACE_POINTS, UNKNOWNS, Mesh, Points, lobatto
from verify.theory.arms.problem import Arm, ArmsProblem, Load, Support
from verify.theory.beam.arm import SHEAR_CORRECTION

U, W, TURN = range(3)


@dataclass(frozen=True)
class Structure:
    """Two arms on one mesh.

    ``load`` (n,) : forces for a load of 1, which is the opening as a function of the unknowns, too
    ``held`` (m, n) : mean displacements that supports keep at zero
    ``load_slope`` (n,), ``held_slope`` (m, n) : the same of slopes du_y/dX on patches, zero for end faces
    ``pinned`` (3, k) : combinations of u, w, phi at the right end of the lower arm that nothing else holds
    """

    arms: tuple[Arm, Arm]
    width: float
    mesh: Mesh
    load: np.ndarray
    held: np.ndarray
    load_slope: np.ndarray
    held_slope: np.ndarray
    pinned: np.ndarray

    @staticmethod
    def of(problem: ArmsProblem, size: float, places: Sequence[float] = ()) -> Structure:
        """With elements of at most ``size`` that end at ``places``, at the ends of the bond and of all patches.

        Raises
        ------
        Refusal : the loads move the specimen as a rigid body
        """
        places_of_all: list[Load | Support] = [*problem.loads, *problem.supports]
        patches = [x for one in places_of_all for x in one.extent or ()]
        mesh = Mesh.through((0.0, problem.length, *problem.bonded, *patches, *places), size)
        share = np.array([one.share for one in problem.loads])
        load, load_slope = (share @ rows for rows in _places(problem.arms, mesh, problem.loads))
        held, held_slope = _places(problem.arms, mesh, problem.supports)
        modes = rigid(problem.arms, mesh)
        scale = np.array([1.0, 1.0, problem.length])  # a rotation moves by it over the length
        free = scale[:, None] * null_space(held @ modes * scale, rcond=1e-9) if len(held) else np.diag(scale)
        if np.any(np.abs(load @ modes @ free) > 1e-9 * np.abs(load).sum() * problem.length):
            raise Refusal("specimen: the loads must balance each other where no support takes them")
        return Structure(problem.arms, problem.width, mesh, load, held, load_slope, held_slope, free / scale[:, None])

    @cached_property
    def stiffness_eab(self) -> np.ndarray:
        """Stiffness (E, 30, 30) of both arms in every element."""
        points = Points.gauss(ARM_DEGREE + 1)
        n = UNKNOWNS * (ARM_DEGREE + 1)
        strain = self.strain(points)
        weight = points.weight * self.mesh.sizes[:, None]
        parts = np.einsum("eqia,i,eqib,eq->eab", strain, self.sections, strain, weight, optimize=True)
        return parts.reshape(-1, n, n)

    @cached_property
    def sections(self) -> np.ndarray:
        """E A, E I and kappa G A of the upper arm, then of the lower one, (6,)."""
        b = self.width
        rows = [
            (E * b * h, E * b * h**3 / 12.0, SHEAR_CORRECTION * arm.shear * b * h)
            for arm, E, h in ((arm, arm.young, arm.thickness) for arm in self.arms)
        ]
        return np.concatenate(rows)

    def strain(self, points: Points) -> np.ndarray:
        """u', phi', w' - phi of both arms at points by the unknowns of an element, (E, q, 6, 30)."""
        E, q, n = len(self.mesh.sizes), len(points.at), ARM_DEGREE + 1
        slope = points.dN_qa / self.mesh.sizes[:, None, None]
        strain = np.zeros((E, q, 6, n, UNKNOWNS))
        for arm in range(2):
            strain[:, :, 3 * arm, :, 3 * arm + U] = slope
            strain[:, :, 3 * arm + 1, :, 3 * arm + TURN] = slope
            strain[:, :, 3 * arm + 2, :, 3 * arm + W] = slope
            strain[:, :, 3 * arm + 2, :, 3 * arm + TURN] = -points.N_qa
        return strain.reshape(E, q, 6, n * UNKNOWNS)

    @cached_property
    def points(self) -> Points:
        """Points of the interface in an element."""
        return Points.gauss(INTERFACE_POINTS, ends=True)

    @cached_property
    def jump_qia(self) -> np.ndarray:
        """g and s at the points of any element by its unknowns, (q, 2, 30)."""
        return self._jump(self.points.N_qa)

    @cached_property
    def jump_slope_qia(self) -> np.ndarray:
        """The same of dg/dX and ds/dX, times the size of the element."""
        return self._jump(self.points.dN_qa)

    @cached_property
    def weight_eq(self) -> np.ndarray:
        """Area (E, q) of the interface at its points."""
        return self.width * self.mesh.sizes[:, None] * self.points.weight

    def _jump(self, N_qa: np.ndarray) -> np.ndarray:
        h1, h2 = (arm.thickness for arm in self.arms)
        of_node = np.array([[0.0, 1.0, 0.0, 0.0, -1.0, 0.0], [1.0, 0.0, h1 / 2.0, -1.0, 0.0, h2 / 2.0]])
        return np.einsum("qa,ic->qiac", N_qa, of_node).reshape(len(N_qa), 2, -1)


def heights(arms: tuple[Arm, Arm]) -> tuple[float, float]:
    """Y of the middle of both arms."""
    return arms[0].thickness / 2.0, -arms[1].thickness / 2.0


def rigid(arms: tuple[Arm, Arm], mesh: Mesh) -> np.ndarray:
    """Motions (n, 3) along X, along Y, and about the right end of the lower arm."""
    x = np.concatenate((mesh.places(Points.of(lobatto(), np.zeros(ARM_DEGREE + 1)))[:, :-1].ravel(), mesh.ends[-1:]))
    modes = np.zeros((len(x), 2, 3, 3))
    modes[:, :, U, 0] = modes[:, :, W, 1] = modes[:, :, TURN, 2] = 1.0
    modes[:, :, W, 2] = (x - x[-1])[:, None]
    modes[:, :, U, 2] = heights(arms)[1] - np.array(heights(arms))
    return modes.reshape(-1, 3)


def _places(arms: tuple[Arm, Arm], mesh: Mesh, listed: Sequence[Load | Support]) -> tuple[np.ndarray, np.ndarray]:
    """Mean displacements, and mean slopes on patches, (m, n) each, that go with loads or supports."""
    displacements, slopes = np.zeros((len(listed), mesh.count)), np.zeros((len(listed), mesh.count))
    for i, one in enumerate(listed):
        if one.side in ("left", "right"):
            displacements[i] = _end(arms, mesh, one)
            continue
        if one.couple:
            raise Refusal(f"specimen: a couple must be on an end face, got the {one.side}")
        body = one.body if one.body is not None else ("top", "bottom").index(one.side)
        where = one.extent or (mesh.ends[0], mesh.ends[-1]), 3 * body + W
        displacements[i], slopes[i] = mesh.mean(*where), mesh.mean_slope(*where)
    return displacements, slopes


def _end(arms: tuple[Arm, Arm], mesh: Mesh, one: Load | Support) -> np.ndarray:
    """Mean displacement of an end face, of both arms as one where no body is named, or its mean rotation, (n,).

    The rotation is -int u_x (Y - Y_m) dY / int (Y - Y_m)^2 dY about the middle Y_m of the face.
    """
    node = 0 if one.side == "left" else mesh.count // UNKNOWNS - 1
    row = np.zeros((mesh.count // UNKNOWNS, 2, 3))
    if one.body is not None:
        row[node, one.body, TURN if one.couple else W] = 1.0
        return row.ravel()
    h = np.array([arm.thickness for arm in arms])
    if not one.couple:
        row[node, :, W] = h / h.sum()
        return row.ravel()
    middle = 0.5 * (h[0] - h[1])
    row[node, :, TURN] = (h / h.sum()) ** 3
    row[node, :, U] = -12.0 * h * (np.array(heights(arms)) - middle) / h.sum() ** 3
    return row.ravel()
