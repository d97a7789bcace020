"""What every debonding problem states, whatever its specimen: interface, kinematics, programme, mesh, pose."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass

from iga.bases.names import find
from iga.interface.laws import LAWS, TractionLaw
from iga.mesh.extraction import Mesh
from iga.specimen.layout import Layout
from iga.specimen.pose import Pose


@dataclass(frozen=True, kw_only=True)
class Debonding(ABC):
    """Common part of a problem in plain numbers, any consistent units.

    ``opening`` is the programme of the displacement of where the load acts, ``load_at``: "face" (a uniform dead
    traction, the mean displacement), "node" (the corner of the loaded face away from the interface) or "hinge" (its
    middle). ``steps`` is the number of steps asked for over the whole programme; None lets the path choose them.
    ``dofs`` is the number of unknowns aimed at. ``law_name`` is one of `iga.interface.laws.LAWS`.
    ``meshes`` are those of the bodies, upper first, in the specimen's own frame; made by the solver where left out.

    ``mismatch`` is the element length along the interface of the lower body over that of the upper one; ``slave`` the
    body, "upper" or "lower", whose points are projected: in every configuration where ``search`` is set, else once, and
    gaps are measured along the normal there for good. Steps that the path chooses leave the tangent by ``bend`` of the
    peak load.

    ``symmetry`` models the upper one of two equal arms alone against its mirror image. ``adaptive`` T-splines of two
    equal arms follow the process zone and have at most ``dofs`` unknowns at any time.

    The specimen is reflected X -> -X where ``mirror`` is set, then turned by ``angle`` degrees counter-clockwise, then
    moved by ``shift``, with its supports and its load; what is read from it is in its own frame, wherever it lies.
    """

    strength: float
    toughness: float
    ductility: float
    penalty: float
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

    @property
    @abstractmethod
    def layout(self) -> Layout:
        """Bodies, bond, loads and clamps."""

    @property
    def law(self) -> TractionLaw:
        """The traction law. Raises ValueError where the name is unknown."""
        if self.law_name not in LAWS:
            raise ValueError(f"law_name: must be one of {', '.join(LAWS)}, got {self.law_name!r}")
        shape = LAWS[self.law_name]
        return shape(self.strength, self.toughness, self.ductility, self.penalty, self.contact, self.irreversible)

    @property
    def pose(self) -> Pose:
        return Pose(self.angle, self.mirror, self.shift)


def smooth(problem: Debonding) -> bool:
    """Whether the basis is more than continuous along the specimen; of a mesh that is given nothing is known."""
    return find(problem.basis).smooth and not problem.meshes


def presses(problem: Debonding) -> bool:
    """Whether faces beyond the bond can meet: the programme goes below zero.

    Unloading alone does not close them: along the secants of the damage they come together at no opening, all at once.
    """
    return problem.contact and min(problem.opening) < 0.0


def unloads(problem: Debonding) -> bool:
    """Whether the programme goes down anywhere."""
    return any(after < before for before, after in zip((0.0, *problem.opening), problem.opening, strict=False))
