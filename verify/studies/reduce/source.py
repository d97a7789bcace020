"""Input of a reduction: rows and specimen, from a file with a scene or from the folder of a run."""

from __future__ import annotations

import tomllib
from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import radians
from pathlib import Path
from typing import Any

from verify.curves.read import Reading
from verify.curves.units import units_of
from verify.reduction.coupon import Coupon, coupon
from verify.reduction.data import Columns, Measured, of_steps, read_measured
from verify.reduction.scheme import Settings
from verify.reduction.schemes import LIKE_A_DCB, POWERS
from verify.runs.folder import read_result
from verify.scene.effects import simulated
from verify.scene.load import load_scene
from verify.scene.parse import parse_scene
from verify.scene.schema import Scene
from verify.support.checked_files import ANY, read_json
from verify.support.limited import read_at_most
from verify.support.refusal import Refusal

#: Linear part of a run, which has neither toe nor noise: it ends before the process zone changes the compliance.
OF_RUNS = (0.0, 0.2)
#: Parameters of the bond that a scene for a test may leave out, with the values set instead.
_SOME_BOND = ("interface.strength=1.0", "interface.toughness=1.0")
_SOME_SHEAR = ("interface.shear_strength=1.0", "interface.shear_toughness=1.0")


@dataclass(frozen=True)
class Given:
    """A test or a run. ``bonded``: whether the scene states a toughness with which the result can be compared."""

    measured: Measured
    scene: Scene
    coupon: Coupon
    bonded: bool

    def settings(self, asked: Settings, window: tuple[float, float] | None) -> Settings:
        """The settings; for a run without a toe, and with the correction for large openings if rotations are finite."""
        if self.coupon.kind not in LIKE_A_DCB and (asked.large or asked.block != (0.0, 0.0)):
            raise Refusal(f"--large, --block: must be left out for the kind {self.coupon.kind!r}: factors of a dcb")
        if self.coupon.kind not in POWERS and asked.calibration:
            raise Refusal(f"--calibration: must be left out for the kind {self.coupon.kind!r}, whose CC has none")
        if not self.measured.virtual:
            return asked if window is None else replace(asked, window=window)
        large = self.coupon.kind in LIKE_A_DCB and simulated(self.scene)["kinematics"] == "finite"
        return replace(asked, window=window or OF_RUNS, toe=False, large=asked.large or large)


def given(path: Path, scene: str | None, overrides: Sequence[str], columns: Columns, angle: float | None) -> Given:
    """The rows of a file or run, and its specimen; without ``scene`` the specimen of the run.

    ``angle`` is that of the load of a peel test in degrees, 90 where left out.

    Raises
    ------
    Refusal : no scene, or the reasons of `coupon` and `read_measured`.
    """
    run = path / "result.json"
    if scene is None and not run.exists():
        raise Refusal(f"--scene: must name the specimen of {path}, a packaged scene or a file, as it is no run")
    known, bonded = (scene_of_run(run, overrides), True) if scene is None else scene_of_test(scene, overrides)
    specimen = coupon(known)
    if angle is not None:
        if specimen.kind != "peel" or not 0.0 < angle <= 180.0:
            raise Refusal(f"--peel-angle: must be in (0, 180], of a peel, got {angle:g} of the kind {specimen.kind!r}")
        specimen = replace(specimen, angle=radians(angle))
    if (path / "evidence.csv").exists() and columns == Columns(Reading()):
        measured = of_steps(str(path), read_result(path).steps, specimen)
    else:
        reading = replace(columns.reading, units=units_of(known.units))
        measured = read_measured(path, replace(columns, reading=reading), specimen)
    return Given(measured, known, specimen, bonded)


def scene_of_run(run: Path, overrides: Sequence[str]) -> Scene:
    return parse_scene(read_json(run, {"scene": {ANY: object}})["scene"], overrides, str(run))


def scene_of_test(source: str, overrides: Sequence[str]) -> tuple[Scene, bool]:
    """A scene, in which bond and load may be missing, and whether its bond is given."""
    try:
        raw: dict[str, Any] = tomllib.loads(read_at_most(Path(source)).decode("utf-8-sig"))
    except (OSError, ValueError, RecursionError):  # a packaged scene, or a file that `load_scene` will refuse
        return load_scene(source, overrides), True
    bonded = "interface" in raw or any(one.partition("=")[0].partition(".")[0] == "interface" for one in overrides)
    specimen = raw.get("specimen")
    kind, length = (specimen.get(key) if isinstance(specimen, dict) else None for key in ("kind", "length"))
    missing = [] if bonded else [*_SOME_BOND, *([] if kind == "dcb" else _SOME_SHEAR)]
    if "load" not in raw and isinstance(length, int | float):
        missing.append(f"load.opening={1e-3 * length}")
    return load_scene(source, [*missing, *overrides]), bonded
