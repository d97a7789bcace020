"""Judges of the hard cases: each lets a made-up world pass in which all is well, and names what is not."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np
import pytest
from made_up_costs import made_up as curve
from scipy.optimize import brentq

from verify.checks.mechanics import mixed
from verify.checks.mechanics.columns import law_of
from verify.curves.curve import PROPAGATION
from verify.methods.mesh_choice import spline_mesh
from verify.methods.solve import solve
from verify.result import Result, Snapshot
from verify.scene.bond.mixed import mixed_bond
from verify.scene.load import load_scene
from verify.scene.schema import Scene
from verify.studies.hard import resolution
from verify.studies.hard.case import Number, Trial, Trials
from verify.studies.hard.cases import CASES
from verify.studies.hard.criteria import common, cost_of_damage
from verify.verdict import Check

Change = Callable[[str, Result], Result]


# --- worlds in which all is well


def rises_and_falls(name: str, scene: Scene) -> Result:
    """Over the whole programme of a scene that only opens."""
    return curve(2.0, end=scene.load.opening[-1], n=300, condition=1e8)


def snapshot(s_q: np.ndarray, traction_q: np.ndarray, damage_q: np.ndarray) -> Snapshot:
    grids = {"X_euvi": np.zeros((0, 1, 1, 2)), "u_euvi": np.zeros((0, 1, 1, 2)), "stress_euv": np.zeros((0, 1, 1))}
    return Snapshot(3.0, 0.2, s_q, np.zeros(s_q.size), traction_q, damage_q, **grids)


def changed(result: Result, **columns: np.ndarray) -> Result:
    return replace(result, steps={**result.steps, **columns})


def stiff_from_the_start(name: str, scene: Scene) -> Result:
    """The initial stiffness is the first secant, which is what is asked of a beam that is solved as this one is."""
    result = softer(name, scene)
    return changed(result, load_slope=np.full_like(result.load, result.load[1] / result.opening[1]))


def softer(name: str, scene: Scene) -> Result:
    """A penalty takes 3 / penalty off the load, of every code."""
    result = rises_and_falls(name, scene)
    left = 1.0 - 300.0 / scene.interface.penalty
    return changed(result, load=left * result.load, load_slope=left * result.steps["load_slope"])


def in_own_units(name: str, scene: Scene) -> Result:
    """Openings of a thousandth, loads of a thousandth and openings of a 25.4th, in units other than N and mm."""
    force, length = {"n-m": (1.0, 1e-3), "kn-in": (1e-3, 1.0 / 25.4)}.get(name, (1.0, 1.0))
    steps = curve(n=300).steps
    parts = {"opening": length, "load": force, "load_slope": force / length}
    return Result("nurbs", {**steps, **{key: size * steps[key] for key, size in parts.items()}})


#: How far the load is from that of fracture mechanics, by strength.
OFF = {"strength-4": 0.08, "strength-8": 0.04, "strength-15": 0.03, "strength-30": 0.01, "strength-60": -0.005}


def near_the_limit(name: str, scene: Scene) -> Result:
    limit = solve(scene, "lefm")
    return Result("nurbs", {"opening": limit.opening, "load": (1.0 + OFF[name]) * limit.load})


def paid_for(name: str, scene: Scene) -> Result:
    """Some points broken, none on its way: what is not stored is their area times the toughness."""
    points = spline_mesh(scene).points
    x, _ = np.polynomial.legendre.leggauss(points)
    s_q = (np.arange(40)[:, None] * 0.25 + 0.125 * (1 + x)).ravel()
    broken = np.arange(s_q.size) < s_q.size // 2
    spent = scene.interface.toughness * scene.specimen.width * 20 * 0.25
    result = rises_and_falls(name, scene)
    stored = 0.1 * spent * result.opening
    worked = changed(result, stored_energy=stored, external_work=stored + spent * result.opening / 3.0)
    return replace(worked, snapshots=(snapshot(s_q, 0 * s_q, broken.astype(float)),))


#: Where the bond of a made-up arm is whole, from the loaded end.
PRESSED_ARM = 7.0


def back_and_forth(name: str, scene: Scene) -> Result:
    """Along a curve, back on the secant to the end of the second leg, and on; tips of beams on springs when closed."""
    n, way = 60, [0.0, *scene.load.opening]
    legs = [np.linspace(a, b, n) for a, b in zip(way, way[1:], strict=False)]
    d = np.concatenate([legs[0], *(leg[1:] for leg in legs[1:])])
    grown = np.maximum.accumulate(d)
    load = 2.0 * np.exp(-grown) * np.where(d < grown, d, grown)
    mouth = np.where(d < 0, -pressed(scene, abs(load[np.argmin(d)])), d) if d.min() < 0.0 else d
    front = np.full(d.size, PRESSED_ARM)
    return Result("nurbs", {"opening": d, "load": load, "mouth_opening": mouth, "damage_front": front})


def pressed(scene: Scene, load: float) -> float:
    """How far two arms go into each other at the loaded end, in closed form.

    Each lies on its springs up to where y = 0, ``y = sum of c exp(r x)`` with r^4 = -4 b^4, moment 0 and shear P at the
    end; from there to the clamp it is a beam held at both ends: y_2 = -4 y_1 / L, y_3 = 6 y_1 / L^2 (derivatives).
    """
    body, k = scene.specimen, 2.0 * scene.specimen.width * scene.interface.penalty
    EI = scene.material.young * body.width * body.arm_thickness**3 / 12.0
    r = (k / (4.0 * EI)) ** 0.25 * np.array([1 + 1j, 1 - 1j, -1 + 1j, -1 - 1j])

    def coefficients(end: float) -> np.ndarray:
        L, e = PRESSED_ARM - end, np.exp(r * end)
        rows = [r**2, r**3, (r**2 + 4.0 * r / L) * e, (r**3 - 6.0 * r / L**2) * e]
        return np.linalg.solve(np.array(rows), np.array([0.0, load / EI, 0.0, 0.0]))

    end = brentq(lambda end: float((coefficients(end) @ np.exp(r * end)).real), 0.2 / abs(r[0]), 3.0 / abs(r[0]))
    return 2.0 * float(coefficients(end).sum().real)


def separated(name: str, scene: Scene) -> Result:
    body, result = scene.specimen, rises_and_falls(name, scene)
    bond = body.bond_length if body.kind == "peel" else body.length - body.precrack
    part = result.opening / result.opening[-1]
    grown = changed(result, load=result.load * (part < 0.9), dissipated_energy=bond * scene.interface.toughness * part)
    s_q = np.linspace(0.0, bond, 50)
    return replace(grown, ending="separated at opening 8", snapshots=(snapshot(s_q, s_q, 0 * s_q),))


def upright(name: str, scene: Scene) -> Result:
    sine = np.linspace(0.1, 0.95, 30)
    griffith = scene.interface.toughness * scene.specimen.width
    return Result("nurbs", {"opening": sine, "load": griffith / sine, "face_slope_top": -sine})


def worn(name: str, scene: Scene) -> Result:
    """Leg by leg along the programme; half of the points of the bond break in pure sliding, one is on its way. With
    friction the load is higher, and a short precrack snaps back."""
    way = np.array([0.0, *scene.load.opening])
    d = np.concatenate([np.zeros(1), *(np.linspace(a, b, 41)[1:] for a, b in zip(way[:-1], way[1:], strict=True))])
    spent = np.maximum.accumulate(np.abs(d)) / np.max(np.abs(d))
    s_q = 40.0 + (np.arange(20)[:, None] + 0.5 + np.array([-0.5, 0.5]) / np.sqrt(3.0)).ravel()
    damage_q = np.where(np.arange(40) < 20, 1.0, 0.0)
    damage_q[20] = 0.9
    bond = mixed_bond(scene)
    first, critical = float(bond.onset_norm(1.0)), float(bond.critical(1.0))
    last = 2.0 * critical / first
    jump = first * last / (last - 0.9 * (last - first))
    paid = critical * scene.specimen.width * (10.0 + 0.5 * (jump - first) / (last - first))
    if name == "precrack-0.49":
        d[30] *= 0.9
    stiffness = 110.0 if name == "friction-0.3" else 100.0
    columns = {
        "opening": d, "load": stiffness * d, "load_slope": np.full(d.size, stiffness), "heading": np.ones(d.size),
        "dissipated_energy": paid * spent, "friction_energy": 0.0 * d, "stored_energy": 50.0 * d**2,
        "external_work": paid * spent + 50.0 * d**2, "crack_length": 39.3 + 10.0 * spent,
        "damage_front": 41.3 + 10.0 * spent, "J_loads": 1.7 * spent, "J_bond": 1.7 * spent, "J_shear": 1.7 * spent,
        "mode_ratio": np.ones(d.size),
    }  # fmt: skip
    late = replace(snapshot(s_q, 0.0 * s_q, damage_q), opening=max(scene.load.opening))
    return Result("nurbs", columns, snapshots=(snapshot(s_q, 0.0 * s_q, 0.5 * damage_q), late))


#: Of every case its world, and its checks with the tolerances that they may have: what rounding may do, what a mesh or
#: a beam may be to blame for, and no more.
WORLDS: Mapping[str, tuple[Callable[[str, Scene], Result], Mapping[str, set[float]]]] = {
    "toward-lefm": (near_the_limit, {"monotone": {1.0}}),
    "under-resolved": (paid_for, {"warned": {0.0}, "crack-cost": {0.02}}),
    "peel-as-printed": (rises_and_falls, {"warned": {0.0}, "honest-end": {0.0}}),
    "penalty-sweep": (softer, {"same-curve": {0.001}}),
    "points-sweep": (rises_and_falls, {}),
    "mismatch": (rises_and_falls, {"same-curve": {0.005}}),
    "slender": (stiff_from_the_start, {"compliance": {0.005}}),
    "incompressible": (rises_and_falls, {"compliance": {0.02}}),
    "large-rotation": (upright, {"end-load": {0.01}}),
    "stiffness-contrast": (rises_and_falls, {"condition-known": {0.0}}),
    "big-steps": (rises_and_falls, {"same-curve": {0.002}}),
    "unload-reload": (
        back_and_forth,
        {"secant": {1e-6, 1e-3}, "return": {1e-6}, "same-envelope": {0.002}, "contact": {0.1}},
    ),
    "tiny-reversals": (rises_and_falls, {"same-envelope": {0.002}}),
    "full-separation": (separated, {"separated": {0.0}, "no-load": {0.01}, "all-dissipated": {0.01 + 1.0 / 50}}),
    "units": (in_own_units, {"same-curve": {1e-9}}),
    "pose": (rises_and_falls, {"same-curve": {1e-8}}),
    "noise": (rises_and_falls, {"same-curve": {1e-8}}),
    "enf-snap-back": (worn, {"snaps-back": {0.0}, "crack-cost": {0.01}}),
    "slip-reverses": (worn, {"odd": {1e-6}, "same-end": {0.002}, "secant": {1e-6}, "return": {1e-6}}),
    "pressed-shear": (worn, {"crack-cost": {0.01}, "smooth": {1e-9}, "holds": {0.0}}),
    "unequal-stiffness": (worn, {"same-curve": {0.002}, "same-stiffness": {1e-6}}),
    "unload-slip": (back_and_forth, {"secant": {1e-6}, "return": {1e-6}, "same-envelope": {0.002}}),
}


@pytest.fixture(autouse=True)
def solved(monkeypatch):
    """What the judges solve themselves is the world's curve."""
    monkeypatch.setattr(
        resolution, "solve", lambda scene, method: softer("", scene) if method == "beam" else solve(scene, method)
    )


