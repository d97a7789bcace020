"""Solve a scene by a method: prepared, refused where the method is not made for it, solved."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from verify.methods.method import OnFrame, OnStep, Prepared
from verify.methods.names import refuse_arms, refuse_law
from verify.methods.plugins import find
from verify.methods.sliding import refuse_sliding
from verify.result import Result
from verify.scene.load import load_scene
from verify.scene.schema import Scene


def prepare(scene: Scene | str | Path, method: str) -> Prepared:
    """A scene, or that of a name or a file, for the method of a name; nothing is made before it is needed."""
    return Prepared(load_scene(scene) if isinstance(scene, str | Path) else scene, find(method))


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
    return prepared.method.solve(prepared, on_step or _nothing, on_frame)


def require(prepared: Prepared) -> None:
    """Raise ``Unsuitable`` where the method is not made for the scene, ``NotRun`` where this machine lacks it."""
    scene, method = prepared.scene, prepared.method
    if scene.specimen.mesh:
        from verify.methods.given_meshes import file_kind, given_meshes, refuse_files

        given_meshes(scene) if file_kind(scene) in method.takes_files else refuse_files(scene, method.name)
    refuse_law(scene, method.name, method.laws())
    refuse_sliding(prepared)
    refuse_arms(scene, method)
    method.require(prepared)


def _nothing(row: Mapping[str, float]) -> None:
    """The callback of a caller that does not listen."""
