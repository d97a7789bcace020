"""A scene as a mesh file with named groups, by `meshlane`: Gmsh 2.2, MED of Salome and code_aster, Exodus of MOOSE."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import meshlane
import numpy as np

from verify.export.mesh import SceneMesh
from verify.support.refusal import Refusal

#: Types of elements: by the dimension and the number of nodes.
TYPES = {(2, 4): "quad", (2, 8): "quad8", (1, 2): "line", (1, 3): "line3", (0, 1): "vertex"}


class GroupFile(NamedTuple):
    """Ending of a format, its name in `meshlane`, and whether it takes bodies alone, and sets of nodes beside them."""

    ending: str
    name: str
    bodies_alone: bool = False


GROUP_FILES: Mapping[str, GroupFile] = {
    "gmsh": GroupFile("msh", "gmsh22"),  # the version that every reader of .msh files knows
    "med": GroupFile("med", "med"),
    "exodus": GroupFile("e", "exodus", bodies_alone=True),
}


def write_groups(mesh: SceneMesh, kind: str, path: Path) -> None:
    """Write ``path``: a group of elements for each body, one of sides or a point for each set of nodes.

    Raises
    ------
    Refusal : the format needs a package that is not installed.
    """
    how = GROUP_FILES[kind]
    groups = [one for one in _groups(mesh) if one[0] == 2 or not how.bodies_alone]
    tags = [np.full(len(conn), number) for number, (_, _, conn) in enumerate(groups, 1)]
    numbered = {"cell_data": {"gmsh:physical": tags, "gmsh:geometrical": tags}}
    named = {
        "cell_sets": {
            name: [np.arange(len(conn)) if other == name else np.zeros(0, dtype=int) for _, other, conn in groups]
            for _, name, _ in groups
        },
        "point_sets": mesh.sets,
    }
    found = meshlane.Mesh(
        np.column_stack([mesh.X_nI, np.zeros(len(mesh.X_nI))]),
        [(TYPES[dim, conn.shape[1]], conn) for dim, _, conn in groups],
        field_data={name: np.array([number, dim]) for number, (dim, name, _) in enumerate(groups, 1)},
        **(numbered if kind == "gmsh" else named),
    )
    options = {"binary": False} if kind == "gmsh" else {}
    try:
        meshlane.write(path, found, file_format=how.name, **options)
    except ImportError as error:
        raise Refusal(f"--format: {kind} needs the Python package {error.name}: pip install 'debond[meshes]'") from None
    if kind == "exodus":
        _name_blocks(path, [name for _, name, _ in groups])


def _name_blocks(path: Path, names: Sequence[str]) -> None:
    """Give the element blocks of an Exodus file their names, which `meshlane` leaves out, and numbers from 1 on."""
    from netCDF4 import Dataset, stringtochar

    with Dataset(path, "a") as file:
        file.variables["eb_prop1"][:] = np.arange(1, len(names) + 1)
        file.variables["ns_prop1"][:] = np.arange(1, file.dimensions["num_node_sets"].size + 1)
        length = file.dimensions["len_string"].size
        file.createVariable("eb_names", "S1", ("num_el_blk", "len_string"))[:] = stringtochar(
            np.array(names, dtype=f"S{length}")
        )


def _groups(mesh: SceneMesh) -> list[tuple[int, str, np.ndarray]]:
    """Dimension, name and connectivity of every group."""
    bodies = [(2, name, mesh.conn_ea[mesh.body_e == b]) for b, name in enumerate(mesh.names)]
    sides = [(name, _sides(nodes, mesh)) for name, nodes in mesh.sets.items()]
    return [*bodies, *((dim, name, conn) for name, (dim, conn) in sides)]


def _sides(nodes: np.ndarray, mesh: SceneMesh) -> tuple[int, np.ndarray]:
    """A row of nodes as sides of elements, both ends first and the middle last; one node as a point."""
    if len(nodes) == 1:
        return 0, nodes[:, None]
    p = mesh.degree
    parts = [nodes[:-1:p], nodes[p::p], *([nodes[1::2]] if p == 2 else [])]
    return 1, np.stack(parts, axis=1)
