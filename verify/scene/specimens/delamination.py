"""What all specimens share: two bodies, bonded along a part of a straight interface, loads and supports."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal, NamedTuple, TypeAlias

from pydantic import BeforeValidator, Field, ValidationInfo, field_validator

from verify.scene.tables import Positive, Section, as_list, refuse

Files: TypeAlias = Annotated[tuple[Annotated[str, Field(min_length=1)], ...], BeforeValidator(as_list)]
Plane: TypeAlias = Literal["stress", "strain"]
Depth: TypeAlias = Literal["stress", "strain", "solid"]
Side: TypeAlias = Literal["left", "right", "top", "bottom"]


class Groups(Section):
    """Names of the groups in a mesh file. Where a name is left out the word itself is the name, and the group may be
    missing."""

    upper: str = ""
    """Elements of the upper body."""
    lower: str = ""
    """Elements of the lower body."""
    bond: str = ""
    """Lines or nodes of the bonded faces, of one body or both."""
    load: str = ""
    """Lines or nodes of the loaded faces, or of the patches of all loads."""
    support: str = ""
    """Lines or nodes of the patches of all supports, where there are any."""


class Ratio(NamedTuple):
    """Range of one length of a specimen over another one, whose key stands before it in the table."""

    key: str
    low: float
    high: float
    other: str


class Load(NamedTuple):
    """A part of the load as an even dead traction: ``share`` of it upwards, on a side of a body (0 upper, 1 lower).

    ``extent`` is the range of X of a patch on the top or the bottom, None for the whole side. A ``couple`` is a
    traction along X on an end face, linear across it, with ``share`` of the load as its moment, anticlockwise. Without
    a body it is on the end faces of both as one.
    """

    body: int | None
    side: Side
    share: float
    extent: tuple[float, float] | None = None
    couple: bool = False


class Support(NamedTuple):
    """A patch, as that of a `Load`, whose mean vertical displacement is zero; with ``couple`` an end face whose mean
    rotation is zero."""

    body: int | None
    side: Side
    extent: tuple[float, float] | None = None
    couple: bool = False


class Clamp(NamedTuple):
    """A side of a body that cannot move."""

    body: int
    side: Side


#: The loads that pull two arms apart at X = 0.
PULLED_APART = Load(0, "left", 1.0), Load(1, "left", -1.0)


class Delamination(Section):
    """The table ``[specimen]``: two rectangles, upper and lower, that begin at X = 0 and meet on Y = 0, bonded along a
    part of that line.

    Each kind is a subclass. Its fields are the keys of the table: ``kind``, lengths, ``width``, ``plane`` and ``mesh``.
    Its class variables describe it:

    ``materials`` : names of the tables of its materials, one for both bodies or one for each
    ``bodies``, ``body`` : names of the bodies, and of a body that the load bends
    ``length_keys``, ``thickness_keys`` : keys of the lengths and thicknesses of the bodies
    ``tip_key`` : key of X of the end of the bond next to the load; the far end is the far end of the upper body
    ``bond_key`` : the key to increase for a longer bond
    ``loads``, ``supports``, ``clamps`` : what it is loaded and held by; without supports and clamps the loads balance
    ``slides`` : whether its bond slides, so that it asks for the keys of shear
    ``pressed`` : largest negative opening, in thicknesses of the loaded body, and its reason in words
    ``ratios`` : limits of the proportions
    ``sentence`` : the test in words, with the keys of its lengths in braces
    ``example`` : the packaged scene whose values ``debond new`` writes; a key that it lacks needs ``examples`` in its
        field
    """

    materials: ClassVar[tuple[str, ...]] = ("material",)
    bodies: ClassVar[tuple[str, str]] = ("upper", "lower")
    body: ClassVar[str] = "arm"
    length_keys: ClassVar[tuple[str, str]]
    thickness_keys: ClassVar[tuple[str, str]]
    tip_key: ClassVar[str]
    bond_key: ClassVar[str]
    clamps: ClassVar[tuple[Clamp, ...]] = ()
    slides: ClassVar[bool] = False
    pressed: ClassVar[tuple[int, str]]
    ratios: ClassVar[tuple[Ratio, ...]]
    sentence: ClassVar[str]
    example: ClassVar[str] = "dcb-czm1"

    if TYPE_CHECKING:  # fields of every subclass, which declares them itself: after its lengths in the table
        kind: str
        width: float
        plane: Depth
        lateral: str
        mesh: Files
        groups: Groups

        @property
        def loads(self) -> tuple[Load, ...]:
            """Parts of the load."""

        @property
        def supports(self) -> tuple[Support, ...]:
            """The supports; none where the loads balance each other, or a clamp holds the specimen."""

    @field_validator("*")
    @classmethod
    def _in_proportion(cls, value: Any, info: ValidationInfo) -> Any:
        for key, low, high, other in cls.ratios:
            if key != info.field_name or value is None or other not in info.data:
                continue
            size, why = info.data[other], f"{low:g} to {high:g} times specimen.{other}"
            for one in value if isinstance(value, tuple) else (value,):
                if not low * size <= one <= high * size:
                    raise refuse(f">= {low * size:.10g} and <= {high * size:.10g}, {why}", ((), one))
        return value

    @property
    def patches(self) -> tuple[Load | Support, ...]:
        """Loads and supports of arms whose bond slides; other specimens have only loaded faces."""
        return (*self.loads, *self.supports) if self.slides else ()

    @property
    def nodal(self) -> bool:
        """Whether its mesh files hold nodal elements, and not the splines of `.iga` files."""
        return bool(self.mesh) and not all(name.lower().endswith(".iga") for name in self.mesh)

    @property
    def arms(self) -> int:
        """Number of bodies that the load bends: those that are not clamped along their base."""
        return 2 - len({clamp.body for clamp in self.clamps if clamp.side in ("bottom", "top")})

    @property
    def symmetric(self) -> bool:
        """Whether one body can represent both by symmetry."""
        sizes = set(zip(self.lengths, self.thicknesses, strict=True))
        return not self.slides and self.arms == 2 and len(sizes) == len(self.materials) == 1

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
    def bonded(self) -> tuple[float, float]:
        """Coordinates X of the bond's end next to the load and of its far end."""
        return self.tip, self.lengths[0] if self.tip > self.loaded_at else 0.0

    @property
    def loaded_at(self) -> float:
        """Coordinate X of the loaded end."""
        return self.middle(self.loads[0])

    @property
    def extent(self) -> float:
        """Distance from the loaded end to the far end of the bond."""
        return self.lengths[0]

    @property
    def most(self) -> tuple[tuple[float, str], tuple[float, str]]:
        """The smallest and the largest opening of a programme, each with its reason in words."""
        times, why = self.pressed
        return (-times * self.loaded_thickness, why), (2.0 * self.extent, f"2 {self.length_keys[0]}")

    @property
    def free_length(self) -> float:
        """Distance from the loaded end to the bond."""
        return abs(self.tip - self.loaded_at)

    @property
    def loaded_thickness(self) -> float:
        """Of the thinner body that the load bends."""
        return min(self.thicknesses[: self.arms])

    def middle(self, patch: Load | Support) -> float:
        """Coordinate X of the middle of a patch, or of the end that it is."""
        if patch.extent is not None:
            return sum(patch.extent) / 2
        return 0.0 if patch.side == "left" else self.lengths[patch.body or 0]

    def place(self, s: float) -> float:
        """Coordinate X at the distance ``s`` from the loaded end."""
        return self.loaded_at + (s if self.tip > self.loaded_at else -s)


