"""Sets of steps of a run: loading steps, steps with an open tip, steps whose crack is far from the end."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from verify.scene.bond.opening import law_of
from verify.scene.schema import Scene
from verify.scene.specimens.delamination import Delamination
from verify.theory.law import KNOWN_LAWS

Steps = Mapping[str, np.ndarray]


def zone_is_new(scene: Scene, steps: Steps) -> np.ndarray:
    """Steps (n_steps,) at which no point of the process zone was damaged on an earlier leg of the programme.

    Arms that were pressed together reopen in another shape: the points of the old zone return to the envelope of the
    law one after the other, and J is not the area under the law until the zone has advanced by its own length. In a
    programme without negative openings all points return at once.
    """
    if min(scene.load.opening) >= 0.0 or not has(steps, "crack_length", "damage_front"):
        return np.ones(steps["opening"].size, dtype=bool)
    opening, start, reach = steps["opening"], 0, max(map(abs, scene.load.opening))
    starts = np.zeros(opening.size, dtype=int)  # the first step of the leg of every step
    for goal in scene.load.opening:
        arrived = np.flatnonzero(np.abs(opening[start:] - goal) <= 1e-9 * reach)
        if not arrived.size:
            break
        start += int(arrived[0])
        starts[start + 1 :] = start
    before = np.maximum.accumulate(steps["damage_front"])[starts]
    return np.where(before > scene.specimen.free_length, steps["crack_length"] >= before, True)


def tip_is_open(scene: Scene, steps: Steps) -> np.ndarray:
    """Steps (n_steps,) at which the tip of the precrack is fully open; for unknown laws, those with a grown crack."""
    if scene.interface.law in KNOWN_LAWS:
        return steps["tip_opening"] > law_of(scene).g_open
    return steps.get("crack_length", np.zeros(steps["opening"].size)) > scene.specimen.free_length


def end_area(scene: Scene, steps: Steps) -> np.ndarray:
    """Area under the law up to the gap at the far end (n_steps,)."""
    return law_of(scene).area(steps.get("end_opening", np.zeros(steps["opening"].size)))


def far_from_end(scene: Scene, steps: Steps) -> np.ndarray:
    """Steps (n_steps,) at which the far end carries less than a hundredth of G_Ic.

    Later the specimen rotates about its far end, where a spot of contact is smaller than an element.
    """
    return np.abs(end_area(scene, steps)) <= 0.01 * scene.interface.toughness


#: Distance from a load, a support or the far end, over the thickness of both arms, within which they affect a zone.
AWAY = 3.0


def zone_is_free(scene: Scene, steps: Steps) -> np.ndarray:
    """Steps (n_steps,) at which the damaged bond is away from the far end."""
    body = scene.specimen
    front = steps.get("damage_front", np.zeros(steps["load"].size))
    return front < body.extent - AWAY * sum(body.thicknesses)


def loading(steps: Steps) -> np.ndarray:
    """Steps (n_steps,) at which damage grows, and those before any damage."""
    dissipated = steps["dissipated_energy"]
    rounding = 1e-12 * np.max(dissipated, initial=0.0)
    return (np.diff(dissipated, prepend=0.0) > rounding) | (np.maximum.accumulate(dissipated) <= rounding)


def size(body: Delamination) -> float:
    """Sum of the magnitudes of the loads for a load of 1; couples are divided by the length."""
    return sum(abs(load.share) / (body.lengths[0] if load.couple else 1.0) for load in body.loads)


def has(steps: Steps, *names: str) -> bool:
    return all(name in steps for name in names)


def peak(values: np.ndarray) -> np.ndarray:
    return np.max(np.abs(values), initial=0.0, keepdims=True)


def scale(values: np.ndarray) -> np.ndarray:
    """The values as a divisor: 0 becomes the smallest float, so that only 0 / 0 is small."""
    return np.where(values == 0, np.finfo(float).tiny, values)


def worst(deviation: np.ndarray) -> float:
    return float(np.max(np.abs(deviation), initial=0.0))  # NaN stays NaN, and fails
