"""Stand-in for the law of opening and sliding, until the reference is there."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Path:
    p: np.ndarray
    t: np.ndarray
    d: np.ndarray
    slip: np.ndarray
    stored: np.ndarray
    contact: np.ndarray
    friction_stored: np.ndarray
    released: np.ndarray
    rubbed: np.ndarray


@dataclass(frozen=True)
class MixedBond:
    law: str
    strength: tuple[float, float]
    toughness: tuple[float, float]
    stiffness: tuple[float, float]
    penalty: float
    criterion: str = "bk"
    exponent: float = 2.0
    onset: str = "turon"
    contact: bool = True
    friction: float = 0.0
    viscosity: float = 0.0
    pressure_strength: float = 0.0
    plateau: float = 0.5

    def __post_init__(self) -> None:
        if self.onset == "turon" and self.criterion != "bk":
            raise ValueError("turon")
        if self.law == "exponential":
            return
        B = np.linspace(0, 1, 101)
        if not np.all(self.onset_norm(B) ** 2 < 2 * self.critical(B)):
            raise ValueError("the energy at onset")

    def mode_ratio(self, g: np.ndarray, s: np.ndarray) -> np.ndarray:
        K, Ks = self.stiffness
        a, b = K * np.maximum(g, 0.0) ** 2, Ks * s**2
        return np.where(a + b > 0, b / np.where(a + b > 0, a + b, 1.0), 0.0)

    def energy_norm(self, g: np.ndarray, s: np.ndarray) -> np.ndarray:
        K, Ks = self.stiffness
        return np.sqrt(K * np.maximum(g, 0.0) ** 2 + Ks * s**2)

    def onset_norm(self, B: np.ndarray) -> np.ndarray:
        (p, t), (K, Ks) = self.strength, self.stiffness
        if self.onset == "turon":
            return np.sqrt(p**2 / K + (t**2 / Ks - p**2 / K) * B**self.exponent)
        return 1 / np.sqrt((1 - B) * K / p**2 + B * Ks / t**2)

    def critical(self, B: np.ndarray) -> np.ndarray:
        G1, G2 = self.toughness
        if self.criterion == "bk":
            return G1 + (G2 - G1) * B**self.exponent
        a = self.exponent
        return (((1 - B) / G1) ** a + (B / G2) ** a) ** (-1 / a)

    def driving(self, g: np.ndarray, s: np.ndarray) -> np.ndarray:
        if self.law == "exponential":
            g0 = self.toughness[0] / (np.e * self.strength[0])
            s0 = (2 / np.e) ** 0.5 * self.toughness[1] / self.strength[1]
            return 1 - np.exp(-np.maximum(g, 0.0) / g0 - (s / s0) ** 2)
        B, lam = self.mode_ratio(g, s), self.energy_norm(g, s)
        q = np.maximum(-self.penalty * g, 0.0) if self.contact else 0.0 * g
        l0 = self.onset_norm(B) * (1 + self.pressure_strength * q / self.strength[1])
        flat = self.plateau if self.law == "trapezoidal" else 0.0
        w = (2 * self.critical(B) - l0**2) / ((1 + flat) * l0)
        safe = np.where(lam > 0, lam, 1.0)
        D = 1 - l0 / safe * np.minimum(1.0, (l0 + w - lam) / ((1 - flat) * w))
        return np.where(lam > l0, np.clip(D, 0.0, 1.0), 0.0)

    def path(self, g: np.ndarray, s: np.ndarray, time: np.ndarray | None = None) -> Path:
        K, Ks = self.stiffness
        D = self.driving(g, s)
        if self.viscosity:
            assert time is not None
            d, out = 0.0, []
            for dt, one in zip(np.diff(time, prepend=time[0]), D, strict=True):
                d = d + dt / (dt + self.viscosity) * max(one - d, 0.0)
                out.append(d)
            d = np.array(out)
        else:
            d = np.maximum.accumulate(D)
        closed = (g < 0) & self.contact
        slip, t_f = np.zeros_like(g), np.zeros_like(g)
        rubbed = np.zeros_like(g)
        if self.friction:
            before = 0.0
            for i in range(g.size):
                held = self.friction * (-self.penalty * g[i] if closed[i] else 0.0)
                t_f[i] = np.clip(Ks * (s[i] - before), -held, held)
                slip[i] = s[i] - t_f[i] / Ks
                rubbed[i] = d[i] * t_f[i] * (slip[i] - before)
                before = slip[i]
        p = np.where(closed, self.penalty * g, (1 - d) * K * g)
        gp = np.where(closed, 0.0, g)
        e = 0.5 * (K * gp**2 + Ks * s**2)
        released = np.concatenate([[0], np.cumsum(0.5 * (e[1:] + e[:-1]) * np.diff(d))])
        friction_stored = d * t_f**2 / (2 * Ks)
        t = (1 - d) * Ks * s + d * t_f
        return Path(
            p,
            t,
            d,
            slip,
            (1 - d) * e,
            np.where(closed, 0.5 * self.penalty * g**2, 0.0),
            friction_stored,
            released,
            np.cumsum(rubbed),
        )
