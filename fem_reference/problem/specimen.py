"""Two bodies that meet on Y = 0, with what holds and what loads them: all that the model knows of a specimen."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

UPPER, LOWER = 0, 1

#: Where something is: the ends in X and the ends in Y of a point or of a straight side along an axis.
Place = tuple[tuple[float, float], tuple[float, float]]


@dataclass(frozen=True)
class Body:
    """A rectangle 0 <= X <= length of one material.

    ``Y`` (layers + 1,) are the element boundaries through it, rising; one of its ends is the interface at 0.
    ``D_IJ`` (3, 3) is its in-plane stiffness.
    """

    length: float
    Y: np.ndarray
    D_IJ: np.ndarray

    @property
    def thickness(self) -> float:
        return float(self.Y[-1] - self.Y[0])


@dataclass(frozen=True)
class Face:
    """An end face at X of a body; ``load``: part of the load that it carries upwards, as a uniform dead traction.

    ``energy``: the sign with which its strain energy enters the J-integral.
    """

    body: int
    X: float
    load: float
    energy: float


@dataclass(frozen=True)
class Held:
    """A point or a side of a body whose displacements in these components are zero."""

    body: int
    place: Place
    components: tuple[int, ...]


@dataclass(frozen=True)
class Hook:
    """A corner of a body that the tie holds lengthwise.

    The tie is a spring whose elongation, times the root of its stiffness, is the sum of ``factor`` times u_x over its
    hooks.
    """

    body: int
    X_I: tuple[float, float]
    factor: float


@dataclass(frozen=True)
class Specimen:
    """A specimen in its own frame.

    Parameters
    ----------
    bodies : upper (Y > 0) and lower (Y < 0).
    X : element boundaries along the specimen, rising; those of a body are the ones up to its length.
    bond : ends in X of the bond, the one nearer to the load first.
    facing : ends in X of the faces that are opposite to each other, in the same order: the bond and what is beyond it.
    touching : whether these faces carry contact beyond the bond.
    faces : all end faces that carry load or count in the J-integral, one of each body at least.
    loaded_at : X of the loaded faces.
    """

    bodies: tuple[Body, Body]
    X: np.ndarray
    bond: tuple[float, float]
    facing: tuple[float, float]
    touching: bool
    faces: tuple[Face, ...]
    held: tuple[Held, ...]
    hooks: tuple[Hook, ...]
    loaded_at: float

    @property
    def near(self) -> float:
        """A distance within which two places are one."""
        return 1e-6 * min(float(np.min(np.diff(lines))) for lines in (self.X, *(body.Y for body in self.bodies)))

    @property
    def interface(self) -> tuple[float, float]:
        """Ends in X of what carries tractions: the bond, or all that can touch."""
        return self.facing if self.touching else self.bond

    @property
    def bond_elements(self) -> np.ndarray:
        """Lengths of the elements on the bond."""
        X, (low, high) = self.X, sorted(self.bond)
        return np.diff(X[(X > low - self.near) & (X < high + self.near)])

    def distance(self, X: np.ndarray | float) -> np.ndarray | float:
        """From the loaded end."""
        return np.abs(X - self.loaded_at)


def point(X: float, Y: float) -> Place:
    return (X, X), (Y, Y)


def lines_by_way_of(corners: tuple[float, ...], elements: int) -> np.ndarray:
    """Element boundaries (elements + 1,) from 0 to the last of the corners: one at each, evenly spaced between them.

    Raises
    ------
    ValueError : there are fewer elements than ways between corners.
    """
    ends = np.array(sorted({0.0, *corners}))
    ways = ends.size - 1
    if elements < ways:
        raise ValueError(f"elements: must be >= {ways}, one on each part of the specimen, got {elements}")
    counts_before = [0]
    for k in range(1, ways):
        even = round(elements * ends[k] / ends[-1])
        counts_before.append(min(max(even, counts_before[-1] + 1), elements - ways + k))
    numbers = np.diff([*counts_before, elements])
    parts = [np.linspace(a, b, n + 1)[:-1] for a, b, n in zip(ends[:-1], ends[1:], numbers, strict=True)]
    return np.concatenate([*parts, ends[-1:]])


def finer_at_first(X: np.ndarray, most: float) -> np.ndarray:
    """Element boundaries with the first element halved, again and again, until it is no longer than ``most``."""
    halvings = max(0, int(np.ceil(np.log2((X[1] - X[0]) / most) - 1e-9)))
    return np.concatenate([X[:1], X[0] + (X[1] - X[0]) * 0.5 ** np.arange(halvings, 0, -1), X[1:]])
