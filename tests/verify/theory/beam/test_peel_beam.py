"""The strip of a peel test as a beam on interface and substrate: identities, other routes to a number, limits."""

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_bvp

from iga.elements.elasticity import orthotropic
from verify.checks.identities import run_checks
from verify.curves.curve import curve_error, peak
from verify.methods import solve as methods
from verify.result import CURVE_COLUMNS, EVIDENCE_COLUMNS, steps_from_rows
from verify.scene.load import load_scene
from verify.theory.beam.arm import Arm
from verify.theory.beam.equilibrium import intact
from verify.theory.beam.path import Pace, follow
from verify.theory.beam.peeled_strip import Strip
from verify.theory.beam.problem import BeamProblem
from verify.theory.beam.rows import Units
from verify.theory.beam.solve import model, solve
from verify.theory.beam.substrate import Layer

REFERENCE = Path(__file__).parents[4] / "../shared/reference"
PEEL = Layer.of((120.0, 10.0), 5e3, 5e3, 5e3 / 2.4, 0.2)
B120 = BeamProblem(150.0, 2.0, 30.0, 1.0, 250e3, 250e3 / 2.4, 6.0, 0.1, 10.0, 1e3, opening=6.0, substrate=PEEL)
B120 = replace(B120, kinematics="finite", points=60)
B60 = replace(B120, precrack=90.0, opening=6.5)
SOFT = BeamProblem(60.0, 1.0, 25.0, 1.0, 50.0, 50.0 / 2.4, 0.2, 0.1, 10.0, 1e3, kinematics="finite", points=60)
SOFT = replace(SOFT, opening=30.0, substrate=Layer.of((40.0, 5.0), 5e3, 5e3, 5e3 / 2.4, 0.2))
SHORT = replace(B120, opening=0.8, points=30)
ALL = {"120": B120, "60": B60, "soft": SOFT, "linear": replace(SHORT, kinematics="linear")}


@cache
def solved(problem):
    return solve(problem)


def steps(problem):
    return steps_from_rows(solved(problem).rows)


def curve(problem):
    s = steps(problem)
    return s["opening"], s["load"]


@pytest.mark.parametrize("nu", [0.0, 0.2, 0.33])
@pytest.mark.parametrize("plane", ["stress", "strain"])
def test_layer_is_the_closed_form_of_an_isotropic_one(nu, plane):
    """Plane elasticity by stress functions, base clamped, surface free of shear; E is 5, the thickness 2."""
    G, kappa = 5.0 / (2 * (1 + nu)), (3 - nu) / (1 + nu) if plane == "stress" else 3 - 4 * nu
    layer = Layer.of((100.0, 2.0), 5.0, 5.0, G, nu, plane)
    for q in (0.05, 0.3, 0.8, 2.0, 4.9, 20.0):
        x = 2.0 * min(q, 50.0)
        cosh, sinh = np.cosh(2 * x), np.sinh(2 * x)
        sag = (kappa + 1) / (4 * G * q) * (kappa * sinh - 2 * x) / (kappa * cosh + 2 * x**2 + (1 + kappa**2) / 2)
        assert layer.stiffness(q) == pytest.approx(1 / sag, rel=1e-6)


@pytest.mark.parametrize("plane", ["stress", "strain"])
def test_layer_takes_the_elasticity_of_its_plane(plane):
    constants = {"E1": 120.0, "E2": 9.0, "G12": 5.0, "nu12": 0.3}
    layer, D = Layer.of((1.0, 1.0), **constants, plane=plane), orthotropic(**constants, plane=plane)
    assert (layer.C11, layer.C12, layer.C22, layer.C66) == pytest.approx((D[0, 0], D[0, 1], D[1, 1], D[2, 2]))


def test_parameters_are_the_tangent():
    k, g = PEEL.parameters(0.22)
    assert k + g * 0.22**2 == pytest.approx(PEEL.stiffness(0.22), rel=1e-12)
    assert g == pytest.approx((PEEL.stiffness(0.2201) - PEEL.stiffness(0.2199)) / (0.2201**2 - 0.2199**2), rel=1e-6)


def test_long_waves_feel_winkler_and_a_quarter_of_vlasov():
    """g = t C12 / 3 (1 - C12 / C66), by the energy of the first order fields; at nu = 0.2 that is C66 t / 3 over 4."""
    k, g = PEEL.parameters(1e-4)
    assert k == pytest.approx(5e3 / 0.96 / 10.0, rel=1e-6)
    assert g == pytest.approx(10.0 * PEEL.C12 / 3 * (1 - PEEL.C12 / PEEL.C66), rel=1e-5)
    assert g == pytest.approx(PEEL.C66 * 10.0 / 3 / 4, rel=1e-5)


