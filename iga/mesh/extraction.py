"""The common form of all discretisations: control points, weights and Bezier extraction operators.

On element e the functions are ``N_a = sum_b C_eab B_b`` and, with weights, ``R_a = w_a N_a / sum_c w_c N_c`` (Borden,
Scott, Evans, Hughes 2011). Assembly and interface depend on nothing else of a mesh.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

import numpy as np

from iga.mesh.bernstein import bernstein

#: Element sides by the names of the Rhino plug-in's files: (direction whose parameter is constant, its value).
SIDES = {"LEFT": (0, 0.0), "RIGHT": (0, 1.0), "BOTTOM": (1, 0.0), "TOP": (1, 1.0)}

#: Where the element lies, seen along the side's parameter: +1 to the left, -1 to the right.
HANDS = {"LEFT": -1.0, "RIGHT": 1.0, "BOTTOM": 1.0, "TOP": -1.0}


@dataclass(frozen=True)
class ElementBlock:
    """Elements with the same degrees and the same number of functions.

    ``C_eab`` (n_e, n_a, (p+1)(q+1)) with Bernstein index ``j (p + 1) + i``, in a solid ``(k (q + 1) + j) (p + 1) + i``;
    ``conn_ea`` (n_e, n_a) control points.
    """

    degrees: tuple[int, ...]
    C_eab: np.ndarray
    conn_ea: np.ndarray


@dataclass(frozen=True)
class Chain:
    """An ordered chain of element sides.

    ``block_c``, ``element_c`` (n_c,) are block and number of the elements, ``side_c`` (n_c,) their sides by name in
    `SIDES`. ``outward`` is +1 if the body lies to the left of the walking direction, -1 if to the right.
    """

    block_c: np.ndarray
    element_c: np.ndarray
    side_c: np.ndarray
    outward: float

    @property
    def reversed_c(self) -> np.ndarray:
        """Mask (n_c,) of the sides that are walked against their own parameter."""
        return np.array([HANDS[side] != self.outward for side in self.side_c], dtype=bool)

    def across(self, n_f: int) -> Chain:
        """The faces over these sides in a `prism` of ``n_f`` elements across."""
        element_c = (self.element_c[:, None] * n_f + np.arange(n_f)).ravel()
        return Chain(np.repeat(self.block_c, n_f), element_c, np.repeat(self.side_c, n_f), self.outward)

    def parts(self) -> Iterator[tuple[np.ndarray, int, str]]:
        """For each block and side in the chain: the indices (n,) of these sides in the chain, the block, the side."""
        for number in np.unique(self.block_c):
            for side in SIDES:
                here = np.flatnonzero((self.block_c == number) & (self.side_c == side))
                if here.size:
                    yield here, int(number), side


@dataclass(frozen=True)
class Mesh:
    """A body: control points ``P_AI`` (n_A, d), weights ``w_A`` (n_A,), element blocks, and named chains of sides."""

    P_AI: np.ndarray
    w_A: np.ndarray
    blocks: tuple[ElementBlock, ...]
    chains: Mapping[str, Chain] = field(default_factory=dict)

    @property
    def order(self) -> int:
        """Expected rate of convergence of the displacement in L2, p + 1."""
        return min(min(block.degrees) for block in self.blocks) + 1

    @property
    def first_b(self) -> np.ndarray:
        """Numbers (n_b + 1,) of the first element of each block, and of all elements, counted through the blocks."""
        return np.cumsum([0, *(len(block.conn_ea) for block in self.blocks)])

    @property
    def elements(self) -> int:
        """Number of elements."""
        return int(self.first_b[-1])

    def _repr_html_(self) -> str:
        from iga.notebook import drawn

        H_AI, t = np.column_stack([self.P_AI * self.w_A[:, None], self.w_A]), np.linspace(0.0, 1.0, 2 * self.order)
        lines: list[np.ndarray] = []
        for block in self.blocks:
            H_ebI = block.C_eab.swapaxes(1, 2) @ H_AI[block.conn_ea]
            for side in SIDES:
                along = on_side(block.degrees, side)
                h_etI = bernstein(len(along) - 1, t) @ H_ebI[:, along]
                lines.extend(h_etI[..., :2] / h_etI[..., 2:])
        return drawn(lines, f"{self.elements} elements, {len(self.P_AI)} control points")


def on_side(degrees: tuple[int, ...], side: str) -> np.ndarray:
    """Bernstein indices that do not vanish on a side, along the side's own parameter."""
    direction, value = SIDES[side]
    shape = [p + 1 for p in reversed(degrees)]
    return np.take(np.arange(np.prod(shape)).reshape(shape), -int(value), axis=-1 - direction).ravel()