def world(case: str, change: Change = lambda name, result: result) -> Trials:
    make, _ = WORLDS[case]
    return {name: Trial(name, scene, change(name, make(name, scene))) for name, scene in CASES[case].scenes().items()}


def judged(case: str, trials: Trials) -> Mapping[tuple[str, str], Check]:
    return {(f.name, f.subject): f for f in CASES[case].judge(trials) if isinstance(f, Check)}


def numbers(case: str, trials: Trials) -> Mapping[tuple[str, str], float]:
    return {(f.name, f.subject): f.value for f in CASES[case].judge(trials) if isinstance(f, Number)}


@pytest.mark.parametrize("case", WORLDS)
def test_a_world_in_which_all_is_well_passes_with_no_more_than_is_allowed(case):
    found = judged(case, world(case))
    allowed: dict[str, set[float]] = {}
    for (name, _), check in found.items():
        allowed.setdefault(name, set()).add(check.tolerance)
    assert allowed == WORLDS[case][1] and all(check.passed for check in found.values())
    exact = [check for check in found.values() if check.kind == "exact"]
    assert all(abs(check.value) < 1e-9 for check in exact)


def test_every_run_is_compared_with_the_one_that_nothing_was_done_to():
    of_case = {"units": 2, "pose": 4, "noise": 20, "mismatch": 4, "penalty-sweep": 7, "big-steps": 1}
    assert {case: len(judged(case, world(case))) for case in of_case} == of_case


