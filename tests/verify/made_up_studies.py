"""Folders as ``debond cost``, ``effects``, ``vary`` and ``hard`` leave them, with made-up numbers."""

from __future__ import annotations

import json
from dataclasses import asdict, fields
from pathlib import Path

from verify.runs.folder import write_csv, write_json
from verify.studies.cost.row import Row as CostRow
from verify.studies.hard.one import Line, Verdict
from verify.studies.pairs import Row
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
        "reference": {"sentence": "Reference: cubic NURBS, 9000 unknowns; uncertainty (GCI): curve 0.020%."},
        "left_out": [],
        "source": source,
    }
    return _written(folder, "cost", CostRow, rows, about)


def pair(name: str, value: str, against: str, **known: object) -> Row:
    """A run against another, a hundredth off in all that is measured."""
    numbers = {f.name: {"float": 0.01, "int": 3}[f.type] for f in fields(Row) if f.type in ("float", "int")}
    words = {"name": name, "key": name, "value": value, "against": against, "scene_has": True, "status": "complete"}
    return Row(**numbers | words | known)


def effects(folder: Path, scene: str = "dcb-czm1") -> Path:
    """One effect that was switched, and one that could not be."""
    rows = [
        pair("contact", "true", "false", time_ratio=1.25),
        pair("symmetry", "true", "false", status="symmetry = true: stopped"),
    ]
    return _written(folder, "effects", Row, rows, {"scene": {"name": scene}, "left_out": [], "source": ""})


def vary(folder: Path, scene: str = "dcb-czm1") -> Path:
    """Three meshes."""
    rows = [pair("dofs", str(n), "4000", dofs=n, iteration=1e-5 * n) for n in (4000, 2000, 1000)]
    about = {"scene": {"name": scene}, "left_out": [], "source": "", "sentences": ["it grows"]}
    return _written(folder, "vary", Row, rows, about)


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


def _written(folder: Path, name: str, kind: type, rows: list, about: dict) -> Path:
    folder.mkdir(parents=True)
    write_csv(folder / f"{name}.csv", kind, rows)
    (folder / f"{name}.json").write_text(json.dumps(about))
    return folder
