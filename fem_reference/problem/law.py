"""The shapes of softening, of one mode or both, and the laws in mode I, for all points of the interface at once."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar, TypeVar

import numpy as np

from fem_reference.problem.bond_law import DAMAGE, BondLaw


class Shape(ABC):
    """The part r of the traction that is left after the part x of the way from onset to failure."""

    @property
    @abstractmethod
    def area(self) -> float:
        """Integral of r from 0 to 1."""

    @abstractmethod
    def left(self, x_q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """r and dr/dx (n_q,), at a corner that of the line that begins there; beyond failure r = 0."""

    @abstractmethod
    def spent(self, x_q: np.ndarray) -> np.ndarray:
        """Integral (n_q,) of r from 0 to x."""


@dataclass(frozen=True)
class Corners(Shape):
    """Straight lines through corners x_c and r_c, from (0, 1) to (1, 0)."""

    x_c: tuple[float, ...]
    r_c: tuple[float, ...]

    @property
    def area(self) -> float:
        return float(np.sum(np.diff(self.x_c) * np.convolve(self.r_c, (0.5, 0.5), "valid")))

    def left(self, x_q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        line_q = np.clip(np.searchsorted(self.x_c, x_q, side="right") - 1, 0, len(self.x_c) - 2)
        return np.interp(x_q, self.x_c, self.r_c), (np.diff(self.r_c) / np.diff(self.x_c))[line_q]

    def spent(self, x_q: np.ndarray) -> np.ndarray:
        spent = np.zeros_like(x_q)
        for a, b, begins, ends in zip(self.x_c, self.x_c[1:], self.r_c, self.r_c[1:], strict=False):
            part_q = np.clip(x_q - a, 0.0, b - a)
            spent = spent + part_q * (begins + 0.5 * (ends - begins) / (b - a) * part_q)
        return spent


@dataclass(frozen=True)
class Decay(Shape):
    """r = (exp(-b x) - exp(-b)) / (1 - exp(-b)). Raises ValueError for a b outside [0.1, 100]."""

    b: float

    def __post_init__(self) -> None:
        if not 0.1 <= self.b <= 100.0:
            raise ValueError(f"decay: must be in [0.1, 100], got {self.b}")

    @property
    def area(self) -> float:
        return float(self.spent(np.ones(1))[0])

    def left(self, x_q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        x_q, b, whole = np.clip(x_q, 0.0, 1.0), self.b, -np.expm1(-self.b)
        return np.exp(-b) * np.expm1(b * (1.0 - x_q)) / whole, -b * np.exp(-b * x_q) / whole

    def spent(self, x_q: np.ndarray) -> np.ndarray:
        x_q, b = np.clip(x_q, 0.0, 1.0), self.b
        return (-np.expm1(-b * x_q) / b - x_q * np.exp(-b)) / -np.expm1(-b)


@dataclass(frozen=True, kw_only=True)
class Shaped:
    """The parameters of all shapes, of which ``shape_name`` uses its own.

    plateau : trapezoidal: part of the way on which the traction stays.
    knee, knee_traction : trilinear: the corner (x, r) between both lines.
    decay : exponential-softening: b of `Decay`.
    table : tabular: openings and tractions of the corners after the origin; damage begins at the first.

    Raises ValueError for one that is out of its range.
    """

    plateau: float = 0.5
    knee: float = 0.2
    knee_traction: float = 0.25
    decay: float = 5.0
    table: tuple[tuple[float, float], ...] = ()
    shape_name: ClassVar[str] = "bilinear"

    @cached_property
    def shape(self) -> Shape:
        if not 0.0 <= self.plateau < 1.0:
            raise ValueError(f"plateau: must be in [0, 1), got {self.plateau}")
        for name in ("knee", "knee_traction"):
            if not 0.0 < getattr(self, name) < 1.0:
                raise ValueError(f"{name}: must be in (0, 1), got {getattr(self, name)}")
        return MODELLED_SHAPES[self.shape_name](self)


def _table(of: Shaped) -> Shape:
    """The corners of a table; a secant that does not fall would be one that heals."""
    if np.shape(of.table)[1:] != (2,) or len(of.table) < 2 or not np.all(np.isfinite(of.table)):
        raise ValueError(f"table: must be two or more pairs of opening and traction, got {of.table}")
    g_c, p_c = np.array(of.table, dtype=float).T
    if not (g_c[0] > 0.0 and np.all(np.diff(g_c) > 0.0)):
        raise ValueError(f"table: must have openings that rise from above 0, got {g_c.tolist()}")
    if not np.all(p_c[:-1] > 0.0) or p_c[-1] != 0.0:
        raise ValueError(f"table: must have tractions > 0 and a last one of 0, got {p_c.tolist()}")
    if not np.all(np.diff(p_c / g_c) < 0.0):
        raise ValueError(f"table: must have a falling traction / opening, got {(p_c / g_c).tolist()}")
    return Corners(tuple((g_c - g_c[0]) / (g_c[-1] - g_c[0])), tuple(p_c / p_c[0]))


#: Name in a scene -> shape.
MODELLED_SHAPES: dict[str, Callable[[Shaped], Shape]] = {
    "bilinear": lambda of: Corners((0.0, 1.0), (1.0, 0.0)),
    "trapezoidal": lambda of: Corners((0.0, of.plateau, 1.0)[of.plateau == 0 :], (1.0, 1.0, 0.0)[of.plateau == 0 :]),
    "trilinear": lambda of: Corners((0.0, of.knee, 1.0), (1.0, of.knee_traction, 0.0)),
    "tabular": _table,
    "exponential-softening": lambda of: Decay(of.decay),
}

Kind = TypeVar("Kind", bound=Shaped)


def of_all_shapes(law: type[Kind]) -> dict[str, type[Kind]]:
    """Name of a shape -> the law with it."""
    made = {name: {"shape_name": name, "__module__": law.__module__} for name in MODELLED_SHAPES}
    return {name: type(law.__name__, (law,), more) for name, more in made.items()}


@dataclass(frozen=True)
class Law(BondLaw, Shaped):
    """Traction against opening: damage D(g) with which p follows an envelope, K0 g up to g_max, then the `shape`.

    Its way is that with which the area is the toughness (bilinear: Alfano and Crisfield 2001, Int. J. Numer. Methods
    Eng. 50, 1701-1736). The measure of a jump is the gap.

    Parameters
    ----------
    strength, toughness, ductility, penalty : p_max [stress], G_Ic [energy per area], 2 G_Ic / (p_max g_max), stiffness
        against closing [stress per length]. Those of a table are computed from it; given values are ignored.
    contact : if False, (1 - d) K0 continues into closing.
    irreversible : if False, d = D(g): nonlinear elastic.
    """

    strength: float
    toughness: float
    ductility: float
    penalty: float
    contact: bool = True
    irreversible: bool = True
    slides: ClassVar[bool] = False

    def __post_init__(self) -> None:
        area = self.shape.area
        if self.shape_name != "tabular":
            return
        (g_first, p_first), (g_last, _) = self.table[0], self.table[-1]
        strength, toughness = (
            max(p for _, p in self.table),
            0.5 * p_first * g_first + p_first * (g_last - g_first) * area,
        )
        object.__setattr__(self, "strength", strength)
        object.__setattr__(self, "toughness", toughness)
        object.__setattr__(self, "ductility", 2.0 * toughness / (strength * g_first))

    @property
    def p_begun(self) -> float:
        """Traction at which damage begins."""
        return self.table[0][1] if self.shape_name == "tabular" else self.strength

    @property
    def begun(self) -> float:
        """Opening g_max at which damage begins."""
        return 2.0 * self.toughness / self.strength / self.ductility

    @property
    def failed(self) -> float:
        """Opening g_u from which the traction is zero."""
        return self.begun + (self.toughness / self.p_begun - 0.5 * self.begun) / self.shape.area

    @property
    def unit(self) -> float:
        return self.failed

    @property
    def slope_j(self) -> np.ndarray:
        return np.array([self.p_begun / self.begun, 0.0])

    def measure(self, jump_qj: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return jump_qj[:, 0], np.ones_like(jump_qj)

    def kept(self, jump_qj: np.ndarray, k_qh: np.ndarray, d_q: np.ndarray) -> np.ndarray:
        """The largest gap so far, the present one where damage heals."""
        return np.maximum(jump_qj[:, 0], self.held(k_qh) if self.irreversible else 0.0)

    def driving(self, g_q: np.ndarray, s_q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        begun, way = self.begun, self.failed - self.begun
        k_q = np.maximum(g_q, begun)
        r_q, dr_q = self.shape.left((k_q - begun) / way)
        D_q = np.maximum(1.0 - r_q * begun / k_q, 0.0)
        softens_q = (g_q > begun) & (g_q < begun + way)
        slope_q = np.where(softens_q, (r_q / k_q - dr_q / way) * begun / k_q, 0.0)
        return D_q, np.stack([slope_q, np.zeros_like(g_q)], -1)

    def balance(self, jump_qj: np.ndarray, k_qh: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray | None]:
        cohesive_q, contact_q, _ = super().balance(jump_qj, k_qh)
        k_q = self.held(k_qh)
        lost_q = self.area(k_q) - 0.5 * (1.0 - k_qh[:, DAMAGE]) * self.K0 * k_q**2
        if not self.irreversible:  # the energy of damage is recovered
            cohesive_q, lost_q = cohesive_q + np.where(jump_qj[:, 0] < 0.0, 0.0, lost_q), np.zeros_like(lost_q)
        return cohesive_q, contact_q, lost_q

    def area(self, k_q: np.ndarray) -> np.ndarray:
        """Integral (n_q,) of the envelope from 0 to k >= 0; G_Ic from g_u on."""
        way = self.failed - self.begun
        softened_q = way * self.shape.spent((k_q - self.begun) / way)
        return 0.5 * self.K0 * np.minimum(k_q, self.begun) ** 2 + self.p_begun * softened_q


@dataclass(frozen=True)
class ExponentialLaw(Law):
    """p = e p_max x exp(-x) with x = g / g0, g0 = G_Ic / (e p_max) (Salehani and Irani 2018, in mode I).

    The damage of this formula begins at once and never ends, but a path needs g_max > 0 and a finite g_u. Here damage
    begins at x = ``begins``, below which p follows the chord, and p is zero from x = ``ends`` on; the missing area,
    2e-10 of G_Ic, is lost there. ``ductility`` is not used.
    """

    begins: float = 1e-3
    ends: float = 40.0

    @property
    def g_0(self) -> float:
        """Opening at the strength."""
        return self.toughness / (np.e * self.strength)

    @property
    def begun(self) -> float:
        return self.begins * self.g_0

    @property
    def failed(self) -> float:
        return self.ends * self.g_0

    @property
    def slope_j(self) -> np.ndarray:
        """That of the chord."""
        return np.array([(np.e * self.strength) ** 2 / self.toughness * np.exp(-self.begins), 0.0])

    def driving(self, g_q: np.ndarray, s_q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        left_q = np.where(g_q < self.failed, np.exp(-np.maximum(g_q - self.begun, 0.0) / self.g_0), 0.0)
        return 1.0 - left_q, np.stack([np.where(g_q > self.begun, left_q / self.g_0, 0.0), np.zeros_like(g_q)], -1)

    def area(self, k_q: np.ndarray) -> np.ndarray:
        rising_q, x_q = np.minimum(k_q, self.begun), np.clip(k_q / self.g_0, self.begins, self.ends)
        left, left_q = (1.0 + self.begins) * np.exp(-self.begins), (1.0 + x_q) * np.exp(-x_q)
        spent_q = 0.5 * self.K0 * rising_q**2 + self.toughness * (left - left_q)
        return np.where(k_q < self.failed, spent_q, self.toughness)


#: Name in a scene -> law, a class with the fields, properties and methods of `Law`.
MODELLED_LAWS: dict[str, type[Law]] = {**of_all_shapes(Law), "exponential": ExponentialLaw}
