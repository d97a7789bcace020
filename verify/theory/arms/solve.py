"""Arms of order N on a cohesive bond: the beam of the textbooks (order 1), and plane arms whose displacements are
polynomials of the order N through the thickness.

The arms stretch, bend and shear, each with its own thickness and material; jumps of the faces follow from their motion,
tractions from the law, and loads and supports act where they do on the specimen. Small or finite rotations.

Sources: Kanninen (1973), Int. J. Fract. 9 (a beam on a foundation); Reissner (1972), J. Appl. Math. Phys. 23 (beams
with finite rotations);
Bennati, Fisicaro, Valvo (2013), Meccanica 48 (mixed-mode bending on an elastic interface); Vekua
(1955) and Carrera (2003), Arch. Comput. Methods Eng. 10 (polynomials through the thickness).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from verify.theory.arms.equilibrium import Control, Model, State
from verify.theory.arms.equilibrium import solve as equilibrium
from verify.theory.arms.front import model
from verify.theory.arms.path import HAS_SEPARATED, Pace, follow
from verify.theory.arms.problem import ArmsProblem
from verify.theory.arms.rows import Rows
from verify.theory.solution import Solution

#: Rows of a leg below which the energies of a step are not those of a smooth curve, however few are asked for.
LEAST_ROWS = 75


def solve(problem: ArmsProblem, on_step: Callable[[Mapping[str, float]], None] | None = None) -> Solution:
    """Follow the path to the end of the programme.

    Raises
    ------
    ValueError : a leg of no length; `Refusal` as by `model`
    """
    programme, one = problem.programme, model(problem)
    first = first_state(one, programme[0])
    if first is None:
        return Solution((), "stopped: no equilibrium of the specimen without damage")
    whole = one.progress(np.where(one.interface.bonded, 1.0, 0.0))
    size = 1.0 / max(problem.points, LEAST_ROWS)
    pace = Pace(max(map(abs, programme)), whole, _loads(one, first, programme), size, _longest(problem, size))
    rows_of = Rows(one)
    start = rows_of.unloaded(rows_of.row(first, one.rest, None))
    rows, snapshots, wanted = [start], [], sorted(problem.snapshot_openings)
    report = on_step or (lambda row: None)
    report(rows[0])
    status, rejected, before = "complete", 0, one.rest
    for found in follow(one, first, programme, pace):
        if isinstance(found, str):
            status = found
        elif found is None:
            rejected += 1
        elif isinstance(found, tuple):
            rows_of, before = Rows(found[0]), found[1]
        else:
            rows.append(rows_of.row(found, before, rows[-1]))
            if wanted and rows[-1]["opening"] >= wanted[0] * (1.0 - 1e-9):
                snapshots.append(rows_of.snapshot(found, before))
                wanted = [opening for opening in wanted if opening > rows[-1]["opening"] * (1.0 + 1e-9)]
            before = found
            report(rows[-1])
    ending = f"separated at opening {rows[-1]['opening']:.6g}" if status == HAS_SEPARATED else ""
    status, made = "complete" if ending else status, one.structure
    return Solution(tuple(rows), status, rejected, ending, tuple(snapshots), made.count, len(made.mesh.sizes))


def first_state(model: Model, target: float) -> State | None:
    """A state without damage at a small opening of the first leg."""
    opening = 1e-3 * target
    while abs(opening) > 1e-12 * abs(target):
        found = equilibrium(model, model.rest, model.rest, Control(1.0, 0.0, opening), turning=True, from_rest=True)
        if found is None or not np.any(found.history.d[model.interface.bonded] > 0.0):
            return found
        opening *= 0.1
    return None


def _loads(model: Model, first: State, programme: tuple[float, ...]) -> tuple[float, float]:
    """Loads at which a step is measured, on the sides of negative and of positive openings."""
    found = []
    for side in (-1.0, 1.0):
        most = max(side * opening for opening in (0.0, *programme))
        state = first if side * programme[0] > 0.0 else first_state(model, side * most) if most > 0.0 else None
        found.append(np.inf if state is None else _griffith(model, state, most))
    return found[0], found[1]


def _griffith(model: Model, state: State, most: float) -> float:
    """The load at which J would be the toughness, by the work of a state without damage; at most that at the last
    opening."""
    one, opening = model.structure, model.opening(state.x)
    towards = 1.0 if one.problem.loaded_at < 0.5 * one.problem.length else -1.0
    J = towards * one.j_of_loads(state.x, state.load, state.reactions)
    more = float(np.sqrt(model.interface.bond.critical(0.5) / max(J, 1e-300)))
    return abs(state.load) * min(more, most / abs(opening))


def _longest(problem: ArmsProblem, size: float) -> float:
    """The longest step: a hundredth of the programme for 150 rows, and half a process zone, as peaks are sharp."""
    low, high = sorted(problem.bonded)
    return min(1.5 * size, 0.5 * problem.zone / (high - low))
