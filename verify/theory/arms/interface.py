"""The bond at the points of the interface, step by step, in series with what the arms give beyond their model.

The jump of the faces of the arms is the jump of the bond and what the arms give: (g + c_n p, s + c_t t). Jumps and
tractions have one component where the bond opens alone, and two where it slides.

What a plane arm gives at a crack tip beyond a beam: extra crack lengths, and the compliances that stand for them.

A beam that is clamped at the tip is too stiff. Effective crack lengths are a + D_I in opening and a + D_II in sliding,

    D_I = chi h,  D_II = 0.42 chi h

with the chi of `verify.theory.lefm` (Wang and Williams 1992, Compos. Sci. Technol. 43; ASTM D6671). Two equal
Timoshenko arms on an even foundation of the compliances c_n and c_t (length per stress) have

    D_I^2 = 2 sqrt(E h^3 c_n / 24) + E h^2 / (12 kappa G),  D_II^2 = E h c_t / 8,  kappa = 5/6,

from the decay of opening, whose rates a, b have a b = sqrt(24 / (E h^3 c_n)) and D_I = 1/a + 1/b, and from that of
slip, s'' = 8 s / (E h c_t). Solved for c_n and c_t, half of each belongs to an arm.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from verify.theory.arms.problem import Arm
from verify.theory.arms.sections import SHEAR_CORRECTION
from verify.theory.law import KnownLaw
from verify.theory.lefm import chi
from verify.theory.mixed_law import MixedBond

#: Part of the extra crack length in opening that it has in sliding (ASTM D6671).
SLIDING_PART = 0.42

#: Least part of D_I^2 that is left for the foundation: in arms that hardly bend beside their shear the formula leaves
#: none.
LEAST_FOUNDATION = 0.02

#: Part of its toughness that a bond and what the arms give hold in a mode at its strength, at most. With all of it or
#: more the crack would not grow at J = G_c: the tip would give way before it has the strength. Likewise the arms
#: spring back by at most this part of what a bond opens as it softens: with all of it no equilibrium would follow.
MOST_HELD = 0.75

#: Step of the difference quotients of damage and progress, as a part of the jumps at onset.
LAW_STEP = 1e-6

#: A part that is the whole but for rounding: of onset, of damage that grows again, of the limit of friction.
NEARLY = 1.0 - 1e-9

#: Part of the change of the jumps that may be left beyond the travelled profile where a crack has run on.
BEYOND_TRAVEL = 0.5

#: Parts of a step in the integral of the energy that damage takes; the mode ratio may change in a step.
STEP_PARTS = 8

#: The jumps (q, J) at a part of a step; damage or progress by gap and slip.
Way = Callable[[float], np.ndarray]
Value = Callable[[np.ndarray, np.ndarray], np.ndarray]


@dataclass(frozen=True)
class History:
    """What points (E, q) remember: damage d, slip of friction, lambda of the last growth of damage, progress as far as
    it counted, and energies per area that damage and friction took."""

    d: np.ndarray
    slip: np.ndarray
    norm: np.ndarray
    progress: np.ndarray
    released: np.ndarray
    rubbed: np.ndarray


class Response(NamedTuple):
    """Tractions (E, q, J), their tangent (E, q, J, J), damage and slip (E, q) after a step."""

    traction: np.ndarray
    tangent: np.ndarray
    d: np.ndarray
    slip: np.ndarray


@dataclass(frozen=True)
class Interface:
    """A bond at all points of an interface.

    ``bonded`` (E, q) : which points are bonded, or were
    ``give`` (J,) : compliances of the arms (length per stress)
    ``x`` (E, q) : where the points are
    """

    bond: KnownLaw | MixedBond
    bonded: np.ndarray
    give: np.ndarray
    x: np.ndarray

    @property
    def components(self) -> int:
        return 2 if self.bond.slides else 1

    @property
    def intact(self) -> History:
        """Points that were never bonded are as broken ones."""
        return History(np.where(self.bonded, 0.0, 1.0), *np.zeros((5, *self.bonded.shape)))

    def split(self, jump: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Gap and slip."""
        return jump[..., 0], jump[..., 1] if self.bond.slides else np.zeros(jump.shape[:-1])

    def respond(self, jump: np.ndarray, before: History, frozen: bool = False) -> Response:
        """The law from one state to the next, with the damage of the last one where it is ``frozen``.

        The tangent of a point whose damage, or slip, has just stopped to grow is that of its growth, but where frozen.
        """
        bond, (K, Ks) = self.bond, self.bond.slopes
        g, s = self.split(jump)
        d, slope = before.d, np.zeros(jump.shape)
        if not frozen:
            d, slope = self._grown(bond.driving, jump, before.d)
        pressed = (g < 0.0) & bond.contact
        whole = 1.0 - d
        normal = np.where(pressed, bond.penalty, whole * K)
        traction, tangent = np.empty_like(jump), np.zeros((*jump.shape, jump.shape[-1]))
        traction[..., 0], tangent[..., 0, 0] = normal * g, normal
        tangent[..., 0, :] -= np.where(pressed, 0.0, K * g)[..., None] * slope
        slip = before.slip
        if isinstance(bond, MixedBond):
            traction[..., 1], tangent[..., 1, 1] = whole * Ks * s, whole * Ks
            rubbed = 0.0
            if bond.friction > 0.0:
                limit = bond.friction * bond.pressure(g)
                stuck = Ks * (s - before.slip)
                sliding = ~pressed | (np.abs(stuck) > (limit / NEARLY if frozen else limit * NEARLY))
                rubbed, a = np.clip(stuck, -limit, limit), bond.rubbing_part(d)
                slip = np.clip(before.slip, s - limit / Ks, s + limit / Ks)
                traction[..., 1] += a * rubbed
                tangent[..., 1, 1] += np.where(sliding, 0.0, a * Ks)
                tangent[..., 1, 0] -= np.where(
                    sliding & pressed, a * np.sign(stuck) * bond.friction * bond.penalty, 0.0
                )
                rubbed = rubbed * (bond.rubbing_part(np.minimum(d + 1e-7, 1.0)) - a) / 1e-7
            tangent[..., 1, :] -= (Ks * s - rubbed)[..., None] * slope
        return Response(traction, tangent, d, slip)

    def growth(self, jump: np.ndarray, before: History) -> tuple[np.ndarray, np.ndarray]:
        """Progress (E, q) of points from onset to failure, 0 to 1, as far as damage has gone, and its derivative by the
        jump (E, q, J) where it grows."""
        return self._grown(lambda g, s: self.bond.progress(g, s) - 1.0, jump, before.progress)

    def _grown(self, value: Value, jump: np.ndarray, old: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """What a jump asks for, at least as much as there was, and its derivative by the jump where it grows.

        Derivatives are quotients away from zero. Points without damage, and those never bonded, have what they had.
        """
        (g, s), start = self.split(jump), old if self.bond.irreversible else np.where(self.bonded, 0.0, old)
        at = np.nonzero(self.bonded & (self.bond.progress(g, s) >= NEARLY))
        asked, new, slope = value(g[at], s[at]), start.copy(), np.zeros(jump.shape)
        new[at] = np.maximum(start[at], np.clip(asked, 0.0, 1.0))
        grows = (asked >= start[at] * NEARLY) & (asked > 0.0) & (asked < 1.0)
        there = tuple(index[grows] for index in at)
        for i, step in enumerate(LAW_STEP * self.bond.scale):
            by = np.copysign(step, (g, s)[i][there])
            column = slope[..., i]
            column[there] = (value(g[there] + (1 - i) * by, s[there] + i * by) - asked[grows]) / by
        return new, slope

    def advanced(self, jump: np.ndarray, jump_before: np.ndarray, before: History) -> History:
        """The history after a step, of jumps (E, q, J) before and after it."""
        now = self.respond(jump, before)
        history = replace(before, d=now.d, slip=now.slip, progress=self.growth(jump, before)[0])
        if not isinstance(self.bond, MixedBond):
            k = np.where(self.bonded, np.maximum(jump[..., 0], before.norm if self.bond.irreversible else 0.0), 0.0)
            return replace(history, norm=k, released=self.bond.dissipated(k))
        released, norm = self._released(self.bond, jump, jump_before, before, now.d)
        rubbing = [
            self.bond.rubbing_part(d) * self.bond.friction * self.bond.pressure(one[..., 0])
            for d, one in ((before.d, jump_before), (now.d, jump))
        ]
        rubbed = before.rubbed + 0.5 * sum(rubbing) * np.abs(now.slip - before.slip)
        return replace(history, norm=norm, released=released, rubbed=rubbed)

    def _released(
        self, law: MixedBond, jump: np.ndarray, jump_before: np.ndarray, before: History, d_after: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Energy per area that damage took, and lambda of its last change.

        Damage takes int lambda^2/2 dd, over a part of the step lambda_a lambda_b (d_b - d_a)/2, which is exact for the
        bilinear law at a constant mode ratio, and gives it back where it heals. A step beyond failure takes no more.
        """
        bonded, changed = self.bonded, self.bonded & (d_after != before.d)
        released, norm, d, last = before.released.copy(), before.norm.copy(), before.d[changed], before.norm[changed]
        ends = jump_before[bonded], jump[bonded]
        jumps = way(self.x[bonded], tuple(law.progress(*one.T) - 1.0 for one in ends), ends)
        for part in np.linspace(0.0, 1.0, STEP_PARTS + 1)[1:]:
            g, s = jumps(part)[changed[bonded]].T
            B, new, now = law.mode_ratio(g, s), law.driving(g, s), law.energy_norm(g, s)
            if law.irreversible:
                new = np.maximum(d, new)
            if law.law != "exponential":
                now = np.minimum(now, law.corners(B)[-1])
            ends_at = (np.where(at > 0.0, norm_at, law.onset_norm(B)) for at, norm_at in ((d, last), (new, now)))
            released[changed] += 0.5 * np.prod(list(ends_at), axis=0) * (new - d)
            d, last = new, np.where(new != d, now, last)
        norm[changed] = last
        return released, norm


def way(x: np.ndarray, reached: Sequence[np.ndarray], jumps: tuple[np.ndarray, np.ndarray]) -> Way:
    """The way of the jumps on a step: they change evenly, or travel with a crack that runs on.

    While a crack runs its profile of jumps travels along the bond and changes little: a point that it passes has had,
    one after the other, the jumps of the points behind it.

    x : places (q,) of the points
    reached : progress (q,) of the points before and after, 0 at onset and 1 at failure
    jumps : (q, J) before and after
    """
    (before, after), order = jumps, np.argsort(x)

    def travelled(distance: float) -> np.ndarray:
        return np.stack([np.interp(x - distance, x[order], column[order]) for column in before.T], axis=1)

    fronts = [_fronts(x[order], r[order]) for r in reached]
    if all(len(found) == 1 for found in fronts):
        run = float(fronts[1][0] - fronts[0][0])
        left = after - travelled(run)
        if np.linalg.norm(left) <= BEYOND_TRAVEL * np.linalg.norm(after - before):
            return lambda part: travelled(part * run) + part * left
    return lambda part: (1.0 - part) * before + part * after


def _fronts(x: np.ndarray, r: np.ndarray) -> np.ndarray:
    """Where the progress r (q,) at rising places x (q,) passes one half."""
    over = r - 0.5
    at = np.flatnonzero(over[:-1] * over[1:] < 0.0)
    return np.asarray(x[at] - over[at] * (x[at + 1] - x[at]) / (over[at + 1] - over[at]))


def extra_lengths(arm: Arm) -> tuple[float, float]:
    """(D_I, D_II) of an arm (length)."""
    opening = chi(arm) * arm.thickness
    return opening, SLIDING_PART * opening


def compliances(arms: Sequence[Arm]) -> tuple[float, float]:
    """(c_n, c_t) of both arms together, in series with the bond (length per stress)."""
    c_n = c_t = 0.0
    for arm in arms:
        E, h, (D_I, D_II) = arm.young, arm.thickness, extra_lengths(arm)
        rest = max(D_I**2 - E * h**2 / (12.0 * SHEAR_CORRECTION * arm.shear), LEAST_FOUNDATION * D_I**2)
        c_n += 3.0 * rest**2 / (E * h**3)
        c_t += 4.0 * D_II**2 / (E * h)
    return c_n, c_t


def give_of(arms: Sequence[Arm], bond: MixedBond) -> np.ndarray:
    """The `compliances` (2,) in series with a bond: in both modes p_max^2 (c + 1 / K) / 2 <= `MOST_HELD` G_c, and c
    times the steepest softening, p_max^2 / (2 G_c - p_max^2 / K) of a straight line, is at most `MOST_HELD`."""
    strength, toughness, slopes = (np.array(pair) for pair in (bond.strength, bond.toughness, bond.slopes))
    opens = 2.0 * toughness / strength**2
    most = MOST_HELD * np.minimum(opens - 1.0 / (MOST_HELD * slopes), (opens - 1.0 / slopes) / bond.steepness)
    return np.clip(most, 0.0, compliances(arms))
