"""Checks of a single run: identities of mechanics, computed from the columns that the run wrote.

Unless its docstring says otherwise, the value of a check is the largest relative deviation over the steps. A check is
left out where a method lacks its columns.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from verify.checks.mechanics import balance, dissipation, j_integral, mixed, peel_growth, penetration, secant  # noqa: F401
from verify.checks.mechanics import unresolved as resolution
from verify.checks.mechanics.columns import worst
from verify.checks.mechanics.identity import IDENTITIES
from verify.methods.method import Prepared
from verify.methods.solve import prepare
from verify.result import Result
from verify.scene.schema import Scene
from verify.verdict import Check, Checks


def run_checks(scene: Scene, result: Result, subject: str = "") -> Checks:
    """The checks of one run that its columns allow; ``subject`` as in `checks_of`."""
    return checks_of(prepare(scene, result.method), result, subject)


def checks_of(prepared: Prepared, result: Result, subject: str = "") -> Checks:
    """The checks of one run that its columns allow; of a run without a step only whether it is completed.

    Parameters
    ----------
    subject : name of the run in the report; default: the method
    """
    scene, checks = prepared.method.modelled(prepared.scene), []
    if scene is not prepared.scene:
        prepared = replace(prepared, scene=scene)
    without_step = result.opening.size < 2  # the first row is the unloaded specimen
    for name, one in IDENTITIES.items():
        if without_step and name != "completed":
            continue
        more = (lambda: prepared.element,) if one.element else ()
        value = 0.0 if result.separated and name == "completed" else one.value(scene, result.steps, *more)
        if value is None or (one.of_face and scene.load.at != "face"):
            continue
        tolerance = one.tolerance if isinstance(one.tolerance, float) else one.tolerance(prepared, result)
        meaning = one.meaning if isinstance(one.meaning, str) else one.meaning(scene)
        check = Check(name, subject or result.method, value, tolerance, one.kind, meaning)
        checks.append(replace(check, unresolved=_cannot_judge(prepared, result, check)))
    return Checks(checks)


def _cannot_judge(prepared: Prepared, result: Result, check: Check) -> str:
    """Why a check above its tolerance gives no verdict; empty where it gives one."""
    if not abs(check.value) > check.tolerance:
        return ""
    if not IDENTITIES[check.name].of_zone:
        return penetration.long_elements(prepared, result, check)
    return resolution.too_coarse(prepared, result, check) or end_cannot_judge(prepared, result, check)


def end_cannot_judge(prepared: Prepared, result: Result, check: Check) -> str:
    """Why the J-integral gives no verdict: the far end carries load from the start and explains the deviation, or all
    of it but what a coarse mesh leaves.
    """
    scene = prepared.scene
    gap = j_integral.j_gap(scene, result.steps) if check.name == "j-integral" else None
    if gap is None or not j_integral.far_end_loaded(scene, result.steps):
        return ""
    held = j_integral.far_end_energy(scene, result.steps)
    beyond = worst(j_integral.beyond_far_end(np.abs(gap), held))
    if beyond <= check.tolerance:
        return resolution.far_end_unresolved(prepared, float(np.nanmax(held)))
    return resolution.too_coarse(prepared, result, replace(check, value=beyond))


#: Checks whose deviation depends on how well the mesh resolves the process zone.
OF_THE_ZONE = tuple(name for name, one in IDENTITIES.items() if one.of_zone)
