"""Scenes to start from, and scenes as a terminal shows them."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

import pytest

from iga.laws.opening import LAWS, BilinearLaw
from verify.cli import main
from verify.command_line.scenes.listing import line, page
from verify.command_line.scenes.new import SHEAR_KEYS, new_scene, published
from verify.command_line.scenes.sketch import sketch
from verify.scene.complaints import _bounds
from verify.scene.keys import SPECIMENS, keys, keys_of
from verify.scene.load import load_scene, packaged_scenes
from verify.scene.materials import Orthotropic
from verify.scene.parse import parse_scene
from verify.scene.schema import Scene
from verify.scene.stated.published import Published

KINDS = tuple(SPECIMENS)
#: Keys of a bond that slides.
SHEAR = (
    "shear_strength", "shear_toughness", "criterion", "exponent", "onset", "shear_stiffness", "friction", "viscosity",
    "pressure_strength",
)  # fmt: skip
MATERIALS = {kind: specimen.materials for kind, specimen in SPECIMENS.items()}


def given(text: str) -> dict[str, dict]:
    """The tables of a scene, with those keys that stand behind a comment sign."""
    text, published = text.split("# [[published]]")
    bare = re.sub(r"^# (\w+ = )", r"\1", text, flags=re.MULTILINE)
    mine = re.sub(r"^# ", "", published, flags=re.MULTILINE)
    return tomllib.loads(bare) | {"published": tomllib.loads(mine)}


@pytest.mark.parametrize("kind", KINDS)
def test_it_is_a_scene_with_nothing_but_defaults(kind: str) -> None:
    scene = parse_scene(tomllib.loads(new_scene(kind)))
    least = scene.model_dump()
    for key in keys(kind):
        wanted = SPECIMENS[kind].slides and key.name in SHEAR_KEYS
        if key.table and not key.field.is_required() and not wanted:
            least[key.table].pop(key.name, None)
    assert parse_scene({name: table for name, table in least.items() if table}) == scene
    assert scene.specimen.kind == kind


@pytest.mark.parametrize("kind", KINDS)
def test_every_key_is_there_with_what_it_is_and_its_range(kind: str) -> None:
    text = new_scene(kind)
    tables = given(text)
    for key in (*keys(kind), *keys_of("published", Published)):
        assert key.name in (tables[key.table] if key.table else tables), key.dotted
        assert key.meaning, f"{key.dotted}: say in the schema what it is"
        for limit, sign in _bounds(key.field):
            assert f"{sign} {limit:g}" in text
    assert "[length]" not in text and "[mm]" in text and "[stress]" not in text


@pytest.mark.parametrize("kind", KINDS)
def test_no_table_of_the_schema_is_forgotten(kind: str) -> None:
    tables, found = given(new_scene(kind)), Scene.model_json_schema()
    mine = SPECIMENS[kind].__name__
    other = {specimen.__name__ for specimen in SPECIMENS.values()} - {mine} | {"OwnLoad", "Patch", "Groups"}
    for name, table in found["$defs"].items():
        if name not in other:
            places = {"Isotropic": MATERIALS[kind], "Orthotropic": MATERIALS[kind], mine: ["specimen"]}
            for place in places.get(name, [name.lower()]):
                assert set(table["properties"]) <= set(tables[place]), place
    alternatives = {material for materials in MATERIALS.values() for material in materials} - set(MATERIALS[kind])
    assert set(found["properties"]) - alternatives == set(tables)


@pytest.mark.parametrize("kind", KINDS)
def test_what_stands_behind_comment_signs_is_valid_too(kind: str) -> None:
    scene = tomllib.loads(new_scene(kind))
    tables = given(new_scene(kind))
    with_all = scene | {"specimen": tables["specimen"]}
    with_all["interface"] = scene["interface"] | {key: tables["interface"][key] for key in ("ductility", "penalty")}
    for name in MATERIALS[kind]:
        with_all[name] = {key: tables[name][key] for key in Orthotropic.model_fields}
    full = parse_scene(with_all | {"published": [published(parse_scene(scene).model_dump()) | {"source": "a book"}]})
    assert full.interface == parse_scene(scene).interface


@pytest.mark.parametrize("kind", KINDS)
def test_other_bonds_stand_behind_comment_signs_too(kind: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Their keys are taken together, in place of those that they exclude."""
    monkeypatch.setitem(LAWS, "tabular", BilinearLaw)
    scene, bond = tomllib.loads(new_scene(kind)), given(new_scene(kind))["interface"]
    sliding = {key: bond[key] for key in SHEAR}
    one, other = ({key: bond[key] for key in ("strength", "toughness", mine)} for mine in ("stiffness", "ductility"))
    needed = {key: bond[key] for key in SHEAR_KEYS} if SPECIMENS[kind].slides else {}
    one, other = one | needed, other | needed
    bonds = [one, other | sliding, other | {"plateau": bond["plateau"], "law": "trapezoidal"}]
    for keys_of_it in bonds:
        found = parse_scene(scene | {"interface": keys_of_it}).interface
        assert {key: getattr(found, key) for key in keys_of_it} == keys_of_it
    if needed:
        return  # of laws of a table none slides
    table = parse_scene(scene | {"interface": {"table": bond["table"], "law": "tabular"}}).interface.table
    assert [list(corner) for corner in table] == bond["table"]


