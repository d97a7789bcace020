"""What a path is made of: converged points, and how it ended."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from iga.path.tangent import Tangent
from iga.system.state import Energies, Response, State


@dataclass(frozen=True)
class Point:
    """A converged point of the path, its history committed, and the tangent on which the path leaves it.

    ``slope`` is d load / d opening there and ``heading`` the sign of the change of the opening along the path;
    ``external_work`` is the integral of the load over the opening along the path.
    ``residuals`` are the norms that Newton went through, relative to the scale of the forces.
    ``before`` is where the step that ended here began, opening and load, if points broke on it.
    """

    state: State
    response: Response
    opening: float
    tangent: Tangent
    external_work: float
    energies: Energies
    residuals: tuple[float, ...]
    before: tuple[float, float] | None = None

    @property
    def slope(self) -> float:
        return self.tangent.slope

    @property
    def heading(self) -> float:
        return self.tangent.heading

    @property
    def front(self) -> int:
        """The point that has opened furthest among those whose damage grows along the path."""
        return int(np.argmax(np.where(self.tangent.growing_q, self.response.x_q, -np.inf)))

    @property
    def residual(self) -> float:
        """Norm of the residual forces; 0 of a point that Newton did not have to find."""
        return self.residuals[-1] * self.response.scale if self.residuals else 0.0

    @property
    def iterations(self) -> int:
        return len(self.residuals)


@dataclass(frozen=True)
class End:
    """How a path ended: ``complete`` or ``stopped: <cause and what to do>``, and how many steps were rejected.

    ``separated``: the specimen came apart before the programme was over, which is a complete path, too. ``counted``:
    the opening from which a path that chose its step lengths went on with steps of one length.
    """

    status: str
    rejected: int
    separated: bool = False
    counted: float | None = None
