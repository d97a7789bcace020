"""Whether data can be of the simulated specimen at all, or are in other units than the scene."""

from __future__ import annotations

from math import isfinite

import numpy as np

from verify.curves.curve import Curve, envelope, from_origin, peak
from verify.studies.validation.quantities import WINDOWS, Pair, has_peak, slope

#: Factor of a stiffness or of a peak load beyond which the data are in other units: these differ by 1000 or 25.4. A
#: factor of 4.45, of pounds and newtons, is below it and appears in the statement.
OTHER_UNITS = 10.0


def other_units(simulated: Curve, data: Curve) -> str:
    """A sentence where stiffness or peak load differ by more than `OTHER_UNITS`; empty where they do not.

    Openings of another unit change the stiffness, loads of another unit the peak load as well. The opening at the peak
    does not count: on a branch of constant load, as of a peel test, the peak is anywhere.
    """
    S, D = (envelope(*from_origin(*curve)) for curve in (simulated, data))
    ratios = [_rise(D) / _rise(S)] if _is_told(S) and _is_told(D) else []
    if has_peak(S) and has_peak(D) and min(peak(S)[1], peak(D)[1]) > 0.0:
        ratios.append(peak(D)[1] / peak(S)[1])
    ratios = [ratio for ratio in ratios if isfinite(ratio)]
    if all(1.0 / OTHER_UNITS <= ratio <= OTHER_UNITS for ratio in ratios):
        return ""
    return f"no statement: {_extent('the data', D)}, and {_extent('the simulation', S)}: units?"


def _is_told(curve: Pair) -> bool:
    """Whether a row on the rise tells the stiffness: of two points it is that of the whole curve."""
    top = int(np.argmax(curve[1]))
    return bool(np.any(curve[1][1:top] > 0.0))


def _rise(curve: Pair) -> float:
    """Stiffness between the same parts of the largest load of a curve itself."""
    low, high = (part * peak(curve)[1] for part in WINDOWS.stiff)
    return slope((low, high), curve)


def _extent(name: str, curve: Pair) -> str:
    opening, load = peak(curve)
    return f"{name} open to {curve[0][-1]:.4g}, with the largest load, {load:.4g}, at the opening {opening:.4g}"
