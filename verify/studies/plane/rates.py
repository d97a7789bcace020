"""Convergence rates in plane elasticity of NURBS, T-splines, and meshes with an extraordinary point.

One smooth field, prescribed by tractions on the whole boundary, on meshes with 4, 8 and 16 elements per direction.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np

from iga.bases.bspline import open_knots
from iga.bases.nurbs import nurbs_rectangle
from iga.elements.elasticity import isotropic
from iga.elements.plane_elasticity import no_rigid_motion, solve, stiffness, traction_forces
from iga.mesh.boundary import boundary_chains
from iga.mesh.extraction import Mesh
from iga.tsplines.lines import tensor_grid, with_line
from iga.tsplines.tspline import tspline_rectangle
from iga.tsplines.unstructured import polygon_mesh
from verify.studies.plane.errors import Errors, errors
from verify.studies.plane.study import SOLID
from verify.theory.plane_fields import smooth
from verify.verdict import Check

#: Elements per direction of the three meshes.
COUNTS = (4, 8, 16)
#: Tolerance for the difference of observed and expected order.
RATE_WITHIN = 0.15


@dataclass(frozen=True)
class Family:
    """A sequence of meshes by elements per direction; ``order`` is the theoretical one in L2, None if unknown."""

    name: str
    ink: str  # its colour in the palette of the report
    build: Callable[[int], Mesh]
    order: int | None


@dataclass(frozen=True)
class Convergence:
    """Unknowns and errors on the meshes of one family."""

    family: Family
    unknowns: tuple[int, ...]
    errors: tuple[Errors, ...]

    @property
    def rates(self) -> tuple[float, float]:
        """Rates in L2 and in the energy norm between the last two meshes."""
        a, b = self.errors[-2:]
        return float(np.log2(a.displacement / b.displacement)), float(np.log2(a.energy / b.energy))


def half_fine(n: int) -> Mesh:
    """The unit square with twice as many columns in its lower half: T-junctions along the line y = 0.5."""
    mesh = tensor_grid(np.linspace(0.0, 1.0, n + 1), np.linspace(0.0, 1.0, n + 1))
    for x in (np.arange(n) + 0.5) / n:
        mesh = with_line(mesh, "vertical", float(x), (0.0, 0.5))
    return tspline_rectangle(mesh)


def square(n: int) -> Mesh:
    """The unit square in n x n elements."""
    return nurbs_rectangle(*[open_knots(np.linspace(0.0, 1.0, n + 1), 3)] * 2)


MESH_FAMILIES = (
    Family("NURBS, unit square", "nurbs", square, 4),
    Family("T-spline with T-junctions, unit square", "tspline", half_fine, 4),
    *(
        Family(f"extraordinary point of valence {N}, regular polygon", ink, partial(polygon_mesh, N), None)
        for N, ink in ((3, "zone"), (5, "bad"), (6, "muted"))
    ),
)


def rates(families: tuple[Family, ...] = MESH_FAMILIES, counts: tuple[int, ...] = COUNTS) -> tuple[Convergence, ...]:
    """Solve all families; some 5 s."""
    return tuple(_convergence(family, counts) for family in families)


def rate_checks(found: tuple[Convergence, ...]) -> tuple[Check, ...]:
    """The rate of every family whose order is known."""
    meaning = "The rate in L2 is p + 1."
    return tuple(
        Check("rate", c.family.name, c.rates[0] - c.family.order, RATE_WITHIN, "analytical", meaning)
        for c in found
        if c.family.order is not None
    )


def _convergence(family: Family, counts: tuple[int, ...]) -> Convergence:
    D, unknowns, found = isotropic(**SOLID), [], []
    for n in counts:
        mesh = family.build(n)
        size = 1.0 if mesh.P_AI.min() > -1e-9 else 2.0
        exact = smooth(0.3 + 0.2j, size, 1.0, **SOLID)
        f_Ai = traction_forces(mesh, boundary_chains(mesh), exact.traction)
        u_Ai = solve(stiffness(mesh, D), f_Ai, no_rigid_motion(mesh))
        unknowns.append(u_Ai.size)
        found.append(errors(mesh, D, u_Ai, exact, up_to_rigid=True))
    return Convergence(family, tuple(unknowns), tuple(found))
