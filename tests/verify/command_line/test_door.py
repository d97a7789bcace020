"""Whatever comes in at the door, as a scene or a command line: an exit code of 0, 1 or 2 and a sentence.

The solvers are replaced by nothing, so that thousands of inputs take seconds; a few real runs are tiny.
"""

from __future__ import annotations

import ast
import shutil
from pathlib import Path
from types import SimpleNamespace

import pytest
from hypothesis import strategies as st
from iga_files import SMALL
from odd_inputs import DCB, KEYS, LINES, METHODS, OVERRIDES, SCENES, answered, as_toml, few_and_many

from verify.result import CURVE_COLUMNS, Result, steps_from_rows
from verify.runs import run
from verify.scene.load import load_scene, packaged_scenes
from verify.scene.parse import SceneError

PROJECT = Path(__file__).resolve().parents[3]


CURVE = "opening,load\n0,0\n1,2\n3,1\n"
FILES = {
    "broken.toml": "[specimen\n",
    "curve.csv": CURVE,
    "other.csv": "opening,force\n0,0\n1,2\n",
    "body.iga": "type plane\n",
    "two.csv": "X;U2;RF2\n1;0;0\n2;-1,5;-2\n",
    "run/curve.csv": CURVE,
    "plate.iga": SMALL,
}
#: What takes long -> what it finds instead; a study that is complete for ``...``.
DONE = {
    **dict.fromkeys(("verification.verify", "studies.hard.suite.hard", "studies.campaign.campaign"), True),
    **{"studies.cost.study.cost": None, "export.command.export": []},
    "studies.pairs.compared": ...,
    **dict.fromkeys(("studies.uncertainty.run_study", "studies.certified.keeping.keep"), ...),
}


@pytest.fixture
def door(tmp_path, monkeypatch):
    """A folder to stand in, with all that takes long replaced by nothing."""

    def nothing(prepared, *_: object, **__: object):
        return Result(prepared.method.name, steps_from_rows([dict.fromkeys(CURVE_COLUMNS, 0.0)]), seconds={}), ()

    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(run, "run", nothing)
    study = SimpleNamespace(complete=True, failures=(), found=())
    for name, found in DONE.items():
        monkeypatch.setattr(f"verify.{name}", lambda *_, found=found: study if found is ... else found)
    (tmp_path / "own.toml").write_text("\n".join(f"{key} = {as_toml(value)}" for key, value in DCB.items()))
    for name, text in FILES.items():
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text(text)
    return tmp_path


def scene_is_answered(text: bytes, method: str, door: Path, capsys: pytest.CaptureFixture) -> None:
    (door / "x.toml").write_bytes(text)
    code, said = answered(capsys, "solve", "x.toml", "--method", method, "--out", "here")
    try:
        load_scene("x.toml")
    except SceneError as error:
        assert code == 2 and all(sentence in said and sentence for sentence in error.sentences)
        assert answered(capsys, "verify", "x.toml", "--dry-run")[0] == 2
    else:
        assert answered(capsys, "effects", "x.toml", "--method", method, "--dry-run")[0] in (0, 1, 2)


def overrides_are_answered(overrides: list[str], scene: str, door: Path, capsys: pytest.CaptureFixture) -> None:
    words = [word for override in overrides for word in ("--set", override)]
    code, said = answered(capsys, "solve", scene, "--method", "lefm", *words, "--out", "here")
    if code == 2 and len(overrides) == 1 and not said.startswith("usage"):
        key = overrides[0].partition("=")[0].strip().split(".")[0]
        assert key in said or "--set" in said, overrides


def line_is_answered(words: list[str], door: Path, capsys: pytest.CaptureFixture) -> None:
    answered(capsys, *words)


of_scenes = {"text": SCENES, "method": st.sampled_from(METHODS)}
test_scenes, test_many_scenes = few_and_many(scene_is_answered, **of_scenes)
of_overrides = {"overrides": OVERRIDES, "scene": st.sampled_from(["dcb-czm1", "peel-60"])}
test_overrides, test_many_overrides = few_and_many(overrides_are_answered, **of_overrides)
test_command_lines, test_many_command_lines = few_and_many(line_is_answered, words=LINES)


#: Keys whose values have dimensions, for runs in which they are far from their usual size.
SIZES = [
    "specimen.length", "specimen.arm_thickness", "specimen.precrack", "specimen.width", "material.young",
    "interface.strength", "interface.toughness", "interface.ductility", "interface.penalty", "load.opening",
]  # fmt: skip


