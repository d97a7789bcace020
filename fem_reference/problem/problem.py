"""The part of a problem that all specimens share: interface, kinematics, load programme, fineness of the mesh."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass

import numpy as np

from fem_reference.problem.bond_law import BondLaw
from fem_reference.problem.specimen import (
    Body,
    Cells,
    Held,
    Region,
    Specimen,
    graded_by_way_of,
    lines_by_way_of,
    point,
)


@dataclass(frozen=True, kw_only=True)
class Debonding(ABC):
    """Common part of a problem in plain numbers, in any consistent set of units.

    Parameters
    ----------
    width, plane : width of the specimen [length]; "stress" or "strain", or "solid".
    n_Z, edge, width_held : of a solid, elements over half of the width; length of the last one, at the edge, over that
        of the first; whether nothing moves across the width.
    opening : the prescribed openings in turn, for instance ``(3.0,)`` or ``(1.5, 0.0, 3.0)``; it starts at zero.
    load_at : where the load acts and the opening is measured: "face" (uniform dead traction, mean displacement), "node"
        (the corner of the loaded face away from the interface) or "hinge" (the node in the middle of the loaded face).
    kinematics : "linear" or "finite".
    degree : Lagrange degree, 1 to 4.
    elements : elements along the longer body, as even as its parts allow.
    element, fine, longest : in place of their number the longest element on a range of X, and beyond it.
    layers : elements through the thickness of each loaded body.
    interface_points : Gauss points on each element of the bond; None: three more than the degree, since the law has
        kinks in elements.
    cells : a given mesh for two arms, in place of the one by ``elements`` and ``layers``.
    steps : equal opening increments over the whole programme; the ends of its branches are additional. None: the path
        chooses its steps by accuracy.
    bend : for steps by accuracy, how far the load may leave the tangent of a step, in parts of the peak.
    snapshot_openings : fields are kept at the first converged step that reaches each of these openings.

    Raises
    ------
    ValueError : a parameter outside its range, or a mesh without a node at the load; the message names the parameter.
    """

    width: float = 1.0
    plane: str = "stress"
    n_Z: int = 4
    edge: float = 0.25
    width_held: bool = False
    opening: tuple[float, ...] = (3.0,)
    load_at: str = "face"
    kinematics: str = "finite"
    degree: int = 2
    elements: int = 112
    element: float | None = None
    fine: tuple[float, float] = (0.0, 0.0)
    longest: float = np.inf
    layers: int = 1
    interface_points: int | None = None
    cells: Cells | None = None
    steps: int | None = 150
    bend: float = 0.005
    snapshot_openings: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        _one_of("plane", self.plane, ("stress", "strain", "solid"))
        _one_of("kinematics", self.kinematics, ("linear", "finite"))
        _one_of("load_at", self.load_at, ("face", "node", "hinge"))
        _one_of("degree", self.degree, (1, 2, 3, 4))
        self.require_positive("width", "bend", "layers", "n_Z", "edge")
        if self.solid and (self.load_at != "face" or self.cells):
            raise ValueError('plane: must be "stress" or "strain" for given cells or a load at one point, got "solid"')
        if self.solid and self.bond_points < 2:
            raise ValueError(f"interface_points: must be >= 2 in a solid, got {self.interface_points}")
        given = ("steps", "interface_points", "element")
        self.require_positive(*(name for name in given if getattr(self, name) is not None))
        if not np.any(self.opening):
            raise ValueError(f"opening: must have an opening other than 0, got {self.opening}")
        if self.load_at == "hinge" and self.degree * self.layers % 2:
            face = f"a face of {self.layers} element{'s' * (self.layers > 1)}"
            raise ValueError(f"degree: must be even for a load in the middle of {face}, got {self.degree}")

    @property
    @abstractmethod
    def law(self) -> BondLaw:
        """The traction law of the bond."""

    @abstractmethod
    def specimen(self) -> Specimen:
        """Bodies, mesh lines, bond, supports and loads."""

    def lines(self, corners: tuple[float, ...]) -> np.ndarray:
        """Element boundaries from 0 to the last of these places, with one at each.

        Raises
        ------
        ValueError : fewer elements than parts between corners.
        """
        if self.element is None:
            return lines_by_way_of(corners, self.elements)
        return graded_by_way_of(corners, self.element, self.fine, self.longest)

    @property
    def solid(self) -> bool:
        """Whether the specimen has a width of its own."""
        return self.plane == "solid"

    @property
    def Z(self) -> np.ndarray | None:
        """Element boundaries (n_Z + 1,) of a solid from the middle of its width to its edge."""
        if not self.solid:
            return None
        ends = np.concatenate([[0.0], np.cumsum(self.edge ** np.linspace(0.0, 1.0, self.n_Z))])
        return 0.5 * self.width * ends / ends[-1]

    def middle(self, X: float, Y: float) -> Region:
        """A point, of a solid in the middle of its width."""
        return point(X, Y) + ((0.0, 0.0),) * self.solid

    def held_across(self, bodies: tuple[Body, ...]) -> tuple[Held, ...]:
        """What holds the displacement across the width of a solid: the plane in its middle, or everything."""
        Z = () if self.width_held else ((0.0, 0.0),)
        places = (((0.0, body.length), (float(body.Y[0]), float(body.Y[-1])), *Z) for body in bodies)
        return tuple(Held(number, place, (2,)) for number, place in enumerate(places)) if self.solid else ()

    @property
    def bond_points(self) -> int:
        """Gauss points on each element of the bond."""
        return self.interface_points or self.degree + 3

    @property
    def way(self) -> float:
        """Length of the whole programme in the opening."""
        return float(np.sum(np.abs(np.diff([0.0, *self.opening]))))

    @property
    def presses(self) -> bool:
        """Whether the faces beyond the bond can touch: the programme goes below zero."""
        return self.law.contact and min(self.opening) < 0.0

    @property
    def unloads(self) -> bool:
        """Whether the opening decreases anywhere in the programme."""
        return any(after < before for before, after in zip((0.0, *self.opening), self.opening, strict=False))

    def require_positive(self, *names: str) -> None:
        """Raise ValueError if one of these parameters is not > 0."""
        for name in names:
            if not getattr(self, name) > 0:
                raise ValueError(f"{name}: must be > 0, got {getattr(self, name)}")


def _one_of(name: str, value: object, allowed: tuple) -> None:
    if value not in allowed:
        raise ValueError(f"{name}: must be one of {', '.join(map(str, allowed))}, got {value}")
