"""Judges of the hard cases: each lets a made-up world pass in which all is well, and names what is not."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import brentq

from tests.verify.studies.hard.test_hard import fake_rows
from verify.checks.mechanics.columns import law_of
from verify.curves.curve import PROPAGATION
from verify.methods.mesh_choice import spline_mesh
from verify.methods.solve import solve
from verify.result import Result, Snapshot, steps_from_rows
from verify.scene.load import load_scene
from verify.scene.schema import Scene
from verify.studies.hard import bodies, interfaces
from verify.studies.hard.case import Number, Trial, Trials
from verify.studies.hard.cases import CASES
from verify.studies.hard.interfaces import variation
from verify.verdict import Check

Change = Callable[[str, Result], Result]


def made_up(scene: Scene) -> Result:
    """A curve that rises and falls, over the whole programme of a scene that only opens."""
    return Result("nurbs", steps_from_rows(fake_rows(scene.load.opening[-1], 300)), condition=1e8)


def world(name: str, change: Change = lambda name, result: result, make: Callable = made_up) -> Trials:
    return {v.name: Trial(v, change(v.name, make(v.scene))) for v in CASES[name].variants()}


def times(result: Result, factor: float, *names: str) -> Result:
    return replace(result, steps={**result.steps, **{name: factor * result.steps[name] for name in names or ("load",)}})


def only(wrong: str, factor: float, *names: str) -> Change:
    """One run whose columns are off by a factor."""
    loads = ("load", "load_slope", "stored_energy", "dissipated_energy")
    return lambda name, result: times(result, factor, *(names or loads)) if name == wrong else result


def judged(name: str, trials: Trials) -> Mapping[tuple[str, str], Check]:
    return {(f.name, f.subject): f for f in CASES[name].judge(trials) if isinstance(f, Check)}


def numbers(name: str, trials: Trials) -> Mapping[tuple[str, str], float]:
    return {(f.name, f.subject): f.value for f in CASES[name].judge(trials) if isinstance(f, Number)}


def failing(name: str, trials: Trials) -> set[tuple[str, str]]:
    return {key for key, check in judged(name, trials).items() if not check.passed}


@pytest.mark.parametrize(
    ("name", "wrong", "checked"),
    [
        ("big-steps", "steps-5", {"steps-5"}),
        ("tiny-reversals", "reversals-tiny", {"reversals-tiny"}),
        ("mismatch", "10-lower", {"1.37-upper", "1.37-lower", "10-upper", "10-lower"}),
    ],
)
def test_a_curve_that_is_off_by_a_hundredth_is_named(name: str, wrong: str, checked: set[str]) -> None:
    good = judged(name, world(name))
    assert {subject for _, subject in good} == checked and all(check.value < 1e-12 for check in good.values())
    (off,) = failing(name, world(name, only(wrong, 1.01)))
    assert off[1] == wrong
    assert judged(name, world(name, only(wrong, 1.01)))[off].value == pytest.approx(0.01)


def test_contact_may_give_way_as_much_as_that_of_a_beam(monkeypatch: pytest.MonkeyPatch) -> None:
    """A world in which a penalty takes 3 / penalty off the load, of every code; and one that hides it."""

    def softer(scene: Scene, method: str = "nurbs") -> Result:
        return times(made_up(scene), 1.0 - 300.0 / scene.interface.penalty, "load", "load_slope")

    monkeypatch.setattr(interfaces, "solve", softer)
    trials = world("penalty-sweep", make=softer)
    good = judged("penalty-sweep", trials)
    assert {subject for _, subject in good} == {f"penalty-1e{n}" for n in range(4, 11)}
    assert all(abs(check.value) < 1e-9 for check in good.values())
    found = numbers("penalty-sweep", trials)
    assert len(found) == 9 and found["distance", "penalty-1e4"] == pytest.approx(0.03, rel=1e-4)
    rigid = world("penalty-sweep", make=made_up)
    assert failing("penalty-sweep", rigid) == {("same-curve", "penalty-1e4"), ("same-curve", "penalty-1e5")}


def snapshot(s_q: np.ndarray, traction_q: np.ndarray, damage_q: np.ndarray) -> Snapshot:
    grids = {"X_euvi": np.zeros((0, 1, 1, 2)), "u_euvi": np.zeros((0, 1, 1, 2)), "stress_euv": np.zeros((0, 1, 1))}
    return Snapshot(3.0, 0.2, s_q, np.zeros(s_q.size), traction_q, damage_q, **grids)


def test_a_single_rise_and_fall_of_the_traction_is_no_wiggle() -> None:
    s = np.linspace(0.0, 1.0, 101)
    hill = np.minimum(s, 1.0 - s)
    assert variation(Result("nurbs", {}, snapshots=(snapshot(s, hill, 0 * s),))) == pytest.approx(1.0)
    saw = np.where(np.arange(101) % 2, 1.0, 0.0)
    assert variation(Result("nurbs", {}, snapshots=(snapshot(s, saw, 0 * s),))) == pytest.approx(50.0)
    assert variation(Result("nurbs", {}, snapshots=tuple(snapshot(s, p, 0 * s) for p in (saw, hill)))) == pytest.approx(
        1.0
    )
    assert np.isnan(variation(Result("nurbs", {})))


def off_the_limit(factors: Mapping[str, float]) -> Trials:
    """Fracture mechanics itself, its load off by so much."""
    variants = CASES["toward-lefm"].variants()
    limit = solve(variants[0].scene, "lefm")
    steps = {"opening": limit.opening, "load": limit.load}
    return {v.name: Trial(v, Result("nurbs", {**steps, "load": (1 + factors[v.name]) * limit.load})) for v in variants}


def test_every_strength_must_come_closer_to_fracture_mechanics() -> None:
    names = [v.name for v in CASES["toward-lefm"].variants()]
    nearer = dict(zip(names, (0.08, 0.04, 0.03, 0.01, -0.005), strict=True))
    trials = off_the_limit(nearer)
    (check,) = judged("toward-lefm", trials).values()
    assert check.passed and check.value == pytest.approx(0.75) and check.kind == "analytical"
    assert numbers("toward-lefm", trials) == pytest.approx({("distance", n): abs(a) for n, a in nearer.items()})
    assert failing("toward-lefm", off_the_limit({**nearer, names[3]: 0.031})) == {("monotone", "all")}
    at_rest = off_the_limit({**nearer, names[2]: 1e-3, names[3]: 1.9e-3, names[4]: 1e-3})
    assert failing("toward-lefm", at_rest) == set(), "closer than 0.2 % is the same"
    leaving = off_the_limit({**nearer, names[2]: 1e-3, names[3]: 3e-3, names[4]: 1e-3})
    assert judged("toward-lefm", leaving)["monotone", "all"].value == pytest.approx(3.0 / 2.0), "and further is not"
    before = {}
    for name, trial in off_the_limit(nearer).items():
        d, P = trial.result.opening, trial.result.load
        rising = d < PROPAGATION * d[np.argmax(P)] * 0.9
        before[name] = replace(trial, result=Result("nurbs", {"opening": d, "load": np.where(rising, 0.5 * P, P)}))
    assert judged("toward-lefm", before)["monotone", "all"].value == pytest.approx(0.75, rel=1e-3)


def back_and_forth(scene: Scene) -> Result:
    """Along a curve, back on the secant to the end of the second leg, and on; tips of beams on springs when closed."""
    n, way = 60, [0.0, *scene.load.opening]
    legs = [np.linspace(a, b, n) for a, b in zip(way, way[1:], strict=False)]
    d = np.concatenate([legs[0], *(leg[1:] for leg in legs[1:])])
    grown = np.maximum.accumulate(d)
    load = 2.0 * np.exp(-grown) * np.where(d < grown, d, grown)
    deepest = load[np.argmin(d)]
    mouth = np.where(d < 0, -pressed(scene, abs(deepest)), d)
    front = np.full(d.size, PRESSED_ARM)
    return Result("nurbs", {"opening": d, "load": load, "mouth_opening": mouth, "damage_front": front})


#: Where the bond of a made-up arm is whole, from the loaded end.
PRESSED_ARM = 7.0


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


def test_a_programme_that_turns_is_judged_leg_by_leg() -> None:
    good = judged("unload-reload", world("unload-reload", make=back_and_forth))
    linear, finite = ({name for name, subject in good if subject == f"{way}-linear"} for way in ("to-zero", "closing"))
    assert linear == {"secant", "return", "same-envelope"} and finite == {*linear, "contact"}
    assert [key for key, check in good.items() if not check.passed] == []
    assert abs(good["contact", "closing-linear"].value) < 1e-3


@pytest.mark.parametrize(
    ("change", "broken"),
    [
        (lambda d, P: np.where((d > 0.4) & (d < 0.6) & turned(d), 1.01 * P, P), {("secant", "to-zero-linear")}),
        (lambda d, P: np.where(turned(d) & (np.arange(d.size) < 118), P + 0.01, P), {("secant", "to-zero-linear")}),
        (lambda d, P: np.where((d == 1.5) & (np.arange(d.size) > 100), 1.001 * P, P), {("return", "to-zero-linear")}),
        (lambda d, P: np.where(d > 1.5, 1.05 * P, P), {("same-envelope", "to-zero-linear")}),
        (lambda d, P: P[:90], {("legs", "to-zero-linear")}),
    ],
    ids=["bent", "shifted", "not-back", "other-curve", "unfinished"],
)
def test_what_is_wrong_with_a_leg_is_named(change: Callable, broken: set[tuple[str, str]]) -> None:
    def changed(name: str, result: Result) -> Result:
        if name != "to-zero-linear":
            return result
        load = change(result.opening, result.load)
        return replace(result, steps={key: c[: load.size] for key, c in result.steps.items()} | {"load": load})

    assert failing("unload-reload", world("unload-reload", changed, back_and_forth)) == broken


def turned(d: np.ndarray) -> np.ndarray:
    """Steps on the leg that unloads."""
    after = np.arange(d.size) > int(np.argmax(d >= 1.5))
    return after & (np.arange(d.size) <= int(np.flatnonzero(d <= 0.0)[-1]))


def test_arms_that_go_further_into_each_other_are_named() -> None:
    deeper = world("unload-reload", only("closing-finite", 1.2, "mouth_opening"), back_and_forth)
    assert failing("unload-reload", deeper) == {("contact", "closing-finite")}
    assert judged("unload-reload", deeper)["contact", "closing-finite"].value == pytest.approx(0.2, abs=1e-3)


def separated(scene: Scene) -> Result:
    body, result = scene.specimen, made_up(scene)
    bond = body.bond_length if body.kind == "peel" else body.length - body.precrack
    fades = result.load * (result.opening < 0.9 * result.opening[-1])
    grows = scene.interface.toughness * body.width * bond * result.opening / result.opening[-1]
    s_q = np.linspace(0.0, bond, 50)
    steps = {**result.steps, "load": fades, "dissipated_energy": grows}
    return replace(result, steps=steps, ending="separated at opening 8", snapshots=(snapshot(s_q, s_q, 0 * s_q),))


def test_a_specimen_that_has_come_apart_carries_nothing_and_has_paid_for_its_bond() -> None:
    good = judged("full-separation", world("full-separation", make=separated))
    assert {key for key in good} == {
        (n, s) for n in ("separated", "no-load", "all-dissipated") for s in ("dcb", "peel")
    }
    assert all(abs(check.value) < 1e-12 for check in good.values())
    changes: dict[str, Change] = {
        "separated": lambda name, r: replace(r, ending="") if name == "peel" else r,
        "no-load": lambda name, r: replace(r, steps={**r.steps, "load": r.load + 0.02}) if name == "peel" else r,
        "all-dissipated": only("peel", 0.95, "dissipated_energy"),
    }
    for name, change in changes.items():
        assert failing("full-separation", world("full-separation", change, separated)) == {(name, "peel")}
    stopped = world("full-separation", lambda name, r: replace(r, status="stopped: here"), separated)
    assert {name for name, _ in failing("full-separation", stopped)} == {"separated"}
    nothing = world(
        "full-separation", lambda name, r: replace(r, steps={k: c[:1] for k, c in r.steps.items()}), separated
    )
    assert {name for name, _ in judged("full-separation", nothing)} == {"separated"}


def test_initial_stiffness_of_bodies_that_lock(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(bodies, "solve", lambda scene, method: replace(made_up(scene), method=method))
    trials = {
        name: replace(
            trial,
            result=replace(
                trial.result,
                steps=trial.result.steps
                | {"load_slope": np.full_like(trial.result.load, trial.result.load[1] / trial.result.opening[1])},
            ),
        )
        for name, trial in world("slender").items()
    }
    assert abs(judged("slender", trials)["compliance", "1-1000"].value) < 1e-12
    stiff = {n: replace(t, result=times(t.result, 1.01, "load_slope")) for n, t in trials.items()}
    assert judged("slender", stiff)["compliance", "1-1000"].value == pytest.approx(0.01)
    assert failing("slender", stiff) == {("compliance", "1-1000")}
    assert failing("incompressible", world("incompressible")) == set()
    locked = world("incompressible", only("coarse", 1.03, "load_slope"))
    assert judged("incompressible", locked)["compliance", "coarse"].value == pytest.approx(0.03)
    assert failing("incompressible", locked) == {("compliance", "coarse")}


def test_a_vertical_strip_carries_its_toughness() -> None:
    def upright(scene: Scene) -> Result:
        griffith, sine = scene.interface.toughness * scene.specimen.width, np.linspace(0.1, 0.95, 30)
        return Result("nurbs", {"opening": sine, "load": griffith / sine, "face_slope_top": -sine})

    trials = world("large-rotation", make=upright)
    assert abs(judged("large-rotation", trials)["end-load", "upright"].value) < 1e-12
    assert numbers("large-rotation", trials)["slope", "upright"] == pytest.approx(0.95)
    heavy = {n: replace(t, result=times(t.result, 1.02)) for n, t in trials.items()}
    assert failing("large-rotation", heavy) == {("end-load", "upright")}


def test_a_condition_number_must_be_told() -> None:
    assert failing("stiffness-contrast", world("stiffness-contrast")) == set()
    assert numbers("stiffness-contrast", world("stiffness-contrast")) == {("condition", "million"): 1e8}
    silent = world("stiffness-contrast", lambda name, result: replace(result, condition=0.0))
    assert failing("stiffness-contrast", silent) == {("condition-known", "million")}


def test_an_under_resolved_zone_is_announced_and_every_point_paid_for() -> None:
    def run(scene: Scene) -> Result:
        """Some points broken, none on its way: what is not stored is their area times the toughness."""
        points = spline_mesh(scene).points
        n = 40 * points
        x, _ = np.polynomial.legendre.leggauss(points)
        s_q = (np.arange(40)[:, None] * 0.25 + 0.125 * (1 + x)).ravel()
        broken = np.arange(n) < n // 2
        spent = scene.interface.toughness * scene.specimen.width * 20 * 0.25
        result = made_up(scene)
        stored = 0.1 * spent * result.opening
        steps = {**result.steps, "stored_energy": stored, "external_work": stored + spent * result.opening / 3.0}
        return replace(result, steps=steps, snapshots=(snapshot(s_q, 0 * s_q, broken.astype(float)),))

    trials = world("under-resolved", make=run)
    good = judged("under-resolved", trials)
    assert {name for name, _ in good} == {"warned", "crack-cost"} and len(good) == 6
    assert all(abs(check.value) < 1e-9 for check in good.values())
    areas = numbers("under-resolved", trials)
    assert list(areas.values()) == pytest.approx([20 * 0.25] * 3)
    law = law_of(trials["strength-10"].scene)
    assert law.dissipated(np.array([2 * law.g_open]))[0] == pytest.approx(0.1)
    dear = world("under-resolved", only("strength-20", 1.05, "external_work"), run)
    assert failing("under-resolved", dear) == {("crack-cost", "strength-20")}
    assert {check.tolerance for (name, _), check in good.items() if name == "crack-cost"} == {0.02}
    fine = {n: replace(t, variant=replace(t.variant, scene=CASES["toward-lefm"].variants()[0].scene))
            for n, t in trials.items()}  # fmt: skip
    assert ("warned", "strength-10") in failing("under-resolved", fine)


@pytest.mark.parametrize(
    ("status", "steps", "passes"),
    [
        ("complete", 30, True),
        ("stopped: process zone 0.1 < element 1", 30, True),
        ("stopped: process zone 0.1 < element 1", 1, False),
        ("stopped: no convergence", 30, False),
    ],
)
def test_a_run_may_stop_where_it_says_why(status: str, steps: int, passes: bool) -> None:
    def stop(name: str, result: Result) -> Result:
        return replace(result, status=status, steps={key: c[:steps] for key, c in result.steps.items()})

    found = judged("peel-as-printed", world("peel-as-printed", stop))
    assert found["honest-end", "mpa"].passed == passes and found["warned", "mpa"].passed


def test_wiggles_are_told_for_every_number_of_points(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of the load about the beam's, and of the traction at the last opening; none is judged."""
    monkeypatch.setattr(interfaces, "solve", lambda scene, method: made_up(scene))
    s = np.linspace(0.0, 1.0, 101)
    saw = (snapshot(s, np.where(np.arange(101) % 2, 1.0, 0.0), 0 * s),)

    def wavy(name: str, result: Result) -> Result:
        if name != "gauss-3":
            return replace(result, snapshots=saw)
        steps = result.steps
        return Result("nurbs", {"opening": steps["opening"],
                                "load": steps["load"] * (1.0 + 0.1 * np.sin(20.0 * steps["opening"]))})  # fmt: skip

    trials = world("points-sweep", wavy)
    assert judged("points-sweep", trials) == {} and len(trials) == 12 + 11 + 1
    found = numbers("points-sweep", trials)
    assert {subject for _, subject in found} == set(trials)
    assert found["load-oscillation", "gauss-3"] == pytest.approx(0.1 / np.sqrt(2.0), rel=0.1)
    assert found["load-oscillation", "lumped"] == pytest.approx(0.0, abs=1e-5)
    assert found["traction-variation", "lumped"] == pytest.approx(50.0)
    assert np.isnan(found["traction-variation", "gauss-3"])


