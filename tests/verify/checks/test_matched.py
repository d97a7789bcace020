"""What a matched interface leaves out, from fields whose tilt and slip are known."""

from dataclasses import replace

import numpy as np
import pytest

from verify.checks.matched import left_out, summary
from verify.checks.mechanics.columns import law_of
from verify.checks.neglected import of_run
from verify.methods.solve import prepare
from verify.result import Result, Snapshot, steps_from_rows
from verify.scene.load import load_scene
from verify.theory.law import Softened

LAW = Softened(strength=2.0, toughness=0.5, ductility=5.0, penalty=100.0, contact=True)
LENGTH, LOADED_AT, TILT, SLIP, LOAD = 6.0, 8.0, 0.03, 0.2, 3.0


def grids(low, high, displacement):
    """Elements of length 1.5 in the layer between two heights, with 3 x 3 samples of u(X, Y)."""
    X_e, t = np.arange(4) * 1.5, np.linspace(0.0, 1.0, 3)
    X = np.broadcast_to((X_e[:, None] + 1.5 * t)[:, :, None], (4, 3, 3))
    Y = np.broadcast_to(low + (high - low) * t, (4, 3, 3))
    return np.stack([X, Y], axis=-1), np.stack(np.broadcast_arrays(*displacement(X, Y)), axis=-1)


@pytest.fixture
def snapshot():
    """The lower surface lies on a parabola that is steepest, TILT, at its right end; the upper one has slid by SLIP."""
    upper = grids(0.0, 0.5, lambda X, Y: (SLIP + 0 * X, 5 * Y))
    lower = grids(-1.0, 0.0, lambda X, Y: (0 * X, np.tan(TILT) * X**2 / (2 * LENGTH)))
    deep = grids(-2.0, -1.0, lambda X, Y: (0 * X, 9 * X))
    X, u = (np.concatenate(parts) for parts in zip(upper, lower, deep, strict=True))
    s_q = LOADED_AT - LENGTH + np.linspace(0.0, LENGTH, 601)
    gap_q = np.full(601, 0.5 * (LAW.g_peak + LAW.g_open))
    gap_q[1] = 3.0 * LAW.g_open  # broken faces are no part of the process zone
    return Snapshot(1.0, LOAD, s_q, gap_q, np.full(601, 1.5), np.zeros(601), X, u, np.zeros(X.shape[:3]))


def test_tilt_slip_and_pull_are_those_of_the_surfaces(snapshot):
    found = left_out((snapshot,), LAW, LOADED_AT, width=2.0)
    assert found.tilt == pytest.approx(TILT, rel=1e-12)
    gap = snapshot.gap_q[0]
    assert found.gap * LAW.g_open == pytest.approx(gap - (gap * np.cos(TILT) - SLIP * np.sin(TILT)), rel=1e-12)
    rise = 1.5 * (np.sqrt(1 + np.tan(TILT) ** 2) - 1) / np.tan(TILT) * LENGTH  # integral of 1.5 sin(turn)
    assert found.pull == pytest.approx(2.0 * rise / LOAD, rel=1e-5)
    assert left_out((replace(snapshot, load=0.0),), LAW, LOADED_AT).pull == 0.0, "no part of no load"


@pytest.mark.parametrize(("name", "loaded_at"), [("peel-60", 150.0), ("dcb-czm1", 0.0)])
def test_only_the_method_whose_interface_is_matched_has_something_to_say(snapshot, name, loaded_at):
    scene = load_scene(name)
    fields = replace(snapshot, s_q=np.abs(snapshot.s_q - LOADED_AT + loaded_at))
    result = Result("dolfinx", steps_from_rows([]), snapshots=(fields,))
    assert summary(prepare(scene, result.method), result)["tilt"] == pytest.approx(TILT, rel=1e-12)
    assert summary(prepare(scene, "nurbs"), result) == {}
    assert summary(prepare(scene, "dolfinx"), replace(result, snapshots=())) == {}


def test_without_a_search_the_surface_half_way_between_counts(snapshot):
    """The upper surface does not turn, so that half is left."""
    scene = load_scene("dcb-czm1", ["effects.search=false"])
    law = law_of(scene)
    gap_q, traction_q = np.full(601, 0.5 * (law.g_peak + law.g_open)), np.full(601, 0.5 * law.strength)
    fields = replace(snapshot, s_q=np.abs(snapshot.s_q - LOADED_AT), gap_q=gap_q, traction_q=traction_q, load=1e6)
    steps = {"opening": np.array([0.0, 1.0]), "load": np.array([0.0, 1.0])}
    (found,) = [one for one in of_run(scene, Result("nurbs", steps, snapshots=(fields,))) if one.key == "search"]
    change = gap_q[0] * (1 - np.cos(TILT / 2)) + SLIP * np.sin(TILT / 2)
    assert found.value == pytest.approx(2.0 * change / law.g_open, rel=1e-9) and not found.negligible
    assert f"tilts by up to {np.degrees(TILT / 2):.2g} degrees" in found.seen
    bare = replace(fields, X_euvi=np.zeros((0, 1, 1, 2)), u_euvi=np.zeros((0, 1, 1, 2)))
    for result in (Result("nurbs", steps, snapshots=(bare,)), Result("nurbs", steps)):
        assert [one.key for one in of_run(scene, result) if one.key == "search"] == []
