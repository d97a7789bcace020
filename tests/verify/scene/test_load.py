"""Scene files: what is taken, and what is refused with which words."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from odd_inputs import VALUES

from verify.scene.effects import end_rotation, simulated
from verify.scene.load import load_scene, packaged_scenes, verified_scenes
from verify.scene.materials import Isotropic, Orthotropic
from verify.scene.parse import SceneError, parse_scene
from verify.scene.schema import Scene
from verify.scene.specimens import SPECIMENS

#: Scene -> override -> every sentence of the refusal.
REFUSED: dict[str, dict[str, Any]] = tomllib.loads(Path(__file__).with_name("refused.toml").read_text())

PAPER_DCB = ("dcb-czm1", "dcb-czm1-linear", "dcb-czm2", "dcb-czm2-linear")
PAPER_PEEL = ("peel-60", "peel-80", "peel-100", "peel-120")

MINIMAL = """
[specimen]
kind = "dcb"
length = 14
arm_thickness = 0.2
precrack = 4
[material]
young = 120e3
poisson = 0.2
[interface]
strength = 4
toughness = 0.1
[load]
opening = 3
"""

#: What a file holds -> how the sentences of its refusal begin.
FILES = {
    b"": ["specimen: is missing", "interface: is missing", "load: is missing"],
    MINIMAL.replace("strength = 4", "").encode(): ["interface.strength: is missing, must be a number > 0"],
    MINIMAL.replace("[material]", "[strip]").encode(): [
        "material: is missing, must be a table of young, poisson, or of E1, E2, G12, nu12, nu23",
        "strip: must be left out",
    ],
    b"[specimen]\nkind = 'bend'\nstrip_length = 150\n[strip]\nyoung = 1\npoisson = 0\n": [
        'specimen.kind: must be "dcb", "peel", "4enf", "adcb", "delamination", "els", "enf", "mmb", "moments" or "slb"',
        "interface: is missing",
        "load: is missing",
    ],
    b"specimen = 'a.iga'": ["specimen: must be a table of kind", "interface", "load"],
    b"specimen = {kind = 'dcb', mesh = 5}\nload = {opening = 1}\ninterface = {strength = 1, toughness = 1}": [
        *(f"specimen.{key}: is missing" for key in ("length", "arm_thickness", "precrack")),
        "specimen.mesh: must be a file name, or a list of two, got 5",
    ],
    MINIMAL.replace("length = 14", 'mesh = "a\\u0000b.iga"\nlength = 14').encode(): [
        "specimen.mesh: must name files in the folder of the scene or below it"
    ],
    b"\xff\xfe\x00": ["is not a text in UTF-8"],
    b"a = " + b"9" * 5000: ["cannot be read: "],
    b"a = " + b"[" * 5000: ["cannot be read: "],
}


def sentences(source: str | Path, *overrides: str) -> tuple[str, ...]:
    with pytest.raises(SceneError) as caught:
        load_scene(source, overrides)
    return caught.value.sentences


@pytest.mark.parametrize(("name", "override"), [(name, one) for name, table in REFUSED.items() for one in table])
def test_a_broken_scene_is_refused_with_key_range_and_value(name, override):
    told = REFUSED[name][override]
    assert sentences(name, override, *["published=[]"] * ("as4peek" in name)) == tuple(
        [told] if isinstance(told, str) else told
    )


@pytest.mark.parametrize("content", FILES, ids=range(len(FILES)))
def test_a_file_that_is_no_scene_is_refused_with_what_is_wrong(content, tmp_path):
    (tmp_path / "odd.toml").write_bytes(content)
    found = sentences(tmp_path / "odd.toml")
    assert len(found) == len(FILES[content]) and all(map(str.startswith, found, FILES[content])), found


def test_places_that_hold_no_scene_are_refused(tmp_path):
    assert sentences(tmp_path) == ("cannot be read: Is a directory",) and sentences("a\0b")
    assert '"dcb-czm1"' in sentences("dcb-cmz1")[0]
    assert f"the packaged scenes are {', '.join(packaged_scenes())}" in sentences("zzz")[0]
    (tmp_path / "bad.toml").write_text("name = 'x'\n[specimen\nlength = 3\n")
    with pytest.raises(SceneError, match=r"bad\.toml:2:\n.*is not TOML"):
        load_scene(tmp_path / "bad.toml")


def test_everything_that_is_wrong_is_said_at_once():
    wrong = ["interface.strength=-4", "specimen.precrack=20", 'load.opening=[1.0, "x"]', "dolfinx.degree=0", "x"]
    keys = [sentence.split(":")[0] for sentence in sentences("dcb-czm1", *wrong)]
    assert keys == ["--set x", "specimen.precrack", "interface.strength", "load.opening[1]", "dolfinx.degree"]
    tables = ["load.opening=[1.0, 99]", "effects.symmetry=true", "discretization={mismatch=2.0, slave='lower'}"]
    keys = [sentence.split(":")[0] for sentence in sentences("dcb-czm1", *tables)]
    assert keys == ["load.opening[1]", "discretization.mismatch", "discretization.slave"]
    meshes = ('specimen.mesh="arm.iga"', "discretization.adaptive=true")
    assert sentences("dcb-czm1", *meshes)[0].startswith("discretization.adaptive: must be false with specimen.mesh")
    other = sentences("dcb-czm1", "material.E1=4.0")[-2:]
    assert [one.partition(",")[0] for one in other] == [
        f"material.{key}: is not a key of a scene" for key in ("young", "poisson")
    ]


def test_plane_strain_narrows_the_orthotropic_range():
    """In plane strain E3 = E2, and nu23 = nu12 where it is left out: for E1 = E2 the isotropic bounds -1 and 1/2."""
    for more, told in (("", "nu12: must be > -1 and < 0.5"), (", nu23=0.9", "nu23: must be > -1 and < 0.28")):
        override = f"material={{E1=1.0, E2=1.0, G12=1.0, nu12=0.6{more}}}"
        assert load_scene("dcb-czm1", [override]).material.nu12 == 0.6
        (said,) = sentences("dcb-czm1", override, "specimen.plane=strain")
        assert said.startswith(f"material.{told} in plane strain, got ")


def test_a_useful_scene_is_short(tmp_path):
    """What is left out is as the guide and `debond new` say."""
    (tmp_path / "mine.toml").write_text(MINIMAL)
    scene = load_scene(tmp_path / "mine.toml")
    assert scene.name == "mine" and scene.load.opening == (3.0,) and scene.interface.law == "bilinear"
    assert scene.interface.ductility == 12.5
    assert scene.interface.penalty == pytest.approx(1e5)  # a hundred initial stiffnesses of p_max / g_max = 1000
    found = scene.model_dump()
    auto = dict.fromkeys(("degree", "elements", "in_a_zone", "layers", "interface_points"), "auto")
    assert found["dolfinx"] == auto and found["published"] == ()
    assert found["discretization"] == {
        **dict.fromkeys(("dofs", "in_a_zone", "layers", "elements_width", "interface_points", "steps", "bend"), "auto"),
        **{"accuracy": 0.003, "degree": 3, "interface_rule": "gauss", "mismatch": 1.0, "adaptive": False},
        "slave": "upper",
    }
    assert found["effects"] == {
        **dict.fromkeys(("contact", "irreversible", "search"), True),
        **{"kinematics": "finite", "symmetry": False, "shear": "auto"},
    }
    assert found["pose"] == {"angle": 0.0, "mirror": False, "shift": (0.0, 0.0)}


@pytest.mark.parametrize("name", packaged_scenes())
def test_a_packaged_scene_is_valid_and_bears_the_name_of_its_file(name):
    scene = load_scene(name)
    assert scene.name == name and parse_scene(scene.model_dump()) == scene
    assert scene.units != type(scene).model_fields["units"].default, "its units are told"


def test_the_scenes_of_the_paper_are_packaged_and_verified():
    assert {*PAPER_DCB, *PAPER_PEEL, "peel-as-printed", "peel-soft"} <= set(packaged_scenes())
    assert set(verified_scenes()) == {*PAPER_DCB, "peel-120"}
    assert set(verified_scenes(full=True)) == {*PAPER_DCB, *PAPER_PEEL}
    for name in PAPER_DCB:
        scene = load_scene(name)
        assert scene.interface.strength == (4.0 if "czm1" in name else 6.0)
        assert scene.effects.kinematics == ("linear" if "linear" in name else "finite")


def test_overrides_are_toml_or_plain_text_and_a_scene_cannot_change():
    scene = load_scene("dcb-czm1", ["units=N, mm, GPa", "specimen.mesh=some arms.msh", 'name="a1"'])
    assert (scene.units, scene.specimen.mesh, scene.name) == ("N, mm, GPa", ("some arms.msh",), "a1")
    assert load_scene("dcb-czm1", "interface.strength=6") == load_scene("dcb-czm1", ["interface.strength=6"])
    turned = load_scene("dcb-czm1", ["load.opening=[1.0, 0.2, 3.0]"])
    assert parse_scene(turned.model_dump()) == turned
    with pytest.raises(Exception, match="frozen"):
        scene.interface.strength = 3.0


def test_automatic_kinematics_follows_the_rotation():
    scene = load_scene("dcb-czm1", ["effects.kinematics=auto"])
    small = load_scene("dcb-czm1", ["effects.kinematics=auto", "load.opening=0.1"])
    assert [simulated(one)["kinematics"] for one in (scene, small)] == ["finite", "linear"]
    # on the precrack theta = 3 Delta / (4 a); with the crack grown to 11.28 (by a^2 = 3/2 Delta sqrt(EI / wG)) 0.1994
    assert end_rotation(small) == pytest.approx(0.75 * 0.1 / 4)
    assert end_rotation(scene) == pytest.approx(0.1994, rel=1e-3)
    # E I = 166667, so sqrt(E I / (2 w G)) = 912.87: at opening 6 the free length is sqrt(18 * 912.87) = 128.2
    assert end_rotation(load_scene("peel-120")) == pytest.approx(9 / 128.186, rel=1e-4)
    assert end_rotation(load_scene("peel-60", ["load.opening=0.1"])) == pytest.approx(0.15 / 90)


values = VALUES | st.none() | st.just("peel")
tables = {name: getattr(field.annotation, "model_fields", {}) for name, field in Scene.model_fields.items()}
tables["specimen"] = {name: key for one in SPECIMENS.values() for name, key in one.model_fields.items()}
tables["material"] = tables["strip"] = tables["substrate"] = Isotropic.model_fields | Orthotropic.model_fields
places = [*tables, "nonsense", *(f"{table}.{key}" for table, keys in tables.items() for key in [*keys, "nonsense"])]


@settings(max_examples=100, deadline=None)
@given(st.lists(st.tuples(st.sampled_from(places), values), max_size=4))
def test_no_dictionary_raises_anything_but_a_scene_error(changes):
    raw: dict = tomllib.loads(MINIMAL)
    for place, value in changes:
        table, _, key = place.rpartition(".")
        target = raw if not table else raw.setdefault(table, {})
        if isinstance(target, dict):
            target[key] = value
    try:
        scene = parse_scene(raw)
    except SceneError as error:
        assert all(": " in sentence for sentence in error.sentences)
    else:
        assert scene == parse_scene(scene.model_dump())


@settings(max_examples=100, deadline=None)
@given(st.text(max_size=40))
def test_no_override_raises_anything_but_a_scene_error(text):
    try:
        load_scene("dcb-czm1", [text])
    except SceneError:
        pass
