"""`debond export`: one scene, one format, one folder."""

from __future__ import annotations

from pathlib import Path
from shlex import quote

from verify.export import moose
from verify.export.abaqus import write_abaqus
from verify.export.groups import GROUP_FILES, write_groups
from verify.export.mesh import SceneMesh, merged, numbered, scene_mesh
from verify.export.numbers import LAW_NOTES, notes, numbers
from verify.export.odb import write_odb_script
from verify.export.references import references
from verify.export.tables import write_tables
from verify.export.vtu import write_scene_vtu
from verify.runs.folder import write_json
from verify.scene.schema import Dolfinx, Scene
from verify.scene.toml import keep_scene
from verify.support.refusal import Refusal, one_of

ENDINGS = {"abaqus": "inp", **{kind: one.ending for kind, one in GROUP_FILES.items()}, "vtu": "vtu", "moose": "i"}
FORMATS = (*ENDINGS, "csv")
#: Formats in which nodes and elements have numbers of their own.
OWN_NUMBERS = ("abaqus", "csv")
#: Formats without quadrilaterals of 9 nodes: Abaqus has none, and `meshio` writes none for MED.
WITHOUT_NINE = ("abaqus", "med")


def export(scene: Scene, kind: str, folder: Path, asked: Dolfinx, conforming: bool = False) -> list[str]:
    """Write a scene into a folder; returns the files and remarks on them, a line each.

    Parameters
    ----------
    kind : one of `FORMATS`
    asked : the exported mesh; the scene file keeps that of the scene, on which DOLFINx judges the other code
    conforming : whether the bodies share the nodes of the bond, which then is one group

    Raises
    ------
    Refusal : a law that is not written down, a degree above 2, too few elements, a folder that cannot be written to.
    """
    if scene.specimen.plane == "solid":
        raise Refusal('specimen.plane: must be "stress" or "strain" for an export, got "solid"')
    if scene.interface.law not in LAW_NOTES:
        raise Refusal(f"interface.law: must be {one_of(LAW_NOTES)} for an export, got {scene.interface.law!r}")
    if conforming and kind not in GROUP_FILES:
        raise Refusal(f"--merged: is for --format {one_of(GROUP_FILES)}, got {kind!r}")
    mesh = scene_mesh(scene.model_copy(update={"dolfinx": asked}))
    if kind in WITHOUT_NINE and mesh.conn_ea.shape[1] == 9:
        able = [one for one in FORMATS if one not in WITHOUT_NINE]
        raise Refusal(f"--format: must be {one_of(able)} for a mesh with elements of 9 nodes, got {kind!r}")
    mesh = merged(mesh) if conforming else mesh
    mesh = numbered(mesh) if kind in OWN_NUMBERS else mesh
    file = f"{scene.name}.{ENDINGS.get(kind)}"
    if file in {Path(name).name for name in scene.specimen.mesh}:  # which stays what it is
        file = f"{scene.name}-export.{ENDINGS[kind]}"
    try:
        folder.mkdir(parents=True, exist_ok=True)
        if kind == "csv":
            files = list(write_tables(mesh, folder))
        else:
            files = [folder / file]
            _write(kind, scene, mesh, files[0])
        if kind == "abaqus":
            files.append(folder / "history.py")
            write_odb_script(references(scene, mesh)[0], files[-1])
        files += [folder / "scene.json", folder / f"{scene.name}.toml"]
        write_json(files[-2], numbers(scene, mesh), compact=True)
        if scene.specimen.nodal and kind != "csv":  # the file that is written, which includes no other
            meshed = files[0].with_suffix(".e") if kind == "moose" else files[0]
            read = {"mesh": (str(meshed),), "groups": type(scene.specimen.groups)()}
            scene = scene.model_copy(update={"specimen": scene.specimen.model_copy(update=read)})
        keep_scene(scene, files[-1])
    except OSError as error:
        text = f"must be a folder that can be written to, got {str(folder)!r}: {error.strerror}"
        raise Refusal(f"--out: {text}") from None
    size = f"{len(mesh.X_nI)} nodes, {len(mesh.conn_ea)} elements of degree {mesh.degree}, {len(mesh.pair_kb)} pairs"
    then = f"its curve is judged by: debond verify {quote(str(files[-1]))} --with CURVE"
    said = [*notes(scene), *(moose.remarks(scene) if kind == "moose" else [])]
    return [size, *said, *(f"written: {file}" for file in files), then]


def _write(kind: str, scene: Scene, mesh: SceneMesh, path: Path) -> None:
    if kind == "abaqus":
        write_abaqus(scene, mesh, path)
    elif kind == "vtu":
        write_scene_vtu(mesh, path)
    elif kind == "moose":
        moose.write_moose(scene, mesh, path)
    else:
        write_groups(mesh, kind, path)
