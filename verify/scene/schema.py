"""The scene file as a type: one physical problem, its load programme, the effects to simulate, the meshes.

Units are the user's own consistent set. Every bound here is physical or a limit of what is built; the sentences that a
user reads about a broken one are made in ``verify.scene.complaints``.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Self

from pydantic import (
    AfterValidator,
    BeforeValidator,
    Field,
    ValidationInfo,
    ValidatorFunctionWrapHandler,
    field_validator,
    model_validator,
)  # fmt: skip
from pydantic_core import PydanticCustomError

from verify.scene.bond.interface import BOND_TO_CONTACT, Interface
from verify.scene.materials import Material, MaterialOrTwo, definite, elastic_constants
from verify.scene.settings import MOST_THROUGH as MOST_THROUGH
from verify.scene.settings import Beam, Discretization, Effects, Load, Pose
from verify.scene.settings import Dolfinx as Dolfinx
from verify.scene.specimens import Specimen
from verify.scene.stated.published import Published
from verify.scene.stated.uncertainty import Uncertainty
from verify.scene.tables import Section, agreed, refuse

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

    @model_validator(mode="after")
    def _of_one_problem(self) -> Self:
        from verify.scene.rules import broken  # here, as it imports this module

        return agreed(self, broken(self))


def bend(scene: Scene) -> float:
    """How far off its tangent the load may be on a step, as a part of the peak load."""
    asked = scene.discretization
    return BEND_OF_ACCURACY * asked.accuracy if asked.bend == "auto" else asked.bend


def counted_steps(scene: Scene) -> int:
    """Steps for the methods that do not choose their own."""
    steps = scene.discretization.steps
    return DEFAULT_STEPS if steps == "auto" else steps
