"""The one place that chooses meshes: what "auto" means for the elements along a bond, their layers and points.

The process zone sets the size of the elements, on the way of the crack; elsewhere there is only bending. Errors of the
load curve were measured on scenes of ordinary materials (`verify.scene.by_seed.plain_scenes`) with both codes: at most
half of `MeshRule.error` over n^2 for n elements in the zone. With fewer than `MeshRule.smooth` of them the load
oscillates from element to element, which costs more steps than finer elements do.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from math import exp, sqrt
from typing import Literal

import numpy as np

from verify.curves.curve import curve_error
from verify.methods.method import ENOUGH, Unsuitable
from verify.scene.effects import crack_at_the_end, simulated
from verify.scene.materials import elastic_constants
from verify.scene.process_zone import fading_length, steepness, zone_length
from verify.scene.schema import Scene
from verify.scene.specimens.bending import curve


@dataclass(frozen=True)
class MeshRule:
    """How elements follow from the process zone.

    error : error of the curve times the square of the elements in a zone, where the zone may be 0.7 of its estimate
    smooth : least number of elements in a zone
    fading : of splines in the length over which the slip fades on an intact bond, with `finest` in a zone at most:
        fewer leave 0.2 to 0.8 % of J before a crack grows
    thick, longest : longest elements on the way of the crack, and of DOLFINx off it, in thicknesses of the thinner arm
    bond : fewest elements on the bond
    ahead : process zones beyond the crack at the end with elements as short
    slack : factor on the growth of the crack by beam theory
    most : elements on the way of the crack at most
    tip, fades : error of the stiffness by the mesh through an arm at the tip of a crack, see `tip_error`
    growing : error of the load over that of the stiffness while a crack grows by an opening, see `of_stiffness`
    """

    error: float = 0.035
    smooth: float = 7.0
    fading: float = 3.0
    finest: float = 14.0
    thick: float = 1.0
    longest: float = 2.0
    bond: int = 12
    ahead: float = 1.5
    slack: float = 1.1
    most: int = 50_000
    tip: float = 0.056
    fades: float = 2.1
    growing: float = 0.5


MESH_RULE = MeshRule()

#: Part of the accuracy that the mesh through the thickness may take.
THROUGH = 5.0 / 6.0
#: Layers of cubic splines through an arm -> error over that of one layer.
SPLINE_LAYERS = {1: 1.0, 2: 0.6, 3: 0.34}


@dataclass(frozen=True)
class SplineMesh:
    """Of an ``iga`` method: unknowns to aim at, or the longest element on the way of the crack; layers through two
    arms, and points in each interface element."""

    dofs: int | None
    element: float | None
    layers: int
    points: int


def spline_mesh(scene: Scene, in_a_zone: float = 1.0, in_fading: float = 1.0) -> SplineMesh:
    """The mesh that ``[discretization]`` asks for, with the two factors of `Basis` for what is "auto"."""
    asked = scene.discretization
    given = asked.dofs if asked.dofs != "auto" else None
    points = asked.interface_points
    if points == "auto":
        points = 2 if given else asked.degree + 1
    elements = splines_in_a_zone(scene, in_a_zone, in_fading)
    return SplineMesh(given, None if given else element(scene, elements), _layers(scene), points)


def splines_in_a_zone(scene: Scene, in_a_zone: float = 1.0, in_fading: float = 1.0) -> float:
    """Elements of splines in a process zone where ``discretization.dofs`` is "auto", see `spline_mesh`."""
    asked = scene.discretization.in_a_zone
    if asked != "auto":
        return asked
    found = in_a_zone * _in_a_zone(scene, asked)
    if not simulated(scene)["shear"]:
        return found
    fading = min(MESH_RULE.fading * zone_length(scene) / fading_length(scene), MESH_RULE.finest)
    return max(found, in_fading * fading)


def reference_in_a_zone(scene: Scene) -> float:
    """Elements of DOLFINx in a process zone where ``dolfinx.elements`` is "auto"."""
    return _in_a_zone(scene, scene.dolfinx.in_a_zone)


def _in_a_zone(scene: Scene, asked: float | Literal["auto"]) -> float:
    """What is asked for, or as many elements as leave the error which a scene aims at."""
    if asked != "auto":
        return asked
    steep = steepness(scene)
    return max(sqrt(steep * MESH_RULE.error / scene.discretization.accuracy), MESH_RULE.smooth, ENOUGH * sqrt(steep))


def element(scene: Scene, in_a_zone: float) -> float:
    """Longest element on the way of the crack.

    Raises
    ------
    Unsuitable : there would be more than `MeshRule.most` of them.
    """
    low, high = sorted(scene.specimen.bonded)
    zone, (start, end) = zone_length(scene), crossed(scene)
    found = min(zone / in_a_zone, MESH_RULE.thick * scene.specimen.loaded_thickness, (high - low) / MESH_RULE.bond)
    if (end - start) / found > MESH_RULE.most:
        way = f"the crack crosses {(end - start) / zone:.0f} process zones of {zone:.2g}"
        few = f"{in_a_zone:.2g} elements in each are more than {MESH_RULE.most}"
        raise Unsuitable(f"discretization.dofs: must be a number here, got auto: {way}, and {few}")
    return found


def longest(scene: Scene) -> float:
    """Longest element of DOLFINx off the way of the crack."""
    return MESH_RULE.longest * scene.specimen.loaded_thickness


def crossed(scene: Scene) -> tuple[float, float]:
    """Range of X that the process zone crosses, from the tip of the bond on."""
    specimen = scene.specimen
    (tip, end), zone = specimen.bonded, zone_length(scene)
    grown = MESH_RULE.slack * max(crack_at_the_end(scene) - specimen.free_length, 0.0) + MESH_RULE.ahead * zone
    far = tip + max(-abs(end - tip), min(grown, abs(end - tip))) * (1.0 if end > tip else -1.0)
    return min(tip, far), max(tip, far)


def tip_error(scene: Scene) -> float:
    """Estimate of the relative error of the load curve with one cubic element through an arm, from its deformation at
    the tip of the crack, which is the sharper, the shorter the zone is.

    ``tip (h / a0) exp(-fades (zone / h) / (E1 / (2.6 G12))^(1/3))`` times `of_stiffness`. Of the initial stiffness 0.75
    to 1 of it was measured on six solids (isotropic ones, spruce, glass and carbon fibres), each with five zones of
    0.03 to 4 thicknesses, against eight layers.
    """
    specimen, constants = scene.specimen, elastic_constants(scene.materials[0])
    if specimen.clamped:  # measured on arms alone
        return 0.0
    stocky = specimen.loaded_thickness / specimen.free_length
    shear = (constants["E1"] / (2.6 * constants["G12"])) ** (1.0 / 3.0)
    fading = MESH_RULE.fades * zone_length(scene) / specimen.loaded_thickness / shear
    return float(MESH_RULE.tip * stocky * exp(-fading)) * of_stiffness(scene)


@lru_cache(maxsize=32)  # every choice of a mesh asks for it several times, of a few scenes
def of_stiffness(scene: Scene) -> float:
    """Error of the load curve over that of a stiffness which is too large by the accuracy of a scene.

    The load while a crack grows changes with the slope of its curve: by half of that error in a dcb, but by two or
    three times that in a specimen on rollers whose load falls steeply. It follows from the curve of brittle beams, of
    which the openings are as much smaller.
    """
    least = MESH_RULE.growing
    if not scene.specimen.slides:
        return least
    off, (d, P) = scene.discretization.accuracy, curve(scene)
    if d.size < 2:  # no crack grows
        return least
    end = min(max(map(abs, scene.load.opening)), float(np.max(d)) * (1.0 - off))
    return max(curve_error((d * (1.0 - off), P), (d, P), end) / off, least)


def _layers(scene: Scene) -> int:
    """Layers of splines through two arms: as many as the tip of the crack needs, two where rollers or pressed faces
    touch them, one for given unknowns."""
    asked, specimen = scene.discretization.layers, scene.specimen
    if asked != "auto":
        return asked
    if scene.discretization.dofs != "auto":
        return 1
    if specimen.clamped:
        return 1
    least = 2 if specimen.supports or min(scene.load.opening) < 0.0 else 1
    target, error = THROUGH * scene.discretization.accuracy, tip_error(scene)
    return next((n for n, part in SPLINE_LAYERS.items() if n >= least and part * error <= target), max(SPLINE_LAYERS))


@dataclass(frozen=True)
class Size:
    """What sets the size of a mesh along the specimen: a key of the scene and its value, to which elements are
    proportional."""

    key: str
    value: float

    def times(self, factor: float) -> Size:
        """That of about ``factor`` times as many elements."""
        value = factor * self.value
        return Size(self.key, value if self.key.endswith("in_a_zone") else round(value))

    @property
    def override(self) -> str:
        return f"{self.key}={self.value:.6g}"

    @property
    def words(self) -> str:
        """What it is in words."""
        of = {"discretization.dofs": "unknowns", "dolfinx.elements": "elements along"}
        return f"{self.value:.6g} {of.get(self.key, 'elements in a process zone')}"


def size(scene: Scene, splines: bool) -> Size:
    """Of the meshes of ``iga``, or of DOLFINx."""
    table, key = ("discretization", "dofs") if splines else ("dolfinx", "elements")
    asked = scene.discretization.dofs if splines else scene.dolfinx.elements
    if asked != "auto":
        return Size(f"{table}.{key}", asked)
    return Size(f"{table}.in_a_zone", splines_in_a_zone(scene) if splines else reference_in_a_zone(scene))
