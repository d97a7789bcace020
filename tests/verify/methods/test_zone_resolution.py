"""Length of the process zone: its formulas against other routes, elements counted in it, warnings, measurement."""

import json
import re
from dataclasses import replace

import numpy as np
import pytest

from verify.curves.of_run import cubics, distance
from verify.methods.mesh_choice import MESH_RULE
from verify.methods.method import Prepared
from verify.methods.names import METHODS, WITH_DOFS
from verify.methods.solve import prepare, solve
from verify.methods.zone_resolution import Zone, element_length, expected, measured, summary, warnings
from verify.result import Result
from verify.runs.run import run
from verify.scene.load import load_scene
from verify.scene.materials import Orthotropic
from verify.scene.process_zone import CANTILEVER, bulk_length, slender_factor, slender_length


def test_without_an_elastic_part_the_zone_is_that_of_the_cantilever():
    assert slender_factor(1e12) == pytest.approx(CANTILEVER, rel=1e-3)
    assert np.cosh(CANTILEVER) * np.cos(CANTILEVER) == pytest.approx(-1.0, rel=1e-12)
    factors = [slender_factor(d) for d in (1.0001, 1.01, 2.0, 12.5, 500.0, 1e6)]
    assert all(a < b for a, b in zip(factors, factors[1:], strict=False)) and factors[-1] < CANTILEVER


def test_a_long_beam_on_the_law_has_a_zone_of_the_length_that_the_formula_says():
    """By collocation on the whole of softening and elastic part, with no closed form."""
    from scipy.integrate import solve_bvp

    ductility, g_max = 12.5, 1.0 / 12.5
    k4 = (ductility - 1.0) / 4.0

    def right(s, y, x):  # both parts on s in [0, 1]: the softening one is x long, the elastic one 12
        soft = np.stack([y[1], y[2], y[3], y[0] - 1.0]) * x[0]
        elastic = np.stack([-y[5], -y[6], -y[7], 4.0 * k4 * y[4]]) * 12.0
        return np.concatenate([soft, elastic])

    def ends(a, b, x):
        return np.array([*(a[:4] - a[4:]), a[0] - g_max, b[0] - 1.0, b[3], b[4], b[5]])

    s = np.linspace(0, 1, 200)
    guess = np.zeros((8, 200))
    guess[0], guess[4] = g_max + (1 - g_max) * s**2, g_max * np.exp(-12 * s)
    found = solve_bvp(right, ends, s, guess, p=[1.0], tol=1e-8, max_nodes=20000)
    assert found.success and found.p[0] == pytest.approx(slender_factor(ductility), rel=1e-6)


@pytest.mark.parametrize(("name", "length"), [("dcb-czm1", 0.9), ("dcb-czm2", 0.7)])
def test_zones_of_the_paper(name, length):
    zone = expected(load_scene(name), "nurbs")
    assert zone.length == pytest.approx(zone.slender, rel=3e-3) == pytest.approx(length, rel=0.05)
    assert zone.bulk > 100 * zone.slender and zone.resolved


@pytest.mark.parametrize(("slender", "bulk"), [(1.427, 1.080), (1.0, 1e9), (1e9, 1.0)])
def test_the_zone_is_shorter_than_either_limit_and_comes_to_both(slender, bulk):
    length, least = Zone(slender, bulk, 0.1).length, min(slender, bulk)
    assert 0.5 * least <= length < least and length == Zone(bulk, slender, 0.1).length
    assert least > 1.05 or length == pytest.approx(1.0, rel=1e-8)


def test_a_steep_fall_behind_a_plateau_takes_more_elements():
    """Its error is more than that of straight softening on the same mesh, and within what the elements are said to be
    worth; that of exponential softening, which is steep at its onset, is not."""
    errors, zones = [], []
    for law in ("law=bilinear", "law=trapezoidal", "law=exponential-softening"):
        keys = [f"interface.{law}", "interface.plateau=0.8"][: 1 + ("trap" in law)]
        coarse, fine = (
            load_scene("dcb-czm1-linear", [*keys, "discretization.dofs=auto", f"discretization.in_a_zone={n}"])
            for n in (5, 20)
        )
        errors.append(distance(cubics(solve(coarse, "nurbs")), solve(fine, "nurbs")))
        zones.append(prepare(coarse, "nurbs").zone)
    n = [zone.elements for zone in zones]
    assert n[0] == n[2] == pytest.approx(3.0 * n[1]) and zones[0].resolved and not zones[1].resolved
    assert errors[1] > 4.0 * max(errors[0], errors[2])
    assert all(error < MESH_RULE.error / elements**2 for error, elements in zip(errors, n, strict=True))
    (said,) = warnings(prepare(load_scene("dcb-czm1-linear", ["interface.law=trapezoidal"]), "lagrange"))
    assert said.startswith("fall of the traction 0.51 mm spans 2.1 elements")


def test_the_modulus_of_a_bulky_body():
    scene, law = load_scene("dcb-czm1"), load_scene("dcb-czm1").interface
    assert bulk_length(scene) == pytest.approx(120e3 * law.toughness / law.strength**2)
    strain = scene.model_copy(update={"specimen": scene.specimen.model_copy(update={"plane": "strain"})})
    assert bulk_length(strain) == pytest.approx(bulk_length(scene) / (1 - 0.2**2))
    isotropic = Orthotropic(E1=120e3, E2=120e3, G12=50e3, nu12=0.2)
    assert bulk_length(scene.model_copy(update={"material": isotropic})) == pytest.approx(bulk_length(scene))
    fibres = Orthotropic(E1=120e3, E2=8e3, G12=5e3, nu12=0.3)
    ply = scene.model_copy(update={"material": fibres})
    # Sih, Paris, Irwin 1965, in the engineering constants
    modulus = (2 * 120e3 * 8e3 / (np.sqrt(120 / 8) - 0.3 + 120 / 10)) ** 0.5
    assert bulk_length(ply) == pytest.approx(modulus * law.toughness / law.strength**2)
    assert slender_length(ply) == pytest.approx(slender_length(scene))


