"""Second runs of a scene, whose distance to the first shows the error of the mesh; and what makes that error smaller.

Pressed faces of arms touch at their loaded end, where the load is carried through the thickness: one element of NURBS
through an arm is off by 0.2 to 2 % of that load, and no J-integral shows it.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from math import ceil, isfinite

from verify.methods.mesh_choice import spline_mesh
from verify.methods.reference_mesh import reference_mesh, second_mesh
from verify.scene.schema import MOST_THROUGH, Scene

#: Methods with second runs, and the names of these.
SECONDS: Mapping[str, str] = {"dolfinx": "dolfinx-second", "nurbs": "nurbs-second"}
#: NURBS with one layer, as coarse as a T-mesh, which has no more layers than its unknowns allow.
SINGLE = "nurbs-single"
#: Error of a mesh over its distance to one with twice as many layers, where the error falls with the layers or faster.
FIRST_ORDER = 2.0


def second_runs(scene: Scene) -> Iterator[tuple[str, str, tuple[str, ...]]]:
    """Method, name and overrides: of DOLFINx on every scene, of NURBS where faces of arms are pressed together.

    NURBS have twice as many layers of elements as long as before, half as many where there are no more.
    """
    yield "dolfinx", SECONDS["dolfinx"], second_mesh(scene)
    if not presses(scene):
        return
    layers = spline_mesh(scene).layers
    yield "nurbs", SECONDS["nurbs"], through(scene, 2 * layers if 2 * layers <= MOST_THROUGH else layers // 2)
    if layers > 1:
        yield "nurbs", SINGLE, through(scene, 1)


def presses(scene: Scene) -> bool:
    """Whether a programme presses two free arms together whose meshes are not given."""
    body = scene.specimen
    return min(scene.load.opening) < 0.0 and not (body.supports or body.clamped or body.mesh)


def through(scene: Scene, layers: int) -> tuple[str, ...]:
    """So many layers of elements as long as before."""
    degree, mesh = scene.discretization.degree, spline_mesh(scene)
    more = () if mesh.dofs is None else (round(mesh.dofs * (layers + degree) / (mesh.layers + degree)),)
    return (f"discretization.layers={layers}", *(f"discretization.dofs={dofs}" for dofs in more))


def remedy(scene: Scene, method: str, part: float) -> str:
    """What makes the error of a mesh smaller by a factor, through the thickness where that is finite."""
    if method == "dolfinx" and isfinite(part):
        return f"dolfinx.layers = {ceil(part * reference_mesh(scene).layers)} resolves it"
    if method == "dolfinx":
        return "larger dolfinx.elements, dolfinx.layers or dolfinx.degree resolve it"
    now = 1 if method == "tspline" else spline_mesh(scene).layers
    layers = ceil(min(part * now, MOST_THROUGH))
    finer = " and ".join(through(scene, layers)).replace("=", " = ")
    return f"NURBS with {finer} judge in its place" if method == "tspline" else f"{finer} resolve it"
