"""Names of the built-in methods, and the two reasons why a method does not run."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from verify.support.refusal import Refusal

#: name -> what it is, in the words of the report
METHODS: Mapping[str, str] = {
    "tspline": "isogeometric, T-splines",
    "nurbs": "isogeometric, NURBS",
    "lagrange": "isogeometric code, Lagrange basis",
    "dolfinx": "DOLFINx, Lagrange elements",
    "beam": "beam on a cohesive interface",
    "lefm": "linear elastic fracture mechanics",
}
WITH_DOFS = ("tspline", "nurbs", "lagrange")

OnStep = Callable[[Mapping[str, float]], None]

#: Called with the opening of every converged step and with what makes its frame, see `verify.fields.frames`.
OnFrame = Callable[[float, Callable[[], Mapping[str, Any] | None]], None]


class NotRun(Exception):
    """A method that this machine cannot run; the message says why."""


class Unsuitable(Refusal):
    """A method that cannot solve this scene on any machine."""
