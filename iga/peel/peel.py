"""The peel test: a strip bonded on a clamped substrate, its free end pulled up."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from iga.elements.bulk import joined
from iga.elements.elasticity import orthotropic
from iga.peel.meshes import meshes, tmeshes
from iga.peel.problem import Problem
from iga.run import OnFrame, Solution, run
from iga.specimen.body import Body, bodies, mean_row
from iga.specimen.bond import bond, control_points, faces, probe, slave_number
from iga.specimen.load import pulled_row
from iga.specimen.pose import Pose
from iga.specimen.problem import presses, smooth
from iga.specimen.specimen import Specimen
from iga.system.system import Phase, System, untimed
from iga.tsplines.tspline import tspline_rectangle


def build(problem: Problem, phase: Phase = untimed) -> Specimen:
    """Discrete system of a problem with all that is needed to read results from its states."""
    with phase("mesh"):
        drawn = tmeshes(problem) if problem.basis == "tspline" and not problem.meshes else ()
        both = problem.meshes or tuple(tspline_rectangle(mesh) for mesh in drawn) or meshes(problem)
    with phase("basis"):
        pose, extent = problem.pose, (problem.bond_length, 0.0)
        moduli = (problem.strip, problem.substrate)
        D = tuple(orthotropic(m.E1, m.E2, m.G12, m.nu12, problem.plane) for m in moduli)
        strip, substrate = pair = bodies(both, D, pose, problem.width, smooth(problem))
        P_AI = control_points(pair)
        springs_rd, spring_r = _support(problem, strip, pose, P_AI.size)
        system = System(
            solids=joined([solid for body in pair for solid in body.solids]),
            interface=bond(problem, pair, extent, _touching(problem)),
            kinematics=problem.kinematics,
            load_d=pulled_row(strip, "right", problem.load_at, pose, 1, P_AI.size),
            free_d=_free(substrate, P_AI.size),
            x_d=np.repeat(pose.own(P_AI)[:, 0], 2),
            springs_rd=springs_rd,
            spring_r=spring_r,
        )
        return Specimen(
            system=system,
            bodies=pair,
            pose=pose,
            loaded=("right", ""),
            loaded_at=problem.strip_length,
            load_at=problem.load_at,
            free_length=problem.strip_length - problem.bond_length,
            energy_faces=((0, "right", 1.0), (1, "right", 1.0), (0, "left", -1.0), (1, "left", -1.0)),
            upper_is_slave=slave_number(problem, pair) == 0,
            copies=1.0,
            probe=probe(problem, pair, extent, system.interface),
            path=(problem.strip_length - problem.bond_length, problem.strip_length),
            tmeshes=drawn,
            faces=faces(problem, pair, (facing(problem), 0.0)),
        )


def solve(
    problem: Problem,
    on_step: Callable[[Mapping[str, float]], None] | None = None,
    phase: Phase = untimed,
    on_frame: OnFrame | None = None,
) -> Solution:
    """Solve a peel test; parameters, result and refusals as those of `iga.dcb.dcb.solve`."""
    return run(problem, build(problem, phase), on_step, phase, on_frame=on_frame)


def _free(substrate: Body, n_dof: int) -> np.ndarray:
    """The base of the substrate is clamped."""
    free_Ai = np.ones((n_dof // 2, 2), dtype=bool)
    free_Ai[substrate.surface("bottom").conn_ca] = False
    return free_Ai.ravel()


def _touching(problem: Problem) -> tuple[float, float] | None:
    """How far strip and substrate may touch, beyond the bond as well; None where no gap closes there."""
    face = facing(problem)
    return (face, 0.0) if presses(problem) and face > problem.bond_length else None


def facing(problem: Problem) -> float:
    """How far from the flush end strip and substrate face each other."""
    return min(problem.strip_length, problem.substrate_length)


def _support(problem: Problem, strip: Body, pose: Pose, n_dof: int) -> tuple[np.ndarray, np.ndarray]:
    """Row (1, n_dof) and stiffness (1,) of the spring that keeps the strip from sliding along the substrate.

    An interface without friction does not. The spring holds the mean of the strip's left end and carries what the
    tractions amount to lengthwise: nothing in linear kinematics, where they stay across the specimen, and in finite
    kinematics as much as the master's surface tilts where they pull.
    """
    row_d = mean_row(strip.face("left"), pose.axes_kI[0], n_dof)
    stiffness = problem.strip.E1 * problem.strip_thickness * problem.width / problem.strip_length
    return row_d[None], np.array([stiffness])
