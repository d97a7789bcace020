"""The statement of ASME V&V 20-2009: comparison error, validation uncertainty, interval of the error of the model."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from math import isfinite

import numpy as np

from verify.curves.curve import Curve
from verify.studies.validation.budget import Moved, Part, of_data, of_input, of_introduction, of_meshes, together
from verify.studies.validation.quantities import Quantity

#: Coverage factor for 95 %: V&V 20-2009, section 6, for a normal distribution of the errors.
COVERAGE = 2.0

#: Least relative step of an input, for changes that are larger than errors of Newton's method and of the steps.
LEAST_STEP = 0.005

#: Relative change of all openings by which a quantity is differentiated: well inside `Windows.whole`.
OPENING_STEP = 0.005

#: A second-order term up to this part of u_val is negligible.
NEGLIGIBLE_BEND = 0.1

#: Largest part of u_val that may come from meshes outside of the asymptotic range (they then add 5 % to it); above it
#: no statement is made.
NEGLIGIBLE_MESH = 0.3


@dataclass(frozen=True)
class Curves:
    """Curves of the simulation, each opening (n,) and load (n,).

    scene : of the scene as it is
    inputs : dotted key of an input -> its relative step, and the curves with it smaller and larger by that
    meshes : (size, curve) of each mesh; empty for a method without a mesh
    places : where the load acts -> curve; empty where there is one place
    """

    scene: Curve
    inputs: Mapping[str, tuple[float, Curve, Curve]] = field(default_factory=dict)
    meshes: Sequence[tuple[float, Curve]] = ()
    places: Mapping[str, Curve] = field(default_factory=dict)


@dataclass(frozen=True)
class Known:
    """Relative standard uncertainties of inputs and of "data.load" and "data.opening", 0 where nothing is stated."""

    inputs: Mapping[str, float]
    data: Mapping[str, float]


@dataclass(frozen=True)
class Statement:
    """The statement on one quantity.

    S, D : its value in the simulation and in the data
    parts : the lines of its budget
    """

    quantity: str
    where: str
    S: float
    D: float
    parts: tuple[Part, ...]

    @property
    def E(self) -> float:
        """Comparison error S - D."""
        return self.S - self.D

    def of(self, *kinds: str) -> float:
        """Standard uncertainty of all parts of some kinds together."""
        return together([part for part in self.parts if part.kind in kinds])

    @cached_property
    def u_val(self) -> float:
        """sqrt(u_num^2 + u_input^2 + u_D^2); the introduction of the load is an input."""
        return together(self.parts)

    @property
    def interval(self) -> tuple[float, float]:
        """E - k u_val and E + k u_val, between which the error of the model lies."""
        return self.E - COVERAGE * self.u_val, self.E + COVERAGE * self.u_val

    @property
    def resolved(self) -> bool:
        """Whether the error of the model is distinguishable from zero."""
        return abs(self.E) > COVERAGE * self.u_val

    @property
    def doubt(self) -> str:
        """Why no statement can be made; empty where one can."""
        if not isfinite(self.E) or not isfinite(self.u_val):
            return "not every run has such a value"
        for part in self.parts:
            if part.doubtful and part.u > NEGLIGIBLE_MESH * self.u_val:
                share = f"they differ by so much that they would make {part.u / self.u_val:.0%} of u_val"
                return f"the meshes are {part.remark}, and {share}: take finer ones"
        return ""

    @property
    def verdict(self) -> str:
        """The statement in a clause."""
        low, high = self.interval
        if self.doubt:
            return f"no statement: {self.doubt}"
        if self.resolved:
            more = "more" if self.E > 0 else "less"
            return f"the model shows {more} than the data: its error is between {low:+.4g} and {high:+.4g}"
        return f"the error of the model cannot be told from zero: it is between {low:+.4g} and {high:+.4g}"

    @property
    def sentence(self) -> str:
        """peak load: S 0.551, D 0.542, E = +0.009 (+1.6 %), u_val 1.3 %: the error of the model ..."""
        values = f"S {self.S:.5g}, D {self.D:.5g}, E {self.E:+.3g} ({self.part(self.E):+.2%} of D)"
        return f"{self.quantity}: {values}, u_val {self.part(self.u_val):.2%}: {self.verdict}"

    @property
    def remarks(self) -> list[str]:
        """Contributions that are not negligible and not linear."""
        return [
            f"{self.quantity}: not linear in {p.name}: over its uncertainty the second-order term is "
            f"{abs(p.second / p.u) if p.u else float('inf'):.0%} of the first, which alone counts here"
            for p in self.parts
            if self.bent(p)
        ]

    def bent(self, part: Part) -> bool:
        """Whether a part is not linear over its uncertainty, and its second-order term counts in u_val."""
        return not part.straight and abs(part.second) > NEGLIGIBLE_BEND * self.u_val

    def part(self, value: float) -> float:
        """A value over that of the data."""
        return value / abs(self.D) if self.D else float("nan")


def statement(quantity: Quantity, curves: Curves, data: Curve, known: Known) -> Statement:
    """The statement on one quantity of the curves of a simulation and of data."""
    of = quantity.of
    S, D = of(curves.scene), of(data)
    parts = (
        [of_meshes([size for size, _ in curves.meshes], [of(one) for _, one in curves.meshes])] if curves.meshes else []
    )
    for key, (step, low, high) in curves.inputs.items():
        parts.append(of_input(key, known.inputs[key], Moved(step, of(low), S, of(high))))
    if curves.places:
        parts.append(of_introduction({place: of(one) for place, one in curves.places.items()}))
    over_opening = moved_opening(of, curves.scene, OPENING_STEP).slope
    parts += of_data(known.data, D, over_opening)
    return Statement(quantity.name, quantity.where, S, D, tuple(parts))


def moved_opening(of: Callable[[Curve], float], curve: Curve, step: float) -> Moved:
    """A quantity with all openings of a curve smaller and larger by a part of them."""
    d, P = (np.asarray(values, dtype=float) for values in curve)
    low, high = (of((d * factor, P)) for factor in (1.0 - step, 1.0 + step))
    return Moved(step, low, of(curve), high)