@pytest.mark.parametrize("nu", [0.45, 0.4999])
def test_layers_that_hardly_contract_stay_stable(nu):
    layer = Layer.of((120.0, 10.0), 5e3, 5e3, 2.5e3 / (1 + nu), nu, "strain")
    for q in np.geomspace(1e-3, 10.0, 9):
        k, g = layer.parameters(q)
        assert k > 0.0 and g > 0.0


@pytest.mark.parametrize("nu", [0.2, 0.45, 0.4999])
@pytest.mark.parametrize("length", [1e-3, 25.4])
def test_parameters_of_a_layer_know_no_units(nu, length):
    """Where the tangent is taken and where the least coupling is."""
    elastic = {"E1": 5e3, "E2": 5e3, "G12": 2.5e3 / (1 + nu), "nu12": nu, "plane": "strain"}
    here, there = Layer.of((120.0, 10.0), **elastic), Layer.of((120.0 * length, 10.0 * length), **elastic)
    for q in np.geomspace(1e-3, 10.0, 9):
        (k, g), (k_there, g_there) = here.parameters(q), there.parameters(q / length)
        assert k_there == pytest.approx(k / length, rel=1e-9) and g_there == pytest.approx(g * length, rel=1e-9)


@pytest.mark.parametrize("finite", [False, True])
def test_derivative_of_the_rates(finite):
    strip, rng = Strip(Arm(0.24, 1 / 12, finite), 0.7, 1.3), np.random.default_rng(1)
    y, on = rng.normal(size=(50, 6)), rng.normal(size=(50, 3))
    shifts = 1e-6 * np.eye(6)
    numeric = [(strip.rates(y + e, on)[0] - strip.rates(y - e, on)[0]) / 2e-6 for e in shifts]
    np.testing.assert_allclose(strip.rates(y, on)[1], np.stack(numeric, axis=-1), rtol=1e-7, atol=1e-8)
    numeric = [(strip.gap(y + e)[0] - strip.gap(y - e)[0]) / 2e-6 for e in shifts]
    np.testing.assert_allclose(strip.gap(y)[1], np.stack(numeric, axis=-1), rtol=1e-7, atol=1e-8)


@pytest.mark.parametrize("name", ["short", *(pytest.param(name, marks=pytest.mark.slow) for name in ALL)])
def test_identities(name):
    """J is the area under the law less that at the far end, with what the edges of the substrate hold: to rounding."""
    problem = {"short": SHORT, **ALL}[name]
    found, s = solved(problem), steps(problem)
    assert found.status == "complete" and s["opening"][-1] == pytest.approx(problem.opening, rel=1e-12)
    assert set(s) <= {*CURVE_COLUMNS, *EVIDENCE_COLUMNS} and set(CURVE_COLUMNS) <= set(s)
    J = s["load"] * np.abs(s["face_slope_top"]) - s["face_energy"]
    area = problem.law.area(s["tip_opening"]) - problem.law.area(s["end_opening"])
    assert np.abs(J - area).max() < 1e-12 * problem.toughness
    assert np.all(s["face_slope_bottom"] == 0.0)
    gap = s["external_work"] - s["stored_energy"] - s["dissipated_energy"]
    assert np.abs(gap).max() < 1e-5 * s["external_work"][-1]
    assert np.abs(s["interface_force"] - s["load"]).max() < 1e-12 * s["load"].max()
    assert np.all(np.diff(s["dissipated_energy"]) >= 0.0) and np.all(np.diff(s["crack_length"]) >= -1e-12)


def test_the_edge_of_the_substrate_is_part_of_j():
    """At the start of a bond that begins there it is about half as much again, later nothing."""
    s = steps(SHORT)
    J = s["load"] * np.abs(s["face_slope_top"]) - s["face_energy"]
    share = s["face_energy"][1:] / J[1:]
    assert 0.3 < share[0] < 0.6 and abs(share[-1]) < 0.002


@pytest.mark.parametrize(("name", "limit"), [pytest.param("120", 0.005, marks=pytest.mark.slow), ("60", 0.001)])
def test_reference_curves(name, limit):
    """Two-dimensional fine-mesh curves; what is left of the first is the corner of the substrate."""
    path = REFERENCE / f"peel_gpa_{name}.csv"
    if not path.exists():
        pytest.skip(f"{path.name} is not there")
    reference = tuple(np.loadtxt(path, delimiter=",", skiprows=1)[:, :2].T)
    assert curve_error(curve(ALL[name]), reference, ALL[name].opening) < limit
    assert peak(curve(ALL[name]), steps(ALL[name])["load_slope"])[1] == pytest.approx(peak(reference)[1], rel=0.015)


