"""A scene as a Gmsh file of format 2.2, which every reader of .msh files knows: physical groups carry the names."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from verify.export.mesh import SceneMesh

#: Element types of Gmsh: by the number of nodes of a piece of a body, a side, a point.
TYPES = {(2, 4): 3, (2, 8): 16, (1, 2): 1, (1, 3): 8, (0, 1): 15}


def write_gmsh(mesh: SceneMesh, path: Path) -> None:
    """Write ``path``: a physical surface for each body, a physical curve or point for each set of nodes."""
    groups = _groups(mesh)
    numbers = range(1, len(groups) + 1)
    rows = [
        (TYPES[dim, conn.shape[1]], number, nodes + 1)
        for number, (dim, _, conn) in zip(numbers, groups, strict=True)
        for nodes in conn
    ]
    lines = [
        *("$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$PhysicalNames", str(len(groups))),
        *(f'{dim} {number} "{name}"' for number, (dim, name, _) in zip(numbers, groups, strict=True)),
        *("$EndPhysicalNames", "$Nodes", str(len(mesh.X_nI))),
        *(f"{n} {x:.17g} {y:.17g} 0" for n, (x, y) in enumerate(mesh.X_nI, 1)),
        *("$EndNodes", "$Elements", str(len(rows))),
        *(f"{e} {kind} 2 {g} {g} {' '.join(map(str, nodes))}" for e, (kind, g, nodes) in enumerate(rows, 1)),
        "$EndElements",
    ]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


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
