"""The cohesive beam: identities, independent routes to the same number, limits, reference curves, hard cases."""

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from scipy.linalg import expm
from scipy.optimize import brentq

from verify.curves.curve import curve_error, hermite, load_at, peak
from verify.result import CURVE_COLUMNS, EVIDENCE_COLUMNS, Snapshot, steps_from_rows
from verify.theory.beam import equilibrium
from verify.theory.beam import path as front
from verify.theory.beam.arm import Arm
from verify.theory.beam.problem import BeamProblem
from verify.theory.beam.solve import solve
from verify.theory.lefm import LefmProblem
from verify.theory.lefm import solve as solve_lefm

REFERENCE = Path(__file__).parents[4] / "../shared/reference"
CZM1 = BeamProblem(14.0, 0.2, 4.0, 1.0, 120e3, 50e3, 4.0, 0.1, 12.5, 1e5, opening=3.0)
SHORT = replace(CZM1, opening=1.0, points=60)
SCENES = {
    f"czm{i}_{kinematics}": replace(CZM1, strength=strength, kinematics=kinematics)
    for i, strength in ((1, 4.0), (2, 6.0))
    for kinematics in ("linear", "finite")
}


@cache
def solved(problem):
    return solve(problem)


def steps(problem):
    return steps_from_rows(solved(problem).rows)


def curve(problem):
    s = steps(problem)
    return s["opening"], s["load"]


def j_error(problem):
    """Worst deviation of J from the area under the law, relative to the toughness."""
    s = steps(problem)
    J = s["load"] * (np.abs(s["face_slope_top"]) + np.abs(s["face_slope_bottom"])) / problem.width - s["face_energy"]
    return np.abs(J - problem.law.area(s["tip_opening"])).max() / problem.toughness


def ledger_error(problem):
    s = steps(problem)
    return np.abs(s["external_work"] - s["stored_energy"] - s["dissipated_energy"]).max() / s["external_work"][-1]


@pytest.mark.parametrize(("name", "limit"), [(name, 0.0005 if "linear" in name else 0.0006) for name in SCENES])
def test_reference_curves(name, limit):
    """Two-dimensional fine-mesh curves; what is left is what a beam leaves out."""
    path = REFERENCE / f"dcb_{name}.csv"
    if not path.exists():
        pytest.skip(f"{path.name} is not there")
    reference = np.loadtxt(path, delimiter=",", skiprows=1)[:, :2].T
    assert curve_error(curve(SCENES[name]), tuple(reference)) < limit
    s = steps(SCENES[name])
    fine_peak = peak(tuple(reference))
    assert peak(curve(SCENES[name]), s["load_slope"])[1] == pytest.approx(fine_peak[1], rel=2e-3)


@pytest.mark.parametrize(
    ("name", "loads"),
    [
        ("czm1_finite", (0.24263, 0.43483, 0.54954, 0.43618, 0.30878, 0.25261)),
        ("czm1_linear", (0.24245, 0.43391, 0.54800, 0.43519, 0.30737, 0.25088)),
        ("czm2_finite", (0.26036, 0.47039, 0.56269, 0.43582, 0.30866, 0.25253)),
        ("czm2_linear", (0.26017, 0.46937, 0.56197, 0.43480, 0.30725, 0.25079)),
    ],
)
def test_known_loads(name, loads):
    """Fine two-dimensional meshes, at openings 0.2, 0.4, 0.6, 1, 2, 3."""
    assert load_at(curve(SCENES[name]), [0.2, 0.4, 0.6, 1.0, 2.0, 3.0]) == pytest.approx(loads, rel=1.5e-3)


