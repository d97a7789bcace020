"""Identities of a specimen whose bond slides: J of loads and bond, supports, balance of an arm, closed forms.

A formula is None where it does not apply to the specimen.
"""

from __future__ import annotations

from collections.abc import Callable
from math import sqrt

import numpy as np

from verify.checks.mechanics.balance import moment_tolerance
from verify.checks.mechanics.columns import AWAY, Steps, has, peak, scale, size, zone_is_free
from verify.checks.mechanics.identity import identity
from verify.methods.method import Prepared
from verify.result import Result
from verify.scene.bond.mixed import mixed_bond
from verify.scene.effects import simulated
from verify.scene.materials import elastic_constants
from verify.scene.process_zone import zone_length
from verify.scene.schema import Scene
from verify.scene.specimens.bending import bent_arms
from verify.scene.specimens.delamination import Load, Support
from verify.scene.specimens.on_rollers import FourPointEnf
from verify.scene.specimens.two_arms import Moments
from verify.theory.arms.interface import extra_lengths
from verify.theory.arms.problem import Arm

#: Tolerance of J of the loads against J of the bond.
BALANCE_OF_J, BALANCE_OF_J_ENF = 0.005, 0.002
#: Tolerance of the part of sliding in J, twice that of J.
OF_THE_MODE = 0.01
#: Mode ratio, or distance from 1, up to which a mode is pure.
PURE = 1e-3
#: Growth of a crack, in lengths of its process zone, from which on its cost per length can be measured.
ZONES_GROWN = 4.0
#: J, over the largest, that is rounding, where the loads pass through zero.
ROUNDED_J = 1e-12


#: Columns of a run whose bond slides.
J_COLUMNS = ("J_loads", "J_bond", "J_shear")


def _part(counted: np.ndarray, above: np.ndarray, below: np.ndarray | float) -> np.ndarray | None:
    """A quotient at the steps that count; None without any."""
    return above[counted] / np.broadcast_to(below, above.shape)[counted] if counted.any() else None


def j_tolerance(prepared: Prepared, result: Result) -> float:
    """0.2 % for an end-notched flexure, else 0.5 %; at least the discretisation error of the method."""
    of_kind = BALANCE_OF_J_ENF if prepared.scene.specimen.kind == "enf" else BALANCE_OF_J
    return max(of_kind, prepared.method.mesh_error)


@identity(
    "j-loads",
    j_tolerance,
    "The J-integral of loads and supports is that of the bond.",
    *J_COLUMNS,
    slides=True,
    of_zone=True,
)
def j_loads(scene: Scene, steps: Steps) -> np.ndarray | None:
    """J_loads - J_bond over the largest J.

    J of a closed path around the specimen, on which dead tractions act, equals J of the path along the bond (Rice
    1968), for every law, history and length of the zone. ``w J_loads = sum of F mean(du/dX)`` over loads and supports,
    with the strain energy of the end faces; ``J_bond = - integral of p dg/dX + t ds/dX``.

    Steps do not count at which the damaged bond is near the far end: there the arms touch on a spot smaller than an
    element.
    """
    counted = zone_is_free(scene, steps) & (steps["J_loads"] != 0.0)
    return _part(counted, steps["J_loads"] - steps["J_bond"], peak(steps["J_loads"][counted]))


@identity("supports", moment_tolerance, "Each support carries what statics gives it.")
def support_gap(scene: Scene, steps: Steps) -> np.ndarray | None:
    """Difference of a reaction from that of statics, over the size of the loads; couples are divided by the
    length.

    With finite kinematics the points of action move, and only the sum of the forces is known.
    """
    body = scene.specimen
    names = [f"support_{i}" for i in range(1, len(body.supports) + 1)]
    if not names or not has(steps, *names):
        return None
    found_rn, P = np.array([steps[name] for name in names]), steps["load"]
    most, length = size(body) * peak(P), body.lengths[0]
    couple_r = np.array([support.couple for support in body.supports])
    if simulated(scene)["kinematics"] == "finite":
        carried = sum(load.share for load in body.loads if not load.couple)
        return (found_rn[~couple_r].sum(0) + carried * P) / scale(most)
    acts_2r = np.array([_acts(support, length) for support in body.supports]).T
    if acts_2r.shape != (2, 2) or np.linalg.cond(acts_2r / np.max(acts_2r, axis=0)) > 1e9:
        return None
    loads_2 = sum(load.share * np.array(_acts(load, length)) for load in body.loads)
    expected_r = -np.linalg.solve(acts_2r, loads_2)
    per_r = np.where(couple_r, length, 1.0)
    return (found_rn - np.outer(expected_r, P)) / per_r[:, None] / scale(most)


