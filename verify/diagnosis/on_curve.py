"""Causes that lie in the curve: units and signs, an offset, a compliance in series, few rows, waves of a coarse mesh.

Each is undone on the curve, which is then as far from the reference as it would be without the cause.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from math import exp, log

import numpy as np
from scipy.ndimage import uniform_filter1d
from scipy.optimize import minimize_scalar

from verify.curves.curve import PROPAGATION, SAMPLES
from verify.diagnosis.solutions import sampled
from verify.diagnosis.wording import percent
from verify.scene.magnitudes import LARGEST_NUMBER, SMALLEST_NUMBER

Curve = tuple[np.ndarray, np.ndarray]

#: Factors by which openings or loads are off when a convention or a unit is another one, with what they may mean.
FACTORS = {
    2.0: "twice as large: both arms for one, or a half for the whole",
    0.5: "half as large: one arm for both, or a half for the whole",
    1e3: "1000 times as large: a smaller unit",
    1e-3: "a thousandth: a larger unit",
}
OF_OPENINGS = FACTORS | {1.0 / 25.4: "in inches for mm", 25.4: "in mm for inches"}
OF_LOADS = FACTORS | {
    1.0 / 4.4482216: "in lbf for N",
    4.4482216: "in N for lbf",
    1.0 / 9.80665: "in kgf for N",
    9.80665: "in N for kgf",
}
#: Part by which a fitted factor may be off such a one to be called near it, and step of the logarithm in its search.
NEAR_A_FACTOR, STEP_OF_FACTORS = 0.02, 0.05
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

    def of_load(self, curve: Curve) -> float:
        """The factor of all loads without which the distance is least, 0 where there is none."""
        _, off, load = self.deviation(curve)
        along = float((off + load) @ load)
        return float((off + load) @ (off + load)) / along if along else 0.0

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
        words = f"a compliance of {soft * compliance:.3g} in series, {percent(soft)} of that of the specimen"
        yield Undone("machine compliance", words, soft * compliance, "length/force", error)
    if d.size < FEW_ROWS:
        words = f"straight lines between its {d.size} rows"
        yield Undone("few steps", words, d.size, "rows", _few(curve, reference), False)
    yield from _waves(curve, reference, at_peak)


def _factors(curve: Curve, reference: Reference, width: float) -> Iterator[Undone]:
    """Openings and loads that are off by a factor, each alone, and both by known ones.

    A factor of both that is fitted would explain too much: toughness and modulus nearly are two such.
    """
    d, P = curve
    ratio = float(np.max(d)) / reference.end
    loads = OF_LOADS | ({} if 0.2 < width < 5.0 else {width: "for the whole width", 1.0 / width: "per unit of width"})
    loads |= {-factor: f"{words}, and of the other sign" for factor, words in loads.items()}
    loads |= {-1.0: "of the other sign"}
    for one, words in OF_OPENINGS.items():
        if COVERS[0] <= ratio / one <= COVERS[1]:
            tried = d / one, P
            yield Undone(f"opening x {one:.4g}", f"openings {words}", one, "factor", reference.error(tried), False)
            both = _known(reference.of_load(tried), loads)
            if both is not None:
                name, words = f"opening x {one:.4g}, load x {both:.4g}", f"openings {words}, and loads {loads[both]}"
                yield Undone(name, words, both, "factor", reference.error((d / one, P / both)), False)
    stretch = _stretch(curve, reference, ratio)
    yield _free("opening", stretch, OF_OPENINGS, reference.error((d / stretch, P)))
    factor = reference.of_load(curve)
    if factor and REACHES[0] <= ratio <= REACHES[1]:
        yield _free("load", factor, loads, reference.error((d, P / factor)))
        one = min(loads, key=lambda known: abs(1.0 / known - 1.0 / factor))  # which leaves less than any other
        yield Undone(f"load x {one:.4g}", f"loads {loads[one]}", one, "factor", reference.error((d, P / one)), False)


def _known(factor: float, known: Mapping[float, str]) -> float | None:
    """The known factor that one is near, if any."""
    return next((one for one in known if abs(factor / one - 1.0) <= NEAR_A_FACTOR), None)


def _free(axis: str, factor: float, known: Mapping[float, str], error: float) -> Undone:
    """A fitted factor; it has the name of the known one that it is near."""
    near = _known(factor, known)
    if near is None and 0.5 < factor < 2.0:
        off = f"all {axis}s {percent(abs(factor - 1.0))} {'higher' if factor > 1.0 else 'lower'}"
        name, by = ("width", ", as by another width") if axis == "load" else ("opening factor", "")
        return Undone(name, off + by, factor - 1.0, "part", error)
    times = f"{axis}s {abs(factor):.3g} times as large{', and of the other sign' if factor < 0.0 else ''}"
    if near is None:
        return Undone(f"{axis} factor", times, factor, "factor", error)
    return Undone(f"{axis} x {near:.4g}", f"{times} ({near:.4g} is {known[near]})", factor, "factor", error)


def _stretch(curve: Curve, reference: Reference, ratio: float) -> float:
    """The factor of all openings that leaves least, among those with which the curve covers enough."""

    def left(x: float) -> float:
        return min(reference.error((curve[0] / exp(x), curve[1])), LARGEST_NUMBER)

    ends = (min(ratio, 1.0), max(ratio, 1.0)) if REACHES[0] <= ratio <= REACHES[1] else (ratio, ratio)
    low, high = log(ends[0] / COVERS[1]), log(ends[1] / COVERS[0])
    start = min(np.linspace(low, high, 2 + int((high - low) / STEP_OF_FACTORS)), key=left)
    bounds = max(start - STEP_OF_FACTORS, low), min(start + STEP_OF_FACTORS, high)
    return exp(float(minimize_scalar(left, bounds=bounds, method="bounded", options={"xatol": 1e-5}).x))


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
