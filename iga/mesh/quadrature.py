"""Quadrature rules on [0, 1], [0, 1]^2 and [0, 1]^3."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import numpy as np

#: Points (n,) and weights (n,) of a rule on [0, 1].
Rule = tuple[np.ndarray, np.ndarray]


@cache
def gauss(n: int) -> Rule:
    """Gauss-Legendre points and weights (n,), exact for degree 2n - 1."""
    xi, weights = np.polynomial.legendre.leggauss(n)  # on [-1, 1]
    x, w = 0.5 * (xi + 1.0), 0.5 * weights
    x.flags.writeable = w.flags.writeable = False  # cached: all callers share these arrays
    return x, w


def lobatto(n: int) -> Rule:
    """Gauss-Lobatto points and weights (n,), end points included, exact for degree 2n - 3.

    Inner points are the roots of P'_{n-1}; ``w = 2 / (n (n - 1) P_{n-1}(x)^2)`` on [-1, 1] (Abramowitz and Stegun
    1964, 25.4.32).

    Raises
    ------
    ValueError : n < 2.
    """
    if n < 2:
        raise ValueError(f"a Lobatto rule has at least 2 points, got {n}")
    P = np.polynomial.legendre.Legendre.basis(n - 1)
    x = np.concatenate([[-1.0], np.sort(P.deriv().roots().real), [1.0]])
    return 0.5 * (x + 1.0), 1.0 / (n * (n - 1) * P(x) ** 2)


#: Name in a scene -> rule of so many points.
QUADRATURE: dict[str, Callable[[int], Rule]] = {"gauss": gauss, "lobatto": lobatto}


def square(*rules: Rule) -> Rule:
    """Product of d rules: points (n, d) and weights (n,) on the unit square or cube, the first one running fastest."""
    points, weights = rules[0][0][:, None], rules[0][1]
    for x, w in rules[1:]:
        points = np.column_stack([np.tile(points, (len(x), 1)), np.repeat(x, len(points))])
        weights = np.repeat(w, len(weights)) * np.tile(weights, len(w))
    return points, weights