@identity(
    "arm-balance",
    moment_tolerance,
    "Forces and moments on the upper arm add up to nothing.",
    "arm_force_x",
    "arm_force_y",
    "arm_moment",
)
def arm_gap(scene: Scene, steps: Steps) -> np.ndarray:
    """Resultant of the forces on the upper arm over the size of the loads, or of the moments over that size
    times the length."""
    most = scale(size(scene.specimen) * peak(steps["load"]))
    force = np.hypot(steps["arm_force_x"], steps["arm_force_y"])
    return np.stack((force, steps["arm_moment"] / scene.specimen.lengths[0])) / most


def mode_tolerance(prepared: Prepared, result: Result) -> float:
    """Of the part of sliding in J: 0.01, twice that of J, and of a slb what its arms and its zone take from the closed
    form.

    Shear and the rotation at the tip lengthen the effective crack, by chi h for opening and by 0.42 chi h for sliding
    (ASTM D6671). With the effective lengths a_I and a_II the ratio is ``s / (s + o)``, ``s = 9 a_II^2``, ``o = 12
    a_I^2``: 3/7 if they are equal. A zone of length z lengthens the crack by up to z in either mode: the ratio changes
    by up to z / 2 a. It counts as long as it is, and up to twice its estimate.
    """
    body, c = prepared.scene.specimen, elastic_constants(prepared.scene.materials[0])
    if body.kind != "slb":
        return OF_THE_MODE
    D_I, D_II = extra_lengths(Arm(body.thicknesses[0], c["E1"], c["E2"], c["G12"]))
    slid, opened = 9.0 * (body.free_length + D_II) ** 2, 12.0 * (body.free_length + D_I) ** 2
    zone = 2.0 * zone_length(prepared.scene) / body.free_length
    if "damage_front" in result.steps:
        zone = min(zone, float(np.max(result.steps["damage_front"] / result.steps["crack_length"])) - 1.0)
    return OF_THE_MODE + 3.0 / 7.0 - slid / (slid + opened) + 0.5 * zone


@identity(
    "mode-ratio",
    mode_tolerance,
    "The part of sliding in J is that of the closed form.",
    *J_COLUMNS,
    slides=True,
    kind="analytical",
    of_zone=True,
)
def mode_gap(scene: Scene, steps: Steps) -> np.ndarray | None:
    """Difference of J_shear from the part of J_bond that is expected for two equal arms, over the largest J.

    Steps of a single-leg bending test (slb) at which the damaged bond is near the load in the middle do not count.
    Except of end moments those at openings below zero do not count: loads of the other sign lift one arm off the other.
    """
    expected, body = _mode(scene), scene.specimen
    if expected is None or len(set(body.thicknesses)) > 1 or len(set(scene.materials)) > 1:
        return None
    counted = zone_is_free(scene, steps) & (steps["J_bond"] != 0.0)
    if body.kind != "moments":
        counted &= steps["opening"] > 0.0
    if body.kind == "slb":
        counted &= steps["damage_front"] < body.extent / 2.0 - AWAY * sum(body.thicknesses)
    return _part(counted, steps["J_shear"] - expected * steps["J_bond"], peak(steps["J_bond"]))


