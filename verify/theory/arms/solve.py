"""The cohesive beam in mixed mode: two Timoshenko arms on a bond that opens and slides.

The arms stretch, bend and shear, each with its own thickness and material; jumps of the faces g and s follow from their
motion, tractions from the law, and loads and supports act where they do on the specimen. Beyond the beam the arms give
across and along their faces (`verify.theory.arms.root`). Linear kinematics.

Sources: Kanninen (1973), Int. J. Fract. 9 (a beam on a foundation); Bennati, Fisicaro, Valvo (2013), Meccanica 48 (the
mixed-mode bending test on an elastic interface); here with a softening bond and contact, and followed by its front.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from verify.support.refusal import Refusal
from verify.theory.arms.equilibrium import Model
from verify.theory.arms.interface import Interface
from verify.theory.arms.path import ALL_BROKEN, Pace, first_state, follow
from verify.theory.arms.problem import ArmsProblem
from verify.theory.arms.root import compliances
from verify.theory.arms.rows import Rows
from verify.theory.arms.structure import Structure

#: Elements in the length of a process zone, and in the thickness of the thinner arm, at the least.
ELEMENTS_IN_A_ZONE = 8

#: What a row needs of one before it.
AT_REST = {"opening": 0.0, "load": 0.0, "external_work": 0.0}


@dataclass(frozen=True)
class Solution:
    """Rows, status ("complete" or the reason of a stop), the number of halved steps, a sentence on a separation, and
    snapshots."""

    rows: tuple[Mapping[str, float], ...]
    status: str
    rejected_steps: int = 0
    ending: str = ""
    snapshots: tuple[Mapping[str, object], ...] = ()


def model(problem: ArmsProblem, size: float | None = None) -> Model:
    """The equations of a problem, with elements of at most ``size`` or by the process zone.

    Raises
    ------
    Refusal : loads that nothing takes, or a law with a viscosity
    """
    if problem.law.viscosity > 0.0:
        raise Refusal(f"interface.viscosity: must be 0 for beams, got {problem.law.viscosity:g}")
    structure = Structure.of(problem, size or element_size(problem))
    middle = 0.5 * (structure.mesh.ends[1:] + structure.mesh.ends[:-1])
    inside = (middle > problem.bonded[0]) & (middle < problem.bonded[1])
    bonded = np.repeat(inside[:, None], len(structure.points.at), axis=1)
    return Model(structure, Interface(problem.law, bonded, compliances(problem.arms)))


def element_size(problem: ArmsProblem) -> float:
    """Length of an element: `ELEMENTS_IN_A_ZONE` of the shorter process zone, (E h^3 G / p_max^2)^(1/4) in opening and
    (E h G / t_max^2)^(1/2) in sliding, half of which is damaged, and no more than 1/400 of the arms less."""
    law, lengths = problem.law, [problem.length / 100.0]
    for arm in problem.arms:
        E, h = arm.young, arm.thickness
        lengths.append((E * h**3 * law.toughness[0] / law.strength[0] ** 2) ** 0.25 / ELEMENTS_IN_A_ZONE)
        lengths.append((E * h * law.toughness[1] / law.strength[1] ** 2) ** 0.5 / ELEMENTS_IN_A_ZONE)
    return max(min(lengths), problem.length / 2000.0)


def solve(problem: ArmsProblem, on_step: Callable[[Mapping[str, float]], None] | None = None) -> Solution:
    """Follow the path to the end of the programme.

    Raises
    ------
    ValueError : the programme unloads; `Refusal` as by `model`
    """
    end, one = problem.end, model(problem)
    state = first_state(one, end)
    if state is None:
        return Solution((), "stopped: no equilibrium of the specimen without damage")
    rows_of, rest = Rows(one, problem.loaded_at), one.intact()
    first = rows_of.row(state, rest, AT_REST)
    scale = np.array([end, _griffith(problem, first)])
    rows = [rows_of.unloaded(first)]
    report = on_step or (lambda row: None)
    report(rows[0])
    status, rejected, before = "complete", 0, rest
    for found in follow(one, state, Pace(end, scale, 2.0 / problem.points)):
        if isinstance(found, str):
            status = found
        elif found is None:
            rejected += 1
        else:
            rows.append(rows_of.row(found, before, rows[-1]))
            before = found
            report(rows[-1])
    ending = f"separated at opening {rows[-1]['opening']:.6g}" if status == ALL_BROKEN else ""
    return Solution(tuple(rows), "complete" if ending else status, rejected, ending)


def _griffith(problem: ArmsProblem, row: Mapping[str, float]) -> float:
    """The load at which J would be the toughness, by J of a state without damage; at most that at the last opening."""
    more = float(np.sqrt(problem.law.critical(row["mode_ratio"]) / max(row["J_loads"], 1e-300)))
    return abs(row["load"]) * min(more, problem.end / row["opening"])
