"""Kinks of the law on the way: which point reaches one next when the path goes on along its tangent."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from iga.cohesive import TractionLaw

#: How far beyond a kink a step that ends at one goes, in parts of the shortest branch of the law.
BEYOND = 1e-3


@dataclass(frozen=True)
class Event:
    """Point ``q`` reaches its next kink ``away`` lengths of the tangent on, and is just beyond it at ``beyond``."""

    q: int
    away: float
    beyond: float


def next_event(law: TractionLaw, g_q: np.ndarray, k_q: np.ndarray, rate_q: np.ndarray) -> Event | None:
    """The first kink on opening: at the strength, at the return to the envelope, on it, at the end of softening."""
    soft_q = (k_q > law.g_max) & (g_q >= (1.0 - 1e-9) * k_q)
    kinks = np.array(law.kinks)
    next_q = kinks[np.minimum(np.searchsorted(kinks, k_q, side="right"), kinks.size - 1)]
    kink_q = np.where(soft_q, next_q, np.maximum(k_q, law.g_max))
    coming_q = (k_q < law.g_u) & (rate_q > 0.0)
    if not np.any(coming_q):
        return None
    away_q = np.where(coming_q, (kink_q - g_q) / np.where(coming_q, rate_q, 1.0), np.inf)
    q = int(np.argmin(away_q))
    hair = BEYOND * float(np.min(np.diff(kinks, prepend=0.0)))
    return Event(q, float(away_q[q]), float(away_q[q] + hair / rate_q[q]))
