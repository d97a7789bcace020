"""The table ``[uncertainty]``: both spellings, what it refuses, and that no run depends on it."""

from __future__ import annotations

import tomllib

import pytest

from verify.command_line.scenes.new import new_scene
from verify.runs.fingerprint import fingerprint
from verify.scene.keys import SPECIMENS, dotted_keys
from verify.scene.load import load_scene
from verify.scene.parse import SceneError, parse_scene
from verify.scene.schema import Scene

RAW = load_scene("dcb-czm1").model_dump()


def stated(toml: str, *overrides: str) -> Scene:
    return parse_scene(RAW | {"uncertainty": tomllib.loads(toml)}, overrides)


def test_keys_are_those_of_the_scene_with_or_without_quotation_marks():
    plain = stated("material.young = 0.02\ndata = { load = 0.005 }")
    quoted = stated('"material.young" = 0.02\n"data.load" = 0.005')
    assert plain == quoted and hash(plain) == hash(quoted)
    assert plain.uncertainty.inputs == {"material.young": 0.02}
    assert plain.uncertainty.data == {"data.load": 0.005, "data.opening": 0.0}


def test_one_is_replaced_on_the_command_line_and_what_is_written_is_read_again():
    scene = stated("material.young = 0.02\ninterface.toughness = 0.05")
    assert parse_scene(scene.model_dump()) == scene == parse_scene(scene.model_dump(mode="json"))
    other = parse_scene(scene.model_dump(), ["uncertainty.material.young=0.1"]).uncertainty
    assert other.inputs == {"material.young": 0.1, "interface.toughness": 0.05} and other.introduction


def test_two_arms_are_off_by_the_same_part_and_two_materials_have_no_such_key():
    two = load_scene("mmb50-as4peek", ["uncertainty.specimen.arm_thickness=0.01"])
    assert two.uncertainty.inputs == {"specimen.arm_thickness": 0.01}
    materials = {"material": [RAW["material"], RAW["material"]]}
    with pytest.raises(SceneError, match=r"uncertainty.material.young: must be that of a number"):
        parse_scene(load_scene("enf-as4peek").model_dump() | materials, ["uncertainty.material.young=0.02"])


def test_no_run_depends_on_it():
    assert fingerprint(stated("material.young = 0.02"), "nurbs") == fingerprint(load_scene("dcb-czm1"), "nurbs")


@pytest.mark.parametrize("kind", SPECIMENS)
def test_a_new_scene_shows_keys_that_are_taken(kind):
    head, table = new_scene(kind).split("[uncertainty]\n")
    shown = [line.removeprefix("# ") for line in table.splitlines() if line.startswith("# ") and " = 0.0" in line]
    lines = [line for line in shown if line.partition(" ")[0].count(".") == 1]
    scene = parse_scene(tomllib.loads("\n".join([head, "[uncertainty]", *lines])))
    assert {"interface.toughness"} < set(scene.uncertainty.inputs) and all(scene.uncertainty.data.values())
    assert {f"uncertainty.{key}" for key in scene.uncertainty.inputs} <= set(dotted_keys())
