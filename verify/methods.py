"""From a scene to every solver's own input, and back to one kind of result."""

from __future__ import annotations

import sys
from collections.abc import Callable, Mapping
from dataclasses import fields, replace
from importlib.util import find_spec
from types import ModuleType
from typing import TYPE_CHECKING, Any

from verify.effects import simulated
from verify.laws import laws_of, refusal
from verify.refusal import Refusal
from verify.result import Result, Snapshot, steps_from_rows
from verify.schema import Discretization, Pose, Scene
from verify.specimen import Isotropic, Material
from verify.timing import Stopwatch, peak_memory_mb

if TYPE_CHECKING:
    from verify.lefm import LefmProblem

#: name -> what it is, in the words of the report
METHODS: Mapping[str, str] = {
    "tspline": "isogeometric, T-splines",
    "nurbs": "isogeometric, NURBS",
    "lagrange": "isogeometric code, Lagrange basis",
    "dolfinx": "DOLFINx, Lagrange elements",
    "beam": "beam on a cohesive interface",
    "lefm": "linear elastic fracture mechanics",
}
WITH_DOFS = ("tspline", "nurbs", "lagrange")

DOLFINX_MISSING = "not run: DOLFINx is not installed"
DOLFINX_WAYS = (
    "conda: conda install -c conda-forge fenics-dolfinx",
    "Docker: docker run -ti -v $PWD:/work -w /work dolfinx/dolfinx:stable",
    "Debian 13 or Ubuntu: apt install python3-dolfinx-real; as any user, ./debond builds itself a private Debian",
)

#: Steps where the path does not choose them, and the interface points in the process zone from which on it does: with
#: fewer the load goes up and down with each of them, and every wave would need steps of its own.
STEPS, SMOOTH = 150, 8

#: Fractions of the largest opening at which the fields are kept: before and near the peak, under way, at the end.
SNAPSHOT_FRACTIONS = (0.1, 0.2, 0.5, 1.0)

#: Below so many times the least unknowns a specimen with a long precrack or a small opening may have no mesh.
SMALL = 10

OnStep = Callable[[Mapping[str, float]], None]

#: Called with the opening of every converged step and with what makes its frame, see `verify.frames`.
OnFrame = Callable[[float, Callable[[], Mapping[str, Any] | None]], None]


class NotRun(Exception):
    """A method that this machine cannot run; the message says why."""


class Unsuitable(Refusal):
    """A method that cannot solve this scene on any machine."""


def known_methods() -> dict[str, str]:
    """``METHODS``, and those of other packages (`verify.plugins`)."""
    from verify.plugins import plugins

    others = {name: f"plug-in of {plugin.package}" for name, plugin in plugins().items() if name not in METHODS}
    return {**METHODS, **others}


def dolfinx_installed() -> bool:
    """Whether DOLFINx can be imported, without importing it."""
    return find_spec("dolfinx") is not None


def solve(scene: Scene, method: str, on_step: OnStep | None = None, on_frame: OnFrame | None = None) -> Result:
    """Solve a scene by one method.

    Parameters
    ----------
    method : one of ``known_methods``
    on_step : called with every converged row (``verify.result``), the first one zeros, as the run goes
    on_frame : called at every converged step by the methods that have fields

    Raises
    ------
    NotRun, Unsuitable
        Where the method needs what is not installed, or is not made for the scene.

    Notes
    -----
    Timed from the first line of work on: importing a solver is paid once a process, not once a solution.
    """
    require(scene, method)
    if method not in METHODS:
        from verify import plugins

        return plugins.solve(scene, method, on_step or _nothing)
    with_fields = {**dict.fromkeys(WITH_DOFS, _iga), "dolfinx": _dolfinx}
    if method in with_fields:
        return with_fields[method](scene, method, on_step or _nothing, on_frame)
    return {"beam": _beam, "lefm": _lefm}[method](scene, method, on_step or _nothing)


