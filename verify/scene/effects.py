"""Which effects a scene needs: what ``auto`` means, and why.

Every estimate uses beam theory and is made before a run; `verify.checks.neglected` evaluates the run afterwards.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from math import atan2, degrees, exp, sqrt
from types import MappingProxyType
from typing import Any

from verify.scene.materials import elastic_constants
from verify.scene.schema import Scene
from verify.scene.specimens import bending

FINITE_ABOVE_DEGREES = 5.0

#: Change of the load up to which an effect is negligible: the tolerance between curves of two independent codes.
NEGLIGIBLE = 0.005

#: Factor c: finite kinematics changes the load of a beam, whose end turns by theta, by the factor 1 + c theta^2 at the
#: same opening. Before growth it follows from the elastica (Bisshopp and Drucker 1945, Quart. Appl. Math. 3) to second
#: order, ``P a^2 / (E I) = 2 theta (1 + 16/35 theta^2)`` with theta = 3 d / (2 a); during growth the length a satisfies
#: ``2 P sin(theta) = G w``.
STANDING, GROWING = 16.0 / 35.0, 6.0 / 35.0

#: A rigid foundation under the compressed part of a bond increases the stiffness of the beam by this factor times the
#: part of the work in that part (1.54 to 1.60 for crack lengths of 1 to 40 / lambda, see `load_of_squeezing`).
RIGID = 1.6

#: For a method that fixes no effect.
NO_FIXED_EFFECTS: Mapping[str, Any] = MappingProxyType({})


@dataclass(frozen=True)
class Decision:
    """The choice for an effect that is ``auto``: its key in ``[effects]``, the value, and the reason in words."""

    key: str
    value: str | bool
    why: str

    def __str__(self) -> str:
        value = str(self.value).lower() if isinstance(self.value, bool) else self.value
        return f"effects.{self.key}: {value}, as {self.why}"


def simulated(scene: Scene, fixed: Mapping[str, Any] = NO_FIXED_EFFECTS) -> dict[str, Any]:
    """The effects as they are simulated: ``auto`` is replaced by the choice made for it, and effects that the method
    fixes by their fixed value."""
    chosen = {one.key: one.value for one in decided(scene)}
    found = {**scene.effects.model_dump(), **({} if scene.interface.slides else {"shear": False}), **chosen, **fixed}
    return found if searches(found) else found | {"search": False}


def searches(effects: Mapping[str, Any]) -> bool:
    """Whether closest points are searched for in every configuration: only for two bodies with finite kinematics."""
    return effects["search"] and effects["kinematics"] == "finite" and not effects["symmetry"]


def decided(scene: Scene, fixed: Mapping[str, Any] = NO_FIXED_EFFECTS) -> tuple[Decision, ...]:
    """The choices for all effects that are ``auto``, except those that a method fixes; shear only with a law of
    sliding."""
    chosen = (key for key, value in scene.effects if value == "auto" and key not in fixed)
    return tuple(Decision(key, *AUTO_RULES[key](scene)) for key in chosen if key != "shear" or scene.interface.slides)


def end_rotation(scene: Scene) -> float:
    """Largest rotation of a loaded end face over the programme, in radians, by simple beam theory.

    An arm of bending stiffness E I, bent to the deflection d over a free length a, turns by theta = 3 d / (2 a). The
    free length is that before any growth or, if larger, that at the end. Arms that slide on each other are solved as
    beams on their supports, and any of their rotations counts.
    """
    specimen = scene.specimen
    if specimen.slides:
        return bending.rotation(scene)
    free = min(max(specimen.free_length, specimen.loaded_thickness, crack_at_the_end(scene)), specimen.extent)
    return 1.5 * _deflection(scene) / free


def crack_at_the_end(scene: Scene) -> float:
    """Free length in equilibrium at the largest opening, by simple beam theory; it may exceed the specimen.

    d = a^2/3 sqrt(2 s w G / (E I)) for the more flexible arm, which takes the share s of opening and G: one half in a
    dcb, all for a strip. For arms that slide: `verify.scene.specimens.bending.grown`.
    """
    if scene.specimen.slides:
        return bending.grown(scene)
    released = 2.0 * opening_share(scene) * scene.specimen.width * scene.interface.toughness
    return sqrt(3 * _deflection(scene) * sqrt(min(_bending_stiffnesses(scene)) / released))


def load_of_squeezing(scene: Scene) -> float:
    """Relative change of the load by contact before any damage, only from the compression of the bond ahead of the
    crack.

    Model: a long beam on an elastic foundation k, pulled at a distance a. With ``lambda = (k / 4 E I)^(1/4)``,
    ``alpha = lambda a`` and X in units of 1 / lambda the gap is ``exp(-X) ((1 + alpha) cos X - alpha sin X)`` times a
    constant. Where it is negative the foundation holds the part `squeezed` of the work, and contact changes k to r k
    there; see `stiffer`. The compliances in series are that of the bond (of a dcb up to its plane of symmetry), that of
    the arm or strip across its thickness, h / (2 E2) (Kanninen 1973, Int. J. Fract. 9), and that of a substrate.
    """
    specimen, law = scene.specimen, scene.interface
    initial = law.strength**2 * law.ductility / (2.0 * law.toughness)
    across = specimen.loaded_thickness / (2.0 * elastic_constants(scene.materials[0])["E2"])
    if specimen.clamped:
        across += specimen.thicknesses[1] / elastic_constants(scene.materials[1])["E2"]
    k, closed = (1.0 / (opening_share(scene) / bond + across) for bond in (initial, law.penalty))
    alpha = specimen.free_length * (k * specimen.width / (4.0 * min(_bending_stiffnesses(scene)))) ** 0.25
    return squeezed(alpha) * stiffer(closed / k)


def squeezed(alpha: float) -> float:
    """Part of the work that is stored in the compressed part of an elastic foundation; ``alpha`` as in
    `load_of_squeezing`.

    The deflection of the end is ``1/2 + alpha + alpha^2 + alpha^3 / 3``; the part of ``exp(-X) C sin(X_0 - X)`` beyond
    X_0 contributes ``4 C^2 exp(-2 X_0) / 8``.
    """
    whole = 0.5 + alpha + alpha**2 + alpha**3 / 3.0
    return 0.25 * ((1.0 + alpha) ** 2 + alpha**2) * exp(-2.0 * atan2(1.0 + alpha, alpha)) / (2.0 * whole)


def stiffer(ratio: float) -> float:
    """Change of the load for each part of the work in a piece of foundation made ``ratio`` times as stiff.

    ``c (1 - ratio^(-1/c))`` with c = `RIGID`: the first order, ratio - 1, is exact, and the limit is `RIGID`. For
    ratios of 3 and 100 it is within 5 % of the solution of the beam.
    """
    return RIGID * (1.0 - ratio ** (-1.0 / RIGID))


def _kinematics(scene: Scene) -> tuple[str, str]:
    theta, slides = end_rotation(scene), scene.specimen.slides
    turn = f"the {'specimen' if slides else 'loaded end'} turns by {degrees(theta):.2g} degrees"
    if degrees(theta) > FINITE_ABOVE_DEGREES:
        return "finite", f"{turn}, more than {FINITE_ABOVE_DEGREES:g}"
    change = f"which changes the load by no more than {STANDING * theta**2:.2g} of it"
    return "linear", f"{turn}, {f'not more than {FINITE_ABOVE_DEGREES:g}' if slides else change}"


def _contact(scene: Scene) -> tuple[bool, str]:
    if scene.specimen.slides:
        return True, "arms that slide are pressed together somewhere"
    lowest, change = min(scene.load.opening), load_of_squeezing(scene)
    if lowest < 0.0:
        return True, f"the programme closes the faces, to {lowest:g}"
    if crack_at_the_end(scene) >= scene.specimen.extent:
        return True, "the crack comes to the far end, about which the specimen then turns"
    squeeze = f"the bond is squeezed ahead of the crack, which is worth {abs(change):.2g} of the load"
    return abs(change) > NEGLIGIBLE, squeeze + ("" if abs(change) > NEGLIGIBLE else ", and nothing else closes")


def _irreversible(scene: Scene) -> tuple[bool, str]:
    programme = scene.load.opening
    falls = [(before, after) for before, after in zip((0.0, *programme), programme, strict=False) if after < before]
    if not falls and scene.interface.viscosity:
        return True, "the damage follows in time"
    if not falls:
        return False, "the programme only opens"
    return True, "the programme goes from {:g} down to {:g}".format(*falls[0])


def mirrored_solid(scene: Scene) -> bool:
    """Whether a solid is made of two mirror images, whose bond opens: its upper arm stands for both."""
    return scene.specimen.plane == "solid" and scene.specimen.symmetric and not simulated(scene)["shear"]


def _symmetry(scene: Scene) -> tuple[bool, str]:
    mesh, specimen = scene.discretization, scene.specimen
    if not specimen.symmetric:
        return False, f"{' and '.join(specimen.bodies)} differ"
    if len(specimen.mesh) == 2 or specimen.nodal:
        return False, "each arm has a mesh of its own"
    if scene.effects.shear is True or scene.interface.viscosity:
        return False, "a law of sliding acts between two arms"
    if mesh.mismatch != 1.0 or mesh.slave != "upper":
        return False, "the arms are meshed differently, or the lower one carries the interface"
    return True, "the arms are alike"


def _search(scene: Scene) -> tuple[bool, str]:
    alike, why = _symmetry(scene)
    return not alike, f"{why} and turn alike" if alike else why


def _shear(scene: Scene) -> tuple[bool, str]:
    if scene.interface.viscosity:
        return True, "the law of opening and sliding has the viscosity"
    if scene.specimen.symmetric:
        return False, "two equal arms open and do not slide"
    return True, f"the bond of the kind {scene.specimen.kind} slides"


AUTO_RULES: Mapping[str, Callable[[Scene], tuple[str | bool, str]]] = {
    "kinematics": _kinematics,
    "contact": _contact,
    "irreversible": _irreversible,
    "symmetry": _symmetry,
    "search": _search,
    "shear": _shear,
}


def opening_share(scene: Scene) -> float:
    """Share of the opening that the more flexible body takes: half of equal arms, all of a strip on a substrate."""
    bending = _bending_stiffnesses(scene)
    return 1.0 / sum(min(bending) / one for one in bending)


def _bending_stiffnesses(scene: Scene) -> list[float]:
    """E I of the bodies that the load bends."""
    specimen = scene.specimen
    bent = list(zip(scene.materials, specimen.thicknesses, strict=True))[: specimen.arms]
    return [elastic_constants(material)["E1"] * specimen.width * height**3 / 12 for material, height in bent]


def _deflection(scene: Scene) -> float:
    """Largest deflection of the more flexible arm."""
    return max(map(abs, scene.load.opening)) * opening_share(scene)
