"""Two bodies on one conforming mesh: the parent, a submesh for each body, and one for the interface between them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from dolfinx import mesh
from mpi4py import MPI

from fem_reference.dolfinx_api import Submesh, create_mesh, create_submesh
from fem_reference.problem.specimen import Body, Face, Region, Specimen


@dataclass(frozen=True)
class TwoBodies:
    """The mesh of a specimen.

    ``pair`` are the submeshes of the bodies, upper first, ``bond`` is that of the interface. ``cells`` are the parent's
    cells of each body that this rank owns, ``faces`` the owned facets (n, 2) of every end face as (cell, local facet),
    ``patches`` those of every patch of every load and support in turn,
    ``interface_quads`` (n, 4) the owned facets of the interface as (upper cell, local facet, lower cell, local facet).
    """

    parent: mesh.Mesh
    pair: tuple[Submesh, Submesh]
    bond: Submesh
    cells: tuple[np.ndarray, np.ndarray]
    faces: tuple[np.ndarray, ...]
    patches: tuple[np.ndarray, ...]
    interface_quads: np.ndarray


def two_bodies(specimen: Specimen, comm: MPI.Intracomm) -> TwoBodies:
    """Mesh of a specimen, distributed over the ranks of ``comm``."""
    parent = _parent(specimen, comm)
    tdim, near = 2, specimen.near
    for pair in ((1, tdim), (tdim, 1)):
        parent.topology.create_connectivity(*pair)
    upper, lower = (entities_on(parent, tdim, _extent(body), near) for body in specimen.bodies)
    low, high = sorted(specimen.interface)
    bonded = entities_on(parent, 1, ((low, high), (0.0, 0.0)), near)
    belongs = [_marked(parent, tdim, cells) for cells in (upper, lower)]
    faces = [(face.body, _side(specimen, face)) for face in specimen.faces]
    patches = [(patch.body, patch.place) for action in specimen.actions for patch in action.patches]

    def facets_of(body: int, place: Region) -> np.ndarray:
        return _seen_from(parent, _owned(parent, 1, entities_on(parent, 1, place, near)), belongs[body])

    return TwoBodies(
        parent=parent,
        pair=(create_submesh(parent, tdim, upper), create_submesh(parent, tdim, lower)),
        bond=create_submesh(parent, 1, bonded),
        cells=(_owned(parent, tdim, upper), _owned(parent, tdim, lower)),
        faces=tuple(facets_of(*face) for face in faces),
        patches=tuple(facets_of(*patch) for patch in patches),
        interface_quads=np.hstack([_seen_from(parent, _owned(parent, 1, bonded), inside) for inside in belongs]),
    )


def entities_on(domain: mesh.Mesh, dim: int, place: Region, near: float) -> np.ndarray:
    """Local entities (owned and ghosts) of a dimension that lie in a place."""
    domain.topology.create_connectivity(dim, 2)
    (left, right), (low, high) = place
    return mesh.locate_entities(
        domain,
        dim,
        lambda x: (x[0] > left - near) & (x[0] < right + near) & (x[1] > low - near) & (x[1] < high + near),
    )


def _parent(specimen: Specimen, comm: MPI.Intracomm) -> mesh.Mesh:
    """The specimen's own cells, or a grid of unit steps whose lines are moved to the specimen's.

    Coordinates are exact to the last digit. Beyond the end of the shorter body the grid has cells of no body. Facets
    between ranks need a ghost cell on their other side, which ``create_rectangle`` provides by default.
    """
    if specimen.cells:
        return create_mesh(comm, specimen.cells.X_nI, specimen.cells.conn_ea)
    upper, lower = (body.Y for body in specimen.bodies)
    X, Y, below = specimen.X, np.concatenate([lower, upper[1:]]), lower.size - 1
    n, m = X.size - 1, Y.size - 1
    parent = mesh.create_rectangle(comm, [[0.0, -below], [n, m - below]], [n, m], mesh.CellType.quadrilateral)
    x = parent.geometry.x
    x[:, 0] = X[np.rint(x[:, 0]).astype(int)]
    x[:, 1] = Y[np.rint(x[:, 1]).astype(int) + below]
    return parent


def _extent(body: Body) -> Region:
    return (0.0, body.length), (float(body.Y[0]), float(body.Y[-1]))


def _side(specimen: Specimen, face: Face) -> Region:
    return (face.X, face.X), _extent(specimen.bodies[face.body])[1]


def _marked(parent: mesh.Mesh, dim: int, entities: np.ndarray) -> np.ndarray:
    index_map = parent.topology.index_map(dim)
    marked = np.zeros(index_map.size_local + index_map.num_ghosts, dtype=bool)
    marked[entities] = True
    return marked


def _owned(parent: mesh.Mesh, dim: int, entities: np.ndarray) -> np.ndarray:
    return entities[entities < parent.topology.index_map(dim).size_local]


def _seen_from(parent: mesh.Mesh, facets: np.ndarray, inside_c: np.ndarray) -> np.ndarray:
    """Facets as (cell, local facet) (n, 2), seen from their adjacent cell that is marked in ``inside_c``."""
    to_cells, to_facets = parent.topology.connectivity(1, 2), parent.topology.connectivity(2, 1)
    facets_cf = to_facets.array.reshape(-1, parent.geometry.dofmap.shape[1])  # as many as corners
    one_f, other_f = to_cells.array[to_cells.offsets[facets]], to_cells.array[to_cells.offsets[facets + 1] - 1]
    cells_f = np.where(inside_c[one_f], one_f, other_f)
    local_f = np.argmax(facets_cf[cells_f] == facets[:, None], axis=1)
    return np.stack([cells_f, local_f], axis=1).astype(np.int32)
