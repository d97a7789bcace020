"""The tables of a scene about its solution: load, effects, pose, and the mesh of each method."""

from __future__ import annotations

from typing import Annotated, Literal, TypeAlias

from pydantic import BeforeValidator, Field, ValidationInfo, field_validator

from verify.scene.tables import Auto, Section, as_list, as_two, refuse

#: Elements of splines through an arm at most.
MOST_THROUGH = 8

Switch: TypeAlias = bool | Auto
InAZone: TypeAlias = Annotated[float, Field(ge=0.1, le=200)] | Auto
Points: TypeAlias = Annotated[int, Field(ge=1, le=12)] | Auto


class Load(Section):
    opening: Annotated[tuple[float, ...], BeforeValidator(as_list), Field(min_length=1)]
    """End of the displacement programme [length]; a list unloads and reloads, like [1.5, 0.2, 3.0]; below 0 the loaded
    faces are pressed together."""

    at: Literal["face", "node", "hinge"] = "face"
    """Where load and opening are: even over the end face and its mean, its corner away from the bond, or its middle."""

    @field_validator("opening")
    @classmethod
    def _every_leg_goes_somewhere(cls, opening: tuple[float, ...]) -> tuple[float, ...]:
        legs = enumerate(zip((0.0, *opening[:-1]), opening, strict=True))
        still = [((i,), after) for i, (before, after) in legs if before == after]
        if still:
            raise refuse("different from the opening before it (the first one: from 0)", *still)
        return opening


class Effects(Section):
    """Only what is asked for is simulated."""

    kinematics: Literal["linear", "finite", "auto"] = "finite"
    """Large or small displacements."""
    contact: Switch = True
    """Whether the bodies push each other away on closing."""
    irreversible: Switch = True
    """Whether damage stays on unloading."""
    symmetry: Switch = False
    """Whether one arm is modelled for both, where they are alike."""
    search: Switch = True
    """Whether points look for the place on the other face that they are opposite to now, or keep the first one and the
    normal there, which two arms that are alike allow; linear kinematics always keeps them."""
    shear: Switch = "auto"
    """Whether the bond slides as well, by its shear_strength and shear_toughness; without them, and between two equal
    arms that are pulled apart, it does not."""


class Pose(Section):
    """Where the specimen is solved: reflected (X to -X), then rotated, then moved, with its supports and its load.

    Only the ``iga`` methods are told: no answer depends on it, and that is what it is there to show.
    """

    angle: float = Field(default=0.0, ge=-360, le=360)
    """Rotation, counter-clockwise [degrees]."""
    mirror: bool = False
    """Whether X is reflected first."""
    shift: Annotated[tuple[float, float], BeforeValidator(as_two)] = (0.0, 0.0)
    """Movement along X and Y [length]."""


class Discretization(Section):
    """How accurately the scene is solved, and how finely the ``iga`` methods resolve it for that."""

    accuracy: float = Field(default=0.003, ge=1e-4, le=0.1)
    """Error of the load curve to aim at, relative; meshes and steps that are "auto" follow from it."""
    degree: int = Field(default=3, ge=1, le=5)
    """Degree of the basis; 3 for tspline."""
    dofs: Annotated[int, Field(ge=40, le=1_000_000)] | Auto = "auto"
    """Unknowns to aim at, 40 to 1000000; "auto": as many as `in_a_zone` asks for."""
    in_a_zone: InAZone = "auto"
    """For dofs "auto": elements in a process zone; "auto": from the accuracy."""
    layers: Annotated[int, Field(ge=1, le=MOST_THROUGH)] | Auto = "auto"
    """Elements through each of two arms, 1 to 8, for nurbs and lagrange; T-meshes are graded there. "auto": 1, or 2
    where rollers or pressed faces need them and ``dofs`` is "auto"."""
    elements_width: Annotated[int, Field(ge=1, le=200)] | Auto = "auto"
    """For specimen.plane "solid": elements over half of the width, 1 to 200, shorter towards the edge; "auto": from the
    geometry."""
    interface_rule: Literal["gauss", "lobatto", "lumped"] = "gauss"
    """How the interface is integrated."""
    interface_points: Points = "auto"
    """Points in each interface element, 1 to 12; "auto": 2 for given dofs, else one more than the degree."""
    mismatch: float = Field(default=1.0, ge=0.05, le=20)
    """Element length of the lower body over that of the upper one."""
    adaptive: bool = False
    """For tspline: elements follow the process zone, and dofs is the most at any time."""
    slave: Literal["upper", "lower"] = "upper"
    """The body whose points carry the interface."""
    steps: Annotated[int, Field(ge=1, le=100_000)] | Auto = "auto"
    """Equal opening increments; "auto": chosen by accuracy where the mesh resolves the process zone, 150 elsewhere."""
    bend: Annotated[float, Field(ge=1e-5, le=0.2)] | Auto = "auto"
    """For steps "auto": how far off its tangent the load may be, as a part of the peak load; "auto": from the
    accuracy."""

    @field_validator("interface_points")
    @classmethod
    def _lobatto_has_both_ends(cls, points: int | str, info: ValidationInfo) -> int | str:
        if points == 1 and info.data.get("interface_rule") == "lobatto":
            raise refuse("an integer from 2 to 12 for the lobatto rule", ((), points))
        return points


class Dolfinx(Section):
    """How finely the DOLFINx model resolves the scene."""

    degree: Annotated[int, Field(ge=1, le=4)] | Auto = "auto"
    """Degree of the Lagrange elements, 1 to 4; "auto": 2, or 3 where one quadratic layer is too coarse."""
    elements: Annotated[int, Field(ge=2, le=100_000)] | Auto = "auto"
    """Elements along the specimen, all of one length, 2 to 100000; "auto": as many as `in_a_zone` asks for where the
    crack runs, and longer ones elsewhere."""
    in_a_zone: InAZone = "auto"
    """For elements "auto": elements in a process zone; "auto": from ``discretization.accuracy``."""
    layers: Annotated[int, Field(ge=1, le=100)] | Auto = "auto"
    """Elements through each arm, or through the strip, 1 to 100; "auto": as many as the geometry asks for."""
    interface_points: Points = "auto"
    """Gauss points on each element of the bond, 1 to 12; "auto": three more than the degree."""


class Beam(Section):
    """How finely the beam resolves the thickness of its arms."""

    order: int = Field(default=1, ge=1, le=9)
    """Of the displacements through the thickness: 1 is a beam of Timoshenko and Reissner, 3 and more are plane arms."""
    in_a_zone: float = Field(default=5.0, ge=1, le=50)
    """Elements in a process zone."""
