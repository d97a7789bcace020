"""A scene as a VTU file: bodies and interface as cells, sets and pairs as point data."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from verify.export.mesh import SceneMesh
from verify.fields.vtk_xml import Grid, write_grid

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