@pytest.mark.parametrize("bond_at_edge", [False, True])
def test_elastic_stiffness_is_the_closed_form(bond_at_edge):
    """Timoshenko strip on interface and two-parameter layer that never end, by decaying exponentials.

    Before the bond the free surface of the layer has w ~ exp(sqrt(k / g) x), or ends where the bond begins.
    """
    base = replace(PEEL, length=300.0 if bond_at_edge else 380.0)
    problem = replace(
        B120, length=400.0, precrack=100.0, contact=False, kinematics="linear", opening=0.1, substrate=base
    )
    EI, GA, K, a = problem.bending, 5 / 6 * problem.shear * 2.0, problem.law.stiffness, 100.0
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
    assert steps(problem)["load_slope"][0] == pytest.approx(1 / tip, rel=1e-9)


@pytest.mark.parametrize("name", ["stiff", pytest.param("soft", marks=pytest.mark.slow)])
def test_growing_crack_is_that_of_another_solver(name):
    """The whole law in one boundary value problem by scipy, in the units of the scene, with the load unknown.

    Free and bonded part side by side on [0, 1]: 4 and 6 states. The substrate begins where the bond does.
    """
    soft = replace(SOFT, opening=24.7, points=30, substrate=replace(SOFT.substrate, length=35.0))
    problem = {"stiff": SHORT, "soft": soft}[name]
    m, units = model(problem), Units.of(problem)
    states = follow(m, intact(m), Pace(units.deflection(problem.opening), units.reference_load, 2.0 / problem.points))
    *_, state = (state for state in states if state is not None and not isinstance(state, str))
    h, EI, law, a = problem.arm_thickness, problem.bending, problem.law, problem.precrack
    EA, GA, bond = problem.young * h, 5 / 6 * problem.shear * h, problem.length - a
    k, g = problem.substrate.beneath(EI, law.stiffness)

    def strip(v, phi, V, M, p):
        sin, cos = np.sin(phi), np.cos(phi)
        stretch, shear = 1 + V * sin / EA, V * cos / GA
        along = stretch * cos - shear * sin
        return stretch * sin + shear * cos, M / EI, p, -V * along + p * h / 2 * sin

    def rates(t, y):
        w, T = y[8:]
        p = law.traction(y[4] + h / 2 * (1 - np.cos(y[5])) - w)
        free, bonded = strip(*y[:4], 0.0 * w), strip(*y[4:8], p)
        return np.stack([a * f for f in free] + [bond * f for f in (*bonded, T / g, k * w - p)])

    def ends(left, right):
        outer = left[0] - problem.opening, left[3], *right[6:8], right[9]
        return np.array([*outer, *(right[:4] - left[4:8]), left[9]])

    t = np.linspace(0.0, 1.0, 1001)
    size = np.array([h, 1.0, EI / h**2, EI / h, h, EI / h**2])[:, None]
    free, bonded = (state.field.at(x / h).T * size for x in (a * t, a + bond * t))
    guess = np.concatenate((free[:4], bonded)) * (1 + 0.02 * np.sin(9 * t))
    found = solve_bvp(rates, ends, t, guess, tol=1e-4, max_nodes=5000)
    assert found.status == 0
    assert -found.y[2, 0] == pytest.approx(solved(problem).rows[-1]["load"], rel=1e-7)
    crack = a + bond * np.interp(-law.g_open, -_gap(found.y, h), found.x)
    assert crack == pytest.approx(solved(problem).rows[-1]["crack_length"], rel=1e-4) and crack > 1.01 * a


def _gap(y, h):
    return y[4] + h / 2 * (1 - np.cos(y[5])) - y[8]


@pytest.mark.slow
def test_upright_strip_is_peeled_at_the_toughness():
    """load sin(theta) = G_Ic w as the crack grows, but for the strain energy of the loaded end."""
    s = steps(SOFT)
    upright = (np.abs(s["face_slope_top"]) > 0.98) & (s["crack_length"] > 25.0)
    assert upright.any()
    pull = s["load"] * np.abs(s["face_slope_top"]) - s["face_energy"]
    assert pull[upright] == pytest.approx(0.1, rel=1e-9)
    assert s["load"][-1] == pytest.approx(0.1, rel=2e-3)
    grows = s["crack_length"] > 25.0 + 2.0
    assert np.all(s["load"][grows] * np.abs(s["face_slope_top"][grows]) >= 0.1 * (1 - 1e-9))


@pytest.mark.slow
def test_on_a_rigid_base_it_is_half_a_dcb():
    """A mirror image of gap 2 v: twice the toughness and the opening, half the penalty."""
    rigid = replace(SHORT, kinematics="linear", opening=0.6, substrate=Layer.of((120.0, 10.0), 1e13, 1e13, 4e12, 0.2))
    dcb = replace(rigid, toughness=0.2, penalty=500.0, opening=1.2, substrate=None)
    a, b = steps(rigid), steps(dcb)
    assert curve_error((2 * a["opening"], a["load"]), (b["opening"], b["load"])) < 1e-4
    assert a["load_slope"][0] == pytest.approx(2 * b["load_slope"][0], rel=1e-6)


