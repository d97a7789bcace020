"""From the problem of a delamination specimen to its discrete system and its solution."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from iga.delamination.adaptive import Window, carried, first_window, followed
from iga.delamination.meshes import drawn, follows
from iga.delamination.supports import supports
from iga.path.point import Point
from iga.run import OnFrame, Solution, run
from iga.specimen.problem import Debonding
from iga.specimen.specimen import Specimen, discretised
from iga.system.state import State
from iga.system.system import Phase, untimed


def build(problem: Debonding, phase: Phase = untimed, window: Window | None = None) -> Specimen:
    """Discrete system of a problem with all that is needed to read results from its states.

    ``window`` is the fine part of an adaptive mesh, the first one if left out.
    """
    with phase("mesh"):
        made = drawn(problem, window)
    with phase("basis"):
        return discretised(problem, made, lambda bodies: supports(problem, bodies))


def solve(
    problem: Debonding,
    on_step: Callable[[Mapping[str, float]], None] | None = None,
    phase: Phase = untimed,
    on_frame: OnFrame | None = None,
) -> Solution:
    """Solve a delamination specimen.

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
