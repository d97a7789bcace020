"""The scene file as a type: one physical problem, its load programme, the effects to simulate, the meshes.

Units are the user's own consistent set. Every bound here is physical or a limit of what is built; the sentences that a
user reads about a broken one are made in ``verify.complaints``.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, Literal, TypeAlias

from pydantic import BaseModel, BeforeValidator, ConfigDict, Discriminator, Field, Tag, ValidationInfo, field_validator
from pydantic_core import PydanticCustomError

Positive: TypeAlias = Annotated[float, Field(gt=0)]


def refuse(text: str, *found: tuple[tuple[str | int, ...], object]) -> PydanticCustomError:
    """A broken rule between keys: ``text`` completes "must be ...", ``found`` has rests of key paths and values."""
    return PydanticCustomError("rule", "{text}", {"text": text, "found": found})


class Section(BaseModel):
    """A table of the scene file: nothing is coerced, nothing unknown is let through, nothing changes afterwards."""

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True, allow_inf_nan=False)


class Dcb(Section):
    """Double cantilever beam: two arms, bonded on X in [precrack, length], loaded at X = 0."""

    kind: Literal["dcb"]
    length: Positive
    arm_thickness: Positive
    precrack: Positive
    width: Positive = 1.0
    plane: Literal["stress", "strain"] = "stress"

    @field_validator("precrack")
    @classmethod
    def _bonded_part_is_left(cls, precrack: float, info: ValidationInfo) -> float:
        length = info.data.get("length")
        if length is not None and precrack >= length:
            raise refuse(f"< specimen.length = {length:g}", ((), precrack))
        return precrack


class Isotropic(Section):
    young: Positive
    poisson: float = Field(gt=-1, lt=0.5)


class Orthotropic(Section):
    """Axis 1 runs along the specimen; nu12 is the contraction along 2 for a pull along 1."""

    E1: Positive
    E2: Positive
    G12: Positive
    nu12: float

    @field_validator("nu12")
    @classmethod
    def _positive_definite(cls, nu12: float, info: ValidationInfo) -> float:
        if "E1" in info.data and "E2" in info.data:
            limit = (info.data["E1"] / info.data["E2"]) ** 0.5
            if abs(nu12) >= limit:
                raise refuse(f"> {-limit:.6g} and < {limit:.6g}, that is |nu12| < sqrt(E1/E2)", ((), nu12))
        return nu12


def material_kind(value: object) -> str:
    """Tell the two materials apart by their keys."""
    keys = set(value) if isinstance(value, Mapping) else {value.__class__.__name__}
    return "orthotropic" if keys & {*Orthotropic.model_fields, "Orthotropic"} else "isotropic"


Material: TypeAlias = Annotated[
    Annotated[Isotropic, Tag("isotropic")] | Annotated[Orthotropic, Tag("orthotropic")], Discriminator(material_kind)
]


def _hundred_initial_stiffnesses(data: dict[str, Any]) -> float:
    gap_at_strength = 2 * data["toughness"] / data["strength"] / data["ductility"]
    return 100 * data["strength"] / gap_at_strength


class Interface(Section):
    law: Literal["bilinear"] = "bilinear"
    strength: Positive
    toughness: Positive
    ductility: float = Field(default=12.5, gt=1)  # g_u / g_max: 1 is a vertical drop, which no Newton follows
    penalty: float = Field(default_factory=_hundred_initial_stiffnesses, gt=0)  # so that the default has no units


def _as_programme(value: object) -> object:
    """One number is a programme of one leg."""
    return tuple(value) if isinstance(value, list | tuple) else (value,)


class Load(Section):
    opening: Annotated[tuple[float, ...], BeforeValidator(_as_programme), Field(min_length=1)]

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
    contact: bool = True
    irreversible: bool = True
    symmetry: bool = False


class Discretization(Section):
    """How finely the ``iga`` methods resolve the scene."""

    degree: int = Field(default=3, ge=1, le=5)
    dofs: int = Field(default=1956, ge=40, le=1_000_000)
    interface_rule: Literal["gauss", "lobatto", "lumped"] = "gauss"
    interface_points: int = Field(default=2, ge=1, le=12)
    steps: int = Field(default=150, ge=1, le=100_000)  # equal opening increments asked of every path follower

    @field_validator("interface_rule")
    @classmethod
    def _built(cls, rule: str) -> str:
        if rule == "lumped":
            raise refuse('"gauss" or "lobatto" ("lumped" is not available yet)', ((), rule))
        return rule

    @field_validator("interface_points")
    @classmethod
    def _lobatto_has_both_ends(cls, points: int, info: ValidationInfo) -> int:
        if info.data.get("interface_rule") == "lobatto" and points < 2:
            raise refuse("an integer from 2 to 12 for the lobatto rule", ((), points))
        return points


class Dolfinx(Section):
    """How finely the DOLFINx model resolves the scene."""

    degree: int = Field(default=2, ge=1, le=4)
    elements: int = Field(default=112, ge=2, le=100_000)  # along the specimen


class Scene(Section):
    """One physical problem. Every method solves the same one."""

    name: str = Field(default="scene", pattern=r"^[A-Za-z0-9][A-Za-z0-9._-]*$", max_length=80)  # names folders
    units: str = "consistent units"
    specimen: Dcb
    material: Material
    interface: Interface
    load: Load
    effects: Effects = Effects()
    discretization: Discretization = Discretization()
    dolfinx: Dolfinx = Dolfinx()

    @field_validator("material")
    @classmethod
    def _positive_definite_in_plane_strain(cls, material: Material, info: ValidationInfo) -> Material:
        """With the third direction like the second (E3 = E2, nu13 = nu23 = nu12): 1 - nu12 - 2 nu12^2 E2/E1 > 0."""
        specimen = info.data.get("specimen")
        if isinstance(material, Isotropic) or specimen is None or specimen.plane == "stress":
            return material
        ratio = material.E2 / material.E1
        low, high = (max((sign * (1 + 8 * ratio) ** 0.5 - 1) / (4 * ratio), -1) for sign in (-1, 1))
        if not low < material.nu12 < high:
            raise refuse(f"> {low:.6g} and < {high:.6g} in plane strain", (("nu12",), material.nu12))
        return material

    @field_validator("load")
    @classmethod
    def _within_reach(cls, load: Load, info: ValidationInfo) -> Load:
        """Two arms of length L cannot be further apart than 2 L, nor pass through each other by more than both."""
        specimen = info.data.get("specimen")
        if specimen is None:
            return load
        low, high = -2 * specimen.arm_thickness, 2 * specimen.length
        outside = [(("opening", i), opening) for i, opening in enumerate(load.opening) if not low <= opening <= high]
        if outside:
            raise refuse(f">= {low:g} (-2 arm_thickness) and <= {high:g} (2 length)", *outside)
        return load
