"""Two arms on a bond that slides: identities at every step, J of the closed forms, friction, reference curves."""

from dataclasses import replace

import numpy as np
import pytest

from tests.verify.theory.arms.specimens import (
    ARM,
    DCB,
    ENF,
    LAW,
    SHARED,
    SLB,
    WIDTH,
    curve,
    dcb,
    moments,
    of_scene,
    solved,
    steps,
)
from verify.curves.curve import curve_error
from verify.methods.problems import arms_problem
from verify.methods.solve import prepare
from verify.scene.effects import simulated
from verify.scene.load import load_scene
from verify.support.refusal import Refusal
from verify.theory.arms.front import model
from verify.theory.arms.solve import first_state, solve
from verify.theory.law import Softened

RUBBED = replace(LAW, friction=0.4)


@pytest.mark.parametrize(("name", "peak"), [("enf_as4peek", 722.2), ("mmb50_as4peek", 253.9)])
@pytest.mark.parametrize(("order", "limit"), [(1, 0.004), pytest.param(3, 0.003, marks=pytest.mark.slow)])
def test_curves_of_fine_plane_meshes(name, peak, order, limit):
    """The rows of the files step over the peaks, which are of the same meshes.

    Of beams what is left is what they leave out, up to 0.9 % of the peak; of plane arms the falls.
    """
    file = SHARED / "reference" / "mixed" / f"{name}.csv"
    if not file.exists():
        pytest.skip(f"{file.name} is not there")
    reference = np.loadtxt(file, delimiter=",", skiprows=1)[:, :2].T
    problem = of_scene(name.replace("_", "-"), order=order, points=60)
    assert curve_error(curve(problem), tuple(reference), 0.999 * problem.programme[-1]) < limit
    assert curve(problem)[1].max() == pytest.approx(peak, rel=0.01 if order == 1 else 3e-3)


def test_friction_completes_in_a_few_hundred_steps_and_takes_its_part():
    """The load of sliding rises, part of the work is rubbed off, and nothing is cut again and again."""
    rubbed, plain = (replace(ENF, bond=bond) for bond in (RUBBED, ENF.bond))
    s = steps(rubbed)
    assert len(s["opening"]) < 300 and solved(rubbed).rejected_steps < 30
    assert s["load"].max() > 1.003 * steps(plain)["load"].max()
    assert 0.0 < s["friction_energy"][-1] < 0.2 * s["dissipated_energy"][-1]
    assert np.all(steps(plain)["friction_energy"] == 0.0)


@pytest.mark.parametrize("pair", [(1.0, -1.0), (1.0, 1.0)])
def test_moments_have_their_j(pair):
    """J = [21 (M1^2 + M2^2) - 6 M1 M2] / (4 b^2 h^3 E), whatever the zone."""
    s = steps(moments(*pair))
    m1, m2 = (side * s["load"] for side in pair)
    J = (21 * (m1**2 + m2**2) - 6 * m1 * m2) / (4 * WIDTH**2 * ARM.thickness**3 * ARM.young)
    assert s["J_loads"] == pytest.approx(J, rel=1e-4, abs=1e-6)
    assert s["J_bond"] == pytest.approx(J, rel=5e-3, abs=1e-3 * J.max())
    assert s["tip_opening"][-1] > 0.0 if pair[1] < 0 else abs(s["tip_slip"][-1]) > 0.0


@pytest.mark.parametrize("kinematics", ["linear", "finite"])
def test_a_double_cantilever_is_that_of_one_arm(kinematics):
    """A bond much softer than the arms, whose give at the root then is nothing: the same curve."""
    law = replace(LAW, strength=(4.0, 4.0), stiffness=(200.0, 200.0), toughness=(0.3, 0.3))
    two = replace(DCB, bond=law, opening=4.0, kinematics=kinematics)
    single = Softened(4.0, 0.3, 2 * 0.3 * 200.0 / 16.0, 1e5)
    keys = {"width": WIDTH, "zone": two.zone, "reach": two.reach, "kinematics": kinematics}
    one = dcb(single, ARM, 102.0, 30.0, 4.0, **keys)
    assert curve_error(curve(two), curve(one)) < 3e-3
    assert np.all(steps(two)["mode_ratio"] < 1e-12)


def test_small_deflections_of_finite_arms_are_linear():
    """The curves of both part with the deflection over the span."""
    both = [curve(replace(ENF, kinematics=kinematics)) for kinematics in ("linear", "finite")]
    assert 1e-5 < curve_error(both[1], both[0], 5.9) < 0.02


@pytest.mark.parametrize("problem", [replace(SLB, bond=replace(LAW, viscosity=0.1))])
def test_a_viscosity_is_refused(problem):
    with pytest.raises(Refusal, match="viscosity"):
        solve(problem)


@pytest.mark.parametrize("order", [3, 5])
def test_zones_of_contact_that_open_and_close_in_turn_come_to_rest(order: int) -> None:
    """Faces of a long precrack: full steps opened all of them, and closed them again, for ever."""
    problem = prepare(load_scene("plain-35", [f"beam.order={order}"]), "beam").problem
    assert first_state(model(problem), problem.programme[0]) is not None


def test_a_crack_grows_at_its_toughness_in_arms_that_give_much():
    """Compliant thick arms on a strong bond: under a plain foundation J is 2.5 G_IIc when the tip has the strength."""
    scene = load_scene("plain-35", ["load.opening=6.6"])
    rows = solve(replace(arms_problem(scene, simulated(scene), 1), points=75)).rows
    peak = max(rows, key=lambda row: row["load"])
    assert peak["J_bond"] == pytest.approx(scene.interface.shear_toughness, rel=0.05) and peak["opening"] < 6.3
