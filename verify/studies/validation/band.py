"""Standard uncertainty of the load at every opening, for drawings."""

from __future__ import annotations

import numpy as np

from verify.studies.validation.quantities import loads
from verify.studies.validation.statement import OPENING_STEP, Curves, Known


def band(curves: Curves, known: Known, grid: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Load (n,) of the scene at openings ``grid`` (n,), and u (n,) of inputs, introduction of the load and data.

    The mesh is left out: its index describes single quantities, and not a steep drop that moves a little.
    """
    S = loads(curves.scene, grid)
    squares = [
        (known.inputs[key] * (loads(high, grid) - loads(low, grid)) / (2.0 * step)) ** 2
        for key, (step, low, high) in curves.inputs.items()
    ]
    if curves.places:
        squares.append(np.ptp([loads(one, grid) for one in curves.places.values()], axis=0) ** 2 / 12.0)
    over_opening = (loads(curves.scene, grid / (1 + OPENING_STEP)) - loads(curves.scene, grid / (1 - OPENING_STEP))) / (
        2.0 * OPENING_STEP
    )
    squares += [(known.data["data.load"] * S) ** 2, (known.data["data.opening"] * over_opening) ** 2]
    return S, np.sqrt(np.sum(squares, axis=0))
