"""A scene as a mesh file with named groups, by `meshio`: Gmsh 2.2, MED of Salome and code_aster, Exodus of MOOSE."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import meshio
import numpy as np

from verify.export.mesh import SceneMesh
from verify.meshes.abaqus import PLANE_TYPES
from verify.support.refusal import Refusal

#: Types of elements: by the dimension and the number of nodes.
TYPES = {(2, size): kind for kind, size in PLANE_TYPES.items()} | {(1, 2): "line", (1, 3): "line3", (0, 1): "vertex"}


class GroupFile(NamedTuple):
    """Ending of a format, its name in `meshio`, and whether it takes bodies alone, and sets of nodes beside them."""

    ending: str
    name: str
    bodies_alone: bool = False


#: Group of the cohesive elements in a mesh that is from a file.
COHESIVE_CELLS = "cohesive"
#: Dimension, name and connectivity of every group.
Groups = Sequence[tuple[int, str, np.ndarray]]

GROUP_FILES: Mapping[str, GroupFile] = {
    "gmsh": GroupFile("msh", "gmsh22"),  # the version that every reader of .msh files knows
    "med": GroupFile("med", "med"),
    "exodus": GroupFile("e", "exodus", bodies_alone=True),
}


def write_groups(mesh: SceneMesh, kind: str, path: Path) -> None:
    """Write ``path``: a group of elements for each body, and of cohesive ones in a mesh from a file; sides or a point
    for each set of nodes.

    Raises
    ------
    Refusal : the format needs a package that is not installed.
    """
    how = GROUP_FILES[kind]
    groups = [one for one in _groups(mesh) if one[0] == 2 or not how.bodies_alone]
    made = {"gmsh": _tagged, "med": _in_families, "exodus": _in_blocks}[kind](mesh, groups)
    options = {"binary": False} if kind == "gmsh" else {}
    try:
        meshio.write(path, made, file_format=how.name, **options)
    except ImportError as error:
        raise Refusal(f"--format: {kind} needs the Python package {error.name}: pip install 'debond[meshes]'") from None
    if kind == "exodus":
        _as_netcdf_3(path, groups, _side_sets(mesh, groups))


def _points(mesh: SceneMesh) -> np.ndarray:
    return np.column_stack([mesh.X_nI, np.zeros(len(mesh.X_nI))])


def _tagged(mesh: SceneMesh, groups: Groups) -> meshio.Mesh:
    """A block for each group, with its number as physical and geometrical tag."""
    tags = [np.full(len(conn), number) for number, (_, _, conn) in enumerate(groups, 1)]
    return meshio.Mesh(
        _points(mesh),
        [(TYPES[dim, conn.shape[1]], conn) for dim, _, conn in groups],
        cell_data={"gmsh:physical": tags, "gmsh:geometrical": tags},
        field_data={name: np.array([number, dim]) for number, (dim, name, _) in enumerate(groups, 1)},
    )


def _in_blocks(mesh: SceneMesh, groups: Groups) -> meshio.Mesh:
    """A block for each body, and the sets of nodes."""
    return meshio.Mesh(_points(mesh), [(TYPES[2, conn.shape[1]], conn) for *_, conn in groups], point_sets=mesh.sets)


def _in_families(mesh: SceneMesh, groups: Groups) -> meshio.Mesh:
    """A block for each type of element, as MED has them, and families: what belongs to the same groups.

    Their numbers are negative for elements and positive for nodes.
    """
    kinds = [TYPES[dim, conn.shape[1]] for dim, _, conn in groups]
    parts = {kind: [i for i, other in enumerate(kinds) if other == kind] for kind in kinds}
    in_set_ns = np.stack([np.isin(np.arange(len(mesh.X_nI)), nodes) for nodes in mesh.sets.values()], axis=1)
    family_n = in_set_ns @ (1 << np.arange(len(mesh.sets)))  # bit i: whether it belongs to set i
    made = meshio.Mesh(
        _points(mesh),
        [(kind, np.concatenate([groups[i][2] for i in of])) for kind, of in parts.items()],
        point_data={"point_tags": family_n},
        cell_data={
            "cell_tags": [np.repeat([-1 - i for i in of], [len(groups[i][2]) for i in of]) for of in parts.values()]
        },
    )
    made.point_tags = {
        int(family): [name for i, name in enumerate(mesh.sets) if family >> i & 1]
        for family in np.unique(family_n)
        if family
    }
    made.cell_tags = {-1 - i: [name] for i, (_, name, _) in enumerate(groups)}
    return made


def _side_sets(mesh: SceneMesh, groups: Groups) -> dict[str, np.ndarray]:
    """Sides (n, 2) of the sets of nodes that have some: element and side of it, both from 1 on, in the order of blocks.

    Of a bond whose bodies share their nodes these are the sides of the upper one.
    """
    conn_ea = np.concatenate([conn[:, : 3 + (conn.shape[1] in (4, 8, 9))] for *_, conn in groups[: len(mesh.names)]])
    sides = np.sort(np.stack([conn_ea, np.roll(conn_ea, -1, axis=1)], axis=2).reshape(-1, 2), axis=1)
    found = {}
    for name, nodes in mesh.sets.items():
        _, first = np.unique(
            sides[rows := np.flatnonzero(np.isin(sides, nodes).all(axis=1))], axis=0, return_index=True
        )
        if rows.size:
            found[name] = 1 + np.stack(np.divmod(np.sort(rows[first]), conn_ea.shape[1]), axis=1)
    return found


def _as_netcdf_3(path: Path, groups: Groups, sides: Mapping[str, np.ndarray]) -> None:
    """Write an Exodus file again as NetCDF-3, which every Exodus library reads: with the names of the element blocks
    and the sets of sides, which `meshio` leaves out, with blocks and sets numbered from 1 on, and integers of 32 bits.

    A set of sides has the number of the set of nodes of its name, as some codes look up the one by the other.
    """
    from netCDF4 import Dataset, stringtochar

    with Dataset(path) as file:
        file.set_auto_mask(False)
        sizes = {name: len(one) for name, one in file.dimensions.items()}
        about = {key: file.getncattr(key) for key in file.ncattrs()}
        found = {
            key: (one.dimensions, one[:], {k: one.getncattr(k) for k in one.ncattrs()})
            for key, one in file.variables.items()
        }
    sets = [b"".join(row).decode().rstrip("\0") for row in found["ns_names"][1]]
    sizes |= {"num_side_sets": len(sides)} if sides else {}
    if sides:
        known = np.array([1 + sets.index(name) for name in sides])
        found["ss_prop1"] = (("num_side_sets",), known, {"name": "ID"})
        found["ss_status"] = (("num_side_sets",), np.ones_like(known), {})
        labels = stringtochar(np.array([*sides], dtype=f"S{sizes['len_string']}"))
        found["ss_names"] = (("num_side_sets", "len_string"), labels, {})
    for i, pairs in enumerate(sides.values(), 1):
        sizes[f"num_side_ss{i}"] = len(pairs)
        for key, column in zip(("elem_ss", "side_ss"), pairs.T, strict=True):
            found[f"{key}{i}"] = ((f"num_side_ss{i}",), column, {})
    names = [name for _, name, _ in groups]
    found["eb_prop1"] = (found["eb_prop1"][0], np.arange(1, len(names) + 1), {"name": "ID"})
    found["ns_prop1"] = (found["ns_prop1"][0], np.arange(1, sizes["num_node_sets"] + 1), {"name": "ID"})
    labels = stringtochar(np.array(names, dtype=f"S{sizes['len_string']}"))
    found["eb_names"] = (("num_el_blk", "len_string"), labels, {})
    with Dataset(path, "w", format="NETCDF3_64BIT_OFFSET") as file:
        for name, size in sizes.items():
            file.createDimension(name, None if name == "time_step" else size)
        file.setncatts(
            {key: np.int32(value) if isinstance(value, np.integer) else value for key, value in about.items()}
        )
        for key, (dimensions, values, said) in found.items():
            kind = "i4" if values.dtype.kind in "iu" else values.dtype
            one = file.createVariable(key, kind, dimensions)
            one.setncatts({k: v for k, v in said.items() if k != "_FillValue"})
            if values.size:
                one[:] = values


def _groups(mesh: SceneMesh) -> Groups:
    bodies = [(2, name, mesh.conn_ea[mesh.body_e == b]) for b, name in enumerate(mesh.names)]
    if mesh.given and not mesh.merged:
        bodies.append((2, COHESIVE_CELLS, mesh.cohesive_ea))
    sides = [(name, _sides(nodes, mesh)) for name, nodes in mesh.sets.items()]
    return [*bodies, *((dim, name, conn) for name, (dim, conn) in sides)]


def _sides(nodes: np.ndarray, mesh: SceneMesh) -> tuple[int, np.ndarray]:
    """A row of nodes as sides of elements, both ends first and the middle last; one node as a point."""
    if len(nodes) == 1:
        return 0, nodes[:, None]
    p = mesh.degree
    parts = [nodes[:-1:p], nodes[p::p], *([nodes[1::2]] if p == 2 else [])]
    return 1, np.stack(parts, axis=1)