# --- what is not well


def only(wrong: str, factor: float, *names: str) -> Change:
    """One run with columns that are off by a factor."""
    columns = names or ("load", "load_slope", "stored_energy", "dissipated_energy")

    def change(name: str, result: Result) -> Result:
        return changed(result, **{key: factor * result.steps[key] for key in columns}) if name == wrong else result

    return change


def where(wrong: str, of: Callable[[np.ndarray, np.ndarray], np.ndarray], column: str = "load") -> Change:
    """One run with another column, of the opening and that column."""

    def change(name: str, result: Result) -> Result:
        if name != wrong:
            return result
        new = of(result.opening, result.steps[column])
        return replace(result, steps={key: c[: new.size] for key, c in result.steps.items()} | {column: new})

    return change


def back(d: np.ndarray) -> np.ndarray:
    """Steps on the leg that unloads from an opening of 1.5."""
    after = np.arange(d.size) > int(np.argmax(d >= 1.5))
    return after & (np.arange(d.size) <= int(np.flatnonzero(d <= 0.0)[-1]))


def at(d: np.ndarray, step: int) -> np.ndarray:
    return np.arange(d.size) == step % d.size


def with_off(**off: float) -> Change:
    return lambda name, r: changed(r, load=r.load * (1.0 + off.get(name, OFF[name])) / (1.0 + OFF[name]))


