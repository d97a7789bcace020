"""Meshes that a problem states, held against its specimen."""

from __future__ import annotations

from collections.abc import Collection, Iterator

import numpy as np

from iga.interface.surface import surface
from iga.mesh.extraction import Mesh
from iga.specimen.bond import FACING
from iga.specimen.layout import Clamp, Load, Support
from iga.specimen.problem import Debonding

#: Part of a body's length by which its mesh may be off its place.
MISPLACED = 1e-6

#: Bodies of a specimen by their numbers.
BODY_NAMES = ("upper", "lower")


def given(problem: Debonding) -> tuple[Mesh, ...]:
    """The meshes of the modelled bodies among those that a problem states.

    Raises
    ------
    ValueError : not one mesh a body, or a mesh that is not of the specimen (see `misfit`).
    """
    layout, count = problem.layout, len(problem.meshes)
    if count != 2 and not (problem.symmetry and count == 1):
        wanted = "1 or 2 with symmetry" if problem.symmetry else "2"
        raise ValueError(f"meshes: must be {wanted}, the upper body first, got {count}")
    meshes = problem.meshes[: 1 if problem.symmetry else 2]
    for number, mesh in enumerate(meshes):
        body = layout.bodies[number]
        parts: tuple[Load | Support | Clamp, ...] = (*layout.loads, *layout.supports, *layout.clamps)
        sides = {part.side for part in parts if part.body in (None, number)}
        if fault := misfit(mesh, number, (body.length, body.thickness), layout.bonded, sides):
            raise ValueError(f"meshes: {BODY_NAMES[number]} body: {fault}")
    return meshes


def misfit(
    mesh: Mesh, number: int, size: tuple[float, float], bonded: tuple[float, float], acted: Collection[str]
) -> str:
    """Where a mesh is not that of its body, in words with both places; empty where it is.

    Its ends are straight, its face to the other body lies on Y = 0 from end to end, and has element boundaries at both
    ends of the bond. It has its full thickness on the sides that are ``acted`` on; elsewhere its outline is free.

    Parameters
    ----------
    number : 0 of the upper body, 1 of the lower one.
    size : length and thickness of the body.
    bonded : X of the ends of the bond.
    acted : sides that loads, supports and clamps act on.
    """
    return next(_misfits(mesh, number, size, bonded, acted), "")


def _misfits(
    mesh: Mesh, number: int, size: tuple[float, float], bonded: tuple[float, float], acted: Collection[str]
) -> Iterator[str]:
    (length, thickness), facing, outer = size, FACING[number], FACING[1 - number]
    off, far = MISPLACED * length, thickness if number == 0 else -thickness
    names = ("left", "right", *FACING)
    if not set(names) <= set(mesh.chains):
        yield f"must have the sides {', '.join(names)}, got {', '.join(mesh.chains) or 'none'}"
    X_scbI = {side: _bezier_points(mesh, side) for side in names}
    for side, axis, place in (("left", 0, 0.0), ("right", 0, length), (facing, 1, 0.0)):
        found = _farthest(X_scbI[side][..., axis], place)
        if not abs(found - place) <= off:
            yield f"its {side} side must lie on {'XY'[axis]} = {place:g}, got {found:.6g}"
    runs = [(facing, 0, 0.0, length)]
    runs += [(end, 1, min(far, 0.0), max(far, 0.0)) for end in ("left", "right") if end in acted]
    for side, axis, low, high in runs:
        x = X_scbI[side][:, [0, -1], axis]
        if not max(abs(x.min() - low), abs(x.max() - high)) <= off:
            where = f"its {side} side must run from {'XY'[axis]} = {low:g} to {high:g}"
            yield f"{where}, got {x.min():.6g} to {x.max():.6g}"
    reached = _farthest(X_scbI[outer][:, [0, -1], 1], 0.0)
    if outer in acted and not abs(reached - far) <= off:
        yield f"its {outer} side must reach Y = {far:g}, got {reached:.6g}"
    for tip in bonded:
        x = X_scbI[facing][:, [0, -1], 0]
        near = x.ravel()[np.argmin(np.abs(x - tip))]
        if not abs(near - tip) <= off:
            where = f"an element boundary on its {facing} side must lie at the end of the bond, X = {tip:g}"
            yield f"{where}, got {near:.6g} as the nearest"


def _bezier_points(mesh: Mesh, side: str) -> np.ndarray:
    """Bezier points (n_c, p + 1, 2) of a side."""
    face = surface(mesh, mesh.chains[side], 0)
    return face.bezier_points(mesh.P_AI) / face.w_cb[..., None]


def _farthest(x: np.ndarray, place: float) -> float:
    """The value that is farthest from a place."""
    return float(x.ravel()[np.argmax(np.abs(x - place))])
