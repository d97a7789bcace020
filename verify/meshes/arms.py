"""Two arms from a mesh file, held against the specimen of a scene: sizes, outlines, bond and groups."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from verify.meshes.abaqus import COHESIVE
from verify.meshes.pose import SAME, in_place, signed_area
from verify.meshes.read import ELEMENT_DEGREES, PlaneMesh, read_mesh
from verify.scene.schema import Scene
from verify.scene.specimens.delamination import Delamination, Load, Support
from verify.support.refusal import Refusal
from verify.support.say import say_once

if TYPE_CHECKING:
    import meshio

#: Factors between units of length, looked for where a mesh and a scene differ.
UNIT_FACTORS = (1000.0, 100.0, 10.0, 25.4)
#: What elements between two arms are.
LAYER = (
    ": a layer of the adhesive? Leave it out, move the arms together, and give the bond its stiffness "
    "(interface.stiffness: modulus over thickness)"
)


@dataclass(frozen=True)
class Arm:
    """One body: nodes ``X_nI`` (n, 2), those of its outline exactly on it, and elements as in `PlaneMesh`, with the
    numbers that both have in their file."""

    X_nI: np.ndarray
    conn_kea: Mapping[int, np.ndarray]
    number_n: np.ndarray
    number_e: np.ndarray

    @property
    def degree(self) -> int:
        return ELEMENT_DEGREES[next(iter(self.conn_kea))]


def given_arms(scene: Scene, mesh: meshio.Mesh | None = None) -> tuple[Arm, Arm]:
    """The upper and the lower arm of a mesh, or else of the file that a scene names.

    Raises
    ------
    Refusal : a file that is no mesh of two arms, or not those of the specimen; the sentence has both numbers.
    """
    specimen = scene.specimen
    file = "the mesh" if mesh is not None else specimen.mesh[0]
    try:
        if specimen.clamped or len(specimen.mesh) > 1:
            raise ValueError("must be one file with both arms, or .iga files")
        found, remarks = in_place(specimen, read_mesh(Path(file) if mesh is None else mesh))
        upper_e = np.concatenate([found.X_nI[conn].mean(1)[:, 1] for conn in found.conn_kea.values()]) > 0.0
        parts = [_part(found, which) for which in (upper_e, ~upper_e)]
        above, below = (_pieces(part, len(found.X_nI)) for part in parts)
        if layer := _layer(specimen, found):
            raise ValueError(f"must hold arms that meet, got {layer}")
        if above + below == 1:
            raise ValueError(
                "must hold both arms, got one: a half model? Mirror it at its bond, or leave it out "
                "(--set specimen.mesh=[]); effects.symmetry solves one arm on a mesh of its own"
            )
        if (above, below) != (1, 1):
            pieces = f"{above} above and {below} below that share no nodes"
            along = "; the longer side lies along Y" if np.less(*np.ptp(found.X_nI, axis=0)) else ""
            raise ValueError(f"must hold 2 bodies, one above and one below Y = 0, got {pieces}{along}")
        upper, lower = (
            _arm(specimen, b, found, part, found.number_e[which])
            for b, (part, which) in enumerate(zip(parts, (upper_e, ~upper_e), strict=True))
        )
        _check_groups(specimen, found, upper_e)
        for remark in remarks:
            say_once(f"specimen.mesh: {file}: {remark}")
        return upper, lower
    except OSError as error:
        raise Refusal(f"specimen.mesh: cannot read {file}: {error.strerror or error}") from None
    except ValueError as error:
        raise Refusal(f"specimen.mesh: {file}: {error}") from None


def _layer(specimen: Delamination, mesh: PlaneMesh) -> str:
    """What is between the arms, and what to do; nothing where they meet."""
    (upper, lower), tol = specimen.thicknesses, SAME * specimen.lengths[0]
    Y = [mesh.X_nI[conn, 1] for conn in mesh.conn_kea.values()]
    low_e, high_e = np.concatenate([[Y_ea.min(1), Y_ea.max(1)] for Y_ea in Y], axis=1)
    bottom, top = low_e.min(), high_e.max()
    thick, faces = top - bottom - upper - lower, (low_e - top + upper, high_e - bottom - lower)
    if tol < thick < min(upper, lower) and max(np.abs(away_e).min() for away_e in faces) <= tol:
        filled = np.any((low_e >= bottom + lower - tol) & (high_e <= top - upper + tol))
        return f"{thick:.6g} between them{LAYER if filled else '; move them together'}"
    across = (low_e < -tol) & (high_e > tol)
    if not across.any() or abs(thick) > tol:
        return ""
    whole = low_e[across].min() <= bottom + tol or high_e[across].max() >= top - tol
    return f"{across.sum()} elements across Y = 0{'; one body without a bond?' if whole else LAYER}"


def _part(mesh: PlaneMesh, which_e: np.ndarray) -> dict[int, np.ndarray]:
    """The elements of a mesh that are marked."""
    ends = np.cumsum([len(conn) for conn in mesh.conn_kea.values()])[:-1]
    split = zip(mesh.conn_kea.items(), np.split(which_e, ends), strict=True)
    return {size: conn[here] for (size, conn), here in split if np.any(here)}


def _pieces(conn_kea: Mapping[int, np.ndarray], n: int) -> int:
    """Number of pieces that share none of the n nodes."""
    nodes = [np.empty(0, dtype=int), *(conn.ravel() for conn in conn_kea.values())]
    firsts = [np.empty(0, dtype=int), *(np.repeat(conn[:, 0], conn.shape[1]) for conn in conn_kea.values())]
    a, b = np.concatenate(nodes), np.concatenate(firsts)
    _, piece_n = connected_components(coo_array((np.ones(a.size), (a, b)), shape=(n, n)), directed=False)
    return len(np.unique(piece_n[a]))


def _arm(
    specimen: Delamination, body: int, mesh: PlaneMesh, conn_kea: Mapping[int, np.ndarray], number_e: np.ndarray
) -> Arm:
    """One body with nodes of its own, which has the sizes of the specimen and no holes."""
    name, tol = ARM_NAMES[body], SAME * specimen.lengths[0]
    used, local = np.unique(np.concatenate([conn.ravel() for conn in conn_kea.values()]), return_inverse=True)
    X_nI = mesh.X_nI[used]
    upper, lower = specimen.thicknesses
    box = (0.0, specimen.lengths[0]), ((0.0, upper), (-lower, 0.0))[body]
    for x_n, axis, (low, high), key in zip(X_nI.T, "XY", box, ("length", "arm_thickness"), strict=True):
        start, end = x_n.min(), x_n.max()
        if max(abs(start - low), abs(end - high)) > tol:
            where = f"{axis} must run from {low:g} to {high:g} (specimen.{key}), got {start:.6g} to {end:.6g}"
            raise ValueError(f"body {name}: {where}{_other_units(np.ptp(box, axis=1), np.ptp(X_nI, axis=0))}")
    ends = np.cumsum([conn.size for conn in conn_kea.values()])[:-1]
    numbers = zip(conn_kea.items(), np.split(np.ravel(local), ends), strict=True)
    rollers = (x for patch in specimen.patches for x in patch.extent or ())
    lines = ((0.0, *specimen.bonded, *rollers), box[1])
    conn_kea = {size: part.reshape(conn.shape) for (size, conn), part in numbers}
    arm = Arm(_snapped(X_nI, lines, tol), conn_kea, mesh.number_n[used], number_e)
    _check_outline(name, arm, box)
    tip, corners = specimen.tip, corners_on(arm, 0.0)
    near = corners[np.argmin(np.abs(corners - tip))]
    if near != tip:
        raise ValueError(
            f"body {name}: a corner of an element must lie at the end of the bond, X = {tip:g} "
            f"(specimen.precrack), got {near:.6g} as the nearest"
        )
    return arm


def _check_outline(name: str, arm: Arm, box: tuple[tuple[float, float], tuple[float, float]]) -> None:
    """Sides of one element alone lie on the rectangle; the elements turn counter-clockwise and fill it."""
    X = arm.X_nI
    area_e = np.concatenate([_area(X[conn]) for conn in arm.conn_kea.values()])
    if np.any(area_e <= 0.0):
        e = int(np.argmin(area_e))
        x = np.concatenate([X[conn].mean(1) for conn in arm.conn_kea.values()])[e]
        raise ValueError(
            f"body {name}: nodes of elements must be in order, counter-clockwise, got an area of "
            f"{area_e[e]:.3g} at ({x[0]:.4g}, {x[1]:.4g})"
        )
    sides = np.concatenate([_sides(conn) for conn in arm.conn_kea.values()])
    kinds, count = np.unique(sides, axis=0, return_counts=True)
    lone = kinds[count == 1]
    on = np.any([np.all(X[lone, axis] == end, axis=1) for axis in (0, 1) for end in box[axis]], axis=0)
    if not np.all(on) or count.max() > 2:
        bad = lone[~on] if not np.all(on) else kinds[count > 2]
        at = X[bad[0]].mean(0)
        raise ValueError(
            f"body {name}: sides inside it must belong to two elements (no gaps, no hanging nodes), "
            f"got {len(bad)} that do not, one at ({at[0]:.4g}, {at[1]:.4g})"
        )
    full = float(np.prod(np.ptp(box, axis=1)))
    if abs(area_e.sum() - full) > SAME * full:
        raise ValueError(f"body {name}: elements must fill an area of {full:g} once, got {area_e.sum():.6g}")


def _check_groups(specimen: Delamination, mesh: PlaneMesh, upper_e: np.ndarray) -> None:
    """Groups that the scene names, or that have the names of `GROUP_ROLES`, hold what they should."""
    named = {role: getattr(specimen.groups, role) for role in GROUP_ROLES}
    groups = {role: name or role for role, name in named.items() if name or role in {*mesh.elements, *mesh.nodes}}
    if COHESIVE in mesh.nodes:
        _check_line(specimen, "bond", COHESIVE, mesh.X_nI[mesh.nodes[COHESIVE]])
    for role, name in groups.items():
        elements, nodes = mesh.elements.get(name), mesh.nodes.get(name)
        if elements is None and nodes is None:
            there = ", ".join(sorted({*mesh.elements, *mesh.nodes})) or "none"
            raise ValueError(f"group {name} (specimen.groups.{role}) is missing, the file has {there}")
        if role in ARM_NAMES:
            if elements is None:
                raise ValueError(f"group {name}: must hold elements of a body, got lines or nodes")
            wanted = np.flatnonzero(upper_e if role == "upper" else ~upper_e)
            if wrong := len(np.setxor1d(elements, wanted)):
                raise ValueError(
                    f"group {name}: must hold the {len(wanted)} elements on its side of Y = 0, got "
                    f"{len(elements)}, {wrong} of them missing or too many"
                )
        elif nodes is None:
            raise ValueError(f"group {name}: must hold lines or nodes, got elements of a body")
        elif role == "bond" or (role == "load" and not specimen.slides):
            _check_line(specimen, role, name, mesh.X_nI[nodes])
        else:
            _check_patches(specimen, role, name, mesh.X_nI[nodes])


def _check_line(specimen: Delamination, role: str, name: str, X_nI: np.ndarray) -> None:
    """Nodes on the bond, or on the loaded ends, from one end to the other."""
    tol = SAME * specimen.lengths[0]
    upper, lower = specimen.thicknesses
    low, high = (-lower, upper) if role == "load" else (specimen.tip, specimen.lengths[0])
    across, along = (0, 1) if role == "load" else (1, 0)
    off, start, end = np.abs(X_nI[:, across]).max(), X_nI[:, along].min(), X_nI[:, along].max()
    if off > tol or max(abs(start - low), abs(end - high)) > tol:
        raise ValueError(
            f"group {name}: must lie on {'XY'[across]} = 0 from {'XY'[along]} = {low:g} to {high:g}, "
            f"got {start:.6g} to {end:.6g}, up to {off:.3g} off that line"
        )


def _check_patches(specimen: Delamination, role: str, name: str, X_nI: np.ndarray) -> None:
    """Nodes on the patches of all loads or all supports, and on no other place."""
    patches: tuple[Load | Support, ...] = specimen.loads if role == "load" else specimen.supports
    if not patches:
        raise ValueError(f"group {name}: must not be there in a {specimen.kind}, which has no {role}")
    on_kn = np.array([_on(patch, specimen, X_nI) for patch in patches])
    if not np.all(on_kn.any(1)):
        missing = patches[int(np.argmin(on_kn.any(1)))]
        raise ValueError(f"group {name}: must have nodes of every {role}, got none {_place(missing)}")
    if not np.all(on_kn.any(0)):
        x, y = X_nI[int(np.argmin(on_kn.any(0)))]
        places = ", ".join(map(_place, patches))
        raise ValueError(f"group {name}: must have nodes {places} alone, got one at ({x:.6g}, {y:.6g})")


def _on(patch: Load | Support, specimen: Delamination, X_nI: np.ndarray) -> np.ndarray:
    """Which nodes (n,) lie on a patch."""
    (x, y), tol = X_nI.T, SAME * specimen.lengths[0]
    upper, lower = specimen.thicknesses
    if patch.side in ("left", "right"):
        low, high = (-lower if patch.body != 0 else 0.0), (upper if patch.body != 1 else 0.0)
        end = 0.0 if patch.side == "left" else specimen.lengths[0]
        return (np.abs(x - end) < tol) & (y > low - tol) & (y < high + tol)
    low, high = patch.extent or (0.0, specimen.lengths[0])
    return (np.abs(y - height(patch, specimen)) < tol) & (x > low - tol) & (x < high + tol)


def height(patch: Load | Support, specimen: Delamination) -> float:
    """Y of the side, top or bottom, of a body."""
    upper, lower = specimen.thicknesses
    return {(0, "top"): upper, (1, "bottom"): -lower}.get((patch.body or 0, patch.side), 0.0)


def _place(patch: Load | Support) -> str:
    """Words for a patch: on the top from X = 69.5 to 70.5."""
    if patch.extent is None:
        return f"on the {patch.side} side"
    return f"on the {patch.side} from X = {patch.extent[0]:g} to {patch.extent[1]:g}"


#: Bodies, and what else groups may name: the bonded faces, the loaded ones, and those that are held.
ARM_NAMES = ("upper", "lower")
GROUP_ROLES = (*ARM_NAMES, "bond", "load", "support")


def _other_units(wanted: np.ndarray, found: np.ndarray) -> str:
    """A question where both sizes (2,) are off by a factor of units."""
    for factor in UNIT_FACTORS:
        for ratio, words in ((factor, f"{factor:g} times larger"), (1.0 / factor, f"{factor:g} times smaller")):
            if np.all(np.abs(found / wanted - ratio) < SAME * ratio):
                return f"; the mesh is {words}: in other units?"
    return ""


def _snapped(X_nI: np.ndarray, lines_Ik: tuple[tuple[float, ...], ...], tol: float) -> np.ndarray:
    """Nodes that lie on a line but for rounding, moved onto it."""
    columns = []
    for x_n, lines in zip(X_nI.T, lines_Ik, strict=True):
        away = np.abs(x_n[:, None] - np.array(lines))
        columns.append(np.where(away.min(1) <= tol, np.array(lines)[away.argmin(1)], x_n))
    return np.stack(columns, -1)


def corner_count(conn: np.ndarray) -> int:
    """Corners of an element."""
    return 3 if conn.shape[1] in (3, 6) else 4


def corners_on(arm: Arm, Y: float) -> np.ndarray:
    """X (n,) of the corners of elements on a line along the specimen, rising."""
    used = np.unique(np.concatenate([conn[:, : corner_count(conn)].ravel() for conn in arm.conn_kea.values()]))
    return np.unique(arm.X_nI[used[arm.X_nI[used, 1] == Y], 0])


def _area(X_eaI: np.ndarray) -> np.ndarray:
    """Areas (n_e,) of the polygons of the corners; the smallest one of the triangles at a corner, if not positive."""
    corners = X_eaI[:, : 3 if X_eaI.shape[1] in (3, 6) else 4]
    after, before = np.roll(corners, -1, axis=1) - corners, np.roll(corners, 1, axis=1) - corners
    worst = 0.5 * (after[..., 0] * before[..., 1] - after[..., 1] * before[..., 0]).min(1)
    return np.where(worst > 0.0, signed_area(X_eaI), np.minimum(worst, 0.0))


def _sides(conn: np.ndarray) -> np.ndarray:
    """Sides (n, 2 or 3) as their ends, the smaller number first, and their middle node."""
    n = corner_count(conn)
    ends = np.stack([conn[:, :n], np.roll(conn[:, :n], -1, axis=1)], -1)
    middle = conn[:, n : 2 * n, None] if conn.shape[1] > 4 else conn[:, :0].reshape(len(conn), 0, 1)
    parts = [np.sort(ends, -1), *([middle] if middle.size else [])]
    return np.concatenate(parts, -1).reshape(-1, 3 if middle.size else 2)
