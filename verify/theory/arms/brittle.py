"""Fracture mechanics of two arms in mixed mode: the brittle limit of the beam on a bond, for any loads and supports.

With a crack tip at X the arms are bonded beyond it, stiffly but for what they give themselves, which is in
`verify.theory.arms.interface`, and touch before it. What that foundation stores at the tip is released as the crack
grows:

    G_I = c_n p^2 / 2, none where p presses,   G_II = c_t t^2 / 2,   dC/da = 2 b (G_I + G_II) / P^2

with the compliance C, conjugate deflection over load. For equal arms this is beam theory with the effective crack
lengths a + D_I and a + D_II. For unequal arms beam theory alone parts G into modes in no unique way; here the elastic
foundation does (Bennati, Fisicaro, Valvo 2013, Meccanica 48). The sum depends on no partition.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from scipy.interpolate import CubicSpline

from verify.theory.arms.equations import Bordered, Pattern
from verify.theory.arms.interface import compliances, extra_lengths
from verify.theory.arms.problem import ArmsProblem
from verify.theory.arms.splines import Meshes
from verify.theory.arms.structure import Structure
from verify.theory.solution import Solution, rows_of

#: Iterations of the zones of contact of arms with a crack.
MOST_CONTACTS = 40

#: Depth to which faces enter each other and are still apart, as a part of the largest motion: arms that bend alike lie
#: on each other without a force. Zones of contact have come to rest where they change the compliance by no more than
#: this part: points so near to each other touch and part in turn, for ever.
CONTACT_DEPTH = 1e-8

#: Elements of even length at most: where arms are so thin that these are longer than D_II, the last digits suffer.
MOST_ELEMENTS = 1000

#: Part of the largest G beyond which a crack is taken to stop.
SMALLEST_RELEASE = 1e-9


@dataclass(frozen=True)
class Releases:
    """Cracks with their tips at X ``tip`` (n,), under a load of 1: conjugate deflection C, G_I, G_II (n,)."""

    tip: np.ndarray
    compliance: np.ndarray
    G_I: np.ndarray
    G_II: np.ndarray

    @property
    def mode_ratio(self) -> np.ndarray:
        """G_II / G, 0 where nothing is released."""
        total = self.G_I + self.G_II
        return np.divide(self.G_II, total, out=np.zeros_like(total), where=total > 0.0)


@dataclass(frozen=True)
class Growth:
    """The curve along which a crack grows: tips X, conjugate deflection, load, mode ratio, toughness (n,)."""

    tip: np.ndarray
    opening: np.ndarray
    load: np.ndarray
    mode_ratio: np.ndarray
    toughness: np.ndarray
    release: np.ndarray

    def turns(self, loaded_at: float = 0.0) -> np.ndarray:
        """Lengths of the crack at which a test at prescribed deflection changes between stable and not: there the
        deflection along the curve is least or largest."""
        return CubicSpline(self.tip, self.opening).derivative().roots(extrapolate=False) - loaded_at


def releases(problem: ArmsProblem, first: float | None = None) -> Releases:
    """Cracks with tips from X = ``first``, by default the end of the precrack, to next to the end of the bond.

    Raises
    ------
    Refusal : loads that nothing takes
    ValueError : faces of a crack find no equilibrium
    """
    tip, far = problem.bonded[0] if first is None else first, problem.bonded[1]
    lengths = np.array([extra_lengths(arm) for arm in problem.arms])
    last = far - lengths[:, 0].max()
    tips = np.linspace(tip, last, problem.points) if last > tip else np.zeros(0)
    size = max(float(lengths[:, 1].min()), problem.length / MOST_ELEMENTS)
    linear = replace(problem, order=1, kinematics="linear")
    one = Structure.of(linear, Meshes(linear, (tip, *tips), size).finest)
    pattern, give = Pattern(one), np.array(compliances(problem.arms))
    pressed, found = np.zeros(one.at_points.shape, dtype=bool), []
    for place in tips:
        x, C, pressed = _cracked(pattern, place, give, pressed)
        g, s = one.jump_at(x, *one.mesh.at(place))
        found.append((C, 0.5 * max(g, 0.0) ** 2 / give[0], 0.5 * s**2 / give[1]))
    return Releases(tips, *np.array(found).reshape(-1, 3).T)


def _cracked(
    pattern: Pattern, tip: float, give: np.ndarray, pressed: np.ndarray
) -> tuple[np.ndarray, float, np.ndarray]:
    """Unknowns under a load of 1, compliance, and where the faces touch (E, q), with a crack up to the ``tip``;
    ``pressed`` is a guess of where they do."""
    one, before = pattern.structure, 0.0
    beyond, nothing = one.at_points > tip, np.zeros(one.count)
    for _ in range(MOST_CONTACTS):
        stiff = np.zeros((*pressed.shape, 2, 2))
        stiff[..., 0, 0] = np.where(beyond | pressed, 1.0 / give[0], 0.0)
        stiff[..., 1, 1] = np.where(beyond, 1.0 / give[1], 0.0)
        band = pattern.banded([one.bond_stiffness(stiff)], pattern.linear)
        step, _ = Bordered(pattern, band).solve(nothing, np.zeros(len(one.held)), one.load, 1.0)
        x = step.x / step.load
        jump = one.functionals(x)
        touching = (jump[..., 0] < -CONTACT_DEPTH * np.abs(x).max()) & ~beyond
        if np.array_equal(touching, pressed & ~beyond) or abs(step.load - before) <= CONTACT_DEPTH * abs(before):
            return x, 1.0 / step.load, pressed
        pressed, before = touching, step.load
    raise ValueError(f"specimen: faces of a crack up to X = {tip:.6g} touch and part in turn, without an equilibrium")


class Stability(NamedTuple):
    """Whether the crack begins to grow stably at a prescribed deflection, and the lengths at which that changes."""

    stable: bool
    changes: tuple[float, ...]


def stability(problem: ArmsProblem) -> Stability:
    """Of cracks from a tenth of the precrack on; a test is stable where growth takes more deflection."""
    tip, start = problem.bonded[0], problem.loaded_at
    curve = growth(problem, releases(problem, start + 0.1 * (tip - start)))
    rate = CubicSpline(curve.tip, curve.opening)(tip, 1)
    return Stability(bool(rate > 0.0), tuple(map(float, curve.turns(start))))


def growth(problem: ArmsProblem, found: Releases) -> Growth:
    """The equilibrium curve of the growing crack: G P^2 = G_c at the mode ratio of the tip, snap-backs included.

    It ends where nothing is released any more.
    """
    total = found.G_I + found.G_II
    ends = np.flatnonzero(total <= SMALLEST_RELEASE * total.max())
    n = int(ends[0]) if len(ends) else len(total)
    B = found.mode_ratio[:n]
    G_c = np.array([problem.bond.critical(one) for one in B])
    load = np.sqrt(G_c / total[:n])
    return Growth(found.tip[:n], found.compliance[:n] * load, load, B, G_c, total[:n])


def solve(problem: ArmsProblem, on_step: Callable[[Mapping[str, float]], None] | None = None) -> Solution:
    """Load curve: the arms bend with the crack at the precrack, then it grows to the end of the programme or the bond.

    Stored and dissipated energy together are the work of the load; ``load_slope`` at the onset is that before it.

    Raises
    ------
    ValueError : the programme unloads, or the loads grow no crack
    """
    found, tip, end, ending = releases(problem), problem.bonded[0], problem.programme[-1], ""
    curve = growth(problem, found)
    onset = curve.opening[0] if len(curve.tip) else np.inf
    opening = np.linspace(0.0, min(onset, end), max(2, problem.points // 3))
    load = opening / found.compliance[0]
    # tip, opening, load, slope of the load, G, mode ratio, energy lost
    G, B, none = (found.G_I + found.G_II)[0] * load**2, found.mode_ratio[0], np.zeros_like(opening)
    slope = none + 1.0 / found.compliance[0]
    parts = [np.stack((none + tip, opening, load, slope, G, none + B, none))]
    if end > onset:
        path = CubicSpline(curve.tip, np.stack((curve.opening, curve.load, curve.toughness, curve.mode_ratio), -1))
        last, ending = curve.tip[-1], f"separated at opening {curve.opening[-1]:.6g}"
        if (reached := np.flatnonzero(curve.opening >= end)).size:
            inside = CubicSpline(curve.tip, curve.opening).solve(end, extrapolate=False)
            last, ending = min(inside[inside > curve.tip[reached[0] - 1]], default=last), ""
        tips = np.linspace(curve.tip[0], last, max(3, problem.points - problem.points // 3))[1:]
        (d, P, G_c, ratio), rate, taken = path(tips).T, path(tips, 1).T, path.antiderivative()
        lost = problem.width * (taken(tips) - taken(tip))[:, 2]
        parts.append(np.stack((tips, d, P, rate[1] / rate[0], G_c, ratio, lost)))
    tips, d, P, slopes, J, ratio, lost = np.hstack(parts)
    columns = {"opening": d, "load": P, "crack_length": tips - problem.loaded_at, "stored_energy": 0.5 * d * P}
    columns |= {"dissipated_energy": lost, "external_work": 0.5 * d * P + lost, "newton_iterations": np.zeros_like(d)}
    rows = rows_of({**columns, "load_slope": slopes, "J_loads": J, "mode_ratio": ratio})
    for row in rows if on_step else ():
        on_step(row)  # type: ignore[misc]
    return Solution(rows, ending=ending)
