"""The isogeometric code as methods: one for each basis that it has."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from types import ModuleType
from typing import Any

from iga.bases.basis import Basis
from iga.bases.names import BASES
from verify.methods.bonds import iga_law
from verify.methods.mesh_choice import spline_mesh
from verify.methods.method import Look, MeshFacts, Method, OnFrame, OnStep, Prepared, Unsuitable, result_of
from verify.methods.problems import common_keys, rectangles
from verify.result import Result
from verify.scene.bond.bond import bond_of
from verify.scene.effects import mirrored_solid
from verify.scene.schema import DEFAULT_STEPS, Scene, bend
from verify.support.timing import Stopwatch

#: Interface points in the process zone from which on the path chooses its steps. With fewer the load oscillates with
#: each point, and every oscillation would need steps of its own.
SMOOTH_POINTS = 8
#: With fewer unknowns than this times the least number a specimen with a long precrack or a small opening may have no
#: mesh, so that a mesh is made to find out.
SMALL_MESH = 10

#: Keys of ``[discretization]`` that the solver takes as they are.
_MESH_KEYS = ("degree", "interface_rule", "mismatch", "adaptive", "slave")


def _given(scene: Scene, basis: str) -> tuple[Any, ...]:
    """The meshes of the files that a scene names, if the basis takes them."""
    if not scene.specimen.mesh:
        return ()
    from verify.methods.given_meshes import file_kind, given_meshes

    return given_meshes(scene) if file_kind(scene) in _files(BASES[basis]) else ()


def iga_problem(scene: Scene, effects: Mapping[str, Any], basis: str) -> tuple[ModuleType, Any]:
    """The module of ``iga`` that solves a scene, and the problem for it."""
    from iga.delamination import solution
    from iga.delamination.problem import Problem
    from iga.specimen.layout import Clamp, Load, Moduli, Rectangle, Support

    specimen, mesh, of = scene.specimen, scene.discretization, BASES[basis]
    chosen = spline_mesh(scene, of.in_a_zone, of.in_fading)
    keys = {
        **common_keys(scene, effects),
        **{key: getattr(mesh, key) for key in _MESH_KEYS},
        **({"element": chosen.element} if chosen.dofs is None else {"dofs": chosen.dofs}),
        **scene.pose.model_dump(),
    }
    across: dict[str, Any] = {}
    if specimen.plane == "solid":
        number = mesh.elements_width
        across = {"lateral": specimen.lateral, "elements_width": None if number == "auto" else number}
    return solution, Problem(
        bodies=rectangles(scene, Rectangle, Moduli),
        bonded=specimen.bonded,
        bond=iga_law(bond_of(scene, effects)),
        loads=tuple(Load(*load) for load in specimen.loads),
        clamps=tuple(Clamp(*clamp) for clamp in specimen.clamps),
        supports=tuple(Support(*support) for support in specimen.supports),
        loaded_at=specimen.loaded_at if specimen.slides else None,
        layers=chosen.layers,
        interface_points=chosen.points,
        symmetry=effects["symmetry"],
        search=effects["search"],
        basis=basis,
        meshes=_given(scene, basis),
        **across,
        bend=bend(scene),
        steps=None if mesh.steps == "auto" else mesh.steps,
        **keys,
    )


def mesh_facts(prepared: Prepared) -> MeshFacts:
    """Facts of the solver's mesh: coarse ones are quadratic through the arms, T-meshes are graded there."""
    from iga.specimen.solid import functions_across
    from iga.specimen.specimen import element_length

    solver, problem = prepared.problem
    specimen = solver.build(problem)
    degree = min(min(block.degrees) for mesh in specimen.meshes for block in mesh.blocks)
    layers = 0 if BASES[prepared.method.name].local else problem.layers
    across = functions_across(problem) if problem.solid else 1
    return MeshFacts(element_length(specimen), degree, layers, specimen.system.n_dof, across)


