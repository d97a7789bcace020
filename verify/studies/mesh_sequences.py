"""Sequences of meshes among the runs of a scene: convergence of quantities, extrapolated limits, estimated errors.

These are no checks: the errors are estimates without an exact value.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from verify.curves.convergence import Convergence, assess
from verify.curves.of_run import dissipated, peak_load, work
from verify.methods.reference_mesh import reference_mesh
from verify.result import Result
from verify.verdict import Run, SceneReport

#: Quantities whose convergence is assessed, and the column that a run needs for them.
QUANTITIES: Mapping[str, tuple[Callable[[Result], float], str]] = {
    "peak load": (peak_load, "load"),
    "dissipated energy at the end": (dissipated, "dissipated_energy"),
    "work at the end": (work, "external_work"),
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
    found = []
    for method in dict.fromkeys(run.method for run in report.runs):
        runs = _meshes(report, method)
        results = [run.result for run in runs if run.result is not None]
        for quantity, (of, column) in QUANTITIES.items():
            ends = [result.steps.get(column, np.empty(0))[-1:] for result in results]
            if len(runs) >= FEWEST and all(np.isfinite(end).any() for end in ends):
                value = tuple(map(of, results))
                about = assess([1 / result.elements for result in results], value)
                found.append(Sequence(method, quantity, runs, value, about))
    return tuple(found)


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
