"""B-splines: knot vectors and their Bezier extraction in one direction."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class KnotVector:
    """An open knot vector of one degree.

    ``knots`` (n + p + 1,) is non-decreasing with end multiplicity p + 1 and inner multiplicity at most p.

    Raises
    ------
    ValueError : knots that violate this or are not finite, or a degree below 1.
    """

    degree: int
    knots: np.ndarray

    def __post_init__(self) -> None:
        knots = np.asarray(self.knots, dtype=float)
        p = self.degree
        if p < 1 or knots.size < 2 * (p + 1) or np.any(np.diff(knots) < 0) or not np.all(np.isfinite(knots)):
            raise ValueError(f"a knot vector of degree {p} needs at least {2 * (p + 1)} finite, non-decreasing knots")
        multiplicity = np.unique(knots, return_counts=True)[1]
        if multiplicity.size < 2 or multiplicity[0] != p + 1 or multiplicity[-1] != p + 1:
            raise ValueError(
                f"the end knots must have multiplicity {p + 1}, got {multiplicity[0]} and {multiplicity[-1]}"
            )
        if np.any(multiplicity[1:-1] > p):
            raise ValueError(f"inner knots may have multiplicity {p} at most, got {multiplicity[1:-1].max()}")
        object.__setattr__(self, "knots", knots)

    @property
    def functions(self) -> int:
        """Number of functions n."""
        return self.knots.size - self.degree - 1

    @property
    def spans(self) -> np.ndarray:
        """(n_e,) index of the first knot of each non-empty span."""
        return np.flatnonzero(np.diff(self.knots) > 0)

    @property
    def greville(self) -> np.ndarray:
        """(n,) Greville abscissae, the control values of the identity map."""
        return np.lib.stride_tricks.sliding_window_view(self.knots[1:-1], self.degree).mean(-1)


def open_knots(breaks: np.ndarray, degree: int) -> KnotVector:
    """Open knot vector with simple inner knots at ``breaks`` (n_e + 1,): C^{p-1} inside."""
    breaks = np.asarray(breaks, dtype=float)
    return KnotVector(degree, np.concatenate([np.repeat(breaks[0], degree), breaks, np.repeat(breaks[-1], degree)]))


def bezier_extraction(kv: KnotVector) -> np.ndarray:
    """Extraction operators of all spans: N_a = sum_b C_eab B_b on span e.

    The Bernstein coefficient b of a spline on [x0, x1] is its polar form at x0 (p - b times) and x1 (b times)
    (Ramshaw 1989). Inserting both knots up to multiplicity p gives the same (Borden, Scott, Evans, Hughes 2011).

    Returns
    -------
    C_eab : (n_e, p + 1, p + 1); function a of span e is number ``spans[e] - p + a``.
    """
    t, p, span_e = kv.knots, kv.degree, kv.spans
    x0_e, x1_e = t[span_e], t[span_e + 1]
    C_eab = np.empty((span_e.size, p + 1, p + 1))
    for b in range(p + 1):
        d_eja = np.broadcast_to(np.eye(p + 1), (span_e.size, p + 1, p + 1))  # control points = unit vectors
        for r in range(1, p + 1):
            x_e = (x1_e if r <= b else x0_e)[:, None, None]
            j = np.arange(r, p + 1)
            low = t[span_e[:, None] - p + j][..., None]
            high = t[span_e[:, None] + 1 + j - r][..., None]
            d_eja = ((high - x_e) * d_eja[:, :-1] + (x_e - low) * d_eja[:, 1:]) / (high - low)
        C_eab[:, :, b] = d_eja[:, 0]
    return C_eab
