"""Displacement paths of one point as straight legs between corners, with steps where the law has kinks."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from verify.theory.mixed_law import MixedBond

Corner = tuple[float, float]

#: Two jumps have the same mode ratio if the sine of the angle between them in the energy norm is below this.
_SAME_MODE = 1e-9
#: Steps closer than this part of a leg are merged.
_SAME_STEP = 1e-9


@dataclass(frozen=True, eq=False)
class JumpPath:
    """Openings ``g`` (n,) and slips ``s`` (n,) [length] at every step; step 0 is the undamaged state.

    Time goes from 0 to 1 in equal steps. ``ratio`` is the mode ratio by energy of a path that goes straight from rest
    to failure. ``pressure`` [stress] is the constant pressure of a path that slides to failure under it.
    """

    name: str
    what: str  # one sentence for the reader of the page
    g: np.ndarray
    s: np.ndarray
    ratio: float | None = None
    pressure: float | None = None

    @property
    def time(self) -> np.ndarray:
        """Of each step (n,), 0 to 1."""
        return np.linspace(0.0, 1.0, self.g.size)

    @property
    def dt(self) -> float:
        """Time of a step."""
        return 1.0 / (self.g.size - 1)

    @property
    def straight(self) -> np.ndarray:
        """Whether the path goes through a step (n,) without a turn; not at its ends."""
        dg, ds = np.diff(self.g), np.diff(self.s)
        ahead = dg[1:] * dg[:-1] + ds[1:] * ds[:-1]
        aside = dg[1:] * ds[:-1] - ds[1:] * dg[:-1]
        return np.concatenate([[False], (ahead > 0.0) & (np.abs(aside) <= 1e-6 * ahead), [False]])


def legs(bond: MixedBond, corners: Sequence[Corner], steps: int | Sequence[int], kinks: Sequence[float]) -> np.ndarray:
    """Jumps (n, 2) on the way from corner to corner, each leg in ``steps`` equal parts.

    Where a leg keeps its mode ratio, it has steps at the ``kinks`` [lambda] that it passes as well.
    """
    counts = [steps] * (len(corners) - 1) if isinstance(steps, int) else steps
    parts = [np.array(corners[:1], float)]
    for a, b, n in zip(corners[:-1], corners[1:], counts, strict=True):
        at = _with_kinks(bond, a, b, np.linspace(0.0, 1.0, n + 1), kinks)[1:, None]
        parts.append(np.where(at == 1.0, b, np.array(a) + at * (np.array(b) - np.array(a))))
    return np.concatenate(parts)


def _with_kinks(bond: MixedBond, a: Corner, b: Corner, at: np.ndarray, kinks: Sequence[float]) -> np.ndarray:
    """Parts of the way from a to b (n,), those with steps at the kinks if the mode ratio is the same on the leg."""
    (K, Ks), size = bond.slopes, np.hypot
    (x, y), (u, v) = ((max(g, 0.0) * K**0.5, s * Ks**0.5) for g, s in (a, b))
    if abs(x * v - y * u) > _SAME_MODE * size(x, y) * size(u, v) or x * u + y * v < 0.0 or min(a[0], b[0]) < 0.0 < u:
        return at
    before, after = size(x, y), size(u, v)
    if before == after:
        return at
    inner = np.array([(kink - before) / (after - before) for kink in kinks])
    every = np.sort(np.concatenate([at, inner[(inner > 0.0) & (inner < 1.0)]]))
    return every[np.append(True, np.diff(every) > _SAME_STEP)]
