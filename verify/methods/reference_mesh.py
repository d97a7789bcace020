"""The DOLFINx mesh of a scene: degree and layers through the thickness from the geometry, and the second mesh.

Elements along the specimen resolve the process zone. Elements through the thickness resolve the shear warping of an arm
near the crack tip. The error of the latter does not shrink with more elements along, and the J-integral does not show
it.
"""

from __future__ import annotations

from dataclasses import dataclass

from verify.methods.mesh_choice import THROUGH, element, reference_in_a_zone, size, tip_error
from verify.scene.materials import elastic_constants
from verify.scene.schema import Scene, counted_steps

#: Error of the load curve, times a0/h, of one quadratic element through an arm with E1 / G12 = 2.4 (isotropic with a
#: Poisson's ratio of 0.2), and the power of E1 / G12 with which it grows. See `thickness_error`.
WARPING, ANISOTROPY = 0.035, 0.85
#: By the degree: power of the number of layers with which the error falls, and its size over that of degree 2.
FALL = {1: 3.3, 2: 3.3, 3: 5.0, 4: 5.0}
PART = {1: 1.0, 2: 1.0, 3: 0.05, 4: 0.05}
#: The same two numbers for the error at the tip of a crack, over `verify.methods.mesh_choice.tip_error`.
TIP_FALL = {1: 1.75, 2: 1.75, 3: 1.6, 4: 1.6}
TIP_PART = {1: 20.0, 2: 4.6, 3: 1.0, 4: 1.0}
#: Quadratic layers that are cheaper than one cubic one, where elements along the specimen are graded.
FEW_LAYERS = 2
#: Elements over half of the width of a solid, over that width in thicknesses of an arm: G next to the edge of an
#: elastic cantilever is then within 1 %.
PER_THICKNESS = 0.7
#: Layers through an arm at most.
MOST_LAYERS = 8
#: Steps of the run on the second mesh over those of the first, and their least number.
FEWER_STEPS, FEWEST_STEPS = 0.3, 40
#: Elements along the second mesh below which it has more than half of those of the first, two thirds at most.
FEW_ELEMENTS = 48
#: Elements in a process zone of the second mesh over those of the first.
SECOND_IN_A_ZONE = 0.7


@dataclass(frozen=True)
class ReferenceMesh:
    """Degree, elements along the specimen, and layers of elements through each arm, or through the strip.

    In place of the number of ``elements`` there is the longest ``element`` on the way of the crack.
    """

    degree: int
    elements: int | None
    element: float | None
    layers: int


def reference_mesh(scene: Scene) -> ReferenceMesh:
    """The mesh that ``[dolfinx]`` asks for; values that are "auto" follow from geometry, process zone and accuracy.

    Elements are quadratic if few layers of them keep their part of the accuracy, `THROUGH`, else cubic; there are as
    many layers as the degree needs for that.
    """
    asked, target = scene.dolfinx, THROUGH * scene.discretization.accuracy
    few = asked.layers if asked.layers != "auto" else 1 if asked.elements != "auto" else FEW_LAYERS
    degree = asked.degree if asked.degree != "auto" else 2 if thickness_error(scene, 2, few) <= target else 3
    layers = asked.layers
    if layers == "auto":
        hinged = scene.load.at == "hinge"  # needs a node in the middle of the face
        enough = (m for m in range(1, MOST_LAYERS) if not (hinged and degree * m % 2))
        layers = next((m for m in enough if thickness_error(scene, degree, m) <= target), MOST_LAYERS)
    if asked.elements != "auto":
        return ReferenceMesh(degree, asked.elements, None, layers)
    return ReferenceMesh(degree, None, element(scene, reference_in_a_zone(scene)), layers)


def elements_across(scene: Scene) -> int:
    """Elements over half of the width of a solid: what is asked for, or as many as the edge needs, see
    `PER_THICKNESS`."""
    asked, specimen = scene.discretization.elements_width, scene.specimen
    if asked != "auto":
        return asked
    return max(2, round(PER_THICKNESS * 0.5 * specimen.width / specimen.loaded_thickness))


def thickness_error(scene: Scene, degree: int, layers: int) -> float:
    """Estimate of the relative error of the load curve from the mesh through the thickness, on the safe side.

    ``WARPING (E1 / (2.4 G12))^ANISOTROPY (h / a0) PART(degree) layers^-FALL(degree)``. The error measured with linear
    kinematics on 15 random cantilevers (`verify.scene.by_seed`), against two cubic layers, was 0.3 to 1 of the
    estimate for process zones of up to two arm thicknesses, and 0.15 to 0.4 of it for longer ones. At the tip of a
    crack with a zone shorter than half of a thickness the error may be larger, `tip_error`.
    """
    constants, specimen = elastic_constants(scene.materials[0]), scene.specimen
    stocky = specimen.loaded_thickness / specimen.free_length
    warping = WARPING * (constants["E1"] / (2.4 * constants["G12"])) ** ANISOTROPY
    bending = warping * stocky * PART[degree] * layers ** -FALL[degree]
    return max(bending, tip_error(scene) * TIP_PART[degree] * layers ** -TIP_FALL[degree])


def second_mesh(scene: Scene) -> tuple[str, ...]:
    """Overrides for the run that the reference is compared with: cheap, and coarse in another way.

    It has about half as many elements along, at most quadratic, but twice as many layers. Its distance to the reference
    shows the errors of both meshes, along and through the thickness. With counted steps it also has fewer of them.
    """
    mesh, counted = reference_mesh(scene), counted_steps(scene)
    steps = min(max(FEWEST_STEPS, round(FEWER_STEPS * counted)), counted)
    fewer = size(scene, splines=False).times(SECOND_IN_A_ZONE).override
    if mesh.elements is not None:
        fewer = f"dolfinx.elements={max(mesh.elements // 2, min(2 * mesh.elements // 3, FEW_ELEMENTS), 4)}"
    return (
        f"dolfinx.degree={min(mesh.degree, 2)}",
        fewer,
        f"dolfinx.layers={2 * mesh.layers}",
        'discretization.steps="auto"' if scene.discretization.steps == "auto" else f"discretization.steps={steps}",
    )
