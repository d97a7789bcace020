"""The layout of a delamination specimen in plain numbers: two bodies, their bond, loads and clamps."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from iga.elements.elasticity import orthotropic, solid
from iga.specimen.ranges import require, require_numbers, require_positive


@dataclass(frozen=True, kw_only=True)
class Moduli:
    """Elastic constants, axis 1 along the specimen; isotropic where ``E2`` and ``G12`` are left out;
    ``nu23``, which plane stress does not need, is nu12 where it is left out. Those of solids alone are transversely
    isotropic where they are left out: E3 = E2, nu13 = nu12, G13 = G12, G23 = E2 / (2 (1 + nu23)).

    Raises
    ------
    ValueError : a modulus that is not positive, one of ``E2`` and ``G12`` alone, or a contraction beyond its range,
        -1 < nu12 < 0.5 where isotropic, |nu12| < sqrt(E1 / E2) where not.
    """

    E1: float
    nu12: float
    E2: float | None = None
    G12: float | None = None
    nu23: float | None = None
    E3: float | None = None
    nu13: float | None = None
    G13: float | None = None
    G23: float | None = None

    def __post_init__(self) -> None:
        require_numbers(self)
        require_positive(self, "E1", "E2", "G12", "E3", "G13", "G23")
        for key, other in (("E2", "G12"), ("G12", "E2")):
            alone = getattr(self, key) is None and getattr(self, other) is not None
            require(self, key, not alone, f"given where {other} is")
        if self.E2 is None:
            require(self, "nu12", -1.0 < self.nu12 < 0.5, "> -1 and < 0.5 without E2 and G12")
        else:
            limit = (self.E1 / self.E2) ** 0.5
            require(self, "nu12", abs(self.nu12) < limit, f"> {-limit:.6g} and < {limit:.6g} = sqrt(E1/E2)")
        require(self, "nu23", self.nu23 is None or abs(self.nu23) < 1.0, "> -1 and < 1")

    def stiffness(self, plane: str) -> np.ndarray:
        """Elasticity matrix (3, 3), stress = D (E11, E22, 2 E12), of a solid (6, 6); raises as `orthotropic` does."""
        E2 = self.E1 if self.E2 is None else self.E2
        G12 = self.E1 / (2.0 * (1.0 + self.nu12)) if self.G12 is None else self.G12
        if plane != "solid":
            return orthotropic(self.E1, E2, G12, self.nu12, plane, self.nu23)
        E3, G13 = E2 if self.E3 is None else self.E3, G12 if self.G13 is None else self.G13
        nu13, nu23 = (self.nu12 if nu is None else nu for nu in (self.nu13, self.nu23))
        G23 = E2 / (2.0 * (1.0 + nu23)) if self.G23 is None else self.G23
        return solid((self.E1, E2, E3), (self.nu12, nu13, nu23), (G23, G13, G12))

    def axial(self, plane: str) -> float:
        """Modulus of an arm that is bent or stretched: E1, and ``E1 / (1 - nu12^2 E2 / E1)`` in plane strain; of a
        solid E1, as at its edges."""
        E2 = self.E1 if self.E2 is None else self.E2
        return self.E1 if plane != "strain" else self.E1 / (1.0 - self.nu12**2 * E2 / self.E1)


@dataclass(frozen=True)
class Rectangle:
    """A body: 0 <= X <= length, above or below Y = 0."""

    length: float
    thickness: float
    moduli: Moduli


#: A range of X.
Extent = tuple[float, float]


class Load(NamedTuple):
    """A part of the load on a side of a body (0 upper, 1 lower, None: the end faces of both as one): "left", "right",
    "top" or "bottom".

    It is a uniform dead traction on the ``extent`` of the side, all of it where left out: ``share`` times the load,
    upwards. A ``couple`` is a traction along X on an end face, linear in Y about the middle of its height: ``share``
    times the load is its moment, anticlockwise.
    """

    body: int | None
    side: str
    share: float
    extent: Extent | None = None
    couple: bool = False


class Support(NamedTuple):
    """A patch, as that of a `Load`, whose mean displacement along Y is zero; with ``couple`` its mean rotation."""

    body: int | None
    side: str
    extent: Extent | None = None
    couple: bool = False


class Clamp(NamedTuple):
    """A side of a body that cannot move: "left", "right", "bottom" or "top"."""

    body: int
    side: str


#: The load that pulls two arms apart at their left ends.
OPENED = (Load(0, "left", 1.0), Load(1, "left", -1.0))


@dataclass(frozen=True)
class Layout:
    """A specimen in its own frame: X along the interface Y = 0, Y across it; both bodies begin at X = 0.

    Parameters
    ----------
    bodies : the upper and the lower one.
    bonded : X of the tip of the bond, next to the load, and of its far end.
    loads : what the load consists of.
    clamps, supports : neither if the loads balance each other.
    from_x : X from where distances are counted; that of the first load, on an end face, where left out.
    """

    bodies: tuple[Rectangle, Rectangle]
    bonded: tuple[float, float]
    loads: tuple[Load, ...] = OPENED
    clamps: tuple[Clamp, ...] = ()
    supports: tuple[Support, ...] = ()
    from_x: float | None = None

    @property
    def facing(self) -> tuple[float, float]:
        """X of the ends of the surfaces that lie opposite each other, in the order of ``bonded``."""
        overlap = 0.0, min(body.length for body in self.bodies)
        return overlap if self.bonded[0] < self.bonded[1] else overlap[::-1]

    @property
    def loaded_at(self) -> float:
        """X of the loaded end, from where distances are counted."""
        body, side = self.loads[0][:2]
        if self.from_x is not None:
            return self.from_x
        return 0.0 if side == "left" else self.bodies[body or 0].length

    @property
    def free_length(self) -> float:
        """Distance of the tip of the bond."""
        return abs(self.bonded[0] - self.loaded_at)

    def distance(self, X: np.ndarray) -> np.ndarray:
        """Distance of X (...,) from the loaded end, along the specimen; negative in an overhang."""
        return np.abs(X - self.loaded_at) if self.from_x is None else X - self.from_x

    def load_on(self, body: int) -> Load | None:
        """The load on the end face of a body; None where there is none."""
        on_ends = (load for load in self.loads if load.side in ("left", "right") and not load.couple)
        return next((load for load in on_ends if load.body == body), None)
