"""One body: its mesh in place, element bases, loaded and free faces, elasticity."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np

from iga.elements.bulk import Solid
from iga.elements.shape_functions import BlockBasis, block_basis, chain_basis
from iga.interface.surface import Surface, surface
from iga.mesh.extraction import ElementBlock, Mesh
from iga.mesh.quadrature import gauss, square
from iga.specimen.pose import Pose

#: Intervals between samples along each direction of an element.
ELEMENT_SAMPLES = 3
#: Tolerance for two bodies that differ by a translation, relative to their size.
MOVED_ALIKE = 1e-14


@dataclass(frozen=True)
class Body:
    """A mesh in place whose control points are numbered from ``first`` on in the whole model.

    ``ends`` are the bases on its sides "left" and "right", which are named as before the specimen was put in place.
    """

    mesh: Mesh
    first: int
    solids: tuple[Solid, ...]
    ends: Mapping[str, tuple[BlockBasis, ...]]
    D: np.ndarray

    @property
    def points(self) -> slice:
        """Its control points."""
        return slice(self.first, self.first + len(self.mesh.P_AI))

    @property
    def sampled(self) -> tuple[Solid, ...]:
        """The blocks on a grid of points an element, for pictures; those of a solid in the middle of its width."""
        t, s = np.meshgrid(*[np.linspace(0.0, 1.0, ELEMENT_SAMPLES + 1)] * 2, indexing="ij")
        points_q = np.stack([s.ravel(), t.ravel()], -1)
        if self.mesh.P_AI.shape[1] == 3:
            points_q = np.insert(points_q, 2, 0.0, axis=1)
        grids = (block_basis(self.mesh, block, points_q, np.ones(len(points_q))) for block in self._middle)
        return tuple(Solid(_numbered(basis, self.first), self.D) for basis in grids)

    @property
    def _middle(self) -> Iterator[ElementBlock]:
        """The elements at Z = 0, all of them in the plane."""
        for block in self.mesh.blocks:
            near = np.abs(self.mesh.P_AI[block.conn_ea, 2:]).sum(-1).min(1, initial=np.inf) == 0.0
            here = slice(None) if self.mesh.P_AI.shape[1] == 2 else near
            yield ElementBlock(block.degrees, block.C_eab[here], block.conn_ea[here])

    def surface(self, name: str) -> Surface:
        """The surface of one of the mesh's chains."""
        return surface(self.mesh, self.mesh.chains[name], self.first)


def bodies(
    meshes: tuple[Mesh, ...], elasticity: tuple[np.ndarray, ...], pose: Pose, width: float, smooth: bool
) -> tuple[Body, ...]:
    """Bodies in place, numbered one after the other, from meshes and elasticity matrices in the specimen's own frame.

    ``width`` is a factor of all areas or volumes. ``smooth``: the basis is smoother than C^0 along the specimen. Then p
    Gauss points in that direction, at least two, keep the order (Ciarlet 1978, sec. 4.1); on C^0
    elements they would leave spurious modes.
    """
    made: list[Body] = []
    for number, (mesh, D) in enumerate(zip(meshes, elasticity, strict=True)):
        first, placed = sum(len(body.mesh.P_AI) for body in made), pose.placed(mesh)
        same = (other for other in range(number) if elasticity[other] is D and _alike(meshes[other], mesh))
        other = next(same, None)
        if other is None:
            made.append(_body(placed, first, pose.turned(D), width, smooth))
        else:
            made.append(_moved(made[other], placed, first))
    return tuple(made)


def _alike(a: Mesh, b: Mesh) -> bool:
    """Whether two meshes are translations of each other: they share blocks, chains and weights."""
    if a.blocks is not b.blocks or a.chains is not b.chains or a.w_A is not b.w_A:
        return False
    apart_AI = b.P_AI - a.P_AI
    return bool(np.abs(apart_AI - apart_AI[0]).max() <= MOVED_ALIKE * np.ptp(a.P_AI, axis=0).max())


