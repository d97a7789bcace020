"""A delamination specimen in plain numbers, whatever its kind."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

from iga.laws.law import Law
from iga.specimen.layout import Clamp, Layout, Load, Rectangle, Support
from iga.specimen.problem import Debonding


@dataclass(frozen=True, kw_only=True)
class Problem(Debonding):
    """A specimen by what its layout consists of (see `Layout`), and the traction law of its ``bond``."""

    bodies: tuple[Rectangle, Rectangle]
    bonded: tuple[float, float]
    bond: Law
    loads: tuple[Load, ...]
    clamps: tuple[Clamp, ...] = ()
    supports: tuple[Support, ...] = ()
    loaded_at: float | None = None

    @property
    def law(self) -> Law:
        return self.bond

    @cached_property
    def layout(self) -> Layout:
        return Layout(self.bodies, self.bonded, self.loads, self.clamps, self.supports, self.loaded_at)
