"""Causes that lie in the curve: units and signs, an offset, a compliance in series, few rows, waves of a coarse mesh.

Each is undone on the curve, which is then as far from the reference as it would be without the cause.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
from scipy.ndimage import uniform_filter1d
from scipy.optimize import minimize_scalar

from verify.curves.curve import PROPAGATION, SAMPLES
from verify.diagnosis.solutions import sampled
from verify.scene.magnitudes import LARGEST_NUMBER, SMALLEST_NUMBER

Curve = tuple[np.ndarray, np.ndarray]

#: Factors by which openings or loads are off when a convention or a unit is another one, with what they may mean.
FACTORS = {
    2.0: "twice as large: both arms for one, or a half for the whole",
    0.5: "half as large: one arm for both, or a half for the whole",
    1e3: "1000 times as large: a smaller unit",
    1e-3: "a thousandth: a larger unit",
    -1.0: "of the other sign",
}
#: Part of the reference that an undone curve must cover, and by how much it may go beyond.
COVERS = (0.6, 1.7)
#: The same of a curve that is not off by a factor: openings of another unit have no offset.
REACHES = (0.3, 3.0)
#: Rows below which straight lines between them may matter.
FEW_ROWS = 100
#: Waves of a coarse mesh: windows of the mean, over the largest opening, and the least number of crossings.
WAVE_WINDOWS, WAVE_CROSSINGS = (0.01, 0.02, 0.04, 0.07, 0.1), 8


@dataclass(frozen=True)
class Reference:
    """The curve that the other one should be."""

    curve: Curve

    @property
    def end(self) -> float:
        return float(np.max(self.curve[0]))

    def error(self, curve: Curve) -> float:
        """Relative L2 distance over the openings that both have."""
        _, off, load = self.deviation(curve)
        size = float(np.sqrt(np.sum(load**2)))
        return float(np.sqrt(np.sum(off**2))) / size if size > SMALLEST_NUMBER else np.inf

    def deviation(self, curve: Curve) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Openings (n,), load of the curve minus that of the reference there, and the latter."""
        end = min(self.end, float(np.max(curve[0])))
        if not end > 0.0:
            return np.zeros(0), np.zeros(0), np.zeros(0)
        at = end * np.arange(1, SAMPLES + 1) / SAMPLES
        load = sampled(self.curve, at)
        return at, sampled(curve, at) - load, load


@dataclass(frozen=True)
class Undone:
    """A cause in the curve; ``free``: whether its amount was fitted. ``words`` complete "the curve has ..."."""

    name: str
    words: str
    amount: float
    unit: str
    error: float
    free: bool = True


def undone(curve: Curve, reference: Reference, width: float = 1.0) -> Iterator[Undone]:
    """Every cause in the curve, with the error that is left without it."""
    d, P = curve
    yield from _factors(curve, reference, width)
    if not REACHES[0] <= float(np.max(d)) / reference.end <= REACHES[1]:
        return
    peak = int(np.argmax(sampled(reference.curve, np.linspace(0.0, reference.end, SAMPLES + 1))))
    at_peak = reference.end * peak / SAMPLES
    toe, error = _fitted(lambda x: (d - x * at_peak, P), reference, 0.3)
    yield Undone("toe", f"an offset of the opening by {toe * at_peak:+.3g}", toe * at_peak, "length", error)
    first = at_peak / 20.0
    stiff = float(sampled(reference.curve, np.array([first]))[0])
    if first > 0.0 and stiff > SMALLEST_NUMBER:
        compliance = first / stiff
        soft, error = _fitted(lambda x: (d - x * compliance * P, P), reference, 0.6)
        words = f"a compliance of {soft * compliance:.3g} in series, {100 * soft:.2g} % of that of the specimen"
        yield Undone("machine compliance", words, soft * compliance, "length/force", error)
    part, error = _fitted(lambda x: (d, P / (1.0 + x)), reference, 0.4)
    words = f"all loads {100 * abs(part):.2g} % {'higher' if part > 0 else 'lower'}, as by another width"
    yield Undone("width", words, part, "part", error)
    if d.size < FEW_ROWS:
        words = f"straight lines between its {d.size} rows"
        yield Undone("few steps", words, d.size, "rows", _few(curve, reference), False)
    yield from _waves(curve, reference, at_peak)


def _factors(curve: Curve, reference: Reference, width: float) -> Iterator[Undone]:
    of_width = {} if 0.2 < width < 5.0 else {width: "for the whole width", 1.0 / width: "per unit of width"}
    for name, table in (("opening", FACTORS), ("load", FACTORS | of_width)):
        for factor, words in table.items():
            tried = (curve[0] / factor, curve[1]) if name == "opening" else (curve[0], curve[1] / factor)
            if COVERS[0] <= np.max(tried[0]) / reference.end <= COVERS[1]:
                error = reference.error(tried)
                yield Undone(f"{name} x {factor:g}", f"{name}s {words}", factor, "factor", error, False)


def _fitted(change: Callable[[float], Curve], reference: Reference, most: float) -> tuple[float, float]:
    """The amount within ``most`` that leaves least."""
    best = minimize_scalar(
        lambda x: min(reference.error(change(x)), LARGEST_NUMBER),
        bounds=(-most, most),
        method="bounded",
        options={"xatol": 1e-5},
    )
    return float(best.x), float(best.fun)


def _few(curve: Curve, reference: Reference) -> float:
    """Distance to the reference where that has the same rows, and straight lines between them."""
    d = curve[0]
    return Reference((d, sampled(reference.curve, d))).error(curve)


def _waves(curve: Curve, reference: Reference, at_peak: float) -> Iterator[Undone]:
    """What is left of the deviation behind the peak as its running mean, where it crosses that often."""
    at, off, load = reference.deviation(curve)
    behind = at > PROPAGATION * at_peak
    if np.count_nonzero(behind) < 40:
        return
    for window in WAVE_WINDOWS:
        mean = uniform_filter1d(off, max(3, int(window * SAMPLES)), mode="nearest")
        wave = (off - mean)[behind]
        crossings = int(np.count_nonzero(np.diff(np.sign(wave)) != 0))
        if crossings >= WAVE_CROSSINGS:
            left = np.where(behind, mean, off)
            error = float(np.sqrt(np.sum(left**2) / np.sum(load**2)))
            words = f"about {crossings // 2} waves behind the peak, as the elements of a coarse mesh make them"
            yield Undone("coarse mesh", words, crossings / 2.0, "waves", error)
