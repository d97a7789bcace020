"""Bezier extraction files (`.iga`) of the Rhino T-spline plug-in: their content, their mesh, and writing them.

`IgaFile` keeps the order of the elements and of the functions of each element, so that a file that is read and written
again is the same to the last bit.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from iga.mesh.bezier import homogeneous, jacobian
from iga.mesh.edges import chains_of, element_sides
from iga.mesh.extraction import Chain, ElementBlock, Mesh
from iga.mesh.mirror import SEEN_FROM_BEHIND, block_from_behind
from iga.mesh.quadrature import gauss, square

#: Types of files; only the first is a body in the plane.
FILE_KINDS = ("plane", "surface", "thickened_surface", "volume")

#: Third coordinates below this part of the body's extent are rounding.
IN_PLANE = 1e-12


@dataclass(frozen=True)
class NamedSet:
    """A named set of nodes, element sides or elements.

    ``kind`` is ``node``, ``side`` or ``elem``; ``ids`` (k,) count from 0; ``sides`` (k,), of element sides alone, are
    names in `SIDES`.
    """

    kind: str
    name: str
    ids: np.ndarray
    sides: tuple[str, ...] = ()


@dataclass(frozen=True)
class Domain:
    """A part of the elements with its own numbering of their functions.

    ``elements`` (n,), ``functions`` (m,); ``places[i]`` are the indices in ``functions`` of the functions of element i.
    """

    elements: np.ndarray
    functions: np.ndarray
    places: tuple[np.ndarray, ...]


@dataclass(frozen=True)
class IgaFile:
    """The content of an `.iga` file.

    ``P_AI`` (n_A, 3) control points, not homogeneous, ``w_A`` (n_A,) weights > 0. Element e of the file is number
    ``place_e[e]`` of block ``block_e[e]``; in a file of volumes a block has three degrees.
    """

    kind: str
    P_AI: np.ndarray
    w_A: np.ndarray
    blocks: tuple[ElementBlock, ...]
    block_e: np.ndarray
    place_e: np.ndarray
    sets: tuple[NamedSet, ...] = ()
    domains: tuple[Domain, ...] = ()


def mesh(file: IgaFile) -> Mesh:
    """The body in the plane that a file describes, with a chain for every side set that is a part of its boundary.

    In elements whose s and t turn clockwise, s is reversed (LEFT becomes RIGHT), so that Jacobians are positive. Chains
    are walked with the body on the left. A side set of several pieces becomes the chains ``NAME-1``, ``NAME-2``, ...; a
    side set with sides inside the body, such as a diagonal, becomes no chain.

    Raises
    ------
    ValueError : the file does not describe a plane, or has control points outside the plane z = 0.
    """
    if file.kind != "plane":
        raise ValueError(f"type: must be plane for a body in the plane, got {file.kind}")
    _refuse_lifted(file.P_AI)
    body = Mesh(np.ascontiguousarray(file.P_AI[:, :2]), file.w_A, file.blocks)
    turned = [_clockwise(body, block) for block in file.blocks]
    body = replace(body, blocks=tuple(block_from_behind(*pair) for pair in zip(file.blocks, turned, strict=True)))
    sets = {part.name: part for part in file.sets if part.kind == "side"}
    if not sets:
        return body
    all_sides = element_sides(body)
    chains: dict[str, Chain] = {}
    for name, part in sets.items():
        block_c, element_c = file.block_e[part.ids], file.place_e[part.ids]
        behind_c = np.array([turned[b][e] for b, e in zip(block_c, element_c, strict=True)], dtype=bool)
        seen = [SEEN_FROM_BEHIND.get(s, s) if behind else s for s, behind in zip(part.sides, behind_c, strict=True)]
        pieces = chains_of(all_sides, all_sides.find(block_c, element_c, np.array(seen)))
        numbers = [""] if len(pieces) == 1 else [f"-{i + 1}" for i in range(len(pieces))]
        chains |= {name + number: piece for number, piece in zip(numbers, pieces, strict=True)}
    return replace(body, chains=chains)


def _refuse_lifted(P_AI: np.ndarray) -> None:
    lifted_A = np.abs(P_AI[:, 2]) > IN_PLANE * np.ptp(P_AI[:, :2], axis=0).max()
    if np.any(lifted_A):
        A = int(np.argmax(lifted_A))
        raise ValueError(f"node {A}: z must be 0 in a plane, got {P_AI[A, 2]:.6g} (nodes count from 0)")


def write_iga(file: IgaFile, path: Path | str) -> None:
    """Write a file with 17 significant digits, which preserve every bit of a number.

    Raises
    ------
    OSError : the path cannot be written to.
    """
    Path(path).write_text("".join(f"{line}\n" for line in _lines(file)), encoding="utf-8", newline="\n")


def _lines(file: IgaFile) -> Iterator[str]:
    yield f"type {file.kind}"
    yield f"nodeN {len(file.P_AI)}"
    yield f"elemN {len(file.block_e)}"
    for row in np.column_stack([file.P_AI, file.w_A]):
        yield f"node {_numbers(map(float, row))}"
    for b, e in zip(file.block_e, file.place_e, strict=True):
        block = file.blocks[b]
        C_ab = block.C_eab[e]
        yield f"belem {len(C_ab)} {_words(block.degrees)}"
        yield _words(block.conn_ea[e])
        yield from map(_numbers, C_ab.tolist())
    for part in file.sets:
        entries = (f"{i} {side}" for i, side in zip(part.ids, part.sides, strict=True)) if part.sides else part.ids
        yield f"set {len(part.ids)} {part.kind} {part.name} {_words(entries)}"
    for domain in file.domains:
        yield f"domain {len(domain.elements)} {len(domain.functions)}"
        yield from (_words(numbers) for numbers in (domain.elements, domain.functions, *domain.places))


def _words(values: Iterable) -> str:
    return " ".join(map(str, values))


def _numbers(values: Iterable[float]) -> str:
    return " ".join([f"{value:.17g}" for value in values])


def _clockwise(body: Mesh, block: ElementBlock) -> np.ndarray:
    """Elements (n_e,) of negative area."""
    p, q = block.degrees
    points_q, weights_q = square(gauss(p + 1), gauss(q + 1))
    return jacobian(homogeneous(body.P_AI, body.w_A, block), block.degrees, points_q) @ weights_q < 0
