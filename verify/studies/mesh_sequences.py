"""Sequences of meshes among the runs of a scene: convergence of quantities, extrapolated limits, estimated errors.

These are no checks: the errors are estimates without an exact value.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from verify.curves.convergence import Convergence, assess
from verify.curves.of_run import dissipated, peak_load, work
from verify.methods.reference_mesh import reference_mesh
from verify.result import Result
from verify.verdict import Run, SceneReport

#: Quantities whose convergence is assessed.
QUANTITIES: Mapping[str, Callable[[Result], float]] = {
    "peak load": peak_load,
    "dissipated energy at the end": dissipated,
    "work at the end": work,
}

#: Smallest number of meshes with an observed order.
FEWEST = 3


@dataclass(frozen=True, eq=False)
class Sequence:
    """One quantity on the meshes of one method, finest first.

    value : value of each run of ``runs``
    found : order, limit, grid convergence index, and whether the meshes are in the asymptotic range
    """

    method: str
    quantity: str
    runs: tuple[Run, ...]
    value: tuple[float, ...]
    found: Convergence

    @property
    def steps(self) -> tuple[float | None, ...]:
        """Relative change from the next coarser mesh; None on the coarsest."""
        pairs = zip(self.value, self.value[1:], strict=False)
        return (*((a - b) / abs(b) if b else None for a, b in pairs), None)


def sequences(report: SceneReport) -> tuple[Sequence, ...]:
    """Every quantity of every method with at least three complete runs that differ only in their meshes."""
    return tuple(
        _sequence(method, quantity, runs)
        for method in dict.fromkeys(run.method for run in report.runs)
        if len(runs := _meshes(report, method)) >= FEWEST
        for quantity in QUANTITIES
        if all(_known(quantity, result) for result in _results(runs))
    )


def _sequence(method: str, quantity: str, runs: tuple[Run, ...]) -> Sequence:
    results = _results(runs)
    value = tuple(QUANTITIES[quantity](result) for result in results)
    return Sequence(method, quantity, runs, value, assess([1 / result.elements for result in results], value))


def _results(runs: tuple[Run, ...]) -> list[Result]:
    """Results of runs that all have one."""
    return [run.result for run in runs if run.result is not None]


def _meshes(report: SceneReport, method: str) -> tuple[Run, ...]:
    """Complete runs of a method with one degree and fixed meshes, finest first, one for each number of elements."""
    ours = [(run, run.result) for run in report.runs if run.method == method and run.result is not None]
    whole = [(run, result.elements, _kind(run)) for run, result in ours if result.complete]
    of_elements = {elements: run for run, elements, kind in whole if kind == whole[0][2]}
    return tuple(run for elements, run in sorted(of_elements.items(), reverse=True) if elements)


def _kind(run: Run) -> tuple[int, bool]:
    """Degree, and whether the mesh is adaptive."""
    if run.scene is None:
        return 0, False
    mesh = run.scene.discretization
    return (reference_mesh(run.scene).degree, False) if run.method == "dolfinx" else (mesh.degree, mesh.adaptive)


def _known(quantity: str, result: Result) -> bool:
    needed = {"dissipated energy at the end": "dissipated_energy", "work at the end": "external_work"}
    column = result.steps.get(needed.get(quantity, "load"))
    return column is not None and len(column) > 0 and column[-1] == column[-1]
