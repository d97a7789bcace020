"""Two arms on their supports as beams: estimates for a specimen whose bond slides, before a run."""

from __future__ import annotations

from typing import TYPE_CHECKING

from verify.scene.materials import axial_modulus
from verify.scene.specimens.delamination import Load, Support

if TYPE_CHECKING:
    from verify.scene.schema import Scene
    from verify.theory.bent_arms import BentArms, Force

#: Number of crack lengths that are tried.
CRACK_LENGTHS = 40


def bent_arms(scene: Scene) -> BentArms:
    """The arms of a scene as beams, its loads and supports as points."""
    from verify.theory.bent_arms import BentArms

    body, (h1, h2) = scene.specimen, scene.specimen.thicknesses
    E1, E2 = (axial_modulus(material, body.plane) for material in scene.materials)
    return BentArms(
        length=body.lengths[0],
        width=body.width,
        axial=(E1 * h1, E2 * h2),
        thickness=(h1, h2),
        loads=tuple(_force(load, body.lengths[0], load.share) for load in body.loads),
        supports=tuple(_force(support, body.lengths[0], 0.0) for support in body.supports),
    )


def _force(patch: Load | Support, length: float, size: float) -> Force:
    from verify.theory.bent_arms import Force

    end = 0.0 if patch.side == "left" else length
    X = end if patch.extent is None else sum(patch.extent) / 2
    return Force(patch.body, X, patch.couple, size)


def mode_ratio(scene: Scene) -> float:
    """Mode ratio G_II / G of the energy that the precrack releases as it begins to grow."""
    return bent_arms(scene).release(scene.specimen.tip)[1]


def grown(scene: Scene) -> float:
    """Crack length at the largest opening: the first one from the precrack on that releases less than the toughness.

    The toughness is interpolated linearly between opening and sliding.
    """
    arms, body, law = bent_arms(scene), scene.specimen, scene.interface
    opening, far = max(map(abs, scene.load.opening)), body.lengths[0]
    for i in range(CRACK_LENGTHS):
        tip = body.tip + (far - body.tip) * i / CRACK_LENGTHS
        release, B = arms.release(tip)
        if release * opening**2 < law.toughness + ((law.shear_toughness or 0.0) - law.toughness) * B:
            return tip - body.loaded_at
    return body.extent


def rotation(scene: Scene) -> float:
    """Largest rotation of the arms over the programme, in radians, before the crack grows and at the end."""
    arms, body = bent_arms(scene), scene.specimen
    both = (arms.bent(body.place(s)) for s in {body.free_length, grown(scene)})
    return max(map(abs, scene.load.opening)) * max(abs(bent.rotation / bent.opening) for bent in both)