def require(scene: Scene, method: str) -> None:
    """Raise ``Unsuitable`` where the method is not made for the scene, ``NotRun`` where this machine lacks it."""
    if method not in METHODS:
        from verify import plugins

        plugins.require(scene, method)
        return
    other_law = refusal(scene.interface.law, method, laws_of(method), METHODS)
    if other_law:
        raise Unsuitable(other_law)
    if method == "dolfinx":
        _require_elements(scene)
    if method == "dolfinx" and not dolfinx_installed():
        raise NotRun(DOLFINX_MISSING)
    mesh, programme = scene.discretization, scene.load.opening
    if method == "tspline" and mesh.degree != 3:
        raise Unsuitable(f"discretization.degree: must be 3 for tspline, got {mesh.degree}")
    if method == "tspline" and scene.specimen.mesh:
        _given(scene, method)
    least = least_dofs(method, mesh.degree)
    if mesh.dofs < least:
        text = f"must be >= {least} for {method} of degree {mesh.degree}, got {mesh.dofs}"
        raise Unsuitable(f"discretization.dofs: {text}")
    if method in WITH_DOFS and (
        mesh.interface_rule == "lumped" or mesh.adaptive or scene.specimen.kind == "peel" or mesh.dofs < SMALL * least
    ):
        _require_mesh(scene, method)
    if method in ("beam", "lefm") and any(b <= a for a, b in zip((0.0, *programme), programme, strict=False)):
        raise Unsuitable(f"load.opening: must only increase for the method {method}, got {list(programme)}")


def _require_mesh(scene: Scene, method: str) -> None:
    """What only the meshes can tell: whether one is possible at all, and whether lumping finds points one to one."""
    solver, problem = iga_problem(scene, method)
    try:
        solver.build(problem)
    except ValueError as error:
        key = "interface_rule" if str(error).startswith("interface_rule") else "dofs"
        raise Unsuitable(f"discretization.{key}: {str(error).removeprefix('interface_rule ')}") from None


def _require_elements(scene: Scene) -> None:
    """As many elements as the specimen has parts."""
    try:
        dolfinx_problem(scene)
    except ValueError as error:
        raise Unsuitable(f"dolfinx.{error}") from None


def least_dofs(method: str, degree: int) -> int:
    """Unknowns of two elements along and one through each of two arms; 0 for a method without a mesh of that kind.

    A T-spline halves the one on the crack path.
    """
    along = {"tspline": degree + 2, "nurbs": degree + 2, "lagrange": 2 * degree + 1}.get(method, 0)
    return 4 * (degree + 1) * along + 4 * (method == "tspline")


def problem_keys(scene: Scene, method: str) -> dict[str, Any]:
    """What every solver's own ``Problem`` of a dcb calls by the same names: geometry, material, law, load, effects."""
    specimen = scene.specimen
    return {
        "length": specimen.length,
        "arm_thickness": specimen.arm_thickness,
        "precrack": specimen.precrack,
        **elastic_constants(scene.material),
        **_common_keys(scene, method),
        "symmetry": simulated(scene, method)["symmetry"],
        "steps": counted_steps(scene),
    }


def counted_steps(scene: Scene) -> int:
    """Steps for the methods that do not choose their own."""
    steps = scene.discretization.steps
    return STEPS if steps == "auto" else steps


def _common_keys(scene: Scene, method: str) -> dict[str, Any]:
    """What does not depend on the kind of the specimen."""
    specimen, interface, effects = scene.specimen, scene.interface, simulated(scene, method)
    return {
        "width": specimen.width,
        "plane": specimen.plane,
        "strength": interface.strength,
        "toughness": interface.toughness,
        "ductility": interface.ductility,
        "law_name": interface.law,
        "penalty": interface.penalty,
        "contact": effects["contact"],
        "irreversible": effects["irreversible"],
        "opening": scene.load.opening,
        "kinematics": effects["kinematics"],
        "snapshot_openings": tuple(f * max(0.0, *scene.load.opening) for f in SNAPSHOT_FRACTIONS),
    }


def elastic_constants(material: Material) -> dict[str, float]:
    """E1, E2, G12 and nu12, of an isotropic material as well."""
    if isinstance(material, Isotropic):
        young, poisson = material.young, material.poisson
        return {"E1": young, "E2": young, "G12": young / (2 * (1 + poisson)), "nu12": poisson}
    return material.model_dump()


