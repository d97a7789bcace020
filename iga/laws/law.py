"""The traction law of a bond: one damage variable, contact, friction and viscosity, for many points at once.

A bond that opens alone is that without slip: its jump, its tractions and their slopes have one component in place of
two, and nothing is spent on the other.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from iga.laws.mode_ratio import ModeRatio

#: Time between two steps: none, but laws with viscosity divide by it.
INSTANT = float(np.finfo(float).tiny)
#: Points that are evaluated at a time: their arrays stay in the cache.
POINTS_IN_CACHE = 8192
#: What the numbers of a bond that opens alone are greater than.
LEAST = {"strength": 0.0, "toughness": 0.0, "ductility": 1.0, "penalty": 0.0}


class History(NamedTuple):
    """History of points: ``d`` (n,), the largest gap or, where the bond slides, the damage, 0 to 1; and with friction
    the slip (n,) at which its traction is zero."""

    d: np.ndarray
    slip: np.ndarray | None = None


class Stored(NamedTuple):
    """Energies per area (n,): in cohesion, in contact, in the elastic slip of friction, and dissipated, as far as that
    follows from the history: all of it where the bond opens alone."""

    cohesion: np.ndarray
    contact: np.ndarray
    friction: np.ndarray | float = 0.0
    dissipated: np.ndarray | float = 0.0


class Scaled(NamedTuple):
    """Scaled jump ``x`` (n,), which rises with the progress of damage and has onset and failure at the kinks of the
    law; its derivatives by opening and slip; and ``back`` (n,), the scaled jump that a point has to reach for its
    damage to grow (again). Where the bond opens alone it is the gap, and ``back`` the largest one. Otherwise ``back``
    is at most the onset without damage, and at least failure of a failed point."""

    x: np.ndarray
    by_g: np.ndarray
    by_s: np.ndarray | None
    back: np.ndarray


class Driving(NamedTuple):
    """History (n,) on first loading to a jump, and its derivatives by opening, slip and shear strength."""

    d: np.ndarray
    by_g: np.ndarray | float
    by_s: np.ndarray | float = 0.0
    by_strength: np.ndarray | float = 0.0


@dataclass(frozen=True)
class Law(ABC):
    """``p = (1 - d) K g`` for openings g and ``penalty g``, free of damage, for g < 0; ``t = (1 - d) Ks s + a t_f``.

    The damage d follows from the history, the largest value so far of `driving`: of the gap where the bond opens alone,
    and of the damage itself at the jumps (max(g, 0), s) where it slides. Under pressure ``q = max(-p, 0)`` the damaged
    part a of the area rubs by Coulomb's law, ``|t_f| <= friction q``, elastic with Ks below that (Alfano and Sacco
    2006). Pressure also raises the shear strength, not the toughness, by ``pressure_strength q``. With ``viscosity``
    damage grows at the rate ``(driving - d) / viscosity``, by the implicit Euler method. A bond that opens alone has
    neither friction nor viscosity.

    A law is a frozen dataclass; jumps and tractions are (n, n_c), with n_c = 2 where the bond ``slides``, else 1.

    Parameters
    ----------
    modes : strength, toughness and stiffness in opening and, where the bond slides, in sliding, and how they mix.
    penalty : stiffness against closing [stress per length]; without ``contact`` the secant holds for g < 0, too.
    irreversible : if False, damage follows the jump up and down, and damage dissipates nothing.
    friction : coefficient of Coulomb's law, at least 0.
    viscosity : relaxation time of damage, in the unit of ``dt``.
    pressure_strength : shear strength gained per pressure, at least 0. The strength rises at most until the energy
        stored at onset is all of the toughness.
    rubs : definition of a: "damage" for a = d (Alfano and Sacco 2006), or, for laws that soften along a line, "area"
        for the fraction of the way from onset to failure in pure shear, ``d / (d + (1 - d) s_f / s_0)`` (as in
        CompDam).
    """

    modes: ModeRatio
    penalty: float
    contact: bool = True
    irreversible: bool = True
    friction: float = 0.0
    viscosity: float = 0.0
    pressure_strength: float = 0.0
    rubs: str = "damage"

    @classmethod
    def opening(
        cls,
        strength: float,
        toughness: float,
        ductility: float,
        penalty: float,
        contact: bool = True,
        irreversible: bool = True,
        **own: Any,
    ) -> Law:
        """The law of a bond that opens alone, with its ``own`` keys.

        Parameters
        ----------
        strength, toughness, penalty : p_max [stress], G_Ic [force/length], stiffness of the contact [stress/length].
        ductility : 2 G_Ic / (p_max g_max) > 1, with the opening g_max at which damage begins.

        Raises
        ------
        ValueError : a number out of its range; the message has key, range and value.
        """
        numbers = zip(LEAST.items(), (strength, toughness, ductility, penalty), strict=True)
        for (key, least), value in numbers:
            if not least < value < np.inf:
                raise ValueError(f"{key}: must be > {least:g} and finite, got {value!r}")
        modes = ModeRatio((toughness,), (strength,), (0.5 * strength**2 * ductility / toughness,))
        return cls(modes, penalty, contact, irreversible, **own)

    @abstractmethod
    def fading(self, k: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """1 - d after the largest opening k (n,) of a bond that opens alone, and its slope; at a kink that of the
        branch that begins there."""

    @abstractmethod
    def work(self, k: np.ndarray) -> np.ndarray:
        """Integral of the `envelope` of a bond that opens alone from 0 to k >= 0; G_Ic from failure on."""

    @abstractmethod
    def driving(self, g: np.ndarray, s: np.ndarray, stronger: np.ndarray | None) -> Driving:
        """Damage on first loading to g (n,) >= 0 and s (n,); its slopes are zero before onset and after failure.

        ``stronger`` (n,) is the shear strength over that without pressure, None where pressure does not change it.
        """

    @abstractmethod
    def progress(self, g: np.ndarray, s: np.ndarray, d: np.ndarray) -> Scaled:
        """The scaled jump at openings, slips and damages (n,)."""

    @property
    @abstractmethod
    def kinks(self) -> tuple[float, ...]:
        """Scaled jumps, rising from onset to failure, at which tractions have a kink."""

    @property
    def slides(self) -> bool:
        """Whether tractions depend on a slip."""
        return len(self.modes.strength) > 1

    @property
    def stiffness(self) -> tuple[float, ...]:
        """Initial stiffness (K,) in opening or (K, Ks) in opening and sliding."""
        return self.modes.stiffness

    @property
    def pure_modes(self) -> tuple[tuple[float, float], ...]:
        """Strength and toughness of opening and, where the bond slides, of sliding."""
        return tuple(zip(self.modes.strength, self.modes.toughness, strict=True))

    def critical(self, B: np.ndarray) -> np.ndarray:
        """Toughness (n,) at mode ratios by energy."""
        return self.modes.at(B)[1][0]

    @property
    def g_max(self) -> float:
        """Opening at which damage begins; where the bond slides, that at which K reaches the strength."""
        return self.modes.strength[0] / self.stiffness[0] if self.slides else self.kinks[0]

    @property
    def g_u(self) -> float:
        """Opening from which a bond that opens alone has no traction."""
        return self.kinks[-1]

    @property
    def begun(self) -> float:
        """History beyond which a point is damaged."""
        return 0.0 if self.slides else self.kinks[0]

    @property
    def failed(self) -> float:
        """History from which a point has no cohesion left."""
        return self.unbonded

    @property
    def unbonded(self) -> float:
        """History of points without cohesion."""
        return 1.0 if self.slides else self.kinks[-1]

    @property
    def span(self) -> float:
        """The scaled jump over which a point goes from whole to failed."""
        return self.kinks[-1] - self.kinks[0] if self.slides else self.kinks[-1]

    @property
    def stiffest(self) -> float:
        """Largest slope of a traction."""
        return max(self.penalty, *self.stiffness)

    def kept(self, d: np.ndarray) -> tuple[np.ndarray, np.ndarray | float]:
        """The part (n,) of the stiffness that is left after a history (n,), and its slope."""
        return (1.0 - d, -1.0) if self.slides else self.fading(d)

    def damage(self, d: np.ndarray) -> np.ndarray:
        """Damage, 0 to 1, after a history (n,)."""
        return 1.0 - self.kept(d)[0]

    def envelope(self, k: np.ndarray) -> np.ndarray:
        """Traction of a bond that opens alone on first loading to the opening k >= 0."""
        return self.fading(k)[0] * self.stiffness[0] * k

    def nudged(self, d: np.ndarray, driven: np.ndarray, grows: np.ndarray, keeps: np.ndarray) -> np.ndarray:
        """Histories (n,) changed by a rounding: just below ``driven`` where damage ``grows``, just above ``d`` where it
        ``keeps`` its value."""
        tiny = 1e-12 * (1.0 if self.slides else d)
        return np.where(grows, np.minimum(d, driven) - tiny, np.where(keeps, d + tiny, d))

    def start(self, n: int) -> History:
        """Points that have not been loaded."""
        return History(np.zeros(n), np.zeros(n) if self.friction else None)

    def scaled(self, *jump_and_history: np.ndarray) -> Scaled:
        """The scaled jump at jumps and histories (n,)."""
        if self.slides:
            return self.progress(*jump_and_history)
        g, k = jump_and_history
        return Scaled(g, np.ones_like(g), None, k)

    def driven(self, *jump: np.ndarray) -> np.ndarray:
        """The history (n,) on first loading to the jumps (n,), with pressure."""
        return self._driven(np.where((jump[0] < 0.0) & self.contact, self.penalty * jump[0], 0.0), *jump).d

    def respond(
        self,
        jump_qc: np.ndarray,
        past: History,
        dt: float = 0.0,
        closed_q: np.ndarray | None = None,
        bonded_q: np.ndarray | None = None,
    ) -> tuple[np.ndarray, np.ndarray, History]:
        """Tractions (n_q, n_c), their consistent slopes (n_q, n_c, n_c), and the new history after a step.

        Parameters
        ----------
        past : the history of all converged steps so far.
        dt : time that the step takes; only `viscosity` needs it.
        closed_q : which points (n_q,) are in contact; those with a negative gap if left out.
        bonded_q : which points (n_q,) have cohesion, all if left out; the others are damaged, whatever their history.

        Raises
        ------
        ValueError : viscosity without a ``dt`` > 0.
        """
        if self.viscosity and not dt > 0.0:
            raise ValueError(f"a law with viscosity needs the time of a step, dt > 0, got {dt}")
        closed_q = ((jump_qc[:, 0] < 0.0) if closed_q is None else closed_q) & self.contact
        every: tuple[Any, ...] = (jump_qc, past.d, past.slip, closed_q, bonded_q)
        if len(jump_qc) <= POINTS_IN_CACHE:
            return self._respond(dt, *every)
        parts = (slice(first, first + POINTS_IN_CACHE) for first in range(0, len(jump_qc), POINTS_IN_CACHE))
        pieces: Any = ([None if one is None else one[part] for one in every] for part in parts)
        found = [self._respond(dt, *piece) for piece in pieces]
        arrays: Any = zip(*((f, slope, *after) for f, slope, after in found), strict=True)
        f_qc, slope_qcc, *after = (np.concatenate(one) for one in arrays if one[0] is not None)
        return f_qc, slope_qcc, History(*after)

    def stored(self, *jump_and_history: Any) -> Stored:
        """Energies per area (n,) at jumps (n,), with the `History` after them."""
        (g, *slips, history), (K, *stiff) = jump_and_history, self.stiffness
        closed, (left, _) = (g < 0.0) & self.contact, self.kept(history.d)
        cohesion, contact = np.where(closed, 0.0, 0.5 * K * g**2), np.where(closed, 0.5 * self.penalty * g**2, 0.0)
        if not slips:
            k = history.d
            spent = np.where(k > self.begun, self.work(k) - 0.5 * left * K * k**2, 0.0)  # nothing before damage
            kept, lost = (0.0, spent) if self.irreversible else (spent, np.zeros_like(g))
            return Stored(left * cohesion + kept, contact, 0.0, lost)
        (s,), (Ks,) = slips, stiff
        rubbing = 0.0 if history.slip is None else 0.5 * Ks * self.rubbing(history.d)[0] * (s - history.slip) ** 2
        return Stored(left * (cohesion + 0.5 * Ks * s**2), contact, rubbing + np.zeros_like(g))

    def rubbing(self, d: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The part (n,) of the area that rubs at a damage (n,), and its slope."""
        if self.rubs == "damage":
            return d, np.ones_like(d)
        slender = 2.0 * self.modes.toughness[1] * self.stiffness[1] / self.modes.strength[1] ** 2  # s_f / s_0
        below = d + (1.0 - d) * slender
        return d / below, slender / below**2

    def _respond(
        self,
        dt: float,
        jump_qc: np.ndarray,
        d: np.ndarray,
        slip: np.ndarray | None,
        closed: np.ndarray,
        bonded: np.ndarray | None,
    ) -> tuple[np.ndarray, np.ndarray, History]:
        (g, *slips), (K, *stiff) = jump_qc.T.copy(), self.stiffness
        pressed = np.where(closed, self.penalty * g, 0.0)
        driven = self._driven(pressed, g, *slips)
        d, part = self._follows(driven.d, d, dt)
        if bonded is not None:
            d, part = np.where(bonded, d, self.unbonded), np.where(bonded, part, 0.0)
        (left, fades), d_g = self.kept(d), part * driven.by_g
        if bonded is not None:
            left = np.where(bonded, left, 0.0)  # whatever stiffness a law leaves to a failed bond
        secant = left * K
        p = np.where(closed, pressed, secant * g)
        dp_dg = np.where(closed, self.penalty, secant + K * g * (fades * d_g))
        if not slips:
            return p[:, None], dp_dg[:, None, None], History(d)
        (s,), (Ks,), d_s = slips, stiff, part * driven.by_s
        dp_ds = np.where(closed, 0.0, K * g * (fades * d_s))
        t, t_d, t_g, t_s = left * Ks * s, fades * Ks * s, np.zeros_like(g), left * Ks
        if slip is not None:
            held, elastic = -self.friction * pressed, Ks * (s - slip)
            t_f = np.clip(elastic, -held, held)
            slides, slip = (t_f != elastic) | ~closed, s - t_f / Ks  # open faces slide freely
            area, d_area = self.rubbing(d)
            t, t_d = t + area * t_f, t_d + d_area * t_f
            t_g = np.where(slides & closed, -self.friction * self.penalty * np.sign(elastic) * area, 0.0)
            t_s = t_s + np.where(slides, 0.0, Ks * area)
        slopes = np.stack([dp_dg, dp_ds, t_g + t_d * d_g, t_s + t_d * d_s], axis=1)
        return np.stack([p, t], axis=1), slopes.reshape(-1, 2, 2), History(d, slip)

    def _driven(self, pressed: np.ndarray, g: np.ndarray, *slips: np.ndarray) -> Driving:
        """`driving` at openings of any sign, with the shear strength that pressure ``-pressed`` raises."""
        if not slips:
            return Driving(g if self.irreversible else np.maximum(g, 0.0), 1.0)
        gain = self.pressure_strength / self.modes.strength[1]
        driven = self.driving(np.maximum(g, 0.0), slips[0], 1.0 - gain * pressed if gain > 0.0 else None)
        by_pressure = np.where(pressed < 0.0, -self.penalty * gain * driven.by_strength, 0.0)
        return driven._replace(by_g=np.where(g < 0.0, by_pressure, driven.by_g))

    def _follows(self, driven: np.ndarray, d: np.ndarray, dt: float) -> tuple[np.ndarray, np.ndarray | float]:
        """The new history (n,) after ``d`` where the jump drives to ``driven``, and its derivative by ``driven``."""
        if not self.irreversible:
            return driven, 1.0
        if not self.viscosity:
            return np.maximum(driven, d), driven > d
        part = np.where(driven > d, dt / (dt + self.viscosity), 0.0)
        return d + part * (driven - d), part
