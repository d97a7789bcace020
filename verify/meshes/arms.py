"""Two arms from a mesh file, held against the specimen of a scene: sizes, outlines, bond and groups."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from verify.meshes.read import COHESIVE, ELEMENT_DEGREES, PlaneMesh, read_mesh
from verify.scene.schema import Scene
from verify.scene.specimens.delamination import Delamination, Load, Support
from verify.support.refusal import Refusal

if TYPE_CHECKING:
    import meshio

#: Part of the specimen's length within which two places are the same.
SAME = 1e-6

#: Factors between units of length, looked for where a mesh and a scene differ.
UNIT_FACTORS = (1000.0, 100.0, 10.0, 25.4)


@dataclass(frozen=True)
class Arm:
    """One body: nodes ``X_nI`` (n, 2), those of its outline exactly on it, and elements as in `PlaneMesh`."""

    X_nI: np.ndarray
    conn_kea: Mapping[int, np.ndarray]

    @property
    def degree(self) -> int:
        return ELEMENT_DEGREES[next(iter(self.conn_kea))]


def given_arms(scene: Scene, mesh: meshio.Mesh | None = None) -> tuple[Arm, Arm]:
    """The upper and the lower arm of a mesh, or else of the file that a scene names.

    Raises
    ------
    Refusal : a file that is no mesh of two arms, or not those of the specimen; the sentence has both numbers.
    """
    file = "the mesh" if mesh is not None else scene.specimen.mesh[0]
    try:
        if scene.specimen.clamped or len(scene.specimen.mesh) > 1:
            raise ValueError("must be one file with both arms, or .iga files")
        return _Check(scene, read_mesh(Path(file) if mesh is None else mesh)).arms()
    except OSError as error:
        raise Refusal(f"specimen.mesh: cannot read {file}: {error.strerror or error}") from None
    except ValueError as error:
        raise Refusal(f"specimen.mesh: {file}: {error}") from None


@dataclass(frozen=True)
class _Check:
    """A mesh beside the specimen that it must be one of."""

    scene: Scene
    mesh: PlaneMesh

    @property
    def tol(self) -> float:
        return SAME * self.scene.specimen.lengths[0]

    def arms(self) -> tuple[Arm, Arm]:
        self._size()
        upper_e = self._centres()[:, 1] > 0.0
        self._bodies(upper_e)
        boxes = ((0.0, self.scene.specimen.thicknesses[0]), (-self.scene.specimen.thicknesses[1], 0.0))
        arms = [
            self._arm(name, which, box) for name, which, box in zip(ARM_NAMES, (upper_e, ~upper_e), boxes, strict=True)
        ]
        self._groups(upper_e)
        return arms[0], arms[1]

    def _size(self) -> None:
        """Bounding box of the elements."""
        used = self.mesh.X_nI[np.unique(np.concatenate([conn.ravel() for conn in self.mesh.conn_kea.values()]))]
        body = self.scene.specimen
        wanted = ((0.0, body.lengths[0]), (-body.thicknesses[1], body.thicknesses[0]))
        for axis, (low, high), keys in zip((0, 1), wanted, ("specimen.length", "specimen.arm_thickness"), strict=True):
            found = used[:, axis].min(), used[:, axis].max()
            if max(abs(found[0] - low), abs(found[1] - high)) > self.tol:
                where = f"{'XY'[axis]} must run from {low:g} to {high:g} ({keys})"
                text = f"{where}, got {found[0]:.6g} to {found[1]:.6g}"
                raise ValueError(text + _other_units((high - low), found[1] - found[0]))

    def _centres(self) -> np.ndarray:
        return np.concatenate([self.mesh.X_nI[conn].mean(1) for conn in self.mesh.conn_kea.values()])

    def _bodies(self, upper_e: np.ndarray) -> None:
        """Each body is one piece."""
        pieces = 0
        for which in (upper_e, ~upper_e):
            a = np.concatenate([part.ravel() for part in self._part(which).values()])
            b = np.concatenate([np.repeat(part[:, 0], part.shape[1]) for part in self._part(which).values()])
            n = len(self.mesh.X_nI)
            _, piece_n = connected_components(coo_array((np.ones(a.size), (a, b)), shape=(n, n)), directed=False)
            pieces += len(np.unique(piece_n[a]))
        if pieces != 2:
            raise ValueError(f"must hold 2 bodies, one above and one below Y = 0, got {pieces} that share no nodes")

    def _part(self, which: np.ndarray) -> dict[int, np.ndarray]:
        ends = np.cumsum([len(conn) for conn in self.mesh.conn_kea.values()])[:-1]
        split = zip(self.mesh.conn_kea.items(), np.split(which, ends), strict=True)
        return {size: conn[here] for (size, conn), here in split if np.any(here)}

    def _arm(self, name: str, which: np.ndarray, box: tuple[float, float]) -> Arm:
        part = self._part(which)
        used, inverse = np.unique(np.concatenate([conn.ravel() for conn in part.values()]), return_inverse=True)
        X_nI = self.mesh.X_nI[used]
        found = X_nI[:, 1].min(), X_nI[:, 1].max()
        if max(abs(found[0] - box[0]), abs(found[1] - box[1])) > self.tol:
            raise ValueError(
                f"body {name}: Y must run from {box[0]:g} to {box[1]:g}, got {found[0]:.6g} to {found[1]:.6g}"
            )
        ends = np.cumsum([conn.size for conn in part.values()])[:-1]
        local = zip(part.items(), np.split(np.ravel(inverse), ends), strict=True)
        specimen = self.scene.specimen
        rollers = (x for patch in specimen.patches for x in patch.extent or ())
        lines = ((0.0, *specimen.bonded, *rollers), box)
        arm = Arm(
            _snapped(X_nI, lines, self.tol), {size: numbers.reshape(conn.shape) for (size, conn), numbers in local}
        )
        self._outline(name, arm, box)
        tip = self.scene.specimen.tip
        face = corners_on(arm, 0.0)
        near = face[np.argmin(np.abs(face - tip))]
        if near != tip:
            raise ValueError(
                f"body {name}: a corner of an element must lie at the end of the bond, X = {tip:g} "
                f"(specimen.precrack), got {near:.6g} as the nearest"
            )
        return arm

    def _outline(self, name: str, arm: Arm, box: tuple[float, float]) -> None:
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
        length = self.scene.specimen.lengths[0]
        sides = np.concatenate([_sides(conn) for conn in arm.conn_kea.values()])
        kinds, count = np.unique(sides, axis=0, return_counts=True)
        lone = kinds[count == 1]
        x, y = X[lone, 0], X[lone, 1]
        on = np.any([np.all(x == 0.0, 1), np.all(x == length, 1), np.all(y == box[0], 1), np.all(y == box[1], 1)], 0)
        if not np.all(on) or count.max() > 2:
            bad = lone[~on] if not np.all(on) else kinds[count > 2]
            at = X[bad[0]].mean(0)
            raise ValueError(
                f"body {name}: sides inside it must belong to two elements (no gaps, no hanging nodes), "
                f"got {len(bad)} that do not, one at ({at[0]:.4g}, {at[1]:.4g})"
            )
        full = length * (box[1] - box[0])
        if abs(area_e.sum() - full) > SAME * full:
            raise ValueError(f"body {name}: elements must fill an area of {full:g} once, got {area_e.sum():.6g}")

    def _groups(self, upper_e: np.ndarray) -> None:
        """Groups that the scene names, or that have the names of `GROUP_ROLES`, hold what they should."""
        named = self.scene.specimen.groups
        if COHESIVE in self.mesh.nodes:
            self._face_group("bond", COHESIVE, self.mesh.nodes[COHESIVE])
        for role in GROUP_ROLES:
            asked = getattr(named, role)
            name = asked or role
            elements, nodes = self.mesh.elements.get(name), self.mesh.nodes.get(name)
            if elements is None and nodes is None:
                if asked:
                    raise ValueError(
                        f"group {name} (specimen.groups.{role}) is missing, the file has "
                        f"{', '.join(sorted({*self.mesh.elements, *self.mesh.nodes})) or 'none'}"
                    )
                continue
            if role in ARM_NAMES:
                self._body_group(name, elements, upper_e if role == "upper" else ~upper_e)
            elif role == "bond" or (role == "load" and not self.scene.specimen.slides):
                self._face_group(role, name, nodes)
            else:
                self._patch_group(role, name, nodes)

    def _body_group(self, name: str, elements: np.ndarray | None, which: np.ndarray) -> None:
        if elements is None:
            raise ValueError(f"group {name}: must hold elements of a body, got lines or nodes")
        if not np.array_equal(elements, np.flatnonzero(which)):
            wrong = np.setxor1d(elements, np.flatnonzero(which))
            raise ValueError(
                f"group {name}: must hold the {which.sum()} elements on its side of Y = 0, got "
                f"{len(elements)}, {len(wrong)} of them missing or too many"
            )

    def _face_group(self, role: str, name: str, nodes: np.ndarray | None) -> None:
        if nodes is None:
            raise ValueError(f"group {name}: must hold lines or nodes, got elements of a body")
        body = self.scene.specimen
        low, high = (-body.thicknesses[1], body.thicknesses[0]) if role == "load" else (body.tip, body.lengths[0])
        across, along = (0, 1) if role == "load" else (1, 0)
        X = self.mesh.X_nI[nodes]
        off, ran = np.abs(X[:, across]).max(), (X[:, along].min(), X[:, along].max())
        if off > self.tol or max(abs(ran[0] - low), abs(ran[1] - high)) > self.tol:
            raise ValueError(
                f"group {name}: must lie on {'XY'[across]} = 0 from {'XY'[along]} = {low:g} to {high:g}, "
                f"got {ran[0]:.6g} to {ran[1]:.6g}, up to {off:.3g} off that line"
            )

    def _patch_group(self, role: str, name: str, nodes: np.ndarray | None) -> None:
        """Nodes on the patches of all loads or all supports, and on no other place."""
        specimen = self.scene.specimen
        patches: tuple[Load | Support, ...] = specimen.loads if role == "load" else specimen.supports
        if nodes is None or not patches:
            got = "elements of a body" if patches else f"a {specimen.kind}, which has none"
            raise ValueError(f"group {name}: must hold lines or nodes of the patches of every {role}, got {got}")
        X_nI = self.mesh.X_nI[nodes]
        on_kn = np.array([_on(patch, specimen, X_nI, self.tol) for patch in patches])
        if not np.all(on_kn.any(1)):
            missing = patches[int(np.argmin(on_kn.any(1)))]
            raise ValueError(f"group {name}: must have nodes of every {role}, got none {_place(missing)}")
        if not np.all(on_kn.any(0)):
            x, y = X_nI[int(np.argmin(on_kn.any(0)))]
            places = ", ".join(map(_place, patches))
            raise ValueError(f"group {name}: must have nodes {places} alone, got one at ({x:.6g}, {y:.6g})")


def _on(patch: Load | Support, specimen: Delamination, X_nI: np.ndarray, tol: float) -> np.ndarray:
    """Which nodes (n,) lie on a patch."""
    x, y = X_nI.T
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


def _other_units(wanted: float, found: float) -> str:
    for factor in UNIT_FACTORS:
        for ratio, words in ((factor, f"{factor:g} times larger"), (1.0 / factor, f"{factor:g} times smaller")):
            if abs(found / wanted - ratio) < SAME * ratio:
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
    x, y = corners[..., 0], corners[..., 1]
    area = 0.5 * (x * np.roll(y, -1, 1) - y * np.roll(x, -1, 1)).sum(1)
    return np.where(worst > 0.0, area, np.minimum(worst, 0.0))


def _sides(conn: np.ndarray) -> np.ndarray:
    """Sides (n, 2 or 3) as their ends, the smaller number first, and their middle node."""
    n = corner_count(conn)
    ends = np.stack([conn[:, :n], np.roll(conn[:, :n], -1, axis=1)], -1)
    middle = conn[:, n : 2 * n, None] if conn.shape[1] > 4 else conn[:, :0].reshape(len(conn), 0, 1)
    parts = [np.sort(ends, -1), *([middle] if middle.size else [])]
    return np.concatenate(parts, -1).reshape(-1, 3 if middle.size else 2)
