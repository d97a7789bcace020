"""Arms of order 3 and 5 are the plane solution: reference curves, pressed faces, identities of finite rotations."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from tests.verify.theory.arms.specimens import SHARED, curve, ledger_error, of_scene, steps
from verify.curves.curve import curve_error, load_at, peak


def reference(path: Path) -> tuple[np.ndarray, ...]:
    if not path.exists():
        pytest.skip(f"{path.name} is not there")
    return tuple(np.loadtxt(path, delimiter=",", skiprows=1)[:, :2].T)


@pytest.mark.parametrize(("order", "least", "most"), [(1, 5e-3, 2e-2), (3, 0.0, 1e-3), (5, 0.0, 6e-4)])
def test_stocky_arms_need_an_order_above_that_of_a_beam(order, least, most):
    fine = reference(SHARED / "stocky" / "stocky-linear.csv")
    problem = of_scene(SHARED / "stocky" / "stocky-linear.toml", order=order, points=60)
    assert least < curve_error(curve(problem), fine, 0.999 * problem.programme[-1]) < most


def test_pressed_faces_converge_with_the_order():
    """The load at an opening of -0.005 of two independent plane codes is -58.38: a concentrated contact under the load,
    which polynomials through the thickness come close to with their order, from the stiff side."""
    scene = SHARED / "trust" / "dcb-cyc.toml"
    if not scene.exists():
        pytest.skip(f"{scene.name} is not there")
    loads = []
    for order in (3, 5):
        s = steps(of_scene(scene, "load.opening=[1.2, -0.005]", order=order, points=40))
        assert s["opening"][-1] == pytest.approx(-0.005)
        loads.append(s["load"][-1])
    assert loads[0] < loads[1] < -58.38 and loads == pytest.approx([-58.38, -58.38], rel=0.015)


def test_a_cycle_ends_on_the_curve_of_one_leg():
    """Opened, pressed, opened, unloaded and opened again, of order 3."""
    there = 'specimen={kind="dcb", length=20.0, arm_thickness=1.0, precrack=8.0}', 'effects.kinematics="linear"'
    programme = "load.opening=[0.3, -0.005, 0.5, 0.2, 0.7]"
    keys = *there, "interface.strength=6.0", "interface.toughness=0.15"
    cycled, plain = (of_scene("dcb-czm1", *keys, one, order=3, points=40) for one in (programme, "load.opening=0.7"))
    s = steps(cycled)
    assert s["opening"][-1] == pytest.approx(0.7) and s["opening"].min() == pytest.approx(-0.005)
    assert s["load"][-1] == pytest.approx(steps(plain)["load"][-1], rel=2e-3) and ledger_error(cycled) < 1e-3


def test_unequal_arms_turn_until_their_loads_act_on_one_line():
    """The peak of a fine plane mesh is 59.468 [cross-code]; with an end that cannot turn it was 59.74."""
    found = peak(curve(of_scene("adcb-czmtestkit-b", "load.opening=8.7", order=1, points=40)))
    assert found[1] == pytest.approx(59.468, rel=1e-3)


def test_orders_agree_where_arms_are_slender():
    """Of the peak of the double cantilever of slender arms, to what beams leave out."""
    one, three = (curve(of_scene("dcb-czm1", 'effects.kinematics="linear"', order=n, points=60)) for n in (1, 3))
    at = np.array([0.3, 0.8, 2.0])
    assert load_at(one, at) == pytest.approx(load_at(three, at), rel=2e-3)
