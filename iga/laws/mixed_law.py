"""A traction law for opening and sliding, with one damage variable, contact and friction, for many points at once."""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import dataclass
from typing import Any, ClassVar, NamedTuple

import numpy as np

from iga.laws.law import History, Law, Stored
from iga.laws.mode_ratio import ModeRatio

#: Points that are evaluated at a time: their arrays stay in the cache.
POINTS_IN_CACHE = 8192


class Response(NamedTuple):
    """Tractions (n,), their derivatives by opening and slip (n,), and the new history."""

    p: np.ndarray
    t: np.ndarray
    dp_dg: np.ndarray
    dp_ds: np.ndarray
    dt_dg: np.ndarray
    dt_ds: np.ndarray
    history: History


class Driving(NamedTuple):
    """Damage (n,) on first loading to a jump, and its derivatives by opening, slip and shear strength."""

    d: np.ndarray
    by_g: np.ndarray
    by_s: np.ndarray
    by_strength: np.ndarray | float = 0.0


@dataclass(frozen=True)
class MixedLaw(Law):
    """``p = (1 - d) K g`` for openings g and ``penalty g``, free of damage, for g < 0; ``t = (1 - d) Ks s + a t_f``.

    The damage d is the largest value so far of `driving` at the jumps (max(g, 0), s). Under pressure
    ``q = max(-p, 0)`` the damaged part a of the area rubs by Coulomb's law, ``|t_f| <= friction q``, elastic with Ks
    below that (Alfano and Sacco 2006). Pressure also raises the shear strength, not the toughness, by
    ``pressure_strength q``. With ``viscosity`` damage grows at the rate ``(driving - d) / viscosity``, by the implicit
    Euler method.

    Parameters
    ----------
    modes : strength, toughness and stiffness in opening and sliding, and how they mix.
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

    slides: ClassVar[bool] = True
    unbonded: ClassVar[float] = 1.0

    @abstractmethod
    def driving(self, g: np.ndarray, s: np.ndarray, stronger: np.ndarray | None) -> Driving:
        """Damage on first loading to g (n,) >= 0 and s (n,); its slopes are zero before onset and after failure.

        ``stronger`` (n,) is the shear strength over that without pressure, None where pressure does not change it.
        """

    @property
    def pure_modes(self) -> tuple[tuple[float, float], ...]:
        return tuple(zip(self.modes.strength, self.modes.toughness, strict=True))

    def critical(self, B: np.ndarray) -> np.ndarray:
        return self.modes.at(B)[1][0]

    @property
    def begun(self) -> float:
        """Damage of a point that is whole."""
        return 0.0

    @property
    def failed(self) -> float:
        """Damage of a point that has failed."""
        return 1.0

    @property
    def kinks(self) -> tuple[float, ...]:
        """Scaled jumps at which tractions have a kink, rising: at the onset and at failure."""
        return 1.0, 2.0

    @property
    def span(self) -> float:
        """Change of the scaled jump from onset to failure."""
        return self.kinks[-1] - self.kinks[0]

    @property
    def g_max(self) -> float:
        """Opening at which the initial stiffness reaches the strength; a linear law begins to be damaged there."""
        return self.modes.strength[0] / self.stiffness[0]

    @property
    def stiffest(self) -> float:
        """Largest slope of a traction."""
        return max(self.penalty, *self.stiffness)

    def nudged(self, d: np.ndarray, driven: np.ndarray, grows: np.ndarray, keeps: np.ndarray) -> np.ndarray:
        return np.where(grows, np.minimum(d, driven) - 1e-12, np.where(keeps, d + 1e-12, d))

    def secant(self, d: np.ndarray) -> np.ndarray:
        """Secant stiffness (1 - d) K of an opening."""
        return (1.0 - d) * self.stiffness[0]

    def damage(self, d: np.ndarray) -> np.ndarray:
        """The history of a point is its damage."""
        return d

    @property
    def stiffness(self) -> tuple[float, float]:
        """Initial stiffness (K, Ks) in opening and sliding."""
        return self.modes.stiffness

    def start(self, n: int) -> History:
        """Undamaged points that have not slid."""
        return History(np.zeros(n), np.zeros(n) if self.friction else None)

    def respond(
        self, jump_qc: np.ndarray, past: History, dt: float, closed_q: np.ndarray | None, bonded_q: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray, History]:
        g, s = jump_qc.T.copy()
        p, t, *slopes, after = self.traction(g, s, past, dt, closed_q, bonded_q)
        return np.stack([p, t], axis=1), np.stack(slopes, axis=1).reshape(-1, 2, 2), after

    def traction(
        self,
        g: np.ndarray,
        s: np.ndarray,
        history: History,
        dt: float = 0.0,
        closed: np.ndarray | None = None,
        bonded: np.ndarray | None = None,
    ) -> Response:
        """Tractions at openings and slips (n,), consistent tangent, new history.

        Parameters
        ----------
        history : of all converged steps so far.
        dt : time that the step takes; only `viscosity` needs it.
        closed : which points (n,) are in contact; those with a negative opening if left out.
        bonded : which points (n,) have cohesion, all if left out; the damage of the others is 1, whatever their
            history.

        Raises
        ------
        ValueError : viscosity without a ``dt`` > 0.
        """
        if self.viscosity and not dt > 0.0:
            raise ValueError(f"a law with viscosity needs the time of a step, dt > 0, got {dt}")
        closed = ((g < 0.0) if closed is None else closed) & self.contact
        if g.size <= POINTS_IN_CACHE:
            return self._traction(g, s, history, dt, closed, bonded)
        whole = np.empty((8 if history.slip is not None else 7, g.size))
        for first in range(0, g.size, POINTS_IN_CACHE):
            part = slice(first, first + POINTS_IN_CACHE)
            before = History(history.d[part], None if history.slip is None else history.slip[part])
            held = None if bonded is None else bonded[part]
            found = self._traction(g[part], s[part], before, dt, closed[part], held)
            arrays = (*found[:6], *(one for one in found.history if one is not None))
            for to, one in zip(whole, arrays, strict=True):
                to[part] = one
        p, t, dp_dg, dp_ds, dt_dg, dt_ds, *after = whole
        return Response(p, t, dp_dg, dp_ds, dt_dg, dt_ds, History(*after))

    def stored(self, *jump_and_history: Any) -> Stored:
        (g, s, history), (K, Ks) = jump_and_history, self.stiffness
        closed = (g < 0.0) & self.contact
        opening = np.where(closed, 0.0, 0.5 * K * g**2)
        rubbing = 0.0 if history.slip is None else 0.5 * Ks * self.rubbing(history.d)[0] * (s - history.slip) ** 2
        cohesion = (1.0 - history.d) * (opening + 0.5 * Ks * s**2)
        return Stored(cohesion, np.where(closed, 0.5 * self.penalty * g**2, 0.0), rubbing + np.zeros_like(g))

    def released(self, g: np.ndarray, s: np.ndarray, history: History) -> np.ndarray:
        """Energy per area (n,) released per unit of damage at a jump, less what the elastic slip of friction stores."""
        K, Ks = self.stiffness
        rubbing = 0.0 if history.slip is None else 0.5 * Ks * self.rubbing(history.d)[1] * (s - history.slip) ** 2
        return np.where((g < 0.0) & self.contact, 0.0, 0.5 * K * g**2) + 0.5 * Ks * s**2 - rubbing

    def rubbing(self, d: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The part (n,) of the area that rubs at a damage (n,), and its slope."""
        if self.rubs == "damage":
            return d, np.ones_like(d)
        slender = 2.0 * self.modes.toughness[1] * self.stiffness[1] / self.modes.strength[1] ** 2  # s_f / s_0
        below = d + (1.0 - d) * slender
        return d / below, slender / below**2

    def _traction(
        self,
        g: np.ndarray,
        s: np.ndarray,
        history: History,
        dt: float,
        closed: np.ndarray,
        bonded: np.ndarray | None,
    ) -> Response:
        K, Ks = self.stiffness
        pressure = np.where(closed, -self.penalty * g, 0.0)
        driven = self._driven(g, s, pressure)
        d, part = self._follows(driven.d, history.d, dt)
        if bonded is not None:
            d, part = np.where(bonded, d, 1.0), np.where(bonded, part, 0.0)
        left, d_g, d_s = 1.0 - d, part * driven.by_g, part * driven.by_s
        p = np.where(closed, -pressure, left * K * g)
        dp_dg = np.where(closed, self.penalty, left * K - K * g * d_g)
        dp_ds = np.where(closed, 0.0, -K * g * d_s)
        t, t_d, t_g, t_s, slip = left * Ks * s, -Ks * s, np.zeros_like(g), left * Ks, history.slip
        if slip is not None:
            held, elastic = self.friction * pressure, Ks * (s - slip)
            t_f = np.clip(elastic, -held, held)
            slides, slip = (t_f != elastic) | ~closed, s - t_f / Ks  # open faces slide freely
            area, d_area = self.rubbing(d)
            t, t_d = t + area * t_f, t_d + d_area * t_f
            t_g = np.where(slides & closed, -self.friction * self.penalty * np.sign(elastic) * area, 0.0)
            t_s = t_s + np.where(slides, 0.0, Ks * area)
        return Response(p, t, dp_dg, dp_ds, t_g + t_d * d_g, t_s + t_d * d_s, History(d, slip))

    def driven(self, *jump: np.ndarray) -> np.ndarray:
        """Damage (n,) on first loading to the jump, with pressure."""
        g, s = jump
        pressure = np.where((g < 0.0) & self.contact, -self.penalty * g, 0.0)
        return self._driven(g, s, pressure).d

    def _driven(self, g: np.ndarray, s: np.ndarray, pressure: np.ndarray) -> Driving:
        """`driving` at openings of any sign, with the shear strength that pressure raises."""
        gain = self.pressure_strength / self.modes.strength[1]
        driven = self.driving(np.maximum(g, 0.0), s, 1.0 + gain * pressure if gain > 0.0 else None)
        by_pressure = np.where(pressure > 0.0, -self.penalty * gain * driven.by_strength, 0.0)
        return driven._replace(by_g=np.where(g < 0.0, by_pressure, driven.by_g))

    def _follows(self, driven: np.ndarray, d: np.ndarray, dt: float) -> tuple[np.ndarray, np.ndarray | float]:
        """The new damage (n,) after ``d`` where the jump drives to ``driven``, and its derivative by ``driven``."""
        if not self.irreversible:
            return driven, 1.0
        if not self.viscosity:
            return np.maximum(driven, d), (driven > d).astype(float)
        part = np.where(driven > d, dt / (dt + self.viscosity), 0.0)
        return d + part * (driven - d), part
