"""The seam: every discretisation ends here as control points, weights, and Bezier extraction operators.

On element e the functions are ``N_a = sum_b C_eab B_b`` and, with weights, ``R_a = w_a N_a / sum_c w_c N_c``. Whatever
lies beyond (basis, assembly, interface) knows nothing else of a mesh.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

import numpy as np

#: Element sides, named as in the Rhino plug-in's files: (fixed direction, its value).
SIDES = {"LEFT": (0, 0.0), "RIGHT": (0, 1.0), "BOTTOM": (1, 0.0), "TOP": (1, 1.0)}

#: On which hand the element lies, seen along the side's own parameter: +1 to the left, -1 to the right.
HANDS = {"LEFT": -1.0, "RIGHT": 1.0, "BOTTOM": 1.0, "TOP": -1.0}


@dataclass(frozen=True)
class ElementBlock:
    """Elements with the same degrees and the same number of functions.

    ``C_eab`` (n_e, n_a, (p+1)(q+1)) with Bernstein index ``j (p + 1) + i``; ``conn_ea`` (n_e, n_a) control points.
    """

    degrees: tuple[int, int]
    C_eab: np.ndarray
    conn_ea: np.ndarray


@dataclass(frozen=True)
class Chain:
    """An ordered chain of element sides, walked with the body on one hand.

    ``block_c``, ``element_c`` (n_c,) say which element and ``side_c`` (n_c,) which of its sides, by name in `SIDES`.
    ``outward`` is +1 where the body lies to the left of the walking direction, -1 where to the right.
    """

    block_c: np.ndarray
    element_c: np.ndarray
    side_c: np.ndarray
    outward: float

    @property
    def reversed_c(self) -> np.ndarray:
        """Which sides (n_c,) are walked against their own parameter."""
        return np.array([HANDS[side] != self.outward for side in self.side_c], dtype=bool)

    def parts(self) -> Iterator[tuple[np.ndarray, int, str]]:
        """Places in the chain that share a block and a side, with that block and side."""
        for number in np.unique(self.block_c):
            for side in SIDES:
                here = np.flatnonzero((self.block_c == number) & (self.side_c == side))
                if here.size:
                    yield here, int(number), side


@dataclass(frozen=True)
class Mesh:
    """A body: control points ``P_AI`` (n_A, 2), weights ``w_A`` (n_A,), element blocks, and named chains of sides.

    ``order`` is the expected rate of convergence of the displacement in L2, p + 1.
    """

    P_AI: np.ndarray
    w_A: np.ndarray
    blocks: tuple[ElementBlock, ...]
    chains: Mapping[str, Chain] = field(default_factory=dict)

    @property
    def order(self) -> int:
        return min(min(block.degrees) for block in self.blocks) + 1

    @property
    def first_b(self) -> np.ndarray:
        """Numbers of the first element of each block and of the end (n_b + 1,), counted through the blocks."""
        return np.cumsum([0, *(len(block.conn_ea) for block in self.blocks)])

    @property
    def elements(self) -> int:
        return int(self.first_b[-1])


def on_side(degrees: tuple[int, int], side: str) -> np.ndarray:
    """Bernstein indices that do not vanish on a side, along the side's own parameter."""
    direction, value = SIDES[side]
    number = np.arange((degrees[0] + 1) * (degrees[1] + 1)).reshape(degrees[1] + 1, degrees[0] + 1)
    return np.take(number, -int(value), axis=1 - direction)


def one_sided(side: str, block_c: np.ndarray, element_c: np.ndarray) -> Chain:
    """Chain of the same side of all its elements, in the order of the side's own parameter."""
    return Chain(block_c, element_c, np.full(len(element_c), side), HANDS[side])


def tensor_mesh(
    degrees: tuple[int, int],
    C_s: np.ndarray,
    conn_s: np.ndarray,
    C_t: np.ndarray,
    conn_t: np.ndarray,
    P_AI: np.ndarray,
    w_A: np.ndarray,
) -> Mesh:
    """Mesh from 1-D extractions in two directions.

    Parameters
    ----------
    C_s, C_t : (n_es, p + 1, p + 1), (n_et, q + 1, q + 1) extraction operators.
    conn_s, conn_t : (n_es, p + 1), (n_et, q + 1) functions of each span.
    P_AI, w_A : control net with the index along s running fastest.
    """
    p, q = degrees
    n_s, (e_s, e_t) = conn_s.max() + 1, (len(C_s), len(C_t))
    C = np.einsum("fcd,eab->fecadb", C_t, C_s).reshape(e_t * e_s, (q + 1) * (p + 1), (q + 1) * (p + 1))
    conn = (conn_t[:, None, :, None] * n_s + conn_s[None, :, None, :]).reshape(e_t * e_s, -1)
    number = np.arange(e_t * e_s).reshape(e_t, e_s)
    strips = {"LEFT": number[:, 0], "RIGHT": number[:, -1], "BOTTOM": number[0], "TOP": number[-1]}
    chains = {side.lower(): one_sided(side, np.zeros_like(e), e) for side, e in strips.items()}
    return Mesh(P_AI, w_A, (ElementBlock((p, q), C, conn),), chains)
