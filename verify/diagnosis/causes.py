"""Causes that are another scene: a number that is off by a factor, or a choice made the other way."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from math import exp, log

from verify.scene.effects import simulated
from verify.scene.schema import Scene
from verify.scene.stated.uncertainty import number_at, scaled

#: Factor of a number from which on it is not said in percent.
BEYOND_PERCENT = 3.0


@dataclass(frozen=True)
class Number:
    """A number of the scene times a factor; ``keys``: the dotted keys that it has in scenes, those present are scaled.

    more, less : its comparatives, as in "4.1 % lower"
    soft : whether the curve follows the inverse of the number, as a compliance, and not its logarithm
    """

    name: str
    keys: tuple[str, ...] = ()
    more: str = "higher"
    less: str = "lower"
    soft: bool = False

    @property
    def probe(self) -> float:
        """Amount of a change for the derivative: that of a stiffness is small beside the waves of the elements."""
        return 1.0 if self.soft else 0.05

    def factor(self, amount: float) -> float:
        """The factor of an amount in which the curve is about linear, 1 for an amount of 0."""
        return 1.0 / (1.0 + amount) if self.soft else exp(amount)

    def within(self, amount: float) -> float:
        """The amount, or that of the largest or smallest factor that is looked for."""
        low, high = (-0.99, 99.0) if self.soft else (-log(3.0), log(3.0))
        return min(max(amount, low), high)

    def words(self, part: float) -> str:
        """As in "the modulus is 4.1 % lower"."""
        comparative = self.more if part > 0 else self.less
        if not 1.0 / BEYOND_PERCENT < 1.0 + part < BEYOND_PERCENT:
            return f"the {self.name} is {comparative} by a factor of {max(1.0 + part, 1.0 / (1.0 + part)):.3g}"
        return f"the {self.name} is {percent(abs(part))} {comparative}"

    def overrides(self, scene: Scene, factor: float) -> list[str]:
        """The scene with the factor, as overrides; empty where it has no such number."""
        found = {key: number_at(scene, key) for key in self.keys}
        if "interface.shear_stiffness" in found:  # left out, it follows from the other numbers
            found["interface.shear_stiffness"] = scene.interface.shear_stiffness
        return [f"{key}={scaled(value, factor)}" for key, value in found.items() if value is not None]


def percent(part: float) -> str:
    """A part in percent: two digits, and whole ones from 100 % on."""
    return f"{100 * part:.0f} %" if abs(part) >= 0.995 else f"{100 * part:.2g} %"


@dataclass(frozen=True)
class Kept(Number):
    """The part of its stiffness that a broken bond keeps, which no scene has; a factor is 1 plus it."""

    @property
    def probe(self) -> float:
        return 1e-5

    def factor(self, amount: float) -> float:
        return 1.0 + amount

    def within(self, amount: float) -> float:
        return min(max(amount, 0.0), 0.01)

    def words(self, part: float) -> str:
        return f"a broken bond keeps {part:.2g} of its stiffness"

    def overrides(self, scene: Scene, factor: float) -> list[str]:
        return [f"law.kept={factor - 1.0!r}"]


SCALED_NUMBERS = (
    Number("modulus", ("material.young", "material.E1", "strip.young")),
    Number("thickness", ("specimen.arm_thickness", "specimen.strip_thickness"), "larger", "smaller"),
    Number("precrack", ("specimen.precrack",), "longer", "shorter"),
    Number("strength", ("interface.strength",)),
    Number("toughness", ("interface.toughness",)),
    Number("shear strength", ("interface.shear_strength",)),
    Number("shear toughness", ("interface.shear_toughness",)),
    Number("initial stiffness of the bond", ("interface.stiffness", "interface.ductility"), soft=True),
    Number("initial shear stiffness of the bond", ("interface.shear_stiffness",), soft=True),
    Kept("remaining stiffness", soft=True),
)


@dataclass(frozen=True)
class Choice(Number):
    """A choice of the scene made the other way, whose amount is 1; ``changed``: the overrides, ``said``: what the curve
    then has."""

    changed: tuple[str, ...] = ()
    said: str = ""

    def factor(self, amount: float) -> float:
        return 2.0

    def within(self, amount: float) -> float:
        return 1.0

    def words(self, part: float) -> str:
        return self.said

    def overrides(self, scene: Scene, factor: float) -> list[str]:
        return list(self.changed)


def choices(scene: Scene) -> Iterator[Choice]:
    """The choices of a scene that can be made the other way."""
    plane = scene.specimen.plane
    other, here = "stress" if plane == "strain" else "strain", "a solid" if plane == "solid" else f"in plane {plane}"
    words = f"it is in plane {other}, not {here}"
    yield Choice("plane", changed=(f"specimen.plane={other}",), said=words)
    here = simulated(scene)["kinematics"]
    other = {"finite": "linear", "linear": "finite"}[here]
    strains = {"finite": "finite", "linear": "small"}
    words = f"its strains are {strains[other]}, not {strains[here]}"
    yield Choice("kinematics", changed=(f"effects.kinematics={other}",), said=words)
    bond, K = scene.interface, scene.interface.bond_stiffness
    if abs(bond.penalty / K - 1.0) >= 1e-6:
        words = (
            f"its contact is as stiff as the bond, {K:.4g}, where the scene has {bond.penalty / K:.3g} times that "
            f"(--set interface.penalty={K:.4g} judges it so)"
        )
        yield Choice("contact stiffness", changed=(f"interface.penalty={K!r}",), said=words)
    if bond.law == "exponential":  # damage begins at once
        return
    if not bond.table:
        words = "its toughness is the area beyond the onset, without the elastic triangle"
        yield Choice("toughness without the elastic triangle", changed=tuple(_with_triangle(scene)), said=words)
    if scene.specimen.slides and not bond.friction:
        # the mode ratio of the step before is none: it moves the curve of a bond that slides alone by 2e-6
        words = "it takes sqrt(2) of the toughness where faces are closed and slide"
        yield Choice("sqrt(2) of the toughness where closed", changed=("law.sqrt2",), said=words)
        words = "its toughness has (1 + s/g)^2 in place of 1 + (s/g)^2"
        yield Choice("toughness of a summed mode ratio", changed=("law.summed",), said=words)


def _with_triangle(scene: Scene) -> Iterator[str]:
    """The elastic energy at the onset, S^2 / (2 K), on top of the toughness; stiffness and strength stay."""
    bond = scene.interface
    more = 1.0 + 0.5 * bond.strength**2 / bond.bond_stiffness / bond.toughness
    for key in ("interface.toughness", "interface.ductility"):
        if (value := number_at(scene, key)) is not None:  # a stiffness that is given stands in place of the latter
            yield f"{key}={scaled(value, more)}"
    if bond.shear_strength and bond.shear_toughness and bond.shear_stiffness:
        toughness = bond.shear_toughness + 0.5 * bond.shear_strength**2 / bond.shear_stiffness
        yield f"interface.shear_toughness={toughness!r}"
        yield f"interface.shear_stiffness={bond.shear_stiffness!r}"
