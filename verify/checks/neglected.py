"""Effects that a run neglected, and how large they would have been: estimated from the results of the run.

An effect is neglected by the scene or by its setting ``auto``; the estimates cover both cases. Those that are made
before a run are in `verify.scene.effects`.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import degrees, nan

import numpy as np

from verify.checks import matched
from verify.checks.mechanics.columns import law_of
from verify.methods.method import Prepared
from verify.methods.solve import prepare
from verify.result import Result, Snapshot
from verify.scene.effects import GROWING, NEGLIGIBLE, STANDING, stiffer
from verify.scene.schema import Scene
from verify.theory.law import Law

#: Overlap of the faces, over g_max, above which they penetrate each other. Ahead of a growing crack the bond is
#: compressed by at most 0.6 g_max (measured; on an elastic foundation 0.2 of the gap at the tip).
OVERLAP = 1.0
#: Strength over the smallest traction that counts in a ratio; smaller ones are rounding.
LARGEST_RATIO = 1e12
#: Distance, over the thickness of an arm, within which control points of two meshes coincide.
SAME_CONTROL_POINT = 1e-6


@dataclass(frozen=True)
class Neglected:
    """One effect that a run neglected.

    ``value`` estimates its share of the load or of the energy in the bond; ``seen`` says in words what the estimate is
    based on.
    """

    key: str
    value: float
    negligible: bool
    seen: str

    @property
    def sentence(self) -> str:
        verdict = "negligible" if self.negligible else f"not negligible (limit {NEGLIGIBLE:.1%})"
        return f"{_NAMES[self.key]}: {self.seen}: {verdict}"


_NAMES = {
    "kinematics": "without finite kinematics",
    "contact": "without contact",
    "irreversible": "without irreversible damage",
    "symmetry": "with one arm in place of two",
    "search": "without a search for the other face",
}


def of_run(scene: Scene, result: Result) -> tuple[Neglected, ...]:
    """All neglected effects that the columns of the run allow to estimate."""
    return of_prepared(prepare(scene, result.method), result)


def of_prepared(prepared: Prepared, result: Result) -> tuple[Neglected, ...]:
    """All neglected effects that the columns of the run allow to estimate, for a prepared scene.

    Symmetry and search are left out for methods that always model one arm or fixed pairs of points; the report gives
    the error of fixed pairs (`verify.checks.matched`).
    """
    effects, own = prepared.effects, prepared.method.fixed(prepared.scene)
    rules = {
        _rotation: effects["kinematics"] == "linear",
        _overlap: not effects["contact"],
        _healing: not effects["irreversible"],
        _other_arm: effects["symmetry"] and "symmetry" not in own,
        _tilt: not effects["search"] and "search" not in own,
    }
    if prepared.method.is_limit or result.opening.size < 2:
        return ()
    found = (rule(prepared, result) for rule, without in rules.items() if without)
    return tuple(one for one in found if one is not None)


def warnings(prepared: Prepared, result: Result) -> tuple[str, ...]:
    """A sentence for every effect that should not have been neglected."""
    return tuple(one.sentence for one in of_prepared(prepared, result) if not one.negligible)


def remarks(scene: Scene, results: Mapping[str, Result]) -> tuple[str, ...]:
    """Warnings for many runs of a scene: one sentence per effect, with the run in which it is largest."""
    worst: dict[str, list[tuple[Neglected, str]]] = {}
    for name, result in results.items():
        for one in of_run(scene, result):
            if not one.negligible:
                worst.setdefault(one.key, []).append((one, name))
    return tuple(
        f"{', '.join(name for _, name in found)}: {max(found, key=lambda pair: pair[0].value)[0].sentence}"
        for found in worst.values()
    )


def summary(prepared: Prepared, result: Result) -> dict[str, dict[str, object]]:
    """The entry ``neglected`` of result.json."""
    return {
        one.key: {"value": one.value, "negligible": one.negligible, "sentence": one.sentence}
        for one in of_prepared(prepared, result)
    }


def _rotation(prepared: Prepared, result: Result) -> Neglected | None:
    """Change of the load by finite kinematics, from the largest rotation theta of the loaded faces by beam theory.

    16/35 theta^2 before the crack grows, 6/35 theta^2 while it grows (see `verify.scene.effects`).
    """
    steps = result.steps
    if "face_slope_top" not in steps:
        return None
    slopes = [np.abs(steps[name]) for name in ("face_slope_top", "face_slope_bottom") if name in steps]
    theta = np.max(slopes, axis=0)
    grown = steps["crack_length"] > steps["crack_length"][0]
    change = float(np.max(np.where(grown, GROWING, STANDING) * theta**2))
    turn = f"the loaded end turned by {degrees(np.max(theta)):.2g} degrees, which is worth {change:.2%} of the load"
    return Neglected("kinematics", change, change <= NEGLIGIBLE, turn)


def _overlap(prepared: Prepared, result: Result) -> Neglected | None:
    """Change of the load by contact in the compressed part of the bond.

    The smallest gap is searched for in the stored fields, at both ends of the bond at every step, and, where the
    programme unloads, on all the faces. The energy of the compressed bond is computed from the fields; contact would
    make every point of it stiffer by the factor penalty / secant.
    """
    scene, steps = prepared.scene, result.steps
    law = law_of(scene)
    gaps = [steps[name] for name in ("tip_opening", "end_opening") if name in steps]
    gaps += [snapshot.gap_q for snapshot in result.snapshots]
    if not gaps:
        return None
    overlap = max(0.0, -min(float(np.min(gap, initial=0.0)) for gap in gaps)) / law.g_peak
    ends = max(0.0, -min((float(np.min(steps[n])) for n in ("tip_opening", "end_opening") if n in steps), default=0.0))
    ends = max(ends, float(np.max(steps.get("penetration", 0.0), initial=0.0)))
    overlap = max(overlap, ends / law.g_peak)
    change = max((_load_of(snapshot, result, law, scene) for snapshot in result.snapshots), default=0.0)
    seen = f"faces overlapped by up to {overlap:.2g} g_max, which is worth {change:.2%} of the load"
    if ends / law.g_peak > OVERLAP:
        seen = f"faces ran into each other by {overlap:.2g} g_max where they were to close"
        return Neglected("contact", max(change, overlap), False, seen)
    return Neglected("contact", change, change <= NEGLIGIBLE, seen)


def _load_of(snapshot: Snapshot, result: Result, law: Law, scene: Scene) -> float:
    """Relative change of the load by contact in one snapshot."""
    closed_q = snapshot.gap_q < 0.0
    at = int(np.argmax(result.opening >= snapshot.opening))
    work = float(result.steps["external_work"][at])
    if not closed_q.any() or work <= 0.0:
        return 0.0
    g_q, p_q = np.where(closed_q, snapshot.gap_q, -1.0), np.where(closed_q, np.minimum(snapshot.traction_q, 0.0), 0.0)
    ratio_q = scene.interface.penalty * g_q / np.minimum(p_q, -law.strength / LARGEST_RATIO)
    change_q = p_q * g_q * stiffer(ratio_q)
    order = np.argsort(snapshot.s_q)
    return abs(0.5 * scene.specimen.width * float(np.trapezoid(change_q[order], snapshot.s_q[order]))) / work


def _healing(prepared: Prepared, result: Result) -> Neglected | None:
    """Share of the energy of the damaged bond that was recovered on unloading; with irreversible damage none is.

    Without a history variable nothing is dissipated: the work of the bond is the cohesive energy, which falls as the
    gaps close.
    """
    steps = result.steps
    if "cohesive_energy" not in steps or "damage_front" not in steps:
        return None
    damaged = np.maximum.accumulate(steps["damage_front"]) > prepared.scene.specimen.free_length
    absorbed = np.where(damaged, steps["cohesive_energy"], 0.0)
    most = np.maximum.accumulate(absorbed)
    back = float(np.max((most - absorbed) / np.where(most > 0.0, most, 1.0)))
    seen = f"{back:.2%} of the energy that the damaged bond had taken came back"
    return Neglected("irreversible", back, back <= NEGLIGIBLE, seen)


def _other_arm(prepared: Prepared, result: Result) -> Neglected | None:
    """Distance of the other arm's mesh from the mirror image of the modelled arm; the arms differ in nothing else."""
    specimen = prepared.scene.specimen
    if "iga" not in prepared.method.takes_files or len(specimen.mesh) != 2:
        return Neglected("symmetry", 0.0, True, "the arms are alike")
    from iga.mesh.mirror import upside_down
    from verify.methods.given_meshes import given_meshes

    upper, lower = given_meshes(prepared.scene)
    ours, theirs = (P_AI[np.lexsort(np.round(P_AI, 9).T)] for P_AI in (upper.P_AI, upside_down(lower).P_AI))
    apart = float(np.max(np.abs(ours - theirs))) if ours.shape == theirs.shape else nan
    same = apart <= SAME_CONTROL_POINT * specimen.loaded_thickness
    seen = "the meshes of the arms mirror each other" if same else "the lower arm has another mesh, which was left out"
    return Neglected("symmetry", apart / specimen.loaded_thickness, same, seen)


def _tilt(prepared: Prepared, result: Result) -> Neglected | None:
    """Error of gaps and tractions along the undeformed normal, against the surface half way between the faces."""
    effects, specimen = prepared.effects, prepared.scene.specimen
    snapshots = tuple(snapshot for snapshot in result.snapshots if snapshot.X_euvi.size)  # a beam has no faces
    if effects["symmetry"] or effects["kinematics"] == "linear" or not snapshots:
        return None
    found = matched.left_out(snapshots, law_of(prepared.scene), specimen.place(0.0), specimen.width, between=True)
    tilt = f"{degrees(found.tilt):.2g} degrees"
    seen = f"half way between the faces the bond tilts by up to {tilt}, worth {found.bound:.2%} of G_Ic or of the load"
    return Neglected("search", found.bound, found.valid, seen)
