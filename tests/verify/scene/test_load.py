"""Scene files: what is taken, and what is refused with which words."""

from __future__ import annotations

import tomllib
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from verify.scene.effects import end_rotation, simulated
from verify.scene.laws import known
from verify.scene.load import load_scene, packaged_scenes, verified_scenes
from verify.scene.materials import Isotropic, Orthotropic
from verify.scene.parse import SceneError, parse_scene
from verify.scene.schema import Scene
from verify.scene.specimens import SPECIMENS
from verify.support.refusal import one_of

#: The scenes of the paper, which are verified where none is named.
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

#: override -> the sentence that must come
#: The kinds of specimens, in a refusal.
KINDS = '"dcb", "peel", "4enf", "adcb", "delamination", "els", "enf", "mmb", "moments" or "slb"'
BROKEN = {
    "interface.strength=-4": "interface.strength: must be > 0, got -4",
    'interface.strength="4"': "interface.strength: must be a number > 0, got '4'",
    "interface.strength=true": "interface.strength: must be a number > 0, got true",
    "interface.strength=nan": "interface.strength: must be a number > 0, got nan",
    "interface.toughness=inf": "interface.toughness: must be a number > 0, got inf",
    "interface.ductility=1": "interface.ductility: must be > 1, got 1",
    "interface.penalty=0": "interface.penalty: must be > 0, got 0",
    "interface.law=no-such-law": f"interface.law: must be {one_of(known())}, got 'no-such-law'",
    "interface.strenght=6": (
        'interface.strenght: is not a key of a scene, got 6; did you mean "strength" or "shear_strength"?'
    ),
    "interfce.strength=6": "interfce: is not a key of a scene, got {'strength': 6}; did you mean \"interface\"?",
    "specimen.kind=bend": f"specimen.kind: must be {KINDS}, got 'bend'",
    "specimen.precrack=14": "specimen.precrack: must be < specimen.length = 14, got 14",
    "specimen.plane=flat": 'specimen.plane: must be "stress" or "strain", got \'flat\'',
    "material.poisson=0.5": "material.poisson: must be > -1 and < 0.5, got 0.5",
    "material={E1=4.0, E2=1.0, G12=1.0, nu12=2.0}": (
        "material.nu12: must be > -2 and < 2, that is |nu12| < sqrt(E1/E2), got 2"
    ),
    "material={E1=4.0, E2=1.0, G12=1.0}": "material.nu12: is missing, must be a number",
    "load.opening=0": "load.opening: must be different from the opening before it (the first one: from 0), got 0",
    "load.opening=[]": "load.opening: must be a number, or a list of at least one number, got []",
    "load.opening=[1.0, 1.0]": (
        "load.opening[1]: must be different from the opening before it (the first one: from 0), got 1"
    ),
    "load.opening=[1.0, -0.3, 1.5]": (
        "load.opening[1]: must be >= -0.2 (-arm_thickness, at which both loaded faces would be in one place) and <= 28 "
        "(2 length), got -0.3"
    ),
    'load.opening=[1.0, "x"]': "load.opening[1]: must be a number, got 'x'",
    "effects.kinematics=large": 'effects.kinematics: must be "linear", "finite" or "auto", got \'large\'',
    "effects.symmetry=1": 'effects.symmetry: must be true, false or "auto", got 1',
    "discretization.degree=6": "discretization.degree: must be >= 1 and <= 5, got 6",
    "discretization.degree=3.0": "discretization.degree: must be an integer >= 1 and <= 5, got 3.0",
    "discretization.interface_points=13": (
        'discretization.interface_points: must be an integer >= 1 and <= 12, or "auto", got 13'
    ),
    'discretization={interface_rule="lobatto", interface_points=1}': (
        "discretization.interface_points: must be an integer from 2 to 12 for the lobatto rule, got 1"
    ),
    "discretization={adaptive=true, mismatch=1.5}": (
        "discretization.mismatch: must be 1 with discretization.adaptive, whose arms are alike, got 1.5"
    ),
    "discretization.interface_rule=simpson": (
        'discretization.interface_rule: must be "gauss", "lobatto" or "lumped", got \'simpson\''
    ),
    "discretization.steps=0": 'discretization.steps: must be an integer >= 1 and <= 100000, or "auto", got 0',
    "discretization.steps=true": 'discretization.steps: must be an integer >= 1 and <= 100000, or "auto", got true',
    "discretization.steps=automatic": (
        "discretization.steps: must be an integer >= 1 and <= 100000, or \"auto\", got 'automatic'"
    ),
    "discretization.mismatch=0.01": "discretization.mismatch: must be >= 0.05 and <= 20, got 0.01",
    "discretization.slave=top": 'discretization.slave: must be "upper" or "lower", got \'top\'',
    "pose.angle=400": "pose.angle: must be >= -360 and <= 360, got 400",
    "pose.mirror=1": "pose.mirror: must be true or false, got 1",
    "pose.shift=1e4": "pose.shift: must be a list of two numbers, got 10000",
    "pose.shift=[1.0]": "pose.shift: must be a list of two numbers, got [1.0]",
    'pose.shift=[1.0, "x"]': "pose.shift[1]: must be a number, got 'x'",
    "dolfinx.degree=5": 'dolfinx.degree: must be an integer >= 1 and <= 4, or "auto", got 5',
    "dolfinx=3": "dolfinx: must be a table of degree, elements, in_a_zone, layers, interface_points, got 3",
    "units=3": "units: must be a text, got 3",
    "load.opening=1,5": "--set load.opening=1,5: the value must be TOML, like 6, true or [1.0, 0.2], got '1,5'",
    'name="a': "--set name=\"a: the value must be TOML, like 6, true or [1.0, 0.2], got '\"a'",
    "name=../up": (
        "name: must be 1 to 80 letters, digits, dots, dashes and underscores, a letter or digit first, got '../up'"
    ),
    "interface.strength": '--set interface.strength: must be KEY=VALUE with a dotted key, like "interface.strength=6"',
    "a b=3": '--set a b=3: must be KEY=VALUE with a dotted key, like "interface.strength=6"',
}


