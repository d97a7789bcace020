"""Functions, positions and normals on sides of elements."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from iga.mesh.bernstein import bernstein, bernstein_derivative
from iga.mesh.extraction import HANDS, SIDES, Chain, Mesh, on_side
from iga.mesh.quadrature import gauss


@dataclass(frozen=True)
class SidePoints:
    """Gauss points on sides of one name of the elements of one block.

    ``conn_ea`` (n_e, n_a) control points, ``N_eqa`` (n_e, n_q, n_a) functions, ``X_eqI`` (n_e, n_q, 2) positions,
    ``ndL_eqI`` (n_e, n_q, 2) outward normal times the length of each point.
    """

    conn_ea: np.ndarray
    N_eqa: np.ndarray
    X_eqI: np.ndarray
    ndL_eqI: np.ndarray

    @property
    def dL_eq(self) -> np.ndarray:
        """Length (n_e, n_q) of each point."""
        return np.linalg.norm(self.ndL_eqI, axis=-1)


def side_points(mesh: Mesh, chains: Sequence[Chain], more: int) -> tuple[SidePoints, ...]:
    """p + 1 + ``more`` Gauss points on every side of some chains, one entry per block and name of the side."""
    return tuple(
        _on_side(mesh, number, chain.element_c[here], side, more)
        for chain in chains
        for here, number, side in chain.parts()
    )


def _on_side(mesh: Mesh, number: int, e: np.ndarray, side: str, more: int) -> SidePoints:
    block = mesh.blocks[number]
    p = block.degrees[1 - SIDES[side][0]]
    xi_q, weight_q = gauss(p + 1 + more)
    trace_eab = block.C_eab[e][:, :, on_side(block.degrees, side)]
    conn_ea = block.conn_ea[e]
    wC_eab = trace_eab * mesh.w_A[conn_ea][..., None]
    wN, wdN = (np.einsum("eab,qb->eqa", wC_eab, B(p, xi_q)) for B in (bernstein, bernstein_derivative))
    W, dW = wN.sum(-1, keepdims=True), wdN.sum(-1, keepdims=True)
    N_eqa = wN / W
    X_eqI, tangent_eqI = (np.einsum("eqa,eaI->eqI", v, mesh.P_AI[conn_ea]) for v in (N_eqa, (wdN - N_eqa * dW) / W))
    outward = HANDS[side] * np.stack([tangent_eqI[..., 1], -tangent_eqI[..., 0]], -1)
    return SidePoints(conn_ea, N_eqa, X_eqI, outward * weight_q[:, None])
