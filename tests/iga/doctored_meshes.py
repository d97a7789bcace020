"""Mesh files made wrong in one place, as an editor or a faulty exporter would."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from iga.bases.bspline import open_knots
from iga.bases.nurbs import nurbs_rectangle
from iga.mesh.extraction import ElementBlock, Mesh


def arch(degree: int = 3, spans: int = 4) -> Mesh:
    """A bent strip of quadrilaterals with one block; C2 for degree 3, C0 for degree 1."""
    kv = open_knots(np.linspace(0.0, 1.0, spans + 1), degree)
    flat = nurbs_rectangle(kv, kv)
    s, t = flat.P_AI.T
    bent = np.stack([(2.0 - t) * np.cos(0.4 * np.pi * s), (2.0 - t) * np.sin(0.4 * np.pi * s)], -1)
    return replace(flat, P_AI=bent)


def with_block(body: Mesh, **changes) -> Mesh:
    (block,) = body.blocks
    return replace(body, blocks=(replace(block, **changes),))


def with_elements(body: Mesh, e: np.ndarray) -> Mesh:
    """The mesh of some elements in some order, without chains."""
    (block,) = body.blocks
    return replace(with_block(body, C_eab=block.C_eab[e], conn_ea=block.conn_ea[e]), chains={})


def with_copies(body: Mesh, e: np.ndarray, A: np.ndarray, moved: float = 0.0) -> Mesh:
    """Elements e use copies of the control points A, moved along the diagonal."""
    (block,) = body.blocks
    copy_A = np.arange(len(body.P_AI))
    copy_A[A] = len(body.P_AI) + np.arange(len(A))
    conn_ea = block.conn_ea.copy()
    conn_ea[e] = copy_A[conn_ea[e]]
    P_AI, w_A = np.concatenate([body.P_AI, body.P_AI[A] + moved]), np.append(body.w_A, body.w_A[A])
    used, place = np.unique(conn_ea, return_inverse=True)
    copied = replace(body, P_AI=P_AI[used], w_A=w_A[used], chains={})
    return with_block(copied, conn_ea=place.reshape(conn_ea.shape))


def ids_exchanged(body: Mesh) -> Mesh:
    conn_ea = body.blocks[0].conn_ea.copy()
    conn_ea[5, [0, 1]] = conn_ea[5, [1, 0]]
    return with_block(body, conn_ea=conn_ea)


def rows_exchanged(body: Mesh) -> Mesh:
    C_eab = body.blocks[0].C_eab.copy()
    C_eab[5, [5, 6]] = C_eab[5, [6, 5]]
    return with_block(body, C_eab=C_eab)


def coefficient(body: Mesh) -> Mesh:
    """From one function to another, in the middle of a side: the sum is still 1, and so are the corners."""
    C_eab = body.blocks[0].C_eab.copy()
    C_eab[5, 5, 1] += 1e-4
    C_eab[5, 6, 1] -= 1e-4
    return with_block(body, C_eab=C_eab)


def row_scaled(body: Mesh, factor: float = 1.02) -> Mesh:
    C_eab = body.blocks[0].C_eab.copy()
    C_eab[5, 3] *= factor
    return with_block(body, C_eab=C_eab)


def function_scaled(body: Mesh, factor: float = 1.0 + 1e-8) -> Mesh:
    """One function on all of its elements: no tear, as the rational functions divide by the sum."""
    (block,) = body.blocks
    scale_ea = np.where(block.conn_ea == len(body.P_AI) // 2, factor, 1.0)
    return with_block(body, C_eab=block.C_eab * scale_ea[..., None])


def function_halved(body: Mesh) -> Mesh:
    """Two functions for one, each half of it, with the same control point: the sum is the same."""
    (block,) = body.blocks
    conn_ea, C_eab = block.conn_ea, block.C_eab
    here_ea = conn_ea == len(body.P_AI) // 2
    on_e = here_ea.any(1)
    C_eab = np.where(here_ea[..., None], 0.5, 1.0) * C_eab
    extra_eb = np.einsum("ea,eab->eb", here_ea, C_eab)
    more = ElementBlock(
        block.degrees,
        np.concatenate([C_eab, extra_eb[:, None]], axis=1)[on_e],
        np.column_stack([conn_ea, np.full(len(conn_ea), len(body.P_AI))])[on_e],
    )
    rest = replace(block, C_eab=C_eab[~on_e], conn_ea=conn_ea[~on_e])
    P_AI, w_A = (np.concatenate([part, part[len(part) // 2 :][:1]]) for part in (body.P_AI, body.w_A))
    return Mesh(P_AI, w_A, (rest, more) if not on_e.all() else (more,))


def point_unused(body: Mesh) -> Mesh:
    return replace(body, P_AI=np.concatenate([body.P_AI, body.P_AI[:1]]), w_A=np.append(body.w_A, 1.0), chains={})


def every(body: Mesh) -> np.ndarray:
    return np.arange(body.elements)


def inner(body: Mesh) -> int:
    """A control point inside an inner element."""
    return int(body.blocks[0].conn_ea[5, -1])


def over(body: Mesh) -> Mesh:
    """One more element over the others, which shares a corner with them."""
    more = with_elements(body, np.append(every(body), 5))
    return with_copies(more, np.array([body.elements]), body.blocks[0].conn_ea[5, 1:], 0.1)


#: What is wrong -> a function that makes it so.
SMOOTH: dict[str, tuple[Callable[[Mesh], Mesh], str]] = {
    "ids of one element exchanged": (ids_exchanged, "torn"),
    "rows of one element exchanged": (rows_exchanged, "falls into 2 pieces"),
    "a coefficient of a side": (coefficient, "torn"),
    "a row scaled": (row_scaled, "the sum of the functions misses 1 by"),
    "a function scaled": (function_scaled, "the sum of the functions misses 1 by 4.4"),
    "an element twice": (lambda b: with_elements(b, np.append(every(b), 5)), "elements lie on each other"),
    "an element at the corner twice": (
        lambda b: with_elements(b, np.append(every(b), 0)),
        "elements lie on each other",
    ),
    "an element missing": (lambda b: with_elements(b, np.delete(every(b), 5)), "an element is missing"),
    "an element at the boundary missing": (lambda b: with_elements(b, np.delete(every(b), 1)), "an element is missing"),
    "an element with a node of its own": (lambda b: with_copies(b, np.array([5]), np.array([inner(b)])), "torn"),
    "an element off by a hair": (lambda b: with_copies(b, np.array([5]), np.array([inner(b)]), 1e-5), "torn"),
    "an element off by a bit": (lambda b: with_copies(b, np.array([5]), np.array([inner(b)]), 0.05), "torn"),
    "two halves": (lambda b: with_copies(b, every(b)[8:], np.arange(len(b.P_AI))), "falls into 2 pieces"),
    "an element on its own": (lambda b: with_copies(b, np.array([0]), np.arange(len(b.P_AI))), "falls into 2 pieces"),
    "torn along a line": (lambda b: with_copies(b, every(b)[8:10], b.blocks[0].conn_ea[8, :4]), "torn"),
}

C0: dict[str, tuple[Callable[[Mesh], Mesh], str]] = {
    "an element twice": SMOOTH["an element twice"],
    "two halves": SMOOTH["two halves"],
    "an element with a node of its own": SMOOTH["an element with a node of its own"],
    "an element off by a hair": (lambda b: with_copies(b, np.array([5]), np.array([inner(b)]), 1e-5), "torn"),
    "an element off inwards by a hair": (lambda b: with_copies(b, np.array([5]), np.array([inner(b)]), -1e-5), "torn"),
    "an element that overlaps others": (lambda b: with_copies(b, np.array([5]), np.array([inner(b)]), 0.05), "overlap"),
    "torn along a line": (lambda b: with_copies(b, every(b)[8:10], np.array([11])), "torn: 4 sides"),
    "an element over others": (over, "falls into 2 pieces"),
}
