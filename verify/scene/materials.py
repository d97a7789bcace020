"""The materials of a scene."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, TypeAlias

from pydantic import BeforeValidator, Discriminator, Field, Tag, ValidationInfo, field_validator

from verify.scene.tables import Positive, Section, refusal, refuse


class Isotropic(Section):
    young: Positive
    """Young's modulus [stress]."""
    poisson: float = Field(gt=-1, lt=0.5)
    """Poisson's ratio."""


class Orthotropic(Section):
    """Axis 1 runs along the specimen; nu12 is the contraction along 2 for a pull along 1."""

    E1: Positive
    """Young's modulus along the specimen [stress]."""
    E2: Positive
    """Young's modulus through the thickness [stress]."""
    G12: Positive
    """Shear modulus [stress]."""
    nu12: float
    """Contraction along 2 for a pull along 1; |nu12| < sqrt(E1/E2)."""
    nu23: float | None = Field(default=None, gt=-1, lt=1, examples=[0.45])
    """Contraction out of the plane for a pull along 2, which plane strain asks for; left out: nu12."""
    E3: Positive | None = Field(default=None, examples=[9000.0])
    """Young's modulus across the width [stress], which solids ask for; left out: E2."""
    nu13: float | None = Field(default=None, examples=[0.3])
    """Contraction across the width for a pull along 1, which solids ask for; left out: nu12."""
    G13: Positive | None = Field(default=None, examples=[5000.0])
    """Shear modulus along the specimen and across the width [stress], which solids ask for; left out: G12."""
    G23: Positive | None = Field(default=None, examples=[3000.0])
    """Shear modulus across the specimen [stress], which solids ask for; left out: E2 / (2 (1 + nu23))."""

    @field_validator("nu12")
    @classmethod
    def _positive_definite(cls, nu12: float, info: ValidationInfo) -> float:
        if "E1" in info.data and "E2" in info.data:
            limit = (info.data["E1"] / info.data["E2"]) ** 0.5
            if abs(nu12) >= limit:
                raise refuse(f"> {-limit:.6g} and < {limit:.6g}, that is |nu12| < sqrt(E1/E2)", ((), nu12))
        return nu12


#: Constants of an orthotropic material that only a solid has.
OF_SOLIDS = ("E3", "nu13", "G13", "G23")

#: The types of a material by their names in errors.
MATERIALS: Mapping[str, type[Section]] = {"isotropic": Isotropic, "orthotropic": Orthotropic}


def material_kind(value: object) -> str:
    """Whether a material is isotropic or orthotropic, by its keys; "<pair>" for a list of two."""
    if isinstance(value, list | tuple):
        return "<pair>"
    keys = set(value) if isinstance(value, Mapping) else {value.__class__.__name__}
    return "<orthotropic>" if keys & {*Orthotropic.model_fields, "Orthotropic"} else "<isotropic>"


def _two(value: object) -> object:
    if isinstance(value, list | tuple) and len(value) != 2:
        raise refuse("a table, or a list of two, of the upper and the lower arm", ((), value))
    return tuple(value) if isinstance(value, list) else value


_One: TypeAlias = Annotated[Isotropic, Tag("<isotropic>")] | Annotated[Orthotropic, Tag("<orthotropic>")]
Material: TypeAlias = Annotated[_One, Discriminator(material_kind)]
#: One material of both arms, or that of the upper and that of the lower one.
MaterialOrTwo: TypeAlias = Annotated[
    _One | Annotated[tuple[Material, Material], BeforeValidator(_two), Tag("<pair>")], Discriminator(material_kind)
]


