"""The statement of ASME V&V 20-2009 on the error of the model: comparison error, budget, validation uncertainty.

*Standard for Verification and Validation in Computational Fluid Dynamics and Heat Transfer*: u_num in section 2,
u_input by sensitivity coefficients in section 3, u_D in section 4, u_val in section 5. Uncertainties are standard ones.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from math import inf, isfinite, nan, sqrt

import numpy as np

from verify.curves.curve import Curve
from verify.pages.table import Table
from verify.scene.stated.uncertainty import Uncertainty
from verify.studies.uncertainty import Budget, Part, Runs, of_meshes, percent, values
from verify.studies.validation.quantities import Quantity


@dataclass(frozen=True)
class Estimates:
    """How uncertainties follow from runs, and which are negligible.

    coverage : factor for 95 %: V&V 20-2009, section 6, for a normal distribution of the errors
    expansion : grid convergence index (95 %) over the standard uncertainty. The error of a mesh has a known sign, so
        that the interval is one-sided: the factor is 1.1 to 1.15, and not 2 as for a normal distribution
    step : least relative step of an input, for changes that are larger than errors of Newton's method and of the steps;
        of all openings of a curve, well inside `Windows.whole`
    linear : a contribution is linear if its second-order term is at most this part of it
    bend : a second-order term up to this part of u_val is negligible
    mesh : largest part of u_val that may come from meshes outside of the asymptotic range (they then add 5 % to it);
        above it no statement is made
    """

    coverage: float = 2.0
    expansion: float = 1.15
    step: float = 0.005
    linear: float = 0.1
    bend: float = 0.1
    mesh: float = 0.3


ESTIMATES = Estimates()


@dataclass(frozen=True)
class Statement(Budget):
    """The statement on one quantity: its value in the simulation, ``S``, and in the data, ``D``."""

    quantity: str
    where: str
    S: float
    D: float

    @property
    def E(self) -> float:
        """Comparison error S - D."""
        return self.S - self.D

    @cached_property
    def u_val(self) -> float:
        """sqrt(u_num^2 + u_input^2 + u_D^2); the introduction of the load is an input."""
        return self.of()

    @property
    def model_error(self) -> tuple[float, float]:
        """E - k u_val and E + k u_val, between which the error of the model lies."""
        return self.E - ESTIMATES.coverage * self.u_val, self.E + ESTIMATES.coverage * self.u_val

    @property
    def errors(self) -> dict[str, tuple[float, float]]:
        """The error of the model and its uncertainty, over the data."""
        return {"": (self.part(self.E), ESTIMATES.coverage * self.part(self.u_val))}

    @property
    def resolved(self) -> bool:
        """Whether the error of the model is distinguishable from zero."""
        return abs(self.E) > ESTIMATES.coverage * self.u_val

    @property
    def doubt(self) -> str:
        """Why no statement can be made; empty where one can."""
        if not isfinite(self.E) or not isfinite(self.u_val):
            return "not every run has such a value"
        for part in self.parts:
            if part.doubtful and part.u > ESTIMATES.mesh * self.u_val:
                share = f"they differ by so much that they would make {part.u / self.u_val:.0%} of u_val"
                return f"the meshes are {part.remark}, and {share}: take finer ones"
        return ""

    @property
    def sentence(self) -> str:
        """peak load: S 0.551, D 0.542, E = +0.009 (+1.6 %), u_val 1.3 %: the error of the model ..."""
        low, high = self.model_error
        if self.doubt:
            verdict = f"no statement: {self.doubt}"
        elif self.resolved:
            more = "more" if self.E > 0 else "less"
            verdict = f"the model shows {more} than the data: its error is between {low:+.4g} and {high:+.4g}"
        else:
            verdict = f"the error of the model cannot be told from zero: it is between {low:+.4g} and {high:+.4g}"
        told = f"S {self.S:.5g}, D {self.D:.5g}, E {self.E:+.3g} ({self.part(self.E):+.2%} of D)"
        return f"{self.quantity}: {told}, u_val {self.part(self.u_val):.2%}: {verdict}"

    @property
    def remarks(self) -> list[str]:
        """Contributions that are not negligible and not linear."""
        return [
            f"{self.quantity}: not linear in {p.name}: over its uncertainty the second-order term is "
            f"{abs(p.second / p.u) if p.u else inf:.0%} of the first, which alone counts here"
            for p in self.parts
            if self.bent(p)
        ]

    def bent(self, part: Part) -> bool:
        """Whether a part is not linear over its uncertainty, and its second-order term counts in u_val."""
        return abs(part.second) > max(ESTIMATES.linear * abs(part.u), ESTIMATES.bend * self.u_val)

    def part(self, value: float) -> float:
        """A value over that of the data."""
        return value / self.D

    @property
    def table(self) -> Table:
        """Every part of its uncertainty, and the sums."""
        rows: list[Sequence[object]] = [
            (p.name, percent(p.stated) if p.stated else "", p.sensitivity, abs(p.u), percent(abs(self.part(p.u))),
             p.remark or "not linear" * self.bent(p)) for p in self.parts
        ]  # fmt: skip
        sums = {"u_num": self.of("num"), "u_input": self.of("input", "introduction"), "u_D": self.of("data")}
        rows += [(name, "", "", u, percent(self.part(u)), "") for name, u in {**sums, "u_val": self.u_val}.items()]
        titles = (self.quantity, "stated", "sensitivity", "u", "u / D", "remark")
        return Table.of(titles, rows, f"{self.quantity.capitalize()}: every part of its uncertainty", "methods told")


def statement(
    quantity: Quantity, curves: Runs[Curve], sizes: Sequence[float], data: Curve, stated: Uncertainty
) -> Statement:
    """The statement on one quantity.

    Parameters
    ----------
    curves : of the simulation, opening (n,) and load (n,), by what is varied: "mesh", the keys of inputs, each smaller
        and larger, and the places of the load
    sizes : of the elements of the meshes; fewer than two for a method without a mesh
    stated : relative standard uncertainties of inputs and of the data
    """
    of, found = quantity.of, values(curves, quantity.of)
    S, D = found["mesh"][0], of(data)
    parts = [of_meshes(sizes, found["mesh"], ESTIMATES.expansion)] if len(sizes) > 1 else []
    parts += [of_input(key, u, found[key][0], S, found[key][1]) for key, u in stated.inputs.items()]
    loaded = {name.rpartition("=")[2]: value for name, (value, *_) in found.items() if name.startswith("load.at=")}
    if loaded:  # a uniform distribution between the extremes
        seen = ", ".join(f"{place} {value:.6g}" for place, value in loaded.items())
        width = max(loaded.values()) - min(loaded.values())
        parts.append(Part("load introduction", "introduction", width / sqrt(12.0), remark=seen))
    d, P = (np.asarray(column, dtype=float) for column in curves["mesh"][0])
    low, high = (
        of((d * (1.0 + sign * ESTIMATES.step), P)) for sign in (-1.0, 1.0)
    )  # of the simulation, as it is smooth
    slopes = {"data.load": D, "data.opening": (high - low) / (2.0 * ESTIMATES.step)}
    parts += [
        Part(key, "data", slopes[key] * u, u, slopes[key] / D if D else nan) for key, u in stated.data.items() if u
    ]
    return Statement(tuple(parts), quantity.name, quantity.where, S, D)


def step_of(u: float) -> float:
    """The relative step of an input of this relative standard uncertainty."""
    return max(u, ESTIMATES.step)


def of_input(key: str, u: float, low: float, middle: float, high: float) -> Part:
    """Part of an input: ``(dq/dx) u_x``, with the second-order term of the series (V&V 20-2009, section 3), from the
    values with the input one step smaller, as it is, and one larger."""
    step = step_of(u)
    slope, bend = (high - low) / (2.0 * step), (high - 2.0 * middle + low) / (2.0 * step**2)
    return Part(key, "input", slope * u, u, slope / middle if middle else nan, bend * u**2)