def test_points_are_those_of_their_rules() -> None:
    meshes = {v.name: v.scene.discretization for v in CASES["points-sweep"].variants()}
    for rule, fewest in (("gauss", 1), ("lobatto", 2)):
        named = {name: mesh for name, mesh in meshes.items() if name.startswith(rule)}
        assert [mesh.interface_points for mesh in named.values()] == list(range(fewest, 13))
        assert all(name == f"{rule}-{mesh.interface_points}" and mesh.interface_rule == rule
                   for name, mesh in named.items())  # fmt: skip
    assert meshes["lumped"].interface_rule == "lumped"
    penalties = [v.scene.interface.penalty for v in CASES["penalty-sweep"].variants()]
    assert penalties == [10.0**n for n in (*range(2, 11), 2, 6, 8, 10)]


def test_what_the_judges_allow(monkeypatch: pytest.MonkeyPatch) -> None:
    """What only rounding may do, what a mesh or a beam may be to blame for, and no more."""
    monkeypatch.setattr(bodies, "solve", lambda scene, method: replace(made_up(scene), method=method))
    made = {"unload-reload": back_and_forth, "full-separation": separated}
    allowed = {
        "big-steps": {"same-curve": {0.002}},
        "tiny-reversals": {"same-envelope": {0.002}},
        "mismatch": {"same-curve": {0.005}},
        "slender": {"compliance": {0.005}},
        "incompressible": {"compliance": {0.02}},
        "stiffness-contrast": {"condition-known": {0.0}},
        "unload-reload": {"secant": {1e-6, 1e-3}, "return": {1e-6}, "same-envelope": {0.002}, "contact": {0.1}},
        "full-separation": {"separated": {0.0}, "no-load": {0.01}, "all-dissipated": {0.01 + 1.0 / 50}},
    }
    for name, wanted in allowed.items():
        found: dict[str, set[float]] = {}
        for (check, _), given in judged(name, world(name, make=made.get(name, made_up))).items():
            found.setdefault(check, set()).add(given.tolerance)
        assert found == wanted, name


