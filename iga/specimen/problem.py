"""What every debonding problem states, whatever its specimen: interface, kinematics, programme, mesh, pose."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass

import numpy as np

from iga.elements.elasticity import orthotropic
from iga.elements.kinematics import KINEMATICS
from iga.interface.laws import LAWS, TractionLaw
from iga.mesh.extraction import Mesh
from iga.mesh.quadrature import QUADRATURE
from iga.specimen.grading import BASES
from iga.specimen.pose import Pose

#: Stiffness of the contact over that of the intact bond, where a problem does not state its penalty.
CONTACT = 100.0

#: Keys that have names as values, and these names.
CHOICES: dict[str, Collection[str]] = {
    "law_name": LAWS,
    "load_at": ("face", "node", "hinge"),
    "plane": ("stress", "strain"),
    "kinematics": KINEMATICS,
    "basis": BASES,
    "slave": ("upper", "lower"),
    "interface_rule": (*QUADRATURE, "lumped"),
}


def require(record: object, key: str, holds: bool, rule: str) -> None:
    """Raise ValueError with key, rule and value where a field of a record breaks a rule."""
    if not holds:
        raise ValueError(f"{key}: must be {rule}, got {getattr(record, key)!r}")


def require_positive(record: object, *keys: str) -> None:
    """Raise ValueError where one of these fields is given and is not positive and finite."""
    for key in keys:
        value = getattr(record, key)
        require(record, key, value is None or 0.0 < value < np.inf, "> 0 and finite")


@dataclass(frozen=True, kw_only=True)
class Moduli:
    """Elastic constants, axis 1 along the specimen; isotropic where ``E2`` and ``G12`` are left out.

    Raises
    ------
    ValueError : a modulus that is not positive.
    """

    E1: float
    nu12: float
    E2: float | None = None
    G12: float | None = None

    def __post_init__(self) -> None:
        require_positive(self, "E1", "E2", "G12")

    def elasticity(self, plane: str) -> np.ndarray:
        """Elasticity matrix (3, 3), see `iga.elements.elasticity.orthotropic`."""
        E2 = self.E1 if self.E2 is None else self.E2
        G12 = self.E1 / (2.0 * (1.0 + self.nu12)) if self.G12 is None else self.G12
        return orthotropic(self.E1, E2, G12, self.nu12, plane)


@dataclass(frozen=True, kw_only=True)
class Debonding:
    """Common part of a problem in plain numbers, any consistent units.

    ``opening`` is the programme of the displacement of where the load acts, such as (3.0,) or (1.5, 0.2, 3.0); one
    number is a programme of one leg. ``load_at`` says where: "face" (a uniform dead traction, the mean displacement),
    "node" (the corner of the loaded face away from the interface) or "hinge" (its middle). ``steps`` is the number of
    steps asked for over the whole programme; None lets the path choose them. ``dofs`` is the number of unknowns aimed
    at. ``law_name`` is one of `iga.interface.laws.LAWS`, ``ductility`` the gap at separation over the gap at the
    strength, ``penalty`` the stiffness of the contact, `CONTACT` times that of the bond where left out.
    ``meshes`` are those of the bodies, upper first, in the specimen's own frame; made by the solver where left out.

    ``mismatch`` is the element length along the interface of the lower body over that of the upper one; ``slave`` the
    body, "upper" or "lower", whose points are projected: in every configuration where ``search`` is set, else once, and
    gaps are measured along the normal there for good. Steps that the path chooses leave the tangent by ``bend`` of the
    peak load. The specimen is reflected X -> -X where ``mirror`` is set,
    then turned by ``angle`` degrees counter-clockwise, then moved by ``shift``, with its supports and its load; what is
    read from it is in its own frame, wherever it lies.

    Raises
    ------
    ValueError : a value out of its range; the message has key, range and value.
    """

    strength: float
    toughness: float
    ductility: float = 12.5
    penalty: float | None = None
    law_name: str = "bilinear"
    opening: tuple[float, ...]
    load_at: str = "face"
    width: float = 1.0
    plane: str = "stress"
    contact: bool = True
    irreversible: bool = True
    kinematics: str = "finite"
    basis: str = "nurbs"
    degree: int = 3
    dofs: int = 1956
    meshes: tuple[Mesh, ...] = ()
    mismatch: float = 1.0
    slave: str = "upper"
    search: bool = True
    interface_rule: str = "gauss"
    interface_points: int = 2
    steps: int | None = 150
    bend: float = 0.005
    snapshot_openings: tuple[float, ...] = ()
    angle: float = 0.0
    mirror: bool = False
    shift: tuple[float, float] = (0.0, 0.0)

    def __post_init__(self) -> None:
        object.__setattr__(self, "opening", tuple(np.ravel(self.opening).astype(float).tolist()))
        for key, names in CHOICES.items():
            require(self, key, getattr(self, key) in names, f"one of {', '.join(names)}")
        require_positive(self, "strength", "toughness", "penalty", "width", "mismatch", "bend")
        require(self, "ductility", 1.0 < self.ductility < np.inf, "> 1 and finite")
        require(self, "degree", self.degree >= 1, ">= 1")
        require(self, "interface_points", self.interface_points >= 1, ">= 1")
        require(self, "steps", self.steps is None or self.steps >= 1, ">= 1, or None")
        moves = len(self.opening) > 0 and all(0.0 < abs(after - before) < np.inf for before, after in self.legs)
        require(self, "opening", moves, "finite, and different from the opening before it (the first one: from 0)")

    @property
    def legs(self) -> tuple[tuple[float, float], ...]:
        """First and last opening of every leg of the programme."""
        return tuple(zip((0.0, *self.opening), self.opening, strict=False))

    @property
    def law(self) -> TractionLaw:
        """The traction law."""
        shape, stiffness = LAWS[self.law_name], 0.5 * self.strength**2 * self.ductility / self.toughness
        penalty = CONTACT * stiffness if self.penalty is None else self.penalty
        return shape(self.strength, self.toughness, self.ductility, penalty, self.contact, self.irreversible)

    @property
    def pose(self) -> Pose:
        return Pose(self.angle, self.mirror, self.shift)


def smooth(problem: Debonding) -> bool:
    """Whether the basis is more than continuous along the specimen; of a mesh that is given nothing is known."""
    return problem.basis != "lagrange" and not problem.meshes


def presses(problem: Debonding) -> bool:
    """Whether faces beyond the bond can meet: the programme goes below zero.

    Unloading alone does not close them: along the secants of the damage they come together at no opening, all at once.
    """
    return problem.contact and min(problem.opening) < 0.0


def unloads(problem: Debonding) -> bool:
    """Whether the programme goes down anywhere."""
    return any(after < before for before, after in problem.legs)
