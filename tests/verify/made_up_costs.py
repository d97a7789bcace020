"""Made-up curves with exact slopes and energies, runs and rows of them, and a made-up reference."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace

import numpy as np
import pytest

from verify.result import Result
from verify.runs.jobs import Job, Outcome
from verify.scene.load import load_scene
from verify.studies import frame
from verify.studies.cost import study as cost_study
from verify.studies.cost.grid import FAMILIES, Family, Try
from verify.studies.cost.reference import Reference
from verify.studies.cost.row import Row, row

SCENE = load_scene("dcb-czm1")
NURBS = next(family for family in FAMILIES if family.name == "nurbs-p3")


def made_up(scale: float = 1.0, wave: float = 0.0, end: float = 3.0, n: int = 40, lost: float = 1.0, **about) -> Result:
    """A curve with its exact slopes: P = s (1 + w sin 20 d) d exp(-d). The area below s d exp(-d) is its work; what is
    not stored in half of the load times the opening is dissipated, or a part ``lost`` of that."""
    d = np.linspace(0.0, end, n + 1)
    hill, turn = scale * d * np.exp(-d), 1.0 + wave * np.sin(20.0 * d)
    slope = scale * (1.0 - d) * np.exp(-d) * turn + 20.0 * wave * np.cos(20.0 * d) * hill
    work = scale * (1.0 - (1.0 + d) * np.exp(-d))
    spent = lost * (work - 0.5 * d * hill)
    steps = {
        "opening": d, "load": hill * turn, "load_slope": slope, "heading": np.ones(n + 1), "external_work": work,
        "stored_energy": work - spent, "dissipated_energy": spent, "newton_iterations": np.full(n + 1, 4.0),
    }  # fmt: skip
    phases = dict.fromkeys(("mesh", "basis", "assembly", "factor", "solve", "other"), 0.5)
    known = {"dofs": 1000, "elements": 100, "seconds": {**phases, "total": 3.0}}
    return Result("nurbs", steps, **known | about)


def leaking(result: Result) -> Result:
    """The run with a quarter of its external work neither stored nor dissipated."""
    work = result.steps.get("external_work", np.linspace(0.0, 1.0, result.opening.size))
    lost = result.steps.get("dissipated_energy", 0.5 * work)
    energies = {"external_work": work, "stored_energy": 0.75 * work - lost, "dissipated_energy": lost}
    return replace(result, steps={**result.steps, **energies})


def planted(monkeypatch: pytest.MonkeyPatch, solver: Callable[[Job], Result], broken: str = "nothing") -> list[tuple]:
    """In place of the solvers, in this process; runs with ``broken`` in their name leak. Returns what is asked for:
    jobs, each with the runs at a time and the scheduler."""
    asked: list[tuple] = []

    def run_all(plan: Sequence[Job], out: object, jobs: int = 1, scheduler: str | None = None) -> Iterator[Outcome]:
        for job in plan:
            asked.append((job, jobs, scheduler))
            result = solver(job)
            yield Outcome(job, leaking(result) if broken in job.variant else result)

    for module in (frame, cost_study):
        monkeypatch.setattr(module, "run_all", run_all)
    return asked


def ladder(job: Job, size: float = 60.0) -> Result:
    """Curves whose error falls as the third power of the number of unknowns, which their time grows with."""
    scene = job.solved
    unknowns = 24 * scene.dolfinx.elements if job.method == "dolfinx" else scene.discretization.dofs
    found = made_up(1.0 + (size / unknowns) ** 3, dofs=unknowns, elements=unknowns, n=120)
    return replace(found, seconds={name: 1e-3 * unknowns * part for name, part in (found.seconds or {}).items()})


def outcome(result: Result | None, why: str = "") -> Outcome:
    return Outcome(Job("x", SCENE, "nurbs", "x"), result, why, failed=bool(why))


def against(result: Result | None = None) -> Reference:
    sure = {"curve": 1e-4, "peak": 1e-4, "energy": 1e-4}
    return Reference("cubic NURBS", result or made_up(n=400), sure, 2.0)


def a_row(method: str, error: float, seconds: float, dofs: int = 500, degree: int = 3, asked: str = "80") -> Row:
    one = row(Try(Family(method, method, degree, 1.0), dofs, asked), [outcome(made_up())], against())
    parts = {"assembly": 0.5 * seconds, "factor": 0.2 * seconds}
    return replace(one, curve_error=error, seconds=seconds, dofs=dofs, peak_memory_mb=100.0, **parts)
