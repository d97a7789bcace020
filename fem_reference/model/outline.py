"""Loads and supports on patches as functionals of the displacements."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import ufl
from dolfinx import fem

from fem_reference.dolfinx_api import compile_forms
from fem_reference.model.assembled import BlockVector, owned
from fem_reference.model.forms import bulk_points, constant
from fem_reference.model.mesh import TwoBodies
from fem_reference.model.supports import Displacement
from fem_reference.problem.specimen import Action, Specimen

#: Marker of the facets of the patch that a form is assembled on.
PATCH = 0


@dataclass(frozen=True)
class ActionRows:
    """Rows of the loads and supports, one for each action, over the unknowns that this rank owns.

    ``mean_kn`` (n_k, n) gives the mean displacement that is conjugate to the unit traction, and is also its nodal
    forces; ``slope_kn`` gives the mean of the derivative of the displacement by X. ``factor_k`` are the parts of the
    load, then the stiffnesses of the supports.
    """

    mean_kn: np.ndarray
    slope_kn: np.ndarray
    factor_k: np.ndarray
    loads: int

    @property
    def load_n(self) -> np.ndarray:
        """Nodal forces (n,) of a unit load."""
        return self.factor_k[: self.loads] @ self.mean_kn[: self.loads]

    @property
    def springs_kn(self) -> np.ndarray:
        """Elongations of the supporting springs, times the square root of their stiffness."""
        return np.sqrt(self.factor_k[self.loads :])[:, None] * self.mean_kn[self.loads :]


def action_rows(
    specimen: Specimen, bodies: TwoBodies, displacement: Displacement, degree: int, maps: Any
) -> ActionRows:
    """Rows of the loads, then of the supports, then of the springs against rigid motions."""
    facets = iter(bodies.patches)
    rows = np.zeros((2, len(specimen.actions), sum(owned(u) for u in displacement)))
    for k, act in enumerate(specimen.actions):
        for patch in act.patches:
            part = _patch_rows(act, next(facets), displacement[patch.body], bodies, degree, maps) / specimen.depth
            first = 0 if patch.body == 0 else owned(displacement[0])
            rows[:, k, first : first + part.shape[1]] += part
    factors = np.array([act.factor for act in specimen.actions])
    return ActionRows(rows[0], rows[1], factors, len(specimen.pulls))


def _patch_rows(
    act: Action, facets: np.ndarray, u: fem.Function, bodies: TwoBodies, degree: int, maps: Any
) -> np.ndarray:
    """Mean displacement and mean slope (2, n) of one patch; one compiled form serves all patches."""
    ds = ufl.Measure(
        "ds",
        domain=bodies.parent,
        subdomain_data=[(PATCH, facets.ravel())],
        metadata={"quadrature_degree": 2 * bulk_points(degree) - 1},
    )
    push, turn, middle = (constant(bodies.parent, value) for value in (act.push, act.turn, act.middle))
    Y = ufl.SpatialCoordinate(bodies.parent)[1]
    traction = ufl.as_vector([turn * (middle - Y), push, 0.0][: bodies.parent.topology.dim])
    v = ufl.TestFunction(u.function_space)
    forms = [ufl.inner(traction, w) * ds(PATCH) for w in (v, v.dx(0))]
    return np.stack([BlockVector([compile_forms(form, maps)]).assemble() for form in forms])
