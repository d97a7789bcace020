"""The scene file as a type: one physical problem, its load programme, the effects to simulate, the meshes.

Units are the user's own consistent set. Every bound here is physical or a limit of what is built; the sentences that a
user reads about a broken one are made in ``verify.scene.complaints``.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Annotated

from pydantic import (
    AfterValidator,
    BeforeValidator,
    Field,
    ValidationInfo,
    ValidatorFunctionWrapHandler,
    field_validator,
)  # fmt: skip
from pydantic_core import PydanticCustomError

from verify.scene.bond.interface import BOND_TO_CONTACT, Interface
from verify.scene.magnitudes import proportions
from verify.scene.materials import Material, MaterialOrTwo, definite, elastic_constants
from verify.scene.settings import MOST_THROUGH as MOST_THROUGH
from verify.scene.settings import Beam, Discretization, Effects, Load, Pose
from verify.scene.settings import Dolfinx as Dolfinx
from verify.scene.specimens import Specimen
from verify.scene.stated.published import Published
from verify.scene.stated.uncertainty import DATA_KEYS, Uncertainty, number_at, numbers_in
from verify.scene.tables import Broken, Section, refuse
from verify.support.programme import turns

#: Endings of files in output folders; a scene, whose folder has its name, must not end like them.
FILE_ENDINGS = (".csv", ".html", ".json", ".md")

#: Stiffness of the contact over that of an arm across its thickness, where faces roll off each other.
ROLLING = 10.0

#: Steps where the path does not choose them.
DEFAULT_STEPS = 150

#: Distance from the tangent over the accuracy.
BEND_OF_ACCURACY = 5.0 / 3.0


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
        default="scene",
        pattern=r"^[A-Za-z0-9][A-Za-z0-9._-]*$",
        max_length=80,
        description="1 to 80 letters, digits, dots, dashes and underscores, a letter or digit first",
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

    def _repr_html_(self) -> str:
        from iga.notebook import drawn

        body, law = self.specimen, self.interface
        faces = zip(body.lengths, (body.thicknesses[0], -body.thicknesses[1]), strict=True)
        boxes = [[(0, 0), (length, 0), (length, y), (0, y), (0, 0)] for length, y in faces]
        sizes = " and ".join(f"{length:g} by {h:g}" for length, h in zip(body.lengths, body.thicknesses, strict=True))
        text = (
            f"{self.name} ({self.units}): {body.kind}, bodies of {sizes}, width {body.width:g}; bond from "
            f"{min(body.bonded):g} to {max(body.bonded):g}, {law.law}, strength {law.strength:g}, toughness "
            f"{law.toughness:g}; opened to {max(self.load.opening, key=abs):g}"
        )
        return drawn(boxes, text, [[(x, 0.0) for x in body.bonded]])

    @field_validator("material", "strip", "substrate", mode="wrap")
    @classmethod
    def _of_this_specimen(cls, value: object, validate: ValidatorFunctionWrapHandler, info: ValidationInfo) -> object:
        """Each kind of specimen has its own materials; nothing is said while the specimen itself is broken."""
        specimen = info.data.get("specimen")
        if specimen is None:
            return validate(value) if value is not None else None
        wanted = specimen.materials
        if info.field_name not in wanted:
            if value is not None:
                raise refuse(f"left out: the materials of a {specimen.kind} are {' and '.join(wanted)}", ((), value))
            return None
        if value is None:
            raise PydanticCustomError("missing", "missing")
        found = validate(value)
        if not isinstance(found, tuple):
            return definite(found, specimen.plane)
        if not specimen.slides:
            raise refuse(f"one table for the kind {specimen.kind}", ((), "a list of two"))
        return tuple(definite(one, specimen.plane, i) for i, one in enumerate(found))

    @field_validator("interface")
    @classmethod
    def _penalty_of_faces(cls, interface: Interface, info: ValidationInfo) -> Interface:
        """Stiffness of the contact of arms that slide on each other, `ROLLING` E2 / h, and no less than that of the
        bond, unless it is given.

        Long faces that hardly press each other are found point by point where the contact is far stiffer than the arms:
        a step then takes 20 to 100 iterations, and 10 to 40 with this, which changed curves of three scenes by up to
        0.08 %.
        """
        specimen, material = info.data.get("specimen"), info.data.get("material")
        if specimen is None or material is None or not specimen.slides or "penalty" in interface.model_fields_set:
            return interface
        bodies = material if isinstance(material, tuple) else (material,)
        across = min(elastic_constants(one)["E2"] for one in bodies) / min(specimen.thicknesses)
        penalty = min(interface.penalty, max(interface.penalty / BOND_TO_CONTACT, ROLLING * across))
        return interface.model_copy(update={"penalty": penalty})

    def _broken(self) -> Iterator[Broken]:
        """What the tables of a scene, each of which is valid, ask of each other."""
        for rules in (_load, _effects, _meshes, _solid, _published):
            yield from rules(self)
        for key, value in self.uncertainty.inputs.items():
            if number_at(self, key) is None:
                known = ", ".join([*numbers_in(self), *DATA_KEYS])
                yield ("uncertainty", key), f"that of a number of the scene that is not 0: one of {known}", value
        for name, size, low, high, why in proportions(self):
            if not low <= size <= high:
                yield (name,), f">= {low:.10g} and <= {high:.10g}, {why}", size


def bend(scene: Scene) -> float:
    """How far off its tangent the load may be on a step, as a part of the peak load."""
    asked = scene.discretization
    return BEND_OF_ACCURACY * asked.accuracy if asked.bend == "auto" else asked.bend


def counted_steps(scene: Scene) -> int:
    """Steps for the methods that do not choose their own."""
    steps = scene.discretization.steps
    return DEFAULT_STEPS if steps == "auto" else steps


def _load(scene: Scene) -> Iterator[Broken]:
    """Two arms of length L cannot be more than 2 L apart; rollers and couples have a traction of their own."""
    specimen, load = scene.specimen, scene.load
    (low, why_low), (high, why_high) = specimen.most
    for i, opening in enumerate(load.opening):
        if not low <= opening <= high:
            yield ("load", "opening", i), f">= {low:g} ({why_low}) and <= {high:g} ({why_high})", opening
    if specimen.slides and load.at != "face":
        yield ("load", "at"), f'"face" for the kind {specimen.kind}', load.at


def _effects(scene: Scene) -> Iterator[Broken]:
    """What needs a bond that slides, what such a bond excludes, and what two equal arms allow."""
    specimen, bond, effects = scene.specimen, scene.interface, scene.effects
    if specimen.slides and not bond.slides:
        text = f"one with shear_strength and shear_toughness for the kind {specimen.kind}, whose bond slides"
        yield ("interface",), text, sorted(bond.model_fields_set)
        return
    if effects.shear is True and not bond.slides:
        why = "without interface.shear_strength and interface.shear_toughness"
        yield ("effects", "shear"), f'false or "auto" {why}', True
    needed = [f"for the kind {specimen.kind}, whose arms nothing else holds"] * bool(specimen.supports)
    needed += [f"with interface.{key}" for key in ("friction", "viscosity") if getattr(bond, key)]
    if effects.shear is False and needed:
        yield ("effects", "shear"), f'true or "auto" {needed[0]}', False
    if effects.symmetry is True and (effects.shear is True or bond.viscosity):
        yield ("effects", "symmetry"), "false with a law of sliding, which acts between two arms", True
    bodies = " and ".join(specimen.bodies)
    if effects.symmetry is True and not specimen.symmetric:
        yield ("effects", "symmetry"), f"false for a {specimen.kind}: {bodies} differ", True
    if effects.search is False and not specimen.symmetric:
        yield ("effects", "search"), f"true for a {specimen.kind}: {bodies} turn", False


def _meshes(scene: Scene) -> Iterator[Broken]:
    specimen, mesh = scene.specimen, scene.discretization

    def rule(key: str, text: str) -> Broken:
        return ("discretization", key), text, getattr(mesh, key)

    if mesh.layers not in ("auto", 1) and specimen.clamped:
        yield rule("layers", f"1 for a {specimen.kind}, whose lower body is graded")
    if mesh.adaptive and not specimen.symmetric:
        yield rule("adaptive", f"false for a {specimen.kind}")
    elif mesh.adaptive and specimen.mesh:
        yield rule("adaptive", "false with specimen.mesh, which is taken as it is")
    if mesh.adaptive and mesh.mismatch != 1.0:
        yield rule("mismatch", "1 with discretization.adaptive, whose arms are alike")
    elif scene.effects.symmetry is True and mesh.mismatch != 1.0:
        yield rule("mismatch", "1 with effects.symmetry, which models the upper arm alone")
    if scene.effects.symmetry is True and mesh.slave != "upper":
        yield rule("slave", '"upper" with effects.symmetry, which models the upper arm alone')


def _solid(scene: Scene) -> Iterator[Broken]:
    """What only solids have, and what they do not have."""
    specimen, mesh, plane = scene.specimen, scene.discretization, scene.specimen.plane
    if plane != "solid":
        if getattr(specimen, "lateral", "free") != "free":
            yield ("specimen", "lateral"), f'"free" with specimen.plane "{plane}"', specimen.lateral
        if mesh.elements_width != "auto":
            key = ("discretization", "elements_width")
            yield key, f'"auto" with specimen.plane "{plane}"', mesh.elements_width
        return
    why = 'with specimen.plane "solid"'
    if specimen.mesh:
        yield ("specimen", "mesh"), f"left out {why}, whose mesh is made", list(specimen.mesh)
    if scene.load.at != "face":
        yield ("load", "at"), f'"face" {why}', scene.load.at
    if scene.pose != Pose():
        yield ("pose",), f"left out {why}", sorted(scene.pose.model_fields_set)
    if scene.interface.viscosity:
        yield ("interface", "viscosity"), f"0 {why}", scene.interface.viscosity
    if scene.interface.friction:
        yield ("interface", "friction"), f"0 {why}, whose faces have no direction to rub in", scene.interface.friction
    for name, plain, words in (("adaptive", False, "false"), ("mismatch", 1.0, "1"), ("slave", "upper", '"upper"')):
        if getattr(mesh, name) != plain:
            yield ("discretization", name), f"{words} {why}", getattr(mesh, name)
    if mesh.interface_rule == "lumped":
        yield ("discretization", "interface_rule"), f'"gauss" or "lobatto" {why}', "lumped"


def _published(scene: Scene) -> Iterator[Broken]:
    """Openings of published values are on the way of the programme."""
    way, end = (0.0, *turns(scene.load.opening)), max(scene.load.opening)
    for i, value in enumerate(scene.published):
        if value.opening is None:
            continue
        leg, opening = value.leg, ("published", i, "opening")
        if value.opening > end:
            yield opening, f"<= {end:g}, the largest load.opening", value.opening
        elif leg is not None and leg >= len(way):
            yield ("published", i, "leg"), f"<= {len(way) - 1}, the number of legs of load.opening", leg
        elif leg is not None:
            low, high = sorted(way[leg - 1 : leg + 1])
            if not low <= value.opening <= high:
                yield opening, f">= {low:g} and <= {high:g}, leg {leg} of load.opening", value.opening
