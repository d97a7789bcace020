"""A double cantilever beam in plain numbers."""

from __future__ import annotations

from dataclasses import dataclass

from iga.specimen.problem import Debonding


@dataclass(frozen=True, kw_only=True)
class Problem(Debonding):
    """A double cantilever beam in its own frame.

    X runs from 0 (loaded end) to ``length``, the interface lies on Y = 0 and is bonded from ``precrack`` on; each arm
    is ``arm_thickness`` thick and elastic with axis 1 along X. The opening is the separation of the loaded faces. Where
    it goes below zero the faces are pressed together from X = 0 on: the load, spread over the faces at X = 0, and the
    contact next to them are a couple, which makes the arms gape behind.
    ``symmetry`` models the upper arm alone against its mirror image. ``adaptive`` T-splines follow the process zone and
    have at most ``dofs`` unknowns at any time.
    """

    length: float
    arm_thickness: float
    precrack: float
    E1: float
    E2: float
    G12: float
    nu12: float
    symmetry: bool = False
    adaptive: bool = False
