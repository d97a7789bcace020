"""The DOLFINx model as a method."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from verify.meshes.arms import given_arms
from verify.meshes.joined import joined, require_patch_ends
from verify.methods import dolfinx
from verify.methods.bonds import modelled_law
from verify.methods.mesh_choice import crossed, longest
from verify.methods.method import (
    Failure,
    Look,
    MeshFacts,
    Method,
    OnFrame,
    OnStep,
    Prepared,
    Unsuitable,
    result_of,
)
from verify.methods.problems import common_keys, rectangles
from verify.methods.reference_mesh import ReferenceMesh, elements_across, reference_mesh
from verify.result import Result
from verify.scene.bond.bond import bond_of
from verify.scene.effects import mirrored_solid
from verify.scene.schema import Scene, bend
from verify.support.refusal import NotRun
from verify.support.timing import Stopwatch


def dolfinx_problem(scene: Scene, effects: Mapping[str, Any]) -> Any:
    """The problem that `fem_reference` is given; DOLFINx itself is not needed.

    Raises
    ------
    Unsuitable : fewer elements than the specimen has parts, no node where the load is, or unequal arms that turn far.
    """
    from fem_reference.problem.delamination import Problem
    from fem_reference.problem.material import Moduli, Rectangle

    mesh, bond = _mesh(scene), bond_of(scene, effects)
    across: dict[str, Any] = {}
    if scene.specimen.plane == "solid":
        across = {"n_Z": elements_across(scene), "width_held": scene.specimen.lateral == "held"}
    along: dict[str, Any] = {"elements": mesh.elements}
    if mesh.elements is None:
        along = {"element": mesh.element, "fine": crossed(scene), "longest": longest(scene)}
    try:
        return Problem(
            bodies=rectangles(scene, Rectangle, Moduli),
            bonded=scene.specimen.bonded,
            bond=modelled_law(bond),
            on_base=scene.specimen.clamped,
            **common_keys(scene, effects),
            **_on_patches(scene, bond.slides),
            **across,
            steps=None if scene.discretization.steps == "auto" else scene.discretization.steps,
            bend=bend(scene),
            degree=mesh.degree,
            **along,
            layers=mesh.layers,
            interface_points=None if scene.dolfinx.interface_points == "auto" else scene.dolfinx.interface_points,
            cells=_given(scene),
        )
    except ValueError as error:
        table = "effects" if str(error).startswith("kinematics") else "dolfinx"
        raise Unsuitable(f"{table}.{error}") from None


def _mesh(scene: Scene) -> ReferenceMesh:
    """The mesh that a scene asks for; the degree of elements from a file is their own, unless it asks for another."""
    if not scene.specimen.nodal or scene.dolfinx.degree != "auto":
        return reference_mesh(scene)
    asked = {"degree": given_arms(scene)[0].degree}
    return reference_mesh(scene.model_copy(update={"dolfinx": scene.dolfinx.model_copy(update=asked)}))


def _given(scene: Scene) -> Any:
    """The elements of the mesh file of a scene, as one mesh on which the arms share the nodes of the interface."""
    if not scene.specimen.nodal:
        return None
    from fem_reference.problem.specimen import Cells

    arms = given_arms(scene)
    try:
        require_patch_ends(arms, scene.specimen)
        return Cells(*joined(arms))
    except ValueError as error:
        raise Unsuitable(f"specimen.mesh: {scene.specimen.mesh[0]}: {error} (method lagrange takes them)") from None


def _on_patches(scene: Scene, slides: bool) -> dict[str, Any]:
    """Loads and supports of arms whose bond slides; empty where it only opens, and for a strip."""
    from fem_reference.problem.loads import Load, Support

    specimen = scene.specimen
    if not slides or specimen.clamped:
        return {}
    return {
        "loads": tuple(Load(*load) for load in specimen.loads),
        "supports": tuple(Support(*support) for support in specimen.supports),
        "loaded_at": specimen.loaded_at,
    }


def mesh_facts(prepared: Prepared) -> MeshFacts:
    mesh, problem = _mesh(prepared.scene), prepared.problem
    made = problem.specimen()
    met = made.bond_elements if problem.element is None else made.elements_within(problem.fine)
    lines = (np.count_nonzero(made.X <= body.length + made.near) - 1 for body in made.bodies)
    through = (len(body.Y) - 1 for body in made.bodies)
    nodes = sum((mesh.degree * n + 1) * (mesh.degree * m + 1) for n, m in zip(lines, through, strict=True))
    across = mesh.degree * problem.n_Z + 1 if problem.solid else 1
    unknowns = made.dim * nodes * across
    return MeshFacts(float(np.max(met, initial=0.0)), mesh.degree, mesh.layers, unknowns, across)


def require(prepared: Prepared) -> None:
    """Raise Unsuitable where the problem is refused, NotRun where DOLFINx is not installed."""
    assert prepared.problem is not None
    if not dolfinx.dolfinx_installed():
        raise NotRun(dolfinx.DOLFINX_MISSING, dolfinx.DOLFINX_WAYS)


def solve(prepared: Prepared, on_step: OnStep, on_frame: OnFrame | None) -> Result:
    problem = prepared.problem
    try:
        from fem_reference.solve import solve_debonding

        watch = Stopwatch()
        solution = solve_debonding(problem, on_step=on_step, phase=watch.phase, on_frame=on_frame)
    except (ImportError, AttributeError, TypeError) as error:
        whose = dolfinx.another_dolfinx()
        if not whose:
            raise
        raise Failure(f"{type(error).__name__}: {error}", whose) from error
    return result_of(prepared.method.name, solution, watch)


def counts(prepared: Prepared) -> str:
    """Why the path cannot choose its steps; empty where it can."""
    return "damage follows in time" if prepared.effects["shear"] and prepared.scene.interface.viscosity else ""


def _laws() -> tuple[str, ...]:
    from fem_reference.problem.law import MODELLED_LAWS

    return tuple(MODELLED_LAWS)


DOLFINX = Method(
    name="dolfinx",
    label="DOLFINx",
    what="DOLFINx, Lagrange elements",
    solve=solve,
    problem=dolfinx_problem,
    mesh=mesh_facts,
    require=require,
    laws=_laws,
    fixed=lambda scene: {"symmetry": mirrored_solid(scene), "search": False},  # points keep their initial pairs
    code="dolfinx",
    counts=counts,
    packages=("fem_reference",),
    ranks=True,
    solids=True,
    takes_files=("nodal",),
    # All runs share a cache of compiled forms: the second to compile the same form would wait for the first, and give
    # up after ten seconds.
    lane="dolfinx",
    besides=1.0,
    per_step=0.008,
    place=100,
    look=Look(("#00805e", "#3dd1a5"), 3.4, (), 0.5, 2.0, place=0),
)