def strengths(*off: float) -> Change:
    return with_off(**dict(zip(OFF, off, strict=True)))


FAULTS: Mapping[str, tuple[str, Change, set[tuple[str, str]]]] = {
    "meshes": ("mismatch", only("10-lower", 1.01), {("same-curve", "10-lower")}),
    "inches": ("units", only("kn-in", 1.0 + 1e-8, "opening"), {("same-curve", "kn-in")}),
    "other steps": ("units", where("kn-in", lambda d, P: P[:20]), {("same-curve", "kn-in")}),
    "stopped": ("pose", where("all", lambda d, P: P[:20]), {("same-curve", "all")}),
    "a strength that leaves the limit": ("toward-lefm", with_off(**{"strength-30": 0.031}), {("monotone", "all")}),
    "less than 0.2 % is the same": ("toward-lefm", strengths(0.08, 0.04, 1e-3, 1.9e-3, 1e-3), set()),
    "before the peak": (
        "toward-lefm",
        lambda name, r: changed(
            r, load=np.where(r.opening < 0.9 * PROPAGATION * r.opening[np.argmax(r.load)], 0.5, 1.0) * r.load
        ),
        set(),
    ),
    "dear points": (
        "under-resolved", only("strength-20", 1.05, "external_work"), {("crack-cost", "strength-20")}
    ),
    "hidden contact": (
        "penalty-sweep",
        lambda name, r: changed(r, load=curve(2.0, n=300).load, load_slope=curve(2.0, n=300).steps["load_slope"]),
        {("same-curve", "penalty-1e4"), ("same-curve", "penalty-1e5")},
    ),
    "a stiff beam": ("slender", only("1-1000", 1.01, "load_slope"), {("compliance", "1-1000")}),
    "locking": ("incompressible", only("coarse", 1.03, "load_slope"), {("compliance", "coarse")}),
    "a heavy strip": ("large-rotation", only("upright", 1.02, "load"), {("end-load", "upright")}),
    "no condition": (
        "stiffness-contrast", lambda name, r: replace(r, condition=0.0), {("condition-known", "million")}
    ),
    "bent": (
        "unload-reload",
        where("to-zero-linear", lambda d, P: np.where((d > 0.4) & (d < 0.6) & back(d), 1.01 * P, P)),
        {("secant", "to-zero-linear")},
    ),
    "not back": (
        "unload-reload",
        where("to-zero-linear", lambda d, P: np.where((d == 1.5) & (np.arange(d.size) > 100), 1.001 * P, P)),
        {("return", "to-zero-linear")},
    ),
    "another curve": (
        "unload-reload",
        where("to-zero-linear", lambda d, P: np.where(d > 1.5, 1.05 * P, P)),
        {("same-envelope", "to-zero-linear")},
    ),
    "no leg": ("unload-reload", where("to-zero-linear", lambda d, P: P[:90]), {("legs", "to-zero-linear")}),
    "soft contact": (
        "unload-reload", only("closing-finite", 1.2, "mouth_opening"), {("contact", "closing-finite")}
    ),
    "a load that stays": ("full-separation", where("peel", lambda d, P: P + 0.02), {("no-load", "peel")}),
    "a bond unpaid": ("full-separation", only("peel", 0.95, "dissipated_energy"), {("all-dissipated", "peel")}),
    "a stop": (
        "full-separation", lambda name, r: replace(r, status="stopped: here"),
        {("separated", "dcb"), ("separated", "peel")},
    ),
    "a stop that is explained": (
        "peel-as-printed", lambda name, r: replace(r, status="stopped: process zone 0.1 < element 1"), set()
    ),
    "a stop that is not": (
        "peel-as-printed", lambda name, r: replace(r, status="stopped: no convergence"), {("honest-end", "mpa")}
    ),
    "no step": (
        "peel-as-printed",
        lambda name, r: Result("nurbs", {k: c[:1] for k, c in r.steps.items()}, "stopped: process zone 1 < element 2"),
        {("honest-end", "mpa")},
    ),
    "no snap-back": (
        "enf-snap-back", where("precrack-0.49", lambda d, _: np.maximum.accumulate(d), "opening"),
        {("snaps-back", "precrack-0.49")},
    ),
    "sliding that costs more": (
        "pressed-shear", only("friction-0.3", 2.0**0.5, "dissipated_energy"), {("crack-cost", "friction-0.3")}
    ),
    "friction that holds nothing": ("pressed-shear", only("friction-0.3", 0.9, "load"), {("holds", "friction-0.3")}),
    "heat without friction": (
        "pressed-shear", where("friction-0.0", lambda d, heat: heat + 1e-6, "friction_energy"),
        {("smooth", "friction-0.0")},
    ),
    "other slip": (
        "slip-reverses", where("to-and-fro", lambda d, P: np.where(P < 0.0, 1.01 * P, P)),
        {("odd", "to-and-fro"), ("same-end", "to-and-fro")},
    ),
    "a load that is lost": (
        "slip-reverses", where("enf", lambda d, P: np.where(at(d, -1), 0.99 * P, P)), {("return", "enf")}
    ),
    "a line that is bent": (
        "slip-reverses", where("enf", lambda d, P: np.where(P < -50.0, 1.01 * P, P)), {("secant", "enf")}
    ),
    "a programme that ends": ("slip-reverses", where("enf", lambda d, P: P[:60]), {("legs", "enf")}),
    "a stiffness upside down": (
        "unequal-stiffness", only("upside-down", 1.0 + 1e-5, "load"), {("same-stiffness", "upside-down")}
    ),
    "a curve upside down": (
        "unequal-stiffness", where("upside-down", lambda d, P: np.where(np.arange(d.size) > 20, 1.01 * P, P)),
        {("same-curve", "upside-down")},
    ),
}  # fmt: skip