def test_the_units_of_a_curve_are_no_part_of_it() -> None:
    """Openings and loads of a thousandth, and of a 25.4th, are those of the scene in millimetres and newtons."""
    sizes = {"n-mm": (1.0, 1.0), "n-m": (1.0, 1e-3), "kn-in": (1e-3, 1.0 / 25.4)}
    base = made_up(CASES["units"].variants()[0].scene)

    def told(force: float, length: float) -> Result:
        return times(times(base, length, "opening"), force, "load")

    trials = {v.name: Trial(v, told(*sizes[v.name])) for v in CASES["units"].variants()}
    good = judged("units", trials)
    assert {subject for _, subject in good} == {"n-m", "kn-in"} and all(one.value < 1e-12 for one in good.values())
    for name in ("n-m", "kn-in"):
        off = {**trials, name: replace(trials[name], result=times(trials[name].result, 1.0 + 1e-8))}
        assert failing("units", off) == {("same-curve", name)}


@pytest.mark.parametrize(("name", "wrong"), [("pose", "moved"), ("noise", "noise-7")])
def test_what_changes_no_curve_is_held_against_the_plain_one(name: str, wrong: str) -> None:
    assert all(check.value < 1e-12 for check in judged(name, world(name)).values())
    assert ("same-curve", "plain") not in judged(name, world(name))
    assert failing(name, world(name, only(wrong, 1.0 + 2e-8))) == {("same-curve", wrong)}


def test_without_the_opening_at_the_mouth_nothing_is_said_of_contact() -> None:
    def bare(scene: Scene) -> Result:
        result = back_and_forth(scene)
        return replace(result, steps={name: c for name, c in result.steps.items() if name != "mouth_opening"})

    good = judged("unload-reload", world("unload-reload", make=bare))
    assert {name for name, _ in good} == {"secant", "return", "same-envelope"}
    assert all(check.passed for check in good.values())


def test_a_path_is_drawn_with_points_between_its_steps_where_its_slopes_are_known() -> None:
    pytest.importorskip("matplotlib")
    from verify.studies.hard.page import _path

    few, many = made_up(load_scene("dcb-czm1")), steps_from_rows(fake_rows(3.0, 700))
    x, y = _path(replace(few, steps=steps_from_rows(fake_rows(3.0, 20))))
    assert len(x) == 20 * (600 // 21) + 1 and y == pytest.approx(2.0 * x * np.exp(-x), abs=1e-3)
    assert len(_path(replace(few, steps=many))[0]) == 701
    bare = {"opening": few.opening[:20], "load": few.load[:20]}
    assert np.array_equal(_path(Result("nurbs", bare)), list(bare.values()))
