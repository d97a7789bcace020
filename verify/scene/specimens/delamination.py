"""What all specimens share: two bodies, bonded along a part of a straight interface, loaded at one end."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, ClassVar, Literal, NamedTuple, TypeAlias

from pydantic import BeforeValidator, Field

from verify.scene.tables import Section


def _as_names(value: object) -> object:
    """One name is a list of one."""
    return (value,) if isinstance(value, str) else tuple(value) if isinstance(value, list) else value


Files: TypeAlias = Annotated[tuple[Annotated[str, Field(min_length=1)], ...], BeforeValidator(_as_names)]
Plane: TypeAlias = Literal["stress", "strain"]


class Ratio(NamedTuple):
    """Range of one length of a specimen over another one."""

    key: str
    low: float
    high: float
    other: str


class Load(NamedTuple):
    """A share of the load, upwards, on the end face of a body (0 upper, 1 lower)."""

    body: int
    end: Literal["left", "right"]
    share: float


class Clamp(NamedTuple):
    """A side of a body that cannot move."""

    body: int
    side: Literal["left", "right", "bottom", "top"]


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
    ``loads`` : loads on end faces, all at the same X
    ``clamps`` : sides that are clamped; none if the loads balance each other
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
    loads: ClassVar[tuple[Load, ...]] = (Load(0, "left", 1.0), Load(1, "left", -1.0))
    clamps: ClassVar[tuple[Clamp, ...]] = ()
    pressed: ClassVar[tuple[int, str]]
    ratios: ClassVar[tuple[Ratio, ...]]
    sentence: ClassVar[str]
    example: ClassVar[str] = "dcb-czm1"

    if TYPE_CHECKING:  # fields of every subclass, which declares them itself: after its lengths in the table
        kind: str
        width: float
        plane: Plane
        mesh: Files

    @property
    def arms(self) -> int:
        """How many bodies the load bends: those that no clamp holds all along."""
        return 2 - len({clamp.body for clamp in self.clamps if clamp.side in ("bottom", "top")})

    @property
    def symmetric(self) -> bool:
        """Whether one body can stand for both."""
        sizes = set(zip(self.lengths, self.thicknesses, strict=True))
        return self.arms == 2 and len(sizes) == len(self.materials) == 1

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
        return self.tip, self.place(self.extent)

    @property
    def loaded_at(self) -> float:
        """Coordinate X of the loaded end."""
        body, end, _ = self.loads[0]
        return 0.0 if end == "left" else self.lengths[body]

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
        """Of the thinner body that the load bends."""
        return min(self.thicknesses[: self.arms])

    def place(self, s: float) -> float:
        """Coordinate X at the distance ``s`` from the loaded end."""
        return self.loaded_at + (s if self.tip > self.loaded_at else -s)
