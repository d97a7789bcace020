"""Bodies of a scene from mesh files, compared with the specimen that the scene describes."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from iga.delamination.given import misfit
from iga.files.cad_body import body_mesh
from iga.files.nodal_body import nodal_body
from iga.mesh.extraction import Mesh
from iga.mesh.mirror import upside_down
from verify.meshes.arms import given_arms
from verify.scene.schema import Scene
from verify.scene.specimens.delamination import Clamp, Load, Support
from verify.support.refusal import Refusal, one_of

#: The methods that solve on meshes from files, by what these hold.
ON_FILES = {"iga": ("tspline",), "nodal": ("lagrange", "dolfinx")}

#: The override with which a method generates its own mesh for a scene that names files.
OWN = "specimen.mesh=[]"


def file_kind(scene: Scene) -> str:
    """What the mesh files of a scene hold: "iga" (splines), "nodal" (elements of other programs), or no files."""
    return "nodal" if scene.specimen.nodal else "iga" if scene.specimen.mesh else ""


def own_mesh(scene: Scene) -> Scene:
    """The scene without its mesh files, that is, with the override `OWN`."""
    return scene.model_copy(update={"specimen": scene.specimen.model_copy(update={"mesh": ()})})


def refuse_files(scene: Scene, who: str) -> None:
    """Raise Refusal where a scene names mesh files and ``who``, a method or a command, takes none."""
    if scene.specimen.mesh:
        for name in scene.specimen.mesh if file_kind(scene) == "nodal" else ():
            known_ending(name)
        able = " and ".join(ON_FILES[file_kind(scene)])
        text = f"must be left out (--set {OWN}) for {who}, which takes no mesh files of this kind; {able} can"
        raise Refusal(f"specimen.mesh: {text}, got {list(scene.specimen.mesh)}")


def known_ending(name: str) -> None:
    """Raise Refusal for a file whose ending nobody here reads."""
    from verify.meshes.read import MESH_ENDINGS

    ending = Path(name).suffix.lower()
    if ending not in MESH_ENDINGS:
        wanted = one_of([*MESH_ENDINGS, ".iga"])
        raise Refusal(f"specimen.mesh: {name}: must end with {wanted}, got {ending or 'no ending'!r}")


def remarks(scene: Scene, others: Sequence[str]) -> tuple[str, ...]:
    """Sentences on the runs of a scene with mesh files that have not used them."""
    able = " and ".join(ON_FILES.get(file_kind(scene), ()))
    text = f"specimen.mesh: the mesh of {able} alone; {', '.join(others)} ran without it"
    return (text,) if others else ()


def given_meshes(scene: Scene) -> tuple[Mesh, ...]:
    """Meshes of the bodies, upper first, in the specimen's own frame; none where the scene names no files.

    Raises
    ------
    Refusal
        For a file that is no mesh, or not a mesh of the specimen (see `iga.delamination.given.misfit`).
    """
    specimen = scene.specimen
    if specimen.nodal:
        arms = given_arms(scene)
        try:
            return tuple(nodal_body(arm.X_nI, arm.conn_kea) for arm in arms)
        except ValueError as error:
            raise Refusal(f"specimen.mesh: {specimen.mesh[0]}: {error}") from None
    meshes = []
    for number, file in enumerate(specimen.mesh):
        try:
            mesh = body_mesh(Path(file))
        except OSError as error:
            raise Refusal(f"specimen.mesh: cannot read {file}: {error.strerror}") from None
        except ValueError as error:
            raise Refusal(f"specimen.mesh: {error}") from None
        size = specimen.lengths[number], specimen.thicknesses[number]
        parts: tuple[Load | Support | Clamp, ...] = (*specimen.loads, *specimen.supports, *specimen.clamps)
        sides = {part.side for part in parts if part.body in (None, number)}
        if fault := misfit(mesh, number, size, specimen.bonded, sides):
            raise Refusal(f"specimen.mesh: {file}: {fault}")
        meshes.append(mesh)
    if len(meshes) == 1:
        meshes.append(upside_down(meshes[0]))
    return tuple(meshes)