@pytest.mark.parametrize("name", SCENES)
def test_identities(name):
    problem = SCENES[name]
    found, s = solved(problem), steps(problem)
    assert found.status == "complete" and s["opening"][-1] == pytest.approx(3.0, rel=1e-12)
    assert set(s) <= {*CURVE_COLUMNS, *EVIDENCE_COLUMNS} and set(CURVE_COLUMNS) <= set(s)
    assert ledger_error(problem) < 1e-6
    assert np.abs(s["interface_force"] - s["load"]).max() < 1e-12 * s["load"].max()
    assert np.all(np.diff(s["dissipated_energy"]) >= 0.0) and np.all(np.diff(s["crack_length"]) >= -1e-12)
    assert np.all(np.diff(s["tip_opening"]) > 0.0)


@pytest.mark.parametrize("name", SCENES)
def test_j_identity_holds_to_rounding_away_from_the_far_end(name):
    problem = replace(SCENES[name], opening=1.5, length=20.0)
    assert j_error(problem) < 1e-12


def test_j_identity_with_the_energy_of_the_far_end():
    """Where the zone feels the free end, J is the area up to the tip minus the area at that end: exact again."""
    problem = replace(CZM1, contact=False, opening=4.5, snapshot_openings=(4.5,))
    s, last = steps(problem), solved(problem).snapshots[-1]
    J = s["load"][-1] * 2 * abs(s["face_slope_top"][-1]) - s["face_energy"][-1]
    end = np.polynomial.Polynomial.fit(last["s_q"][-8:], last["gap_q"][-8:], 7)(14.0)
    assert abs(end) > 1e-4 and abs(J / 0.1 - 1) > 1e-3
    assert J == pytest.approx(0.1 - float(problem.law.area(end)), rel=1e-9)


def test_elastic_stiffness_is_the_closed_form():
    """Timoshenko cantilever on a bilateral foundation that never ends (decaying exponentials), before any damage."""
    problem = replace(CZM1, contact=False, length=40.0, opening=0.1)
    EI, GA, a = problem.bending, 5 / 6 * 50e3 * 0.2, 4.0
    k = 2 * problem.law.stiffness
    s = np.roots([1.0, 0.0, -k / GA, 0.0, k / EI])
    s = s[s.real < 0]  # v'''' EI - k EI / GA v'' + k v = 0
    phi = s - k / (GA * s)  # phi = v' - V / GA with V' = k v
    system = np.array([EI * phi * s, k / s])  # moment and force at the tip for amplitudes c
    c = np.linalg.solve(system, np.array([a, -1.0]))  # of a unit load: M = P a, V = -P
    v, rotation = (c.sum()).real, (phi @ c).real
    tip = v - rotation * a + a**3 / (3 * EI) + a / GA
    slope = steps(problem)["load_slope"]
    assert slope[0] == pytest.approx(1 / (2 * tip), rel=1e-9)
    assert slope == pytest.approx(slope[0], rel=1e-9)


def test_softening_state_is_the_closed_form():
    """A propagating state rebuilt from its zones by matrix exponentials: another route, by transfer matrices."""
    problem = replace(SHORT, contact=False, length=7.0, snapshot_openings=(0.9,))
    s, snap = steps(problem), solved(problem).snapshots[0]
    i = int(np.argmin(np.abs(s["opening"] - snap["opening"])))
    law, EI, GA = problem.law, problem.bending, 5 / 6 * 50e3 * 0.2
    tip = s["crack_length"][i]

    def across(length, k, c):
        A = np.zeros((5, 5))
        A[0, 1], A[0, 2], A[1, 3], A[3, 2] = 1.0, 1 / GA, 1 / EI, -1.0
        A[2, 0], A[2, 4] = k, c
        return expm(A * length)

    def rebuilt(front):
        """Deflections at the crack tip and at the end, and the load, where the front is at ``front``."""
        arm = across(tip, 0.0, 0.0)
        first = across(front - tip, 2 * law.softening, -law.softening * law.g_open) @ arm
        whole = across(7.0 - front, 2 * law.stiffness, 0.0) @ first
        rows = np.stack((whole[2], whole[3], first[0] - [0, 0, 0, 0, law.g_peak / 2]))  # no force, no moment, g_peak
        v, rotation, force = np.linalg.solve(rows[:, :3], -rows[:, 4])
        return (arm @ [v, rotation, force, 0.0, 1.0])[0], v, -force

    near = float(np.interp(-law.g_peak, -snap["gap_q"], snap["s_q"]))  # to the spacing of the snapshot
    front = brentq(lambda x: rebuilt(x)[0] - law.g_open / 2, near - 0.03, near + 0.03, xtol=1e-14)
    _, v0, P = rebuilt(front)
    assert P == pytest.approx(s["load"][i], rel=1e-7)
    assert 2 * v0 == pytest.approx(s["opening"][i], rel=1e-7)


