"""The cohesive beam: a shear-flexible beam on the bilinear law, solved to rounding.

The beam is one arm of a DCB, whose gap is twice the deflection by symmetry, or the strip of a peel test on the
interface in series with the substrate, a foundation of two parameters (``verify.theory.beam.substrate``). In each zone
(free, open, softening, elastic, contact) the equations are smooth, and linear for linear kinematics; nodes of the mesh
lie at the ends of the zones, so that no integral crosses a kink. The position of the damage front, which only advances,
is the parameter of the path, so that snap-backs of load or opening need no special treatment. Since the traction is
continuous between zones, an error in the end of a zone has no first-order effect, and Newton's method for states and
ends converges quadratically.

Source: Skec, Alfano, Jelenic (2019), Int. J. Fract. 215, 67-89, for the linear beam; here with contact, a free far
end, and with geometrically exact kinematics.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from math import nan

from verify.theory.beam.arm import SHEAR_CORRECTION, Arm
from verify.theory.beam.equilibrium import Model, intact
from verify.theory.beam.path import HAS_SEPARATED, UNEQUAL, Pace, follow
from verify.theory.beam.peeled_strip import Strip
from verify.theory.beam.problem import BeamProblem
from verify.theory.beam.rows import Units, row, snapshot, unloaded
from verify.theory.beam.zones import Ends, Foundation


@dataclass(frozen=True)
class Solution:
    """Rows (curve and evidence columns), status ("complete" or the reason of a stop), snapshots, the number of halved
    steps, and a sentence on a separation."""

    rows: tuple[Mapping[str, float], ...]
    status: str
    snapshots: tuple[Mapping[str, object], ...]
    rejected_steps: int = 0
    ending: str = ""


def model(problem: BeamProblem) -> Model:
    """Scale a problem by the arm thickness and the bending stiffness.

    The substrate is left out beyond the loaded end of the strip.
    """
    h, bending, area = problem.arm_thickness, problem.bending, problem.width * problem.arm_thickness
    arm = Arm(bending / (SHEAR_CORRECTION * problem.shear * area * h**2), 1.0 / 12.0, problem.kinematics == "finite")
    base = Foundation.of(problem.law, problem.width, h, bending, 1 if problem.substrate else 2)
    ends = Ends(problem.precrack / h, problem.length / h)
    if problem.substrate is None:
        return Model(arm, base, ends)
    k, g = problem.substrate.beneath(bending / problem.width, problem.law.stiffness)
    unit = problem.width * h**2 / bending
    strip = Strip(arm, k * unit * h**2, g * unit)
    return Model(strip, base, replace(ends, edge=max(0.0, problem.length - problem.substrate.length) / h))


def solve(problem: BeamProblem, on_step: Callable[[Mapping[str, float]], None] | None = None) -> Solution:
    """Follow the path to the end of the programme.

    Raises
    ------
    ValueError : the programme unloads
    """
    m, end, units = model(problem), problem.end, Units.of(problem)
    first = intact(m)
    if first is None:
        status = f"stopped: the zones of contact of the undamaged arm were not found; {UNEQUAL}"
        return Solution((unloaded(m, units, nan),), status, ())
    rows, snapshots, wanted = [row(units, m, first, None)], [], sorted(problem.snapshot_openings)
    pace = Pace(units.deflection(end), units.reference_load, 2.0 / problem.points)
    path, status, rejected = follow(m, first, pace), "", 0
    if on_step:
        on_step(rows[0])
    for state in path:
        if isinstance(state, str):
            status = state
            break
        if state is None:
            rejected += 1
            continue
        rows.append(row(units, m, state, rows[-1]))
        if wanted and rows[-1]["opening"] >= wanted[0] * (1.0 - 1e-9):
            snapshots.append(snapshot(units, m, state, rows[-1]))
            wanted = [opening for opening in wanted if opening > rows[-1]["opening"] * (1.0 + 1e-9)]
        if on_step:
            on_step(rows[-1])
    ending = f"separated at opening {rows[-1]['opening']:.6g}" if status == HAS_SEPARATED else ""
    return Solution(tuple(rows), "complete" if ending else status, tuple(snapshots), rejected, ending)
