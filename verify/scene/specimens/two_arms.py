"""Base of the specimens whose bond slides: two arms of one length, which may differ, on rollers or not."""

from __future__ import annotations

from typing import Annotated, ClassVar, TypeAlias

from pydantic import BeforeValidator, Field, ValidationInfo, field_validator

from verify.scene.specimens.delamination import Delamination, Files, Groups, Load, Plane, Ratio, Support
from verify.scene.tables import Positive, refuse


def _twice(value: object) -> object:
    """One number stands for both arms."""
    return tuple(value) if isinstance(value, list | tuple) else (value, value)


Both: TypeAlias = Annotated[tuple[Positive, Positive], BeforeValidator(_twice)]
NotNegative: TypeAlias = Annotated[float, Field(ge=0)]
Pair: TypeAlias = Annotated[tuple[NotNegative, NotNegative], BeforeValidator(_twice)]


class TwoArms(Delamination):
    """Two arms from X = 0 to the end of the overhang on the right, bonded from the precrack on.

    Distances count from ``start``: the left support, or X = 0 where there is none.
    """

    slides = True
    length_keys, thickness_keys = ("length", "length"), ("arm_thickness", "arm_thickness")
    tip_key, bond_key = "precrack", "length"
    example: ClassVar[str] = "enf-as4peek"
    ratios: ClassVar[tuple[Ratio, ...]] = (
        Ratio("arm_thickness", 1e-6, 1e3, "length"),
        Ratio("precrack", 1e-6, 0.999999, "length"),
        Ratio("width", 1e-9, 1e9, "length"),
    )
    kind: str
    length: Positive
    """From the loaded end to the far end of the bond, or between the outer supports [length]."""
    arm_thickness: Both
    """Of one arm, or of the upper and the lower one [length], like [1.5, 5.1]."""
    precrack: Positive
    """From the loaded end, or from the left support, to the bond [length]; less than the length."""
    width: Positive = 1.0
    """Out of the plane [length]."""
    plane: Plane = "stress"
    """Plane stress or plane strain."""
    mesh: Files = Field(default=(), max_length=1)
    """One .msh, .inp, .vtu, .e or .med file of both arms for lagrange and dolfinx; none: a mesh is made."""
    groups: Groups = Groups()
    """Names of the groups of the mesh file."""

    @field_validator("mesh")
    @classmethod
    def _of_elements(cls, mesh: Files) -> Files:
        if any(name.lower().endswith(".iga") for name in mesh):
            raise refuse("a .msh, .inp, .vtu, .e or .med file of both arms", ((), list(mesh)))
        return mesh

    @field_validator("precrack")
    @classmethod
    def _bonded_part_is_left(cls, precrack: float, info: ValidationInfo) -> float:
        length = info.data.get("length")
        if length is not None and precrack >= length:
            raise refuse(f"< specimen.length = {length:g}", ((), precrack))
        return precrack

    @property
    def start(self) -> float:
        """Coordinate X from which lengths count."""
        return 0.0

    @property
    def lengths(self) -> tuple[float, float]:
        return self.length, self.length

    @property
    def thicknesses(self) -> tuple[float, float]:
        return self.arm_thickness

    @property
    def tip(self) -> float:
        return self.start + self.precrack

    @property
    def loaded_at(self) -> float:
        return self.start

    @property
    def extent(self) -> float:
        return self.lengths[0] - self.start

    @property
    def most(self) -> tuple[tuple[float, str], tuple[float, str]]:
        """The deflection of every load is less than the length, its rotation less than half a turn."""
        couples = all(load.couple for load in self.loads)
        size = (3.0 if couples else self.length) * sum(abs(load.share) for load in self.loads)
        why = "3 radians" if couples else "length"
        return (-size, f"-{why} for every load"), (size, f"{why} for every load")


class OnRollers(TwoArms):
    """Two arms on rollers and under rollers, with overhangs beyond the outer supports."""

    roller: float | None = Field(default=None, gt=0, examples=[0.5])
    """Half the length of the patch on which a roller or a load acts [length]; left out: half the thickness of the arm
    that it touches."""
    overhang: Pair = (0.0, 0.0)
    """From the left support to the left end and from the right one to the right end [length]."""

    @field_validator("roller")
    @classmethod
    def _on_the_specimen(cls, roller: float | None, info: ValidationInfo) -> float | None:
        length = info.data.get("length")
        if roller is not None and length is not None and roller > length / 4:
            raise refuse(f"<= specimen.length / 4 = {length / 4:g}", ((), roller))
        return roller

    @property
    def start(self) -> float:
        return self.overhang[0]

    @property
    def lengths(self) -> tuple[float, float]:
        total = sum(self.overhang) + self.length
        return total, total

    def patch(self, body: int, s: float) -> tuple[float, float]:
        """Range of X of a roller on an arm, ``s`` from the left support, cut off at the ends of the specimen."""
        half = self.arm_thickness[body] / 2 if self.roller is None else self.roller
        return max(self.start + s - half, 0.0), min(self.start + s + half, self.lengths[0])

    def pushed(self, s: float, share: float) -> Load:
        """A load on the top, upwards, ``s`` from the left support."""
        return Load(0, "top", share, self.patch(0, s))

    def carried(self, body: int, s: float) -> Support:
        """A support below an arm, ``s`` from the left one."""
        return Support(body, "bottom", self.patch(body, s))

    @property
    def ends_carried(self) -> tuple[Support, ...]:
        """Supports below both ends of the lower arm."""
        return self.carried(1, 0.0), self.carried(1, self.length)


#: The far end of both arms as one, held against deflection and rotation.
GUIDED = Support(None, "right"), Support(None, "right", couple=True)
