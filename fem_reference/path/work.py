"""External work along one step, to fourth order, also where the opening turns back."""

from __future__ import annotations

import numpy as np

#: Integrals of h_i dh_j/ds over 0 <= s <= 1 for the cubic Hermite polynomials h of (value at 0, value at 1, slope at 0,
#: slope at 1); by parts, the matrix plus its transpose is the outer product of the end values.
HERMITE = np.array([[-30, 30, 6, -6], [-30, 30, -6, 6], [-6, 6, 0, -1], [6, -6, 1, 0]]) / 60.0


def work_along(
    openings: tuple[float, float], loads: tuple[float, float], slopes: tuple[float, float], rates: tuple[float, float]
) -> float:
    """Integral of the load over the opening, both taken as cubics in the prescribed quantity s.

    Where the path turns back, the load is not a function of the opening, but still a function of s.

    Parameters
    ----------
    openings, loads, slopes : opening, load and d load / d opening at both ends.
    rates : d opening / ds at both ends; s goes from 0 to 1 over the step.
    """
    opening_slopes = np.array(rates)
    load_slopes = opening_slopes * slopes
    return float(np.concatenate([loads, load_slopes]) @ HERMITE @ np.concatenate([openings, opening_slopes]))


def chord(openings: tuple[float, float], loads: tuple[float, float]) -> tuple[tuple[float, float], tuple[float, float]]:
    """Slopes and rates for `work_along` of a straight step, where those of the path are not known."""
    way = openings[1] - openings[0]
    return ((loads[1] - loads[0]) / way,) * 2, (way, way)
