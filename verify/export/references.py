"""Reference nodes: a node for each loaded face or roller, tied to its mean displacement by an equation."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import groupby
from typing import NamedTuple

from verify.export.mesh import LoadedFace, SceneMesh
from verify.scene.schema import Scene

#: Numbers of a node and a component, from 1 on.
Place = tuple[int, int]

#: Least part of the largest coefficient of an equation; in the middle of a face that turns, rounding leaves less.
NO_WEIGHT = 1e-9


class Reference(NamedTuple):
    """A node that rises by the sum of factors times the mean displacements of ``faces``, ``part`` times the opening."""

    name: str
    node: int
    faces: Sequence[tuple[float, LoadedFace]]
    part: float

    @property
    def coefficients(self) -> Mapping[Place, float]:
        """Coefficients of its equation."""
        return {
            (int(node) + 1, face.component + 1): factor * float(weight)
            for factor, face in self.faces
            for node, weight in zip(face.node_n, face.weight_n, strict=True)
        }


def references(scene: Scene, mesh: SceneMesh) -> list[Reference]:
    """One for each loaded face; of arms on rollers one for all loads together, and one for each support.

    The reaction of the first one is the load.
    """
    if scene.specimen.slides:
        parts = [("load", [(face.factor, face) for face in mesh.loaded], 1.0)]
        supports = groupby(mesh.resting, key=lambda face: face.action)
        parts += [(name, [(1.0, face) for face in faces], 0.0) for name, faces in supports]
    else:
        parts = [(face.name, [(1.0, face)], face.factor) for face in mesh.loaded]
    first = int(mesh.number_n.max()) + 1
    return [Reference(f"{name}_mean", first + i, faces, part) for i, (name, faces, part) in enumerate(parts)]


def equations(points: Sequence[Reference], held: set[Place]) -> Iterator[list[tuple[Place, float]]]:
    """The terms of each equation, without the reference node.

    Abaqus eliminates the first term, which must be held nowhere and stand in no other equation: the largest of those.
    """
    every = [one.coefficients for one in points]
    for i, found in enumerate(every):
        taken = held.union(*every[:i], *every[i + 1 :])
        terms = sorted(found.items(), key=lambda term: (term[0] in taken, -abs(term[1])))
        least = NO_WEIGHT * max(map(abs, found.values()))
        yield [term for term in terms if abs(term[1]) > least]