@pytest.mark.parametrize("finite", [False, True])
def test_derivative_of_the_rates(finite):
    """Against central differences, at states bent far beyond any specimen."""
    arm, rng = Arm(0.24, 1 / 12, finite), np.random.default_rng(1)
    y, on = rng.normal(size=(50, 4)), rng.normal(size=(50, 3))
    step = 1e-6 * np.eye(4)
    numeric = [(arm.rates(y + e, on)[0] - arm.rates(y - e, on)[0]) / 2e-6 for e in step]
    np.testing.assert_allclose(arm.rates(y, on)[1], np.stack(numeric, axis=-1), rtol=1e-7, atol=1e-8)


@pytest.mark.parametrize("name", ["czm1_linear", "czm2_finite"])
def test_slope_is_that_of_the_path(name):
    """The exact slopes against a path of other steps, through Hermite cubics of order four."""
    at = np.linspace(0.05, 0.99, 100)
    loads = []
    for points in (60, 400):
        s = steps(replace(SCENES[name], opening=1.0, points=points))
        loads.append(hermite(s["opening"], s["load"], s["load_slope"], at))
    assert loads[0] == pytest.approx(loads[1], rel=2e-5)
    straight = load_at((s["opening"], s["load"]), at)
    assert np.abs(loads[0] - loads[1]).max() < np.abs(straight - loads[1]).max()


def test_small_openings_of_the_finite_beam_are_linear():
    differences = []
    for scale in (1.0, 0.1, 0.01):  # the same cohesive process at ever smaller openings: stiffness up, law fixed
        both = [
            replace(
                SHORT,
                young=120e3 / scale,
                shear=50e3 / scale,
                strength=4.0,
                toughness=0.1 * scale,
                opening=scale,
                kinematics=kinematics,
            )
            for kinematics in ("linear", "finite")
        ]
        differences.append(curve_error(curve(both[1]), curve(both[0])))
    assert differences[0] > 1e-4
    assert differences[1] < 0.02 * differences[0] and differences[2] < 0.02 * differences[1]


def lefm_curve(theory, kinematics="linear"):
    problem = LefmProblem(14.0, 0.2, 4.0, 1.0, 120e3, 120e3, 50e3, 0.1, 3.0, kinematics=kinematics, theory=theory)
    s = steps_from_rows(solve_lefm(problem).rows)
    return s["opening"], s["load"]


@pytest.mark.parametrize(("kinematics", "theory"), [("linear", "corrected"), ("finite", "factors")])
def test_strength_leads_to_lefm(kinematics, theory):
    """Closer with every rise of the strength; a beam stops short of it, see the limit of its own below."""
    limit = lefm_curve(theory, kinematics)
    errors, peaks = [], []
    for strength in (4.0, 10.0, 25.0, 60.0):
        problem = replace(CZM1, strength=strength, kinematics=kinematics, points=60)
        errors.append(curve_error(curve(problem), limit))
        peaks.append(peak(curve(problem))[1])
    assert np.all(np.diff(errors) < 0.0) and errors[-1] < 0.25 * errors[0]
    assert np.all(np.diff(peaks) > 0.0) and peaks[-1] < limit[1].max()


