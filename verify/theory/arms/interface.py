"""The bond at points, step by step, in series with the compliance of the arms across and along their faces.

The jump of the beams is the jump (g, s) of the bond and what the arms give: beam jump = (g + c_n p, s + c_t t).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from verify.theory.mixed_law import MixedBond

#: Step of the difference quotients of the tractions, as a part of the jumps at onset.
TRACTION_STEP = 1e-6

#: Parts of a step in the integral of the energy that damage takes; the mode ratio may change in a step.
STEP_PARTS = 8


@dataclass(frozen=True)
class History:
    """What points remember, arrays of one shape: damage d, slip of friction, lambda of the last growth of damage, and
    energies per area that damage and friction took."""

    d: np.ndarray
    slip: np.ndarray
    norm: np.ndarray
    released: np.ndarray
    rubbed: np.ndarray

    @staticmethod
    def start(bonded: np.ndarray) -> History:
        """Points that were never bonded are as broken ones."""
        nothing = np.zeros(bonded.shape)
        return History(np.where(bonded, 0.0, 1.0), nothing, nothing, nothing, nothing)


@dataclass(frozen=True)
class Tractions:
    """Tractions p and t, damage and slip after a step."""

    p: np.ndarray
    t: np.ndarray
    d: np.ndarray
    slip: np.ndarray


@dataclass(frozen=True)
class Interface:
    """A law at all points of an interface.

    ``bonded`` : which points are bonded, or were
    ``give`` : (c_n, c_t) of the arms (length per stress)
    """

    law: MixedBond
    bonded: np.ndarray
    give: tuple[float, float]

    @property
    def scale(self) -> np.ndarray:
        """Jumps (2,) of a size at which damage begins."""
        return np.array(self.law.strength) / np.array(self.law.slopes)

    def tractions(self, g: np.ndarray, s: np.ndarray, before: History) -> Tractions:
        """The law of `MixedBond.path` from one point of a path to the next."""
        law, (K, Ks) = self.law, self.law.slopes
        asked = law.driving(g, s)
        d = np.where(self.bonded, np.maximum(asked, before.d) if law.irreversible else asked, 1.0)
        limit = law.friction * law.pressure(g)
        slip = np.clip(before.slip, s - limit / Ks, s + limit / Ks)
        t_f = law.rubbing_part(d) * np.clip(Ks * (s - before.slip), -limit, limit) if law.friction > 0.0 else 0.0
        p = np.where((g < 0.0) & law.contact, law.penalty, (1.0 - d) * K) * g
        return Tractions(p, (1.0 - d) * Ks * s + t_f, d, slip)

    def tangent(self, g: np.ndarray, s: np.ndarray, before: History) -> np.ndarray:
        """d(p, t)/d(g, s), (..., 2, 2), by difference quotients: a law here has no derivatives of its own.

        They are taken away from zero: at a jump of no size by one side of the law, and where damage has just stopped to
        grow by its growth.
        """
        now, columns = self.tractions(g, s, before), []
        for i, step in enumerate(TRACTION_STEP * self.scale):
            by = np.copysign(step, s if i else g)
            more = self.tractions(g if i else g + by, s + by if i else s, before)
            columns.append(np.stack([more.p - now.p, more.t - now.t], axis=-1) / by[..., None])
        return np.stack(columns, axis=-1)

    def progress(self, g: np.ndarray, s: np.ndarray) -> np.ndarray:
        """How far a jump is on its own: 1 where damage begins, 2 where the bond fails, beyond at the same rate."""
        law, norm = self.law, self.law.energy_norm(g, s)
        B = law.mode_ratio(g, s)
        G, onset = law.critical(B), law.onset_norm(B)
        if law.law == "exponential":
            return norm / np.sqrt(G)
        level = law.plateau if law.law == "trapezoidal" else 0.0
        width = (2.0 * G - onset**2) / ((1.0 + level) * onset)
        return np.where(norm <= onset, norm / onset, 1.0 + (norm - onset) / width)

    def advanced(self, jump: np.ndarray, jump_before: np.ndarray, before: History) -> History:
        """The history after a step, along which the jumps (..., 2) change evenly.

        Damage takes int lambda^2/2 dd, over a part of the step lambda_a lambda_b (d_b - d_a)/2, which is exact for the
        bilinear law at a constant mode ratio; friction takes mu q a |slip|.
        """
        law, now = self.law, self.tractions(jump[..., 0], jump[..., 1], before)
        grown = self.bonded & (now.d > before.d)
        released, d, last = before.released.copy(), before.d[grown], before.norm[grown]
        for part in np.linspace(0.0, 1.0, STEP_PARTS + 1)[1:]:
            g, s = ((1.0 - part) * jump_before[grown] + part * jump[grown]).T
            new = np.maximum(d, law.driving(g, s))
            norm = self._until_failure(g, s)
            released[grown] += 0.5 * np.where(d > 0.0, last, law.onset_norm(law.mode_ratio(g, s))) * norm * (new - d)
            d, last = new, np.where(new > d, norm, last)
        norm = before.norm.copy()
        norm[grown] = last
        rubbing = law.rubbing_part(now.d) * law.friction * law.pressure(jump[..., 0])
        rubbed = before.rubbed + rubbing * np.abs(now.slip - before.slip)
        return History(now.d, now.slip, norm, released, rubbed)

    def _until_failure(self, g: np.ndarray, s: np.ndarray) -> np.ndarray:
        """Lambda, at most that at which damage is complete: a step beyond takes no more."""
        norm, r = self.law.energy_norm(g, s), self.progress(g, s)
        if self.law.law == "exponential":
            return norm
        onset = self.law.onset_norm(self.law.mode_ratio(g, s))
        past = np.maximum(r, 2.0) - 1.0
        return onset + (norm - onset) / past
