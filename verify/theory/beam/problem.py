"""A beam on a cohesive interface in plain numbers."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from verify.theory.beam.substrate import Layer
from verify.theory.law import Bilinear


@dataclass(frozen=True)
class BeamProblem:
    """A double cantilever beam, or a strip that is peeled off a ``substrate``, under a monotone opening.

    A strip has the length and the thickness of an arm; its precrack is the length that is not bonded. ``young`` is the
    effective axial modulus (plane strain: E / (1 - nu^2); orthotropic: E1), ``shear`` the shear modulus (orthotropic:
    G12). ``opening`` is the programme or its end; it must not unload. If ``irreversible`` is False, the energy that
    damage dissipates counts as stored. ``points`` is roughly the number of rows.
    """

    length: float
    arm_thickness: float
    precrack: float
    width: float
    young: float
    shear: float
    strength: float
    toughness: float
    ductility: float
    penalty: float
    contact: bool = True
    kinematics: str = "linear"
    opening: float | Sequence[float] = 1.0
    points: int = 150
    irreversible: bool = True
    snapshot_openings: tuple[float, ...] = ()
    substrate: Layer | None = None

    @property
    def law(self) -> Bilinear:
        return Bilinear(self.strength, self.toughness, self.ductility, self.penalty, self.contact)

    @property
    def bending(self) -> float:
        return self.young * self.width * self.arm_thickness**3 / 12.0

    @property
    def end(self) -> float:
        """Last opening of the programme.

        Raises
        ------
        ValueError : the programme unloads, or does not open at all
        """
        programme = np.concatenate(([0.0], np.atleast_1d(np.asarray(self.opening, dtype=float))))
        if np.any(np.diff(programme) <= 0.0):
            raise ValueError(
                f"load.opening: must only increase for the method beam, got {programme[1:].tolist()}; "
                "a programme that unloads needs one of the solvers"
            )
        return float(programme[-1])
