"""The double cantilever beam: a delamination specimen with two equal arms."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

from iga.delamination import build, solve
from iga.specimen.layout import Layout, Moduli, Rectangle
from iga.specimen.opening import OpeningProblem
from iga.specimen.ranges import require, require_positive

__all__ = ["Problem", "build", "solve"]


@dataclass(frozen=True, kw_only=True)
class Problem(OpeningProblem):
    """A double cantilever beam in its own frame.

    X runs from 0 (loaded end) to ``length``, the interface lies on Y = 0 and is bonded from ``precrack`` on; each arm
    is ``arm_thickness`` thick and elastic with axis 1 along X, isotropic where ``E2`` and ``G12`` are left out. The
    opening is the separation of the loaded faces. Below zero the faces are pressed together near X = 0: the load, which
    is spread over the faces at X = 0, and the contact next to them form a couple that makes the arms gape behind.
    """

    length: float
    arm_thickness: float
    precrack: float
    E1: float
    nu12: float
    E2: float | None = None
    G12: float | None = None

    def __post_init__(self) -> None:
        super().__post_init__()
        require_positive(self, "length", "arm_thickness", "precrack")
        require(self, "precrack", self.precrack < self.length, f"< length = {self.length:g}")
        self._moduli()  # which refuses constants out of their ranges

    def _moduli(self) -> Moduli:
        return Moduli(E1=self.E1, nu12=self.nu12, E2=self.E2, G12=self.G12)

    @cached_property
    def layout(self) -> Layout:
        arm = Rectangle(self.length, self.arm_thickness, self._moduli())
        return Layout((arm, arm), (self.precrack, self.length))
