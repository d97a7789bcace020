"""The isogeometric code as methods: a basis each."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import partial
from types import ModuleType
from typing import Any

from verify.methods.method import Look, MeshFacts, Method, OnFrame, OnStep, Prepared, Unsuitable, result_of
from verify.methods.problems import common_keys, rectangles
from verify.result import Result
from verify.scene.schema import DEFAULT_STEPS, Scene
from verify.support.timing import Stopwatch


@dataclass(frozen=True)
class Looking:
    """When a mesh is made and looked at.

    ``smooth``: interface points in the process zone from which on the path chooses its steps; with fewer the load goes
    up and down with each of them, and every wave would need steps of its own. ``small``: below so many times the least
    unknowns a specimen with a long precrack or a small opening may have no mesh.
    """

    smooth: int = 8
    small: int = 10


LOOKING = Looking()


def iga_problem(scene: Scene, effects: Mapping[str, Any], basis: str) -> tuple[ModuleType, Any]:
    """The module of ``iga`` that solves a scene, and the problem that it is given."""
    from iga.delamination import solution
    from iga.delamination.problem import Problem
    from iga.specimen.layout import Clamp, Load, Moduli, Rectangle

    specimen, mesh = scene.specimen, scene.discretization
    upper, lower = rectangles(scene, Rectangle, Moduli)
    keys = {
        **common_keys(scene, effects),
        **mesh.model_dump(),
        **scene.pose.model_dump(),
        "loads": tuple(Load(*load) for load in specimen.loads),
        "clamps": tuple(Clamp(*clamp) for clamp in specimen.clamps),
        "symmetry": effects["symmetry"],
        "search": effects["search"],
        "basis": basis,
        "meshes": _given(scene, basis),
        "steps": None if mesh.steps == "auto" else mesh.steps,
    }
    return solution, Problem(bodies=(upper, lower), bonded=specimen.bonded, **keys)


def _given(scene: Scene, basis: str) -> tuple[Any, ...]:
    """The meshes of the files that a scene names, for T-splines alone: they are what such files hold."""
    if basis != TSPLINE.name or not scene.specimen.mesh:
        return ()
    from verify.methods.given_meshes import given_meshes

    return given_meshes(scene)


def mesh_facts(prepared: Prepared) -> MeshFacts:
    """Of the mesh that the solver makes; coarse ones are quadratic through the arms, T-splines are graded there."""
    from iga.specimen.specimen import element_length

    solver, problem = prepared.problem
    specimen = solver.build(problem)
    degree = min(min(block.degrees) for mesh in specimen.meshes for block in mesh.blocks)
    return MeshFacts(element_length(specimen), degree, 0 if prepared.method is TSPLINE else 1)


def solve(prepared: Prepared, on_step: OnStep, on_frame: OnFrame | None) -> Result:
    """The path of a scene; steps are counted where too few interface points share the process zone to choose them."""
    solver, problem = prepared.problem
    if problem.steps is None and not _smooth(prepared):
        problem = replace(problem, steps=DEFAULT_STEPS)
    watch = Stopwatch()
    return result_of(prepared.method.name, solver.solve(problem, on_step, watch.phase, on_frame), watch)


def _smooth(prepared: Prepared) -> bool:
    """Whether few steps draw the curve: the mesh stays as it is, and many points share the process zone."""
    mesh = prepared.scene.discretization
    return not mesh.adaptive and mesh.interface_points * prepared.zone.elements >= LOOKING.smooth


def require(prepared: Prepared) -> None:
    """Raise Unsuitable for a degree that the basis does not have, and where no mesh of the unknowns can be made."""
    scene, name = prepared.scene, prepared.method.name
    mesh = scene.discretization
    if name == TSPLINE.name and mesh.degree != 3:
        raise Unsuitable(f"discretization.degree: must be 3 for tspline, got {mesh.degree}")
    least = least_dofs(name, mesh.degree)
    if mesh.dofs < least:
        text = f"must be >= {least} for {name} of degree {mesh.degree}, got {mesh.dofs}"
        raise Unsuitable(f"discretization.dofs: {text}")
    lumped = mesh.interface_rule == "lumped"  # whose points must find each other one to one
    if lumped or mesh.adaptive or not scene.specimen.symmetric or mesh.dofs < LOOKING.small * least:
        _require_mesh(prepared)


def _require_mesh(prepared: Prepared) -> None:
    try:
        assert prepared.mesh is not None
    except ValueError as error:
        key = "interface_rule" if str(error).startswith("interface_rule") else "dofs"
        raise Unsuitable(f"discretization.{key}: {str(error).removeprefix('interface_rule ')}") from None


def least_dofs(basis: str, degree: int) -> int:
    """Unknowns of two elements along and one through each of two arms; T-splines halve the one on the crack path."""
    along = 2 * degree + 1 if basis == LAGRANGE.name else degree + 2
    return 4 * (degree + 1) * along + 4 * (basis == TSPLINE.name)


def _laws() -> tuple[str, ...]:
    from iga.interface.laws import LAWS

    return tuple(LAWS)


def _basis(name: str, **own: Any) -> Method:
    """The method of a basis: what all have, and what is its own."""
    return Method(
        name=name,
        solve=solve,
        problem=partial(iga_problem, basis=name),
        mesh=mesh_facts,
        require=require,
        laws=_laws,
        code="iga",
        packages=("iga",),
        with_dofs=True,
        per_step=0.01,
        **own,
    )


TSPLINE = _basis(
    "tspline",
    label="T-spline",
    what="isogeometric, T-splines",
    takes_files=True,
    look=Look(("#4b3fa0", "#b0a5ff"), 1.2, (), 1.0, 4.2, place=2),
)
NURBS = _basis(
    "nurbs",
    label="NURBS",
    what="isogeometric, NURBS",
    look=Look(("#0072b2", "#5bb8f0"), 1.2, (), 1.0, 4.0, place=1),
)
# Its elements are three times longer at equal unknowns, with about three of them in the process zone: J is 1.0 to 1.9 %
# off on the packaged scenes, by the mesh and not by the solver.
LAGRANGE = _basis(
    "lagrange",
    label="Lagrange",
    what="isogeometric code, Lagrange basis",
    mesh_error=0.02,
    look=Look(("#bf5400", "#ff9a52"), 1.1, (5.0, 2.0), 1.0, 3.8, place=3),
)
