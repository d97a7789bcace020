"""Judges of hard cases of bonds that slide: a made-up world in which all is well passes, and what is not is named."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from tests.verify.studies.hard.test_hard_judges import failing, judged, snapshot, world
from verify.result import Result
from verify.scene.bond.mixed import mixed_bond
from verify.scene.load import load_scene
from verify.scene.schema import Scene
from verify.studies.hard.case import Trial, Variant
from verify.studies.hard.criteria import common
from verify.studies.hard.sliding import SLIDING_CASES


def worn(scene: Scene) -> Result:
    """Leg by leg along the programme; half of the points of the bond break in pure sliding, one is on its way."""
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
    columns = {
        "opening": d, "load": 100.0 * d, "load_slope": np.full(d.size, 100.0), "heading": np.ones(d.size),
        "dissipated_energy": paid * spent, "friction_energy": 0.0 * d, "stored_energy": 50.0 * d**2,
        "external_work": paid * spent + 50.0 * d**2, "crack_length": 39.3 + 10.0 * spent,
        "damage_front": 41.3 + 10.0 * spent, "J_loads": 1.7 * spent, "J_bond": 1.7 * spent, "J_shear": 1.7 * spent,
        "mode_ratio": np.ones(d.size),
    }  # fmt: skip
    early = snapshot(s_q, 0.0 * s_q, 0.5 * damage_q)
    late = replace(snapshot(s_q, 0.0 * s_q, damage_q), opening=max(scene.load.opening))
    return Result("nurbs", columns, snapshots=(early, late))


def column(subject: str, name: str, change: Callable[[np.ndarray], np.ndarray]) -> Callable[[str, Result], Result]:
    return lambda run, r: replace(r, steps={**r.steps, name: change(r.steps[name])}) if run == subject else r


def healed(run: str, result: Result) -> Result:
    return replace(result, snapshots=result.snapshots[::-1])


@pytest.mark.parametrize("name", [case.name for case in SLIDING_CASES])
def test_damage_that_heals_is_named_in_every_case(name: str) -> None:
    good, bad = world(name, make=worn), world(name, healed, worn)
    assert {check for check, _ in failing(name, good)}.isdisjoint({"no-healing", "dissipated-energy"})
    assert {subject for check, subject in failing(name, bad) if check == "no-healing"} == set(good)


def test_energy_that_comes_back_is_named() -> None:
    dips = column("friction-0.3", "dissipated_energy", lambda c: c - 0.1 * c[-1] * (np.arange(c.size) == 20))
    found = failing("pressed-shear", world("pressed-shear", dips, worn))
    assert ("dissipated-energy", "friction-0.3") in found and ("dissipated-energy", "friction-0.0") not in found


def test_a_point_costs_the_toughness_of_sliding_however_it_is_pressed() -> None:
    good = judged("pressed-shear", world("pressed-shear", make=worn))
    assert abs(good["crack-cost", "friction-0.3"].value) < 1e-12
    dear = column("friction-0.3", "dissipated_energy", lambda c: 2.0**0.5 * c)
    found = judged("pressed-shear", world("pressed-shear", dear, worn))["crack-cost", "friction-0.3"]
    assert found.value == pytest.approx(2.0**0.5 - 1.0) and not found.passed
    heat = column("friction-0.0", "friction_energy", lambda c: c + 1.0)
    assert ("smooth", "friction-0.0") in failing("pressed-shear", world("pressed-shear", heat, worn))


def test_friction_must_hold_and_a_short_precrack_snap_back() -> None:
    assert ("holds", "friction-0.3") in failing("pressed-shear", world("pressed-shear", make=worn))
    higher = column("friction-0.3", "load", lambda c: 1.1 * c)
    assert ("holds", "friction-0.3") not in failing("pressed-shear", world("pressed-shear", higher, worn))
    assert ("snaps-back", "precrack-0.49") in failing("enf-snap-back", world("enf-snap-back", make=worn))
    back = column("precrack-0.49", "opening", lambda c: np.where(np.arange(c.size) == 30, 0.9 * c, c))
    assert failing("enf-snap-back", world("enf-snap-back", back, worn)) == set()


def test_slip_that_turns_round_meets_the_load_that_it_had() -> None:
    assert failing("slip-reverses", world("slip-reverses", make=worn)) == set()
    stiffer = column("to-and-fro", "load", lambda c: np.where(c < 0.0, 1.01 * c, c))
    assert failing("slip-reverses", world("slip-reverses", stiffer, worn)) == {
        ("odd", "to-and-fro"), ("same-end", "to-and-fro")
    }  # fmt: skip
    worse = column("enf", "load", lambda c: np.where(np.arange(c.size) == c.size - 1, 0.99 * c, c))
    assert failing("slip-reverses", world("slip-reverses", worse, worn)) == {("return", "enf")}
    bent = column("enf", "load", lambda c: np.where(c < -50.0, 1.01 * c, c))
    assert failing("slip-reverses", world("slip-reverses", bent, worn)) == {("secant", "enf")}


def test_arms_upside_down_are_as_stiff() -> None:
    assert failing("unequal-stiffness", world("unequal-stiffness", make=worn)) == set()
    stiffer = column("upside-down", "load", lambda c: (1.0 + 1e-5) * c)
    assert failing("unequal-stiffness", world("unequal-stiffness", stiffer, worn)) == {
        ("same-stiffness", "upside-down")
    }
    later = column("upside-down", "load", lambda c: np.where(np.arange(c.size) > 20, 1.01 * c, c))
    assert failing("unequal-stiffness", world("unequal-stiffness", later, worn)) == {("same-curve", "upside-down")}


def test_j_of_a_bond_that_slides_is_judged_from_the_onset_on() -> None:
    scene = load_scene("enf-as4peek")

    def found(where: Callable[[np.ndarray], np.ndarray]) -> float:
        """What is said of J where J of the loads is half as large again; damage begins at an opening of 3."""
        result = worn(scene)
        off = np.where(where(result.opening), 1.5, 1.0)
        steps = {**result.steps, "J_loads": off * result.steps["J_loads"]}
        steps["dissipated_energy"] = steps["dissipated_energy"] * (result.opening > 3.0)
        trial = Trial(Variant("x", scene), replace(result, steps=steps))
        (value,) = [one.value for one in common(trial) if one.name in ("j-loads", "j-deviation")]
        return value

    assert found(lambda d: d < 3.0) < 1e-12
    assert found(lambda d: d >= 4.0) > 0.3  # in parts of the larger J
