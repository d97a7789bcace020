"""A scene as a mesh file with named groups: by `meshio` Gmsh 2.2 and MED of Salome and code_aster; Exodus of MOOSE."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

import meshio
import numpy as np

from verify.export.mesh import SceneMesh
from verify.meshes.abaqus import PLANE_TYPES
from verify.support.refusal import Refusal

#: Types of elements: by the dimension and the number of nodes.
TYPES = {(2, size): kind for kind, size in PLANE_TYPES.items()} | {(1, 2): "line", (1, 3): "line3", (0, 1): "vertex"}


#: Group of the cohesive elements in a mesh that is from a file.
COHESIVE_CELLS = "cohesive"
#: Dimension, name and connectivity of every group.
Groups = Sequence[tuple[int, str, np.ndarray]]

#: Ending of each format; that of Gmsh is in version 2.2, which every reader of .msh files knows.
GROUP_FILES: Mapping[str, str] = {"gmsh": "msh", "med": "med", "exodus": "e"}

#: Letters of a name in Exodus.
_LETTERS = 33


def write_groups(mesh: SceneMesh, kind: str, path: Path) -> None:
    """Write ``path``: a group of elements for each body, and of cohesive ones in a mesh from a file; sides or a point
    for each set of nodes.

    Raises
    ------
    Refusal : the format needs a package that is not installed.
    """
    groups = _groups(mesh)
    try:
        if kind == "exodus":
            _write_exodus(mesh, [one for one in groups if one[0] == 2], path)
        elif kind == "med":
            meshio.write(path, _in_families(mesh, groups), file_format="med")
        else:
            meshio.write(path, _tagged(mesh, groups), file_format="gmsh22", binary=False)
    except ImportError as error:
        raise Refusal(f"--format: {kind} needs the Python package {error.name}: pip install 'debond[meshes]'") from None


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


def _write_exodus(mesh: SceneMesh, bodies: Groups, path: Path) -> None:
    """Write Exodus II as NetCDF-3, which every Exodus library reads: element blocks, sets of nodes and sets of sides by
    name. `meshio` writes neither the names of blocks nor sides, and in HDF5.

    A set of sides has the number of the set of nodes of its name, as some codes look up the one by the other.
    """
    from netCDF4 import Dataset

    sets, sides = mesh.sets, _side_sets(mesh, bodies)
    with Dataset(path, "w", format="NETCDF3_64BIT_OFFSET") as file:

        def put(name: str, values: np.ndarray, /, *dimensions: str, **about: str) -> None:
            """A variable of letters, numbers, or integers of 32 bits, with dimensions of its size."""
            for dimension, size in zip(dimensions, values.shape, strict=True):
                if dimension not in file.dimensions:
                    file.createDimension(dimension, size)
            kind = "i4" if values.dtype.kind == "i" else values.dtype
            one = file.createVariable(name, kind, dimensions)
            one.setncatts(about)
            one[:] = values

        def put_names(of: str, names: Iterable[str], numbers: np.ndarray, dimension: str) -> None:
            letters = np.array([*names], dtype=f"S{_LETTERS}").view("S1").reshape(-1, _LETTERS)
            put(f"{of}_names", letters, dimension, "len_string")
            put(f"{of}_prop1", numbers, dimension, name="ID")

        number = np.float32(5.1)
        file.setncatts({"api_version": number, "version": number, "floating_point_word_size": np.int32(8)})
        file.createDimension("time_step", None)
        file.createVariable("time_whole", "f8", ("time_step",))
        put("coord", _points(mesh).T, "num_dim", "num_nodes")
        put_names("eb", [name for _, name, _ in bodies], 1 + np.arange(len(bodies)), "num_el_blk")
        file.createDimension("num_elem", sum(len(conn) for *_, conn in bodies))
        for i, (*_, conn) in enumerate(bodies, 1):
            kind = f"{'QUAD' if conn.shape[1] in (4, 8, 9) else 'TRI'}{conn.shape[1]}"
            put(f"connect{i}", conn + 1, f"num_el_in_blk{i}", f"num_nod_per_el{i}", elem_type=kind)
        put_names("ns", sets, 1 + np.arange(len(sets)), "num_node_sets")
        for i, nodes in enumerate(sets.values(), 1):
            put(f"node_ns{i}", nodes + 1, f"num_nod_ns{i}")
        if sides:
            put_names("ss", sides, 1 + np.array([[*sets].index(name) for name in sides]), "num_side_sets")
        for i, (elements, numbers) in enumerate((pairs.T for pairs in sides.values()), 1):
            put(f"elem_ss{i}", elements, f"num_side_ss{i}")
            put(f"side_ss{i}", numbers, f"num_side_ss{i}")


def _groups(mesh: SceneMesh) -> Groups:
    bodies = [(2, name, mesh.conn_ea[mesh.body_e == b]) for b, name in enumerate(mesh.names)]
    if mesh.given and not mesh.merged:
        bodies.append((2, COHESIVE_CELLS, mesh.cohesive_ea))
    p = mesh.degree
    for name, nodes in mesh.sets.items():  # rows of nodes as sides of elements, their middles last; one node as a point
        parts = [nodes] if len(nodes) == 1 else [nodes[:-1:p], nodes[p::p], *([nodes[1::2]] if p == 2 else [])]
        bodies.append((int(len(nodes) > 1), name, np.stack(parts, axis=1)))
    return bodies