@pytest.mark.parametrize("fault", FAULTS)
def test_what_is_wrong_is_named(fault):
    case, change, broken = FAULTS[fault]
    assert {key for key, check in judged(case, world(case, change)).items() if not check.passed} == broken


def test_a_fine_mesh_is_not_announced_as_too_coarse():
    fine = next(iter(CASES["toward-lefm"].scenes().values()))
    trials = {name: replace(trial, scene=fine) for name, trial in world("under-resolved").items()}
    assert not judged("under-resolved", trials)["warned", "strength-10"].passed


def test_without_the_opening_at_the_mouth_nothing_is_said_of_contact():
    def bare(name: str, result: Result) -> Result:
        return replace(result, steps={key: c for key, c in result.steps.items() if key != "mouth_opening"})

    assert {name for name, _ in judged("unload-reload", world("unload-reload", bare))} == {
        "secant", "return", "same-envelope"
    }  # fmt: skip


def test_numbers_that_are_told_and_not_judged():
    assert numbers("toward-lefm", world("toward-lefm")) == pytest.approx(
        {("distance", name): abs(off) for name, off in OFF.items()}
    )
    assert list(numbers("under-resolved", world("under-resolved")).values()) == pytest.approx([20 * 0.25] * 3)
    found = numbers("penalty-sweep", world("penalty-sweep"))
    assert len(found) == 9 and found["distance", "penalty-1e4"] == pytest.approx(0.03, rel=1e-4)
    assert numbers("large-rotation", world("large-rotation"))["slope", "upright"] == pytest.approx(0.95)
    assert numbers("stiffness-contrast", world("stiffness-contrast")) == {("condition", "million"): 1e8}