@pytest.mark.parametrize("method", WITH_DOFS)
@pytest.mark.parametrize("rule", ["gauss", "lumped"])
def test_elements_are_those_of_the_mesh_maker(method, rule):
    """The crack path is divided into equal elements; of Lagrange ones all nodes are seen, three an element."""
    scene = load_scene("dcb-czm1", [f'discretization.interface_rule="{rule}"'])
    solver, problem = prepare(scene, method).problem
    specimen = solver.build(problem)
    start, end = specimen.layout.free_length, specimen.drawn.path_end
    assert start == 4.0 and 9.0 < end < 14.0
    if method == "lagrange":
        x = np.unique(np.round(specimen.meshes[0].P_AI[:, 0], 9))
        assert element_length(scene, method) == pytest.approx(3 * np.diff(x[(x >= start) & (x <= end)]).max())
    on_path = (end - start) / element_length(scene, method)
    assert on_path == pytest.approx(round(on_path), rel=1e-9) and 0 < on_path < specimen.meshes[0].elements


def test_a_mesh_is_made_once_for_what_is_prepared(monkeypatch):
    """That of a scene that is prepared again may have changed: files are read again."""
    scene, asked = load_scene("dcb-czm1", ["discretization.dofs=777"]), []

    def mesh(prepared):
        asked.append(prepared)
        raise ValueError("no mesh")

    prepared = Prepared(scene, replace(METHODS["nurbs"], mesh=mesh))
    assert np.isnan(prepared.element) and np.isnan(prepared.zone.elements) and asked == [prepared]
    assert np.isnan(replace(prepared).element) and len(asked) == 2


@pytest.mark.parametrize("method", ["beam", "lefm"])
def test_methods_without_a_mesh_have_nothing_to_warn_of(method):
    scene = load_scene("dcb-czm1", ["interface.strength=60"])
    assert np.isnan(element_length(scene, method)) and warnings(prepare(scene, method)) == ()


@pytest.mark.parametrize(("method", "few"), [("tspline", 300), ("nurbs", 600), ("lagrange", 1600)])
def test_a_mesh_that_is_too_coarse_is_warned_of_and_the_one_advised_is_not(method, few):
    (text,) = warnings(prepare(load_scene("dcb-czm2", ["discretization.dofs=160"]), method))
    assert text.startswith("process zone 0.73 mm < element ")
    (text,) = warnings(prepare(load_scene("dcb-czm2", [f"discretization.dofs={few}"]), method))
    assert re.match(r"process zone 0.73 mm spans 2\.\d elements of 0\.[23]\d* mm, fewer than 3", text)
    advised = int(re.search(r"discretization\.dofs = (\d+)", text)[1])
    assert few < advised < 2 * few
    assert warnings(prepare(load_scene("dcb-czm2", [f"discretization.dofs={advised}"]), method)) == ()


def test_the_printed_peel_test_has_a_zone_far_below_any_element():
    pytest.importorskip("iga.peel")
    (text,) = warnings(prepare(load_scene("peel-as-printed"), "nurbs"))
    assert text.startswith("process zone 0.014 mm < element 0.")
    assert warnings(prepare(load_scene("peel-120"), "nurbs")) == ()


def test_measured_over_the_steps_at_which_a_crack_runs():
    crack = np.array([4.0, 4.0, 4.5, 5.0, 5.5, 6.0, 6.5])
    front = np.array([4.0, 4.6, 5.4, 6.0, 6.4, 7.0, 7.0])
    steps = {"opening": np.arange(7.0), "load": np.ones(7), "crack_length": crack, "damage_front": front}
    assert measured(Result("nurbs", steps)) == pytest.approx(0.9)
    assert np.isnan(measured(Result("nurbs", {name: v[:2] for name, v in steps.items()})))
    assert np.isnan(measured(Result("nurbs", {name: v for name, v in steps.items() if name != "damage_front"})))
    found = summary(prepare(load_scene("dcb-czm1"), "nurbs"), Result("nurbs", steps))
    assert found["measured_elements"] / found["elements"] == pytest.approx(0.9 / found["estimate"])


def test_a_run_measures_what_was_estimated(tmp_path):
    """In the plane the arm shears as well, which makes the zone a little longer than that of the beam."""
    keys = ["load.opening=1.6", "discretization.steps=40", "effects.symmetry=true", "effects.kinematics='linear'"]
    scene = load_scene("dcb-czm1", [*keys, "discretization.dofs=1000"])
    result, _ = run(prepare(scene, "nurbs"), tmp_path)
    found = json.loads((tmp_path / "result.json").read_text())["process_zone"]
    assert 1.0 < found["measured"] / found["estimate"] < 1.15
    assert found["measured_elements"] == pytest.approx(found["measured"] / element_length(scene, "nurbs"))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "keys", "thick"),
    [
        ("alfano-crisfield", ["load.opening=2.3", "discretization.steps=60"], True),
        ("peel-60", ["load.opening=4.5", "discretization.dofs=3000"], False),
    ],
)
def test_zones_of_thick_and_of_slender_arms_are_as_estimated(name, keys, thick):
    """A thick arm has a zone of half the smaller limit: that one alone would call a mesh fine that is not."""
    scene = load_scene(name, keys)
    zone, length = expected(scene, "nurbs"), measured(solve(scene, "nurbs"))
    assert length == pytest.approx(zone.length, rel=0.2)
    assert (length < 0.6 * min(zone.slender, zone.bulk)) == thick
