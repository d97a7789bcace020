"""Two bodies that meet on Y = 0, their supports and loads: all that the model knows of a specimen."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

UPPER, LOWER = 0, 1

#: A point, a straight line along an axis or a part of a plane across one: its ranges in X and Y and, in a solid, in Z,
#: without which it is the whole width.
Region = tuple[tuple[float, float], ...]


@dataclass(frozen=True)
class Body:
    """A rectangle 0 <= X <= length of one material.

    ``Y`` (layers + 1,) are the element boundaries through it, rising; one of its ends is the interface at 0.
    ``D_IJ`` is its stiffness, see `fem_reference.problem.material`.
    """

    length: float
    Y: np.ndarray
    D_IJ: np.ndarray

    @property
    def thickness(self) -> float:
        return float(self.Y[-1] - self.Y[0])


@dataclass(frozen=True)
class Face:
    """An end face of a body, at X.

    ``load`` is its part of the load, upwards, as a uniform dead traction; ``energy`` the sign with which its strain
    energy enters the J-integral.
    """

    body: int
    X: float
    load: float
    energy: float


@dataclass(frozen=True)
class Held:
    """A point or a side of a body, or all of it, where these displacement components (0: x, 1: y, 2: z) are zero."""

    body: int
    place: Region
    components: tuple[int, ...]


@dataclass(frozen=True)
class Hook:
    """A corner of a body to which the tie, a spring along X, is fixed.

    The elongation of the tie times the square root of its stiffness is the sum of ``factor`` times u_x over its hooks.
    """

    body: int
    place: Region
    factor: float


@dataclass(frozen=True)
class Patch:
    """A part of the outline of a body."""

    body: int
    place: Region


@dataclass(frozen=True)
class Action:
    """A load or a support on patches: the traction (turn (middle - Y), push) of a unit force or moment.

    Its work is the mean upward displacement of the patches, or the mean anticlockwise rotation of an end face.
    ``factor`` is the part of the load, or the stiffness of the support [force per length, or times length].
    """

    patches: tuple[Patch, ...]
    push: float
    turn: float
    middle: float
    factor: float


@dataclass(frozen=True, eq=False)
class Cells:
    """Straight-sided elements of one kind that fill both bodies, which share their nodes on the interface.

    ``X_nI`` (n, 2) nodes; ``conn_ea`` (n_e, 3 or 4) corners of triangles or quadrilaterals, counter-clockwise.
    """

    X_nI: np.ndarray
    conn_ea: np.ndarray

    @property
    def X(self) -> np.ndarray:
        """Element boundaries along the interface, rising."""
        return np.unique(self.X_nI[self.X_nI[:, 1] == 0.0, 0])


@dataclass(frozen=True)
class Specimen:
    """A specimen in its own frame.

    Parameters
    ----------
    bodies : upper (Y > 0) and lower (Y < 0), or the upper one alone, of which the lower one is the mirror image.
    X : element boundaries along the specimen, rising; a body has those up to its length.
    bond : ends in X of the bond, the one nearer to the load first.
    facing : ends in X of the surfaces opposite each other, bonded or not, in the same order.
    touching : whether these surfaces can carry contact beyond the bond.
    loads : part of the load, upwards, on the end faces of the upper and the lower body at the loaded end.
    loaded_at : X of the loaded faces: 0 or the length of the upper body; X from which a crack is measured.
    pulls, rests : loads on patches, and supports on patches.
    keeps : springs that hold the rigid motions which nothing else resists.
    cells : elements, in place of those between the lines ``X`` and ``Y``.
    Z : of a solid, element boundaries from the middle of the width, a plane of symmetry, to its edge.
    """

    bodies: tuple[Body, ...]
    X: np.ndarray
    bond: tuple[float, float]
    facing: tuple[float, float]
    touching: bool
    loads: tuple[float, float]
    held: tuple[Held, ...]
    hooks: tuple[Hook, ...]
    loaded_at: float
    pulls: tuple[Action, ...] = ()
    rests: tuple[Action, ...] = ()
    keeps: tuple[Action, ...] = ()
    cells: Cells | None = None
    Z: np.ndarray | None = None

    @property
    def dim(self) -> int:
        """Number of directions."""
        return 2 if self.Z is None else 3

    @property
    def depth(self) -> float:
        """Extent of the mesh across the width; 1 in the plane."""
        return 1.0 if self.Z is None else float(self.Z[-1])

    @property
    def copies(self) -> float:
        """How many of a body there are: 2 of one that has a mirror image."""
        return 2.0 / len(self.bodies)

    @property
    def actions(self) -> tuple[Action, ...]:
        """Loads, supports and springs on patches."""
        return (*self.pulls, *self.rests, *self.keeps)

    @property
    def faces(self) -> tuple[Face, ...]:
        """The end faces of both bodies, upper first: those at the loaded end, then those at the other end."""
        loaded = [0.0 if self.direction > 0.0 else body.length for body in self.bodies]
        other = [body.length - X for body, X in zip(self.bodies, loaded, strict=True)]
        return (
            *(Face(body, X, self.loads[body], energy=1.0) for body, X in enumerate(loaded)),
            *(Face(body, X, load=0.0, energy=-1.0) for body, X in enumerate(other)),
        )

    @property
    def direction(self) -> float:
        """1 if the crack grows along X, -1 against it."""
        return 1.0 if self.bond[0] <= self.bond[1] else -1.0

    @property
    def near(self) -> float:
        """Distance below which two places are the same, 1e-6 of the smallest element."""
        across = () if self.Z is None else (self.Z,)
        every = (self.X, *(body.Y for body in self.bodies), *across)
        return 1e-6 * min(float(np.min(np.diff(lines))) for lines in every)

    @property
    def interface(self) -> tuple[float, float]:
        """Ends in X of the surfaces that carry tractions: the bond, or all surfaces that can touch."""
        return self.facing if self.touching else self.bond

    @property
    def bond_elements(self) -> np.ndarray:
        """Lengths of the elements on the bond."""
        return self.elements_within(self.bond)

    def elements_within(self, extent: tuple[float, float]) -> np.ndarray:
        """Lengths of the elements whose ends are in a range of X."""
        X, (low, high) = self.X, sorted(extent)
        return np.diff(X[(X > low - self.near) & (X < high + self.near)])

    def distance(self, X: np.ndarray | float) -> np.ndarray | float:
        """Distance of X from the loaded end, in the direction of growth."""
        return self.direction * (X - self.loaded_at)


def point(X: float, Y: float) -> Region:
    """A single point as a place."""
    return (X, X), (Y, Y)


#: Growth of elements with their distance from those on the way of a crack.
GRADED_GROWTH = 0.25


def graded_by_way_of(corners: tuple[float, ...], size: float, fine: tuple[float, float], most: float) -> np.ndarray:
    """Element boundaries from 0 to the last corner, with one at each corner: elements of a size on a range of X, which
    grow to ``most`` beyond it."""
    ends = np.array(sorted({0.0, *corners}))
    parts = [_graded(low, high, size, fine, most) for low, high in zip(ends[:-1], ends[1:], strict=True)]
    return np.concatenate([*(part[:-1] for part in parts), ends[-1:]])


def _graded(low: float, high: float, size: float, fine: tuple[float, float], most: float) -> np.ndarray:
    """Element boundaries from ``low`` to ``high``: equal parts of the integral of one over the size."""
    x = np.linspace(low, high, 1001)
    away = np.maximum(np.maximum(fine[0] - x, x - fine[1]), 0.0)
    dense = 1.0 / np.minimum(size + GRADED_GROWTH * away, max(size, most))
    number = np.concatenate(([0.0], np.cumsum(0.5 * (dense[1:] + dense[:-1]) * np.diff(x))))
    n = max(1, int(np.ceil(number[-1] - 1e-6)))
    X = np.interp(np.linspace(0.0, number[-1], n + 1), number, x)
    X[[0, -1]] = low, high
    return X


def lines_by_way_of(corners: tuple[float, ...], elements: int) -> np.ndarray:
    """Element boundaries (elements + 1,) from 0 to the last corner, with one at each corner and even spacing between.

    Raises
    ------
    ValueError : fewer elements than parts between corners.
    """
    ends = np.array(sorted({0.0, *corners}))
    parts = ends.size - 1
    if elements < parts:
        raise ValueError(f"elements: must be >= {parts}, one on each part of the specimen, got {elements}")
    counts_before = [0]
    for k in range(1, parts):
        even = round(elements * ends[k] / ends[-1])
        counts_before.append(min(max(even, counts_before[-1] + 1), elements - parts + k))
    numbers = np.diff([*counts_before, elements])
    lines = [np.linspace(a, b, n + 1)[:-1] for a, b, n in zip(ends[:-1], ends[1:], numbers, strict=True)]
    return np.concatenate([*lines, ends[-1:]])


def finer_at_first(X: np.ndarray, most: float) -> np.ndarray:
    """Element boundaries with the first element halved repeatedly until it is no longer than ``most``."""
    halvings = max(0, int(np.ceil(np.log2((X[1] - X[0]) / most) - 1e-9)))
    return np.concatenate([X[:1], X[0] + (X[1] - X[0]) * 0.5 ** np.arange(halvings, 0, -1), X[1:]])
