"""The value of one quantity on which two codes agree, with the budget of each.

Uncertainties are expanded, for 95 %, in the unit of the quantity.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from math import hypot, isfinite, nan

import numpy as np

from verify.checks.between_codes import CODE_TOLERANCE
from verify.checks.certified import CERTIFIED_RULE
from verify.checks.proof import TRUST
from verify.curves.convergence import GCI_SAFETY
from verify.scene.stated.certified import CertifiedKind
from verify.studies.uncertainty import Budget, Part, Runs, of_meshes


@dataclass(frozen=True)
class BudgetShares:
    """Factors by which parts of a budget follow from runs.

    halved : error of the step length over the change by halving it: 4/3 for order 2, times the safety factor of the
        grid convergence index
    newton : relative error of a value by the Newton iteration: ten times the larger tolerance of both codes, 1e-10
    """

    halved: float = GCI_SAFETY * 4.0 / 3.0
    newton: float = 1e-9


BUDGET_SHARES = BudgetShares()


@dataclass(frozen=True)
class OfCode(Budget):
    """A quantity in one code: its values on the meshes, finest first, and the parts of the uncertainty of the first."""

    meshes: tuple[float, ...]

    @property
    def value(self) -> float:
        return self.meshes[0]

    @property
    def uncertainty(self) -> float:
        return self.of()


def of_code(found: Runs[float], sizes: Sequence[float], condition: float, shift: float = 0.0) -> OfCode:
    """The budget of one code.

    Parameters
    ----------
    found : values by what is varied: "mesh", "steps" half as long, and "thickness" with more layers, or without a run
    sizes : of the elements of the meshes
    condition : condition number of the tangents
    shift : what is added to the values to correct them to the model of the scene
    """
    finest, eps = found["mesh"][0], float(np.finfo(float).eps)
    change = {name: abs(one[0] - finest) if one else 0.0 for name, one in found.items()}
    sizes_of_parts = {
        "thickness": change["thickness"],
        "steps": BUDGET_SHARES.halved * change["steps"],
        "iteration": BUDGET_SHARES.newton * abs(finest),
        "rounding": eps * condition * abs(finest),
    }
    others = (Part(name, "num", u) for name, u in sizes_of_parts.items())
    return OfCode((of_meshes(sizes, found["mesh"]), *others), tuple(one + shift for one in found["mesh"]))


@dataclass(frozen=True)
class Value:
    """A quantity of a scene in two codes, and the common value.

    matched : change of the value by keeping the pairs of points, in the first code; None where no run shows it
    places : change of the value by another place of the load, in the first code; not part of the uncertainty
    least : least relative uncertainty that is stated (`shared`)
    """

    quantity: str
    kind: CertifiedKind
    opening: float | None
    codes: Mapping[str, OfCode]
    matched: float | None = 0.0
    places: Mapping[str, float] = field(default_factory=dict)
    least: float = 0.0

    @property
    def value(self) -> float:
        """Mean of the values on the finest meshes, each weighted by 1 / U^2."""
        weight = np.array([one.uncertainty**-2 for one in self.codes.values()])
        return float(weight @ [one.value for one in self.codes.values()] / weight.sum())

    @property
    def uncertainty(self) -> float:
        """The largest of: the smaller uncertainty of both codes, the distance of either code from the common value, and
        ``least``.

        The mesh errors of both codes may have the same sign, so that the mean is not better than the better code.
        """
        least = min(one.uncertainty for one in self.codes.values())
        return max(least, self.least * abs(self.value), *(abs(one.value - self.value) for one in self.codes.values()))

    @property
    def apart(self) -> float:
        """Distance of both codes over the distance that their uncertainties allow, sqrt(U_1^2 + U_2^2)."""
        one, other = self.codes.values()
        return abs(one.value - other.value) / hypot(one.uncertainty, other.uncertainty)

    @property
    def relative(self) -> float:
        return self.uncertainty / abs(self.value) if self.value else nan

    @property
    def errors(self) -> dict[str, tuple[float, float]]:
        """Distance of the value and of each code from it, and their uncertainties, over it."""
        value, codes = self.value, self.codes.items()
        of_codes = {name: (one.value / value - 1.0, one.uncertainty / abs(value)) for name, one in codes}
        return {"": (0.0, self.relative), **of_codes}

    @property
    def doubt(self) -> str:
        """Why the value is not certified; empty where it is. With a larger uncertainty than the largest here a check
        could not detect a wrong run."""
        largest = TRUST.certain * CODE_TOLERANCE * CERTIFIED_RULE.wider(self.kind)
        if not isfinite(self.value):
            return "a run has no such value"
        if not self.apart <= 1.0:
            said = " and ".join(f"{name} {one.value:.6g} ± {one.uncertainty:.2g}" for name, one in self.codes.items())
            return f"{said} differ by more than their uncertainties: one of these is too small, or the models differ"
        if not self.relative <= largest:
            return f"its uncertainty is {self.relative:.2%}, more than {largest:.2%}: take finer meshes"
        return ""

    @property
    def sentence(self) -> str:
        """peak load: 0.55093 ± 0.0003 (0.05 %)"""
        if self.doubt:
            return f"{self.quantity}: not certified: {self.doubt}"
        return f"{self.quantity}: {self.value:.6g} ± {self.uncertainty:.2g} ({self.relative:.3%})"


def shared(values: Sequence[Value]) -> tuple[Value, ...]:
    """The values; every load at an opening gets at least the largest relative uncertainty of the certified loads.

    The load oscillates as the front passes from element to element. Three meshes may agree by chance at one opening;
    the uncertainty at the other openings shows it.
    """
    least = max((one.relative for one in values if one.kind == "load_at" and not one.doubt), default=0.0)
    return tuple(replace(one, least=least) if one.kind == "load_at" else one for one in values)