def test_text_needs_no_quotes_where_a_key_takes_text_alone() -> None:
    changed = ["units=N, mm, GPa", "specimen.mesh=some arms.msh", 'name="a1"']
    scene = load_scene("dcb-czm1", changed)
    assert (scene.units, scene.specimen.mesh, scene.name) == ("N, mm, GPa", ("some arms.msh",), "a1")


def test_a_single_override_needs_no_list() -> None:
    assert load_scene("dcb-czm1", "interface.strength=6") == load_scene("dcb-czm1", ["interface.strength=6"])


#: the same for a peel
BROKEN_PEEL = {
    "specimen.bond_length=130.0": "specimen.bond_length: must be <= specimen.substrate_length = 120, got 130",
    "specimen.strip_length=120.0": "specimen.bond_length: must be < specimen.strip_length = 120, got 120",
    "specimen.precrack=4.0": (
        "specimen.precrack: is not a key of a scene, got 4.0; the keys here are kind, strip_length, strip_thickness, "
        "substrate_length, substrate_thickness, bond_length, width, plane, mesh"
    ),
    "material={young=1.0, poisson=0.2}": (
        "material: must be left out: the materials of a peel are strip and substrate, "
        "got {'young': 1.0, 'poisson': 0.2}"
    ),
    "strip.young=-1": "strip.young: must be > 0, got -1",
    "substrate.poison=0.2": 'substrate.poison: is not a key of a scene, got 0.2; did you mean "poisson"?',
    'specimen.mesh="strip.iga"': "specimen.mesh: must be two files, of strip and substrate, got ['strip.iga']",
    "discretization.adaptive=true": "discretization.adaptive: must be false for a peel, got true",
    "discretization.layers=2": "discretization.layers: must be 1 for a peel, whose lower body is graded, got 2",
    "effects.search=false": "effects.search: must be true for a peel: strip and substrate turn, got false",
    "effects.symmetry=true": "effects.symmetry: must be false for a peel: strip and substrate differ, got true",
    "load.opening=301": "load.opening: must be >= -4 (-2 strip_thickness) and <= 300 (2 strip_length), got 301",
}


def sentences(source: str | Path, *overrides: str) -> tuple[str, ...]:
    with pytest.raises(SceneError) as caught:
        load_scene(source, overrides)
    return caught.value.sentences


def minimal(folder: Path) -> Path:
    path = folder / "mine.toml"
    path.write_text(MINIMAL)
    return path


def test_a_useful_scene_is_short(tmp_path: Path) -> None:
    scene = load_scene(minimal(tmp_path))
    assert scene.name == "mine"
    assert scene.load.opening == (3.0,)
    assert scene.interface.penalty == pytest.approx(1e5)  # a hundred initial stiffnesses of p_max / g_max = 1000
    assert scene.discretization.steps == "auto"


@pytest.mark.parametrize("name", packaged_scenes())
def test_a_packaged_scene_is_valid_and_bears_the_name_of_its_file(name: str) -> None:
    scene = load_scene(name)
    assert scene.name == name and parse_scene(scene.model_dump()) == scene
    assert scene.units != type(scene).model_fields["units"].default, "its units are told"