def test_limit_of_infinite_strength_is_known():
    """Held at v = 0 but free to turn, the bonded arm gives opening = 2 P ((a + l)^3 - l^3) / (3 EI) and
    P_c = sqrt(G w EI) / (a + l) with l = sqrt(EI / GA): 0.49 h, less than chi h = 0.65 h, since a beam does not give
    way across its thickness. The distance falls with the process zone: as strength^(-1/2) where bending governs it, at
    last as strength^(-1), where shear does."""
    EI, a = CZM1.bending, np.linspace(4.0, 14.0, 4000)
    more = np.sqrt(EI / (5 / 6 * 50e3 * 0.2))
    P = np.sqrt(0.1 * EI) / (a + more)
    limit = np.append(0.0, 2 * P * ((a + more) ** 3 - more**3) / (3 * EI)), np.append(0.0, P)
    rigid = replace(CZM1, contact=False, points=60)
    errors = [curve_error(curve(replace(rigid, strength=s)), limit, 3.0) for s in (25.0, 100.0, 400.0, 1600.0)]
    ratios = np.divide(errors[:-1], errors[1:])
    assert 2.0 < ratios[0] < ratios[1] < ratios[2] < 4.0 and errors[-1] < 0.003


def test_flexible_arms_reach_the_peel_load():
    s = steps(replace(CZM1, arm_thickness=0.014, opening=8.0, kinematics="finite", points=60))
    assert s["load"][-1] == pytest.approx(0.05, rel=1e-3) and abs(s["face_slope_top"][-1]) > 0.99


@pytest.mark.parametrize(("metre", "newton"), [(1e-3, 1.0), (25.4, 1e-3)])
@pytest.mark.parametrize("kinematics", ["linear", "finite"])
def test_units(metre, newton, kinematics):
    stress = newton / metre**2
    here = replace(SHORT, kinematics=kinematics)
    there = BeamProblem(
        14 * metre,
        0.2 * metre,
        4 * metre,
        metre,
        120e3 * stress,
        50e3 * stress,
        4 * stress,
        0.1 * newton / metre,
        12.5,
        1e5 * stress / metre,
        kinematics=kinematics,
        opening=metre,
        points=60,
    )
    units = {"opening": metre, "load": newton, "external_work": newton * metre, "crack_length": metre}
    for name, unit in units.items():
        assert steps(there)[name] == pytest.approx(steps(here)[name] * unit, rel=1e-9)


def test_width_scales_the_load():
    a, b = steps(SHORT), steps(replace(SHORT, width=20.0))
    assert b["load"] == pytest.approx(20 * a["load"], rel=1e-9)
    assert b["face_energy"] == pytest.approx(a["face_energy"], rel=1e-9)


@pytest.mark.parametrize(
    "changes",
    [
        {"strength": 0.5},
        {"strength": 1.0},
        {"strength": 200.0},
        {"ductility": 1.01},
        {"ductility": 1e4},
        {"penalty": 1e2},
        {"penalty": 1e6},
        {"penalty": 1e8},
        {"strength": 17783.0},
        {"arm_thickness": 0.014},
        {"precrack": 0.3},
        {"kinematics": "finite", "strength": 40.0},
        {"contact": False},
    ],
    ids=str,
)
def test_hard_cases_complete(changes):
    problem = replace(SHORT, **changes)
    assert solved(problem).status == "complete" and ledger_error(problem) < 1e-5
    assert steps(problem)["opening"][-1] == pytest.approx(1.0, rel=1e-12)


def test_an_arm_whose_zones_are_not_found_stops_with_what_to_change(monkeypatch):
    monkeypatch.setattr(equilibrium, "settle", lambda *given: None)
    found = solve(SHORT)
    assert found.status.startswith("stopped: the zones of contact of the undamaged arm were not found")
    assert "interface.strength" in found.status and len(found.rows) == 1 and found.rows[0]["load"] == 0.0


