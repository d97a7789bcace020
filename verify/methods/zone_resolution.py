"""How many elements resolve the process zone, before a run and after it, and the mesh that would."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from math import nan

import numpy as np

from verify.methods.names import WITH_DOFS
from verify.methods.problems import dolfinx_problem, iga_problem
from verify.result import Result
from verify.scene.process_zone import bulk_length, slender_length
from verify.scene.schema import Scene

#: Elements that a zone needs at the least (Turon et al. 2007, sec. 2.2: three to five).
ENOUGH = 3

#: Meshes of fewer unknowns are made to see whether they resolve a zone; the size of larger ones is told by proportion.
AT_HAND = 5000


@dataclass(frozen=True)
class Zone:
    """Length of the zone by both formulas and the length of the elements along the interface, NaN without a mesh."""

    slender: float
    bulk: float
    element: float

    @property
    def length(self) -> float:
        """Shorter than either."""
        return 1.0 / (1.0 / self.slender + 1.0 / self.bulk)

    @property
    def elements(self) -> float:
        """How many elements span the zone."""
        return self.length / self.element

    @property
    def resolved(self) -> bool:
        """Also where there is no mesh that could fail to."""
        return not self.elements < ENOUGH


def expected(scene: Scene, method: str) -> Zone:
    """Zone and elements of a scene solved by one method."""
    return Zone(slender_length(scene), bulk_length(scene), element_length(scene, method))


def warnings(scene: Scene, method: str) -> tuple[str, ...]:
    """What to say before a run that cannot resolve its zone: one sentence with what to do, or nothing."""
    zone = expected(scene, method)
    if zone.resolved:
        return ()
    unit = _length_unit(scene)
    spans = (
        f"process zone {zone.length:.2g}{unit} < element {zone.element:.2g}{unit}"
        if zone.elements < 1
        else f"process zone {zone.length:.2g}{unit} spans {zone.elements:.1f} elements of {zone.element:.2g}{unit}, "
        f"fewer than {ENOUGH}"
    )
    return (
        f"{spans}: expect too high a load and snap-backs from element to element; {remedy(scene, method)}, "
        "or a lower interface.strength",
    )


def measured(result: Result) -> float:
    """Median length of the zone over the steps at which a crack runs, NaN where there is none.

    It reaches from the foremost fully open point to the foremost one past its strength; once that has come to the end
    of the specimen the rest is no whole zone.
    """
    steps = result.steps
    if not {"crack_length", "damage_front"} <= set(steps) or result.opening.size == 0:
        return nan
    crack, front = steps["crack_length"], steps["damage_front"]
    running = (crack > crack[0]) & (front < front.max())
    return float(np.median((front - crack)[running])) if running.any() else nan


def summary(scene: Scene, result: Result) -> dict[str, float]:
    """The entry ``process_zone`` of result.json; NaN where there is nothing to tell."""
    zone, length = expected(scene, result.method), measured(result)
    return {
        "estimate": zone.length,
        "elements": zone.elements,
        "measured": length,
        "measured_elements": length / zone.element,
    }


def element_length(scene: Scene, method: str) -> float:
    """Longest element along the bond, NaN for a method without a mesh, or where none can be made.

    A mesh that is made from the scene is made once; files may have changed.
    """
    return _longest.__wrapped__(scene, method) if scene.specimen.mesh else _longest(scene, method)


@lru_cache(maxsize=32)
def _longest(scene: Scene, method: str) -> float:
    try:
        if method in WITH_DOFS:
            from iga.specimen.specimen import element_length as longest

            solver, problem = iga_problem(scene, method)
            return longest(solver.build(problem))
        if method == "dolfinx":
            return float(np.max(dolfinx_problem(scene).specimen().bond_elements))
    except ValueError:
        pass
    return nan


def remedy(scene: Scene, method: str, elements: float = ENOUGH) -> str:
    """The setting of the mesh with which that many elements span the zone."""
    if scene.specimen.mesh and method in WITH_DOFS:
        return f"a mesh with {elements:.2g} elements in it resolves it"
    key, now = (
        ("dolfinx.elements", scene.dolfinx.elements)
        if method == "dolfinx"
        else ("discretization.dofs", scene.discretization.dofs)
    )
    # both grow about as the elements along the specimen do
    wanted = _rounded(now * elements / expected(scene, method).elements)
    while method in WITH_DOFS and wanted < AT_HAND and _with_dofs(scene, method, wanted).elements < elements:
        wanted = _rounded(1.05 * wanted)
    return f"{key} = {wanted} resolves it"


def _with_dofs(scene: Scene, method: str, dofs: int) -> Zone:
    mesh = scene.discretization.model_copy(update={"dofs": dofs})
    return expected(scene.model_copy(update={"discretization": mesh}), method)


def _rounded(number: float) -> int:
    """Up to two digits."""
    digits = 10 ** max(len(str(int(number))) - 2, 0)
    return int(np.ceil(number / digits) * digits)


def _length_unit(scene: Scene) -> str:
    """The scene's label of lengths after a space, empty where it does not tell."""
    parts = [part.strip() for part in scene.units.split(",")]
    return f" {parts[1]}" if len(parts) == 3 else ""
