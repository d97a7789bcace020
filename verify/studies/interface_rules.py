"""Traction oscillation against the interface rule, its number of points and the initial stiffness.

A stiff cohesive law couples the openings of neighbouring points through their common shape functions, and the traction
ahead of the crack alternates. For Lagrange elements Lobatto points at the nodes help (Schellekens and de Borst 1993);
for splines they do not, but lumping at the control points does (Vignollet, May, de Borst 2015).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from verify.methods.solve import solve
from verify.result import Result, Snapshot
from verify.scene.load import load_scene
from verify.scene.schema import Scene

COMPARED = ("nurbs", "lagrange")
RULES = (("gauss", 2), ("gauss", 4), ("gauss", 8), ("lobatto", 2), ("lobatto", 4), ("lobatto", 8), ("lumped", None))

#: g_u / g_max: from that of the scene to an interface that is stiffer than the arm through its thickness, E / h.
DUCTILITIES = (12.5, 50.0, 500.0, 50_000.0)

#: One arm whose bond is no longer than the crack path, so that all elements along it are equal; about 260 unknowns,
#: opened to just past the peak in a few steps.
SMALL = (
    "effects.symmetry=true",
    "effects.kinematics='linear'",
    "specimen.length=6.45",
    "discretization.dofs=260",
    "discretization.steps=16",
    "load.opening=0.8",
)


@dataclass(frozen=True)
class Trial:
    """One run: RMS of the oscillation over its snapshots, and the snapshot to draw."""

    method: str
    rule: str
    points: int | None
    ductility: float
    oscillation: float
    profile: Snapshot | None
    status: str


@dataclass(frozen=True)
class Study:
    """All trials, and the traction of the beam on the same law for each ductility."""

    scene: Scene
    trials: tuple[Trial, ...]
    beams: tuple[tuple[float, Snapshot], ...]

    def of(self, method: str, rule: str, points: int | None, ductility: float) -> Trial:
        key = (method, rule, points, ductility)
        return next(t for t in self.trials if (t.method, t.rule, t.points, t.ductility) == key)


def study(
    methods: Sequence[str] = COMPARED,
    rules: Sequence[tuple[str, int | None]] = RULES,
    ductilities: Sequence[float] = DUCTILITIES,
    on_trial: Callable[[Trial], None] = lambda trial: None,
) -> Study:
    """Solve the small beam with every rule; some 15 s for all."""
    trials, beams = [], []
    for ductility in ductilities:
        exact = solve(_scene(ductility), "beam").snapshots
        beams.append((ductility, exact[_SHOWN]))
        for method in methods:
            for rule, points in rules:
                trials.append(_trial(method, rule, points, ductility, exact))
                on_trial(trials[-1])
    return Study(_scene(ductilities[0]), tuple(trials), tuple(beams))


def excess_variation(snapshot: Snapshot, strength: float) -> float:
    """Total variation of the traction beyond one rise and one dip, relative to the strength.

    Up to the strength, down to the largest compression ahead of the crack and back to zero is ``2 (max - min)``.
    """
    p = np.concatenate([[0.0], snapshot.traction_q, [0.0]])
    return float((np.abs(np.diff(p)).sum() - 2.0 * np.ptp(p)) / strength)


def finding(found: Study) -> str:
    """The result for the stiffest interface in one sentence: oscillations over the strength."""
    ductility, words = max(trial.ductility for trial in found.trials), []
    for method, name in (("nurbs", "NURBS"), ("lagrange", "Lagrange elements")):
        gauss, lobatto, lumped = (
            found.of(method, rule, points, ductility).oscillation
            for rule, points in (("gauss", 2), ("lobatto", 4), ("lumped", None))
        )
        numbers = f"{gauss:.0%} with 2 Gauss points, {lobatto:.0%} with 4 Lobatto points, {lumped:.0%} lumped"
        words.append(f"with {name} {numbers}: lumping {'cures' if lumped < 0.1 * gauss else 'does not cure'} it")
    return f"Traction oscillation relative to the strength at ductility {ductility:g}: {'; '.join(words)}"


#: Index of the snapshot that is drawn: at half of the opening the peak traction has just left the precrack.
_SHOWN = 2


def _trial(method: str, rule: str, points: int | None, ductility: float, exact: Sequence[Snapshot]) -> Trial:
    keys = [f"discretization.interface_rule='{rule}'"]
    keys += [f"discretization.interface_points={points}"] if points else []
    scene = _scene(ductility, *keys)
    try:
        result = solve(scene, method)
    except Exception as error:  # a rule that fails is a result, and the other runs go on
        return Trial(method, rule, points, ductility, float("nan"), None, f"failed: {type(error).__name__}: {error}")
    profile = result.snapshots[_SHOWN] if len(result.snapshots) > _SHOWN else None
    return Trial(method, rule, points, ductility, _oscillation(scene, result, exact), profile, result.status)


def _oscillation(scene: Scene, result: Result, exact: Sequence[Snapshot]) -> float:
    """RMS over the snapshots of the excess variation beyond that of the beam's traction, which oscillates a little."""
    if not result.snapshots:
        return float("nan")
    strength = scene.interface.strength
    beyond = [
        max(excess_variation(own, strength) - excess_variation(beam, strength), 0.0)
        for own, beam in zip(result.snapshots, exact, strict=False)
    ]
    return float(np.sqrt(np.mean(np.square(beyond))))


def _scene(ductility: float, *keys: str) -> Scene:
    """The scene with the contact penalty equal to the initial stiffness of the law."""
    plain = load_scene("dcb-czm1", [*SMALL, f"interface.ductility={ductility}"])
    g_max = 2.0 * plain.interface.toughness / plain.interface.strength / ductility
    penalty = f"interface.penalty={plain.interface.strength / g_max}"
    return load_scene("dcb-czm1", [*SMALL, f"interface.ductility={ductility}", penalty, *keys])
