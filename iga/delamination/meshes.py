"""The meshes of a specimen: given ones, those that follow the process zone, or those of the basis."""

from __future__ import annotations

from dataclasses import replace

from iga.bases.names import find
from iga.delamination import arms, on_base
from iga.delamination.adaptive import Window, adapted_tmeshes, first_window
from iga.delamination.given import given
from iga.mesh.extraction import Mesh
from iga.specimen.problem import Debonding
from iga.specimen.solid import functions_across
from iga.specimen.specimen import Drawn
from iga.tsplines.tmesh import TMesh
from iga.tsplines.tspline import tspline_rectangle


def drawn(problem: Debonding, window: Window | None = None) -> Drawn:
    """Meshes of the modelled bodies; ``window`` is the fine part of an adaptive mesh, the first one if left out.

    Raises
    ------
    ValueError : no mesh has so few unknowns, this degree or this layout, the basis is unknown, or given meshes are not
        those of the specimen.
    """
    layout, modelled = problem.layout, slice(1 if problem.symmetry else 2)
    far_end = abs(layout.bonded[1] - layout.loaded_at)
    if problem.meshes:
        return Drawn(given(problem), (), far_end)
    if follows(problem):
        window = window or first_window(problem)
        return _of_tmeshes(adapted_tmeshes(problem, window)[modelled], window.end)
    free = not layout.clamps
    if problem.solid and problem.element is None:  # unknowns of the plane, of which a solid has one mesh for each row
        problem = replace(problem, dofs=2 * problem.dofs // (3 * functions_across(problem)))
    path_end = arms.crack_path(problem) if free else far_end
    if find(problem.basis).local:
        tmeshes: tuple[TMesh, ...] = arms.tmeshes(problem) if free else on_base.tmeshes(problem)
        return _of_tmeshes(tmeshes[modelled], path_end)
    meshes: tuple[Mesh, ...] = arms.rectangles(problem) if free else on_base.rectangles(problem)
    return Drawn(meshes[modelled], (), path_end)


def follows(problem: Debonding) -> bool:
    """Whether the mesh follows the process zone."""
    return problem.adaptive and find(problem.basis).local and not problem.meshes


def _of_tmeshes(tmeshes: tuple[TMesh, ...], path_end: float) -> Drawn:
    return Drawn(tuple(tspline_rectangle(mesh) for mesh in tmeshes), tmeshes, path_end)
