"""What the columns of a run say of its path: the law, the steps that load, the ones far from the end."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from verify.scene.effects import simulated
from verify.scene.schema import Scene
from verify.theory.law import KNOWN_LAWS, Law

Steps = Mapping[str, np.ndarray]


def law_of(scene: Scene) -> Law:
    """The scene's traction law, in the copy that only checks and beam use; what all laws have where there is none."""
    i = scene.interface
    return KNOWN_LAWS.get(i.law, Law)(i.strength, i.toughness, i.ductility, i.penalty, simulated(scene)["contact"])


def zone_is_new(scene: Scene, steps: Steps) -> np.ndarray:
    """Steps (n_steps,) at which nothing in the process zone was damaged on an earlier leg of the programme.

    Pressed arms gape in another shape than opened ones: points of an old zone come back to the envelope one after the
    other, and until the zone has gone on by its own length J is not the area under the law. Of a programme that never
    goes below zero all come back at once.
    """
    if min(scene.load.opening) >= 0.0 or not has(steps, "crack_length", "damage_front"):
        return np.ones(steps["opening"].size, dtype=bool)
    before = np.maximum.accumulate(steps["damage_front"])[_start_of_leg(scene, steps)]
    return np.where(before > scene.specimen.free_length, steps["crack_length"] >= before, True)


def _start_of_leg(scene: Scene, steps: Steps) -> np.ndarray:
    """The step (n_steps,) at which the leg of the programme began on which each step lies."""
    opening, start, reach = steps["opening"], 0, max(map(abs, scene.load.opening))
    starts = np.zeros(opening.size, dtype=int)
    for goal in scene.load.opening:
        arrived = np.flatnonzero(np.abs(opening[start:] - goal) <= 1e-9 * reach)
        if not arrived.size:
            break
        start += int(arrived[0])
        starts[start + 1 :] = start
    return starts


def tip_is_open(scene: Scene, steps: Steps) -> np.ndarray:
    """Steps (n_steps,) at which nothing holds the tip of the bond any more; of a law that is not known, as is told."""
    if scene.interface.law in KNOWN_LAWS:
        return steps["tip_opening"] > law_of(scene).g_open
    return steps.get("crack_length", np.zeros(steps["opening"].size)) > scene.specimen.free_length


def far_from_end(scene: Scene, steps: Steps) -> np.ndarray:
    """Steps before the crack feels the far end: its contact holds less than a hundredth of G_Ic; bool (n_steps,).

    After that the specimen turns about its end, on a spot of contact smaller than an element.
    """
    end = steps.get("end_opening", np.zeros(steps["opening"].size))
    return np.abs(law_of(scene).area(end)) <= 0.01 * scene.interface.toughness


def loading(steps: Steps) -> np.ndarray:
    """Steps at which damage grows, and those before any: bool (n_steps,)."""
    dissipated = steps["dissipated_energy"]
    rounding = 1e-12 * np.max(dissipated, initial=0.0)
    return (np.diff(dissipated, prepend=0.0) > rounding) | (np.maximum.accumulate(dissipated) <= rounding)


def has(steps: Steps, *names: str) -> bool:
    return all(name in steps for name in names)


def peak(values: np.ndarray) -> np.ndarray:
    return np.max(np.abs(values), initial=0.0, keepdims=True)


def scale(values: np.ndarray) -> np.ndarray:
    """A divisor: where nothing has happened yet, only nothing may deviate."""
    return np.where(values == 0, np.finfo(float).tiny, values)


def worst(deviation: np.ndarray) -> float:
    return float(np.max(np.abs(deviation), initial=0.0))  # NaN stays NaN, and fails
