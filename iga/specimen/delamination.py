"""A delamination specimen: two bodies that are bonded on a part of a straight interface, loads at their ends, supports.

The double cantilever beam and the peel test are two of them.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from iga.bases.names import find
from iga.mesh.extraction import Mesh
from iga.specimen.body import Body
from iga.specimen.problem import Debonding
from iga.tsplines.tmesh import TMesh
from iga.tsplines.tspline import tspline_rectangle


@dataclass(frozen=True)
class Supports:
    """What holds a specimen: springs of stiffness spring_r (n_r,) on the displacements ``springs_rd @ u``, and clamps.

    ``free_d`` (n_dof,) is False where a degree of freedom is fixed.
    """

    springs_rd: np.ndarray
    spring_r: np.ndarray
    free_d: np.ndarray


@dataclass(frozen=True)
class Delamination:
    """A specimen in its own frame, X along the interface and Y across it; bodies upper first.

    ``meshes`` and matrices of ``elasticity`` of the bodies; T-meshes ``tmeshes`` of T-splines, else none. The bond
    ``bonded`` = (tip, end) is a part of what the bodies ``face`` of each other. ``loads`` are the end of each body,
    "left" or "right", on which the load acts across the specimen, and how many times; "" where it does not. It acts at
    X = ``loaded_at``, from where distances are counted, and the mesh is made for a crack that ends at the distance
    ``path_end``. ``copies`` is 2 where one body stands for both.
    """

    meshes: tuple[Mesh, ...]
    tmeshes: tuple[TMesh, ...]
    elasticity: tuple[np.ndarray, ...]
    bonded: tuple[float, float]
    face: tuple[float, float]
    loads: tuple[tuple[str, float], ...]
    loaded_at: float
    path_end: float
    supports: Callable[[tuple[Body, ...]], Supports]
    copies: float = 1.0

    @property
    def free_length(self) -> float:
        """Distance of the tip of the bond."""
        return abs(self.bonded[0] - self.loaded_at)


def meshes_of(
    problem: Debonding, tmeshes: Callable[[], tuple[TMesh, ...]], rectangles: Callable[[], tuple[Mesh, ...]]
) -> tuple[tuple[TMesh, ...], tuple[Mesh, ...]]:
    """T-meshes and meshes of the bodies: those that are given, or those of the basis; T-meshes of a local one alone."""
    if problem.meshes:
        return (), problem.meshes
    if not find(problem.basis).local:
        return (), rectangles()
    drawn = tmeshes()
    return drawn, tuple(tspline_rectangle(mesh) for mesh in drawn)
