"""Solve a scene by a method: prepared, refused where the method is not made for it, solved."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from verify.methods.method import Method, OnFrame, OnStep, Prepared, Unsuitable
from verify.methods.names import METHODS
from verify.methods.plugins import find
from verify.result import Result
from verify.scene.laws import mixed
from verify.scene.load import load_scene
from verify.scene.schema import Scene
from verify.support.refusal import one_of


def prepare(
    scene: Scene | str | Path, method: str, revised: Callable[[Any], Any] = lambda problem: problem
) -> Prepared:
    """A scene, or that of a name or a file, for the method of a name; nothing is made before it is needed.

    ``revised`` makes of the problem that the scene states, in the solver's own terms, the one that is solved.
    """
    return Prepared(load_scene(scene) if isinstance(scene, str | Path) else scene, find(method), revised)


def solve(
    scene: Scene | str | Path, method: str, on_step: OnStep | None = None, on_frame: OnFrame | None = None
) -> Result:
    """Solve a scene by one method.

    Parameters
    ----------
    scene : or its packaged name, or its file
    method : one of ``known_methods``
    on_step : called with every converged row (``verify.result``), the first one zeros, as the run goes
    on_frame : called at every converged step by the methods that have fields

    Raises
    ------
    NotRun, Unsuitable
        Where the method needs what is not installed, or is not made for the scene.

    Notes
    -----
    The time of a run does not include importing the solver, which is done once per process.
    """
    return solve_prepared(prepare(scene, method), on_step, on_frame)


def solve_prepared(prepared: Prepared, on_step: OnStep | None = None, on_frame: OnFrame | None = None) -> Result:
    """Solve a prepared scene by its method; parameters and refusals as those of `solve`."""
    require(prepared)
    return prepared.method.solve(prepared, on_step or (lambda row: None), on_frame)


def require(prepared: Prepared) -> None:
    """Raise ``Unsuitable`` where the method is not made for the scene, ``NotRun`` where this machine lacks it."""
    scene, method = prepared.scene, prepared.method
    if scene.specimen.mesh:
        from verify.methods.given_meshes import file_kind, given_meshes, refuse_files

        given_meshes(scene) if file_kind(scene) in method.takes_files else refuse_files(scene, method.name)
    for why in _refusals(prepared):
        raise Unsuitable(why)
    method.require(prepared)


def _refusals(prepared: Prepared) -> Iterator[str]:
    """Why a method does not have the law of a scene, its solid or its unequal arms, and which methods do."""
    method, bond, specimen = prepared.method, prepared.scene.interface, prepared.scene.specimen
    if bond.law not in method.laws():
        able = _able(lambda other: bond.law in other.laws())
        yield f"interface.law: must be {one_of(method.laws())} for {method.name}, got {bond.law!r}; {able}"
    if prepared.effects["shear"] and bond.law not in mixed():
        yield f"interface.law: must be {one_of(mixed())} where it slides, got {bond.law!r}"
    if specimen.plane == "solid" and not method.solids:
        able = _able(lambda other: other.solids)
        yield f'specimen.plane: must be "stress" or "strain" for a plane method, got "solid"; {able}'
    # where the bond slides the method itself refuses unequal arms
    if method.equal_arms and specimen.arms == 2 and not specimen.symmetric and not specimen.slides:
        able = _able(lambda other: not other.equal_arms)
        yield f"specimen: must have equal arms for {method.name}, got kind {specimen.kind!r}; {able}"


def _able(has: Callable[[Method], bool]) -> str:
    """Words that name the built-in methods which have what another one lacks."""
    *head, last = [name for name, method in METHODS.items() if has(method)]
    return f"{', '.join(head)} and {last} have it" if head else f"{last} has it"