def test_the_scenes_of_the_paper_are_packaged_and_verified() -> None:
    assert {*PAPER_DCB, *PAPER_PEEL, "peel-as-printed", "peel-soft"} <= set(packaged_scenes())
    assert set(verified_scenes()) == {*PAPER_DCB, "peel-120"}
    assert set(verified_scenes(full=True)) == {*PAPER_DCB, *PAPER_PEEL}
    for name in PAPER_DCB:
        scene = load_scene(name)
        assert scene.interface.strength == (4.0 if "czm1" in name else 6.0)
        assert scene.effects.kinematics == ("linear" if "linear" in name else "finite")


@pytest.mark.parametrize("override", BROKEN)
def test_a_broken_scene_is_refused_with_key_range_and_value(override: str) -> None:
    assert sentences("dcb-czm1", override) == (BROKEN[override],)


@pytest.mark.parametrize("override", BROKEN_PEEL)
def test_a_broken_peel_is_refused_with_key_range_and_value(override: str) -> None:
    assert sentences("peel-120", override) == (BROKEN_PEEL[override],)


def test_each_kind_of_specimen_has_its_own_materials(tmp_path: Path) -> None:
    strip = "strip={young=1.0, poisson=0.2}"
    (said,) = sentences("dcb-czm1", strip)
    assert said.startswith("strip: must be left out: the materials of a dcb are material, got")
    path = minimal(tmp_path)
    path.write_text(MINIMAL.replace("[material]", "[strip]"))
    assert [s.split(":")[:2] for s in sentences(path)] == [
        ["material", " is missing, must be a table of young, poisson, or of E1, E2, G12, nu12, nu23"],
        ["strip", " must be left out"],
    ]
    peel = load_scene("peel-120")
    assert peel.material is None and peel.strip.young == 250e3 and peel.substrate.young == 5e3


def test_mismatched_meshes_need_two_arms() -> None:
    assert sentences("dcb-czm1", "effects.symmetry=true", "discretization.mismatch=1.37") == (
        "discretization.mismatch: must be 1 with effects.symmetry, which models the upper arm alone, got 1.37",
    )


def test_given_meshes_are_taken_as_they_are() -> None:
    assert sentences("dcb-czm1", 'specimen.mesh="arm.iga"', "discretization.adaptive=true") == (
        "discretization.adaptive: must be false with specimen.mesh, which is taken as it is, got true",
    )


def test_everything_that_is_wrong_is_said_at_once() -> None:
    wrong = ["interface.strength=-4", "specimen.precrack=20", "load.opening=[1.0, 99, 99]", "dolfinx.degree=0", "x"]
    keys = [sentence.split(":")[0] for sentence in sentences("dcb-czm1", *wrong)]
    assert keys == ["--set x", "specimen.precrack", "interface.strength", "load.opening[2]", "dolfinx.degree"]


def test_keys_of_the_other_material_are_refused() -> None:
    assert sentences("dcb-czm1", "material.E1=4.0")[-2:] == (
        "material.young: is not a key of a scene, got 120000.0; the keys here are E1, E2, G12, nu12, nu23",
        "material.poisson: is not a key of a scene, got 0.2; the keys here are E1, E2, G12, nu12, nu23",
    )


def test_a_missing_key_is_named_with_its_range(tmp_path: Path) -> None:
    path = minimal(tmp_path)
    path.write_text(MINIMAL.replace("strength = 4", ""))
    assert sentences(path) == ("interface.strength: is missing, must be a number > 0",)


def test_an_empty_file_is_no_scene() -> None:
    assert [s.split(":")[0] for s in sentences("/dev/null")] == ["specimen", "interface", "load"]


def test_another_specimen_is_refused_by_its_kind_alone(tmp_path: Path) -> None:
    path = tmp_path / "bend.toml"
    path.write_text(
        '[specimen]\nkind = "bend"\nstrip_length = 150\n[strip]\nyoung = 1\n[interface]\nstrength = 6\ntoughness = 1\n'
    )
    kind, load = sentences(path)
    assert kind == f"specimen.kind: must be {KINDS}, got 'bend'"
    assert load.startswith("load: is missing")


def test_a_syntax_error_names_file_and_line(tmp_path: Path) -> None:
    path = tmp_path / "bad.toml"
    path.write_text("name = 'x'\n[specimen\nlength = 3\n")
    with pytest.raises(SceneError, match=r"bad\.toml:2:\n.*is not TOML"):
        load_scene(path)


def test_a_misspelt_scene_gets_a_suggestion() -> None:
    assert '"dcb-czm1"' in sentences("dcb-cmz1")[0]
    assert f"the packaged scenes are {', '.join(packaged_scenes())}" in sentences("zzz")[0]


