"""`debond export`: one scene, one format, one folder.

Small formats stand here: VTU, with bodies and interface as cells, sets and pairs as point data; and beside an input
file of Abaqus a script for its own Python, 2.7 or 3, that writes the curve of the scene from the output database.
"""

from __future__ import annotations

import csv
from pathlib import Path
from shlex import quote

import numpy as np

from verify.export import moose
from verify.export.abaqus import write_abaqus
from verify.export.groups import GROUP_FILES, write_groups
from verify.export.mesh import SceneMesh, merged, numbered, scene_mesh
from verify.export.numbers import LAW_NOTES, notes, numbers
from verify.export.references import references
from verify.fields.vtk_xml import Grid, write_grid
from verify.runs.folder import write_json
from verify.scene.schema import Dolfinx, Scene
from verify.scene.toml import keep_scene
from verify.support.refusal import Refusal, one_of

SCRIPT = '''\
"""Write history.csv, U2 and RF2 of node {node}, which stands for the set {name}: abaqus python history.py JOB.odb"""
import csv
import sys

from odbAccess import openOdb

NODE = {node}

odb = openOdb(sys.argv[-1], readOnly=True)
rows = []
for step in odb.steps.values():
    found = [region for name, region in step.historyRegions.items() if name.endswith(".%d" % NODE)]
    if not found:
        sys.exit("no history of the node %d in the step %s: is this the job of the exported file?" % (NODE, step.name))
    moved, borne = (dict(found[0].historyOutputs[name].data) for name in ("U2", "RF2"))
    for time in sorted(set(moved) & set(borne)):
        if not rows or time > 0.0:  # a step begins where the one before has ended
            rows.append((step.name, time, moved[time], borne[time]))
odb.close()
with open("history.csv", "w") as stream:
    writer = csv.writer(stream, lineterminator="\\n")
    writer.writerow(("step", "time", "U2", "RF2"))
    writer.writerows(rows)
print("written: history.csv, %d rows" % len(rows))
'''


#: VTK_TRIANGLE, VTK_QUAD, their quadratic ones and VTK_BIQUADRATIC_QUAD of vtkCellType.h, by their number of nodes.
CELLS = {3: 5, 4: 9, 6: 22, 8: 23, 9: 28}

#: Cell data ``body`` of the elements of the interface, which have no area.
INTERFACE = 2


def write_scene_vtu(mesh: SceneMesh, path: Path) -> None:
    """Write ``path``. Cell data ``body``: 0 upper, 1 lower, 2 interface. Point data, counted from 0:

    ``pair``: node on the other side of the bond, -1 off it; ``pair_length``: length of the bond that belongs to it;
    ``load_weight``: part of the load of its face, or of the force of its support; and for every set its name, 1 where a
    node belongs to it.
    """
    cells = [*mesh.conn_ea, *mesh.cohesive_ea]
    types = np.repeat([CELLS[mesh.conn_ea.shape[1]], CELLS[4]], [len(mesh.conn_ea), len(mesh.cohesive_ea)])
    body = np.concatenate([mesh.body_e, np.full(len(mesh.cohesive_ea), INTERFACE)])
    grid = Grid(
        points=np.column_stack([mesh.X_nI, np.zeros(len(mesh.X_nI))]),
        connectivity=np.concatenate(cells),
        offsets=np.cumsum([len(cell) for cell in cells]),
        types=types,
        point_data=point_data(mesh),
        cell_data={"body": body},
    )
    write_grid(path, grid)


def point_data(mesh: SceneMesh) -> dict[str, np.ndarray]:
    """Arrays (n,) of every node by their names."""
    pair, length, weight = np.full(len(mesh.X_nI), -1), np.zeros(len(mesh.X_nI)), np.zeros(len(mesh.X_nI))
    lower, upper = mesh.pair_kb.T
    pair[lower], pair[upper] = upper, lower
    length[lower] = length[upper] = mesh.length_k
    for face in (*mesh.loaded, *mesh.resting):
        weight[face.node_n] = face.weight_n
    sets = {name: np.zeros(len(mesh.X_nI), dtype=np.uint8) for name in mesh.sets}
    for name, nodes in mesh.sets.items():
        sets[name][nodes] = 1
    return {"pair": pair, "pair_length": length, "load_weight": weight, **sets}


ENDINGS = {"abaqus": "inp", **GROUP_FILES, "vtu": "vtu", "moose": "i"}
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
            if kind == "vtu":
                write_scene_vtu(mesh, files[0])
            elif kind == "moose":
                moose.write_moose(scene, mesh, files[0])
            elif kind != "abaqus":
                write_groups(mesh, kind, files[0])
        if kind == "abaqus":
            write_abaqus(scene, mesh, files[0])
            files.append(folder / "history.py")
            loaded = references(scene, mesh)[0]
            files[-1].write_text(SCRIPT.format(name=loaded.name, node=loaded.node), encoding="utf-8")
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


def write_tables(mesh: SceneMesh, folder: Path) -> tuple[Path, ...]:
    """Write nodes.csv, elements.csv, pairs.csv and sets.csv into a folder; their paths.

    Corners of an element go counter-clockwise, then the middles of its sides. Pairs are ordered along the bond, and
    ``length`` is the share of each in the interface. ``weight`` is a node's part of the load of a loaded face, or
    of the force of a support.
    """
    names, nodes = [mesh.names[b] for b in mesh.body_e], [f"n{a + 1}" for a in range(mesh.conn_ea.shape[1])]
    elements = zip(mesh.number_e.tolist(), names, mesh.conn_ea + 1, strict=True)
    pairs = zip(mesh.pair_kb + 1, mesh.at(mesh.pair_kb[:, 0]), mesh.length_k, strict=True)
    weights = {face.name: face.weight_n for face in (*mesh.loaded, *mesh.resting)}
    tables = {
        "nodes.csv": (
            ("node", "x", "y"),
            ((n, *X) for n, X in zip(mesh.number_n.tolist(), mesh.X_nI.tolist(), strict=True)),
        ),
        "elements.csv": (("element", "body", *nodes), ((e, b, *conn) for e, b, conn in elements)),
        "pairs.csv": (
            ("pair", "lower", "upper", "x", "y", "length"),
            ((k, *pair, *X.tolist(), float(length)) for k, (pair, X, length) in enumerate(pairs, 1)),
        ),
        "sets.csv": (
            ("set", "node", "weight"),
            (
                (name, node + 1, "" if name not in weights else float(weights[name][i]))
                for name, nodes in mesh.sets.items()
                for i, node in enumerate(nodes)
            ),
        ),
    }
    for name, (columns, rows) in tables.items():
        with (folder / name).open("w", newline="", encoding="utf-8") as stream:
            csv.writer(stream).writerows((columns, *rows))
    return tuple(folder / name for name in tables)
