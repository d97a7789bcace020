"""A strip of order 1 that is peeled off a layer: closed forms, limits, and its end."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tests.verify.theory.arms.specimens import curve, dcb, ledger_error, peel, solved, steps
from verify.curves.curve import curve_error
from verify.theory.arms.problem import Arm
from verify.theory.arms.splines import Meshes
from verify.theory.arms.structure import Structure
from verify.theory.law import Softened
from verify.theory.layer import Layer

BOND = Softened(6.0, 0.1, 10.0, 1e3)
STRIP = Arm(2.0, 250e3, 250e3, 250e3 / 2.4)
BASE = Layer.of((120.0, 10.0), 5e3, 5e3, 5e3 / 2.4, 0.2)
SOFT_STRIP, SOFT_BASE = Arm(1.0, 50.0, 50.0, 50.0 / 2.4), replace(BASE, length=40.0, thickness=5.0)
SOFT = peel(replace(BOND, strength=0.2), SOFT_STRIP, SOFT_BASE, 60.0, 25.0, 30.0, kinematics="finite")


@pytest.mark.parametrize("bond_at_edge", [False, True])
def test_elastic_stiffness_is_the_closed_form(bond_at_edge):
    """Timoshenko strip on interface and two-parameter layer that never end, by decaying exponentials.

    Before the bond the free surface of the layer has w ~ exp(sqrt(k / g) x), or ends where the bond begins.
    """
    base, a = replace(BASE, length=300.0 if bond_at_edge else 380.0), 100.0
    s = steps(peel(replace(BOND, contact=False), STRIP, base, 400.0, a, 0.1))
    EI, GA, K = STRIP.young * 2.0**3 / 12, 5 / 6 * STRIP.shear * 2.0, BOND.stiffness
    k, g = base.beneath(EI, K)
    A = np.zeros((6, 6))  # v, rotation, V, M, w, w'
    A[0, 1], A[0, 2], A[1, 3], A[3, 2], A[4, 5] = 1.0, 1 / GA, 1 / EI, -1.0, 1.0
    A[2, 0], A[2, 4], A[5, 0], A[5, 4] = K, -K, -K / g, (k + K) / g
    rates, modes = np.linalg.eig(A)
    modes = modes[:, rates.real < 0]
    outside = 0.0 if bond_at_edge else np.sqrt(k / g)
    system = np.stack((modes[2], modes[3], modes[5] - outside * modes[4]))
    y = (modes @ np.linalg.solve(system, np.array([-1.0, a, 0.0]))).real  # unit load: V = -1, M = a at the tip
    tip = y[0] - y[1] * a + a**3 / (3 * EI) + a / GA
    assert s["load"][1] / s["opening"][1] == pytest.approx(1 / tip, rel=1e-5)


def test_an_upright_strip_is_peeled_at_the_toughness():
    """load sin(theta) = G_Ic w as the crack grows, but for the strain energy of the loaded end."""
    s = steps(SOFT)
    upright = (np.abs(s["face_slope_top"]) > 0.98) & (s["crack_length"] > 25.0)
    assert upright.any()
    pull = s["load"] * np.abs(s["face_slope_top"]) - s["face_energy"]
    assert pull[upright] == pytest.approx(0.1, rel=2e-3) and s["load"][-1] == pytest.approx(0.1, rel=3e-3)


def test_on_a_rigid_base_it_is_half_a_dcb():
    """A mirror image of gap 2 v: twice the toughness and the opening, half the penalty."""
    rigid = peel(BOND, STRIP, Layer.of((120.0, 10.0), 1e13, 1e13, 4e12, 0.2), 150.0, 30.0, 0.6)
    twice = Softened(6.0, 0.2, 10.0, 500.0)
    b = curve(dcb(twice, STRIP, 150.0, 30.0, 1.2, zone=rigid.zone))
    opening, load = curve(rigid)
    assert curve_error((2 * opening, load), b) < 3e-4
    assert load[1] / opening[1] == pytest.approx(2 * b[1][1] / b[0][1], rel=1e-5)


@pytest.mark.parametrize("kinematics", ["linear", "finite"])
def test_runs_until_the_strip_comes_off(kinematics):
    problem = peel(BOND, STRIP, BASE, 150.0, 130.0, 60.0, kinematics=kinematics)
    found, s = solved(problem), steps(problem)
    assert found.ending.startswith("separated at opening ") and ledger_error(problem) < 2e-3
    assert s["dissipated_energy"][-1] == pytest.approx(0.1 * 20.0, rel=0.02)
    assert s["load"][-1] <= 1e-3 * s["load"].max() or s["crack_length"][-1] > 149.5
    assert np.any(np.diff(s["opening"][s["crack_length"] > 130.0]) < 0.0), "by way of a snap-back"


@pytest.mark.parametrize("substrate", [120.0, 149.0, 150.0, 170.0])
def test_a_substrate_ends_where_it_ends_and_meets_no_bond_beyond_the_strip(substrate):
    problem = peel(BOND, STRIP, replace(BASE, length=substrate), 150.0, 30.0, 1.0)
    one = Structure.of(problem, Meshes(problem).finest)
    ends = one.mesh.ends
    assert np.isclose(ends, substrate).any() and ends[-1] == max(150.0, substrate)
    assert ends[1:][one.common].max() == pytest.approx(min(150.0, substrate))
