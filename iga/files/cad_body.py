"""The body of a CAD file, its four sides found by the names of side sets or by their place."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import numpy as np

from iga.files.iga_format import IgaFile, mesh
from iga.files.iga_reader import read_iga
from iga.mesh.bezier import homogeneous, jacobian
from iga.mesh.edges import SAME_POINT, Sides, chains_of, element_sides
from iga.mesh.extraction import Chain, Mesh
from iga.mesh.quadrature import gauss, square
from iga.mesh.soundness import dependence, faults, unity_fault

#: Sides of a rectangle: (coordinate that is constant, whether it is the largest, `Chain.outward`). The chains run along
#: the axes, like those of a tensor-product mesh.
RECTANGLE = {"left": (0, False, -1.0), "right": (0, True, 1.0), "bottom": (1, False, 1.0), "top": (1, True, -1.0)}

#: Words that the name of a set may have beside that of the side: `Left_side`, `edges_left`.
_FILLERS = {"side", "sides", "edge", "edges", "boundary", "face", "set"}


def body_mesh(path: Path | str) -> Mesh:
    """The body of an `.iga` file with the chains ``left``, ``right``, ``bottom`` and ``top`` in addition to its sets.

    A side is the side set of its name (`left`, `Left_side`, `edges_left`); if there is none, the part of the boundary
    on that line of the bounding box. ``left`` and ``right`` run upwards, ``bottom`` and ``top`` to the right.

    Raises
    ------
    ValueError : the file is malformed (`IgaError`, with the line) or not a plane, a Jacobian is not positive, the mesh
        is torn or doubled (`iga.mesh.soundness`), or a side is missing or not one chain.
    OSError : the file cannot be read.
    """
    file = read_iga(path)
    try:
        body = mesh(file)
        refuse_folded(body)
        sides = element_sides(body)
        if unsound := (*faults(body, sides), *unity_fault(body), *dependence(body)):
            raise ValueError("; ".join(unsound))
        chains = {side: _side(file, body, sides, side) for side in RECTANGLE}
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from None
    return replace(body, chains={**body.chains, **chains})


def _side(file: IgaFile, body: Mesh, sides: Sides, side: str) -> Chain:
    """One side, by the name of a set or by its place."""
    names = [part.name for part in file.sets if part.kind == "side" and _plain(part.name) == side]
    if len(names) > 1:
        raise ValueError(f"the {side} side must be one side set, got {' and '.join(names)}")
    if names and names[0] not in body.chains:
        raise ValueError(
            f"side set {names[0]}: must be one connected chain of sides of the boundary to be the {side} side"
        )
    return _along_axes(body.chains[names[0]], side) if names else straight_side(sides, side)


def straight_side(sides: Sides, side: str) -> Chain:
    """The boundary on one line of the bounding box; raises ValueError where it is not one chain."""
    axis, largest, _ = RECTANGLE[side]
    boundary = np.flatnonzero(~sides.shared_k)
    x_kb = sides.H_kbI[boundary, :, axis] / sides.H_kbI[boundary, :, 3]
    edge = x_kb[:, [0, -1]].max() if largest else x_kb[:, [0, -1]].min()
    on = np.all(np.abs(x_kb - edge) < SAME_POINT * sides.size_k[boundary, None], axis=1)
    chains = chains_of(sides, boundary[on])
    if len(chains) != 1:
        found = f"{len(chains)} pieces of the boundary lie" if chains else "no side of the boundary lies"
        where = f"{'xy'[axis]} = {edge:.6g}"
        raise ValueError(f"no side set is named {side}, and {found} on the {side} of the bounding box, {where}")
    return _along_axes(chains[0], side)


def _plain(name: str) -> str:
    """The name of a set in lower case without the filler words."""
    words = re.findall(r"[A-Z]?[a-z]+|[A-Z]+(?![a-z])|[^\W_a-zA-Z]+", name)
    return " ".join(word.lower() for word in words if word.lower() not in _FILLERS)


def _along_axes(chain: Chain, side: str) -> Chain:
    if chain.outward == RECTANGLE[side][2]:
        return chain
    return Chain(chain.block_c[::-1], chain.element_c[::-1], chain.side_c[::-1], -chain.outward)


def refuse_folded(body: Mesh) -> None:
    """Raise ValueError where a Jacobian is not positive."""
    for block in body.blocks:
        p, q = block.degrees
        points_q, _ = square(gauss(p + 1), gauss(q + 1))
        det_eq = jacobian(homogeneous(body.P_AI, body.w_A, block), block.degrees, points_q)
        if not np.all(det_eq > 0):
            e = int(np.argmin(det_eq.min(1)))
            x = body.P_AI[block.conn_ea[e]].mean(0)
            raise ValueError(
                f"Jacobians must be > 0, got {det_eq.min():.3g} in an element near ({x[0]:.4g}, {x[1]:.4g})"
            )
