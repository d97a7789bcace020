"""A check of every run is a decorated formula: what it needs, allows and means stands above it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import wraps

import numpy as np

from verify.checks.mechanics.columns import Steps, has, worst
from verify.methods.method import Prepared
from verify.result import Result
from verify.scene.effects import simulated
from verify.scene.schema import Scene
from verify.verdict import Kind

Value = Callable[..., float | None]


@dataclass(frozen=True)
class Identity:
    """A check of every run; the fields are described in `identity`."""

    value: Value
    tolerance: float | Callable[[Prepared, Result], float]
    meaning: str | Callable[[Scene], str]
    kind: Kind
    of_zone: bool
    of_face: bool
    element: bool


#: By name.
IDENTITIES: dict[str, Identity] = {}


def identity(
    name: str,
    tolerance: float | Callable[[Prepared, Result], float],
    meaning: str | Callable[[Scene], str],
    *needs: str,
    slides: bool | None = None,
    kind: Kind = "exact",
    of_zone: bool = False,
    of_face: bool = False,
    element: bool = False,
) -> Callable[[Callable[..., float | np.ndarray | None]], Value]:
    """Register a formula of scene and columns as a check of every run, in the order of definition.

    What becomes of the formula is the value of the check: the largest relative deviation over the steps where the
    formula returns them, its number, or None where it does not apply.

    Parameters
    ----------
    tolerance : a number, or a function of the run
    meaning : one sentence for the reader of the report, or a function of the scene
    needs : columns without which the check is left out
    slides : whether the bond must slide, or must open alone
    kind : "exact" for an identity; see `verify.verdict.Check`
    of_zone : the error is that of the mesh in the process zone
    of_face : requires a load that is evenly distributed over the end face, as slopes under a point load do not converge
    element : the formula has a third argument, which builds a mesh and returns the length of its longest element
    """

    def register(formula: Callable[..., float | np.ndarray | None]) -> Value:
        @wraps(formula)
        def value(scene: Scene, steps: Steps, *more: Callable[[], float]) -> float | None:
            if not has(steps, *needs) or slides not in (None, simulated(scene)["shear"]):
                return None
            found = formula(scene, steps, *more)
            return found if found is None or isinstance(found, float) else worst(found)

        IDENTITIES[name] = Identity(value, tolerance, meaning, kind, of_zone, of_face, element)
        return value

    return register


@identity("completed", 1e-9, "The run reached the end of the load programme, or the specimen separated.")
def missing_part(scene: Scene, steps: Steps) -> float:
    """Distance of the last opening from the end of the programme, over the largest opening."""
    programme = np.array(scene.load.opening)
    reached = steps["opening"][-1] if steps["opening"].size else 0.0
    return float(abs(reached - programme[-1]) / np.max(np.abs(programme)))
