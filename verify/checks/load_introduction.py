"""Effect of a point load at the corner of the end face, compared with a load that is spread evenly over the face.

A point load adds a local compliance, and its point of attack moves towards the crack as the end rotates. Both are
negligible on slender arms; on stocky arms they exceed the distance that two codes may have.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from math import isnan, nan, sqrt

from verify.checks.proof import SEARCHING
from verify.curves.of_run import peak_load
from verify.scene.effects import NEGLIGIBLE, opening_share, simulated
from verify.scene.materials import axial_modulus, elastic_constants
from verify.scene.schema import Scene

#: Mesh of the two runs that measure the effect on stocky arms; with 1956 unknowns and 60 steps the results for a0/h = 4
#: and 7 change by 0.1 %.
COARSE_MESH = {"dofs": 1000, "steps": 40}
#: Rotation of the end, in radians, above which the bending of the arm does not determine the lever.
LARGEST_ROTATION = 0.6


@dataclass(frozen=True)
class Corner:
    """Change of initial stiffness and peak load by a load at the corner, relative to a load spread over the face."""

    stiffness: float
    peak: float


def estimate(scene: Scene) -> Corner:
    """The change by beam theory, within a factor of about 2.

    Stiffness: the local displacement of the corner is of the size ``P / sqrt(E2 G12)`` per width, the deflection of the
    arm is ``4 P (a/h)^3 / E1``. For a/h = 4.2, 7 and 20 the measured stiffness was 0.9, 1.4 and 0.005 % lower; the
    estimates are 0.5, 1.4 and 0.005 %.

    Peak load: at the load at which a sharp crack grows, ``P a = sqrt(c G w E I)`` with c = 1 for a DCB and 2 for a
    strip, the end rotates by ``theta = P a^2 / (2 E I)``, which shortens the lever of the corner by ``theta h / 2``: by
    2.8 % for a/h = 4.2, where the measured peak was 3.8 % higher. With linear kinematics there is no such change. A
    strip with a large rotation is under tension and not in bending; its peak is NaN.
    """
    specimen, constants = scene.specimen, elastic_constants(scene.materials[0])
    h, a = specimen.loaded_thickness, max(specimen.free_length, specimen.loaded_thickness)
    modulus = axial_modulus(scene.materials[0], specimen.plane)
    local = 0.25 * (h / a) ** 3 * modulus / sqrt(constants["E2"] * constants["G12"])
    share = opening_share(scene)
    theta = 0.5 * a * sqrt(2.0 * share * scene.interface.toughness / (modulus * h**3 / 12.0))
    lever = 0.5 * theta * h / a if theta < LARGEST_ROTATION else nan
    return Corner(-local, lever if simulated(scene)["kinematics"] == "finite" else 0.0)


def measured(scene: Scene) -> Corner:
    """The change by two runs on a coarse NURBS mesh up to the largest opening; the estimate where one of them stops."""
    from verify.methods.solve import solve

    end = max(scene.load.opening)
    mesh = scene.discretization.model_copy(update=COARSE_MESH)
    face, node = (
        solve(_at(scene.model_copy(update={"discretization": mesh}), at, end), SEARCHING) for at in ("face", "node")
    )
    if not (face.complete and node.complete):
        return estimate(scene)
    slopes = [float(run.steps["load_slope"][0]) for run in (face, node)]
    return Corner(slopes[1] / slopes[0] - 1.0, peak_load(node) / peak_load(face) - 1.0)


def matters(scene: Scene) -> bool:
    """Whether the estimate exceeds the distance that two codes may have."""
    found = estimate(scene)
    return abs(found.stiffness) > NEGLIGIBLE or abs(found.peak) > NEGLIGIBLE


def sentence(scene: Scene) -> str:
    """A warning for codes with a point load that are compared with this scene; empty where the scene has one itself."""
    if scene.load.at != "face" or scene.specimen.supports:
        return ""
    solved = matters(scene) and not scene.specimen.clamped and max(scene.load.opening) > 0.0
    found = _measured(scene.model_dump_json()) if solved else estimate(scene)
    return (
        "the load is spread evenly over the end face, and the opening is its mean: a code that pulls the corner away "
        f'from the bond, as load.at = "node" does, changes the stiffness by {_percent(found.stiffness)} and the peak '
        f"load by {_percent(found.peak)} ({'two runs of this scene' if solved else 'an estimate'})"
    )


def remarks(scene: Scene) -> tuple[str, ...]:
    """The sentence in the report; empty where the effect is negligible."""
    of_faces = scene.load.at == "face" and not scene.specimen.supports
    return (sentence(scene),) if of_faces and matters(scene) else ()


@lru_cache(maxsize=8)
def _measured(scene: str) -> Corner:
    return measured(Scene.model_validate_json(scene))


def _percent(value: float) -> str:
    if isnan(value):
        return "what is not known"
    return f"{100 * value:+.2f} %" if abs(value) >= 5e-5 else "less than 0.01 %"


def _at(scene: Scene, at: str, end: float) -> Scene:
    return scene.model_copy(update={"load": scene.load.model_copy(update={"at": at, "opening": (end,)})})
