"""What it changes to pull at the corner of an end face in place of the whole: the number for a scene, and in words.

A code that pulls a corner node gives way there locally, and its load comes closer to the crack as the end turns. Both
are as nothing on slender arms; on stocky ones they are worth more than two codes may differ by.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from math import isnan, nan, sqrt

from verify.checks.proof import SEARCHING
from verify.curves.curve import peak
from verify.result import Result
from verify.scene.effects import NEGLIGIBLE, opening_share, simulated
from verify.scene.materials import axial_modulus, elastic_constants
from verify.scene.schema import Scene

#: Unknowns and steps of the two runs that tell it of stocky arms. With 1956 and 60 the numbers of a0/h = 4 and 7 change
#: by 0.1 %.
DOFS, STEPS = 1000, 40
#: Turn of the end, in radians, beyond which it is not told by the bending of the arm.
FAR = 0.6


@dataclass(frozen=True)
class Corner:
    """What a load at the corner changes: initial stiffness and peak load, relative to a load spread over the face."""

    stiffness: float
    peak: float


def estimate(scene: Scene) -> Corner:
    """By beam theory, within a factor of about 2.

    The corner gives way by the size of ``P / sqrt(E2 G12)`` per width, where the arm bends by ``4 P (a/h)^3 / E1``: for
    a/h = 4.2, 7 and 20 the stiffness was measured 0.9, 1.4 and 0.005 % less, and is 0.5, 1.4 and 0.005 % here. At the
    load at which a sharp crack grows, ``P a = sqrt(c G w E I)`` with c = 1 of a dcb and 2 of a strip, the end turns by
    ``theta = P a^2 / (2 E I)``, and the lever of the corner is shorter by ``theta h / 2``: by 2.8 % for a/h = 4.2,
    where the peak was measured 3.8 % higher. Linear kinematics does not have this. A strip that turns far is pulled and
    not bent, and its peak is NaN.
    """
    specimen, constants = scene.specimen, elastic_constants(scene.materials[0])
    h, a = specimen.loaded_thickness, max(specimen.free_length, specimen.loaded_thickness)
    modulus = axial_modulus(scene.materials[0], specimen.plane)
    local = 0.25 * (h / a) ** 3 * modulus / sqrt(constants["E2"] * constants["G12"])
    share = opening_share(scene)
    theta = 0.5 * a * sqrt(2.0 * share * scene.interface.toughness / (modulus * h**3 / 12.0))
    lever = 0.5 * theta * h / a if theta < FAR else nan
    return Corner(-local, lever if simulated(scene)["kinematics"] == "finite" else 0.0)


def measured(scene: Scene) -> Corner:
    """By two runs of a coarse NURBS mesh up to the largest opening; the estimate where they do not come so far."""
    from verify.methods.solve import solve

    end = max(scene.load.opening)
    mesh = scene.discretization.model_copy(update={"dofs": DOFS, "steps": STEPS})
    face, node = (
        solve(_at(scene.model_copy(update={"discretization": mesh}), at, end), SEARCHING) for at in ("face", "node")
    )
    if not (face.complete and node.complete):
        return estimate(scene)
    slopes = [float(run.steps["load_slope"][0]) for run in (face, node)]
    return Corner(slopes[1] / slopes[0] - 1.0, _peak(node) / _peak(face) - 1.0)


def _peak(run: Result) -> float:
    return peak((run.opening, run.load), run.steps["load_slope"])[1]


def matters(scene: Scene) -> bool:
    """Whether the estimate is more than two codes may differ by."""
    found = estimate(scene)
    return abs(found.stiffness) > NEGLIGIBLE or abs(found.peak) > NEGLIGIBLE


def sentence(scene: Scene) -> str:
    """What to know of the load before a code is compared with this scene; empty where the scene's is a point load."""
    if scene.load.at != "face":
        return ""
    solved = matters(scene) and not scene.specimen.clamped and max(scene.load.opening) > 0.0
    found = _measured(scene.model_dump_json()) if solved else estimate(scene)
    return (
        "the load is spread evenly over the end face, and the opening is its mean: a code that pulls the corner away "
        f'from the bond, as load.at = "node" does, changes the stiffness by {_percent(found.stiffness)} and the peak '
        f"load by {_percent(found.peak)} ({'two runs of this scene' if solved else 'an estimate'})"
    )


def remarks(scene: Scene) -> tuple[str, ...]:
    """What the report says of it: nothing where it does not matter."""
    return (sentence(scene),) if scene.load.at == "face" and matters(scene) else ()


@lru_cache(maxsize=8)
def _measured(scene: str) -> Corner:
    return measured(Scene.model_validate_json(scene))


def _percent(value: float) -> str:
    if isnan(value):
        return "what is not known"
    return f"{100 * value:+.2f} %" if abs(value) >= 5e-5 else "less than 0.01 %"


def _at(scene: Scene, at: str, end: float) -> Scene:
    return scene.model_copy(update={"load": scene.load.model_copy(update={"at": at, "opening": (end,)})})