def one_sided(side: str, block_c: np.ndarray, element_c: np.ndarray) -> Chain:
    """Chain of the same side of all its elements, in the order of the side's own parameter."""
    return Chain(block_c, element_c, np.full(len(element_c), side), HANDS[side])


@dataclass(frozen=True)
class Spans:
    """The elements of one direction: ``C_eab`` (n_e, p + 1, p + 1) extraction, ``conn_ea`` (n_e, p + 1) functions."""

    C_eab: np.ndarray
    conn_ea: np.ndarray


def tensor_mesh(spans_s: Spans, spans_t: Spans, P_AI: np.ndarray, w_A: np.ndarray) -> Mesh:
    """Tensor-product mesh of two directions, with the chains ``left``, ``right``, ``bottom`` and ``top``.

    Parameters
    ----------
    P_AI, w_A : (n_A, 2) control points and (n_A,) weights, the index along s running fastest.
    """
    (e_s, p_1), (e_t, q_1) = spans_s.conn_ea.shape, spans_t.conn_ea.shape
    n_s, n_b = spans_s.conn_ea.max() + 1, p_1 * q_1
    C_eab = np.einsum("fcd,eab->fecadb", spans_t.C_eab, spans_s.C_eab).reshape(e_t * e_s, n_b, n_b)
    conn_ea = (spans_t.conn_ea[:, None, :, None] * n_s + spans_s.conn_ea[None, :, None, :]).reshape(e_t * e_s, n_b)
    number = np.arange(e_t * e_s).reshape(e_t, e_s)
    strips = {"LEFT": number[:, 0], "RIGHT": number[:, -1], "BOTTOM": number[0], "TOP": number[-1]}
    chains = {side.lower(): one_sided(side, np.zeros_like(e), e) for side, e in strips.items()}
    return Mesh(P_AI, w_A, (ElementBlock((p_1 - 1, q_1 - 1), C_eab, conn_ea),), chains)


def prism(mesh: Mesh, spans: Spans, z_k: np.ndarray) -> Mesh:
    """The solid of a plane mesh over the control values z_k (n_k,) of a third direction, by products of extractions.

    Elements, functions and control points along the third direction run fastest: few of them are between neighbours
    along the specimen. Sides become faces, each a row of elements.
    """
    (n_f, r_1), n_k = spans.conn_ea.shape, len(z_k)
    blocks = []
    for block in mesh.blocks:
        (n_e, n_a), n_b = block.conn_ea.shape, block.C_eab.shape[2]
        C_eab = np.einsum("eab,fcd->efacdb", block.C_eab, spans.C_eab).reshape(n_e * n_f, n_a * r_1, r_1 * n_b)
        conn_efac = block.conn_ea[:, None, :, None] * n_k + spans.conn_ea[None, :, None, :]
        blocks.append(ElementBlock((*block.degrees, r_1 - 1), C_eab, conn_efac.reshape(n_e * n_f, n_a * r_1)))
    chains = {name: chain.across(n_f) for name, chain in mesh.chains.items()}
    P_AI = np.column_stack([np.repeat(mesh.P_AI, n_k, axis=0), np.tile(z_k, len(mesh.P_AI))])
    return Mesh(P_AI, np.repeat(mesh.w_A, n_k), tuple(blocks), chains)
