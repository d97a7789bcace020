"""Arms of order 1 on a bond that opens alone: identities, other routes to a number, limits, curves, hard cases."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tests.verify.theory.arms.specimens import ENF, curve, dcb, ledger_error, solved, steps
from verify.curves.curve import curve_error, load_at
from verify.result import Snapshot
from verify.theory.arms.problem import Arm, ArmsProblem
from verify.theory.arms.solve import solve
from verify.theory.law import Softened

BOND = Softened(4.0, 0.1, 12.5, 1e5)
FREE = replace(BOND, contact=False)
SLENDER = Arm(0.2, 120e3, 120e3, 50e3)
EI, GA = 120e3 * 0.2**3 / 12.0, 5 / 6 * 50e3 * 0.2
SHORT = dcb(BOND, SLENDER)


def law(problem: ArmsProblem) -> Softened:
    assert isinstance(problem.bond, Softened)
    return problem.bond


def j_error(problem: ArmsProblem) -> float:
    """Worst deviation of J from the area under the law less that at the far end, of the toughness."""
    s = steps(problem)
    J = s["load"] * (np.abs(s["face_slope_top"]) + np.abs(s["face_slope_bottom"])) / problem.width - s["face_energy"]
    area = law(problem).area(s["tip_opening"]) - law(problem).area(s["end_opening"])
    return float(np.abs(J - area).max() / law(problem).toughness)


@pytest.mark.parametrize(
    ("strength", "kinematics", "loads"),
    [
        (4.0, "finite", (0.24263, 0.43483, 0.54954, 0.43618, 0.30878, 0.25261)),
        (6.0, "linear", (0.26017, 0.46937, 0.56197, 0.43480, 0.30725, 0.25079)),
    ],
)
def test_known_loads(strength, kinematics, loads):
    """Fine two-dimensional meshes, at openings 0.2, 0.4, 0.6, 1, 2, 3."""
    problem = dcb(replace(BOND, strength=strength), SLENDER, opening=3.0, kinematics=kinematics, points=150)
    assert load_at(curve(problem), [0.2, 0.4, 0.6, 1.0, 2.0, 3.0]) == pytest.approx(loads, rel=1.5e-3)


@pytest.mark.parametrize(("law", "end", "kinematics"), [(BOND, 1.0, "finite"), (FREE, 1.2, "linear")])
def test_j_is_the_area_under_the_law(law, end, kinematics):
    """Ever closer with smaller elements; less the area at the far end, where the zone feels it."""
    whole = dcb(law, SLENDER, length=14.0 if end == 1.0 else 9.0, opening=end, kinematics=kinematics)
    errors = [j_error(replace(whole, zone=whole.zone / n)) for n in (1, 2, 4)]
    assert errors[2] < 2e-4 and errors[2] < errors[0] / 8.0
    assert (np.abs(FREE.area(steps(whole)["end_opening"])).max() > 1e-3 * law.toughness) == (end == 1.2)


def test_elastic_stiffness_is_the_closed_form():
    """Timoshenko cantilever on a bilateral foundation that never ends (decaying exponentials), before any damage."""
    s, a, k = steps(dcb(FREE, SLENDER, length=40.0, opening=0.1)), 4.0, 2 * BOND.stiffness
    rates = np.roots([1.0, 0.0, -k / GA, 0.0, k / EI])  # v'''' EI - k EI / GA v'' + k v = 0
    rates = rates[rates.real < 0]
    phi = rates - k / (GA * rates)  # phi = v' - V / GA with V' = k v
    system = np.array([EI * phi * rates, k / rates])  # moment and force at the tip for amplitudes c
    c = np.linalg.solve(system, np.array([a, -1.0]))  # of a unit load: M = P a, V = -P
    tip = c.sum().real - (phi @ c).real * a + a**3 / (3 * EI) + a / GA
    assert s["load"][1:] / s["opening"][1:] == pytest.approx(1 / (2 * tip), rel=1e-6)


@pytest.mark.slow
def test_limit_of_infinite_strength_is_known():
    """Held at v = 0 but free to turn, the bonded arm gives opening = 2 P ((a + l)^3 - l^3) / (3 EI) and
    P_c = sqrt(G w EI) / (a + l) with l = sqrt(EI / GA): 0.49 h, less than chi h = 0.65 h, since a beam does not give
    way across its thickness. The distance falls with the process zone, as strength^(-1/2) or faster."""
    a = np.linspace(4.0, 14.0, 4000)
    more = np.sqrt(EI / GA)
    P = np.sqrt(0.1 * EI) / (a + more)
    limit = np.append(0.0, 2 * P * ((a + more) ** 3 - more**3) / (3 * EI)), np.append(0.0, P)
    curves = [curve(dcb(replace(FREE, strength=p), SLENDER, opening=1.5)) for p in (25.0, 100.0, 400.0)]
    errors = [curve_error(one, limit, 1.5) for one in curves]
    assert 2.0 < errors[0] / errors[1] < errors[1] / errors[2] < 4.0


def test_units():
    kinematics, metre, newton = "finite", 25.4, 1e-3
    stress = newton / metre**2
    there = dcb(
        Softened(4 * stress, 0.1 * newton / metre, 12.5, 1e5 * stress / metre),
        Arm(0.2 * metre, 120e3 * stress, 120e3 * stress, 50e3 * stress),
        14 * metre,
        4 * metre,
        metre,
        width=metre,
        kinematics=kinematics,
    )
    here, there_s = steps(dcb(BOND, SLENDER, kinematics=kinematics)), steps(there)
    units = {"opening": metre, "load": newton, "external_work": newton * metre, "crack_length": metre}
    for name, unit in units.items():
        assert there_s[name] == pytest.approx(here[name] * unit, rel=1e-6)


@pytest.mark.parametrize(
    "changes",
    [
        {"strength": 0.5},
        {"strength": 40.0},
        {"ductility": 1.1},
        {"ductility": 1e4},
        {"penalty": 1e2},
        {"contact": False},
        {"thickness": 0.014},
        {"precrack": 0.3},
        {"kinematics": "finite", "strength": 20.0},
    ],
    ids=str,
)
def test_hard_cases_complete(changes):
    of_law = {key: value for key, value in changes.items() if key in ("strength", "ductility", "penalty", "contact")}
    of_arm = {key: value for key, value in changes.items() if key == "thickness"}
    rest = {key: value for key, value in changes.items() if key in ("precrack", "kinematics")}
    problem = dcb(replace(BOND, **of_law), replace(SLENDER, **of_arm), **rest)
    assert steps(problem)["opening"][-1] == pytest.approx(1.0, rel=1e-12) and ledger_error(problem) < 1e-3


@pytest.mark.parametrize("stiffness", [1e4, 1e6])
def test_j_on_a_stiff_bond(stiffness):
    """Waves of the arms on the intact bond are much shorter than the process zone; elements of its fifth left 1.1 %."""
    law = Softened(6.0, 0.5, 2.0 * 0.5 * stiffness / 6.0**2, 1e5)
    assert j_error(dcb(law, Arm(2.0, 70e3, 70e3, 26.9e3), 100.0, 30.0, 3.5)) < 2e-3


@pytest.mark.parametrize("penalty", [1e6, 1e8])
def test_j_at_a_far_end_that_turns_on_contact(penalty):
    """The ligament is shorter than the zone; the spot of contact is as long as shear takes up its pressure."""
    assert j_error(dcb(replace(BOND, penalty=penalty), SLENDER, 4.7, opening=0.6)) < 5e-3


@pytest.mark.parametrize("order", [1, 3])
def test_runs_until_the_arms_come_apart(order):
    stiff = np.array([[126315.8, 31578.9, 0.0], [31578.9, 126315.8, 0.0], [0.0, 0.0, 50e3]])
    problem = dcb(BOND, replace(SLENDER, stiffness=stiff), length=7.0, opening=20.0, order=order, points=100)
    found, s = solved(problem), steps(problem)
    assert found.ending == f"separated at opening {s['opening'][-1]:.6g}"
    assert s["load"][-1] < 2e-3 * s["load"].max()
    assert s["dissipated_energy"][-1] == pytest.approx(0.1 * 3.0, rel=0.02)


def test_snapshots_show_the_law():
    problem = replace(SHORT, snapshot_openings=(0.1, 0.5, 1.0))
    snaps = [Snapshot(**snap) for snap in solved(problem).snapshots]
    assert np.all(np.array([s.opening for s in snaps]) >= np.array([0.1, 0.5, 1.0 - 1e-9]))
    for snap in snaps:
        assert np.all(np.diff(snap.s_q) > 0.0) and snap.X_euvi.shape[0] == 0
        np.testing.assert_allclose(snap.traction_q, BOND.traction(snap.gap_q), atol=4e-3)
        assert snap.damage_q.min() >= 0.0 and snap.damage_q.max() <= 1.0
    assert snaps[-1].damage_q[0] == 1.0 and snaps[0].damage_q.max() == 0.0


@pytest.mark.parametrize("kinematics", ["linear", "finite"])
def test_a_programme_that_unloads_follows_the_secant(kinematics):
    """Unloaded and loaded again the damage is frozen; in linear kinematics, where no faces touch, on a straight line to
    the origin, exactly. Loading goes on as if nothing had been."""
    programme = (1.2, 0.3, 2.0, 0.0, 3.0)
    without = dcb(FREE, SLENDER, opening=3.0, kinematics=kinematics)
    s, plain = steps(replace(without, opening=programme)), steps(without)
    opening, load = s["opening"], s["load"]
    ends = [0]
    for end in programme:
        met = np.flatnonzero(np.isclose(opening, end, rtol=1e-9, atol=1e-9))
        ends.append(int(met[met > ends[-1]][0]))
    assert abs(load[ends[4]]) < 1e-9 * load.max()
    for top, low in ((ends[1], ends[2]), (ends[3], ends[4])):
        inside = slice(top, low + 1)
        secant = load[top] / opening[top] * opening[inside]
        off = np.abs(load[inside] - secant).max() / load[top]
        assert off < (1e-9 if kinematics == "linear" else 2e-2) and np.all(np.diff(opening[inside]) < 0.0)
        assert s["dissipated_energy"][low] == pytest.approx(s["dissipated_energy"][top], rel=1e-12)
    last = slice(ends[4], None)
    new = opening[last] > 2.05
    loads = np.interp(opening[last][new], plain["opening"], plain["load"])
    assert (
        load[last][new] == pytest.approx(loads, rel=2e-3) and ledger_error(replace(without, opening=programme)) < 1e-3
    )


def there_and_back(problem: ArmsProblem) -> np.ndarray:
    """Loads on the way back over those on the way there, less one, at openings between."""
    s = steps(problem)
    d, P, turn = s["opening"], s["load"], int(np.argmax(s["opening"]))
    at = np.linspace(d[-1], d[turn], 9)[1:-1]
    return np.interp(at, d[turn:][::-1], P[turn:][::-1]) / np.interp(at, d[: turn + 1], P[: turn + 1]) - 1.0


@pytest.mark.parametrize(
    "problem",
    [replace(SHORT, opening=(1.5, 0.4)), pytest.param(replace(ENF, opening=(5.5, 4.5)), marks=pytest.mark.slow)],
)
def test_a_bond_that_heals_goes_back_the_way_it_came(problem):
    """Progress falls there; damage that only grows leads away from the programme."""
    heals = replace(problem.bond, irreversible=False)
    assert np.abs(there_and_back(replace(problem, bond=heals))).max() < 2e-3
    assert there_and_back(problem).min() < -0.05


def test_arms_are_pressed_by_a_programme_that_closes():
    """From rest, and through rest with damage; then contact bears far more than the bond did."""
    programme = (-0.01, 0.5, -0.01, 0.8)
    s = steps(dcb(BOND, SLENDER, opening=programme))
    opening, load = s["opening"], s["load"]
    pressed, pulled = opening < -1e-6, opening > 1e-6
    assert np.all(load[pressed] < 0.0) and (load / np.where(pressed, opening, np.inf)).max() > 2.0 * np.max(
        load[pulled] / opening[pulled]
    )
    last = np.flatnonzero(pressed)[-1]
    assert opening[last] > -0.01 and opening[pressed].min() == pytest.approx(-0.01) and np.any(pulled[:last])
    new = (opening > 0.55) & (np.arange(len(opening)) > last)
    assert load[new] == pytest.approx(np.interp(opening[new], *curve(dcb(BOND, SLENDER, opening=0.8))), rel=1e-3)


@pytest.mark.parametrize("opening", [(1.0, 1.0, 3.0), 0.0])
def test_legs_of_no_length_are_refused(opening):
    with pytest.raises(ValueError, match="load.opening"):
        solve(replace(SHORT, opening=opening))
