"""The scene file as a type: one physical problem, its load programme, the effects to simulate, the meshes.

Units are the user's own consistent set. Every bound here is physical or a limit of what is built; the sentences that a
user reads about a broken one are made in ``verify.scene.complaints``.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import Annotated, Any, Literal

from pydantic import (
    AfterValidator,
    BeforeValidator,
    Field,
    ValidationInfo,
    ValidatorFunctionWrapHandler,
    field_validator,
)
from pydantic_core import PydanticCustomError

from verify.scene.bond.interface import BOND_TO_CONTACT, Interface
from verify.scene.bond.shear import require_shear
from verify.scene.materials import Material, MaterialOrTwo, definite, elastic_constants
from verify.scene.specimens import Specimen
from verify.scene.stated.published import Published
from verify.scene.stated.uncertainty import Uncertainty, require_numbers
from verify.scene.tables import Section, as_two, refuse
from verify.support.programme import turns

#: Endings of files in output folders; a scene, whose folder has its name, must not end like them.
FILE_ENDINGS = (".csv", ".html", ".json", ".md")


def _as_programme(value: object) -> object:
    """One number is a programme of one leg."""
    return tuple(value) if isinstance(value, list | tuple) else (value,)


class Load(Section):
    opening: Annotated[tuple[float, ...], BeforeValidator(_as_programme), Field(min_length=1)]
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
    contact: bool | Literal["auto"] = True
    """Whether the bodies push each other away on closing."""
    irreversible: bool | Literal["auto"] = True
    """Whether damage stays on unloading."""
    symmetry: bool | Literal["auto"] = False
    """Whether one arm is modelled for both, where they are alike."""
    search: bool | Literal["auto"] = True
    """Whether points look for the place on the other face that they are opposite to now, or keep the first one and the
    normal there, which two arms that are alike allow; linear kinematics always keeps them."""

    shear: bool | Literal["auto"] = "auto"
    """Whether the bond slides as well, by its shear_strength and shear_toughness; without them, and between two equal
    arms that are pulled apart, it does not."""

    @field_validator("contact", "irreversible", "symmetry", "search", "shear", mode="before")
    @classmethod
    def _switched_or_chosen(cls, effect: object) -> object:
        if not isinstance(effect, bool) and effect != "auto":
            raise refuse('true, false or "auto"', ((), effect))
        return effect


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


#: Elements of DOLFINx along a specimen at most.
MOST_ALONG = 100_000
#: Elements of splines through an arm at most.
MOST_THROUGH = 8
#: Elements in a process zone that a scene may ask for, at least and at most.
IN_A_ZONE = (0.1, 200.0)


def _counted_or_chosen(most: Mapping[str, int], least: Mapping[str, int] = MappingProxyType({})) -> Any:
    """Validator of numbers that may be "auto": integers from 1, or from ``least``, to ``most``, by their keys."""

    def check(cls: type[Section], value: object, info: ValidationInfo) -> object:
        key = str(info.field_name)
        low, high = least.get(key, 1), most[key]
        counted = isinstance(value, int) and not isinstance(value, bool) and low <= value <= high
        if not counted and value != "auto":
            raise refuse(f'an integer >= {low} and <= {high}, or "auto"', ((), value))
        return value

    return field_validator(*most, mode="before")(check)


def _a_number_or_chosen(key: str, low: float, high: float) -> Any:
    """Validator of a number from ``low`` to ``high``, or "auto"."""

    def check(cls: type[Section], value: object) -> object:
        if value != "auto" and (isinstance(value, bool | str) or not _is_within(value, low, high)):
            raise refuse(f'>= {low:g} and <= {high:g}, or "auto"', ((), value))
        return value

    return field_validator(key, mode="before")(check)


def _is_within(value: object, low: float, high: float) -> bool:
    return isinstance(value, int | float) and low <= value <= high


class Discretization(Section):
    """How accurately the scene is solved, and how finely the ``iga`` methods resolve it for that."""

    accuracy: float = Field(default=0.003, ge=1e-4, le=0.1)
    """Error of the load curve to aim at, relative; meshes and steps that are "auto" follow from it."""
    degree: int = Field(default=3, ge=1, le=5)
    """Degree of the basis; 3 for tspline."""
    dofs: int | Literal["auto"] = "auto"
    """Unknowns to aim at, 40 to 1000000; "auto": as many as `in_a_zone` asks for."""
    in_a_zone: float | Literal["auto"] = "auto"
    """For dofs "auto": elements in a process zone; "auto": from the accuracy."""
    layers: int | Literal["auto"] = "auto"
    """Elements through each of two arms, 1 to 8, for nurbs and lagrange; T-meshes are graded there. "auto": 1, or 2
    where rollers or pressed faces need them and ``dofs`` is "auto"."""
    interface_rule: Literal["gauss", "lobatto", "lumped"] = "gauss"
    """How the interface is integrated."""
    interface_points: int | Literal["auto"] = "auto"
    """Points in each interface element, 1 to 12; "auto": 2 for given dofs, else one more than the degree."""
    mismatch: float = Field(default=1.0, ge=0.05, le=20)
    """Element length of the lower body over that of the upper one."""
    adaptive: bool = False
    """For tspline: elements follow the process zone, and dofs is the most at any time."""
    slave: Literal["upper", "lower"] = "upper"
    """The body whose points carry the interface."""
    steps: int | Literal["auto"] = "auto"
    """Equal opening increments; "auto": chosen by accuracy where the mesh resolves the process zone, 150 elsewhere."""
    bend: float | Literal["auto"] = "auto"
    """For steps "auto": how far off its tangent the load may be, as a part of the peak load; "auto": from the
    accuracy."""

    _counted = _counted_or_chosen({"dofs": 1_000_000, "layers": MOST_THROUGH, "interface_points": 12}, {"dofs": 40})
    _zone = _a_number_or_chosen("in_a_zone", *IN_A_ZONE)
    _bend = _a_number_or_chosen("bend", 1e-5, 0.2)

    @field_validator("interface_points")
    @classmethod
    def _lobatto_has_both_ends(cls, points: int | str, info: ValidationInfo) -> int | str:
        if info.data.get("interface_rule") == "lobatto" and isinstance(points, int) and points < 2:
            raise refuse("an integer from 2 to 12 for the lobatto rule", ((), points))
        return points

    @field_validator("steps", mode="before")
    @classmethod
    def _counted_or_chosen(cls, steps: object) -> object:
        counted = isinstance(steps, int) and not isinstance(steps, bool) and 1 <= steps <= 100_000
        if not counted and steps != "auto":
            raise refuse('an integer >= 1 and <= 100000, or "auto"', ((), steps))
        return steps


class Dolfinx(Section):
    """How finely the DOLFINx model resolves the scene."""

    degree: int | Literal["auto"] = "auto"
    """Degree of the Lagrange elements, 1 to 4; "auto": 2, or 3 where one quadratic layer is too coarse."""
    elements: int | Literal["auto"] = "auto"
    """Elements along the specimen, all of one length, 2 to 100000; "auto": as many as `in_a_zone` asks for where the
    crack runs, and longer ones elsewhere."""
    in_a_zone: float | Literal["auto"] = "auto"
    """For elements "auto": elements in a process zone; "auto": from ``discretization.accuracy``."""
    layers: int | Literal["auto"] = "auto"
    """Elements through each arm, or through the strip, 1 to 100; "auto": as many as the geometry asks for."""
    interface_points: int | Literal["auto"] = "auto"
    """Gauss points on each element of the bond, 1 to 12; "auto": three more than the degree."""

    _counted = _counted_or_chosen(
        {"degree": 4, "elements": MOST_ALONG, "layers": 100, "interface_points": 12}, {"elements": 2}
    )
    _zone = _a_number_or_chosen("in_a_zone", *IN_A_ZONE)


class Beam(Section):
    """How finely the beam resolves the thickness of its arms."""

    order: int = Field(default=1, ge=1, le=9)
    """Of the displacements through the thickness: 1 is a beam of Timoshenko and Reissner, 3 and more are plane arms."""
    in_a_zone: float = Field(default=5.0, ge=1, le=50)
    """Elements in a process zone."""


def _as_tables(value: object) -> object:
    if not isinstance(value, list | tuple):
        raise refuse("a list of tables, each under [[published]]", ((), value))
    return tuple(value)


def _as_folder(name: str) -> str:
    if name.lower().endswith(FILE_ENDINGS):
        raise refuse(f"a name that is not one of a file, ending in {', '.join(FILE_ENDINGS)}", ((), name))
    return name


class Scene(Section):
    """One physical problem. Every method solves the same one."""

    name: Annotated[str, AfterValidator(_as_folder)] = Field(
        default="scene", pattern=r"^[A-Za-z0-9][A-Za-z0-9._-]*$", max_length=80
    )
    """Names folders; left out: that of the file."""
    units: str = "consistent units"
    """Label of your own consistent set of units, which is only printed."""
    specimen: Specimen
    material: MaterialOrTwo | None = Field(default=None, validate_default=True)
    strip: Material | None = Field(default=None, validate_default=True)
    substrate: Material | None = Field(default=None, validate_default=True)
    interface: Interface
    load: Load
    pose: Pose = Pose()
    effects: Effects = Effects()
    discretization: Discretization = Discretization()
    dolfinx: Dolfinx = Dolfinx()
    beam: Beam = Beam()
    published: Annotated[tuple[Published, ...], BeforeValidator(_as_tables)] = ()
    uncertainty: Uncertainty = Uncertainty()

    @property
    def materials(self) -> tuple[Material, ...]:
        """Of the upper and the lower body."""
        upper, *lower = self.named_materials.values()
        return (upper, *lower) if lower else (upper, upper)

    @property
    def named_materials(self) -> Mapping[str, Material]:
        """Each by the path of its table, the one of the upper body first."""
        found: dict[str, Material] = {}
        for name in self.specimen.materials:
            value = getattr(self, name)
            found |= {f"{name}[{i}]": one for i, one in enumerate(value)} if isinstance(value, tuple) else {name: value}
        return found

    @field_validator("material", "strip", "substrate", mode="wrap")
    @classmethod
    def _of_this_specimen(cls, value: object, validate: ValidatorFunctionWrapHandler, info: ValidationInfo) -> object:
        """Each kind of specimen has its own materials; nothing is said while the specimen itself is broken."""
        specimen = info.data.get("specimen")
        if specimen is None:
            return validate(value) if value is not None else None
        wanted = specimen.materials
        if info.field_name in wanted:
            if value is None:
                raise PydanticCustomError("missing", "missing")
            return _definite(validate(value), specimen)
        if value is not None:
            raise refuse(f"left out: the materials of a {specimen.kind} are {' and '.join(wanted)}", ((), value))
        return None

    @field_validator("load")
    @classmethod
    def _within_reach(cls, load: Load, info: ValidationInfo) -> Load:
        """Two arms of length L cannot be more than 2 L apart."""
        specimen = info.data.get("specimen")
        if specimen is None:
            return load
        (low, why_low), (high, why_high) = specimen.most
        outside = [(("opening", i), opening) for i, opening in enumerate(load.opening) if not low <= opening <= high]
        if outside:
            raise refuse(f">= {low:g} ({why_low}) and <= {high:g} ({why_high})", *outside)
        return load

    @field_validator("load")
    @classmethod
    def _on_end_faces(cls, load: Load, info: ValidationInfo) -> Load:
        """Rollers and couples have a traction of their own."""
        specimen = info.data.get("specimen")
        if specimen is not None and specimen.slides and load.at != "face":
            raise refuse(f'"face" for the kind {specimen.kind}', (("at",), load.at))
        return load

    @field_validator("interface")
    @classmethod
    def _slides_where_it_must(cls, interface: Interface, info: ValidationInfo) -> Interface:
        specimen = info.data.get("specimen")
        if specimen is not None and specimen.slides and not interface.slides:
            text = f"one with shear_strength and shear_toughness for the kind {specimen.kind}, whose bond slides"
            raise refuse(text, ((), sorted(interface.model_fields_set)))
        if specimen is None or not specimen.slides or "penalty" in interface.model_fields_set:
            return interface
        materials = [info.data.get(name) for name in specimen.materials]
        return (
            interface
            if None in materials
            else interface.model_copy(update={"penalty": _penalty_of_faces(interface, specimen, materials)})
        )

    @field_validator("effects")
    @classmethod
    def _sliding(cls, effects: Effects, info: ValidationInfo) -> Effects:
        """What needs a bond that slides, and what such a bond excludes."""
        specimen, bond = info.data.get("specimen"), info.data.get("interface")
        if specimen is not None and bond is not None:
            require_shear(specimen, bond, effects.shear, effects.symmetry)
        return effects

    @field_validator("effects")
    @classmethod
    def _symmetric_specimen(cls, effects: Effects, info: ValidationInfo) -> Effects:
        specimen = info.data.get("specimen")
        if specimen is None or specimen.symmetric:
            return effects
        of, bodies = f"for a {specimen.kind}", " and ".join(specimen.bodies)
        if effects.symmetry is True:
            raise refuse(f"false {of}: {bodies} differ", (("symmetry",), True))
        if effects.search is False:
            raise refuse(f"true {of}: {bodies} turn", (("search",), False))
        return effects

    @field_validator("discretization")
    @classmethod
    def _two_meshes(cls, mesh: Discretization, info: ValidationInfo) -> Discretization:
        effects, specimen = info.data.get("effects"), info.data.get("specimen")
        if mesh.layers != "auto" and mesh.layers > 1 and specimen is not None and specimen.clamped:
            raise refuse(f"1 for a {specimen.kind}, whose lower body is graded", (("layers",), mesh.layers))
        if mesh.adaptive and specimen is not None and (specimen.mesh or not specimen.symmetric):
            why = "with specimen.mesh, which is taken as it is" if specimen.symmetric else f"for a {specimen.kind}"
            raise refuse(f"false {why}", (("adaptive",), True))
        if mesh.adaptive and mesh.mismatch != 1.0:
            raise refuse("1 with discretization.adaptive, whose arms are alike", (("mismatch",), mesh.mismatch))
        if effects is not None and effects.symmetry is True:
            given = {"mismatch": mesh.mismatch, "slave": mesh.slave}
            for key, plain in (("mismatch", 1.0), ("slave", "upper")):
                if given[key] != plain:
                    text = f"{plain:g}" if key == "mismatch" else f'"{plain}"'
                    raise refuse(
                        f"{text} with effects.symmetry, which models the upper arm alone", ((key,), given[key])
                    )
        return mesh

    @field_validator("published")
    @classmethod
    def _on_the_way(cls, published: tuple[Published, ...], info: ValidationInfo) -> tuple[Published, ...]:
        load = info.data.get("load")
        if load is None:
            return published
        end = max(load.opening)
        beyond = [((i, "opening"), known.opening) for i, known in enumerate(published) if (known.opening or 0) > end]
        if beyond:
            raise refuse(f"<= {end:g}, the largest load.opening", *beyond)
        way = (0.0, *turns(load.opening))
        for i, value in enumerate(published):
            if value.leg is None or value.opening is None:
                continue
            if value.leg >= len(way):
                raise refuse(f"<= {len(way) - 1}, the number of legs of load.opening", ((i, "leg"), value.leg))
            low, high = sorted(way[value.leg - 1 : value.leg + 1])
            if not low <= value.opening <= high:
                rule = f">= {low:g} and <= {high:g}, leg {value.leg} of load.opening"
                raise refuse(rule, ((i, "opening"), value.opening))
        return published

    @field_validator("uncertainty")
    @classmethod
    def _of_its_numbers(cls, uncertainty: Uncertainty, info: ValidationInfo) -> Uncertainty:
        require_numbers(uncertainty, info.data)
        return uncertainty


#: Stiffness of the contact over that of an arm across its thickness, where faces roll off each other.
ROLLING = 10.0


def _penalty_of_faces(interface: Interface, specimen: Specimen, materials: Sequence[Any]) -> float:
    """Stiffness of the contact of arms that slide on each other, `ROLLING` E2 / h, and no less than that of the bond.

    Long faces that hardly press each other are found point by point where the contact is far stiffer than the arms: a
    step then takes 20 to 100 iterations, and 10 to 40 with this, which changed curves of three scenes by up to 0.08 %.
    """
    bodies = [one for found in materials for one in (found if isinstance(found, tuple) else (found,))]
    across = min(elastic_constants(one)["E2"] for one in bodies) / min(specimen.thicknesses)
    return min(interface.penalty, max(interface.penalty / BOND_TO_CONTACT, ROLLING * across))


def _definite(found: Material | tuple[Material, Material], specimen: Specimen) -> Material | tuple[Material, ...]:
    """Materials that store energy; two of them for a specimen whose arms may differ."""
    if not isinstance(found, tuple):
        return definite(found, specimen.plane)
    if not specimen.slides:
        raise refuse(f"one table for the kind {specimen.kind}", ((), "a list of two"))
    return tuple(definite(one, specimen.plane, i) for i, one in enumerate(found))


#: Steps where the path does not choose them.
DEFAULT_STEPS = 150


#: Distance from the tangent over the accuracy.
BEND_OF_ACCURACY = 5.0 / 3.0


def bend(scene: Scene) -> float:
    """How far off its tangent the load may be on a step, as a part of the peak load."""
    asked = scene.discretization
    return BEND_OF_ACCURACY * asked.accuracy if asked.bend == "auto" else asked.bend


def counted_steps(scene: Scene) -> int:
    """Steps for the methods that do not choose their own."""
    steps = scene.discretization.steps
    return DEFAULT_STEPS if steps == "auto" else steps
