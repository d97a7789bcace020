"""Two arms on a bond, with their loads and supports, in plain numbers."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np

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
    """One arm: ``thickness``, and moduli along it (plane strain: E / (1 - nu^2)), across it and in shear."""

    thickness: float
    young: float
    transverse: float
    shear: float


@dataclass(frozen=True)
class ArmsProblem:
    """Two arms, upper and lower, from X = 0 to ``length``, whose faces meet on Y = 0.

    ``bonded`` : ends of the bond, the tip of the precrack first. Elsewhere the faces touch without friction of their
        own but that of the law
    ``opening`` : the programme of the deflection that is conjugate to the load, or its end; it must not unload
    ``loaded_at`` : X from which the length of the crack counts
    ``points`` : roughly the number of rows
    """

    arms: tuple[Arm, Arm]
    length: float
    bonded: tuple[float, float]
    width: float
    loads: Sequence[Load]
    supports: Sequence[Support]
    law: MixedBond
    opening: float | Sequence[float] = 1.0
    loaded_at: float = 0.0
    points: int = 150
    snapshot_openings: tuple[float, ...] = ()

    @property
    def end(self) -> float:
        """Last opening of the programme.

        Raises
        ------
        ValueError : the programme unloads, or does not load at all
        """
        programme = np.concatenate(([0.0], np.atleast_1d(np.asarray(self.opening, dtype=float))))
        if np.any(np.diff(programme) <= 0.0):
            raise ValueError(
                f"load.opening: must only increase for beams and fracture mechanics, got {programme[1:].tolist()}; "
                "a programme that unloads needs one of the solvers"
            )
        return float(programme[-1])
