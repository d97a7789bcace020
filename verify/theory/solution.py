"""What a theory returns of a run."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Solution:
    """Rows, status ("complete" or the reason of a stop), the number of steps that were made shorter, a sentence on a
    separation, snapshots, and the size of the model."""

    rows: tuple[Mapping[str, float], ...]
    status: str = "complete"
    rejected_steps: int = 0
    ending: str = ""
    snapshots: tuple[Mapping[str, object], ...] = ()
    dofs: int = 0
    elements: int = 0


def rows_of(columns: Mapping[str, np.ndarray]) -> tuple[dict[str, float], ...]:
    """Rows from columns (n,)."""
    return tuple(dict(zip(columns, map(float, row), strict=True)) for row in zip(*columns.values(), strict=True))
