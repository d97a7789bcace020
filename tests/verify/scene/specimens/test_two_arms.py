"""Specimens whose bond slides: where loads and supports are, and when shear is simulated."""

import pytest

from verify.scene.effects import simulated
from verify.scene.load import load_scene
from verify.scene.parse import parse_scene

SHEAR = ("interface.shear_strength=5.0", "interface.shear_toughness=0.2")


def test_patches_are_half_an_arm_long_on_either_side_and_cut_off_at_the_ends():
    body = load_scene("enf-codeaster", ["specimen.overhang=[0.5, 45.0]"]).specimen
    (load,), (left, right) = body.loads, body.supports
    assert (load.body, load.side, load.share, load.extent) == (0, "top", -1.0, (48.75, 52.25))
    assert (left.extent, right.extent) == ((0.0, 2.25), (98.75, 102.25)) and left.body == right.body == 1
    assert body.bonded == (30.5, 145.5) and body.loaded_at == 0.5 and body.free_length == 30.0


def test_the_bond_ends_with_the_arms_whatever_rounding_makes_of_the_overhangs():
    body = load_scene("enf-as4peek", ["specimen.length=115.6", "specimen.overhang=5.82", "published=[]"]).specimen
    assert body.start + (body.lengths[0] - body.start) != body.lengths[0], "nothing to be learnt from these numbers"
    assert body.bonded[1] == body.lengths[0]


def test_a_lever_pulls_up_and_presses_down():
    up, down = load_scene("mmb50-as4peek").specimen.loads
    assert (up.share, down.share) == pytest.approx((44.4 / 51.0, -95.4 / 51.0))


def test_a_moment_that_bends_upwards_is_clockwise_on_the_left_face():
    loads = load_scene("moments", ["specimen.moments=[2.0, -1.0]"]).specimen.loads
    assert [(load.body, load.share, load.couple) for load in loads] == [(0, -2.0, True), (1, 1.0, True)]


def test_loads_of_its_own_are_held_or_balance():
    table = 'specimen={{kind="delamination", length=100.0, arm_thickness=1.5, precrack=30.0, loads={}, supports={}}}'
    up, down = '{body="upper", side="left", share=1}', '{body="lower", side="left", share=-1}'
    held = '[{body="both", side="right"}, {body="both", side="right", couple=true}]'
    scene = load_scene("enf-as4peek", [table.format(f"[{up}]", held), "published=[]"])
    assert parse_scene(scene.model_dump()) == scene and scene.specimen.supports[1].couple
    assert load_scene("enf-as4peek", [table.format(f"[{up}, {down}]", "[]"), "published=[]"]).specimen.supports == ()


@pytest.mark.parametrize(
    ("name", "more", "slides"),
    [
        ("enf-as4peek", (), True),
        ("dcb-czm1", SHEAR, False),
        ("dcb-czm1", (*SHEAR, "interface.viscosity=0.01"), True),
        ("dcb-czm1", (*SHEAR, "effects.shear=true"), True),
        ("dcb-czm1", (), False),
        ("peel-60", SHEAR, True),
    ],
)
def test_shear_is_simulated_where_something_slides(name, more, slides):
    assert simulated(load_scene(name, more))["shear"] is slides
