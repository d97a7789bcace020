"""The solvers by name: whether one is made for a scene, its run, and one kind of result from each."""

from __future__ import annotations

import sys
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from verify.methods.dolfinx import DOLFINX_MISSING, dolfinx_installed
from verify.methods.names import METHODS, WITH_DOFS, NotRun, OnFrame, OnStep, Unsuitable
from verify.methods.problems import beam_problem, dolfinx_problem, iga_problem, lefm_problem
from verify.result import Result, Snapshot, steps_from_rows
from verify.scene.laws import laws_of, refusal
from verify.scene.schema import STEPS, Scene
from verify.support.timing import Stopwatch, peak_memory_mb

#: Interface points in the process zone from which on the path chooses its steps: with fewer the load goes up and down
#: with each of them, and every wave would need steps of its own.
SMOOTH = 8

#: Below so many times the least unknowns a specimen with a long precrack or a small opening may have no mesh.
SMALL = 10


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
        from verify.methods import plugins

        return plugins.solve(scene, method, on_step or _nothing)
    with_fields = {**dict.fromkeys(WITH_DOFS, _iga), "dolfinx": _dolfinx}
    if method in with_fields:
        return with_fields[method](scene, method, on_step or _nothing, on_frame)
    return {"beam": _beam, "lefm": _lefm}[method](scene, method, on_step or _nothing)


def require(scene: Scene, method: str) -> None:
    """Raise ``Unsuitable`` where the method is not made for the scene, ``NotRun`` where this machine lacks it."""
    if scene.specimen.mesh:
        _require_files(scene, method)
    if method not in METHODS:
        from verify.methods import plugins

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


def _require_files(scene: Scene, method: str) -> None:
    """Mesh files that are those of the specimen, and a method that takes files; a plug-in may."""
    from verify.methods import given_meshes

    if method in METHODS and method != given_meshes.METHOD:
        given_meshes.refuse_files(scene, method)
    given_meshes.given_meshes(scene)


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


def _iga(scene: Scene, method: str, on_step: OnStep, on_frame: OnFrame | None) -> Result:
    solver, problem = iga_problem(scene, method)
    if problem.steps is None and not _smooth(scene, method):
        problem = replace(problem, steps=STEPS)
    watch = Stopwatch()
    return _result(method, solver.solve(problem, on_step, watch.phase, on_frame), watch)


def _smooth(scene: Scene, method: str) -> bool:
    """Whether few steps draw the curve: the mesh stays as it is, and many points share the process zone."""
    from verify.methods.zone_resolution import expected

    mesh = scene.discretization
    return not mesh.adaptive and mesh.interface_points * expected(scene, method).elements >= SMOOTH


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
    from verify.methods.dolfinx import NEWEST, OLDEST, supported

    found = str(getattr(sys.modules.get("dolfinx"), "__version__", ""))
    if not found or supported(found):
        return getattr(error, "whose", "the program: please report it with error.log")
    oldest, newest = (".".join(map(str, numbers)) for numbers in (OLDEST, NEWEST))
    return f"DOLFINx {found}, or for it: debond takes {oldest} to {newest}, see debond doctor"


def _beam(scene: Scene, method: str, on_step: OnStep) -> Result:
    from verify.theory.beam.solve import solve as solve_beam

    watch = Stopwatch()
    problem = beam_problem(scene)
    with watch.phase("solve"):
        solution = solve_beam(problem, on_step)
    return _result(method, solution, watch)


def _lefm(scene: Scene, method: str, on_step: OnStep) -> Result:
    from verify.theory.lefm import solve as solve_lefm

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
