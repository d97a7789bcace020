"""The middle of a step (see `verify.curves.curve.dense`): straight lines between rows draw a curve of few steps."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from verify.curves.curve import dense
from verify.result import CURVE_COLUMNS, SLIDING_COLUMNS

#: What the cubic of a step is drawn by, and what a row must have besides: its ledger.
OF_CUBICS = ("opening", "load", "load_slope", "heading")
NEEDED = frozenset({*OF_CUBICS, "stored_energy", "dissipated_energy", "external_work"})

#: Parts of a step over which its work is added up; an even number.
WORK_PARTS = 16


class Middles:
    """The middle of every step of a path, as its rows come."""

    def __init__(self) -> None:
        self._before: Mapping[str, float] | None = None
        self._size = np.zeros(2)

    def __call__(self, row: Mapping[str, float]) -> dict[str, float] | None:
        """The columns of the curve between the row before and this one; None for the first one, and without slopes.

        Opening and load are on the cubic of the step (`verify.curves.curve.dense`), the work is that along it, and the
        crack, what is dissipated and the J-integrals have gone half way, which leaves to be stored what keeps the
        ledger as it is at both ends. ``newton_iterations`` is 0, as nothing has been solved.
        """
        before, self._before = self._before, row
        self._size = np.maximum(self._size, np.abs([row["opening"], row["load"]]))
        if before is None or not NEEDED <= row.keys():
            return None
        d, P, slope, heading = (np.array([before[name], row[name]]) for name in OF_CUBICS)
        energy = [row["stored_energy"] + row["dissipated_energy"] for row in (before, row)]
        d, P = dense(d, P, slope, heading, WORK_PARTS, self._size, energy)
        half = WORK_PARTS // 2
        mean = {name: 0.5 * (before[name] + row[name]) for name in (*CURVE_COLUMNS, *SLIDING_COLUMNS) if name in row}
        more = float(np.trapezoid(P[: half + 1], d[: half + 1]) - 0.5 * np.trapezoid(P, d))
        by_cubic = {"opening": float(d[half]), "load": float(P[half]), "newton_iterations": 0.0}
        return mean | by_cubic | {name: mean[name] + more for name in ("stored_energy", "external_work")}
