"""What all solutions with one system share: the settings of Newton, the clock, and the factors of one tangent."""

from __future__ import annotations

from dataclasses import dataclass, replace

from iga.algebra.factors import Inverse
from iga.system.assembly import Pattern
from iga.system.state import Response, State
from iga.system.system import Phase, System, factorise, respond, untimed


@dataclass(frozen=True)
class Newton:
    """``tolerance`` on the residual relative to the forces of the elements, and limits of Newton's method.

    - ``settle``: residual below which contact does not change any more. Far ahead of a crack the gaps alternate in sign
      while they decay below rounding: to decide on contact there in every iteration would switch between penalty and
      cohesion for ever. The error of a point that keeps the wrong state is below ``settle``, too.
    - ``rough``: residual above which rounding of the forces is not estimated.
    - ``predictor``: tolerance for a state from which another search starts.
    - ``iterations``: largest number of iterations; ``patience``: number of iterations without a new smallest residual
      after which the search ends, as it goes round in circles (for instance between two points of a softening front).
    - ``furthest``: largest step relative to the size of the model.
    - ``slack``: part of the work of the residual that a line search may leave; ``searches``: its attempts.
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
        """Limits with a line search in every step: the work of the residual falls then, its norm need not."""
        return replace(self, iterations=3 * self.iterations, patience=4 * self.patience)

    @property
    def predicting(self) -> Newton:
        """Limits for a state from which another search starts."""
        return replace(self, tolerance=self.predictor)


DEFAULT = Newton()

#: Limits for a state at which contact is open at hundreds of points at once.
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
        self._pattern: Pattern | None = None  # that of the last tangent

    def of(self, system: System) -> Solver:
        """The same for another system; the factors of this one are dropped."""
        self.drop()
        return Solver(system, self.newton, self.phase)

    def respond(self, trial: State, decide: bool = True) -> Response:
        """Response to a trial state (see `iga.system.system.respond`)."""
        with self.phase("assembly"):
            return respond(self.system, trial, decide)

    def factorise(self, response: Response) -> Linearised | None:
        """Factorise the tangent of a response and keep its factors; None where it is exactly singular, or where faces
        have slid too far for one.

        Callers must not keep a reference to the answer: `drop` could not free it.
        """
        self.linearised = None
        with self.phase("assembly"):
            pattern = self.system.pattern(response, self._pattern)
        if pattern is None:
            return None
        self._pattern = pattern
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