@pytest.mark.parametrize("content", [b"\xff\xfe\x00", b"a = " + b"9" * 5000, b"a = " + b"[" * 5000])
def test_files_that_no_parser_likes_are_refused(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "odd.toml"
    path.write_bytes(content)
    assert sentences(path)


def test_unreadable_places_are_refused(tmp_path: Path) -> None:
    assert sentences(tmp_path) == ("cannot be read: Is a directory",)
    assert sentences("a\0b")


def test_plane_strain_narrows_the_orthotropic_range() -> None:
    """In plane strain E3 = E2 and nu23 = nu12: for E1 = E2 the isotropic bounds -1 and 1/2."""
    override = "material={E1=1.0, E2=1.0, G12=1.0, nu12=0.6}"
    assert load_scene("dcb-czm1", [override]).material.nu12 == 0.6
    assert sentences("dcb-czm1", override, "specimen.plane=strain") == (
        "material.nu12: must be > -1 and < 0.5 in plane strain, got 0.6",
    )


def test_a_scene_cannot_change() -> None:
    with pytest.raises(Exception, match="frozen"):
        load_scene("dcb-czm1").interface.strength = 3.0


def test_a_scene_survives_being_written_down() -> None:
    scene = load_scene("dcb-czm1", ["load.opening=[1.0, 0.2, 3.0]"])
    assert parse_scene(scene.model_dump()) == scene


def test_automatic_kinematics_follows_the_rotation() -> None:
    scene = load_scene("dcb-czm1", ["effects.kinematics=auto"])
    assert simulated(scene)["kinematics"] == "finite"
    small = load_scene("dcb-czm1", ["effects.kinematics=auto", "load.opening=0.1"])
    assert simulated(small)["kinematics"] == "linear"
    # on the precrack theta = 3 Delta / (4 a); with the crack grown to 11.28 (by a^2 = 3/2 Delta sqrt(EI / wG)) 0.1994
    assert end_rotation(small) == pytest.approx(0.75 * 0.1 / 4)
    assert end_rotation(scene) == pytest.approx(0.1994, rel=1e-3)


def test_rotation_of_a_peeled_strip() -> None:
    """E I = 166667, so sqrt(E I / (2 w G)) = 912.87: at opening 6 the free length is sqrt(18 * 912.87) = 128.2."""
    assert end_rotation(load_scene("peel-120")) == pytest.approx(9 / 128.186, rel=1e-4)
    assert end_rotation(load_scene("peel-60", ["load.opening=0.1"])) == pytest.approx(0.15 / 90)


values = st.recursive(
    st.none()
    | st.booleans()
    | st.integers()
    | st.floats()
    | st.text(max_size=8)
    | st.just(10**400)
    | st.just("dcb")
    | st.just("peel")
    | st.just("auto"),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=6), inner, max_size=3),
    max_leaves=6,
)
tables = {name: getattr(field.annotation, "model_fields", {}) for name, field in Scene.model_fields.items()}
tables["specimen"] = {name: key for one in SPECIMENS.values() for name, key in one.model_fields.items()}
tables["material"] = tables["strip"] = tables["substrate"] = Isotropic.model_fields | Orthotropic.model_fields
places = [*tables, "nonsense", *(f"{table}.{key}" for table, keys in tables.items() for key in [*keys, "nonsense"])]


@settings(max_examples=300, deadline=None)
@given(st.lists(st.tuples(st.sampled_from(places), values), max_size=4))
def test_no_dictionary_raises_anything_but_a_scene_error(changes: list[tuple[str, object]]) -> None:
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


@settings(max_examples=300, deadline=None)
@given(st.text(max_size=40))
def test_no_override_raises_anything_but_a_scene_error(text: str) -> None:
    try:
        load_scene("dcb-czm1", [text])
    except SceneError:
        pass


@pytest.mark.parametrize("specimen", ['"a.iga"', '{kind = "dcb", mesh = 5}'])
def test_what_names_no_mesh_file_is_refused_for_what_it_is(specimen: str, tmp_path: Path) -> None:
    (tmp_path / "my.toml").write_text(f"specimen = {specimen}\n")
    with pytest.raises(SceneError, match="specimen.*must be"):
        load_scene(str(tmp_path / "my.toml"))


def test_a_name_that_no_file_can_have_is_not_below_any_folder(tmp_path: Path) -> None:
    text = MINIMAL.replace("length = 14", 'mesh = "a\\u0000b.iga"\nlength = 14')
    (tmp_path / "my.toml").write_text(text)
    with pytest.raises(SceneError, match="specimen.mesh: must name files in the folder of the scene or below it"):
        load_scene(str(tmp_path / "my.toml"))
