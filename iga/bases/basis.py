"""What a basis is: its functions on rectangles, and what solvers, methods, studies and pages need to know of it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np

from iga.mesh.extraction import Mesh


@dataclass(frozen=True, kw_only=True)
class Basis:
    """A tensor-product basis of rectangles, or T-splines on them.

    Parameters
    ----------
    name : that of ``basis`` in a problem, and of its method
    label : its name in tables and legends
    what : what it is, in the words of the report
    columns : number of functions of one direction, by degree and number of elements
    rectangle : the mesh of elements with boundaries breaks_s (n_s + 1,) x breaks_t (n_t + 1,), of two degrees
    degrees : the polynomial degrees that are available
    smooth : whether functions are smoother than C0 between elements
    local : whether specimens get T-meshes of it, which halve the elements on the crack path; ``rectangle`` is not used
    mesh_error : discretisation error of the load curve of a packaged scene; 0 where it is below the tolerances between
        codes
    in_a_zone, in_fading : elements in a process zone, and in the length over which slip fades on an intact bond, over
        those of NURBS that leave the same error
    coarsest : degree -> elements in the process zone on the coarsest mesh that ``debond cost`` tries; empty: not tried
    colours : of its curves on a light and on a dark page; chosen from spare ones where left out
    dashes : of its curves, lengths on and off in points; empty for a solid line
    place, row : position among the bases in messages (equal ones sorted by name) and among the methods in tables
    """

    name: str
    label: str
    what: str
    columns: Callable[[int, int], int]
    rectangle: Callable[[tuple[int, int], np.ndarray, np.ndarray], Mesh]
    degrees: tuple[int, ...] = (1, 2, 3, 4, 5)
    smooth: bool = True
    local: bool = False
    mesh_error: float = 0.0
    in_a_zone: float = 1.0
    in_fading: float = 1.0
    coarsest: Mapping[int, float] = field(default_factory=dict)
    colours: tuple[str, str] | None = None
    dashes: tuple[float, ...] = ()
    place: int = 100
    row: int = 3

    def least_dofs(self, degree: int) -> int:
        """Unknowns of the coarsest mesh of two arms: each has two elements along and one through it; T-meshes halve the
        element on the crack path."""
        return 4 * (degree + 1) * self.columns(degree, 2) + 4 * self.local