def _mode(scene: Scene) -> float | None:
    """G_II/G of two equal arms: 0 or 1 by symmetry, else from the moments; 3/7 for a slb with slender arms. Unknown
    where faces that would have to press one arm with the other pass through each other."""
    kind = scene.specimen.kind
    if kind in ("enf", "4enf", "els"):
        return 1.0 if simulated(scene)["contact"] else None
    if kind in ("dcb", "adcb"):
        return 0.0
    return bent_arms(scene).release(scene.specimen.tip)[1] if kind in ("moments", "slb") else None


@identity("moments", 0.003, "J is that of the end moments.", *J_COLUMNS, slides=True, kind="analytical", of_zone=True)
def moments_gap(scene: Scene, steps: Steps) -> np.ndarray | None:
    """Relative difference of J from the J of the end moments.

    ``2 w J = M1^2/EI_1 + M2^2/EI_2 - (M1 + M2)^2/EI_12``: for two equal arms ``[21 (M1^2 + M2^2) - 6 M1 M2] / (4 w^2
    h^3 E)``. It holds for every law and zone where displacements are small and the far end is not reached.
    """
    J = _of_moments(scene, steps)
    if J is None:
        return None
    return _part((J > ROUNDED_J * np.max(J)) & zone_is_free(scene, steps), steps["J_loads"] - J, J)


@identity(
    "moments-elastic",
    1e-6,
    "Before any damage J is that of the end moments.",
    *J_COLUMNS,
    "dissipated_energy",
    slides=True,
    kind="analytical",
    of_zone=True,
)
def elastic_moments_gap(scene: Scene, steps: Steps) -> np.ndarray | None:
    """Relative difference of J from the J of the end moments, before any damage."""
    J = _of_moments(scene, steps)
    if J is None:
        return None
    whole = np.maximum.accumulate(steps["dissipated_energy"]) <= 0.0
    return _part((J > ROUNDED_J * np.max(J)) & whole, steps["J_loads"] - J, J)


@identity(
    "plateau",
    0.005,
    "Between two loads a crack grows at one load.",
    *J_COLUMNS,
    slides=True,
    kind="analytical",
    of_zone=True,
    element=True,
)
def plateau_gap(scene: Scene, steps: Steps, element: Callable[[], float] = lambda: 0.0) -> np.ndarray | None:
    """Relative difference of the load of a 4enf from that of its plateau while the crack grows between the
    loads.

    For equal arms the load of the plateau is ``(4 w / 3 d) (E h^3 G_IIc)^(1/2)`` with E the bending modulus; arms may
    differ in thickness and material. Friction raises it (by 1.9 % on the packaged one with 0.3), and so does viscosity.
    Steps count in which the crack grows, once it has grown by an ``element`` of the bond, as its length is only known
    between points of the bond, and at openings above zero (see `mode_gap`).
    """
    body, bond = scene.specimen, mixed_bond(scene)
    if not isinstance(body, FourPointEnf) or simulated(scene)["kinematics"] != "linear":
        return None
    if bond is None or bond.friction or bond.viscosity:
        return None
    arms, middle, away = bent_arms(scene), body.place(body.length / 2.0), AWAY * sum(body.thicknesses)
    plateau = sqrt(float(bond.critical(1.0)) / arms.release(middle)[0]) / arms.compliance(middle)
    counted = _grows(steps) & (steps["crack_length"] > max(body.free_length, body.offset + away))
    counted &= steps["opening"] > 0.0
    counted &= steps["damage_front"] < body.length - body.offset - away
    if counted.any():
        grown = np.nan_to_num(element())
        counted &= steps["crack_length"] > body.free_length + grown
    return _part(counted, steps["load"] - plateau, plateau)


def toughness_in_growth(scene: Scene, steps: Steps, counted: np.ndarray) -> float | None:
    """The toughness of the pure mode in which a crack grows; None between the modes, or with viscosity.

    Between the modes the mode ratio of a point changes while the zone passes it: under end moments with G_II/G = 3/7
    and K = Ks from 0.99 at onset to 0.23 at failure. J is then the work of the tractions along that path (confirmed to
    0.02 %); it was 1.3 % below to 3 % above the toughness at G_II/G.
    """
    bond = mixed_bond(scene)
    if bond is None or bond.viscosity or "mode_ratio" not in steps or not counted.any():
        return None
    B = steps["mode_ratio"][counted]
    low, high = float(np.min(B)), float(np.max(B))
    if high < PURE:
        return float(bond.critical(0.0))
    return float(bond.critical(1.0)) if low > 1.0 - PURE else None


