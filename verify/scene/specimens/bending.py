"""Two arms on their supports as beams: estimates for a specimen whose bond slides, before a run."""

from __future__ import annotations

from math import inf, sqrt
from typing import TYPE_CHECKING

import numpy as np

from verify.scene.materials import axial_modulus

if TYPE_CHECKING:
    from verify.scene.schema import Scene
    from verify.theory.bent_arms import BentArms

#: Number of crack lengths that are tried, and how much too stiff beams may be.
CRACK_LENGTHS, TOO_STIFF = 40, 1.15


def bent_arms(scene: Scene, way: float = 1.0) -> BentArms:
    """The arms of a scene as beams, its loads and supports as points; ``way`` is -1 for loads in the other way."""
    from verify.theory.bent_arms import BentArms, Force

    body, (h1, h2) = scene.specimen, scene.specimen.thicknesses
    E1, E2 = (axial_modulus(material, body.plane) for material in scene.materials)
    return BentArms(
        length=body.lengths[0],
        width=body.width,
        axial=(E1 * h1, E2 * h2),
        thickness=(h1, h2),
        loads=tuple(Force(load.body, body.middle(load), load.couple, way * load.share) for load in body.loads),
        supports=tuple(Force(held.body, body.middle(held), held.couple, 0.0) for held in body.supports),
    )


def furthest(scene: Scene) -> dict[float, float]:
    """Largest opening in each way that the programme takes, 1 that of the loads and -1 the other."""
    found = {way: max(way * opening for opening in scene.load.opening) for way in (1.0, -1.0)}
    return {way: far for way, far in found.items() if far > 0.0}


def mode_ratios(scene: Scene) -> tuple[float, ...]:
    """Mode ratio G_II / G of the energy that the precrack releases as it begins to grow, in each way of the programme
    in which it does; in all of them where it does not."""
    found: dict[bool, list[float]] = {}
    tip = scene.specimen.tip
    for way, far in furthest(scene).items():
        arms = bent_arms(scene, way)
        grows = first_opening(scene, arms, tip) <= TOO_STIFF * far
        found.setdefault(grows, []).append(arms.release(tip)[1])
    return tuple(found.get(True) or found[False])


def grown(scene: Scene) -> float:
    """Crack length at the end of a programme that may bend the arms both ways: the first one from the precrack on that
    releases less than the toughness at the largest opening of either way."""
    return max(_grown(scene, way, far) for way, far in furthest(scene).items())


def _grown(scene: Scene, way: float, far: float) -> float:
    arms, body = bent_arms(scene, way), scene.specimen
    for tip in _tips(scene):
        if first_opening(scene, arms, tip) > far:
            return tip - body.loaded_at
    return body.extent


def curve(scene: Scene) -> tuple[np.ndarray, np.ndarray]:
    """Openings and loads of brittle beams whose crack grows from the precrack on, up to the largest opening at least
    where the bond is long enough, from rest on."""
    arms, opening, found = bent_arms(scene), max(map(abs, scene.load.opening)), [(0.0, 0.0)]
    for tip in _tips(scene):
        d = first_opening(scene, arms, tip)
        if d == inf:
            break
        found.append((d, d / arms.compliance(tip)))
        if d > opening:
            break
    d_n, P_n = np.array(found).T
    return d_n, P_n


def first_opening(scene: Scene, arms: BentArms, tip: float) -> float:
    """Opening at which a crack of this tip grows, infinite where nothing bends there.

    The toughness is interpolated linearly between opening and sliding.
    """
    law, (release, B) = scene.interface, arms.release(tip)
    toughness = law.toughness + ((law.shear_toughness or 0.0) - law.toughness) * B
    return sqrt(toughness / release) if release > 0.0 else inf


def _tips(scene: Scene) -> np.ndarray:
    """`CRACK_LENGTHS` tips of a crack, from the precrack on."""
    body, far = scene.specimen, scene.specimen.lengths[0]
    return body.tip + (far - body.tip) * np.arange(CRACK_LENGTHS) / CRACK_LENGTHS


def rotation(scene: Scene) -> float:
    """Largest rotation of the arms over the programme, in radians, before the crack grows and at the end."""
    arms, body = bent_arms(scene), scene.specimen
    both = (arms.bent(body.place(s)) for s in {body.free_length, grown(scene)})
    return max(map(abs, scene.load.opening)) * max(abs(bent.rotation / bent.opening) for bent in both)