def _peel_keys(scene: Scene, moduli: type) -> dict[str, Any]:
    """Geometry and materials of a peel, as both field solvers call them; ``moduli`` is the solver's own type."""
    materials = {name: moduli(**elastic_constants(getattr(scene, name))) for name in ("strip", "substrate")}
    return scene.specimen.model_dump(exclude={"kind", "width", "plane", "mesh"}) | materials


def _iga_keys(scene: Scene, method: str) -> dict[str, Any]:
    """Mesh, interface rule, steps and pose, as both specimens of ``iga`` call them."""
    mesh, pose = scene.discretization, scene.pose
    return {
        "basis": method,
        "meshes": _given(scene, method),
        "degree": mesh.degree,
        "dofs": mesh.dofs,
        "interface_rule": mesh.interface_rule,
        "interface_points": mesh.interface_points,
        "adaptive": mesh.adaptive,
        "mismatch": mesh.mismatch,
        "slave": mesh.slave,
        "search": simulated(scene, method)["search"],
        "bend": mesh.bend,
        "steps": None if mesh.steps == "auto" else mesh.steps,
        "angle": pose.angle,
        "mirror": pose.mirror,
        "shift": pose.shift,
    }


def _given(scene: Scene, method: str) -> tuple:
    """The meshes of the files that a scene names, for T-splines alone: they are what such files hold."""
    if method != "tspline" or not scene.specimen.mesh:
        return ()
    from verify.given_meshes import given_meshes

    return given_meshes(scene)


def iga_problem(scene: Scene, method: str) -> tuple[ModuleType, Any]:
    """The module of ``iga`` that solves a scene, and the problem that it is given."""
    if scene.specimen.kind == "peel":
        from iga import peel

        keys = _peel_keys(scene, peel.Moduli) | _common_keys(scene, method) | _iga_keys(scene, method)
        return peel, peel.Problem(**_taken(peel.Problem, keys))
    from iga import dcb

    return dcb, dcb.Problem(**_taken(dcb.Problem, problem_keys(scene, method) | _iga_keys(scene, method)))


def _iga(scene: Scene, method: str, on_step: OnStep, on_frame: OnFrame | None) -> Result:
    solver, problem = iga_problem(scene, method)
    if problem.steps is None and not _smooth(scene, method):
        problem = replace(problem, steps=STEPS)
    watch = Stopwatch()
    return _result(method, solver.solve(problem, on_step, watch.phase, on_frame), watch)


def _smooth(scene: Scene, method: str) -> bool:
    """Whether few steps draw the curve: the mesh stays as it is, and many points share the process zone."""
    from verify.process_zone import expected

    mesh = scene.discretization
    return not mesh.adaptive and mesh.interface_points * expected(scene, method).elements >= SMOOTH


def _taken(problem: type, keys: Mapping[str, Any]) -> dict[str, Any]:
    """``keys`` less those that are the scene's defaults and that this solver does not have."""
    plain = {**Discretization().model_dump(), **Pose().model_dump()}
    known = {field.name for field in fields(problem)}
    return {key: value for key, value in keys.items() if key in known or value != plain.get(key)}


def dolfinx_problem(scene: Scene) -> Any:
    """The problem that `fem_reference` is given; DOLFINx itself is not asked for. ValueError where it refuses it."""
    from fem_reference import dcb, peel
    from fem_reference.material import Moduli

    mesh = scene.dolfinx.model_dump()
    if scene.specimen.kind == "peel":
        keys = {**_peel_keys(scene, Moduli), **_common_keys(scene, "dolfinx"), "steps": counted_steps(scene)}
        return peel.Problem(**keys, **mesh)
    return dcb.Problem(**problem_keys(scene, "dolfinx"), **mesh)


def _dolfinx(scene: Scene, method: str, on_step: OnStep, on_frame: OnFrame | None) -> Result:
    problem = dolfinx_problem(scene)
    try:
        from fem_reference.solve import solve_debonding

        watch = Stopwatch()
        solution = solve_debonding(problem, on_step=on_step, phase=watch.phase, on_frame=on_frame)
    except (ImportError, AttributeError, TypeError) as error:
        error.whose = _whose_dolfinx(error)
        raise
    return _result(method, solution, watch)


