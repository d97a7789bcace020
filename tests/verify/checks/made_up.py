"""Made-up runs that fulfil every identity, and the recorded one of the cohesive beam."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from recorded_runs import recorded

from tests.verify.checks.faults import having
from verify.checks.mechanics.columns import law_of
from verify.result import Result
from verify.scene.load import load_scene
from verify.scene.schema import Scene
from verify.scene.specimens.bending import bent_arms

#: Steps before the crack grows, and with them those after.
ELASTIC, STEPS = 20, 80
WHOLE, GROWS = slice(0, ELASTIC), slice(ELASTIC + 1, None)
#: Of its way to the far end that the crack has grown.
GROWN = 0.35

SLIDING: Mapping[str, tuple[str, ...]] = {
    "enf-as4peek": (),
    "4enf": (),
    "moments": ("specimen.moments=[1.0, 1.0]",),
    "enf-codeaster": (),
}


def beam() -> Result:
    """It satisfies all identities to rounding, and lacks reactions and moments, which are zero here."""
    result = recorded("beam")
    names = ("load_moment", "interface_moment", "reaction_x", "reaction_y")
    return having(result, **dict.fromkeys(names, np.zeros_like(result.load)))


def sliding() -> Mapping[str, tuple[Scene, Result]]:
    return {name: slid(name) for name in SLIDING}


def slid(name: str) -> tuple[Scene, Result]:
    """Two beams that are one behind the tip of a crack, which grows at the toughness of sliding, each step as long."""
    scene = load_scene(name, [*SLIDING[name], "published=[]"])
    body, arms, toughness = scene.specimen, bent_arms(scene), float(scene.interface.shear_toughness or 0.0)
    bond = body.extent - body.free_length
    a = body.free_length + GROWN * bond * np.maximum(np.arange(STEPS) - ELASTIC, 0) / (STEPS - ELASTIC)
    release, C = np.array([(arms.release(body.place(s))[0], arms.compliance(body.place(s))) for s in a]).T
    opening = np.sqrt(toughness / release) * np.minimum(np.arange(STEPS) / ELASTIC, 1.0)
    load, J, dissipated = opening / C, release * opening**2, toughness * body.width * (a - a[0])
    none, one = np.zeros(STEPS), np.ones(STEPS)
    columns = {
        "opening": opening,
        "load": load,
        "stored_energy": 0.5 * opening * load,
        "dissipated_energy": dissipated,
        "external_work": 0.5 * opening * load + dissipated,
        "newton_iterations": one,
        "mode_ratio": one,
        "friction_energy": none,
        **dict.fromkeys(("crack_length", "damage_front"), a),
        **dict.fromkeys(("J_loads", "J_bond", "J_shear"), J),
        **dict.fromkeys(("arm_force_x", "arm_force_y", "arm_moment"), none),
    }
    held = {"moments": (0.0, 2.0)}.get(name, (0.5, 0.5))  # by hand: half of the load each, or a couple against both
    columns |= {f"support_{i}": share * load for i, share in enumerate(held, 1)}
    end = f"load.opening={float(opening[-1])!r}"
    return load_scene(name, [*SLIDING[name], "published=[]", end]), Result("beam", columns)


def peel(scene: Scene, method: str = "nurbs") -> Result:
    """A strip that is peeled off as it should: J follows the law, then sin(theta) grows and the load falls."""
    n, body, law = 60, scene.specimen, law_of(scene)
    opening = np.linspace(0.0, 6.5, n)
    tip = np.where(opening < 3.5, law.g_open * (opening / 3.5) ** 2, opening - 3.4)
    area = law.area(tip)
    slope = 0.02 + 0.05 * opening / 6.5
    face = 0.2 * np.where(tip < law.g_open, area, 0.0)
    load = (area + face) / slope
    grown = np.maximum(opening - 3.6, 0.0) * 10.0
    dissipated = 0.95 * area + scene.interface.toughness * grown
    none, x = np.zeros(n), 150.0 - opening
    steps = {
        "opening": opening,
        "load": load,
        "crack_length": body.free_length + grown,
        "damage_front": body.free_length + grown + 4.3 * (opening > 3.5),
        "dissipated_energy": dissipated,
        "stored_energy": 0.5 * load * opening,
        "external_work": 0.5 * load * opening + dissipated,
        "newton_iterations": none + 4,
        "tip_opening": tip,
        "face_slope_top": slope,
        "face_energy": face,
        "interface_force": load,
        "load_moment": x * load,
        "interface_moment": -x * load,
        "clamp_moment": -x * load,
        "interface_pull": 0.003 * load,
        "anchor_pull": -0.003 * load,
        **dict.fromkeys(("end_opening", "face_slope_bottom", "reaction_x", "reaction_y"), none),
    }
    return Result(method, steps, dofs=3700, elements=700)
