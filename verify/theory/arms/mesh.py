"""Elements along both arms: polynomials of degree 4 on nodes of their own, and points on the interface."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.polynomial import Legendre

#: Degree of u, w and phi in an element. With 4 shear does not lock, and a cubic deflection is exact.
ARM_DEGREE = 4

#: Gauss points of the interface in an element; the ends of the element are points as well, without weight.
INTERFACE_POINTS = 6

#: Unknowns of a node: u, w, phi of the upper arm, then of the lower one.
UNKNOWNS = 6


def lobatto() -> np.ndarray:
    """Nodes on [0, 1]: the ends, and the extrema of the Legendre polynomial between."""
    inner = Legendre.basis(ARM_DEGREE).deriv().roots()
    return 0.5 * (1.0 + np.concatenate(([-1.0], np.sort(inner), [1.0])))


@dataclass(frozen=True)
class Points:
    """Points (q,) of an element on [0, 1]: places ``at``, weights, functions N and slopes dN (q, a)."""

    at: np.ndarray
    weight: np.ndarray
    N_qa: np.ndarray
    dN_qa: np.ndarray

    @staticmethod
    def of(at: np.ndarray, weight: np.ndarray) -> Points:
        n = ARM_DEGREE + 1
        inverse = np.linalg.inv(lobatto()[:, None] ** np.arange(n))
        powers = at[:, None] ** np.arange(n)
        slopes = np.arange(n) * at[:, None] ** np.maximum(np.arange(n) - 1, 0)
        return Points(at, weight, powers @ inverse, slopes @ inverse)

    @staticmethod
    def gauss(n: int, ends: bool = False) -> Points:
        """``n`` Gauss points; with the ``ends`` of the element, of zero weight."""
        at, weights = np.polynomial.legendre.leggauss(n)
        x, w = 0.5 * (1.0 + at), 0.5 * weights
        return Points.of(np.pad(x, 1, constant_values=(0.0, 1.0)), np.pad(w, 1)) if ends else Points.of(x, w)


@dataclass(frozen=True)
class Mesh:
    """Ends (E + 1,) of the elements; their nodes are numbered from left to right."""

    ends: np.ndarray

    @staticmethod
    def through(places: Iterable[float], size: float) -> Mesh:
        """Elements of at most ``size`` (length) with ends at all ``places``, of which the outermost are its ends."""
        sorted_places = np.unique(np.asarray(tuple(places), dtype=float))
        far = np.diff(sorted_places, prepend=-np.inf) > 1e-9 * (sorted_places[-1] - sorted_places[0])
        corners = sorted_places[far]
        counts = np.ceil(np.diff(corners) / size * (1.0 - 1e-9)).astype(int)
        pieces = [np.linspace(a, b, n + 1)[:-1] for a, b, n in zip(corners[:-1], corners[1:], counts, strict=True)]
        return Mesh(np.append(np.concatenate(pieces), corners[-1]))

    @property
    def sizes(self) -> np.ndarray:
        return np.diff(self.ends)

    @property
    def count(self) -> int:
        """Number of unknowns."""
        return UNKNOWNS * (ARM_DEGREE * len(self.sizes) + 1)

    @property
    def dofs_el(self) -> np.ndarray:
        """Unknowns (E, 30) of every element, those of a node side by side."""
        first = UNKNOWNS * ARM_DEGREE * np.arange(len(self.sizes))
        return first[:, None] + np.arange(UNKNOWNS * (ARM_DEGREE + 1))

    def within(self, x: np.ndarray) -> np.ndarray:
        """Unknowns (E, 30) of every element, with displacements less those of its first node."""
        x_eai = x[self.dofs_el].reshape(len(self.sizes), -1, UNKNOWNS)
        turns = np.arange(UNKNOWNS) % 3 == 2
        return (x_eai - np.where(turns, 0.0, x_eai[:, :1])).reshape(len(self.sizes), -1)

    def places(self, points: Points) -> np.ndarray:
        """X (E, q) of points of every element."""
        return self.ends[:-1, None] + self.sizes[:, None] * points.at

    def mean(self, extent: tuple[float, float], component: int) -> np.ndarray:
        """The mean of a component over a range of X, or its value at a place, as a vector (n,) of the unknowns."""
        low, high = extent
        row, points = np.zeros(self.count), Points.gauss(ARM_DEGREE)
        if high - low < 1e-9 * (self.ends[-1] - self.ends[0]):
            row[UNKNOWNS * ARM_DEGREE * int(np.argmin(np.abs(self.ends - low))) + component] = 1.0
            return row
        middle = 0.5 * (self.ends[:-1] + self.ends[1:])
        inside = np.flatnonzero((middle > low) & (middle < high))
        parts = np.einsum("e,q,qa->ea", self.sizes[inside], points.weight, points.N_qa) / (high - low)
        np.add.at(row, self.dofs_el[inside][:, component::UNKNOWNS], parts)
        return row

    def mean_slope(self, extent: tuple[float, float], component: int) -> np.ndarray:
        """The mean of the slope of a component over a range of X, as a vector (n,) of the unknowns.

        At a place it is the mean of the slopes on both sides, with that of the section, phi, beyond an end.
        """
        low, high = extent
        row, step = np.zeros(self.count), UNKNOWNS * ARM_DEGREE
        nodes = [step * int(np.argmin(np.abs(self.ends - x))) + component for x in extent]
        if nodes[0] != nodes[1]:
            row[nodes] = np.array([-1.0, 1.0]) / (high - low)
            return row
        i = nodes[0] // step
        for element, end in ((i - 1, 1.0), (i, 0.0)):
            if 0 <= element < len(self.sizes):
                slope = Points.of(np.array([end]), np.ones(1)).dN_qa[0] / self.sizes[element]
                row[self.dofs_el[element][component::UNKNOWNS]] += 0.5 * slope
            else:
                row[nodes[0] + 1] += 0.5
        return row