def solve(prepared: Prepared, on_step: OnStep, on_frame: OnFrame | None) -> Result:
    """Solve a scene; a fixed number of steps is used where they cannot be chosen by accuracy."""
    solver, problem = prepared.problem
    if prepared.counted:
        problem = replace(problem, steps=DEFAULT_STEPS)
    watch = Stopwatch()
    return result_of(prepared.method.name, solver.solve(problem, on_step, watch.phase, on_frame), watch)


def counts(prepared: Prepared) -> str:
    """Why steps cannot be chosen by accuracy; empty where they can."""
    mesh, bond = prepared.scene.discretization, prepared.scene.interface
    if mesh.adaptive:
        return "elements follow the process zone"
    if prepared.effects["shear"] and (bond.viscosity or bond.friction):
        return "points stick and slip one after the other" if bond.friction else "damage follows in time"
    points = spline_mesh(prepared.scene).points * prepared.zone.elements
    if points >= SMOOTH_POINTS:
        return ""
    return f"{points:.1f} interface points share the process zone, and steps by accuracy take {SMOOTH_POINTS}"


def require(prepared: Prepared) -> None:
    """Raise Unsuitable for a degree that the basis does not have, and where no mesh with these unknowns can be made."""
    scene, name = prepared.scene, prepared.method.name
    basis, mesh = BASES[name], scene.discretization
    if mesh.degree not in basis.degrees:
        degrees = " or ".join(map(str, basis.degrees))
        raise Unsuitable(f"discretization.degree: must be {degrees} for {name}, got {mesh.degree}")
    least = basis.least_dofs(mesh.degree)
    if mesh.dofs != "auto" and mesh.dofs < least:
        text = f"must be >= {least} for {name} of degree {mesh.degree}, got {mesh.dofs}"
        raise Unsuitable(f"discretization.dofs: {text}")
    lumped = mesh.interface_rule == "lumped"  # which needs meshes that match one to one
    small = mesh.dofs != "auto" and mesh.dofs < SMALL_MESH * least
    if mesh.dofs == "auto" or lumped or mesh.adaptive or not scene.specimen.symmetric or small:
        try:
            assert prepared.mesh is not None
        except ValueError as error:
            key = "interface_rule" if str(error).startswith("interface_rule") else "dofs"
            raise Unsuitable(f"discretization.{key}: {str(error).removeprefix('interface_rule ')}") from None


def _files(basis: Basis) -> tuple[str, ...]:
    """The mesh files that hold elements of a basis."""
    return ("iga",) if basis.local else ("nodal",) if basis.name == "lagrange" else ()


def _laws() -> tuple[str, ...]:
    from iga.laws.laws import LAWS

    return tuple(LAWS)


#: Colours of bases that have none of their own, on a light and on a dark page.
SPARE = (("#6b5d00", "#d6c34a"), ("#006d77", "#63cdd6"), ("#7d4427", "#d9a283"))


def _method(number: int, basis: Basis) -> Method:
    """The method of a basis; ``number`` is its place among all of them."""
    colours = basis.colours or SPARE[number % len(SPARE)]
    line = Look(colours, 1.1 if basis.dashes else 1.2, basis.dashes, 1.0, 4.2 - 0.2 * number, basis.row)
    return Method(
        name=basis.name,
        label=basis.label,
        what=basis.what,
        solve=solve,
        problem=partial(iga_problem, basis=basis.name),
        mesh=mesh_facts,
        require=require,
        counts=counts,
        laws=_laws,
        fixed=lambda scene: {"symmetry": True} if mirrored_solid(scene) else {},  # a quarter of two equal arms
        code="iga",
        packages=("iga",),
        with_dofs=True,
        takes_files=_files(basis),
        solids=basis.name == "nurbs",
        mesh_error=basis.mesh_error,
        place=number,
        besides=0.5,
        per_step=0.014,
        look=line,
    )


OF_BASES = tuple(_method(number, basis) for number, basis in enumerate(BASES.values()))
