"""From a discrete specimen to its rows: the path is followed and evaluated in the same way for every specimen."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from iga.algebra.factors import condition
from iga.output.frames import frame
from iga.output.rows import row
from iga.output.snapshots import Snapshot, snapshot
from iga.path.condensation import condensed
from iga.path.follow import follow
from iga.path.point import End, Point
from iga.path.solver import Solver
from iga.specimen.problem import Debonding
from iga.specimen.specimen import Specimen
from iga.system.state import State
from iga.system.system import Phase, System, inverse_of, respond

#: Called with the opening of every converged step, and with a function that makes its frame (see `iga.output.frames`).
OnFrame = Callable[[float, Callable[[], dict[str, Any]]], None]

#: Why a path stops choosing its steps.
NO_BETTER = "as those by accuracy failed or were no longer: the load rises and falls with single interface points"


@dataclass(frozen=True)
class Solution:
    """Result of a run: one row for each converged step (see `iga.output.rows`), snapshots (see `iga.output.snapshots`),
    and how it ended.

    ``status`` is "complete" where the whole programme was run, and else says why it was not. ``ending`` is the opening
    at which a specimen came apart, if it did. ``counted_steps`` is the opening from which steps had one length although
    the path was to choose them, and why. ``condition`` is the larger condition number of the tangents at the first and
    at the last converged point.
    """

    rows: tuple[Mapping[str, float], ...]
    dofs: int
    elements: int
    rejected_steps: int
    status: str
    snapshots: tuple[Snapshot, ...]
    ending: str = ""
    counted_steps: str = ""
    condition: float = 0.0

    @property
    def steps(self) -> dict[str, np.ndarray]:
        """The rows as columns: name -> array (n_steps,)."""
        return {name: np.array([row[name] for row in self.rows]) for name in self.rows[0]}

    @property
    def opening(self) -> np.ndarray:
        return self.steps["opening"]

    @property
    def load(self) -> np.ndarray:
        return self.steps["load"]

    def __repr__(self) -> str:
        peak = max(self.rows, key=lambda row: row["load"])
        at = f"peak load {peak['load']:.6g} at opening {peak['opening']:.6g}"
        return f"<Solution: {self.dofs} unknowns, {len(self.rows)} points, {at}, {self.ending or self.status}>"

    def _repr_html_(self) -> str:
        from iga.notebook import Drawn, chart

        return chart([Drawn(f"{self.dofs} unknowns", self.opening, self.load)])


def run(
    problem: Debonding,
    specimen: Specimen,
    on_step: Callable[[Mapping[str, float]], None] | None,
    phase: Phase,
    adapt: Callable[[Specimen, Point], tuple[Specimen, State] | None] | None = None,
    on_frame: OnFrame | None = None,
) -> Solution:
    """Follow the programme of a problem; ``on_step`` is called with the row of every converged step, as it comes.

    ``adapt`` may return a specimen with another mesh, and the state on it, for a converged point.
    """
    rows: list[dict[str, float]] = []
    snapshots: list[Snapshot] = []
    wanted = sorted(problem.snapshot_openings)
    first, last, end, most, whose = None, None, End("complete", 0), specimen, specimen.system

    def renewed(point: Point) -> tuple[System, State] | None:
        nonlocal specimen, most
        found = adapt(specimen, point) if adapt is not None else None
        if found is None:
            return None
        specimen, state = found
        most = max(most, specimen, key=lambda one: one.system.n_dof)
        return specimen.system, state

    with phase("basis"):
        small = condensed(specimen.system) if adapt is None else None
    system = specimen.system if small is None else small.system
    programme = by_way_of(problem.opening, wanted)
    for item in follow(Solver(system, phase=phase), programme, problem.steps, renewed, problem.bend):
        if isinstance(item, End):
            end = item
            continue
        first = _condition(system, item, phase) if first is None else first
        last, point = item, item if small is None else small.expanded(item)
        whose = specimen.system if small is None else system  # the mesh may be renewed after the last point
        rows.append(row(specimen, point))
        if on_step is not None:
            on_step(rows[-1])
        if on_frame is not None:
            on_frame(point.opening, partial(frame, specimen, point))
        if wanted and point.opening >= wanted[0]:
            wanted = [opening for opening in wanted if opening > point.opening]
            snapshots.append(snapshot(specimen, point))
    assert first is not None and last is not None
    return Solution(
        rows=tuple(rows),
        dofs=most.system.n_dof,
        elements=sum(mesh.elements for mesh in most.meshes),
        rejected_steps=end.rejected,
        status=end.status,
        snapshots=tuple(snapshots),
        ending=f"separated at opening {last.opening:.6g}" if end.separated else "",
        counted_steps="" if end.counted is None else f"from opening {end.counted:.6g} on, {NO_BETTER}",
        condition=max(first, _condition(whose, last, phase)),
    )


def by_way_of(programme: Sequence[float], stops: Sequence[float]) -> tuple[float, ...]:
    """The programme with a stop at each of ``stops`` (increasing) where it first passes it."""
    way, left, here = [], list(stops), 0.0
    for goal in programme:
        while left and here < left[0] < goal:
            way.append(left.pop(0))
        way.append(goal)
        here = goal
    return tuple(way)


def _condition(system: System, point: Point, phase: Phase) -> float:
    """Condition number of the tangent at a converged point."""
    with phase("assembly"):
        response = respond(system, point.state, decide=False)
        pattern = system.pattern(response)
        assert pattern is not None
        half, skew = pattern.tangent(system.interface, response)
    with phase("factor"):
        found = inverse_of(system, pattern, half, skew)
        return float("inf") if found is None else condition(pattern.band, half, skew, found)
