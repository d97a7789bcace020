"""The calls of DOLFINx that changed between 0.9, 0.10 and 0.11; no other file depends on the version."""

from __future__ import annotations

import inspect
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import basix.ufl
import numpy as np
import ufl
from dolfinx import fem, mesh
from dolfinx.fem import petsc
from mpi4py import MPI
from petsc4py import PETSc

#: -O3 vectorises the loops over basis functions; -march=native with -ffast-math took a sixth off an iteration, but ties
#: the forms to one CPU and changes last digits.
JIT_OPTIONS = {"cffi_extra_compile_args": ["-O3"]}

_POINTS_FIRST = list(inspect.signature(mesh.create_mesh).parameters)[2] == "x"  # until 0.9
_HAS_ENTITY_MAP = hasattr(mesh, "EntityMap")  # since 0.10
_HAS_BLOCK_FUNCTIONS = hasattr(petsc, "create_matrix_block")  # until 0.9


@dataclass(frozen=True)
class Submesh:
    """A part of a parent mesh: its own mesh, and the parent entity of each of its cells."""

    mesh: mesh.Mesh
    parent_of_cell: np.ndarray  # (n_cells,) owned and ghosts
    entity_map: Any  # as ``mesh.create_submesh`` returns it


def create_mesh(comm: MPI.Intracomm, X_nI: np.ndarray, conn_ea: np.ndarray) -> mesh.Mesh:
    """Mesh of straight triangles or quadrilaterals, given on every rank with corners counter-clockwise."""
    cell, order = {3: ("triangle", [0, 1, 2]), 4: ("quadrilateral", [0, 1, 3, 2])}[conn_ea.shape[1]]
    element = ufl.Mesh(basix.ufl.element("Lagrange", cell, 1, shape=(2,)))
    first = comm.rank == 0
    points = np.ascontiguousarray(X_nI if first else X_nI[:0])
    cells = np.ascontiguousarray((conn_ea if first else conn_ea[:0])[:, order], dtype=np.int64)
    shared = mesh.create_cell_partitioner(mesh.GhostMode.shared_facet)
    given = (points, element) if _POINTS_FIRST else (element, points)
    return mesh.create_mesh(comm, cells, *given, partitioner=shared)


def create_submesh(parent: mesh.Mesh, dim: int, entities: np.ndarray) -> Submesh:
    """Submesh of the given local entities (owned and ghosts)."""
    part, entity_map, *_ = mesh.create_submesh(parent, dim, entities)
    if not _HAS_ENTITY_MAP:
        return Submesh(part, np.asarray(entity_map, dtype=np.int32), entity_map)
    cells = part.topology.index_map(dim)
    local = np.arange(cells.size_local + cells.num_ghosts, dtype=np.int32)
    return Submesh(part, np.asarray(entity_map.sub_topology_to_topology(local, False), dtype=np.int32), entity_map)


def entity_maps(parent: mesh.Mesh, submeshes: Sequence[Submesh], interface_quads: np.ndarray) -> Any:
    """Entity maps that ``fem.form`` needs for forms on ``parent`` with functions on the submeshes.

    ``interface_quads`` (n, 4): cell and local facet on the "+" side, cell and local facet on the "-" side; (n, 2) where
    the interface is a side of the only body. DOLFINx 0.9
    needs a cell of a body on both sides of an interface facet, although the body is on one side only: its cell is
    given for both sides, and the part of the element matrix for the other side is zero. Later versions need no cell.
    """
    if _HAS_ENTITY_MAP:
        return [part.entity_map for part in submeshes]
    maps = {}
    for part in submeshes:
        dim = part.mesh.topology.dim
        entities = parent.topology.index_map(dim)
        inverse = np.full(entities.size_local + entities.num_ghosts, -1, dtype=np.int32)
        inverse[part.parent_of_cell] = np.arange(part.parent_of_cell.size)
        if dim == parent.topology.dim:
            here, there = interface_quads[:, 0], interface_quads[:, -2]
            absent = inverse[there] < 0
            inverse[there[absent]] = inverse[here[absent]]
            absent = inverse[here] < 0
            inverse[here[absent]] = inverse[there[absent]]
        maps[part.mesh] = inverse
    return maps


def compile_forms(forms: Any, maps: Any) -> Any:
    """Compiled form, or nested list of them with None where a block is empty."""
    return fem.form(forms, entity_maps=maps, jit_options=JIT_OPTIONS)


def create_block_matrix(blocks: Sequence[Sequence[fem.Form]]) -> PETSc.Mat:
    """Matrix with the pattern of the blocks, all zero; rows: all owned of block 0, then all owned of block 1."""
    return petsc.create_matrix_block(blocks) if _HAS_BLOCK_FUNCTIONS else petsc.create_matrix(blocks)


def add_block_matrix(A: PETSc.Mat, blocks: Sequence[Sequence[fem.Form]], bcs: Sequence[fem.DirichletBC]) -> None:
    """Add the blocks to ``A`` and assemble it; constrained rows and columns are zero, with 1 on their diagonal."""
    assemble = petsc.assemble_matrix_block if _HAS_BLOCK_FUNCTIONS else petsc.assemble_matrix
    assemble(A, blocks, bcs=bcs)
    A.assemble()


def expression(e: ufl.core.expr.Expr, points_qI: np.ndarray) -> fem.Expression:
    """Compiled expression at points of the reference cell."""
    return fem.Expression(e, points_qI, jit_options=JIT_OPTIONS)


def evaluate(e: fem.Expression, domain: mesh.Mesh, cells: np.ndarray) -> np.ndarray:
    """Values (n_cells, n_points, n_components) of an expression on cells."""
    return e.eval(domain, cells).reshape(cells.size, e.X().shape[0], -1)
