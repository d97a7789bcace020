"""What a pass cannot see: changes of the scene that move its curve by less than the tolerance."""

from __future__ import annotations

from math import log1p

import numpy as np

from verify.diagnosis.causes import OTHER_CHOICES, SCALED_NUMBERS
from verify.diagnosis.classify import of_reference, sensitivity
from verify.diagnosis.solutions import solutions
from verify.scene.schema import Scene
from verify.support.progress import Progress

#: Size of a change of a number whose effect is stated.
SIZE = 0.01


def blind_spots(name: str, scene: Scene, tolerance: float, end: float) -> str:
    """A sentence on what would move the curve, up to its ``end``, by less than the tolerance; empty where that is not
    known or nothing.

    Nothing is solved where the bond slides: a solution there takes seconds, and a pass must cost little.
    """
    if scene.specimen.slides:
        return ""
    solved = solutions(scene, min(end, max(scene.load.opening)))
    base = solved.load() if solved.possible else None
    if base is None:
        return ""
    size = float(np.linalg.norm(base))
    numbers = [one for one in SCALED_NUMBERS if one.overrides(scene, 1.0)]
    moved: dict[str, float] = {}
    with Progress("what a pass cannot see", len(numbers) + len(OTHER_CHOICES)) as progress:
        for done, number in enumerate(numbers):
            slope = sensitivity(solved, number)
            part = np.inf if slope is None else float(np.linalg.norm(slope)) * log1p(SIZE) / size
            moved[f"{number.name} off by {100 * SIZE:g} %"] = part
            progress.advance(done + 1, number.name)
        for made in filter(None, (switch.made(scene) for switch in OTHER_CHOICES)):
            change = solved.change([made[0]])
            moved[made[1]] = np.inf if change is None else float(np.linalg.norm(change)) / size
    words = [f"{what} ({100 * part:.1g} %)" for what, part in moved.items() if part < tolerance]
    least = f"move the curve by less than {of_reference(tolerance)}"
    return f"{name}: passes, and would pass with any of these, which {least}: {'; '.join(words)}" if words else ""
