"""The bond of a scene in the plain numbers that all codes receive."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from verify.scene.schema import Scene
from verify.theory.bond import Bond

#: Keys of the bond that are taken as they are, and those of them that a bond which opens alone has.
OF_OPENING = "law penalty plateau knee knee_traction decay table".split()
OF_BOTH_MODES = [*OF_OPENING, *"criterion exponent onset friction rubs viscosity pressure_strength".split()]


def bond_of(scene: Scene, effects: Mapping[str, Any]) -> Bond:
    """The bond with its effects; that of ``shear`` decides whether it slides, and asks for the keys of shear."""
    i, modes = scene.interface, 2 if effects["shear"] else 1
    pairs = {
        "strength": (i.strength, i.shear_strength),
        "toughness": (i.toughness, i.shear_toughness),
        "stiffness": (i.bond_stiffness, i.shear_stiffness),
    }
    numbers: dict[str, Any] = {key: getattr(i, key) for key in (OF_OPENING if modes == 1 else OF_BOTH_MODES)}
    numbers |= {key: pair[:modes] for key, pair in pairs.items()}
    return Bond(**numbers, contact=effects["contact"], irreversible=effects["irreversible"])