def test_wiggles_are_told_for_every_number_of_points(monkeypatch):
    """Of the load about the beam's, and of the traction at the last opening."""
    monkeypatch.setattr(resolution, "solve", lambda scene, method: rises_and_falls("", scene))
    s = np.linspace(0.0, 1.0, 101)
    saw, hill = (snapshot(s, p, 0 * s) for p in (np.where(np.arange(101) % 2, 1.0, 0.0), np.minimum(s, 1.0 - s)))

    def wavy(name: str, result: Result) -> Result:
        if name != "gauss-3":
            return replace(result, snapshots=(saw, hill) if name == "gauss-4" else (saw,))
        d, P = result.opening, result.load
        return Result("nurbs", {"opening": d, "load": P * (1.0 + 0.1 * np.sin(20.0 * d))})

    found = numbers("points-sweep", world("points-sweep", wavy))
    assert {subject for _, subject in found} == CASES["points-sweep"].scenes().keys()
    assert found["load-oscillation", "gauss-3"] == pytest.approx(0.1 / np.sqrt(2.0), rel=0.1)
    assert found["load-oscillation", "lumped"] == pytest.approx(0.0, abs=1e-5)
    assert found["traction-variation", "lumped"] == pytest.approx(50.0)
    assert found["traction-variation", "gauss-4"] == pytest.approx(1.0)
    assert np.isnan(found["traction-variation", "gauss-3"])


def test_damage_costs_what_the_law_dissipates():
    scene = load_scene("dcb-czm1")
    law, bond = law_of(scene), scene.interface
    k = np.array([0.5 * (law.g_peak + law.g_open), 2.0 * law.g_open, 0.5 * law.g_peak])
    areas = np.array([3.0, 4.0, 5.0])
    found = cost_of_damage(areas, law.damage(k), bond.toughness, bond.ductility)
    assert found == pytest.approx(float(areas @ law.dissipated(k)), rel=1e-12)


# --- what every bond that slides must keep


def told(result: Result) -> Mapping[str, float]:
    return {one.name: one.value for one in common(Trial("x", load_scene("enf-as4peek"), result))}


def test_damage_that_heals_and_energy_that_comes_back_are_named():
    names = ("no-healing", "dissipated-energy", "friction-energy")
    result = worn("x", load_scene("enf-as4peek"))
    dip = np.where(at(result.opening, 20), 0.1, 0.0)
    worked = changed(result, dissipated_energy=result.steps["dissipated_energy"] * (1.0 - dip))
    rubbed = changed(result, friction_energy=dip)
    for wrong, run in zip(names, (replace(result, snapshots=result.snapshots[::-1]), worked, rubbed), strict=True):
        assert {name for name in names if told(run)[name] > 1e-9} == {wrong}
    assert all(told(result)[name] == 0.0 for name in names)


def test_a_step_without_load_tells_no_moments():
    """Where the loads pass through zero their J is rounding."""
    scene = CASES["slip-reverses"].scenes()["to-and-fro"]
    load = np.array([1.0, 0.5, 1e-23, -0.5, -1.0])
    steps = {"opening": 0.65 * load, "load": load, "J_bond": load**2, "J_shear": load**2, "J_loads": load**2}
    J = mixed._of_moments(scene, steps)
    assert J is not None and mixed.moments_gap(scene, steps | {"J_loads": J - 1e-30}) < 1e-12
    assert mixed.moments_gap(scene, steps | {"J_loads": 1.01 * J}) == pytest.approx(0.01)
