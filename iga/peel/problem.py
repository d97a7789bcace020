"""A peel test in plain numbers."""

from __future__ import annotations

from dataclasses import dataclass

from iga.specimen.problem import Debonding


@dataclass(frozen=True)
class Moduli:
    """Elastic constants, axis 1 along the specimen."""

    E1: float
    E2: float
    G12: float
    nu12: float


@dataclass(frozen=True, kw_only=True)
class Problem(Debonding):
    """A peel test in its own frame.

    Strip (above) and substrate (below) meet on Y = 0 with their left ends flush on X = 0, and are bonded for X from 0
    to ``bond_length``. The opening is the mean displacement across the specimen of the strip's right end, which
    carries the load.
    """

    strip_length: float
    strip_thickness: float
    substrate_length: float
    substrate_thickness: float
    bond_length: float
    strip: Moduli
    substrate: Moduli
