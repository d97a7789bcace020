"""Specimens in plain numbers: two AS4/PEEK arms that slide, a double cantilever that opens alone, strips on a layer."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np

from iga.elements.elasticity import orthotropic
from verify.methods.problems import arms_problem
from verify.result import steps_from_rows
from verify.scene.effects import simulated
from verify.scene.load import load_scene
from verify.theory.arms.problem import Arm, ArmsProblem, Load, Support
from verify.theory.arms.solve import solve
from verify.theory.law import Softened
from verify.theory.layer import Layer
from verify.theory.mixed_law import MixedBond
from verify.theory.solution import Solution

#: What lies beside the project, where it is.
SHARED = Path(__file__).parents[5] / "shared"

LAW = MixedBond("bilinear", (80.0, 100.0), (0.969, 1.719), (1e5, 1e5), 1e5, "bk", 2.284)
AS4 = {"E1": 122.7e3, "E2": 10.1e3, "G12": 5.5e3, "nu12": 0.25, "nu23": 0.45}
ARM = Arm(
    1.56,
    122.7e3 / (1 - 0.25**2 * 10.1 / 122.7),
    10.1e3 / (1 - 0.45**2),
    5.5e3,
    orthotropic(**AS4, plane="strain"),
)
#: Half span, width.
L, WIDTH = 51.0, 25.4


_SOLVED: dict[str, Solution] = {}


def roller(x: float, half: float = 0.0) -> tuple[float, float]:
    return max(x - half, 0.0), min(x + half, 2 * L)


def push(x: float, share: float, half: float = 0.0) -> Load:
    return Load(0, "top", share, roller(x, half))


def hold(body: int, x: float, half: float = 0.0) -> Support:
    return Support(body, "bottom", roller(x, half))


BELOW = hold(1, 0.0), hold(1, 2 * L)
GUIDED = Support(None, "right"), Support(None, "right", couple=True)
APART = Load(0, "left", 1.0), Load(1, "left", -1.0)

#: Of the rollers, points, so that closed forms hold.
ENF = ArmsProblem(
    (ARM, ARM), (2 * L, 2 * L), (39.3, 2 * L), WIDTH, (push(L, -1.0),), BELOW, LAW, 3.0, 60.0, 6.0, points=60
)
SLB = replace(ENF, supports=(hold(0, 0.0), hold(1, 2 * L)), bonded=(30.0, 2 * L), opening=5.0)
FOUR_POINT = replace(ENF, loads=(push(30.0, -0.5), push(72.0, -0.5)), bonded=(40.0, 2 * L))
ELS = replace(ENF, loads=(push(0.0, -1.0),), supports=GUIDED, bonded=(60.0, 2 * L), opening=20.0)
DCB = replace(ENF, loads=APART, supports=(), bonded=(30.0, 2 * L))


def mmb(lever: float, half: float = 0.0) -> ArmsProblem:
    """A mixed-mode bending test on rollers of the length 2 ``half``."""
    loads = push(0.0, lever / L, half), push(L, -(lever + L) / L, half)
    return replace(on_rollers(ENF, half), loads=loads, bonded=(34.1, 2 * L), opening=11.0)


def on_rollers(problem: ArmsProblem, half: float) -> ArmsProblem:
    """With supports below the lower arm, and a load at mid-span, on patches of the length 2 ``half``."""
    return replace(problem, loads=(push(L, -1.0, half),), supports=(hold(1, 0.0, half), hold(1, 2 * L, half)))


def moments(upper: float, lower: float) -> ArmsProblem:
    """Moments on the arms, above 0 where they bend them upwards."""
    loads = Load(0, "left", -upper, couple=True), Load(1, "left", -lower, couple=True)
    return replace(ENF, loads=loads, supports=GUIDED, bonded=(40.0, 2 * L), opening=0.2)


def opening_zone(arm: Arm, law: Softened) -> float:
    """(E G h^3 / p^2)^(1/4) and E G / p^2 in series (Williams and Hadavinia 2002)."""
    bulky = arm.young * law.toughness / law.strength**2
    return 1.0 / (1.0 / bulky + 1.0 / (bulky * arm.thickness**3) ** 0.25)


def reach(arm: Arm, toughness: float, opening: float | tuple[float, ...], arms: int = 2) -> float:
    """Length of the crack by simple beam theory, d = arms a^2/3 sqrt(2 G / (E I)), with G / 2 for each of two."""
    bending = arm.young * arm.thickness**3 / 12.0
    return float(np.sqrt(3.0 * np.max(opening) / arms * np.sqrt(arms * bending / (2.0 * toughness))))


def dcb(
    law: Softened,
    arm: Arm,
    length: float = 14.0,
    precrack: float = 4.0,
    opening: float | tuple[float, ...] = 1.0,
    **more: object,
) -> ArmsProblem:
    """A double cantilever of the width 1, of which one arm stands for both."""
    keys = {"points": 60, "zone": opening_zone(arm, law), "reach": reach(arm, law.toughness, opening), **more}
    one = ArmsProblem((arm,), (length,), (precrack, length), 1.0, APART, (), law, 1.0, 1.0, opening)
    return replace(one, **keys)


def peel(
    law: Softened, strip: Arm, layer: Layer, length: float, precrack: float, opening: float, **more: object
) -> ArmsProblem:
    """A strip of the width 1 whose right end is pulled off a layer."""
    zone = opening_zone(strip, law)
    keys = {"points": 60, "zone": zone, "reach": reach(strip, law.toughness, opening, 1), "loaded_at": length, **more}
    lengths, bonded, loads = (length, layer.length), (length - precrack, 0.0), (Load(0, "right", 1.0),)
    one = ArmsProblem((strip, layer), lengths, bonded, 1.0, loads, (), law, 1.0, 1.0, opening)
    return replace(one, **keys)


def of_scene(scene: str | Path, *changes: str, order: int = 1, **more: object) -> ArmsProblem:
    """The problem of a scene, as the method has it."""
    found = load_scene(str(scene), list(changes))
    effects = {**simulated(found), "search": False}
    return replace(arms_problem(found, effects, order), **more)


def solved(problem: ArmsProblem) -> Solution:
    """The solution, once for every problem."""
    key = repr(problem)
    if key not in _SOLVED:
        _SOLVED[key] = solve(problem)
    return _SOLVED[key]


def steps(problem: ArmsProblem) -> Mapping[str, np.ndarray]:
    """Columns of a run that completed."""
    found = solved(problem)
    assert found.status == "complete", found.status
    return steps_from_rows(found.rows)


def curve(problem: ArmsProblem) -> tuple[np.ndarray, np.ndarray]:
    s = steps(problem)
    return s["opening"], s["load"]


def ledger_error(problem: ArmsProblem) -> float:
    """Worst gap of the energies, of the last work."""
    s = steps(problem)
    gap = s["external_work"] - s["stored_energy"] - s["dissipated_energy"]
    return float(np.abs(gap).max() / np.abs(s["external_work"]).max())
