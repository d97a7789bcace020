"""Standard uncertainties of one quantity by the mesh, the inputs, the introduction of the load, and the data.

ASME V&V 20-2009, *Standard for Verification and Validation in Computational Fluid Dynamics and Heat Transfer*: u_num in
section 2, u_input by sensitivity coefficients in section 3, u_D in section 4, u_val in section 5.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import hypot, sqrt

from verify.curves.convergence import mesh_error


@dataclass(frozen=True)
class Estimates:
    """How an uncertainty follows from runs.

    expansion : grid convergence index (95 %) over the standard uncertainty. The error of a mesh has a known sign, so
        that the interval is one-sided: the factor is 1.1 to 1.15, and not 2 as for a normal distribution
    linear : a contribution is linear if its second-order term is at most this part of it
    """

    expansion: float = 1.15
    linear: float = 0.1


ESTIMATES = Estimates()


@dataclass(frozen=True)
class Part:
    """One line of a budget.

    name : dotted key of an input or of the data, "mesh", or "load introduction"
    kind : "num", "input", "introduction" or "data"
    u : standard uncertainty of the quantity [its unit], with the sign of the sensitivity
    stated : relative standard uncertainty that the scene states, 0 where it states none
    sensitivity : relative change of the quantity over that of the input
    second : second-order term of the contribution [unit of the quantity]
    remark : finding on the meshes, or the values at the places of the load
    doubtful : whether meshes are not in the asymptotic range
    """

    name: str
    kind: str
    u: float
    stated: float = 0.0
    sensitivity: float = float("nan")
    second: float = 0.0
    remark: str = ""
    doubtful: bool = False

    @property
    def straight(self) -> bool:
        """Whether the quantity is linear in the input over its uncertainty."""
        return abs(self.second) <= ESTIMATES.linear * abs(self.u)


@dataclass(frozen=True)
class Moved:
    """Values of a quantity with an input at (1 - step), 1 and (1 + step) times its value."""

    step: float
    low: float
    middle: float
    high: float

    @property
    def slope(self) -> float:
        """Central difference: change of the quantity over relative change of the input."""
        return (self.high - self.low) / (2.0 * self.step)

    @property
    def bend(self) -> float:
        """Half the second derivative."""
        return (self.high - 2.0 * self.middle + self.low) / (2.0 * self.step**2)


def of_input(name: str, stated: float, moved: Moved, kind: str = "input") -> Part:
    """Part of an input: ``(dq/dx) u_x``, with the second-order term of the series (V&V 20-2009, section 3)."""
    u, second = moved.slope * stated, moved.bend * stated**2
    return Part(name, kind, u, stated, moved.slope / moved.middle if moved.middle else float("nan"), second)


def of_meshes(sizes: Sequence[float], values: Sequence[float]) -> Part:
    """Part of the mesh: the index of the finest of three or more meshes (`verify.curves.convergence`) over
    `Estimates.expansion`."""
    found = mesh_error(sizes, values)
    return Part("mesh", "num", found.index / ESTIMATES.expansion, remark=found.verdict, doubtful=found.doubtful)


def of_introduction(values: Mapping[str, float]) -> Part:
    """Part of the place of the load: a uniform distribution between the extremes, with their distance over sqrt(12)."""
    width = max(values.values()) - min(values.values())
    seen = ", ".join(f"{place} {value:.6g}" for place, value in values.items())
    return Part("load introduction", "introduction", width / sqrt(12.0), remark=seen)


def of_data(stated: Mapping[str, float], value: float, over_opening: float) -> tuple[Part, ...]:
    """Parts of the data: errors that are common to all loads, and to all openings.

    Parameters
    ----------
    stated : relative standard uncertainties "data.load" and "data.opening"
    value : value of the quantity in the data
    over_opening : change of the quantity over the relative change of all openings, from the curve of the simulation,
        which is smooth
    """
    slopes = {"data.load": value, "data.opening": over_opening}
    return tuple(
        Part(key, "data", slopes[key] * u, u, slopes[key] / value if value else float("nan"))
        for key, u in stated.items()
        if u
    )


def together(parts: Sequence[Part]) -> float:
    """Root of the sum of squares."""
    return hypot(*(part.u for part in parts))
