"""Meshes that follow from process zone and accuracy."""

from __future__ import annotations

import numpy as np
import pytest

from iga.bases.names import BASES
from verify.methods.mesh_choice import MESH_RULE, crossed, size, splines_in_a_zone
from verify.methods.names import METHODS
from verify.methods.solve import prepare, solve
from verify.scene.load import load_scene
from verify.scene.process_zone import fading_length, zone_length
from verify.scene.schema import Scene

MESHED = [name for name, method in METHODS.items() if method.has_mesh]
SEEDS = range(12)


@pytest.mark.parametrize("method", MESHED)
@pytest.mark.parametrize("seed", SEEDS)
def test_every_mesh_resolves_the_zone_of_a_scene_that_leaves_its_numbers_out(seed, method):
    prepared = prepare(load_scene(f"plain-{seed}"), method)
    facts = prepared.mesh
    wanted = MESH_RULE.smooth * (BASES[method].in_a_zone if method in BASES else 1.0)
    assert facts is not None and prepared.zone.elements >= 0.95 * wanted
    assert 100 < facts.unknowns < 60_000


def test_splines_resolve_the_length_over_which_the_slip_on_an_intact_bond_fades():
    """J before a crack grows needs it: 0.8 % were left on ``plain-8`` by 7 elements in a zone of 3.9 such lengths."""
    scene = load_scene("plain-8")
    for method, through in (("nurbs", 1.0), ("tspline", 2.0)):  # elements through a T-mesh are twice as long
        assert fading_length(scene) >= 0.99 * MESH_RULE.fading * through * prepare(scene, method).element
    stiff = scene.model_copy(update={"interface": scene.interface.model_copy(update={"shear_stiffness": 1e18})})
    assert splines_in_a_zone(stiff) == MESH_RULE.finest and splines_in_a_zone(load_scene("plain-1")) == MESH_RULE.smooth


@pytest.mark.parametrize(("scene", "opening"), [("plain-34", 1e-3), ("plain-1", 5e-7)])
def test_the_first_stiffness_is_that_of_fine_meshes(scene, opening):
    """Arms deform at the tip of a crack with a short zone: both codes were 0.65 % too stiff on ``plain-34``, with one
    cubic layer through thick arms, and agreed. Before any growth the way of a crack is short, which says nothing of the
    arms: splines were 0.9 and 1.8 % too stiff on ``plain-1``."""
    few = ("discretization.steps=2", f"load.opening={opening}")
    fine = ("discretization.layers=6", "discretization.in_a_zone=14")
    exact, *found = (
        float(result.load[-1])
        for method, over in (("nurbs", fine), ("nurbs", ()), ("tspline", ()), ("dolfinx", ()))
        for result in [solve(load_scene(scene, [*few, *over]), method)]
    )
    assert np.allclose(found, exact, rtol=4e-3)


def test_thick_arms_on_a_long_zone_have_no_more_layers_than_their_elements_need():
    """Layers of T-splines were halved on and on, to fifteen million elements, as only unknowns stopped them."""
    prepared = prepare(load_scene("plain-13"), "tspline")
    assert prepared.mesh is not None and prepared.mesh.unknowns < 5000
    assert prepared.zone.elements < 4.0 * MESH_RULE.smooth


@pytest.mark.parametrize("method", MESHED)
def test_a_smaller_error_takes_shorter_elements(method):
    sizes = [
        prepare(load_scene("plain-4", [f"discretization.accuracy={accuracy}"]), method).zone.elements
        for accuracy in (0.003, 0.0005, 0.0002)
    ]
    # the error falls with the square of the elements in the zone, and is met by the least number at first
    assert sizes[0] < sizes[1] < sizes[2] and sizes[2] / sizes[1] == pytest.approx(2.5**0.5, rel=0.05)


def test_elements_are_short_where_the_crack_runs_alone():
    scene = load_scene("plain-4")
    made = prepare(scene, "dolfinx").problem.specimen()
    low, high = crossed(scene)
    middle, length = 0.5 * (made.X[1:] + made.X[:-1]), np.diff(made.X)
    on = (middle > low) & (middle < high)
    assert length[on].max() < 1.01 * prepare(scene, "dolfinx").zone.length / MESH_RULE.smooth
    assert length[~on].max() > 3.0 * length[on].max() and np.max(length[1:] / length[:-1]) < 1.5


def test_the_crack_stays_where_elements_are_short():
    scene = load_scene("plain-4")
    front = solve(scene, "nurbs").steps["damage_front"]
    low, high = crossed(scene)
    assert low < front.max() < high and front.max() > low + 0.5 * (high - low)


def test_the_way_of_the_crack_is_that_of_both_directions():
    """Turned round, an ENF is pulled open: to 64.8 at 5.4, against 48.8, with a shorter zone than where it slides."""
    forth, back, both = (
        load_scene("enf-as4peek", [f"load.opening={programme}"]) for programme in ("5.4", "-5.4", "[5.4, -5.4]")
    )
    assert crossed(forth)[1] < 64.8 < crossed(back)[1] == crossed(both)[1]
    assert zone_length(both) == zone_length(back) < 0.6 * zone_length(forth)
    pressed = load_scene("enf-as4peek", ["load.opening=[5.4, -0.5]"])
    assert zone_length(pressed) == zone_length(forth), "no crack grows on the way back"


@pytest.mark.parametrize(
    ("splines", "override", "words"),
    [
        (True, "discretization.dofs=2000", "4000 unknowns"),
        (True, "discretization.in_a_zone=5", "10 elements in a process zone"),
        (False, "dolfinx.elements=60", "120 elements along"),
        (False, "dolfinx.in_a_zone=4", "8 elements in a process zone"),
    ],
)
def test_twice_the_elements(splines, override, words):
    twice = size(load_scene("plain-4", [override]), splines).times(2.0)
    assert twice.words == words and size(load_scene("plain-4", [override, twice.override]), splines) == twice


def test_numbers_of_a_scene_are_taken_as_they_are():
    scene: Scene = load_scene("dcb-czm1")
    assert prepare(scene, "nurbs").problem[1].element is None
    assert scene.discretization.dofs == 1956 and prepare(scene, "dolfinx").problem.elements == 112
    assert splines_in_a_zone(scene) == MESH_RULE.smooth  # of a mesh that this scene does not ask for
