"""Rows of what accuracy costs, from made-up curves with exact slopes, against a made-up reference."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from verify.result import Result
from verify.runs.jobs import Job, Outcome
from verify.scene.load import load_scene
from verify.studies.cost.ladder import FAMILIES, Family, Try
from verify.studies.cost.reference import Reference
from verify.studies.cost.row import Row, row

SCENE = load_scene("dcb-czm1")
NURBS = next(family for family in FAMILIES if family.name == "nurbs-p3")


def made_up(scale: float = 1.0, wave: float = 0.0, end: float = 3.0, n: int = 40, **about) -> Result:
    """A curve with its exact slopes: P = s (1 + w sin 20 d) d exp(-d), and its own area as what is dissipated."""
    d = np.linspace(0.0, end, n + 1)
    hill, turn = scale * d * np.exp(-d), 1.0 + wave * np.sin(20.0 * d)
    slope = scale * (1.0 - d) * np.exp(-d) * turn + 20.0 * wave * np.cos(20.0 * d) * hill
    steps = {
        "opening": d, "load": hill * turn, "load_slope": slope, "heading": np.ones(n + 1),
        "dissipated_energy": scale * (1.0 - (1.0 + d) * np.exp(-d)), "newton_iterations": np.full(n + 1, 4.0),
    }  # fmt: skip
    phases = dict.fromkeys(("mesh", "basis", "assembly", "factor", "solve", "other"), 0.5)
    return Result("nurbs", steps, seconds={**phases, "total": 3.0}, **{"dofs": 1000, "elements": 100, **about})


def outcome(result: Result | None, why: str = "") -> Outcome:
    return Outcome(Job("x", SCENE, "nurbs", "x"), result, why, failed=bool(why))


def against(result: Result | None = None) -> Reference:
    sure = {"curve": 1e-4, "peak": 1e-4, "energy": 1e-4}
    return Reference("cubic NURBS", result or made_up(n=400), sure, 2.0)


def a_row(method: str, error: float, seconds: float, dofs: int = 500, degree: int = 3, asked: str = "80") -> Row:
    one = row(Try(Family(method, method, degree, 1.0), 0, dofs, asked), [outcome(made_up())], against())
    parts = {"assembly": 0.5 * seconds, "factor": 0.2 * seconds}
    return replace(one, curve_error=error, seconds=seconds, dofs=dofs, peak_memory_mb=100.0, **parts)
