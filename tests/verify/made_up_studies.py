"""Folders as ``debond cost``, ``effects``, ``scaling`` and ``hard`` leave them, with made-up numbers."""

from __future__ import annotations

import json
from dataclasses import asdict, fields, replace
from pathlib import Path

from verify.runs.folder import write_csv, write_json
from verify.scene.load import load_scene
from verify.studies.cost.row import Row as CostRow
from verify.studies.effects.row import Row as EffectRow
from verify.studies.hard.one import Line, Verdict
from verify.studies.scaling.row import Row as ScalingRow
from verify.studies.scaling.study import Study
from verify.verdict import Check


def cost(folder: Path, scene: str = "dcb-czm1", source: str = "") -> Path:
    """Four runs of two methods, one of which stopped."""
    rows = [
        _cost("nurbs", 3, 500, 0.004, 0.5),
        _cost("nurbs", 3, 2000, 0.0005, 2.0),
        _cost("dolfinx", 2, 2700, 0.0008, 3.0),
        _cost("dolfinx", 1, 900, float("nan"), float("nan")),
    ]
    about = {
        "scene": {"name": scene},
        "reference": {
            "label": "cubic NURBS",
            "dofs": 9000,
            "uncertainty": {"curve": 0.0002},
            "other_code": "DOLFINx of degree 3",
            "other_code_apart": 0.0003,
        },
        "left_out": [],
        "source": source,
    }
    return _written(folder, "cost", CostRow, rows, about)


def effects(folder: Path, scene: str = "dcb-czm1") -> Path:
    """One effect that was switched, and one that could not be."""
    numbers = {f.name: 0.01 for f in fields(EffectRow) if f.type == "float"}
    words = {"with_it": "on", "without": "off", "scene_has": True, "times": 3}
    rows = [
        EffectRow(effect="contact", key="contact", status="complete", **words, **numbers | {"time_ratio": 1.25}),
        EffectRow(effect="symmetry", key="symmetry", status="with it: stopped", **words, **numbers),
    ]
    return _written(folder, "effects", EffectRow, rows, {"scene": {"name": scene}, "left_out": [], "source": ""})


def scaling_study(scene: str = "dcb-czm1") -> Study:
    """Three sizes by NURBS, and two by DOLFINx on one rank and on two, which share the assembly alone."""
    rows = [replace(_scaling("nurbs", 1, 0, 1e-3), bare=True)]  # what the program takes
    rows += [_scaling("nurbs", 1, dofs, 1e-5 * dofs) for dofs in (2000, 10_000, 100_000)]
    for dofs in (20_000, 100_000):
        rows += [_scaling("dolfinx", 1, dofs, 2e-5 * dofs), _scaling("dolfinx", 2, dofs, 1.5e-5 * dofs)]
    given = load_scene("dcb-czm1").model_copy(update={"name": scene})
    return Study(given, tuple(rows), ("4 ranks: left out: 2 cores here",), (0.0, 0.0))


def scaling(folder: Path, scene: str = "dcb-czm1") -> Path:
    """That study in files."""
    study = scaling_study(scene)
    path = _written(folder, "scaling", ScalingRow, list(study.rows), {})
    write_json(folder / "scaling.json", study.summary() | {"source": ""})
    return path


def hard(folder: Path) -> Path:
    """One case that holds on NURBS and not on T-splines."""
    for basis, ledger in (("nurbs", 1e-5), ("tspline", 0.5)):
        check = Check("energy-ledger", "base", ledger, 0.01, "exact", "The ledger closes.")
        line = Line("base", "complete", 40, 2, ledger, 1e6, 1.5)
        there = folder / "coarse-czm2" / basis
        there.mkdir(parents=True)
        write_json(there / "verdict.json", asdict(Verdict("coarse-czm2", basis, (line,), (check,), ())))
    return folder


def _cost(method: str, degree: int, dofs: int, error: float, seconds: float) -> CostRow:
    numbers = {f.name: error for f in fields(CostRow) if f.type == "float"}
    counts = {f.name: 40 for f in fields(CostRow) if f.type == "int"}
    words = {"asked": "80", "run": f"cost/{method}-p{degree}-{dofs}", "status": "complete"}
    known = {"method": method, "degree": degree, "dofs": dofs, "seconds": seconds, "peak_memory_mb": 100.0}
    return CostRow(**numbers | counts | words | known)


def _scaling(method: str, ranks: int, dofs: int, iteration: float) -> ScalingRow:
    parts = {"assembly": 0.5 / ranks, "factor": 0.3, "solve": 0.1, "other": 0.1}
    numbers = {name: part * iteration / sum(parts.values()) for name, part in parts.items()}
    words = {"bare": False, "run": f"scaling/{method}-{dofs}", "status": "complete"}
    counts = {"degree": 2, "elements": dofs // 12, "newton_iterations": 40, "nonzeros": 0, "times": 3}
    head = {"method": method, "ranks": ranks, "dofs": dofs, "iteration": iteration}
    return ScalingRow(**head, **numbers, **counts, **words, spread=1.05, set_up=1.0, peak_memory_mb=90 + 0.01 * dofs)


def _written(folder: Path, name: str, kind: type, rows: list, about: dict) -> Path:
    folder.mkdir(parents=True)
    write_csv(folder / f"{name}.csv", kind, rows)
    (folder / f"{name}.json").write_text(json.dumps(about))
    return folder
