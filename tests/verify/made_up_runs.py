"""Made-up runs of a scene, whose shape is that of real ones, for the tests of the report."""

from __future__ import annotations

import numpy as np

from verify.result import Result, Snapshot
from verify.scene.load import load_scene
from verify.verdict import Check, Run, SceneReport

LENGTH, ARM, PRECRACK = 14.0, 0.2, 4.0
ENVIRONMENT = {"python": "3.11", "numpy": "2.0", "machine": "x86_64, 2 cores", "threads": "1"}


def curve(wobble: float = 0.0, spacing: float = 0.125) -> dict[str, np.ndarray]:
    """A beam with a rounded peak: elastic branch, softening, then P = P(crack length); all columns close."""
    x = np.linspace(0, 3, 151)
    stiffness, toughness = 1.23, 0.1
    crack = np.maximum(5.1 * np.sqrt(x), PRECRACK)
    propagation = 0.4362 * np.maximum(x, 0.3) ** -0.5
    load = 1 / ((1 / np.maximum(stiffness * x, 1e-12)) ** 6 + propagation**-6.0) ** (1 / 6)
    load *= 1 + wobble * np.sin(2 * np.pi * crack / spacing) * (x > 0.7)
    j = np.minimum((x / 0.62) ** 2, 1.0) * (1 + 0.3 * wobble * np.sin(9 * x))
    work = np.concatenate([[0], np.cumsum(np.diff(x) * (load[1:] + load[:-1]) / 2)])
    stored = np.minimum(load * x / 2, work)
    return {
        "opening": x,
        "load": load,
        "crack_length": crack,
        "stored_energy": stored,
        "dissipated_energy": (work - stored) * (1 - 1e-5),
        "external_work": work,
        "newton_iterations": np.where(x > 0, 4.0, 0.0),
        "load_slope": np.gradient(load, x),
        "face_slope_top": np.divide(j * toughness, 2 * load, out=np.zeros_like(x), where=load > 0),
        "face_slope_bottom": -np.divide(j * toughness, 2 * load, out=np.zeros_like(x), where=load > 0),
        "face_energy": np.zeros_like(x),
        "cohesive_energy": 0.05 * stored,
    }


def snapshot(opening: float, tip: float, elements: int, ripple: float) -> Snapshot:
    """Two arms bent apart up to ``tip``, a bilinear traction ahead of it."""
    s = np.linspace(PRECRACK, LENGTH, 2 * elements + 1)
    gap = 0.05 * np.maximum(1 - (s - tip) / 0.9, 0) ** 2
    damage = np.clip((gap - 0.004) / (0.05 - 0.004), 0, 1)
    far = np.exp(-(s - tip) / 0.4) * np.cos((s - tip) / 0.4)
    traction = np.where(
        damage >= 1, 0, np.where(damage > 0, 4 * (0.05 - gap) / 0.046, 4 * far + ripple * np.sin(40 * s))
    )
    k = np.linspace(0, 1, 4)
    left = np.linspace(0, LENGTH, elements, endpoint=False)
    x = (left[:, None] + k * LENGTH / elements)[:, :, None] * np.ones(4)
    grids, shifts, stresses = [], [], []
    for sign in (1, -1):
        y = sign * ARM * k[None, None, :] * np.ones_like(x)
        bend = opening / 2 * np.maximum(1 - x / tip, 0) ** 2 * (1 + x / tip / 2)
        grids.append(np.stack([x, y], axis=-1))
        shifts.append(np.stack([0 * x, sign * bend], axis=-1))
        stresses.append(900 * np.maximum(1 - np.abs(x - tip) / tip, 0) * (1 - 2 * k) * np.ones_like(x))
    fields = (np.concatenate(part) for part in (grids, shifts, stresses))
    return Snapshot(opening, 0.4, s, gap, traction, damage, *fields)


def made_up(method: str, wobble: float, total: float, dofs: int, elements: int) -> Result:
    places = ((0.62, 4.2), (1.0, 5.1), (3.0, 9.0))
    snapshots = tuple(snapshot(o, tip, elements, 10 * wobble) for o, tip in places) if elements else ()
    shares = {"mesh": 0.02, "basis": 0.05, "assembly": 0.4, "factor": 0.35, "solve": 0.1, "other": 0.08}
    times = {name: share * total for name, share in shares.items()} | {"total": total}
    return Result(
        method,
        curve(wobble),
        dofs=dofs,
        elements=2 * elements,
        snapshots=snapshots,
        seconds=times,
        peak_memory_mb=180.0,
    )


def limit() -> Result:
    x = np.linspace(0, 3, 61)
    load = np.minimum(1.25 * x, 0.4362 * np.maximum(x, 0.1) ** -0.5)
    nothing = np.full_like(x, np.nan)
    names = ("crack_length", "stored_energy", "dissipated_energy", "external_work", "newton_iterations")
    return Result("lefm", {"opening": x, "load": load, **dict.fromkeys(names, nothing)})


def run(name: str, label: str, result: Result) -> Run:
    method = result.method
    return Run(label, method, result, "", f"{name}/{method}", f"debond solve {name} --method {method} --fields")


def scene_report(name: str = "dcb-czm1") -> SceneReport:
    runs = (
        run(name, "NURBS p=3, 1952 unknowns", made_up("nurbs", 8e-4, 8.7, 1952, 112)),
        run(name, "Lagrange p=3, 1952 unknowns", made_up("lagrange", 9e-3, 9.4, 1952, 40)),
        run(name, "DOLFINx p=2, 2700 unknowns", made_up("dolfinx", 4e-4, 11.2, 2700, 112)),
        run(name, "cohesive beam", made_up("beam", 0.0, 0.3, 0, 0)),
        run(name, "LEFM", limit()),
    )
    checks = (
        Check("j-integral", "nurbs", 1.4e-3, 5e-3, "exact", "J is the area under the traction law."),
        Check("j-integral", "dolfinx", 1.1e-3, 5e-3, "exact", "J is the area under the traction law."),
        Check("energy-ledger", "nurbs", 2.2e-5, 5e-3, "exact", "Work is stored or dissipated."),
        Check("interface-force", "nurbs", 3.1e-12, 1e-8, "exact", "The interface tractions carry the load."),
        Check("beam-curve", "nurbs / beam", 3.9e-3, 5e-3, "analytical", "The load follows that of a beam."),
        Check("curve", "nurbs / dolfinx", 1.2e-3, 3e-3, "cross-code", "Two codes draw the same curve."),
    )
    return SceneReport(load_scene("dcb-czm1").model_copy(update={"name": name}), runs, checks)
