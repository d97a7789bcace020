"""What a run left out, read from columns and fields that are made up: each measure is what its definition says."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from verify.checks import neglected
from verify.checks.mechanics.columns import law_of
from verify.methods.solve import prepare
from verify.result import Result, Snapshot
from verify.scene.effects import stiffer
from verify.scene.load import load_scene

N = 11
OPENING = np.linspace(0.0, 1.0, N)
OFF = {
    "kinematics": "effects.kinematics=linear",
    "contact": "effects.contact=false",
    "irreversible": "effects.irreversible=false",
}


def found(key: str, steps: dict, snapshots: tuple[Snapshot, ...] = ()) -> neglected.Neglected:
    scene = load_scene("dcb-czm1", [OFF[key]])
    result = Result("nurbs", {"opening": OPENING, "load": OPENING, **steps}, snapshots=snapshots)
    (one,) = [one for one in neglected.of_run(scene, result) if one.key == key]
    return one


def test_a_turn_counts_for_more_before_the_crack_grows():
    """16/35 of its square while the crack stands, 6/35 while it grows; of either face, whatever its sign."""
    crack = np.where(OPENING > 0.45, 5.0, 4.0)
    slopes = {"face_slope_top": 0.2 * OPENING, "face_slope_bottom": -0.3 * OPENING, "crack_length": crack}
    said = found("kinematics", slopes)
    assert said.value == pytest.approx(max(16 / 35 * (0.3 * 0.4) ** 2, 6 / 35 * 0.3**2))
    assert f"turned by {np.degrees(0.3):.2g} degrees" in said.seen and not said.negligible
    slow = found("kinematics", {**slopes, "crack_length": 4.0 + 0 * crack})
    assert slow.value == pytest.approx(16 / 35 * 0.3**2)
    alone = found("kinematics", {"face_slope_top": 0.2 * OPENING, "crack_length": crack})
    assert alone.value == pytest.approx(max(16 / 35 * 0.08**2, 6 / 35 * 0.2**2))


@pytest.mark.parametrize(("times", "negligible"), [(0.999, True), (1.001, False)])
def test_half_a_per_cent_is_negligible_and_more_is_not(times, negligible):
    theta = times * np.sqrt(0.005 * 35 / 16)
    said = found("kinematics", {"face_slope_top": theta * OPENING, "crack_length": 4.0 + 0 * OPENING})
    assert said.negligible == negligible and ("not negligible (limit 0.5%)" in said.sentence) != negligible
    energy = np.where(OPENING < 0.8, OPENING, 0.7 * (1.0 - 0.005 * times))
    grown = {"cohesive_energy": energy, "damage_front": 5.0 + 0 * OPENING}
    assert found("irreversible", grown).negligible == negligible


def closed(share: float, traction: float) -> Snapshot:
    """The first half of the bond squeezed by ``share`` of g_max, with a traction; the rest open."""
    law = law_of(load_scene("dcb-czm1"))
    s_q = np.linspace(4.0, 14.0, 2001)
    here = s_q <= 9.0
    gap, p = np.where(here, -share * law.g_peak, law.g_peak), np.where(here, -traction, 1.0)
    grids = {"X_euvi": np.zeros((0, 1, 1, 2)), "u_euvi": np.zeros((0, 1, 1, 2)), "stress_euv": np.zeros((0, 1, 1))}
    mixed = np.random.default_rng(1).permutation(s_q.size)
    return Snapshot(0.5, 1.0, s_q[mixed], gap[mixed], p[mixed], 0 * s_q, **grids)


def test_what_is_squeezed_would_have_been_stiffer():
    """The part of the work that the squeezed half holds, times what contact makes of it, over the work so far."""
    scene = load_scene("dcb-czm1")
    law, work = law_of(scene), np.linspace(0.0, 2.0, N) ** 2
    gap, traction = 0.4 * law.g_peak, 0.4 * law.strength
    said = found("contact", {"external_work": work}, (closed(0.4, traction),))
    ratio = scene.interface.penalty * gap / traction
    wanted = 0.5 * traction * gap * 5.0 * stiffer(ratio) / 1.0  # the work is 1 at the opening of the fields
    assert said.value == pytest.approx(wanted, rel=1e-3) and "overlapped by up to 0.4 g_max" in said.seen
    assert found("contact", {"external_work": 0 * work}, (closed(0.4, traction),)).value == 0.0
    open_ = closed(-1.0, 0.0)
    assert found("contact", {"external_work": work}, (open_,)).value == 0.0


@pytest.mark.parametrize(("share", "ran_into"), [(0.99, False), (1.01, True)])
@pytest.mark.parametrize("column", ["tip_opening", "end_opening"])
def test_faces_at_the_ends_of_the_bond_that_run_into_each_other_are_no_squeeze(share, ran_into, column):
    law = law_of(load_scene("dcb-czm1"))
    said = found("contact", {column: -share * law.g_peak * OPENING, "external_work": OPENING})
    assert said.negligible != ran_into and ("ran into each other" in said.seen) == ran_into
    assert said.value == pytest.approx(share if ran_into else 0.0)


def test_what_a_damaged_bond_gives_back_counts_from_its_damage_on():
    """An elastic bond may give back what it likes."""
    energy = np.array([0.0, 2.0, 0.5, 1.0, 4.0, 3.0, 3.5, 2.0, 5.0, 6.0, 6.0])
    front = np.where(np.arange(N) >= 4, 4.5, 4.0)
    said = found("irreversible", {"cohesive_energy": energy, "damage_front": front})
    assert said.value == pytest.approx(0.5) and "50.00% of the energy" in said.seen and not said.negligible
    back = np.where(np.arange(N) == 4, 4.5, 4.0)
    assert found("irreversible", {"cohesive_energy": energy, "damage_front": back}).value == said.value, "it stays so"
    whole = found("irreversible", {"cohesive_energy": energy, "damage_front": 4.0 + 0 * front})
    assert whole.value == 0.0 and whole.negligible


@pytest.mark.parametrize(("off", "same"), [(0.9e-6, True), (1.1e-6, False)])
def test_meshes_that_mirror_each_other_may_differ_by_rounding(off, same, monkeypatch):
    points = np.random.default_rng(2).random((30, 2))
    upper, lower = SimpleNamespace(P_AI=points[::-1]), SimpleNamespace(P_AI=points + [0.0, off * 50.0])
    monkeypatch.setattr("verify.methods.given_meshes.given_meshes", lambda scene: (upper, lower))
    monkeypatch.setattr("iga.mesh.mirror.upside_down", lambda mesh: mesh)
    scene = SimpleNamespace(specimen=SimpleNamespace(mesh=("a", "b"), loaded_thickness=50.0))
    said = neglected._other_arm(prepare(scene, "tspline"), Result("tspline", {}))
    assert said.negligible == same and said.value == pytest.approx(off, rel=1e-3)
    more = SimpleNamespace(P_AI=np.concatenate([points, points[:1]]))
    monkeypatch.setattr("verify.methods.given_meshes.given_meshes", lambda scene: (upper, more))
    assert not neglected._other_arm(prepare(scene, "tspline"), Result("tspline", {})).negligible


def test_a_remark_names_all_runs_and_the_worst_of_them():
    scene = load_scene("dcb-czm1", [OFF["kinematics"]])

    def run(theta: float) -> Result:
        steps = {"face_slope_top": theta * OPENING, "crack_length": 4.0 + 0 * OPENING}
        return Result("nurbs", {"opening": OPENING, "load": OPENING, **steps})

    (remark,) = neglected.remarks(scene, {"a": run(0.2), "b": run(0.01), "c": run(0.3)})
    assert remark.startswith("a, c: without finite kinematics: ") and f"{np.degrees(0.3):.2g} degrees" in remark
    assert neglected.remarks(scene, {"b": run(0.01)}) == ()
    prepared = prepare(scene, "nurbs")
    assert len(neglected.warnings(prepared, run(0.3))) == 1 and neglected.warnings(prepared, run(0.01)) == ()
    one_row = Result("nurbs", {name: column[:1] for name, column in run(0.3).steps.items()})
    assert neglected.of_run(scene, one_row) == ()