def _body(mesh: Mesh, first: int, D: np.ndarray, width: float, smooth: bool) -> Body:
    solids = []
    for block in mesh.blocks:
        p, *others = block.degrees
        rules = gauss(max(p, 2) if smooth else p + 1), *(gauss(q + 1) for q in others)
        solids.append(Solid(_numbered(block_basis(mesh, block, *square(*rules), width), first), D))
    through = square(
        *(gauss(max(q) + 1) for q in list(zip(*(block.degrees for block in mesh.blocks), strict=True))[1:])
    )
    ends = {
        name: tuple(_numbered(basis, first) for basis in chain_basis(mesh, mesh.chains[name], *through))
        for name in ("left", "right")
    }
    return Body(mesh, first, tuple(solids), ends, D)


def _moved(original: Body, mesh: Mesh, first: int) -> Body:
    """The body with this mesh, a translation of ``original``, whose functions and gradients it shares."""
    by_I = mesh.P_AI[0] - original.mesh.P_AI[0]

    def here(basis: BlockBasis) -> BlockBasis:
        return replace(basis, conn_ea=basis.conn_ea + (first - original.first), X_eqI=basis.X_eqI + by_I)

    solids = tuple(Solid(here(solid.basis), solid.D) for solid in original.solids)
    ends = {name: tuple(here(basis) for basis in end) for name, end in original.ends.items()}
    return Body(mesh, first, solids, ends, original.D)


def _numbered(basis: BlockBasis, first: int) -> BlockBasis:
    return replace(basis, conn_ea=basis.conn_ea + first)


def face_length(face: tuple[BlockBasis, ...]) -> float:
    return sum(float(basis.dV_eq.sum()) for basis in face)


def mean_row(face: tuple[BlockBasis, ...], direction_i: np.ndarray, n_dof: int) -> np.ndarray:
    """Row (n_dof,) that gives the mean displacement of a face in one direction."""
    row_Ai = _rows(direction_i, n_dof)
    for basis in face:
        weights_ea = np.einsum("eqa,eq->ea", basis.N_eqa, basis.dV_eq)
        np.add.at(row_Ai, basis.conn_ea, weights_ea[..., None] * direction_i)
    return row_Ai.ravel() / face_length(face)


def edge_row(face: tuple[BlockBasis, ...], depth: Callable, direction_i: np.ndarray, n_dof: int) -> np.ndarray:
    """Row (n_dof,) that gives the displacement of a face in one direction at depth 0, by the best-fit straight line
    through the face: the conjugate force is spread over the face, with its resultant at depth 0.

    Parameters
    ----------
    depth : function that gives the depth (...,) of places (..., d) in the face, from 0 to its length
    """
    row_Ai, height = _rows(direction_i, n_dof), face_length(face)
    for basis in face:
        share_eq = (4.0 - 6.0 * depth(basis.X_eqI) / height) * basis.dV_eq
        weights_ea = np.einsum("eqa,eq->ea", basis.N_eqa, share_eq)
        np.add.at(row_Ai, basis.conn_ea, weights_ea[..., None] * direction_i)
    return row_Ai.ravel() / height


def slope_row(face: tuple[BlockBasis, ...], along_I: np.ndarray, across_i: np.ndarray, n_dof: int) -> np.ndarray:
    """Row (n_dof,) that gives the mean slope of a face: displacement across by coordinate along."""
    row_Ai = _rows(across_i, n_dof)
    for basis in face:
        weights_ea = np.einsum("eqIa,eq,I->ea", basis.dN_eqIa, basis.dV_eq, along_I)
        np.add.at(row_Ai, basis.conn_ea, weights_ea[..., None] * across_i)
    return row_Ai.ravel() / face_length(face)


def point_row(A: int, direction_i: np.ndarray, n_dof: int) -> np.ndarray:
    """Row (n_dof,) that gives the displacement of one control point in one direction."""
    row_Ai = _rows(direction_i, n_dof)
    row_Ai[A] = direction_i
    return row_Ai.ravel()


def _rows(direction_i: np.ndarray, n_dof: int) -> np.ndarray:
    return np.zeros((n_dof // direction_i.size, direction_i.size))
