"""Causes that lie in the curve: units and signs, an offset, a compliance in series, few rows, waves of a coarse mesh.

Each is undone on the curve, which is then as far from the reference as it would be without the cause.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from math import exp, log

import numpy as np
from scipy.ndimage import uniform_filter1d
from scipy.optimize import minimize_scalar

from verify.curves.curve import PROPAGATION, SAMPLES, samples
from verify.diagnosis.causes import percent
from verify.diagnosis.solutions import Curve, sampled
from verify.scene.magnitudes import LARGEST_NUMBER, SMALLEST_NUMBER
from verify.verdict import Explanation

#: Factors by which openings or loads are off when a convention or a unit is another one, with what they may mean.
FACTORS = {
    2.0: "twice as large: both arms for one, or a half for the whole",
    0.5: "half as large: one arm for both, or a half for the whole",
    1e3: "1000 times as large: a smaller unit",
    1e-3: "a thousandth: a larger unit",
}
OF_OPENINGS = FACTORS | {1.0 / 25.4: "in inches", 25.4: "in mm for inches"}
OF_LOADS = FACTORS | {
    1.0 / 4.4482216: "in lbf",
    4.4482216: "in N for lbf",
    1.0 / 9.80665: "in kgf",
    9.80665: "in N for kgf",
}
#: Part by which a fitted factor may be off such a one to be called near it, and step of the logarithm in its search.
NEAR_A_FACTOR, STEP_OF_FACTORS = 0.02, 0.05
#: Factor by which loads may be off a known one, as another cause behind it may change them.
BEHIND = 4.0
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
        at = samples(0.0, end) if end > 0.0 else np.zeros(0)
        load = sampled(self.curve, at)
        return at, sampled(curve, at) - load, load


def undone(curve: Curve, reference: Reference, width: float = 1.0) -> Iterator[Explanation]:
    """Every cause in the curve, with the error that is left without it; ``words`` complete "because ..."."""
    (d, P), cause = curve, partial(Explanation, error_without=reference.error(curve))
    for name, words, amount, tried in known_factors(curve, reference, width):
        yield cause(name, words, amount, "factor", reference.error(tried), fitted=False)
    stretch, factor = _stretch(curve, reference), reference.of_load(curve)
    yield cause(*_free("opening", stretch, OF_OPENINGS), reference.error((d / stretch, P)))
    reaches = REACHES[0] <= float(np.max(d)) / reference.end <= REACHES[1]
    if factor and reaches:
        yield cause(*_free("load", factor, _of_loads(width)), reference.error((d, P / factor)))
    if not reaches:
        return
    peak = int(np.argmax(sampled(reference.curve, np.linspace(0.0, reference.end, SAMPLES + 1))))
    at_peak = reference.end * peak / SAMPLES
    toe, error = _least(lambda x: reference.error((d - x * at_peak, P)), -0.3, 0.3)
    yield cause("toe", f"its openings have an offset of {toe * at_peak:+.3g}", toe * at_peak, "length", error)
    first = at_peak / 20.0
    stiff = float(sampled(reference.curve, np.array([first]))[0])
    if first > 0.0 and stiff > SMALLEST_NUMBER:
        compliance = first / stiff
        soft, error = _least(lambda x: reference.error((d - x * compliance * P, P)), -0.6, 0.6)
        words = f"a compliance of {soft * compliance:.3g} is in series, {percent(soft)} of that of the specimen"
        yield cause("machine compliance", words, soft * compliance, "length/force", error)
    if d.size < FEW_ROWS:  # the distance to a reference of the same rows, with straight lines between them
        error = Reference((d, sampled(reference.curve, d))).error(curve)
        yield cause(
            "few steps", f"it has straight lines between its {d.size} rows", d.size, "rows", error, fitted=False
        )
    at, off, load = reference.deviation(curve)
    behind = at > PROPAGATION * at_peak
    for window in WAVE_WINDOWS if np.count_nonzero(behind) >= 40 else ():
        mean = uniform_filter1d(off, max(3, int(window * SAMPLES)), mode="nearest")
        crossings = int(np.count_nonzero(np.diff(np.sign((off - mean)[behind])) != 0))
        if crossings >= WAVE_CROSSINGS:
            error = float(np.sqrt(np.sum(np.where(behind, mean, off) ** 2) / np.sum(load**2)))
            words = f"it has about {crossings // 2} waves behind the peak, as the elements of a coarse mesh make them"
            yield cause("coarse mesh", words, crossings / 2.0, "waves", error)


def known_factors(curve: Curve, reference: Reference, width: float) -> Iterator[tuple[str, str, float, Curve]]:
    """Openings, loads, or both off by known factors: name, words, amount, and the curve without them.

    A factor of both that is fitted would explain too much: toughness and modulus nearly are two such.
    """
    d, P = curve
    ratio = float(np.max(d)) / reference.end
    for one, of_openings in ({1.0: ""} | OF_OPENINGS).items():
        low, high = REACHES if one == 1.0 else COVERS
        if not low <= ratio / one <= high:
            continue
        fitted = reference.of_load((d / one, P))
        for other, of_loads in ({1.0: ""} | _of_loads(width)).items():
            if (of_openings or of_loads) and 1.0 / BEHIND <= fitted / other <= BEHIND:
                said = f"openings are {of_openings}" if of_openings else f"loads are {of_loads}"
                said += f" and loads {of_loads}" if of_openings and of_loads else ""
                names = [f"opening x {one:.4g}"] * bool(of_openings) + [f"load x {other:.4g}"] * bool(of_loads)
                yield ", ".join(names), said, other if of_loads else one, (d / one, P / other)


def _of_loads(width: float) -> dict[float, str]:
    """Factors by which all loads may be off, with what they mean."""
    loads = OF_LOADS | ({} if 0.2 < width < 5.0 else {width: "for the whole width", 1.0 / width: "per unit of width"})
    loads |= {-factor: f"{words}, and of the other sign" for factor, words in loads.items()}
    return loads | {-1.0: "of the other sign"}


def _free(axis: str, factor: float, known: Mapping[float, str]) -> tuple[str, str, float, str]:
    """Name, words, amount and unit of a fitted factor; it has the name of the known one that it is near."""
    near = next((one for one in known if abs(factor / one - 1.0) <= NEAR_A_FACTOR), None)
    if near is None and 0.5 < factor < 2.0:
        off = f"all {axis}s are {percent(abs(factor - 1.0))} {'higher' if factor > 1.0 else 'lower'}"
        name, by = ("width", ", as by another width") if axis == "load" else ("opening factor", "")
        return name, off + by, factor - 1.0, "part"
    times = f"{axis}s are {abs(factor):.3g} times as large{', and of the other sign' if factor < 0.0 else ''}"
    if near is None:
        return f"{axis} factor", times, factor, "factor"
    return f"{axis} x {near:.4g}", f"{times} ({near:.4g} is {known[near]})", factor, "factor"


def _stretch(curve: Curve, reference: Reference) -> float:
    """The factor of all openings that leaves least, among those with which the curve covers enough."""
    ratio = float(np.max(curve[0])) / reference.end

    def left(x: float) -> float:
        return min(reference.error((curve[0] / exp(x), curve[1])), LARGEST_NUMBER)

    ends = (min(ratio, 1.0), max(ratio, 1.0)) if REACHES[0] <= ratio <= REACHES[1] else (ratio, ratio)
    low, high = log(ends[0] / COVERS[1]), log(ends[1] / COVERS[0])
    start = min(np.linspace(low, high, 2 + int((high - low) / STEP_OF_FACTORS)), key=left)
    return exp(_least(left, max(start - STEP_OF_FACTORS, low), min(start + STEP_OF_FACTORS, high))[0])


def _least(left: Callable[[float], float], low: float, high: float) -> tuple[float, float]:
    """The amount between two bounds that leaves least, and what it leaves."""
    found = minimize_scalar(
        lambda x: min(left(x), LARGEST_NUMBER), bounds=(low, high), method="bounded", options={"xatol": 1e-5}
    )
    return float(found.x), float(found.fun)
