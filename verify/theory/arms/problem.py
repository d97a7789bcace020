"""Arms on a bond, with their loads and supports, in plain numbers.

A bond that opens alone is one without slip: its law is one of `verify.theory.law`, that of the other `MixedBond`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np

from verify.theory.layer import Layer
from verify.theory.mixed_law import MixedBond
from verify.theory.traction_law import KnownLaw

Side = Literal["left", "right", "top", "bottom"]

#: Progress of the exponential law in mixed mode, which never fails, that counts as failure: 2e-4 of the toughness left.
PRACTICALLY_FAILED = 8.0


@dataclass(frozen=True)
class Bond:
    """``law`` with damage, contact and friction; ``irreversible`` : whether damage stays."""

    law: KnownLaw | MixedBond
    irreversible: bool = True

    @property
    def slides(self) -> bool:
        return isinstance(self.law, MixedBond)

    @property
    def slopes(self) -> tuple[float, float]:
        """Initial stiffness on opening and on sliding."""
        return self.law.slopes if isinstance(self.law, MixedBond) else (self.law.stiffness, 0.0)

    @property
    def friction(self) -> float:
        return self.law.friction if isinstance(self.law, MixedBond) else 0.0

    @property
    def scale(self) -> np.ndarray:
        """Jumps of a size at which damage begins, one of opening and, where it slides, one of sliding."""
        if isinstance(self.law, MixedBond):
            return np.array(self.law.strength) / np.array(self.law.slopes)
        return np.array([self.law.strength / self.law.stiffness])

    def driving(self, g: np.ndarray, s: np.ndarray) -> np.ndarray:
        """The damage that jumps ask for on their own."""
        return self.law.driving(g, s) if isinstance(self.law, MixedBond) else self.law.damage(np.maximum(g, 0.0))

    def progress(self, g: np.ndarray, s: np.ndarray) -> np.ndarray:
        """How far a jump is on its own: 1 where damage begins, 2 where the bond fails, beyond at the same rate."""
        law = self.law
        if not isinstance(law, MixedBond):
            g = np.maximum(g, 0.0)
            beyond = 1.0 + (g - law.g_peak) / (law.g_open - law.g_peak)
            return np.where(g <= law.g_peak, g / law.g_peak, beyond)
        norm, B = law.energy_norm(g, s), law.mode_ratio(g, s)
        G, onset = law.critical(B), law.onset_norm(B)
        if law.law == "exponential":
            return 1.0 + norm / np.sqrt(G) / PRACTICALLY_FAILED
        level = law.plateau if law.law == "trapezoidal" else 0.0
        width = (2.0 * G - onset**2) / ((1.0 + level) * onset)
        return np.where(norm <= onset, norm / onset, 1.0 + (norm - onset) / width)

    def rubbing(self, d: np.ndarray) -> np.ndarray:
        """The part of the bond that friction acts on."""
        return self.law.rubbing_part(d) if isinstance(self.law, MixedBond) else np.zeros_like(d)

    def critical(self, mode_ratio: float) -> float:
        """Toughness at a mode ratio."""
        return float(self.law.critical(mode_ratio)) if isinstance(self.law, MixedBond) else self.law.toughness


class Load(NamedTuple):
    """A part of the load as a dead traction: ``share`` of it upwards on a side of a body (0 upper, 1 lower, None both).

    ``extent`` is the range of X of a patch on the top or the bottom, or one place twice; None for the whole side. A
    ``couple`` is the moment ``share`` on an end face, anticlockwise.
    """

    body: int | None
    side: Side
    share: float
    extent: tuple[float, float] | None = None
    couple: bool = False


class Support(NamedTuple):
    """A place, as of a `Load`, whose mean vertical displacement is zero; a couple: an end face, its mean rotation."""

    body: int | None
    side: Side
    extent: tuple[float, float] | None = None
    couple: bool = False


@dataclass(frozen=True)
class Arm:
    """One arm.

    ``young``, ``transverse``, ``shear`` : moduli along it (plane strain: E1 / (1 - nu13 nu31)), across it and in shear
    ``stiffness`` (3, 3) : of the plane, S = D E with E = (E_XX, E_YY, 2 E_XY); needed above order 1
    ``clamped`` : whether its outer face, away from the bond, cannot move
    """

    thickness: float
    young: float
    transverse: float
    shear: float
    stiffness: np.ndarray | None = None
    clamped: bool = False


@dataclass(frozen=True)
class ArmsProblem:
    """An upper and a lower body that begin at X = 0 and meet on Y = 0.

    ``bodies`` : two arms, or a strip and the layer that it is peeled from; one arm where both are mirror images
    ``lengths`` : of the bodies
    ``bonded`` : X of both ends of the bond. Elsewhere the faces touch without friction of their own but that of the law
    ``opening`` : the programme of the deflection that is conjugate to the load, or its end
    ``loaded_at`` : X from which the length of the crack counts
    ``order`` : of the displacements through the thickness; 1 is the theory of Timoshenko and Reissner
    ``kinematics`` : "linear" or "finite"
    ``zone`` : estimate of the length of the process zone, which sets the size of the elements
    ``reach`` : estimate of the length of the crack at the end; beyond it, and a few zones, elements grow
    ``points`` : roughly the number of rows of a leg
    ``in_a_zone`` : elements in the process zone
    """

    bodies: tuple[Arm | Layer, ...]
    lengths: tuple[float, ...]
    bonded: tuple[float, float]
    width: float
    loads: Sequence[Load]
    supports: Sequence[Support]
    bond: Bond
    zone: float
    reach: float
    opening: float | Sequence[float] = 1.0
    loaded_at: float = 0.0
    order: int = 1
    kinematics: str = "linear"
    points: int = 150
    in_a_zone: float = 5.0
    snapshot_openings: tuple[float, ...] = ()

    @property
    def mirrored(self) -> bool:
        """Whether one arm stands for both."""
        return len(self.bodies) == 1

    @property
    def finite(self) -> bool:
        return self.kinematics == "finite"

    @property
    def length(self) -> float:
        return max(self.lengths)

    @property
    def arms(self) -> tuple[Arm, ...]:
        """The arms among the bodies."""
        return tuple(body for body in self.bodies if isinstance(body, Arm))

    @property
    def programme(self) -> tuple[float, ...]:
        """Openings at which the legs end.

        Raises
        ------
        ValueError : a leg of no length
        """
        found = np.atleast_1d(np.asarray(self.opening, dtype=float))
        if np.any(np.diff(found, prepend=0.0) == 0.0):
            raise ValueError(f"load.opening: must change in every leg, got {found.tolist()}")
        return tuple(map(float, found))