def run_ends_in_words(method: str, key: str, power: float, tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    """A real run, however it goes, is no error of the program."""
    folder, value = tmp_path, 10.0**power
    shutil.rmtree(folder / "here", ignore_errors=True)
    words = ["--set", f"{key}={value!r}", "--set", "discretization.steps=3", "--out", str(folder / "here")]
    words += ["--dofs", "112"] if method in ("nurbs", "lagrange") else []
    code, said = answered(capsys, "solve", "dcb-czm1-linear", "--method", method, *words)
    log = folder / "here" / "error.log"
    assert not log.exists(), log.read_text()
    known = (key.partition(".")[0], "discretization.dofs: ", "stopped: ", "not run", ": broken: ")
    assert code == 0 or any(words in said for words in known), said


sizes = {"method": st.sampled_from(["lefm", "nurbs", "lagrange", "beam"]), "key": st.sampled_from(SIZES)}
test_real_runs, _ = few_and_many(run_ends_in_words, 8, **sizes, power=st.floats(-8.0, 8.0))
_, test_many_real_runs = few_and_many(run_ends_in_words, 12, 200, **sizes, power=st.floats(-15.0, 15.0))


@pytest.mark.parametrize("scale", [1e-9, 1e-3, 1e3, 1e9])
def test_every_set_of_units_is_taken(scale):
    """Lengths in other units, forces in others: no packaged scene is near the limits."""
    for name in packaged_scenes():
        plain = load_scene(name)
        of_stress = "strength toughness penalty stiffness shear_strength shear_toughness shear_stiffness".split()
        given = {key: getattr(plain.interface, key) for key in of_stress if key in plain.interface.model_fields_set}
        stress = [f"interface.{key}={value * scale}" for key, value in given.items()]
        bodies = [key for key in ("material", "strip", "substrate") if getattr(plain, key) is not None]
        moduli = [
            f"{body}.{key}={value * scale}"
            for body in bodies
            for key, value in getattr(plain, body).model_dump().items()
            if value is not None and key not in ("poisson", "nu12", "nu13", "nu23")
        ]
        load_scene(name, [*stress, *moduli])


# --- what a scene of others cannot do ---


def scene_with(folder: Path, **keys: object) -> Path:
    folder.mkdir(exist_ok=True)
    table = {**DCB, "specimen": {**DCB["specimen"], **keys}}
    (folder / "own.toml").write_text("\n".join(f"{key} = {as_toml(value)}" for key, value in table.items()))
    return folder / "own.toml"


@pytest.mark.parametrize("name", ["../secret.iga", "/etc/passwd", "below/../../secret.iga", "link.iga", "link/x.iga"])
def test_mesh_files_of_a_scene_stay_in_its_folder(name, tmp_path):
    path = scene_with(tmp_path / "scenes", mesh=["upper.iga", name])
    (path.parent / "link.iga").symlink_to(tmp_path / "secret.iga")
    (path.parent / "link").symlink_to(tmp_path)
    with pytest.raises(SceneError, match="specimen.mesh: must name files in the folder of the scene or below it") as no:
        load_scene(path)
    assert repr(name) in str(no.value)
    asked = load_scene(path, [f"specimen.mesh={as_toml(name)}"])  # on the command line the user says so
    assert asked.specimen.mesh == (name,)


def test_mesh_files_beside_and_below_a_scene_are_found(tmp_path):
    path = scene_with(tmp_path / "scenes", mesh=["upper.iga", "below/lower.iga"])
    assert load_scene(path).specimen.mesh == (str(path.parent / "upper.iga"), str(path.parent / "below" / "lower.iga"))


@pytest.mark.parametrize("name", ["../up", "/tmp/x", "a/b", "..", ".hidden", "a\\nb", "a b", "", "x" * 81, "a\0b"])
def test_the_name_of_a_scene_makes_no_folder_elsewhere(name, door, capsys):
    before = sorted(door.parent.rglob("*"))
    (door / "own.toml").write_text((door / "own.toml").read_text().replace('"own"', as_toml(name)))
    code, said = answered(capsys, "solve", "own.toml", "--method", "lefm")
    assert code == 2 and "name: must be 1 to 80 letters, digits, dots" in said
    assert sorted(door.parent.rglob("*")) == before


def test_a_scene_is_data(tmp_path, capsys):
    """What would make a file if anything of a scene were run, wherever a text may stand."""
    trap = tmp_path / "trap"
    code = f"__import__('pathlib').Path({str(trap)!r}).touch()"
    for key in [key for key in KEYS if key != "units"]:
        with pytest.raises(SceneError):
            load_scene("dcb-czm1", [f"{key}={as_toml(code)}"])
    assert load_scene("dcb-czm1", [f"units={as_toml(code)}"]).units == code
    assert not trap.exists()


#: Calls that run a text or what a file holds.
RUNS_TEXT = {"eval", "exec", "compile", "__import__", "execfile"}
RUNS_FILES = {"pickle", "cPickle", "dill", "joblib", "shelve", "marshal", "yaml", "code"}


def test_nothing_in_the_project_runs_text():
    files = [file for package in ("iga", "verify", "fem_reference") for file in (PROJECT / package).rglob("*.py")]
    for path, text in [(path, path.read_text()) for path in files]:
        for node in ast.walk(ast.parse(text)):
            where = f"{path}:{getattr(node, 'lineno', 0)}"
            if isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
                assert node.func.id not in RUNS_TEXT, where
            if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute):
                loads = [k for k in node.keywords if k.arg in ("allow_pickle", "shell")]
                assert all(isinstance(k.value, ast.Constant) and not k.value.value for k in loads), (
                    f"{path}:{node.lineno}"
                )
            if isinstance(node, ast.Import | ast.ImportFrom):
                names = [node.module or ""] if isinstance(node, ast.ImportFrom) else [one.name for one in node.names]
                assert not RUNS_FILES & {name.partition(".")[0] for name in names}, where
