"""The displacement paths on which a law of opening and sliding is judged."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from verify.studies.law.ways.legs import Corner, JumpPath, legs
from verify.studies.law.ways.milestones import Milestones, jump, milestones
from verify.theory.mixed_law import MixedBond


@dataclass(frozen=True)
class Fineness:
    """How many steps the paths have, and how far they go: more steps cost time and show finer faults."""

    leg: int = 40  # steps of a leg through damage
    few: int = 6  # steps of a leg without any
    stairs: int = 12  # of the alternating path
    beyond: float = 1.5  # where paths end, over the jump at failure: more than sqrt(2)
    far: float = 100.0  # where the path that goes far beyond failure ends, over the jump at failure
    pressures: tuple[float, ...] = (0.01, 0.3, 1.0)  # over the shear strength


def paths(bond: MixedBond, shear: bool = True, fineness: Fineness | None = None) -> tuple[JumpPath, ...]:
    """All paths of a bond, scaled to its own jumps; without ``shear`` those that only open and close.

    A rotation of the frame by 180 degrees about the normal changes the sign of the slip, which one path does on its
    way; swapping the two faces changes neither opening nor slip. Other rotations can only be tested on a mesh, as a law
    of two scalars does not depend on them.
    """
    maker = _Maker(bond, fineness or Fineness())
    makers: tuple[Callable[[], Iterator[JumpPath]], ...] = (maker.opening,)
    if shear:
        makers = (
            maker.opening,
            maker.monotonic,
            maker.unloading,
            maker.pressed,
            maker.changing,
            maker.signs,
            maker.near,
        )
    return tuple(path for make in makers for path in make())


@dataclass(frozen=True)
class _Maker:
    bond: MixedBond
    fine: Fineness

    def opening(self) -> Iterator[JumpPath]:
        yield self._straight(0.0, "mode-I", "Opening to failure.")
        yield self._unloaded(0.0, "unload-reload-I", "Opening, unloaded and reloaded half way.")
        (half, _), (end, _) = self._at(0.0, "half"), self._at(0.0, "end")
        press = -self.bond.strength[0] / self.bond.penalty
        corners = [(0.0, 0.0), (half, 0.0), (0.0, 0.0), (press, 0.0), (0.0, 0.0), (end, 0.0), (0.0, 0.0), (press, 0.0)]
        few, leg = self.fine.few, self.fine.leg
        what = "Opened half way, closed and pressed, opened to failure, closed and pressed again."
        kinks = self._found(0.0).kinks
        yield self._of("contact", what, corners, (leg, few, few, few, leg, few, few), kinks)
        what = "Nothing moves; then jumps of 1e-12 of the onset."
        tiny = 1e-12 * self._at(0.0, "onset")[0]
        yield JumpPath("zero", what, np.array([0.0, 0.0, 0.0, tiny, 0.0, 0.0]), np.zeros(6))
        what = "Opened far beyond failure, and back to nothing."
        corners = [(0.0, 0.0), (end, 0.0), (self.fine.far * end, 0.0), (0.0, 0.0)]
        yield self._of("far-I", what, corners, (leg, few, few), kinks)

    def monotonic(self) -> Iterator[JumpPath]:
        yield self._straight(1.0, "mode-II", "Sliding to failure, neither open nor closed.")
        for percent in (20, 50, 80):
            what = f"Opening and sliding to failure at a constant ratio, {percent} % of the energy in sliding."
            yield self._straight(percent / 100.0, f"mixed-{percent}", what)

    def unloading(self) -> Iterator[JumpPath]:
        yield self._unloaded(1.0, "unload-reload-II", "Sliding, unloaded and reloaded half way.")
        yield self._unloaded(0.5, "unload-reload-50", "Both, unloaded and reloaded half way.")
        (g, s), press = self._at(0.5, "end"), -self.bond.strength[0] / self.bond.penalty
        corners = [(0.0, 0.0), (g, s), (self.fine.far * g, self.fine.far * s), (0.0, 0.0), (press, 0.0), (press, s)]
        what = "Far beyond failure and back; then pressed and slid."
        few = self.fine.few
        yield self._of("far-50", what, corners, (self.fine.leg, few, few, few, few), self._found(0.5).kinks)

    def pressed(self) -> Iterator[JumpPath]:
        for number, part in enumerate(self.fine.pressures, 1):
            pressure = part * self.bond.strength[1]
            what = f"Closed under a pressure of {100 * part:g} % of the shear strength, then slid to failure."
            yield self._compressed(f"compressed-shear-{number}", what, pressure)
        pressure = self.fine.pressures[1] * self.bond.strength[1]
        g, found = -pressure / self.bond.penalty, self._found(1.0, pressure)
        s, end = (jump(self.bond, 1.0, size)[1] for size in (found.half, self.fine.beyond * found.end))
        corners = [(0.0, 0.0), (g, 0.0), (g, s), (g, -0.8 * s), (g, end)]
        what = "Slid half way under pressure, back beyond the start, and to failure."
        leg = self.fine.leg
        yield self._of("compressed-cycle", what, corners, (self.fine.few, leg, leg, leg), self._kinks(pressure))

    def changing(self) -> Iterator[JumpPath]:
        (g, _), (_, s) = self._at(0.0, "half"), self._at(1.0, "half")
        (G, _), (_, S) = self._at(0.0, "end"), self._at(1.0, "end")
        o, leg = (0.0, 0.0), self.fine.leg
        two, three = (leg, 2 * leg), (leg, self.fine.few, 2 * leg)
        yield self._of("opening-then-shear", "Opened half way, held, then slid to failure.", [o, (g, 0.0), (g, S)], two)
        yield self._of("shear-then-opening", "Slid half way, held, then opened to failure.", [o, (0.0, s), (G, s)], two)
        what = "Opened half way, closed, then slid to failure."
        yield self._of("opening-closed-shear", what, [o, (g, 0.0), o, (0.0, S)], three)
        what = "Slid half way, back, then opened to failure."
        yield self._of("shear-back-opening", what, [o, (0.0, s), o, (G, 0.0)], three)
        yield self._alternating()

    def signs(self) -> Iterator[JumpPath]:
        for path in (*self.monotonic(), self._compressed("compressed-shear-2", "", self._pressure(1))):
            if path.name in ("mode-II", "mixed-50", "compressed-shear-2"):
                what = f"The path {path.name} with the opposite sign of slip."
                yield replace(path, name=f"{path.name}-negative", what=what, s=-path.s, ratio=None, pressure=None)
        path = self._straight(0.5, "turned-frame", "Both; the frame turns half way, and the slip changes its sign.")
        sign = np.where(np.arange(path.s.size) < path.s.size // 2, 1.0, -1.0)
        yield replace(path, s=sign * path.s, ratio=None)

    def near(self) -> Iterator[JumpPath]:
        """Gaps of 0 and just above or below it at rising slips: the smallest number, 2^-52 and 1e-9 of the onset."""
        onset = self._at(0.0, "onset")[0]
        sides = np.array([0.0, 5e-324, -5e-324, 2.0**-52 * onset, -(2.0**-52) * onset, 1e-9 * onset, -1e-9 * onset])
        found = self._found(1.0)
        sizes = [0.5 * found.onset, *np.linspace(found.onset, found.end, 6)[1:-1], self.fine.beyond * found.end]
        slips = [jump(self.bond, 1.0, size)[1] for size in sizes]
        for name, order in (
            ("closed-either-side", sides),
            ("closed-other-side", np.append(sides[2:], sides[:2])[::-1]),
        ):
            g, s = np.append(0.0, np.tile(order, len(slips))), np.append(0.0, np.repeat(slips, order.size))
            yield JumpPath(name, "Sliding, with the faces a last digit or 1e-9 of the onset open and closed.", g, s)

    def _alternating(self) -> JumpPath:
        (g, _), (_, s) = (self._at(B, "end") for B in (0.0, 1.0))
        n = self.fine.stairs
        rise = np.arange(2 * n + 1)
        opened, slid = (rise + 1) // 2 / n, rise // 2 / n
        what = "Opening and sliding by turns."
        corners = [(float(a), float(b)) for a, b in zip(g * opened, s * slid, strict=True)]
        return self._of("alternating", what, corners, (4,) * (2 * n))

    def _straight(self, B: float, name: str, what: str) -> JumpPath:
        end = jump(self.bond, B, self.fine.beyond * self._found(B).end)
        return replace(self._of(name, what, [(0.0, 0.0), end], (self.fine.leg,), self._found(B).kinks), ratio=B)

    def _unloaded(self, B: float, name: str, what: str) -> JumpPath:
        half, end = self._at(B, "half"), self._at(B, "end")
        o, leg = (0.0, 0.0), self.fine.leg
        steps = leg, self.fine.few, self.fine.few, leg
        return self._of(name, what, [o, half, o, half, end], steps, self._found(B).kinks)

    def _compressed(self, name: str, what: str, pressure: float) -> JumpPath:
        g, found = -pressure / self.bond.penalty, self._found(1.0, pressure)
        end = jump(self.bond, 1.0, self.fine.beyond * found.end)[1]
        corners = [(0.0, 0.0), (g, 0.0), (g, end)]
        path = self._of(name, what, corners, (self.fine.few, self.fine.leg), self._kinks(pressure))
        return replace(path, pressure=pressure)

    def _pressure(self, number: int) -> float:
        return self.fine.pressures[number] * self.bond.strength[1]

    def _of(
        self, name: str, what: str, corners: Sequence[Corner], steps: Sequence[int], kinks: Sequence[float] = ()
    ) -> JumpPath:
        g, s = legs(self.bond, corners, steps, kinks).T
        return JumpPath(name, what, g, s)

    def _kinks(self, pressure: float) -> tuple[float, ...]:
        """Kinks of sliding under pressure: those of damage, and the jump at which friction begins to slip."""
        return *self._found(1.0, pressure).kinks, self.bond.friction * pressure / self.bond.slopes[1] ** 0.5

    def _found(self, B: float, pressure: float = 0.0) -> Milestones:
        return milestones(self.bond, B, pressure)

    def _at(self, B: float, which: str) -> Corner:
        size = getattr(self._found(B), which)
        return jump(self.bond, B, self.fine.beyond * size if which == "end" else size)
