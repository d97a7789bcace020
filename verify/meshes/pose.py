"""A mesh that is not where its specimen is: clockwise elements, another origin, the crack at the other end."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from verify.meshes.abaqus import COHESIVE
from verify.meshes.read import PlaneMesh
from verify.scene.specimens.delamination import Delamination

#: Nodes of an element in the order of the other sense, by their number: corners, middles of the sides, centre.
OTHER_SENSE = {
    3: (0, 2, 1),
    4: (0, 3, 2, 1),
    6: (0, 2, 1, 5, 4, 3),
    8: (0, 3, 2, 1, 7, 6, 5, 4),
    9: (0, 3, 2, 1, 7, 6, 5, 4, 8),
}
#: Part of the specimen's length within which two places are the same.
SAME = 1e-6


def in_place(specimen: Delamination, mesh: PlaneMesh) -> tuple[PlaneMesh, list[str]]:
    """The mesh where the specimen is, and a remark for everything that was changed.

    Bodies whose elements all run clockwise are turned. A mesh of the size of both arms is moved so that their bond lies
    on Y = 0 and their ends on X = 0 and the length. If its bond is where that of the mirror image would be, as a
    specimen opened at its right end, it is mirrored.
    """
    remarks = []
    if moved := _moved(specimen, mesh):
        mesh = replace(mesh, X_nI=mesh.X_nI + np.array(moved))
        remarks.append(f"is moved by ({moved[0]:.6g}, {moved[1]:.6g}), so that the bond lies on Y = 0 from X = 0 on")
    if _mirrored(specimen, mesh):
        X_nI = np.array([specimen.lengths[0], 0.0]) + mesh.X_nI * np.array([-1.0, 1.0])
        mesh = replace(mesh, X_nI=X_nI, conn_kea={n: conn[:, OTHER_SENSE[n]] for n, conn in mesh.conn_kea.items()})
        remarks.append("is mirrored, as its bond begins at the other end")
    turned, bodies = _turned(mesh)
    if bodies:
        remarks.append(f"the elements of the {' and the '.join(bodies)} body run clockwise and are turned")
    return turned, remarks


def _moved(specimen: Delamination, mesh: PlaneMesh) -> tuple[float, float] | None:
    """How far a mesh of the right size has to be moved."""
    tol, (upper, lower) = SAME * specimen.lengths[0], specimen.thicknesses
    used = np.unique(np.concatenate([conn.ravel() for conn in mesh.conn_kea.values()]))
    low, size = mesh.X_nI[used].min(0), np.ptp(mesh.X_nI[used], axis=0)
    there = np.array([0.0, -lower])
    right = np.abs(size - [specimen.lengths[0], upper + lower]).max() <= tol
    return tuple((there - low).tolist()) if right and np.abs(low - there).max() > tol else None


def _mirrored(specimen: Delamination, mesh: PlaneMesh) -> bool:
    """Whether the bond of the mesh is that of the mirror image, and not that of the specimen."""
    nodes = mesh.nodes.get(specimen.groups.bond or ("bond" if "bond" in mesh.nodes else COHESIVE))
    length, tol = specimen.lengths[0], SAME * specimen.lengths[0]
    if nodes is None or not len(nodes):
        return False
    found = np.array([mesh.X_nI[nodes, 0].min(), mesh.X_nI[nodes, 0].max()])
    own = np.array([specimen.tip, length])
    return bool(np.abs(found - own).max() > tol >= np.abs(found - (length - own[::-1])).max())


def _turned(mesh: PlaneMesh) -> tuple[PlaneMesh, list[str]]:
    """The mesh with both bodies counter-clockwise, and the names of those that were not: all of their elements."""
    clockwise = {n: signed_area(mesh.X_nI[conn]) < 0.0 for n, conn in mesh.conn_kea.items()}
    above = {n: mesh.X_nI[conn].mean(1)[:, 1] > 0.0 for n, conn in mesh.conn_kea.items()}
    turn: Mapping[int, np.ndarray] = {n: np.zeros(len(conn), dtype=bool) for n, conn in mesh.conn_kea.items()}
    names = []
    for name, upper in (("upper", True), ("lower", False)):
        here = {n: above[n] == upper for n in above}
        if any(at.any() for at in here.values()) and all(clockwise[n][here[n]].all() for n in here):
            turn = {n: turn[n] | here[n] for n in turn}
            names.append(name)
    conn_kea = {n: np.where(turn[n][:, None], conn[:, OTHER_SENSE[n]], conn) for n, conn in mesh.conn_kea.items()}
    return (replace(mesh, conn_kea=conn_kea) if names else mesh), names


def signed_area(X_eaI: np.ndarray) -> np.ndarray:
    """Signed areas (n_e,) of the polygons of the corners."""
    x, y = np.moveaxis(X_eaI[:, : 3 if X_eaI.shape[1] in (3, 6) else 4], -1, 0)
    return 0.5 * (x * np.roll(y, -1, 1) - y * np.roll(x, -1, 1)).sum(1)