@pytest.mark.slow
@pytest.mark.parametrize("kinematics", ["linear", "finite"])
def test_runs_until_the_strip_comes_off(kinematics):
    problem = replace(B60, precrack=130.0, opening=60.0, kinematics=kinematics)
    found, s = solved(problem), steps(problem)
    assert found.status == "complete" and found.ending.startswith("separated at opening ")
    assert s["dissipated_energy"][-1] == pytest.approx(0.1 * 20.0, rel=0.02)
    assert s["load"][-1] <= 1e-3 * s["load"].max()
    assert np.any(np.diff(s["opening"][s["crack_length"] > 130.0]) < 0.0)  # by way of a snap-back
    gap = s["external_work"] - s["stored_energy"] - s["dissipated_energy"]
    assert np.abs(gap).max() < 1e-4 * s["external_work"].max()


@pytest.mark.parametrize(("metre", "newton"), [pytest.param(1e-3, 1.0, marks=pytest.mark.slow), (25.4, 1e-3)])
def test_units(metre, newton):
    stress = newton / metre**2
    base = Layer.of((120 * metre, 10 * metre), 5e3 * stress, 5e3 * stress, 5e3 / 2.4 * stress, 0.2)
    there = BeamProblem(
        150 * metre,
        2 * metre,
        30 * metre,
        metre,
        250e3 * stress,
        250e3 / 2.4 * stress,
        6 * stress,
        0.1 * newton / metre,
        10.0,
        1e3 * stress / metre,
        kinematics="finite",
        opening=0.8 * metre,
        points=30,
        substrate=base,
    )
    for name, unit in {"opening": metre, "load": newton, "external_work": newton * metre}.items():
        assert steps(there)[name] == pytest.approx(steps(SHORT)[name] * unit, rel=1e-9)


@pytest.mark.slow
def test_width_scales_the_load():
    a, b = steps(SHORT), steps(replace(SHORT, width=20.0))
    assert b["load"] == pytest.approx(20 * a["load"], rel=1e-9)
    assert b["face_energy"] == pytest.approx(a["face_energy"], rel=1e-9)


@pytest.mark.parametrize("method", ["beam", "lefm"])
def test_scenes_are_solved_and_checked(method):
    scene = load_scene("peel-120", ["load.opening=0.1"])
    result = methods.solve(scene, method)
    checks = run_checks(scene, result)
    assert result.complete and result.steps["crack_length"][0] == 30.0
    assert {"completed", "energy-ledger"} <= {check.name for check in checks} and all(check.passed for check in checks)
    if method == "beam":
        assert {"j-integral", "interface-force"} <= {check.name for check in checks}


@pytest.mark.parametrize("part", [0.2, 1.0, 5.0])
def test_a_layer_that_hardly_contracts_is_coupled_by_a_hundredth(part: float) -> None:
    """Of K / (1 / t^2 + q^2), which keeps its foundation stable; one that contracts has more by itself."""
    q, thickness = part / 10.0, 10.0
    soft, plain = Layer.of((120.0, thickness), 5e3, 5e3, 10.0, 0.2), PEEL
    for layer, least in ((soft, part < 5.0), (plain, False)):
        k, g = layer.parameters(q)
        K = layer.stiffness(complex(q)).real
        assert k + g * q**2 == pytest.approx(K, rel=1e-12) and k > 0.0
        share = g / (K / (thickness**-2 + q**2))
        assert (share == pytest.approx(0.01, rel=1e-9)) == least and share >= 0.01 * (1.0 - 1e-9)


@pytest.mark.parametrize(("part", "exact"), [(0.2, 504.597998049174), (5.0, 508.269973209), (50.0, 1142.05468085637)])
def test_a_thick_layer_that_shears_easily_is_as_stiff_as_in_exact_arithmetic(part: float, exact: float) -> None:
    """Waves that grow by e^1000 through the layer; the values are those of 1400 digits."""
    soft = Layer.of((120.0, 10.0), 5e3, 5e3, 10.0, 0.2)
    assert soft.stiffness(complex(part / 10.0)).real == pytest.approx(exact, rel=1e-9)


@pytest.mark.parametrize(("substrate", "edge"), [(120.0, 15.0), (149.0, 0.5), (150.0, 0.0), (170.0, 0.0)])
def test_a_substrate_ends_where_it_ends_and_not_beyond_the_loaded_end(substrate: float, edge: float) -> None:
    """In thicknesses of the strip, 2, from the loaded end of its length of 150."""
    ends = model(replace(B120, substrate=replace(PEEL, length=substrate))).ends
    assert (ends.edge, ends.precrack, ends.length) == pytest.approx((edge, 15.0, 75.0))