def test_it_runs(tmp_path: Path, capsys: pytest.CaptureFixture, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    for kind in KINDS:
        assert main(["new", kind]) == 0
        Path(f"{kind}.toml").write_text(capsys.readouterr().out)
        assert main(["verify", f"{kind}.toml", "--dry-run"]) == 0
        assert f"my-{kind}/nurbs" in capsys.readouterr().out
    assert main(["solve", "dcb.toml", "--method", "lefm"]) == 0


def test_another_kind_is_refused(capsys: pytest.CaptureFixture) -> None:
    assert main(["new", "peell"]) == 2
    assert 'peell: is no kind of specimen; did you mean "peel"?' in capsys.readouterr().err


@pytest.mark.parametrize("width", [40, 80, 200])
@pytest.mark.parametrize("name", packaged_scenes())
def test_scenes_fit_the_terminal(name: str, width: int) -> None:
    scene = load_scene(name)
    for text in (line(name, scene, width), page(scene, width)):
        assert "\x1b" not in text
        words = max(map(len, text.split()))
        assert all(len(one) <= max(width, words + 11) for one in text.splitlines())
    assert "\n".join(sketch(scene, width)).isascii()
    assert f"opening {scene.load.opening[0]:g}" in "\n".join(sketch(scene, width))


@pytest.mark.parametrize("width", [40, 100])
def test_lengths_are_drawn_to_scale(width: int) -> None:
    def bond(share: float) -> int:
        scene = load_scene("dcb-czm1", [f"specimen.precrack={14 * (1 - share)}", "load.opening=1"])
        return max(one.count(":") for one in sketch(scene, width))

    whole = bond(0.999)
    assert bond(0.5) == pytest.approx(whole / 2, abs=1) and bond(0.25) == pytest.approx(whole / 4, abs=1)
    peel = sketch(load_scene("peel-60"), width)
    strip, base = (max(one.count(sign) for one in peel) for sign in "-/")
    assert base / strip == pytest.approx(120 / 150, abs=0.06)


@pytest.mark.parametrize("width", [40, 60, 100])
@pytest.mark.parametrize("name", [name for name in packaged_scenes() if name.startswith("peel")])
def test_a_strip_is_pulled_at_its_free_end_and_lies_flush_on_its_substrate(name: str, width: int) -> None:
    """The arrow stands above the right corner of the strip, wherever its words have room."""
    lines = sketch(load_scene(name), width)
    (pull,) = [one for one in lines if "^" in one]
    corners = [one for one in lines if one.strip().startswith("+-") and one.endswith("-+")]
    assert len(corners) == 4 and corners[0] == corners[1] and corners[2] == corners[3]
    words = pull.replace("^", "").strip()
    strip = len(corners[0]) - 4
    assert pull.index("^") == (len(corners[0]) - 1 if len(words) + 1 < strip else 2)
    assert len({one.index("+") for one in corners}) == 1, "the ends are flush"
    bond, clamp = (next(one for one in lines if sign in one) for sign in (":::", "///"))
    assert bond.index(":") == clamp.index("/") == corners[0].index("+") + 1
    assert bond.count(":") + 2 <= strip and clamp.count("/") == len(corners[2]) - 4


@pytest.mark.parametrize("bond", [20.0, 100.0, 119.9])
def test_the_free_end_of_a_strip_can_be_seen(bond: float) -> None:
    """However short it is; a strip as long as its substrate is drawn as long where there is room for that."""
    scene = load_scene("peel-60", ["specimen.strip_length=120.0", f"specimen.bond_length={bond}"])
    lines = sketch(scene, 60)
    corners = [one for one in lines if one.strip().startswith("+-") and one.endswith("-+")]
    dots = next(one for one in lines if ":::" in one).count(":")
    strip, substrate = (one.count("-") for one in corners[1:3])
    assert strip == max(substrate, dots + 2) and dots == pytest.approx(substrate * bond / 120.0, abs=0.5)
    for text, length in ((f" {bond:.4g} ", dots), (" 120 ", substrate), (" 120 ", strip)):
        assert any(text in one and one.rindex("|") - one.index("|") + 1 == length + 1 or text.rstrip() in one
                   for one in lines[-3:])  # fmt: skip


@pytest.mark.parametrize("width", [40, 100])
def test_measures_begin_and_end_below_what_they_measure(width: int) -> None:
    lines = sketch(load_scene("dcb-czm1"), width)
    crack, whole = lines[-2:]
    (bond,) = [one for one in lines if ":" in one]
    arms = [one for one in lines if "+" in one]
    assert len(arms) == 4 and lines.index(bond) == lines.index(arms[1]) + 3
    assert (whole.index("|"), whole.rindex("|")) == (arms[0].index("+"), arms[0].rindex("+")) and " 14 " in whole
    assert (crack.index("|"), crack.rindex("|")) == (whole.index("|"), bond.index(":")) and " 4 " in crack
    assert bond.rindex(":") + 1 == arms[0].rindex("+")
    assert lines[0].split() == ["^", "opening", "3"] and lines[-3].split() == ["v"], "the arms are pulled apart"


@pytest.mark.parametrize("width", [40, 100])
def test_a_number_without_room_stands_behind_its_measure(width: int) -> None:
    short = sketch(load_scene("dcb-czm1", ["specimen.precrack=0.25", "load.opening=1"]), width)[-2]
    assert short.rstrip().endswith("| 0.25") and "<" not in short


def test_scenes_are_listed_or_shown(capsys: pytest.CaptureFixture, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "200")
    assert main(["scenes"]) == 0
    assert len(capsys.readouterr().out.splitlines()) >= len(packaged_scenes())
    monkeypatch.setenv("COLUMNS", "40")
    assert main(["scenes", "peel-60", "dcb-czm2"]) == 0
    text = capsys.readouterr().out
    assert "////" in text and text.count("::::") >= 2 and max(map(len, text.splitlines())) <= 40
    assert main(["scenes", "peel-61"]) == 2
    assert 'did you mean "peel-60"' in capsys.readouterr().err


def test_a_page_of_a_scene_says_every_effect_and_number() -> None:
    plain = " ".join(page(load_scene("dcb-czm1"), 100).split())
    assert "effects kinematics finite, contact, irreversible, no symmetry, search" in plain
    assert "interface bilinear, strength 4, toughness 0.1, ductility 12.5" in plain
    assert "specimen dcb, plane stress, width 1 material isotropic, young 120000, poisson 0.2" in plain
    assert "meshes 1956 unknowns, degree 3; DOLFINx 112 elements along, 1 through, degree 2" in plain
    chosen = load_scene("dcb-czm1", ["effects.contact=auto", "load.opening=[1.0, 0.5, 2.0]", "effects.search=false"])
    other = " ".join(page(chosen, 100).split())
    assert "contact auto, irreversible, no symmetry, no search" in other and "opening 1 -> 0.5 -> 2 " in other
    sliding = " ".join(page(load_scene("dcb-as4peek", ["interface.friction=0.3"]), 100).split())
    told = "sliding strength 100, toughness 1.719, stiffness 100000, bk of exponent 2.284, onset turon, friction 0.3 "
    assert told in sliding and "sliding" not in plain
    layered = load_scene("dcb-czm1", ["material={E1=120e3, E2=9e3, G12=5e3, nu12=0.3}"])
    assert "material orthotropic, E1 120000, E2 9000, G12 5000, nu12 0.3" in " ".join(page(layered, 100).split())


def test_a_scene_is_told_in_one_line_where_that_has_room() -> None:
    scene = load_scene("dcb-czm1")
    text = "dcb, finite kinematics, strength 4, toughness 0.1, opened to 3 (N, mm, MPa)"
    assert line("name", scene, 25 + len(text)) == f"{'name':24} {text}"
    first, *rest = line("name", scene, 24 + len(text)).splitlines()
    assert first == "name" and all(one.startswith("  ") for one in rest) and " ".join(" ".join(rest).split()) == text


@pytest.mark.parametrize("width", [40, 100])
def test_what_is_next_to_nothing_is_a_sign_wide(width: int) -> None:
    """A precrack of a thousandth is told from none, and a bond of a thousandth is seen."""
    short = sketch(load_scene("dcb-czm1", ["specimen.precrack=0.014", "load.opening=0.1"]), width)
    (bond,) = [one for one in short if ":" in one]
    (edge, *_) = [one for one in short if "+" in one]
    assert bond.index(":") == edge.index("+") + 2 and bond.rindex(":") == edge.rindex("+") - 1
    assert "|-| 0.014" in short[-2]
    strip = sketch(load_scene("peel-60", ["specimen.bond_length=0.15"]), width)
    assert max(one.count(":") for one in strip) == 1


PICTURES = {
    "dcb-czm1": """
  ^ opening 3
  +----------------------------------------+
  |                                        |  0.2 thick
  +----------------------------------------+
              :::::::::::::::::::::::::::::   bond
  +----------------------------------------+
  |                                        |  0.2 thick
  +----------------------------------------+
  v
  |<--- 4 --->|
  |<----------------- 14 ----------------->|""",
    "peel-60": """
                               opening 6.5 ^
  +----------------------------------------+
  |                                        |  2 thick
  +----------------------------------------+
   ::::::::::::::::  bond
  +--------------------------------+
  |                                |  10 thick
  +--------------------------------+
   ////////////////////////////////  fixed
  |<----- 60 ----->|
  |<------------ 120 ------------->|
  |<---------------- 150 ----------------->|""",
}


@pytest.mark.parametrize("name", PICTURES)
def test_a_specimen_is_drawn_as_it_is_held_and_pulled(name: str) -> None:
    assert "\n".join(["", *sketch(load_scene(name), 60)]) == PICTURES[name]


@pytest.mark.parametrize(("precrack", "words"), [(39.3, "stable; unstable with a precrack"), (25.0, "unstable: ")])
def test_the_page_of_a_scene_says_whether_its_crack_runs_away(precrack: float, words: str) -> None:
    """An end-notched flexure does for a < 0.693 L, with the half span L = 51 and a + 0.4 h in place of a."""
    found = page(parse_scene(load_scene("enf-as4peek").model_dump(), (f"specimen.precrack={precrack}",)), 200)
    (growth,) = (line for line in found.splitlines() if line.startswith("growth"))
    assert f"by LEFM {words}" in growth
    assert 0.95 * 0.693 * 51.0 < float(re.findall(r"\d+\.\d+$", growth)[0]) < 0.693 * 51.0


def test_the_page_of_a_bond_that_opens_alone_says_nothing_of_its_growth() -> None:
    assert "\ngrowth" not in page(load_scene("dcb-czm1"), 200)