def test_penalty_no_longer_matters_when_it_is_stiff():
    errors = [
        curve_error(curve(replace(CZM1, penalty=p, points=60)), curve(replace(CZM1, penalty=1e8, points=60)))
        for p in (1e3, 1e4, 1e5, 1e6)
    ]
    assert np.all(np.diff(errors) < 0.0) and errors[1] < 1.5e-3 and errors[2] < 3e-4 and errors[3] < 5e-5


def test_published_dcb():
    """Alfano and Crisfield (2001), strength 57 and 1.7: peaks 61.5 to 62 +- 3 and 49.5 to 50.9 N."""
    dcb = BeamProblem(100.0, 1.5, 30.0, 20.0, 135300.0, 5200.0, 57.0, 0.28, 50.0, 1e5, opening=5.0, points=60)
    assert peak(curve(dcb))[1] == pytest.approx(62.0, abs=3.0)
    assert 49.5 < peak(curve(replace(dcb, strength=1.7)))[1] < 50.9


def test_runs_until_the_arms_come_apart():
    problem = replace(CZM1, opening=20.0, points=100)
    found, s = solved(problem), steps(problem)
    assert found.status == "complete" and found.ending == f"separated at opening {s['opening'][-1]:.6g}"
    assert s["load"][-1] < 2e-3 * s["load"].max()
    assert s["dissipated_energy"][-1] == pytest.approx(0.1 * 10.0, rel=0.02)


def test_what_cannot_be_landed_on_is_stepped_over(monkeypatch):
    """The path goes on as it would have, past the opening that was to be met and not far from it."""
    (opening, load), settle_again = curve(SHORT), front.resettle

    def never(m, state, guess, control):
        return None if control.front is None else settle_again(m, state, guess, control)

    monkeypatch.setattr(front, "resettle", never)
    passed = solve(SHORT)
    path = steps_from_rows(passed.rows)
    assert passed.status == "complete" and 1.0 <= path["opening"][-1] < 1.2 and np.all(np.diff(path["opening"]) > 0.0)
    inside = opening < 1.0
    assert np.interp(opening[inside], path["opening"], path["load"]) == pytest.approx(load[inside], rel=0.01)


def test_reversible_stores_what_damage_costs():
    a, b = steps(SHORT), steps(replace(SHORT, irreversible=False))
    assert np.all(b["dissipated_energy"] == 0.0)
    assert b["stored_energy"] == pytest.approx(a["stored_energy"] + a["dissipated_energy"], rel=1e-9, abs=1e-15)
    assert b["load"] == pytest.approx(a["load"], rel=1e-12)


def test_snapshots_show_the_law():
    problem = replace(SHORT, snapshot_openings=(0.1, 0.5, 1.0))
    snaps = [Snapshot(**snap) for snap in solved(problem).snapshots]
    assert np.all(np.array([s.opening for s in snaps]) >= (0.1, 0.5, 1.0 - 1e-9))
    for snap in snaps:
        assert np.all(np.diff(snap.s_q) > 0.0) and snap.X_euvi.shape[0] == 0
        np.testing.assert_allclose(snap.traction_q, problem.law.traction(snap.gap_q), atol=4e-4)
        assert snap.damage_q.min() >= 0.0 and snap.damage_q.max() <= 1.0
    assert snaps[-1].damage_q[0] == 1.0 and snaps[0].damage_q.max() == 0.0


def test_tells_of_every_row_as_it_goes():
    heard = []
    found = solve(SHORT, heard.append)
    assert tuple(heard) == found.rows and heard[0]["load"] == 0.0 and heard[0]["crack_length"] == 4.0


@pytest.mark.parametrize("opening", [(1.0, 0.2, 3.0), (-1.0,), 0.0])
def test_refuses_unloading(opening):
    with pytest.raises(ValueError, match="load.opening"):
        solve(replace(CZM1, opening=opening))
