"""The bodies of a scene: specimens and their materials."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, ClassVar, Literal, NamedTuple, TypeAlias

from pydantic import BeforeValidator, Discriminator, Field, Tag, ValidationInfo, field_validator

from verify.scene.tables import Positive, Section, refuse


def _as_names(value: object) -> object:
    """One name is a list of one."""
    return (value,) if isinstance(value, str) else tuple(value) if isinstance(value, list) else value


Files: TypeAlias = Annotated[tuple[Annotated[str, Field(min_length=1)], ...], BeforeValidator(_as_names)]


class Ratio(NamedTuple):
    """Range of one length of a specimen over another one."""

    key: str
    low: float
    high: float
    other: str


class Delamination(Section):
    """Two bodies that meet on Y = 0, upper and lower, bonded along a part of it: what every specimen answers.

    A specimen says of itself, besides its lengths:

    ``materials``, ``bodies`` : names of the tables of its materials, one for both or one each; names of the bodies
    ``arms``, ``body`` : how many of them the load bends, both, or one off the other, which is clamped; its name
    ``length_keys``, ``thickness_keys`` : keys of the lengths and thicknesses of the bodies
    ``tip_key``, ``end_key`` : keys of X of the bond's end next to the load, and of X of the loaded end, empty for 0
    ``bond_key`` : the key that is larger where the bond is longer
    ``pressed`` : how many thicknesses the loaded faces can be pressed together, and why no more
    ``ratios`` : proportions that are solved
    ``sentence`` : what is done to the specimen, with the keys of its lengths
    """

    materials: ClassVar[tuple[str, ...]]
    bodies: ClassVar[tuple[str, str]]
    arms: ClassVar[int]
    body: ClassVar[str]
    length_keys: ClassVar[tuple[str, str]]
    thickness_keys: ClassVar[tuple[str, str]]
    tip_key: ClassVar[str]
    end_key: ClassVar[str]
    bond_key: ClassVar[str]
    pressed: ClassVar[tuple[int, str]]
    ratios: ClassVar[tuple[Ratio, ...]]
    sentence: ClassVar[str]

    @property
    def symmetric(self) -> bool:
        """Whether one body can stand for both."""
        return self.arms == 2

    @property
    def clamped(self) -> bool:
        """Whether the lower body is clamped."""
        return self.arms == 1

    @property
    def lengths(self) -> tuple[float, float]:
        """Of the upper and the lower body."""
        upper, lower = self.length_keys
        return getattr(self, upper), getattr(self, lower)

    @property
    def thicknesses(self) -> tuple[float, float]:
        """Of the upper and the lower body."""
        upper, lower = self.thickness_keys
        return getattr(self, upper), getattr(self, lower)

    @property
    def tip(self) -> float:
        """Coordinate X of the end of the bond next to the load."""
        return getattr(self, self.tip_key)

    @property
    def loaded_at(self) -> float:
        """Coordinate X of the loaded end."""
        return getattr(self, self.end_key) if self.end_key else 0.0

    @property
    def extent(self) -> float:
        """Distance from the loaded end to the far end of the bond."""
        return self.lengths[0]

    @property
    def free_length(self) -> float:
        """Distance from the loaded end to the bond."""
        return abs(self.tip - self.loaded_at)

    @property
    def loaded_thickness(self) -> float:
        """Of a body that the load bends."""
        return self.thicknesses[0]

    def place(self, s: float) -> float:
        """Coordinate X of what is ``s`` away from the loaded end."""
        return self.loaded_at + (s if self.tip > self.loaded_at else -s)


class Dcb(Delamination):
    """Double cantilever beam: two arms, bonded on X in [precrack, length], loaded at X = 0.

    ``mesh``: `.iga` files of the upper and the lower arm for T-splines; one stands for both, the lower being its mirror
    image.
    """

    materials = ("material",)
    bodies = ("upper", "lower")
    arms, body = 2, "arm"
    length_keys, thickness_keys = ("length", "length"), ("arm_thickness", "arm_thickness")
    tip_key, end_key, bond_key = "precrack", "", "length"
    pressed = 1, "-arm_thickness, at which both loaded faces would be in one place"
    ratios = (
        Ratio("arm_thickness", 1e-6, 1e3, "length"),
        Ratio("precrack", 1e-6, 0.999999, "length"),
        Ratio("width", 1e-9, 1e9, "length"),
    )
    sentence = (
        "A double cantilever beam with arms of {length} by {arm_thickness} and a precrack of {precrack} is opened"
    )

    kind: Literal["dcb"]
    """Two arms, bonded from the precrack to the far end, pulled apart at X = 0."""
    length: Positive
    """From the loaded end to the far end of the bond [length]."""
    arm_thickness: Positive
    """Of one arm [length]."""
    precrack: Positive
    """From the loaded end to the bond [length]; less than the length."""
    width: Positive = 1.0
    """Out of the plane [length]."""
    plane: Literal["stress", "strain"] = "stress"
    """Plane stress or plane strain."""
    mesh: Files = Field(default=(), max_length=2)
    """`.iga` files of the upper and the lower arm for tspline; one stands for both; none: a mesh is made."""

    @field_validator("precrack")
    @classmethod
    def _bonded_part_is_left(cls, precrack: float, info: ValidationInfo) -> float:
        length = info.data.get("length")
        if length is not None and precrack >= length:
            raise refuse(f"< specimen.length = {length:g}", ((), precrack))
        return precrack


class Peel(Delamination):
    """A strip peeled off a substrate: left ends flush at X = 0, bonded on X in [0, bond_length], strip pulled up at its
    right end, substrate clamped at its base."""

    materials = ("strip", "substrate")
    bodies = ("strip", "substrate")
    arms, body = 1, "strip"
    length_keys = ("strip_length", "substrate_length")
    thickness_keys = ("strip_thickness", "substrate_thickness")
    tip_key, end_key, bond_key = "bond_length", "strip_length", "bond_length"
    pressed = 2, "-2 strip_thickness"
    ratios = (
        Ratio("strip_thickness", 1e-6, 1e3, "strip_length"),
        Ratio("substrate_thickness", 1e-6, 1e3, "substrate_length"),
        Ratio("bond_length", 1e-6, 0.999999, "strip_length"),
        Ratio("width", 1e-9, 1e9, "strip_length"),
        Ratio("substrate_length", 1e-6, 1e6, "strip_length"),
    )
    sentence = (
        "A strip of {strip_length} by {strip_thickness}, bonded over {bond_length} to a clamped substrate of "
        "{substrate_length} by {substrate_thickness}, is peeled off by lifting its free end"
    )

    kind: Literal["peel"]
    """A strip peeled off a substrate that is fixed at its base, pulled up at its free end."""
    strip_length: Positive
    """The strip begins above the end of the substrate at X = 0 [length]."""
    strip_thickness: Positive
    """Of the strip [length]."""
    substrate_length: Positive
    """Of the substrate [length]."""
    substrate_thickness: Positive
    """Of the substrate [length]."""
    bond_length: Positive
    """From X = 0 on [length]; less than the strip, at most the substrate."""
    width: Positive = 1.0
    """Out of the plane [length]."""
    plane: Literal["stress", "strain"] = "stress"
    """Plane stress or plane strain."""
    mesh: Files = ()
    """`.iga` files of strip and substrate for tspline; none: meshes are made."""

    @field_validator("mesh")
    @classmethod
    def _both_meshes(cls, mesh: tuple[str, ...]) -> tuple[str, ...]:
        if len(mesh) not in (0, 2):
            raise refuse("two files, of strip and substrate", ((), list(mesh)))
        return mesh

    @field_validator("bond_length")
    @classmethod
    def _both_bodies_are_there(cls, bond_length: float, info: ValidationInfo) -> float:
        strip, substrate = (info.data.get(key) for key in ("strip_length", "substrate_length"))
        if strip is not None and bond_length >= strip:
            raise refuse(f"< specimen.strip_length = {strip:g}", ((), bond_length))
        if substrate is not None and bond_length > substrate:
            raise refuse(f"<= specimen.substrate_length = {substrate:g}", ((), bond_length))
        return bond_length


#: The specimens by their kind.
SPECIMENS: Mapping[str, type[Dcb] | type[Peel]] = {"dcb": Dcb, "peel": Peel}


def specimen_kind(value: object) -> str:
    """Tell the specimens apart by their kind; one without a known kind is refused as a dcb."""
    kind = value.get("kind") if isinstance(value, Mapping) else getattr(value, "kind", None)
    return kind if isinstance(kind, str) and kind in SPECIMENS else "dcb"


Specimen: TypeAlias = Annotated[Annotated[Dcb, Tag("dcb")] | Annotated[Peel, Tag("peel")], Discriminator(specimen_kind)]


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


def definite(material: Material, plane: str) -> Material:
    """In plane strain, the third direction like the second (E3 = E2, nu13 = nu12): 1 - nu12 - 2 nu12^2 E2/E1 > 0."""
    if isinstance(material, Isotropic) or plane == "stress":
        return material
    ratio = material.E2 / material.E1
    low, high = (max((sign * (1 + 8 * ratio) ** 0.5 - 1) / (4 * ratio), -1) for sign in (-1, 1))
    if not low < material.nu12 < high:
        raise refuse(f"> {low:.6g} and < {high:.6g} in plane strain", (("nu12",), material.nu12))
    return material


def elastic_constants(material: Material) -> dict[str, float]:
    """E1, E2, G12 and nu12, of an isotropic material as well."""
    if isinstance(material, Isotropic):
        young, poisson = material.young, material.poisson
        return {"E1": young, "E2": young, "G12": young / (2 * (1 + poisson)), "nu12": poisson}
    return material.model_dump()


def axial_modulus(material: Material, plane: str) -> float:
    """Stiffness against stretching along the arm; in plane strain E1 / (1 - nu13 nu31), E3 = E2 and nu13 = nu12."""
    c = elastic_constants(material)
    return c["E1"] if plane == "stress" else c["E1"] / (1 - c["nu12"] ** 2 * c["E2"] / c["E1"])
