"""Arms on a bond, with their loads and supports, in plain numbers.

A bond that opens alone is one without slip: a law of `verify.theory.law` in place of a `MixedBond`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np

from verify.theory.law import KnownLaw
from verify.theory.layer import Layer
from verify.theory.mixed_law import MixedBond

Side = Literal["left", "right", "top", "bottom"]


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
    bond: KnownLaw | MixedBond
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
