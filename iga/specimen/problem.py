"""What every debonding problem states, whatever its specimen: interface, kinematics, programme, mesh, pose."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Collection
from dataclasses import dataclass

import numpy as np

from iga.bases.names import BASES, find
from iga.elements.kinematics import KINEMATICS
from iga.laws.law import Law
from iga.mesh.extraction import Mesh
from iga.mesh.quadrature import QUADRATURE
from iga.specimen.layout import Layout
from iga.specimen.pose import Pose
from iga.specimen.ranges import require, require_numbers, require_positive

#: Keys that are True or False.
ON_OR_OFF = ("search", "symmetry", "adaptive", "mirror")

#: Keys that have names as values, and these names.
CHOICES: dict[str, Collection[str]] = {
    "load_at": ("face", "node", "hinge"),
    "plane": ("stress", "strain", "solid"),
    "lateral": ("free", "held"),
    "kinematics": KINEMATICS,
    "basis": BASES,
    "slave": ("upper", "lower"),
    "interface_rule": (*QUADRATURE, "lumped"),
}


@dataclass(frozen=True, kw_only=True)
class Debonding(ABC):
    """Common part of a problem in plain numbers, any consistent units.

    ``opening`` is the programme of the displacement of where the load acts, such as (3.0,) or (1.5, 0.2, 3.0); one
    number is a programme of one leg. ``load_at`` says where: "face" (a uniform dead traction, the mean displacement),
    "node" (the corner of the loaded face away from the interface) or "hinge" (its middle). ``steps`` is the number of
    steps asked for over the whole programme; None lets the path choose them. ``dofs`` is the number of unknowns aimed
    at; with ``element`` elements on the crack path are no longer than that, whatever ``dofs``.
    ``meshes`` are those of the bodies, upper first, in the specimen's own frame; the solver makes them where they are
    left out.

    ``layers`` is the number of elements through each of two arms; T-splines, which are graded there, do not use it.
    ``mismatch`` is the element length along the interface of the lower body over that of the upper one; ``slave`` the
    body, "upper" or "lower", whose points are projected. With ``search`` they are projected in every configuration,
    else once, and gaps are always measured along the normal found then. On steps whose length the path chooses the load
    leaves the tangent by at most about ``bend`` of the peak load.

    ``symmetry`` models the upper one of two equal arms alone against its mirror image. ``adaptive`` T-splines of two
    equal arms follow the process zone and have at most ``dofs`` unknowns at any time.

    The ``plane`` "solid" is the prism over this width: half of it is modelled, with ``elements_width`` elements of the
    degree ``degree_width``, shorter towards the edge (see `iga.specimen.solid`). Its sides are free or, with the
    ``lateral`` displacement "held", nothing moves across the width.

    The specimen is reflected X -> -X where ``mirror`` is set, then turned by ``angle`` degrees counter-clockwise, then
    moved by ``shift``, with its supports and its load; what is read from it is in its own frame, wherever it lies.

    Raises
    ------
    ValueError : a value out of its range; the message has key, range and value.
    """

    opening: tuple[float, ...]
    load_at: str = "face"
    width: float = 1.0
    plane: str = "stress"
    lateral: str = "free"
    elements_width: int | None = None
    degree_width: int = 2
    kinematics: str = "finite"
    basis: str = "nurbs"
    degree: int = 3
    dofs: int = 1956
    element: float | None = None
    meshes: tuple[Mesh, ...] = ()
    layers: int = 1
    mismatch: float = 1.0
    slave: str = "upper"
    search: bool = True
    symmetry: bool = False
    adaptive: bool = False
    interface_rule: str = "gauss"
    interface_points: int = 2
    steps: int | None = 150
    bend: float = 0.005
    snapshot_openings: tuple[float, ...] = ()
    angle: float = 0.0
    mirror: bool = False
    shift: tuple[float, float] = (0.0, 0.0)

    def __post_init__(self) -> None:
        require_numbers(self)
        object.__setattr__(self, "opening", tuple(np.ravel(self.opening).astype(float).tolist()))
        for key, names in CHOICES.items():
            require(self, key, getattr(self, key) in names, f"one of {', '.join(names)}")
        for key in ON_OR_OFF:
            require(self, key, isinstance(getattr(self, key), bool | np.bool_), "True or False")
        require_positive(self, "width", "mismatch", "bend", "element")
        require(self, "degree", self.degree >= 1, ">= 1")
        require(self, "layers", self.layers >= 1, ">= 1")
        require(self, "elements_width", self.elements_width is None or self.elements_width >= 1, ">= 1, or None")
        require(self, "degree_width", self.degree_width >= 1, ">= 1")
        require(self, "load_at", self.load_at == "face" or not self.solid, '"face" for a solid')
        require(
            self, "interface_rule", self.interface_rule != "lumped" or not self.solid, "a rule of points for a solid"
        )
        require(self, "interface_points", self.interface_points >= 1, ">= 1")
        require(self, "steps", self.steps is None or self.steps >= 1, ">= 1, or None")
        moves = len(self.opening) > 0 and all(0.0 < abs(after - before) < np.inf for before, after in self.legs)
        require(self, "opening", moves, "finite, and different from the opening before it (the first one: from 0)")
        largest = max(0.0, *self.opening)
        reached = all(0.0 <= opening <= largest for opening in self.snapshot_openings)
        require(self, "snapshot_openings", reached, f">= 0 and <= {largest:g}, the largest opening")

    @property
    def legs(self) -> tuple[tuple[float, float], ...]:
        """First and last opening of every leg of the programme."""
        return tuple(zip((0.0, *self.opening), self.opening, strict=False))

    @property
    @abstractmethod
    def layout(self) -> Layout:
        """Bodies, bond, loads and clamps."""

    @property
    @abstractmethod
    def law(self) -> Law:
        """The traction law of the bond."""

    @property
    def pose(self) -> Pose:
        return Pose(self.angle, self.mirror, self.shift, 3 if self.solid else 2)

    @property
    def solid(self) -> bool:
        """Whether the specimen has three directions."""
        return self.plane == "solid"


def smooth(problem: Debonding) -> bool:
    """Whether the basis is known to be smoother than C0 along the specimen; not for given meshes."""
    return find(problem.basis).smooth and not problem.meshes


def presses(problem: Debonding) -> bool:
    """Whether the programme presses faces beyond the bond together, next to the load: its opening goes below zero.

    Unloading alone does not: along the secants of the damage all faces close at once, at opening zero.
    """
    return problem.law.contact and min(problem.opening) < 0.0


def touches(problem: Debonding) -> bool:
    """Whether faces beyond the bond can meet: where they are pressed, or the specimen is bent between supports."""
    return presses(problem) or (problem.law.contact and bool(problem.layout.supports))


def unloads(problem: Debonding) -> bool:
    """Whether the opening decreases anywhere in the programme."""
    return any(after < before for before, after in problem.legs)
