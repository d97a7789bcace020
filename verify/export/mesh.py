"""The mesh of a scene for another code, of degree 1 or 2, on which the two sides of the bond match: quadrilaterals, or
what the file of the scene has, with cohesive elements between its arms.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from fem_reference.problem.specimen import Action, Region, Specimen
from verify.meshes.arms import Arm, given_arms
from verify.meshes.joined import joined, require_patch_ends
from verify.methods.given_meshes import own_mesh
from verify.methods.solve import prepare
from verify.scene.schema import Scene
from verify.scene.specimens.delamination import Delamination
from verify.support.refusal import Refusal

#: Part of a height by which a node may lie beside the middle of a face, by rounding.
MIDDLE = 1e-9

#: Nodes and elements of the upper and the lower body, and the numbers of all in a file.
Parts = Sequence[tuple[np.ndarray, ...]]
Numbers = tuple[np.ndarray, np.ndarray]

#: Who takes a mesh, in refusals of one from a file.
WHO = "an export"

#: Integrals of the products of two functions of a side of degree p over its length.
MASSES: Mapping[int, np.ndarray] = {
    1: np.array([[2, 1], [1, 2]]) / 6,
    2: np.array([[4, 2, -1], [2, 16, 2], [-1, 2, 4]]) / 30,
}


@dataclass(frozen=True)
class LoadedFace:
    """A loaded end face, or the patch of a load or a support.

    Its mean displacement is the sum of ``weight_n`` times the displacement of its nodes along ``component`` (0: x,
    1: y), and a dead traction of resultant P is the nodal force weight times P. Of a couple these are the mean rotation
    and the moment. A loaded face moves by ``factor`` times the opening; a patch carries ``factor`` times the load, and
    the opening is the sum of these factors times the mean displacements.
    ``action`` is the name of the load or support; one over both arms has a patch on each, and its mean displacement is
    the sum of both.
    """

    name: str
    node_n: np.ndarray
    weight_n: np.ndarray
    factor: float
    component: int = 1
    action: str = ""


@dataclass(frozen=True)
class Support:
    """Nodes whose displacements in these components (0: x, 1: y) are zero."""

    name: str
    node_n: np.ndarray
    components: tuple[int, ...]


@dataclass(frozen=True)
class SceneMesh:
    """Nodes and elements of both bodies, counted from 0.

    Parameters
    ----------
    degree : 1 or 2
    names : of the bodies, upper first
    X_nI : (n, 2) reference positions
    conn_ea : (n_e, n_a) corners counter-clockwise, then the middles of the sides between them; 4 or 8 nodes in a mesh
        that is made, 3, 4, 6, 8 or 9 in one of a file
    body_e : (n_e,) 0 upper, 1 lower
    pair_kb : (n_k, 2) nodes of the bond, lower and upper, X rising; ``degree`` + 1 of them make a side
    length_k : (n_k,) length of the bond that belongs to each pair: integral of its function
    crack_kb : the same pairs of the faces of the precrack, where they can touch; its end is the first pair of the bond
    resting : patches of supports whose mean displacement is zero, of arms on rollers
    turning : stiffness against a rotation of the whole that no support holds [force times length], else 0
    number_n, number_e : numbers of nodes and elements in the file that they are from, nodes rising; from 1 on in a mesh
        that is made
    given : whether the mesh is from a file
    """

    degree: int
    names: tuple[str, str]
    X_nI: np.ndarray
    conn_ea: np.ndarray
    body_e: np.ndarray
    pair_kb: np.ndarray
    length_k: np.ndarray
    loaded: tuple[LoadedFace, ...]
    supports: tuple[Support, ...]
    crack_kb: np.ndarray
    number_n: np.ndarray
    number_e: np.ndarray
    resting: tuple[LoadedFace, ...] = ()
    turning: float = 0.0
    given: bool = False

    def at(self, node_n: np.ndarray) -> np.ndarray:
        """Positions (n, 2) of nodes of a `numbered` mesh."""
        return self.X_nI[np.searchsorted(self.number_n, node_n + 1)]

    @property
    def sets(self) -> dict[str, np.ndarray]:
        """Every set of nodes by its name."""
        bond = {f"{name}_bond": self.pair_kb[:, 1 - b] for b, name in enumerate(self.names)}
        if self.merged:
            bond = {"bond": self.pair_kb[:, 0]}
        parts: tuple[LoadedFace | Support, ...] = (*self.loaded, *self.resting, *self.supports)
        crack = {f"{name}_crack": self.crack_kb[:, 1 - b] for b, name in enumerate(self.names) if self.crack_kb.size}
        return {part.name: part.node_n for part in parts} | bond | crack

    @property
    def merged(self) -> bool:
        """Whether the bodies share the nodes of the bond."""
        return bool(np.array_equal(*self.pair_kb.T))

    @property
    def cohesive_ea(self) -> np.ndarray:
        """(n, 4) linear interface elements of no thickness: lower side, upper side, counter-clockwise.

        A side of degree 2 has two of them.
        """
        lower, upper = self.pair_kb.T
        return np.stack([lower[:-1], lower[1:], upper[1:], upper[:-1]], axis=1)


def scene_mesh(scene: Scene) -> SceneMesh:
    """The mesh of the scene's file, else that of the DOLFINx model, as ``[dolfinx]`` asks for it; DOLFINx itself is not
    needed.

    Raises
    ------
    Refusal : a degree above 2, fewer elements than the specimen has parts, a file that is no mesh for an export.
    """
    degree = scene.dolfinx.degree if scene.dolfinx.degree != "auto" else 2
    arms = given_arms(scene) if scene.specimen.nodal else ()
    if arms:
        degree, scene = arms[0].degree, own_mesh(scene)
    if degree > 2:
        raise Refusal(f"dolfinx.degree: must be 1 or 2 for export, got {degree}; --set dolfinx.degree=2 exports it")
    # layers left out are chosen for the degree
    given = scene.model_copy(update={"dolfinx": scene.dolfinx.model_copy(update={"degree": degree})})
    specimen = prepare(given, "dolfinx").problem.specimen()
    try:
        parts, numbers = _parts(arms, scene.specimen) if arms else (None, None)
    except ValueError as error:
        raise Refusal(f"specimen.mesh: {error} (method lagrange takes them)") from None
    mesh = replace(_meshed(specimen, degree, scene.specimen.bodies, parts, numbers), given=bool(arms))
    return replace(mesh, loaded=tuple(_pulled(face, scene.load.at, mesh.X_nI) for face in mesh.loaded))


def numbered(mesh: SceneMesh) -> SceneMesh:
    """The mesh with the numbers of its file, minus 1, in place of those from 0 on; rows of ``X_nI`` are as before."""
    return _renamed(mesh, mesh.number_n - 1)


def merged(mesh: SceneMesh) -> SceneMesh:
    """One conforming mesh: the bodies share the nodes of the bond, for codes that insert interface elements there."""
    lower, upper = mesh.pair_kb.T
    kept = np.setdiff1d(np.arange(len(mesh.X_nI)), upper)
    new = np.zeros(len(mesh.X_nI), dtype=int)
    new[kept] = np.arange(len(kept))
    new[upper] = new[lower]
    return replace(_renamed(mesh, new), X_nI=mesh.X_nI[kept], number_n=mesh.number_n[kept])


def _renamed(mesh: SceneMesh, new: np.ndarray) -> SceneMesh:
    """The mesh with ``new[n]`` for each node n."""
    changed: dict[str, Any] = {name: new[getattr(mesh, name)] for name in ("conn_ea", "pair_kb", "crack_kb")}
    for name in ("loaded", "resting", "supports"):
        changed[name] = tuple(replace(part, node_n=new[part.node_n]) for part in getattr(mesh, name))
    return replace(mesh, **changed)


def _parts(arms: tuple[Arm, Arm], specimen: Delamination) -> tuple[Parts, Numbers]:
    """Both bodies of a file. What they share becomes two nodes, of which the upper one is new.

    Raises
    ------
    ValueError : see `joined` and `require_patch_ends`; elements of several kinds.
    """
    joined(arms, WHO)  # refuses what does not match
    require_patch_ends(arms, specimen, WHO)
    if len(sizes := {size for arm in arms for size in arm.conn_kea}) > 1:
        raise ValueError(f"elements must have one number of nodes for {WHO}, got {' and '.join(map(str, sizes))}")
    above, below = (arm.number_n for arm in arms)
    last, shared = max(above.max(), below.max()), np.isin(above, below)
    own = np.where(shared, last + np.cumsum(shared), above), below
    numbers = np.concatenate(own), np.concatenate([arm.number_e for arm in arms])
    return [(arm.X_nI, *arm.conn_kea.values()) for arm in arms], numbers


def _meshed(
    specimen: Specimen, degree: int, names: tuple[str, str], parts: Parts | None, numbers: Numbers | None
) -> SceneMesh:
    """The mesh of both bodies in the order of their numbers; without ``parts`` on the lines of the specimen."""
    near = specimen.near
    parts = parts or [_grid(specimen.X[specimen.X < body.length + near], body.Y, degree) for body in specimen.bodies]
    body_n, body_e = (np.repeat([0, 1], [len(part[i]) for part in parts]) for i in (0, 1))
    number_n, number_e = numbers or (1 + np.arange(len(body_n)), 1 + np.arange(len(body_e)))
    order_n, order_e = np.argsort(number_n), np.argsort(number_e)
    X_nI = np.concatenate([points for points, _ in parts])[order_n]
    conn_ea = np.concatenate([parts[0][1], len(parts[0][0]) + parts[1][1]])
    body_n, body_e, conn_ea = body_n[order_n], body_e[order_e], np.argsort(order_n)[conn_ea][order_e]

    def on(body: int, place: Region) -> np.ndarray:
        """Nodes of a body in a place."""
        low, high = np.transpose(place)
        return np.flatnonzero((body_n == body) & np.all((X_nI > low - near) & (X_nI < high + near), axis=1))

    def facing(start: float, end: float) -> np.ndarray:
        """Pairs of nodes (n, 2), lower and upper, on the faces between two places, X rising."""
        upper, lower = (on(body, ((start, end), (0.0, 0.0))) for body in (0, 1))
        return np.stack([n[np.argsort(X_nI[n, 0])] for n in (lower, upper)], axis=1)

    def patches(actions: tuple[Action, ...], role: str) -> tuple[LoadedFace, ...]:
        return tuple(
            replace(
                _patch(f"{names[patch.body]}_{role}_{number}", act, on(patch.body, patch.place), X_nI, degree),
                action=f"{role}_{number}",
            )
            for number, act in enumerate(actions, 1)
            for patch in act.patches
        )

    pairs = facing(min(specimen.bond), max(specimen.bond))
    faces = [face for face in specimen.faces if face.load != 0.0]
    size = sum(abs(face.load) for face in faces)
    loaded = []
    for face in faces:
        body = specimen.bodies[face.body]
        nodes = on(face.body, ((face.X, face.X), (body.Y[0], body.Y[-1])))
        nodes = nodes[np.argsort(X_nI[nodes, 1])]
        weights = _lengths(X_nI[nodes, 1], degree) / body.thickness
        loaded.append(LoadedFace(f"{names[face.body]}_loaded", nodes, weights, face.load / size))
    supports = tuple(
        Support(
            f"{names[held.body]}_held_{''.join('xy'[i] for i in held.components)}",
            on(held.body, held.place),
            held.components,
        )
        for held in specimen.held
    )
    return SceneMesh(
        degree=degree,
        names=names,
        X_nI=X_nI,
        conn_ea=conn_ea,
        body_e=body_e,
        pair_kb=pairs,
        length_k=_lengths(X_nI[pairs[:, 0], 0], degree),
        loaded=(*loaded, *patches(specimen.pulls, "load")),
        supports=supports,
        crack_kb=facing(0.0, specimen.bond[0]) if specimen.pulls and specimen.touching else np.zeros((0, 2), dtype=int),
        resting=patches(specimen.rests, "support"),
        turning=sum(keep.factor for keep in specimen.keeps),
        number_n=number_n[order_n],
        number_e=number_e[order_e],
    )


def _patch(name: str, act: Action, nodes: np.ndarray, X_nI: np.ndarray, degree: int) -> LoadedFace:
    """Nodes and weights of an action: its traction (turn (middle - Y), push) times the functions of the nodes."""
    axis = int(np.ptp(X_nI[nodes, 1]) > np.ptp(X_nI[nodes, 0]))
    nodes = nodes[np.argsort(X_nI[nodes, axis])]
    at = X_nI[nodes, axis]
    if act.push:
        return LoadedFace(name, nodes, act.push * _lengths(at, degree), act.factor)
    return LoadedFace(
        name, nodes, act.turn * (act.middle * _lengths(at, degree) - _lengths(at, degree, 1)), act.factor, 0
    )


def _pulled(face: LoadedFace, at: str, X_nI: np.ndarray) -> LoadedFace:
    """The loaded face, or its loaded node.

    Raises
    ------
    Refusal : no node in its middle.
    """
    if at == "face":
        return face
    height = np.abs(X_nI[face.node_n, 1])
    place = height.max() if at == "node" else 0.5 * (height.min() + height.max())
    i = int(np.argmin(np.abs(height - place)))
    if abs(height[i] - place) > MIDDLE * height.max():
        raise Refusal(
            'load.at: must be "face" or "node" where no node is in the middle of the loaded face, got "hinge"'
        )
    return replace(face, node_n=face.node_n[i : i + 1], weight_n=np.ones(1))


def _grid(X: np.ndarray, Y: np.ndarray, degree: int) -> tuple[np.ndarray, np.ndarray]:
    """Nodes (n, 2) and elements (n_e, 4 or 8) between lines, without the nodes inside elements."""
    X, Y, p = _refined(X, degree), _refined(Y, degree), degree
    kept = (np.arange(Y.size) % p == 0)[:, None] | (np.arange(X.size) % p == 0)
    number = np.cumsum(kept).reshape(kept.shape) - 1
    corners = (number[:-1:p, :-1:p], number[:-1:p, p::p], number[p::p, p::p], number[p::p, :-1:p])
    middles = (number[:-1:p, 1::p], number[1::p, p::p], number[p::p, 1::p], number[1::p, :-1:p]) if p == 2 else ()
    conn_ea = np.stack([part.ravel() for part in (*corners, *middles)], axis=1)
    return np.stack([grid[kept] for grid in np.meshgrid(X, Y)], axis=1), conn_ea


def _refined(lines: np.ndarray, degree: int) -> np.ndarray:
    """Lines of nodes from those of element boundaries."""
    return np.interp(np.arange(degree * (lines.size - 1) + 1) / degree, np.arange(lines.size), lines)


def _lengths(at: np.ndarray, degree: int, power: int = 0) -> np.ndarray:
    """Integral (n,) of the function of each node times a power of the place, 0 or 1, over a line of sides that rise."""
    found, values = np.zeros(at.size), at**power
    for first in range(0, at.size - 1, degree):
        side = slice(first, first + degree + 1)
        found[side] += (at[first + degree] - at[first]) * MASSES[degree] @ values[side]
    return found
