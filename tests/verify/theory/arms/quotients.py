"""Difference quotients."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np


def derivative(value: Callable[[np.ndarray], np.ndarray], at: np.ndarray, step: float = 1e-6) -> np.ndarray:
    """Central quotients (..., n) of ``value`` (...) at points ``at`` (..., n), by the last axis."""
    shifts = step * np.eye(at.shape[-1])
    return np.stack([(value(at + e) - value(at - e)) / (2.0 * step) for e in shifts], axis=-1)
