"""Meshes of nodal elements by extraction: quadrilaterals and triangles of degree 1 and 2."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from iga.files.cad_body import RECTANGLE, refuse_folded, straight_side
from iga.mesh.bernstein import bernstein, tensor
from iga.mesh.edges import element_sides
from iga.mesh.extraction import ElementBlock, Mesh


@dataclass(frozen=True)
class Nodal:
    """An element: ``nodes_aI`` (n_a, 2) on its reference cell, corners first, and the powers (n_a, 2) of the monomials
    that its functions consist of. ``corners`` is 3 for the triangle (0, 0), (1, 0), (0, 1), 4 for the unit square.
    """

    corners: int
    degree: int
    nodes_aI: np.ndarray
    powers_mI: np.ndarray

    def functions(self, x_qI: np.ndarray) -> np.ndarray:
        """The functions (n_q, n_a) at points of the reference cell: N_a(x_c) = delta_ac."""
        return _monomials(x_qI, self.powers_mI) @ np.linalg.inv(_monomials(self.nodes_aI, self.powers_mI))


def _monomials(x_qI: np.ndarray, powers_mI: np.ndarray) -> np.ndarray:
    return np.prod(x_qI[:, None] ** powers_mI, axis=2)


def _nodal(corners: list, degree: int, powers: list, inner: tuple = ()) -> Nodal:
    ends = np.array(corners, dtype=float)
    middles = 0.5 * (ends + np.roll(ends, -1, axis=0)) if degree == 2 else np.empty((0, 2))
    return Nodal(len(ends), degree, np.concatenate([ends, middles, np.reshape(inner, (-1, 2))]), np.array(powers))


_SQUARE, _TRIANGLE = [(0, 0), (1, 0), (1, 1), (0, 1)], [(0, 0), (1, 0), (0, 1)]
_P1 = [(0, 0), (1, 0), (0, 1)]
_Q1 = [*_P1, (1, 1)]
_P2 = [*_Q1, (2, 0), (0, 2)]
_SERENDIPITY = [*_P2, (2, 1), (1, 2)]

#: Elements by their number of nodes: corners counter-clockwise, the middles of the sides between them, the centre.
NODAL: Mapping[int, Nodal] = {
    3: _nodal(_TRIANGLE, 1, _P1),
    4: _nodal(_SQUARE, 1, _Q1),
    6: _nodal(_TRIANGLE, 2, _P2),
    8: _nodal(_SQUARE, 2, _SERENDIPITY),
    9: _nodal(_SQUARE, 2, [*_SERENDIPITY, (2, 2)], (0.5, 0.5)),
}


def nodal_body(X_nI: np.ndarray, conn_kea: Mapping[int, np.ndarray]) -> Mesh:
    """The mesh of a rectangle of nodal elements, with the chains ``left``, ``right``, ``bottom`` and ``top``.

    A triangle is three quadrilaterals, each from a corner to the centre. On them its reference coordinates are
    bilinear, hence its functions of degree p are polynomials of degree p in either direction: the space is that of the
    triangle.

    Parameters
    ----------
    X_nI : (n, 2) nodes [length]
    conn_kea : number of nodes -> (n_e, n_a) elements, in the order of `NODAL`

    Raises
    ------
    ValueError : a Jacobian that is not positive, or a side that is not one straight chain.
    """
    blocks = tuple(_block(NODAL[count], conn_ea) for count, conn_ea in conn_kea.items())
    body = Mesh(X_nI, np.ones(len(X_nI)), blocks)
    refuse_folded(body)
    sides = element_sides(body)
    chains = {side: straight_side(sides, side) for side in RECTANGLE}
    return Mesh(body.P_AI, body.w_A, blocks, chains)


def _block(nodal: Nodal, conn_ea: np.ndarray) -> ElementBlock:
    parts = [_extraction(nodal, corners) for corners in _quadrilaterals(nodal)]
    C_eab = np.tile(np.stack(parts), (len(conn_ea), 1, 1))
    return ElementBlock((nodal.degree,) * 2, C_eab, np.repeat(conn_ea, len(parts), axis=0))


def _quadrilaterals(nodal: Nodal) -> list[np.ndarray]:
    """Corners (4, 2), counter-clockwise, of the quadrilaterals that make the reference cell."""
    ends = nodal.nodes_aI[: nodal.corners]
    if nodal.corners == 4:
        return [ends]
    after, before = 0.5 * (ends + np.roll(ends, -1, axis=0)), 0.5 * (ends + np.roll(ends, 1, axis=0))
    return [np.stack([ends[i], after[i], ends.mean(0), before[i]]) for i in range(3)]


def _extraction(nodal: Nodal, corners: np.ndarray) -> np.ndarray:
    """C_ab with N_a = sum_b C_ab B_b on a quadrilateral, from both at (p + 1)^2 points: C = (B^-1 N)^T."""
    p = nodal.degree
    t, s = (grid.ravel() for grid in np.meshgrid(*[np.linspace(0.0, 1.0, p + 1)] * 2, indexing="ij"))
    bilinear_qc = NODAL[4].functions(np.stack([s, t], -1))
    C_ab = np.linalg.solve(tensor(bernstein(p, s), bernstein(p, t)), nodal.functions(bilinear_qc @ corners)).T
    return np.where(np.abs(C_ab) < 1e-14, 0.0, C_ab)  # rounding where a function vanishes
