"""Two arms on one conforming mesh: the parent, a submesh for each arm, and one for the bond between them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from dolfinx import mesh
from mpi4py import MPI

from fem_reference.dolfinx_api import Submesh, create_submesh
from fem_reference.problem import Problem


@dataclass(frozen=True)
class TwoBodies:
    """The mesh of a double cantilever beam.

    ``*_cells`` are owned cells of the parent; ``*_face`` (n, 2) are owned facets at X = 0 as (cell, local facet);
    ``interface_quads`` (n, 4) are owned facets of the bond as (upper cell, local facet, lower cell, local facet).
    """

    parent: mesh.Mesh
    upper: Submesh
    lower: Submesh
    bond: Submesh
    upper_cells: np.ndarray
    lower_cells: np.ndarray
    upper_face: np.ndarray
    lower_face: np.ndarray
    interface_quads: np.ndarray


def grid_lines(problem: Problem) -> np.ndarray:
    """Element boundaries along the specimen (elements + 1,): one at the end of the precrack, even on either side."""
    n = problem.elements
    on_precrack = min(max(round(n * problem.precrack / problem.length), 1), n - 1)
    bonded = np.linspace(problem.precrack, problem.length, n - on_precrack + 1)
    return np.concatenate([np.linspace(0.0, problem.precrack, on_precrack + 1)[:-1], bonded])


def two_bodies(problem: Problem, comm: MPI.Intracomm) -> TwoBodies:
    """Mesh of the problem, spread over the ranks of ``comm``."""
    parent = _parent(problem, comm)
    tdim = 2
    for pair in ((1, tdim), (tdim, 1)):
        parent.topology.create_connectivity(*pair)
    h, tolerance = problem.arm_thickness, 1e-6 * np.min(np.diff(grid_lines(problem)))
    near = min(tolerance, 1e-6 * h)
    upper = mesh.locate_entities(parent, tdim, lambda x: x[1] > -near)
    lower = mesh.locate_entities(parent, tdim, lambda x: x[1] < near)
    bonded = mesh.locate_entities(parent, 1, lambda x: (np.abs(x[1]) < near) & (x[0] > problem.precrack - near))
    face = mesh.locate_entities_boundary(parent, 1, lambda x: np.abs(x[0]) < near)
    is_upper = np.zeros(_count(parent, tdim), dtype=bool)
    is_upper[upper] = True
    face_pairs = _sides(parent, _owned(parent, 1, face), 1)
    on_top = is_upper[face_pairs[:, 0]]
    return TwoBodies(
        parent,
        create_submesh(parent, tdim, upper),
        create_submesh(parent, tdim, lower),
        create_submesh(parent, 1, bonded),
        _owned(parent, tdim, upper),
        _owned(parent, tdim, lower),
        face_pairs[on_top],
        face_pairs[~on_top],
        _upper_first(_sides(parent, _owned(parent, 1, bonded), 2), is_upper),
    )


def _parent(problem: Problem, comm: MPI.Intracomm) -> mesh.Mesh:
    """A grid of unit steps, moved to its place: every line is where it should be to the last digit.

    Facets between ranks need a ghost cell on their other side, which ``create_rectangle`` gives them by default.
    """
    n, m = problem.elements, problem.elements_across
    parent = mesh.create_rectangle(comm, [[0.0, -m], [n, m]], [n, 2 * m], mesh.CellType.quadrilateral)
    x = parent.geometry.x
    x[:, 0] = grid_lines(problem)[np.rint(x[:, 0]).astype(int)]
    x[:, 1] = np.rint(x[:, 1]) * (problem.arm_thickness / m)
    return parent


def _count(parent: mesh.Mesh, dim: int) -> int:
    entities = parent.topology.index_map(dim)
    return entities.size_local + entities.num_ghosts


def _owned(parent: mesh.Mesh, dim: int, entities: np.ndarray) -> np.ndarray:
    return entities[entities < parent.topology.index_map(dim).size_local]


def _sides(parent: mesh.Mesh, facets: np.ndarray, n_sides: int) -> np.ndarray:
    """(cell, local facet) on each side of the facets: (n, 2) on the boundary with one side, (n, 4) inside with two."""
    to_cells, to_facets = parent.topology.connectivity(1, 2), parent.topology.connectivity(2, 1)
    facets_cf = to_facets.array.reshape(-1, 4)  # a quadrilateral has four
    cells_fs = to_cells.array[to_cells.offsets[facets][:, None] + np.arange(n_sides)]
    local_fs = np.argmax(facets_cf[cells_fs] == facets[:, None, None], axis=2)
    return np.stack([cells_fs, local_fs], axis=2).reshape(facets.size, 2 * n_sides).astype(np.int32)


def _upper_first(quads: np.ndarray, is_upper: np.ndarray) -> np.ndarray:
    """The same facets with the upper body on the first, the "+", side."""
    swapped = quads[:, [2, 3, 0, 1]]
    return np.where(is_upper[quads[:, :1]], quads, swapped)
