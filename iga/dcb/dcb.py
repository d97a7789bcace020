"""The double cantilever beam: two arms, one interface, opened at one end."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from iga.dcb.adaptive import Window, adapted_tmeshes, carried, first_window, followed
from iga.dcb.meshes import arm_meshes, crack_path, tmeshes
from iga.dcb.problem import Problem
from iga.elements.bulk import joined
from iga.elements.elasticity import orthotropic
from iga.path.point import Point
from iga.run import OnFrame, Solution, run
from iga.specimen.body import Body, bodies, edge_row, mean_row, point_row
from iga.specimen.bond import bond, control_points, faces, probe, slave_number
from iga.specimen.load import pulled_row
from iga.specimen.pose import Pose
from iga.specimen.problem import presses, smooth
from iga.specimen.specimen import Specimen
from iga.system.state import State
from iga.system.system import Phase, System, untimed
from iga.tsplines.tmesh import TMesh
from iga.tsplines.tspline import tspline_rectangle

#: Stiffness of a tie that hardly gives, relative to the modulus times the width: that of the stiffest elements.
TIE = 10.0


def build(problem: Problem, phase: Phase = untimed, window: Window | None = None) -> Specimen:
    """Discrete system of a problem with all that is needed to read results from its states.

    ``window`` is the fine part of an adaptive mesh, the first one if left out.
    """
    with phase("mesh"):
        window = window or (first_window(problem) if follows(problem) else None)
        drawn = _tmeshes(problem, window)
        meshes = problem.meshes or tuple(tspline_rectangle(mesh) for mesh in drawn) or arm_meshes(problem)
        meshes = meshes[:1] if problem.symmetry else meshes
    with phase("basis"):
        pose, extent = problem.pose, (problem.precrack, problem.length)
        D = orthotropic(problem.E1, problem.E2, problem.G12, problem.nu12, problem.plane)
        # a mirror image that is not modelled counts in the width, so that forces and energies are those of the whole
        copies = 2.0 if problem.symmetry else 1.0
        arms = bodies(meshes, (D,) * len(meshes), pose, copies * problem.width, smooth(problem))
        P_AI = control_points(arms)
        across = [pulled_row(arm, "left", problem.load_at, pose, 1, P_AI.size) for arm in arms]
        springs_rd, spring_r = _supports(problem, arms, pose)
        system = System(
            solids=joined([solid for arm in arms for solid in arm.solids]),
            interface=bond(problem, arms, extent, (0.0, problem.length) if presses(problem) else None),
            kinematics=problem.kinematics,
            load_d=2.0 * across[0] if problem.symmetry else across[0] - across[1],
            free_d=np.ones(P_AI.size, dtype=bool),
            x_d=np.repeat(pose.own(P_AI)[:, 0], 2),
            springs_rd=springs_rd,
            spring_r=spring_r,
        )
        return Specimen(
            system=system,
            bodies=arms,
            pose=pose,
            loaded=("left",) * len(arms),
            loaded_at=0.0,
            load_at=problem.load_at,
            free_length=problem.precrack,
            energy_faces=tuple(
                (n, end, sign) for n in range(len(arms)) for end, sign in (("left", 1.0), ("right", -1.0))
            ),
            upper_is_slave=slave_number(problem, arms) == 0,
            copies=copies,
            probe=probe(problem, arms, extent, system.interface),
            path=(problem.precrack, _end_of_path(problem, window)),
            tmeshes=drawn,
            faces=faces(problem, arms, (0.0, problem.length)),
        )


def solve(
    problem: Problem,
    on_step: Callable[[Mapping[str, float]], None] | None = None,
    phase: Phase = untimed,
    on_frame: OnFrame | None = None,
) -> Solution:
    """Solve a double cantilever beam.

    Parameters
    ----------
    problem : the specimen, its law, programme, mesh and pose.
    on_step : called with the row of every converged step, as it comes.
    phase : context manager that times "mesh", "basis", "assembly", "factor", "solve".
    on_frame : called with the opening of every converged step and what makes its frame (see `iga.output.frames`).

    Returns
    -------
    Solution; its ``status`` says whether the whole programme was run.

    Raises
    ------
    ValueError : a problem for which there is no mesh or no material.
    """
    if not follows(problem):
        return run(problem, build(problem, phase), on_step, phase, on_frame=on_frame)
    first = first_window(problem)

    def adapt(specimen: Specimen, point: Point) -> tuple[Specimen, State] | None:
        window = followed(problem, first.roots, specimen, point)
        if window is None:
            return None
        moved = build(problem, phase, window)
        state = carried(specimen, moved, point, phase)
        return None if state is None else (moved, state)

    return run(problem, build(problem, phase, first), on_step, phase, adapt, on_frame)


def follows(problem: Problem) -> bool:
    """Whether the mesh follows the process zone."""
    return problem.adaptive and problem.basis == "tspline" and not problem.meshes


def _end_of_path(problem: Problem, window: Window | None) -> float:
    """Where the mesh for the crack ends."""
    if problem.meshes:
        return problem.length
    return crack_path(problem) if window is None else window.end


def _tmeshes(problem: Problem, window: Window | None) -> tuple[TMesh, ...]:
    """T-meshes of the arms, none where the basis is another."""
    if problem.basis != "tspline" or problem.meshes:
        return ()
    drawn = tmeshes(problem) if window is None else adapted_tmeshes(problem, window)
    return drawn[:1] if problem.symmetry else drawn


def _supports(problem: Problem, arms: tuple[Body, ...], pose: Pose) -> tuple[np.ndarray, np.ndarray]:
    """Rows (n_r, n_dof) of the displacements that are held, and by how stiff a spring (n_r,).

    The lower arm's corner of interface and far end is held along and across the specimen, and how far the two loaded
    faces are out of line takes the rotation: the rigid motions of the whole, so that these springs carry no force. An
    interface without friction leaves one arm free to slide along the other. A tie between their far faces carries what
    the tractions of a bent interface amount to lengthwise, at the interface, but spread over the faces: in a corner it
    would hold energy without bound. One arm alone is held along the specimen.
    """
    P_AI, (along_i, across_i) = control_points(arms), pose.axes_kI
    corner = pose.place(np.array([problem.length, 0.0]))
    at = [arm.first + int(np.argmin(np.linalg.norm(arm.mesh.P_AI - corner, axis=1))) for arm in arms]
    soft = problem.E1 * problem.width * problem.arm_thickness / problem.length
    along_rd = [point_row(A, along_i, P_AI.size) for A in at]
    if len(arms) == 1:
        return np.array(along_rd), np.array([soft])
    upper_d, lower_d = (mean_row(arm.face("left"), along_i, P_AI.size) for arm in arms)
    ends_d = [edge_row(arm.face("right"), lambda X: np.abs(pose.own(X)[..., 1]), along_i, P_AI.size) for arm in arms]
    rows = [along_rd[1], point_row(at[1], across_i, P_AI.size), upper_d - lower_d, ends_d[0] - ends_d[1]]
    return np.array(rows), np.array([soft, soft, soft, TIE * problem.E1 * problem.width])
