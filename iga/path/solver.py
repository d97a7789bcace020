"""What all solutions with one system share: the settings of Newton, the clock, and the factors of one tangent."""

from __future__ import annotations

from dataclasses import dataclass, replace

from iga.algebra.factors import Inverse
from iga.system.assembly import TangentPattern
from iga.system.state import Response, State
from iga.system.system import Phase, System, factorise, respond, untimed


@dataclass(frozen=True)
class Newton:
    """Tolerance on the residual relative to the forces in play, and limits.

    Far ahead of a crack the gaps alternate in sign while they decay below rounding: deciding there anew in every
    iteration sets penalty against cohesion for ever. So contact stays as it is once the residual is below ``settle``;
    what a point could be wrong by is then below that, too. Rounding of the forces is estimated only below ``rough``,
    and a state from which another search starts is good enough at ``predictor``. A search
    whose residual has not come below the best one for ``patience`` iterations goes round in circles, as the softening
    front does between two of its points, and ends.

    A step of ``furthest`` of the size of the model leads nowhere.

    Where the length of a step is searched for, a part ``slack`` of the work along it may be left, and there are
    ``searches`` attempts.
    """

    tolerance: float = 5e-12
    settle: float = 1e-8
    rough: float = 1e-4
    predictor: float = 1e-3
    iterations: int = 25
    patience: int = 6
    furthest: float = 0.5
    slack: float = 0.05
    searches: int = 12

    @property
    def searching(self) -> Newton:
        """Limits where every step is measured; the work falls then, the residual need not."""
        return replace(self, iterations=3 * self.iterations, patience=4 * self.patience)

    @property
    def predicting(self) -> Newton:
        """Limits for a state from which another search starts."""
        return replace(self, tolerance=self.predictor)


DEFAULT = Newton()

#: For a state at which hundreds of points decide at once.
MANY_DECIDE = Newton(iterations=100, patience=20)


@dataclass(frozen=True)
class Linearised:
    """A response, and the inverse of its tangent."""

    response: Response
    inverse: Inverse


class Solver:
    """A system, the settings of Newton, the clock ``phase``, and the factors of one tangent at a time.

    Factors are the largest object of a run. They are kept here and nowhere else, and dropped before others are made.
    """

    def __init__(self, system: System, newton: Newton = DEFAULT, phase: Phase = untimed) -> None:
        self.system, self.newton, self.phase = system, newton, phase
        self.linearised: Linearised | None = None
        self._pattern: TangentPattern | None = None  # that of the last tangent

    def of(self, system: System) -> Solver:
        """The same for another system; the factors of this one are dropped."""
        self.drop()
        return Solver(system, self.newton, self.phase)

    def respond(self, trial: State, decide: bool = True) -> Response:
        """Response to a trial state (see `iga.system.system.respond`)."""
        with self.phase("assembly"):
            return respond(self.system, trial, decide)

    def factorise(self, response: Response) -> Linearised | None:
        """Make the factors of a tangent those that are kept; None where it is exactly singular.

        Callers leave the answer where it is: what they hold on to is not dropped.
        """
        self.linearised = None
        with self.phase("assembly"):
            self._pattern = self.system.pattern(response, self._pattern)
        inverse = factorise(self.system, response, self._pattern, self.phase)
        self.linearised = None if inverse is None else Linearised(response, inverse)
        return self.linearised

    @property
    def inverse(self) -> Inverse:
        """Inverse of the tangent that was factorised last."""
        assert self.linearised is not None
        return self.linearised.inverse

    def drop(self) -> None:
        """Keep no factors any more."""
        self.linearised = None