def cost_of_growth(scene: Scene, steps: Steps, counted: np.ndarray) -> np.ndarray | None:
    """Energy per area (n_steps,) that the growth of a crack costs: the toughness, or between the modes J.

    A zone that moves without changing its shape dissipates J, for any law and any path of its jumps. None with
    viscosity, or between the modes where the ends press on each other.
    """
    bond = mixed_bond(scene)
    if bond is None or bond.viscosity or not has(steps, "J_loads") or not counted.any():
        return None
    toughness = toughness_in_growth(scene, steps, counted)
    if toughness is None and ends_press(scene):
        return None
    return steps["J_loads"] if toughness is None else np.full(steps["load"].size, toughness)


def zone_has_moved(steps: Steps, counted: np.ndarray) -> bool:
    """Whether a crack has grown by several lengths of its zone."""
    crack = np.maximum.accumulate(steps["crack_length"])[counted]
    zone = np.max(steps["damage_front"][counted] - crack) if "damage_front" in steps else 0.0
    return bool(crack[-1] - crack[0] >= ZONES_GROWN * zone)


@identity(
    "growth-toughness",
    0.003,
    "While a crack grows J is the toughness.",
    *J_COLUMNS,
    slides=True,
    kind="analytical",
    of_zone=True,
)
def growth_gap(scene: Scene, steps: Steps) -> np.ndarray | None:
    """Relative difference of J from the toughness while a crack grows in a pure mode under end moments."""
    if scene.specimen.kind != "moments":
        return None
    grows = _grows(steps) & zone_is_free(scene, steps)
    grows &= steps["crack_length"] > scene.specimen.free_length + AWAY * sum(scene.specimen.thicknesses)
    toughness = toughness_in_growth(scene, steps, grows)
    return None if toughness is None else steps["J_bond"][grows] / toughness - 1.0


def _grows(steps: Steps) -> np.ndarray:
    """Steps (n_steps,) at whose end the crack is longer than ever before."""
    crack = np.maximum.accumulate(steps["crack_length"])
    return np.diff(crack, prepend=crack[:1]) > 0.0


def _of_moments(scene: Scene, steps: Steps) -> np.ndarray | None:
    """J of end moments (n_steps,) by beam theory, exact for arms of one material; None for others."""
    if scene.specimen.kind != "moments" or simulated(scene)["kinematics"] != "linear":
        return None
    if len(set(scene.materials)) > 1 or ends_press(scene):
        return None
    arms, tip = bent_arms(scene), scene.specimen.tip
    return arms.release(tip)[0] * (arms.compliance(tip) * steps["load"]) ** 2


def ends_press(scene: Scene) -> bool:
    """Whether end moments bend the arms into each other.

    They then touch on a spot at the loaded end, which contributes to J: 11 % where one arm has 3/5 of the thickness and
    0.44 of the moment of the other one.
    """
    body = scene.specimen
    if not isinstance(body, Moments):
        return False
    (first, second, _), (M1, M2) = bent_arms(scene).bending, body.moments
    parts = M1 * second - M2 * first
    rounded = 1e-9 * (abs(M1) * second + abs(M2) * first)
    return any(np.sign(opening) * parts < -rounded for opening in scene.load.opening)


def _acts(patch: Load | Support, length: float) -> tuple[float, float]:
    """Upward force, and moment about X = 0 over the length, of a unit force or a unit couple on a patch."""
    if patch.couple:
        return 0.0, 1.0 / length
    end = 0.0 if patch.side == "left" else length
    return 1.0, (end if patch.extent is None else sum(patch.extent) / 2.0) / length
