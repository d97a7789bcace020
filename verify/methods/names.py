"""The built-in methods by name."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from verify.methods.beam import BEAM
from verify.methods.dolfinx import DOLFINX
from verify.methods.iga import LAGRANGE, NURBS, TSPLINE
from verify.methods.lefm import LEFM
from verify.methods.method import Method, NotRun, Unsuitable
from verify.scene.schema import Scene
from verify.scene.tables import one_of

__all__ = ["METHODS", "WITH_DOFS", "NotRun", "Unsuitable", "refuse_law"]

METHODS: Mapping[str, Method] = {method.name: method for method in (TSPLINE, NURBS, LAGRANGE, DOLFINX, BEAM, LEFM)}

#: Those whose mesh ``discretization.dofs`` sets.
WITH_DOFS = tuple(method.name for method in METHODS.values() if method.with_dofs)


def refuse_law(scene: Scene, who: str, has: Sequence[str]) -> None:
    """Raise Unsuitable where ``who`` does not have the law of a scene, naming the built-in methods that do."""
    law = scene.interface.law
    if law in has:
        return
    *head, last = [name for name, other in METHODS.items() if law in other.laws()]
    able = f"{', '.join(head)} and {last} have it" if head else f"{last} has it"
    raise Unsuitable(f"interface.law: must be {one_of(has)} for {who}, got {law!r}; {able}")