def definite(material: Material, plane: str, *place: int) -> Material:
    """Condition for plane strain, with the third direction like the second (E3 = E2, nu13 = nu12):
    1 - nu23 - 2 nu12^2 E2/E1 > 0, with nu23 = nu12 where it is left out; for a solid that its compliance is positive
    definite (Jones 1999, eq. 2.48). ``place``: position in a list of materials."""
    if isinstance(material, Isotropic):
        return material
    given = [key for key in OF_SOLIDS if getattr(material, key) is not None]
    if given and plane != "solid":
        text = f'left out with specimen.plane "{plane}"'
        raise refusal(((*place, key), text, getattr(material, key)) for key in given)
    if plane == "solid":
        return _definite_solid(material, place)
    if plane == "stress":
        return material
    ratio = material.E2 / material.E1
    if material.nu23 is not None:
        most = 1 - 2 * material.nu12**2 * ratio
        if not -1 < material.nu23 < most:
            raise refuse(f"> -1 and < {most:.6g} in plane strain", ((*place, "nu23"), material.nu23))
        return material
    low, high = (max((sign * (1 + 8 * ratio) ** 0.5 - 1) / (4 * ratio), -1) for sign in (-1, 1))
    if not low < material.nu12 < high:
        raise refuse(f"> {low:.6g} and < {high:.6g} in plane strain", ((*place, "nu12"), material.nu12))
    return material


def _definite_solid(material: Orthotropic, place: tuple[int, ...]) -> Material:
    c = solid_constants(material)
    for key, square in (("nu13", c["E1"] / c["E3"]), ("nu23", c["E2"] / c["E3"])):
        if c[key] ** 2 >= square:
            raise refuse(f"> {-(square**0.5):.6g} and < {square**0.5:.6g} in a solid", ((*place, key), c[key]))
    twice = c["nu12"] * c["nu13"] * c["E3"] / c["E1"]
    free = (1 - c["nu12"] ** 2 * c["E2"] / c["E1"]) * (1 - c["nu13"] ** 2 * c["E3"] / c["E1"])
    low, high = (c["E2"] / c["E3"] * (sign * (free * c["E3"] / c["E2"]) ** 0.5 - twice) for sign in (-1, 1))
    if not low < c["nu23"] < high:
        raise refuse(f"> {low:.6g} and < {high:.6g} in a solid", ((*place, "nu23"), c["nu23"]))
    return material


def elastic_constants(material: Material) -> dict[str, float]:
    """E1, E2, G12 and nu12, also for an isotropic material; the others where they are given."""
    if isinstance(material, Isotropic):
        young, poisson = material.young, material.poisson
        return {"E1": young, "E2": young, "G12": young / (2 * (1 + poisson)), "nu12": poisson}
    return material.model_dump(exclude_none=True)


def solid_constants(material: Material) -> dict[str, float]:
    """The nine constants of a solid; transversely isotropic, with E3 = E2, nu13 = nu12, nu23 = nu12, G13 = G12 and
    G23 = E2 / (2 (1 + nu23)), where they are left out."""
    c = elastic_constants(material)
    c = {"E3": c["E2"], "nu13": c["nu12"], "nu23": c["nu12"], "G13": c["G12"], **c}
    return {"G23": c["E2"] / (2 * (1 + c["nu23"])), **c}


def plane_strain_constants(material: Material) -> dict[str, float]:
    """The `elastic_constants` with E3, nu13 and nu23: the third direction is like the second."""
    c = elastic_constants(material)
    return c | {"E3": c["E2"], "nu13": c["nu12"], "nu23": c.get("nu23", c["nu12"])}


def axial_modulus(material: Material, plane: str) -> float:
    """Stiffness against stretching along the arm, of a solid that of its edges; in plane strain E1 / (1 - nu13 nu31),
    E3 = E2 and nu13 = nu12."""
    c = elastic_constants(material)
    return c["E1"] if plane != "strain" else c["E1"] / (1 - c["nu12"] ** 2 * c["E2"] / c["E1"])


def plane_compliance(material: Material, plane: str) -> Any:
    """Compliance (3, 3) of the plane in Voigt order, where the third stress (plane stress) or the third strain (plane
    strain) is zero."""
    import numpy as np  # takes time, which reading a scene does not need

    c = plane_strain_constants(material)
    out = c["E2"] if plane == "strain" else 0.0
    s11 = 1.0 / c["E1"] - out * (c["nu12"] / c["E1"]) ** 2
    s12 = -c["nu12"] / c["E1"] - out * c["nu12"] * c["nu23"] / (c["E1"] * c["E2"])
    s22 = 1.0 / c["E2"] - out * (c["nu23"] / c["E2"]) ** 2
    return np.array([[s11, s12, 0.0], [s12, s22, 0.0], [0.0, 0.0, 1.0 / c["G12"]]])
