"""Files of earlier runs that are damaged, cut off or of other types: a sentence, and nothing that is whole is lost."""

from __future__ import annotations

import io
import json
import shutil
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import made_up_studies
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from made_up_runs import ENVIRONMENT, made_up
from odd_inputs import SOME, VALUES, answered

from tests.verify.studies.accuracy.test_choice import a_study
from verify import report, verification
from verify.cli import main
from verify.runs.folder import _append, damage, read_fields, read_result, write_fields
from verify.runs.jobs import Job, Outcome, run_all
from verify.scene.load import load_scene
from verify.studies.accuracy import choice
from verify.studies.found import found_in, named
from verify.support.checked_files import Damaged, read_json, read_table
from verify.support.refusal import Refusal

SCENE = "dcb-czm1-linear"
STUDIES = {
    "cost": (made_up_studies.cost, ("cost.json", "cost.csv")),
    "effects": (made_up_studies.effects, ("effects.json", "effects.csv")),
    "vary": (made_up_studies.vary, ("vary.json", "vary.csv")),
    "hard": (made_up_studies.hard, ("coarse-czm2/nurbs/verdict.json",)),
}
FILES = [(name, file) for name, (_, files) in STUDIES.items() for file in files]


def changed(draw: Callable, content: bytes) -> bytes:
    """A file that is something else, cut off, with other bytes, or, where it is JSON, with another value somewhere."""
    at = draw(st.integers(0, len(content)))
    match draw(st.integers(0, 5)):
        case 0:
            return draw(st.binary(max_size=60))
        case 1:
            return content[:at]
        case 2:
            return content[:at] + draw(st.binary(min_size=1, max_size=4)) + content[at + 1 :]
        case 3:
            return (
                content[:at] + draw(st.sampled_from(["nan", "null", "-1", "1e999", ",", "\n"])).encode() + content[at:]
            )
    try:
        table = json.loads(content)
    except ValueError:
        lines = content.splitlines(keepends=True)
        return b"".join(draw(st.permutations(lines))[: draw(st.integers(0, len(lines)))])
    inner, steps = table, draw(st.integers(0, 4))
    for _ in range(steps):
        keys = list(inner) if isinstance(inner, dict) else range(len(inner)) if isinstance(inner, list) else []
        if not keys:
            break
        key = draw(st.sampled_from(keys))
        if not isinstance(inner[key], dict | list) or draw(st.booleans()):
            inner[key] = draw(VALUES)
            break
        inner = inner[key]
    else:
        table = draw(VALUES)
    return json.dumps(table).encode()


@pytest.fixture(scope="module")
def studies(tmp_path_factory):
    folder = tmp_path_factory.mktemp("studies")
    for name, (make, _) in STUDIES.items():
        make(folder / name)
    return folder


