"""Cases of invariance: units, position and orientation, rounding."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from typing import Any

import numpy as np

from verify.scene.keys import keys, keys_of
from verify.scene.load import load_scene
from verify.scene.materials import Orthotropic
from verify.scene.parse import parse_scene
from verify.scene.schema import Scene
from verify.studies.hard.case import Case, Finding, Trials, equal_curves, judged_by, runs
from verify.studies.hard.criteria import difference
from verify.verdict import Check

_MESH = "discretization.dofs=280"

#: Exponents of force and length of the dimensions that keys of a scene have.
_FORCE_AND_LENGTH = {"stress": (1, -2), "length": (0, 1), "energy per area": (1, -1), "stress per length": (1, -3)}

#: Sizes of a newton and a millimetre in other units, and their label.
_UNITS = {
    "n-mm": (1.0, 1.0, "N, mm, MPa"),
    "n-m": (1.0, 1e-3, "N, m, Pa"),
    "kn-in": (1e-3, 1.0 / 25.4, "kN, in, kN/in2"),
}


def every_number(scene: Scene, change: Callable[[str, float], float]) -> Scene:
    """The scene with every floating-point number replaced by ``change(key, value)``; integers stay."""

    def walk(key: str, value: Any) -> Any:
        if isinstance(value, Mapping):
            return {inner: walk(inner, part) for inner, part in value.items()}
        if key == "uncertainty":  # relative uncertainties, under the keys of other numbers
            return value
        if key == "table":  # of openings and tractions
            return [[change("opening", opening), change("strength", traction)] for opening, traction in value]
        if isinstance(value, list | tuple):
            return [walk(key, part) for part in value]
        return change(key, value) if isinstance(value, float) else value

    return parse_scene({key: part for key, part in walk("", scene.model_dump()).items() if part is not None})


def in_units(scene: Scene, force: float, length: float, label: str) -> Scene:
    """The scene in units in which a newton is ``force`` and a millimetre ``length``."""
    known = (*keys(scene.specimen.kind), *keys_of("material", Orthotropic))
    dimensions = {key.name: key.dimension for key in known}

    def convert(key: str, value: float) -> float:
        forces, lengths = _FORCE_AND_LENGTH.get(dimensions.get(key, ""), (0, 0))
        return value * force**forces * length**lengths

    return every_number(scene, convert).model_copy(update={"units": label})


def _units() -> dict[str, Scene]:
    scene = load_scene("dcb-czm1", [_MESH])
    return {name: in_units(scene, *sizes) for name, sizes in _UNITS.items()}


@judged_by("units", "The same scene in N and mm, N and m, kN and inches.", _units)
def units(trials: Trials) -> Iterator[Finding]:
    for name, (force, length, _) in list(_UNITS.items())[1:]:
        away = difference(trials[name].result, trials["n-mm"].result, 1.0 / length, 1.0 / force)
        yield Check("same-curve", name, away, 1e-9, "exact", "The curve does not depend on the units.")


_TURNED, _MIRRORED, _MOVED = "pose.angle=37.0", "pose.mirror=true", "pose.shift=[1e4, 1e4]"
_POSES = {"plain": (), "rotated": (_TURNED,), "mirrored": (_MIRRORED,), "moved": (_MOVED,)}

pose = Case(
    "pose",
    "The specimen is rotated by 37 degrees, mirrored, moved by 1e4 mm.",
    runs("dcb-czm1", _POSES | {"all": (_TURNED, _MIRRORED, _MOVED)}, _MESH),
    equal_curves("plain", difference, 1e-8, "exact", "The curve does not depend on the pose."),
)

#: Number of runs with random relative changes of all numbers, and the size of these changes.
NOISES, NOISE = 20, 1e-14


def _noises() -> dict[str, Scene]:
    scene = load_scene("dcb-czm1", [_MESH])

    def noisy(seed: int) -> Scene:
        rng = np.random.default_rng(seed)
        return every_number(scene, lambda key, value: value * (1.0 + NOISE * rng.uniform(-1.0, 1.0)))

    return {"plain": scene} | {f"noise-{seed}": noisy(seed) for seed in range(1, NOISES + 1)}


noise = Case(
    "noise",
    "Every number of the scene is off by 1e-14 of itself, twenty times.",
    _noises,
    equal_curves("plain", difference, 1e-8, "exact", "The algorithm does not amplify rounding."),
)
