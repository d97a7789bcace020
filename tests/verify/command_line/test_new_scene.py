"""Scenes to start from, and scenes as a terminal shows them."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

import pytest

from verify.cli import main
from verify.command_line.scenes import listing
from verify.command_line.scenes.listing import line, page, sketch
from verify.command_line.scenes.new import SHEAR_KEYS, new_scene, published
from verify.scene.keys import SPECIMENS, keys, keys_of
from verify.scene.load import load_scene, packaged_scenes
from verify.scene.materials import OF_SOLIDS, Orthotropic
from verify.scene.parse import parse_scene
from verify.scene.schema import Scene
from verify.scene.stated.published import Published

KINDS = pytest.mark.parametrize("kind", SPECIMENS)
#: Keys of a bond that slides.
SHEAR = (
    *SHEAR_KEYS, "criterion", "exponent", "onset", "shear_stiffness", "friction", "viscosity", "pressure_strength",
)  # fmt: skip


def given(text: str) -> dict[str, dict]:
    """The tables of a scene, with those keys that stand behind a comment sign."""
    text, published = text.split("# [[published]]")
    bare = re.sub(r"^# (\w+ = )", r"\1", text, flags=re.MULTILINE)
    mine = re.sub(r"^# ", "", published, flags=re.MULTILINE)
    return tomllib.loads(bare) | {"published": tomllib.loads(mine)}


@KINDS
def test_it_is_a_scene_with_nothing_but_defaults(kind):
    scene = parse_scene(tomllib.loads(new_scene(kind)))
    least = scene.model_dump()
    for key in keys(kind):
        wanted = SPECIMENS[kind].slides and key.name in SHEAR_KEYS
        if key.table and not key.field.is_required() and not wanted:
            least[key.table].pop(key.name, None)
    assert parse_scene({name: table for name, table in least.items() if table}) == scene
    assert scene.specimen.kind == kind


@KINDS
def test_every_key_of_the_schema_is_there_with_what_it_is_and_its_range(kind):
    text = new_scene(kind)
    tables = given(text)
    for key in (*keys(kind), *keys_of("published", Published)):
        assert key.name in (tables[key.table] if key.table else tables), key.dotted
        assert key.meaning, f"{key.dotted}: say in the schema what it is"
        for limit in key.field.metadata:
            for name, sign in (("gt", ">"), ("ge", ">="), ("lt", "<"), ("le", "<=")):
                assert not hasattr(limit, name) or f"{sign} {getattr(limit, name):g}" in text
    assert "[length]" not in text and "[mm]" in text and "[stress]" not in text
    other = {name for specimen in SPECIMENS.values() for name in specimen.materials} - {*SPECIMENS[kind].materials}
    assert set(Scene.model_fields) - other == set(tables), "no table is forgotten"


@KINDS
def test_what_stands_behind_comment_signs_is_valid_too(kind):
    """Keys of other bonds are taken together, in place of those that they exclude."""
    scene, tables = tomllib.loads(new_scene(kind)), given(new_scene(kind))
    with_all = scene | {"specimen": tables["specimen"]}
    with_all["interface"] = scene["interface"] | {key: tables["interface"][key] for key in ("ductility", "penalty")}
    for name in SPECIMENS[kind].materials:
        with_all[name] = {key: tables[name][key] for key in Orthotropic.model_fields if key not in OF_SOLIDS}
    full = parse_scene(with_all | {"published": [published(parse_scene(scene).model_dump()) | {"source": "a book"}]})
    assert full.interface == parse_scene(scene).interface
    bond = tables["interface"]
    base = {key: bond[key] for key in ("strength", "toughness", *SHEAR_KEYS[: 2 * SPECIMENS[kind].slides])}
    bonds = [
        base | {"stiffness": bond["stiffness"]},
        base | {key: bond[key] for key in ("ductility", *SHEAR)},
        base | {"ductility": bond["ductility"], "plateau": bond["plateau"], "law": "trapezoidal"},
        *([] if SPECIMENS[kind].slides else [{"table": bond["table"], "law": "tabular"}]),  # none of which slides
    ]
    for one in bonds:
        found = parse_scene(scene | {"interface": one}).interface.model_dump(mode="json")
        assert {key: found[key] for key in one} == one


def test_it_runs(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for kind in ("dcb", "mmb"):
        assert main(["new", kind]) == 0
        Path(f"{kind}.toml").write_text(capsys.readouterr().out)
        assert main(["verify", f"{kind}.toml", "--dry-run"]) == 0
        assert f"my-{kind}/nurbs" in capsys.readouterr().out
    assert main(["solve", "dcb.toml", "--method", "lefm"]) == 0


@pytest.mark.parametrize("width", [40, 200])
@pytest.mark.parametrize("name", packaged_scenes())
def test_scenes_fit_the_terminal(name, width, monkeypatch):
    monkeypatch.setattr(listing, "_growth", lambda scene: 40 * "by LEFM stable, ")
    scene = load_scene(name)
    for text in (line(name, scene, width), page(scene, width)):
        words = max(map(len, text.split()))
        assert "\x1b" not in text and all(len(one) <= max(width, words + 11) for one in text.splitlines())
    drawn = "\n".join(sketch(scene, width))
    assert drawn.isascii() and f"opening {scene.load.opening[0]:g}" in drawn


#: Scene, overrides and width -> its drawing.
PICTURES = tomllib.loads(Path(__file__).with_name("pictures.toml").read_text())


@pytest.mark.parametrize("words", PICTURES)
def test_a_specimen_is_drawn_to_scale_as_it_is_held_and_pulled(words):
    name, width, *overrides = words.split()
    assert "\n".join(["", *sketch(load_scene(name, overrides), int(width)), ""]) == PICTURES[words]


def test_scenes_are_listed_or_shown(capsys, monkeypatch):
    monkeypatch.setenv("COLUMNS", "200")
    assert main(["scenes"]) == 0
    assert len(capsys.readouterr().out.splitlines()) >= len(packaged_scenes())
    monkeypatch.setenv("COLUMNS", "40")
    assert main(["scenes", "peel-60", "dcb-czm2"]) == 0
    text = capsys.readouterr().out
    assert "////" in text and text.count("::::") >= 2 and max(map(len, text.splitlines())) <= 40


#: Scene and overrides -> what its page says; after a dash what it does not.
SAYS = {
    "dcb-czm1": (
        "effects kinematics finite, contact, irreversible, no symmetry, search",
        "interface bilinear, strength 4, toughness 0.1, ductility 12.5",
        "specimen dcb, plane stress, width 1 material isotropic, young 120000, poisson 0.2",
        "meshes 1956 unknowns, degree 3; DOLFINx 112 elements along, 1 through, degree 2",
        "-sliding",
        "-growth",
    ),
    "dcb-czm1 effects.contact=auto load.opening=[1.0,0.5,2.0] effects.search=false": (
        "contact auto, irreversible, no symmetry, no search",
        "opening 1 -> 0.5 -> 2 ",
    ),
    "dcb-as4peek interface.friction=0.3": (
        "sliding strength 100, toughness 1.719, stiffness 100000, bk of exponent 2.284, onset turon, friction 0.3 ",
    ),
    "dcb-czm1 material={E1=120e3,E2=9e3,G12=5e3,nu12=0.3}": ("orthotropic, E1 120000, E2 9000, G12 5000, nu12 0.3",),
}


@pytest.mark.parametrize("words", SAYS)
def test_a_page_of_a_scene_says_every_effect_and_number(words):
    name, *overrides = words.split()
    said = " ".join(page(load_scene(name, overrides), 100).split())
    assert all((one.removeprefix("-") in said) != one.startswith("-") for one in SAYS[words]), said


def test_a_scene_is_told_in_one_line_where_that_has_room():
    scene = load_scene("dcb-czm1")
    text = "dcb, finite kinematics, strength 4, toughness 0.1, opened to 3 (N, mm, MPa)"
    assert line("name", scene, 25 + len(text)) == f"{'name':24} {text}"
    first, *rest = line("name", scene, 24 + len(text)).splitlines()
    assert first == "name" and all(one.startswith("  ") for one in rest) and " ".join(" ".join(rest).split()) == text


@pytest.mark.parametrize(("precrack", "words"), [(39.3, "stable; unstable with a precrack"), (25.0, "unstable: ")])
def test_the_page_of_a_scene_says_whether_its_crack_runs_away(precrack, words):
    """An end-notched flexure does for a < 0.693 L, with the half span L = 51 and a + 0.4 h in place of a."""
    found = page(parse_scene(load_scene("enf-as4peek").model_dump(), (f"specimen.precrack={precrack}",)), 200)
    (growth,) = (line for line in found.splitlines() if line.startswith("growth"))
    assert f"by LEFM {words}" in growth
    assert 0.95 * 0.693 * 51.0 < float(re.findall(r"\d+\.\d+$", growth)[0]) < 0.693 * 51.0