@pytest.fixture
def out(studies, tmp_path, monkeypatch):
    """A folder to stand in, in which no run is made and no page is drawn."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(verification, "run_all", lambda plan, *_: [Outcome(job, None, "not run") for job in plan])
    monkeypatch.setattr(verification, "write_page", lambda *_: None)
    return tmp_path


@given(data=st.data(), one=st.sampled_from(FILES))
@SOME
def test_include_refuses_a_damaged_study_before_any_run(data, one, studies, out, capsys):
    """What is taken can be shown; what is not has a sentence, and a study that is merely found is left out."""
    name, file = one
    path = studies / name / file
    whole = path.read_bytes()
    try:
        path.write_bytes(changed(data.draw, whole))
        code, said = answered(capsys, "verify", SCENE, "--no-ladder", "--include", str(studies / name), "--out", "here")
        if code == 2:
            assert said.startswith("debond: --include: ") and said.count("\n") == 1
            assert [study.command for study in found_in(studies)] == sorted(set(STUDIES) - {name})
            assert f"{path}: must be as debond has written it, got: " in capsys.readouterr().err
        else:
            (study,) = named([studies / name])
            pytest.importorskip("matplotlib")
            from verify.report.studies.included import section

            section(study, out, "study")
    finally:
        path.write_bytes(whole)


@pytest.mark.parametrize(
    ("file", "text", "why"),
    [
        ("cost/cost.json", '{"scene": {"name": "a"', "Expecting ',' delimiter"),
        ("cost/cost.json", "[1, 2]", "the whole must be a valid dictionary, got '[1, 2]'"),
        ("cost/cost.json", '{"scene": {"name": "a"}, "left_out": []}', "no reference"),
        (
            "effects/effects.json",
            '{"scene": {"name": 3}, "left_out": []}',
            "scene.name must be a valid string, got '3'",
        ),
        (
            "effects/effects.json",
            '{"scene": {"name": "a"}, "left_out": [1]}',
            "left_out.0 must be a valid string, got '1'",
        ),
        ("effects/effects.csv", "", "the columns of an empty file"),
        ("effects/effects.csv", "effect,key\ncontact,contact\n", "the columns effect, key"),
        ("vary/vary.json", "{\x80", "'utf-8' codec can't decode"),
        ("hard/coarse-czm2/nurbs/verdict.json", '{"case": "coarse-czm2", "basis": "nurbs"}', "no runs"),
    ],
)
def test_what_is_wrong_is_said(file, text, why, tmp_path, capsys):
    name = file.partition("/")[0]
    STUDIES[name][0](tmp_path / name)
    (tmp_path / file).write_bytes(text.encode("latin-1"))
    with pytest.raises(Refusal, match="--include: ") as error:
        named([tmp_path / name])
    assert why in str(error.value)
    (tmp_path / file).unlink()
    (tmp_path / file).mkdir()
    with pytest.raises(Refusal, match="Is a directory"):
        named([tmp_path / name])


def test_the_page_is_written_without_a_study_that_is_damaged(studies, tmp_path):
    pytest.importorskip("matplotlib")
    pytest.importorskip("jinja2")
    made_up_studies.effects(tmp_path / "effects")
    made_up_studies.cost(tmp_path / "cost")
    (tmp_path / "cost" / "cost.json").write_text("{}")
    report.write(report.Findings((), ENVIRONMENT, included=found_in(tmp_path)), tmp_path / "report.html")
    page = (tmp_path / "report.html").read_text()
    assert "What each effect does" in page and "What accuracy costs" not in page


@given(data=st.data())
@SOME
def test_a_damaged_cost_json_does_not_count(data, tmp_path, monkeypatch, capsys):
    """It is a cache: without it the table decides, and one sentence says why."""
    table = choice.Choice("nurbs", (), "of the table")
    monkeypatch.setattr(choice, "_by_rule", lambda scene, accuracy: table)
    scene = load_scene("dcb-czm1")
    path = a_study(tmp_path, scene)
    path.write_bytes(changed(data.draw, path.read_bytes()))
    found = choice.choose(scene, 0.01, path)
    said = capsys.readouterr().err
    assert found.method in ("nurbs", "tspline")
    try:
        read_json(path, choice._STUDY)
    except Damaged:
        assert found is table and said.endswith("; it does not count\n") and said.count("\n") == 1


def as_npz(**arrays: object) -> bytes:
    stream = io.BytesIO()
    np.savez_compressed(stream, **arrays)
    return stream.getvalue()


def as_npy(array: np.ndarray) -> bytes:
    stream = io.BytesIO()
    np.save(stream, array, allow_pickle=True)
    return stream.getvalue()


FIELDS = {
    "nothing": b"",
    "garbage": b"\x00\x01garbage",
    "half of it": None,
    "one array": as_npy(np.zeros(3)),
    "objects": as_npy(np.array([{}, []], dtype=object)),
    "words": as_npz(**{"0.opening": "x", "0.load": 1.0}),
    "other names": as_npz(a=np.zeros(2)),
    "too little": as_npz(**{"0.opening": 1.0, "0.load": 2.0, "0.s_q": np.zeros(3)}),
}


@pytest.mark.parametrize("kind", FIELDS)
def test_damaged_fields_are_found(kind, tmp_path):
    path = tmp_path / "fields.npz"
    write_fields(path, made_up("nurbs", 0.0, 1.0, 500, 12).snapshots)
    assert len(read_fields(path)) == 3
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2] if FIELDS[kind] is None else FIELDS[kind])
    with pytest.raises(Damaged, match="fields.npz: must be as debond has written it, got: "):
        read_fields(path)


class Runs:
    """An object that does something as soon as it is read."""

    def __init__(self, mark: Path) -> None:
        self.mark = mark

    def __reduce__(self) -> tuple:
        return Path.touch, (self.mark,)


def test_fields_run_no_code_of_others(tmp_path):
    path, mark = tmp_path / "fields.npz", tmp_path / "mark"
    path.write_bytes(as_npz(**{"0.opening": np.array([Runs(mark)], dtype=object)}))
    with np.load(path, allow_pickle=True) as arrays:
        assert arrays["0.opening"].shape == (1,) and mark.exists(), "it would"
    mark.unlink()
    with pytest.raises(Damaged, match="fields.npz"):
        read_fields(path)
    assert not mark.exists()


@given(data=st.data())
@SOME
def test_any_fields_are_snapshots_or_damaged(data, tmp_path):
    path = tmp_path / "fields.npz"
    write_fields(path, made_up("nurbs", 0.0, 1.0, 500, 2).snapshots)
    path.write_bytes(changed(data.draw, path.read_bytes()))
    try:
        read_fields(path)
    except Damaged:
        pass


@pytest.fixture(scope="module")
def swept(tmp_path_factory):
    """An output folder with one run, its plan, and its result."""
    out, plan = tmp_path_factory.mktemp("swept"), [Job(SCENE, load_scene(SCENE), "beam", "beam")]
    (outcome,) = run_all(plan, out, 1)
    return out, plan, outcome.result


@pytest.mark.parametrize("file", ["fields.npz", "result.json", "evidence.csv", "curve.csv"])
@pytest.mark.parametrize(
    "content", [None, b"", b"\x93NUMPY", b"{}", b"[1]", b"\xff\xfe\x00", b"opening,load\n0,zero\n"]
)
def test_damage_of_a_run_is_found(file, content, swept, tmp_path):
    shutil.copytree(swept[0] / SCENE / "beam", tmp_path / "run")
    assert damage(tmp_path / "run", "result.json") == ""
    path = tmp_path / "run" / file
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2] if content is None else content)
    assert damage(tmp_path / "run", "result.json") == file
    if file in ("evidence.csv", "curve.csv"):
        path.unlink()
        assert damage(tmp_path / "run", "result.json") == file


def test_a_run_of_a_sweep_with_damaged_fields_is_done_again(swept, capsys):
    out, plan, first = swept
    (out / SCENE / "beam" / "fields.npz").write_bytes(b"PK")
    (again,) = run_all(plan, out, 1)
    assert "(fields.npz) and are done again" in capsys.readouterr().err
    assert again.result.complete and np.array_equal(again.result.load, first.load)
    assert len(again.result.snapshots) == len(first.snapshots) > 0


@pytest.mark.parametrize(
    "changes",
    [{"seconds": [1]}, {"seconds": {"mesh": "1"}}, {"status": 3}, {"dofs": "many"}, {"method": None}, {"steps": True}],
)
def test_a_result_of_other_types_is_damaged(changes, swept, tmp_path):
    shutil.copytree(swept[0] / SCENE / "beam", folder := tmp_path / "run")
    about = json.loads((folder / "result.json").read_text())
    (folder / "result.json").write_text(json.dumps(about | changes))
    assert damage(folder, "result.json") == "result.json"
    with pytest.raises(Damaged, match=next(iter(changes))):
        read_result(folder)


def test_fields_of_sizes_that_do_not_belong_together_are_damaged(tmp_path):
    """As many points in every column of the interface, as many displacements and stresses as places."""
    path = tmp_path / "fields.npz"
    write_fields(path, made_up("nurbs", 0.0, 1.0, 500, 2).snapshots)
    with np.load(path) as arrays:
        whole = dict(arrays)
    short = {name: whole[f"0.{name}"][1:] for name in ("s_q", "gap_q", "traction_q", "damage_q", "X_euvi", "u_euvi")}
    short |= {"stress_euv": whole["0.stress_euv"][..., 1:], "s_q": whole["0.s_q"].astype(str)}
    for name, array in short.items():
        path.write_bytes(as_npz(**{**whole, f"0.{name}": array}))
        with pytest.raises(Damaged, match="fields.npz"):
            read_fields(path)
    path.write_bytes(as_npz(**{**whole, "0.stress_euv": np.zeros(0)}))
    assert len(read_fields(path)) == 3, "stress is not told by every code"


def test_of_a_row_that_does_not_fit_on_the_disk_nothing_is_left(tmp_path):
    class Full(io.FileIO):
        def write(self, data: bytes) -> int:
            if self.tell() > 12:
                raise OSError(28, "No space left on device")
            return super().write(data[:7])

    with Full(tmp_path / "curve.csv", "w") as stream:
        _append(stream, ("a", "b"), {"a": 1.5, "b": 2.0})
        with pytest.raises(OSError, match="No space left on device") as raised:
            _append(stream, ("a", "b"), {"a": 1.0 / 3.0, "b": 2.0})
    assert raised.value.filename == str(tmp_path / "curve.csv") and raised.value.errno == 28
    assert (tmp_path / "curve.csv").read_text() == "1.5,2\n"


@dataclass(frozen=True)
class Line:
    name: str
    count: int
    size: float
    good: bool


TABLE = "name,count,size,good\na,3,0.5,True\nb,4,nan,False\n"


def test_a_table_is_read_as_it_was_written(tmp_path):
    path = tmp_path / "table.csv"
    path.write_text(TABLE)
    first, second = read_table(path, Line)
    assert first == Line("a", 3, 0.5, True) and (second.count, second.good) == (4, False) and np.isnan(second.size)


@pytest.mark.parametrize(
    ("before", "after", "why"),
    [
        ("3", "three", "invalid literal for int() with base 10: 'three'"),
        ("0.5", "half", "could not convert string to float: 'half'"),
        ("True", "yes", "a cell 'yes'"),
        ("name,count", "count,name", "the columns count, name, size, good"),
        (TABLE, "", "the columns of an empty file"),
    ],
)
def test_a_table_with_another_cell_is_damaged(before, after, why, tmp_path):
    path = tmp_path / "table.csv"
    path.write_text(TABLE.replace(before, after, 1))
    with pytest.raises(Damaged) as said:
        read_table(path, Line)
    assert str(said.value) == f"{path}: must be as debond has written it, got: {why}" and said.value.path == path


def test_a_method_that_no_ladder_has_is_damage(tmp_path):
    path = made_up_studies.cost(tmp_path / "cost") / "cost.csv"
    path.write_text(path.read_text().replace("dolfinx,1", "dolfinx,7"))
    with pytest.raises(Refusal, match="cost.csv: must be as debond has written it, got: the method 'dolfinx' of degre"):
        named([path.parent])


def test_a_verdict_lies_in_the_folder_of_its_case_and_basis(tmp_path):
    folder = made_up_studies.hard(tmp_path / "hard") / "coarse-czm2"
    (folder / "nurbs").rename(folder / "lagrange")
    with pytest.raises(Refusal, match="got: the verdict of coarse-czm2 on nurbs"):
        named([tmp_path / "hard"])


def test_a_table_that_was_changed_by_hand_is_named_by_its_hash(tmp_path, capsys):
    """The same number of rows, all of numbers: nothing else shows it, and checks read the other table."""
    run = tmp_path / "run"
    assert main(["solve", SCENE, "--dofs", "200", "--set", "load.opening=0.2", "--out", str(run)]) == 0
    curve = run / "curve.csv"
    assert damage(run, "result.json") == ""
    curve.write_text(curve.read_text().replace("1", "2", 1))
    assert damage(run, "result.json") == "curve.csv"
    capsys.readouterr()
    main(["compare", str(run), str(run)])
    assert f"{curve}: has been changed since the run wrote it: SHA-256" in capsys.readouterr().err
