"""Distance of tractions from those of the definition, in parts of the strengths."""

from __future__ import annotations

import numpy as np

from verify.studies.law.given.answer import Answer
from verify.theory.mixed_law import MixedBond


def apart(bond: MixedBond, given: Answer, expected: Answer) -> np.ndarray:
    """Distance (n,) of the tractions at the steps of a path, ``sqrt((dp / p_s)^2 + (dt / t_s)^2)``.

    The scales are the strengths, or the largest tractions of ``expected`` where these are larger, as in contact.
    """
    p, t = (max(one, float(np.abs(x).max())) for one, x in zip(bond.strength, (expected.p, expected.t), strict=True))
    return np.hypot((given.p - expected.p) / p, (given.t - expected.t) / t)


def mean_square(distance: np.ndarray) -> float:
    """Mean square of the distances (n,) at the steps of one path."""
    return float(np.mean(distance**2))


def work(g: np.ndarray, s: np.ndarray, answer: Answer) -> float:
    """Work of the tractions along a path, by the trapezoid rule."""
    p, t = (0.5 * (one[1:] + one[:-1]) for one in (answer.p, answer.t))
    return float(p @ np.diff(g) + t @ np.diff(s))
