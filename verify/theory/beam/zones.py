"""Zones of the arm (free, open, softening, elastic, in contact), and the mesh with nodes at their ends."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from verify.theory.beam.arm import FORCE, Arm
from verify.theory.beam.collocation import Field
from verify.theory.beam.peeled_strip import Strip
from verify.theory.law import Bilinear

FREE, OPEN, SOFTENING, ELASTIC, CONTACT, BARE = range(6)  # bare: free, without a substrate beneath

#: Parts of p_max: a wave of opening and closing beyond the front becomes a zone above the first number, and stays one
#: down to the second, so that it does not appear and disappear between Newton's iterations. Farther waves are taken as
#: elastic: a wave acts on the front by the square of its size.
SMALLEST_WAVE = 1e-6, 1e-8


@dataclass(frozen=True)
class Foundation:
    """The law in the units of the arm, as a function of v, the gap over the number of arms.

    ``on`` (6, 3): for each kind of zone k and c of the force c + k v, and 1 if a substrate is beneath, else 0;
    ``v_peak`` is v at the onset of damage, ``v_open`` that of zero traction.
    """

    on: np.ndarray
    v_peak: float
    v_open: float
    contact: bool

    @staticmethod
    def of(law: Bilinear, width: float, h: float, bending: float, arms: int) -> Foundation:
        scale, unit = width * h**3 / bending, arms * h
        below = law.penalty if law.contact else law.stiffness
        k = unit * scale * np.array([0.0, 0.0, law.softening, law.stiffness, below, 0.0])
        c = scale * np.array([0.0, 0.0, -law.softening * law.g_open, 0.0, 0.0, 0.0])
        beneath = np.array([1.0, 1.0, 1.0, 1.0, 1.0, 0.0])
        on = np.stack((k, c, beneath), axis=1)
        return Foundation(on, law.g_peak / unit, law.g_open / unit, law.contact)

    @property
    def k(self) -> np.ndarray:
        return self.on[:, 0]

    def closing(self, k: float) -> Foundation:
        """The same with another stiffness of contact."""
        on = self.on.copy()
        on[CONTACT, 0] = k
        return replace(self, on=on)


@dataclass(frozen=True)
class Ends:
    """Fixed positions: end of the precrack, far end, and ``edge`` (0: none), from which on a substrate is beneath."""

    precrack: float
    length: float
    edge: float = 0.0

    def untouched(self) -> Zones:
        """The zones of an arm without damage and without contact."""
        return _full([self.edge, self.precrack, self.length], [BARE, FREE, ELASTIC])


@dataclass(frozen=True)
class Zones:
    """Zones along the arm: ``bound`` (n + 1,) their ends, ``kind`` (n,) their kinds."""

    bound: np.ndarray
    kind: np.ndarray


def find(
    arm: Arm | Strip, base: Foundation, field: Field, kind_e: np.ndarray, ends: Ends, front: float | None
) -> Zones:
    """Zones of a field; ``front`` is the damage front, or None to find it too (not before the end of the precrack)."""
    precrack = ends.precrack
    x, y = field.samples()
    kind = np.append(np.repeat(kind_e, field.stage.shape[1] + 1), kind_e[-1])
    v, by = arm.gap(y)
    slope = np.sum(by * arm.rates(y, base.on[kind])[0], axis=-1)
    if front is None:
        front = _last_above(x, v, slope, base.v_peak, precrack, x[-1])
    tip = _last_above(x, v, slope, base.v_open, precrack, front)
    followed = int(np.count_nonzero(np.diff(kind_e[np.isin(kind_e, (ELASTIC, CONTACT))])))
    strain = np.abs(v) * np.maximum(base.k[kind] / base.k[ELASTIC], 1.0) / base.v_peak
    crossings = _waves(x, v, slope, front, followed, strain) if base.contact else []
    beyond = [ELASTIC if i % 2 == 0 else CONTACT for i in range(len(crossings) + 1)]
    return _full([ends.edge, precrack, tip, front, *crossings, x[-1]], [BARE, FREE, OPEN, SOFTENING, *beyond])


def _full(right: list[float], kinds: list[int]) -> Zones:
    """Zones by their right ends, without those of zero length."""
    full = np.diff(right, prepend=0.0) > 0.0
    return Zones(np.append(0.0, np.array(right)[full]), np.array(kinds)[full])


def _last_above(x: np.ndarray, v: np.ndarray, slope: np.ndarray, level: float, low: float, high: float) -> float:
    """Last position in [low, high] at which v falls below ``level``; ``low`` if v is never above it."""
    inside = np.flatnonzero((x >= low) & (x <= high) & (v >= level))
    if len(inside) == 0:
        return low
    i = inside[-1]
    if i + 1 == len(x):
        return high
    return min(_root(x[i : i + 2], v[i : i + 2] - level, slope[i : i + 2]), high)


def _waves(
    x: np.ndarray, v: np.ndarray, slope: np.ndarray, front: float, followed: int, strain: np.ndarray
) -> list[float]:
    """Sign changes of v beyond ``front`` whose waves are above `SMALLEST_WAVE`; ``followed`` of them are zones already.

    ``strain`` is the traction at every sample as a part of p_max.
    """
    beyond = np.flatnonzero(x > front)
    if len(beyond) < 2:
        return []
    sign = np.where(v[beyond] >= 0.0, 1, -1)
    changes = beyond[:-1][sign[1:] != sign[:-1]]
    largest_after = np.maximum.accumulate(strain[::-1])[::-1]
    least = np.where(np.arange(len(changes)) < followed, SMALLEST_WAVE[1], SMALLEST_WAVE[0])
    kept = changes[largest_after[changes + 1] > least]
    return [_root(x[i : i + 2], v[i : i + 2], slope[i : i + 2]) for i in kept]


def _root(x: np.ndarray, v: np.ndarray, slope: np.ndarray) -> float:
    """Root between two points of the cubic Hermite interpolant, by safeguarded Newton iterations."""
    h = x[1] - x[0]
    low, high, t = 0.0, 1.0, v[0] / (v[0] - v[1]) if v[0] != v[1] else 0.0
    a, b = h * slope[0], h * slope[1]
    cubic = np.array([2 * (v[0] - v[1]) + a + b, 3 * (v[1] - v[0]) - 2 * a - b, a, v[0]])
    for _ in range(30):
        value = np.polyval(cubic, t)
        low, high = (t, high) if value * v[0] > 0.0 else (low, t)
        rate = np.polyval(cubic[:3] * [3.0, 2.0, 1.0], t)
        step = -value / rate if rate != 0.0 else np.inf
        new = t + step if low <= t + step <= high else 0.5 * (low + high)
        if abs(new - t) < 1e-15:
            break
        t = new
    return float(x[0] + h * t)


def mesh(arm: Arm | Strip, base: Foundation, zones: Zones, force: float) -> tuple[np.ndarray, np.ndarray]:
    """Nodes (n + 1,) and kinds (n,) of elements: graded to both ends of each zone, where boundary layers are."""
    nodes, kinds = [0.0], []
    for low, high, kind in zip(zones.bound[:-1], zones.bound[1:], zones.kind, strict=True):
        inner = low + (high - low) * _graded(2.0 / max(arm.decay(base.on[kind], force), 1e-300), high - low)
        inner[-1] = high
        nodes.extend(inner)
        kinds.extend([kind] * len(inner))
    return np.array(nodes), np.array(kinds)


def _graded(first: float, length: float) -> np.ndarray:
    """Right ends, in (0, 1], of elements that double in size from ``first`` at both ends of a zone of ``length``."""
    if length <= 4.0 * first:
        n = max(1, int(np.ceil(length / first)))
        return np.linspace(0.0, 1.0, n + 1)[1:]
    half = int(np.ceil(np.log2(length / (2.0 * first) + 1.0)))
    sizes = 2.0 ** np.arange(half)
    return np.cumsum(np.concatenate((sizes, sizes[::-1]))) / (2.0 * sizes.sum())


def peak_force(field: Field) -> float:
    return float(np.abs(field.node[:, FORCE]).max())
