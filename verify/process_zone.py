"""The process zone: how long it will be, and how many elements resolve it, before anything is solved.

A mesh with fewer than three elements in the zone overestimates the strength, and its curve snaps back at every element
(Turon, Davila, Camanho, Costa 2007; Harper and Hallett 2008). The length has two limits. In a *bulky* body it is
``l = M E' G_Ic / p_max^2`` of the material, with M = 1 (Hillerborg, Modeer, Petersson 1976; factors in use go from 0.2
to 1, Turon et al. 2007, table 1). In a *slender* one the arms bend out of the way first, and
``l = M (E' G_Ic / p_max^2)^(1/4) h^(3/4)`` (Williams and Hadavinia 2002; Yang and Cox 2005). An arm that is neither
yields in both ways, and its zone is shorter than either: 0.52 mm where they are 1.43 and 1.08 in alfano-crisfield.
``1 / l = 1 / l_slender + 1 / l_bulky`` is no more than a choice that comes to both limits; the zones that were measured
are 0.84 to 1.16 of it, but 0.48 to 1.14 of the smaller limit.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from math import nan

import numpy as np
from numpy import cos, cosh, sin, sinh
from scipy.optimize import brentq

from verify.methods import WITH_DOFS
from verify.problems import dolfinx_problem, elastic_constants, iga_problem
from verify.result import Result
from verify.scene import Scene
from verify.specimen import Material

#: Elements that a zone needs at the least (Turon et al. 2007, sec. 2.2: three to five).
ENOUGH = 3

#: Meshes of fewer unknowns are made to see whether they resolve a zone; the size of larger ones is told by proportion.
AT_HAND = 5000

#: First root of cosh(x) cos(x) = -1, that of a cantilever's first mode.
CANTILEVER = 1.8751040687119611


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


def bulk_length(scene: Scene) -> float:
    """``E' G_Ic / p_max^2`` of the softer body."""
    law, specimen = scene.interface, scene.specimen
    return min(crack_modulus(body, specimen.plane) for body, _ in _bodies(scene)) * law.toughness / law.strength**2


def slender_length(scene: Scene) -> float:
    """``l = x (E I (g_u - g_max) / p_max)^(1/4)`` with x of `slender_factor`, all per unit width.

    ``1 / E I`` is the sum over the bodies that bend: both arms of a dcb, the strip of a peel. For a traction that drops
    from the start (ductility without bound) it is ``1.0075 (E' G_Ic / p_max^2)^(1/4) h^(3/4)`` in a dcb.
    """
    law, plane = scene.interface, scene.specimen.plane
    softness = sum(12.0 / (bending_modulus(body, plane) * height**3) for body, height in _bending(scene))
    g_u = 2.0 * law.toughness / law.strength
    return slender_factor(law.ductility) * (g_u * (1.0 - 1.0 / law.ductility) / (law.strength * softness)) ** 0.25


def slender_factor(ductility: float) -> float:
    """Length x of the softening part in ``xi = X (p_max / (E I (g_u - g_max)))^(1/4)``, from the beam on its law.

    With phi = 1 - g/g_u the softening part is ``phi'''' = phi``, from xi = 0 (g = g_max), where it joins the decaying
    solution on the elastic part, to xi = x (g = g_u), where a moment but no shear force comes from the far load: two
    conditions for x and for the one free constant there. Ductility to infinity: cosh x cos x = -1.
    """
    m, k = 1.0 / ductility, ((ductility - 1.0) / 4.0) ** 0.25  # on the elastic part g'''' = -4 k^4 g
    fixed = np.array([1.0 - m, -k * m, 0.0, 2.0 * k**3 * m])  # phi and its derivatives at 0
    free = np.array([0.0, -k, -2.0 * k**2, -2.0 * k**3])

    def mismatch(x: np.ndarray) -> np.ndarray:
        K = 0.5 * np.array([cosh(x) + cos(x), sinh(x) + sin(x), cosh(x) - cos(x), sinh(x) - sin(x)])  # phi(x)
        K_shear = K[[1, 2, 3, 0]]  # phi'''(x)
        return (fixed @ K) * (free @ K_shear) - (fixed @ K_shear) * (free @ K)

    grid = np.geomspace(1e-9, 1.01 * CANTILEVER, 400)
    end = int(np.argmax(mismatch(grid) > 0.0))
    return float(brentq(mismatch, grid[end - 1], grid[end], rtol=1e-12))


def bending_modulus(material: Material, plane: str) -> float:
    """Modulus of stretching along the specimen, E1 or its plane-strain value."""
    return 1.0 / float(_compliance(material, plane)[0, 0])


def across_modulus(material: Material, plane: str) -> float:
    """Modulus of stretching across the specimen, E2 or its plane-strain value."""
    return 1.0 / float(_compliance(material, plane)[1, 1])


def poisson(material: Material, plane: str) -> float:
    """Contraction across the specimen over the stretch along it, nu12 or its plane-strain value."""
    a = _compliance(material, plane)
    return -float(a[0, 1] / a[0, 0])


def crack_modulus(material: Material, plane: str) -> float:
    """E' of G = K^2 / E' for a crack along axis 1 of an orthotropic solid (Sih, Paris, Irwin 1965)."""
    a = _compliance(material, plane)
    bracket = (a[1, 1] / a[0, 0]) ** 0.5 + (2.0 * a[0, 1] + a[2, 2]) / (2.0 * a[0, 0])
    return 1.0 / float((0.5 * a[0, 0] * a[1, 1]) ** 0.5 * bracket**0.5)


def element_length(scene: Scene, method: str) -> float:
    """Longest element along the bond, NaN for a method without a mesh, or where none can be made.

    A mesh that is made from the scene is made once; files may have changed.
    """
    return _longest.__wrapped__(scene, method) if scene.specimen.mesh else _longest(scene, method)


@lru_cache(maxsize=32)
def _longest(scene: Scene, method: str) -> float:
    try:
        if method in WITH_DOFS:
            from iga.sizes import element_length as longest

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


def _bodies(scene: Scene) -> tuple[tuple[Material, float], ...]:
    """Material and thickness of every body."""
    specimen = scene.specimen
    if specimen.kind == "peel":
        thickness = (specimen.strip_thickness, specimen.substrate_thickness)
    else:
        thickness = (specimen.arm_thickness, specimen.arm_thickness)
    return tuple(zip(scene.materials, thickness, strict=True))


def _bending(scene: Scene) -> tuple[tuple[Material, float], ...]:
    """The bodies that bend away from the interface; the substrate of a peel is clamped."""
    return _bodies(scene)[:1] if scene.specimen.kind == "peel" else _bodies(scene)


def _compliance(material: Material, plane: str) -> np.ndarray:
    """In-plane compliance (3, 3), Voigt order."""
    from iga.material import orthotropic

    return np.linalg.inv(orthotropic(**elastic_constants(material), plane=plane))


def _length_unit(scene: Scene) -> str:
    """The scene's label of lengths after a space, empty where it does not tell."""
    parts = [part.strip() for part in scene.units.split(",")]
    return f" {parts[1]}" if len(parts) == 3 else ""