class Arms(Delamination):
    """Two arms of one length, bonded from the precrack to the far end; a subclass has the thickness of its arms."""

    length_keys, thickness_keys = ("length", "length"), ("arm_thickness", "arm_thickness")
    tip_key, bond_key = "precrack", "length"
    ratios: ClassVar[tuple[Ratio, ...]] = (
        Ratio("arm_thickness", 1e-6, 1e3, "length"),
        Ratio("precrack", 1e-6, 0.999999, "length"),
        Ratio("width", 1e-9, 1e9, "length"),
    )

    kind: str
    length: Positive
    """From the loaded end to the far end of the bond, or between the outer supports [length]."""
    arm_thickness: Any
    """Of one arm, or of the upper and the lower one [length], like [1.5, 5.1]."""
    precrack: Positive
    """From the loaded end, or from the left support, to the bond [length]; less than the length."""
    width: Positive = 1.0
    """Out of the plane [length]."""
    plane: Depth = "stress"
    """Plane stress or plane strain, or the solid of this width."""
    lateral: Literal["free", "held"] = "free"
    """For plane "solid": whether nothing holds its sides, or nothing moves across the width, as in plane strain."""
    mesh: Files = ()
    """Mesh files; none: a mesh is made."""
    groups: Groups = Groups()
    """Names of the groups of the mesh file."""
