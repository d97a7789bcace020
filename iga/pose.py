"""Where a specimen lies: mirrored, turned and moved, with all that belongs to it."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from iga.extraction import Chain, ElementBlock, Mesh
from iga.kinematics import elasticity_tensor

#: Sides of an element seen from the other end.
SEEN_FROM_BEHIND = {"LEFT": "RIGHT", "RIGHT": "LEFT"}


@dataclass(frozen=True)
class Pose:
    """The specimen's own frame in the plane: ``X = shift + Q M X_own``.

    M reflects X -> -X where ``mirror`` is set, Q turns by ``angle`` degrees counter-clockwise.
    """

    angle: float = 0.0
    mirror: bool = False
    shift: tuple[float, float] = (0.0, 0.0)

    @cached_property
    def axes_kI(self) -> np.ndarray:
        """Unit vectors (2, 2) along and across the specimen, one a row."""
        c, s = np.cos(np.radians(self.angle)), np.sin(np.radians(self.angle))
        sign = -1.0 if self.mirror else 1.0
        return np.array([[sign * c, sign * s], [-s, c]])

    def place(self, X_own: np.ndarray) -> np.ndarray:
        """Places (..., 2) of points given in the specimen's own frame."""
        return X_own @ self.axes_kI + np.asarray(self.shift)

    def own(self, X: np.ndarray) -> np.ndarray:
        """Coordinates (..., 2) of places in the specimen's own frame."""
        return self.components(X - np.asarray(self.shift))

    def components(self, v: np.ndarray) -> np.ndarray:
        """Components (..., 2) of vectors along and across the specimen."""
        return v @ self.axes_kI.T

    def turned(self, D: np.ndarray) -> np.ndarray:
        """Elasticity matrix (3, 3) of a material whose axis 1 lies along the specimen: ``C_IJKL`` in the plane."""
        a = self.axes_kI
        C = np.einsum("mI,nJ,oK,pL,mnop->IJKL", a, a, a, a, elasticity_tensor(D))
        place = [(0, 0), (1, 1), (0, 1)]
        return np.array([[C[*row, *column] for column in place] for row in place])

    def placed(self, mesh: Mesh) -> Mesh:
        """A mesh made in the own frame at its place; a mirrored one runs backwards, to keep its Jacobians positive."""
        mesh = from_behind(mesh) if self.mirror else mesh
        return replace(mesh, P_AI=self.place(mesh.P_AI))


def from_behind(mesh: Mesh) -> Mesh:
    """The same body with the first parametric direction of every element reversed."""
    blocks = tuple(block_from_behind(block, np.ones(len(block.conn_ea), dtype=bool)) for block in mesh.blocks)
    chains = {
        name: Chain(
            chain.block_c[::-1],
            chain.element_c[::-1],
            np.array([SEEN_FROM_BEHIND.get(side, side) for side in chain.side_c[::-1]]),
            chain.outward,
        )
        for name, chain in mesh.chains.items()
    }
    return replace(mesh, blocks=blocks, chains=chains)


def block_from_behind(block: ElementBlock, turned_e: np.ndarray) -> ElementBlock:
    """The block with the first parametric direction of some of its elements (n_e,) reversed."""
    p, q = block.degrees
    back_b = np.arange((p + 1) * (q + 1)).reshape(q + 1, p + 1)[:, ::-1].ravel()
    return replace(block, C_eab=np.where(turned_e[:, None, None], block.C_eab[:, :, back_b], block.C_eab))


def upside_down(mesh: Mesh) -> Mesh:
    """The mirror image of a body in Y = 0; what was its bottom is its top."""
    back = from_behind(mesh)
    other = {"bottom": "top", "top": "bottom"}
    chains = {other.get(name, name): chain for name, chain in back.chains.items()}
    return replace(back, P_AI=back.P_AI * [1.0, -1.0], chains=chains)
