"""What a pass cannot see: changes of the scene that move its curve by less than the tolerance."""

from __future__ import annotations

from math import log1p
from pathlib import Path

import numpy as np

from verify.curves.curve import Curve
from verify.diagnosis.causes import choices
from verify.diagnosis.classify import of_reference, probed
from verify.diagnosis.solutions import solutions
from verify.scene.schema import Scene

#: Size of a change of a number whose effect is stated.
SIZE = 0.01


def blind_spots(name: str, scene: Scene, tolerance: float, end: float, expected: Curve, out: Path | None = None) -> str:
    """A sentence on what would move the curve, up to its ``end``, by less than the tolerance; empty where that is not
    known or nothing.

    Nothing is solved where the bond slides: a solution there takes seconds, and a pass must cost little.
    """
    if scene.specimen.slides:
        return ""
    right = np.asarray(expected[0], dtype=float), np.asarray(expected[1], dtype=float)
    solved = solutions(scene, min(end, max(scene.load.opening)), right, 0.3 * tolerance, out)
    base = solved.load() if solved is not None else None
    if solved is None or base is None:
        return ""
    size = float(np.linalg.norm(base))
    moved = {
        f"{number.name} off by {100 * SIZE:g} %": float(np.linalg.norm(load - base) / abs(amount)) * log1p(SIZE) / size
        for number, amount, load in probed(solved)
    }
    made = list(choices(scene))
    for one, load in zip(made, solved.loads([one.changed for one in made]), strict=True):
        moved[one.said] = np.inf if load is None else float(np.linalg.norm(load - base)) / size
    words = [f"{what} ({100 * part:.1g} %)" for what, part in moved.items() if part < tolerance]
    least = f"move the curve by less than {of_reference(tolerance)}"
    return f"{name}: passes, and would pass with any of these, which {least}: {'; '.join(words)}" if words else ""
