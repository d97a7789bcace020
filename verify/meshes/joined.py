"""Two arms as one mesh that shares the nodes of the interface, of straight elements of one kind."""

from __future__ import annotations

import numpy as np

from verify.meshes.arms import Arm, corner_count, corners_on, height
from verify.scene.specimens.delamination import Delamination

#: Part of a side's length by which its middle node may lie beside the middle.
STRAIGHT = 1e-6


def joined(arms: tuple[Arm, Arm], who: str = "dolfinx") -> tuple[np.ndarray, np.ndarray]:
    """Nodes (n, 2) and corners (n_e, 3 or 4) of both arms, for whom.

    Raises
    ------
    ValueError : triangles beside quadrilaterals, sides that are not straight with their node in the middle, or faces
        whose nodes do not match on Y = 0.
    """
    conns = [conn for arm in arms for conn in arm.conn_kea.values()]
    kinds = {corner_count(conn) for conn in conns}
    if len(kinds) > 1:
        raise ValueError(f"must hold triangles or quadrilaterals alone for {who}, got both")
    for arm in arms:
        _require_straight(arm, who)
    (count,) = kinds
    parts = [np.concatenate([conn[:, :count] for conn in arm.conn_kea.values()]) for arm in arms]
    used = [np.unique(part) for part in parts]
    faces = [np.sort(arm.X_nI[n][arm.X_nI[n, 1] == 0.0, 0]) for arm, n in zip(arms, used, strict=True)]
    size = max(np.ptp(face) for face in faces)
    if len(faces[0]) != len(faces[1]) or np.abs(faces[0] - faces[1]).max() > STRAIGHT * size / len(faces[0]):
        raise ValueError(f"nodes of both arms must match on Y = 0 for {who}, got {len(faces[0])} and {len(faces[1])}")
    first = len(used[0])
    points = np.concatenate([arm.X_nI[n] for arm, n in zip(arms, used, strict=True)])
    number_n = np.arange(len(points))
    above, below = (
        np.flatnonzero(points[part, 1] == 0.0) + at for part, at in ((slice(first), 0), (slice(first, None), first))
    )
    number_n[below[np.argsort(points[below, 0])]] = above[np.argsort(points[above, 0])]
    kept, compact_n = np.unique(number_n, return_inverse=True)
    local = [np.searchsorted(n, part) + at for n, part, at in zip(used, parts, (0, first), strict=True)]
    return points[kept], np.ravel(compact_n)[np.concatenate(local)]


def require_patch_ends(arms: tuple[Arm, Arm], specimen: Delamination, who: str = "dolfinx") -> None:
    """Raise ValueError where a load or a support ends within a side of an element, for those who have whole sides."""
    for patch in specimen.patches:
        corner_n = corners_on(arms[patch.body or 0], height(patch, specimen))
        for end in patch.extent or ():
            near = corner_n[np.argmin(np.abs(corner_n - end))]
            if near != end:
                where = f"X = {end:g} on the {patch.side}, where a roller ends"
                raise ValueError(
                    f"a corner of an element must lie at {where}, for {who}, got {near:.6g} as the nearest"
                )


def _require_straight(arm: Arm, who: str) -> None:
    for conn in arm.conn_kea.values():
        n = corner_count(conn)
        if conn.shape[1] == n:
            continue
        ends, after = arm.X_nI[conn[:, :n]], arm.X_nI[np.roll(conn[:, :n], -1, axis=1)]
        beside = np.linalg.norm(arm.X_nI[conn[:, n : 2 * n]] - 0.5 * (ends + after), axis=2)
        if np.any(beside > STRAIGHT * np.linalg.norm(after - ends, axis=2)):
            e, i = np.unravel_index(np.argmax(beside), beside.shape)
            x = 0.5 * (ends + after)[e, i]
            raise ValueError(
                f"sides must be straight with a node in the middle for {who}, got one {beside[e, i]:.3g} "
                f"off at ({x[0]:.4g}, {x[1]:.4g})"
            )
