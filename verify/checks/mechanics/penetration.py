"""How deep pressed faces are in each other, over what their pressure explains."""

from __future__ import annotations

import numpy as np

from verify.checks.mechanics.columns import Steps, far_from_end, scale, zone_is_free
from verify.checks.mechanics.identity import identity
from verify.methods import zone_resolution
from verify.methods.method import Prepared
from verify.result import Result
from verify.scene.effects import simulated
from verify.scene.materials import axial_modulus, elastic_constants
from verify.scene.schema import Scene
from verify.verdict import Check

NO_DEPTH = 1e-6  # penetration, over the thickness of an arm, that counts as zero
#: Interpolation of a function w by polynomials of degree 1, 2 and 3 on a length l misses at most ``max |w^(4)| l^4``
#: over the first, where w^(2) and w^(3) are at most w^(4) l^2 and w^(4) l, and at most the range of w^(2) times l^2
#: over the second (Peano; of degree 3 with slopes, Hermite).
INTERPOLATED = {1: (8.0, 16.0), 2: (72.0 * np.sqrt(3.0), 32.0), 3: (384.0, 32.0)}
#: Largest factor on the number of elements that is named; without pressure no number of them would do.
MOST_FINER = 32.0
#: Shear factor of a beam of rectangular section.
SHEAR_OF_ARM = 5.0 / 6.0


@identity(
    "penetration",
    0.5,
    "Faces penetrate each other no deeper than the penalty explains.",
    "penetration",
    "contact_pressure",
)
def penetration(scene: Scene, steps: Steps) -> np.ndarray | None:
    """Penetration of the faces over the one expected under their contact pressure, less 1.

    The pressure is known at the integration points, and may be half as large again between them. None without contact,
    or where the programme never unloads.
    """
    if not simulated(scene)["contact"]:
        return None
    deeper = np.where(_deep(scene, steps), steps["penetration"] / scale(_expected(scene, steps)) - 1.0, 0.0)
    return np.maximum(deeper, 0.0)


def _expected(scene: Scene, steps: Steps) -> np.ndarray:
    """The pressure over the penalty plus the pressure over the stiffness of an arm through its thickness (n_steps,):
    between the integration points a surface bulges by a part of the latter."""
    across = elastic_constants(scene.materials[0])["E2"]
    given: np.ndarray = steps["contact_pressure"] * (1.0 / scene.interface.penalty + _thickness(scene) / across)
    return given


def _deep(scene: Scene, steps: Steps) -> np.ndarray:
    """Steps (n_steps,) that count: faces that penetrate each other, of a specimen that does not rotate about its far
    end (see `far_from_end`). Where the damaged bond comes near that end an open specimen rotates too, under nearly no
    load."""
    rotates = ~far_from_end(scene, steps) | (steps["opening"] > 0.0) & ~zone_is_free(scene, steps)
    return (steps["penetration"] > NO_DEPTH * _thickness(scene)) & ~rotates


def _thickness(scene: Scene) -> float:
    return float(scene.specimen.loaded_thickness)


def long_elements(prepared: Prepared, result: Result, check: Check) -> str:
    """Why penetration gives no verdict: elements longer than the faces need; empty where they do not explain it.

    Beside a process zone an open bond pulls with its strength s and a pressed one pushes back with the pressure p. An
    arm bends by ``w^(4) = q / (E h^3 / 12)`` at most, q = s + p, and its shear changes w^(2) by ``q / (5/6 G h)``.
    Shear t along the face is a couple t h / 2 per length, which counts as q where it changes: by the shear strength
    over an element at most. Elements of length l follow both up to their error of interpolation (`INTERPOLATED`). On
    meshes with elements of 1.2 to 7 thicknesses 0.1 to 0.9 of their sum was measured.
    """
    scene, steps = prepared.scene, result.steps
    if check.name != "penetration" or prepared.mesh is None:
        return ""
    along = scene.discretization.degree if prepared.method.with_dofs else prepared.mesh.degree
    fourth, second = INTERPOLATED[min(along, max(INTERPOLATED))]
    law, plane, expected = scene.interface, scene.specimen.plane, _expected(scene, steps)
    shear_strength = law.shear_strength if scene.specimen.slides and law.shear_strength else 0.0

    def bulge(length: float) -> np.ndarray:
        """Depth (n_steps,) that elements of a length explain."""
        depth = np.zeros_like(expected)
        for material, h in zip(scene.materials, scene.specimen.thicknesses, strict=True):
            bending = axial_modulus(material, plane) * h**3 / 12.0
            shear = SHEAR_OF_ARM * elastic_constants(material)["G12"] * h
            load = law.strength + steps["contact_pressure"] + 0.5 * h * shear_strength / length
            depth += (length**4 / fourth / bending + length**2 / second / shear) * load
        return depth

    explained = (1.0 + check.tolerance) * expected + bulge(prepared.element)
    deep = _deep(scene, steps)
    if not np.all(steps["penetration"][deep] <= explained[deep]):
        return ""
    at = int(np.argmax(np.where(deep, steps["penetration"] / scale(expected), 0.0)))
    finer = 1.0
    while finer < MOST_FINER and bulge(prepared.element / finer)[at] > 0.5 * check.tolerance * expected[at]:
        finer *= 1.1
    said = zone_resolution.remedy(prepared, prepared.zone.elements * finer)
    return f"faces bulge into each other between the ends of elements of length {prepared.element:.2g}; {said}"
