"""Two bodies on one conforming mesh: the parent, a submesh for each body, and one for the interface between them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from dolfinx import mesh
from dolfinx.cpp.mesh import cell_num_entities
from mpi4py import MPI

from fem_reference.dolfinx_api import Submesh, create_mesh, create_submesh
from fem_reference.problem.specimen import Body, Face, Region, Specimen


@dataclass(frozen=True)
class TwoBodies:
    """The mesh of a specimen.

    ``pair`` are the submeshes of the bodies, upper first, ``bond`` is that of the interface. ``cells`` are the parent's
    cells of each body that this rank owns, ``faces`` the owned facets (n, 2) of every end face as (cell, local facet),
    ``patches`` those of every patch of every load and support in turn,
    ``interface_quads`` (n, 4) the owned facets of the interface as (upper cell, local facet, lower cell, local facet),
    or (n, 2) where there is an upper body alone.
    """

    parent: mesh.Mesh
    pair: tuple[Submesh, ...]
    bond: Submesh
    cells: tuple[np.ndarray, ...]
    faces: tuple[np.ndarray, ...]
    patches: tuple[np.ndarray, ...]
    interface_quads: np.ndarray


def two_bodies(specimen: Specimen, comm: MPI.Intracomm) -> TwoBodies:
    """Mesh of a specimen, distributed over the ranks of ``comm``."""
    parent = _parent(specimen, comm)
    tdim, fdim, near = specimen.dim, specimen.dim - 1, specimen.near
    for pair in ((fdim, tdim), (tdim, fdim)):
        parent.topology.create_connectivity(*pair)
    filled = [entities_on(parent, tdim, _extent(body), near) for body in specimen.bodies]
    low, high = sorted(specimen.interface)
    bonded = entities_on(parent, fdim, ((low, high), (0.0, 0.0)), near)
    belongs = [_marked(parent, tdim, cells) for cells in filled]
    faces = [(face.body, _side(specimen, face)) for face in specimen.faces]
    patches = [(patch.body, patch.place) for action in specimen.actions for patch in action.patches]

    def facets_of(body: int, place: Region) -> np.ndarray:
        return _seen_from(parent, _owned(parent, fdim, entities_on(parent, fdim, place, near)), belongs[body])

    return TwoBodies(
        parent=parent,
        pair=tuple(create_submesh(parent, tdim, cells) for cells in filled),
        bond=create_submesh(parent, fdim, bonded),
        cells=tuple(_owned(parent, tdim, cells) for cells in filled),
        faces=tuple(facets_of(*face) for face in faces),
        patches=tuple(facets_of(*patch) for patch in patches),
        interface_quads=np.hstack([_seen_from(parent, _owned(parent, fdim, bonded), inside) for inside in belongs]),
    )


def entities_on(domain: mesh.Mesh, dim: int, place: Region, near: float) -> np.ndarray:
    """Local entities (owned and ghosts) of a dimension that lie in a place."""
    domain.topology.create_connectivity(dim, domain.topology.dim)

    def inside(x: np.ndarray) -> np.ndarray:
        return np.all([(x[i] > low - near) & (x[i] < high + near) for i, (low, high) in enumerate(place)], axis=0)

    return mesh.locate_entities(domain, dim, inside)


def _parent(specimen: Specimen, comm: MPI.Intracomm) -> mesh.Mesh:
    """The specimen's own cells, or a grid of unit steps whose lines are moved to the specimen's.

    Coordinates are exact to the last digit. Beyond the end of the shorter body the grid has cells of no body. Facets
    between ranks need a ghost cell on their other side, which ``create_rectangle`` provides by default.
    """
    if specimen.cells:
        return create_mesh(comm, specimen.cells.X_nI, specimen.cells.conn_ea)
    upper, *lower = (body.Y for body in specimen.bodies)
    X, Y, below = specimen.X, np.concatenate([*lower, upper[len(lower) :]]), sum(one.size - 1 for one in lower)
    n, m = X.size - 1, Y.size - 1
    if specimen.Z is None:
        parent = mesh.create_rectangle(comm, [[0.0, -below], [n, m - below]], [n, m], mesh.CellType.quadrilateral)
    else:
        k = specimen.Z.size - 1
        corners = [[0.0, -below, 0.0], [n, m - below, k]]
        parent = mesh.create_box(comm, corners, [n, m, k], mesh.CellType.hexahedron)
    x = parent.geometry.x
    x[:, 0] = X[np.rint(x[:, 0]).astype(int)]
    x[:, 1] = Y[np.rint(x[:, 1]).astype(int) + below]
    if specimen.Z is not None:
        x[:, 2] = specimen.Z[np.rint(x[:, 2]).astype(int)]
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
    dim = parent.topology.dim
    to_cells, to_facets = parent.topology.connectivity(dim - 1, dim), parent.topology.connectivity(dim, dim - 1)
    facets_cf = to_facets.array.reshape(-1, cell_num_entities(parent.topology.cell_type, dim - 1))
    one_f, other_f = to_cells.array[to_cells.offsets[facets]], to_cells.array[to_cells.offsets[facets + 1] - 1]
    cells_f = np.where(inside_c[one_f], one_f, other_f)
    local_f = np.argmax(facets_cf[cells_f] == facets[:, None], axis=1)
    return np.stack([cells_f, local_f], axis=1).astype(np.int32)
