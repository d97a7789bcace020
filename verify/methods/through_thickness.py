"""Whether a mesh resolves an arm, or a strip, through its thickness: elements along it do not make up for that."""

from __future__ import annotations

from verify.methods.names import WITH_DOFS
from verify.methods.problems import iga_problem
from verify.methods.reference_mesh import ReferenceMesh, reference_mesh, thickness_error
from verify.scene.schema import Scene

#: Error of the load curve from the mesh through the thickness beyond which it is named: the tolerance between codes.
NAMED = 0.005


def warnings(scene: Scene, method: str) -> tuple[str, ...]:
    """What to say before a run whose elements are too few through the thickness, with what to do; or nothing."""
    if thickness_error(scene, 2, 1) <= NAMED or scene.specimen.mesh:
        return ()
    mesh = _mesh(scene, method)
    error = thickness_error(scene, min(mesh.degree, 4), mesh.layers) if mesh is not None else 0.0
    if mesh is None or error <= NAMED:
        return ()
    body = "strip" if scene.specimen.kind == "peel" else "arm"
    there = f"{mesh.layers} element{'s' * (mesh.layers > 1)} of degree {mesh.degree} through the {body}"
    finer = "discretization.dofs larger" if scene.discretization.degree > 2 else "discretization.degree = 3"
    remedy = "dolfinx.layers or dolfinx.degree larger" if method == "dolfinx" else finer
    return (f"{there}: the load may be off by {error:.1%}, however many elements along it; {remedy} resolves it",)


def degree_through(scene: Scene, method: str) -> int:
    """Lowest degree of the elements of ``iga`` in any direction: coarse meshes are quadratic through the arms."""
    solver, problem = iga_problem(scene, method)
    return min(min(block.degrees) for mesh in solver.build(problem).meshes for block in mesh.blocks)


def _mesh(scene: Scene, method: str) -> ReferenceMesh | None:
    """Degree and layers through the thickness; T-splines halve their elements towards the bond and have enough."""
    if method == "dolfinx":
        return reference_mesh(scene)
    if method not in WITH_DOFS or method == "tspline":
        return None
    try:
        return ReferenceMesh(degree_through(scene, method), 1, 1)
    except ValueError:  # of which another sentence tells
        return None