def _whose_dolfinx(error: Exception) -> str:
    """Whose an error is of a call that another DOLFINx does not have, or not in this way."""
    from verify.doctor import NEWEST, OLDEST, supported

    found = str(getattr(sys.modules.get("dolfinx"), "__version__", ""))
    if not found or supported(found):
        return getattr(error, "whose", "the program: please report it with error.log")
    oldest, newest = (".".join(map(str, numbers)) for numbers in (OLDEST, NEWEST))
    return f"DOLFINx {found}, or for it: debond takes {oldest} to {newest}, see debond doctor"


def _beam(scene: Scene, method: str, on_step: OnStep) -> Result:
    from verify.beam import BeamProblem
    from verify.beam import solve as solve_beam

    watch = Stopwatch()
    problem = BeamProblem(**_known(BeamProblem, _analytical_keys(scene, method)))
    with watch.phase("solve"):
        solution = solve_beam(problem, on_step)
    return _result(method, solution, watch)


def lefm_problem(scene: Scene) -> LefmProblem:
    """What ``verify.lefm`` solves of a scene."""
    from verify.lefm import LefmProblem

    return LefmProblem(**_known(LefmProblem, _analytical_keys(scene, "lefm")))


def _analytical_keys(scene: Scene, method: str) -> dict[str, Any]:
    """What beam and LEFM call by the same names; a strip is an arm, whose precrack is the length that is not bonded."""
    specimen, own = scene.specimen, {}
    if specimen.kind == "peel":
        from verify.layer import Layer

        base = elastic_constants(scene.substrate)
        layer = Layer.of(specimen.substrate_length, specimen.substrate_thickness, plane=specimen.plane, **base)
        own = {"substrate": layer, "arms": 1}
    material = scene.strip if own else scene.material
    constants = elastic_constants(material)
    return {
        **_common_keys(scene, method),
        "length": specimen.extent,
        "arm_thickness": specimen.loaded_thickness,
        "precrack": specimen.free_length,
        "young": axial_modulus(material, specimen.plane),
        "transverse": constants["E2"],
        "shear": constants["G12"],
        "points": counted_steps(scene),
        **own,
    }


def _known(problem: type, keys: Mapping[str, Any]) -> dict[str, Any]:
    """Those of ``keys`` that a problem has."""
    return {field.name: keys[field.name] for field in fields(problem) if field.name in keys}


def _lefm(scene: Scene, method: str, on_step: OnStep) -> Result:
    from verify.lefm import solve as solve_lefm

    watch, problem = Stopwatch(), lefm_problem(scene)
    with watch.phase("solve"):
        try:
            solution = solve_lefm(problem, on_step)
        except ValueError:  # the programme leaves the range of the large-displacement factors
            solution = solve_lefm(replace(problem, theory="elastica"), on_step)
    return Result(
        method=method,
        steps=steps_from_rows(solution.rows),
        status=solution.status,
        ending=solution.ending,
        seconds=watch.seconds(),
        peak_memory_mb=peak_memory_mb(),
    )


def axial_modulus(material: Material, plane: str) -> float:
    """Stiffness against stretching along the arm; in plane strain E1 / (1 - nu13 nu31), E3 = E2 and nu13 = nu12."""
    c = elastic_constants(material)
    return c["E1"] if plane == "stress" else c["E1"] / (1 - c["nu12"] ** 2 * c["E2"] / c["E1"])


def _result(method: str, solution: Any, watch: Stopwatch) -> Result:
    """``solution``: rows, rejected_steps, status, snapshots, as the solvers return them.

    And dofs, elements, ending, condition and nonzeros, from a solver that knows them.
    """
    return Result(
        method=method,
        steps=steps_from_rows(solution.rows),
        status=solution.status,
        ending=getattr(solution, "ending", ""),
        condition=getattr(solution, "condition", 0.0),
        dofs=getattr(solution, "dofs", 0),
        elements=getattr(solution, "elements", 0),
        rejected_steps=solution.rejected_steps,
        snapshots=tuple(Snapshot(**snapshot) for snapshot in solution.snapshots),
        seconds=watch.seconds(),
        peak_memory_mb=peak_memory_mb(),
        nonzeros=getattr(solution, "nonzeros", 0),
        jit_seconds=watch.compile,
    )


def _nothing(row: Mapping[str, float]) -> None:
    """The callback of a caller that does not listen."""
