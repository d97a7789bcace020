"""`debond reduce` on files: what it prints and writes, and the sentence for whatever is wrong."""

import csv
import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from made_up_tests import NOISY, TESTS, Rig, recorded, text_of

from verify.cli import main

SCENE = """
[specimen]
kind = "dcb"
length = 102.0
arm_thickness = 1.56
precrack = 32.9
width = 25.4
plane = "strain"

[material]
E1 = 122.7e3
E2 = 10.1e3
G12 = 5.5e3
nu12 = 0.25
nu23 = 0.45
"""


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder to stand in, with a test in N and mm and its specimen."""
    monkeypatch.chdir(tmp_path)
    Path("test.csv").write_text(text_of(recorded("dcb", Rig(rows=400))))
    Path("mine.toml").write_text(SCENE)
    return tmp_path


def test_a_laboratory_file_from_units_to_page(folder: Path, capsys: pytest.CaptureFixture) -> None:
    """Decimal commas, a line of units, kN, a toe, a machine; a scene without a bond."""
    text = text_of(recorded("dcb", replace(NOISY, rows=3000)), "way,force,a")
    header, *rows = text.splitlines()
    rows = [";".join(cell.replace(".", ",") for cell in row.split(",")) for row in rows]
    Path("lab.csv").write_text("\n".join([header.replace(",", ";"), "mm;N;mm", *rows]))
    words = ["--opening", "way", "--load", "force", "--crack", "a", "--machine-compliance", "1e-4", "--out", "out"]
    assert main(["reduce", "lab.csv", "--scene", "mine.toml", *words]) == 0
    found = json.loads(Path("out/reduce.json").read_text())
    for name in ("MBT", "CC", "MCC", "CBBM"):
        value = found["schemes"][name]["propagation"]
        assert abs(value["value"] - TESTS["dcb"][1]) < 2.0 * value["half_width"] < 0.1
    assert found["linear_part"]["toe"] == pytest.approx(0.3, abs=0.02)
    assert "input" not in found["schemes"]["CBBM"]  # the scene has no bond to hold it against
    assert found["schemes"]["J"] == {"missing": "needs rotations of the loaded ends"}
    with open("out/reduce.csv", newline="") as stream:
        curve = list(csv.DictReader(stream))
    assert {row["scheme"] for row in curve} == {"MBT", "CC", "MCC", "CBT", "CBBM"}
    assert sum(row["scheme"] == "MBT" for row in curve) == 20
    said = capsys.readouterr()
    assert "5%/max" in said.out and "± " in said.out and "J: needs rotations" in said.out
    assert "--large counts F and N in" in said.err


def test_units_by_scales_and_columns_by_number(folder: Path) -> None:
    test = recorded("dcb", Rig(rows=400))
    np.savetxt("plain.txt", np.stack([test.load / 1e3, -test.opening / 1e3], axis=1))
    words = ["--opening", "2", "--load", "1", "--opening-scale", "-1e3", "--load-scale", "1e3", "--out", "out"]
    assert main(["reduce", "plain.txt", "--scene", "mine.toml", *words]) == 0
    found = json.loads(Path("out/reduce.json").read_text())
    assert found["schemes"]["CBBM"]["propagation"]["value"] == pytest.approx(TESTS["dcb"][1], rel=1e-3)


def test_rotations_in_degrees_give_j(folder: Path) -> None:
    """Of the cantilevers of the closed form: theta = 6 P (a + D)^2 / (E b h^3)."""
    test = recorded("dcb", Rig(rows=400))
    P, a = test.load, np.where(np.isfinite(test.crack), test.crack, 32.9)
    theta = np.degrees(P * a**2 * 1e-6)
    rows = np.stack([test.opening, P, -theta, theta], axis=1)
    np.savetxt("turned.csv", rows, delimiter=",", header="opening,load,top,bottom", comments="")
    words = ["--rotations", "top,bottom", "--rotation-scale", str(np.pi / 180.0), "--out", "out"]
    assert main(["reduce", "turned.csv", "--scene", "mine.toml", *words]) == 0
    at = json.loads(Path("out/reduce.json").read_text())
    i = at["initiation_points"]["5%/max"]["point"] - 1
    J = P[i] * 2.0 * np.sin(np.radians(theta[i])) / 25.4
    assert at["schemes"]["J"]["initiation"]["5%/max"]["value"] == pytest.approx(J)


def test_calibration_of_an_enf(folder: Path) -> None:
    Path("enf.csv").write_text(text_of(recorded("enf", Rig(rows=400, readings=2))))
    words = ["--calibration", "20,3.4e-3,30,3.9e-3,40,5.2e-3", "--out", "out"]
    assert main(["reduce", "enf.csv", "--scene", "enf-as4peek", *words]) == 0
    found = json.loads(Path("out/reduce.json").read_text())["schemes"]
    assert found["CC"]["constants"]["m"]["value"] == pytest.approx(3.2e-8, rel=0.05)
    assert found["CBBM"]["bias"] == pytest.approx(0.0, abs=1e-3) and found["CBBM"]["input"] == 1.719


def cut(text: str, keep) -> str:
    """The rows of a CSV text whose number ``keep`` is true of, with its header."""
    header, *rows = text.splitlines()
    return "\n".join([header, *(row for i, row in enumerate(rows) if keep(i))])


PLAIN = text_of(recorded("dcb", Rig(rows=400)))
TOP = int(np.argmax(recorded("dcb", Rig(rows=400)).load))


def replaced(column: int, text: str, where: slice = slice(200, None)) -> str:
    """The test with other cells in a column."""
    header, *rows = PLAIN.splitlines()
    cells = [row.split(",") for row in rows]
    for row in cells[where]:
        row[column] = text
    return "\n".join([header, *(",".join(row) for row in cells)])


def cracks(*values: str) -> str:
    """The test with these crack lengths in its last rows alone."""
    header, *rows = PLAIN.splitlines()
    bare = [row.rpartition(",")[0] for row in rows]
    return "\n".join([header, *(f"{row}," for row in bare[: -len(values)]),
                      *(f"{row},{a}" for row, a in zip(bare[-len(values) :], values, strict=True))])  # fmt: skip


#: name -> content of the file (None: there is none), options, and what the sentence must say
BAD = {
    "no file": (None, [], "must be a file with a curve"),
    "empty": ("", [], "got an empty file"),
    "no number": ("opening,load\n", [], "must hold at least 2 points"),
    "one point": ("opening,load\n1,2\n", [], "at least 2 points"),
    "no load": ("opening,a\n0,1\n1,2\n", [], "must name load"),
    "no such crack": (PLAIN, ["--crack", "length"], "'length'|length"),
    "crack number": (PLAIN, ["--crack", "9"], "has 3 columns"),
    "crack is load": (PLAIN, ["--crack", "load"], "twice"),
    "crack as text": (replaced(2, "long"), ["--crack", "a"], "must be a finite number, got 'long'"),
    "a dash where no crack was read": (
        replaced(2, "-", slice(0, 1)).replace("load,a\n", "load,crack_length\n"),
        [],
        "must be a finite number, got '-'",
    ),
    "NaN load": (replaced(1, "nan"), [], "must be a finite number, got 'nan'"),
    "NaN opening": (replaced(0, "NaN"), [], "must be a finite number"),
    "infinite": (replaced(1, "inf"), [], "must be a finite number"),
    "downwards": (PLAIN, ["--load-scale", "-1"], "a load scale of -1 turns signs"),
    "backwards": (PLAIN, ["--opening-scale", "-1"], "a scale of -1 turns signs"),
    "no load at all": (replaced(1, "0", slice(None)), [], "loads must go above 0"),
    "closing alone": (cut(PLAIN, lambda i: i == 0 or i > TOP), ["--linear", "0.2,0.5"], "at least 3 points"),
    "loading alone": (cut(PLAIN, lambda i: i < TOP - 2), [], "until the crack grows"),
    "three points": (cut(PLAIN, lambda i: i in (0, TOP, 399)), [], "at least 3 points"),
    "crack decreases": (cracks("60", "50", "55"), ["--crack", "a"], "must not decrease, got 50"),
    "crack negative": (cracks("-60", "50", "55"), ["--crack", "a"], "must be above 0"),
    "crack in metres": (PLAIN, ["--crack", "a", "--crack-scale", "1e-3"], "units?"),
    "crack beyond": (cracks("60", "150"), ["--crack", "a"], "<= specimen.length = 102"),
    "machine too soft": (PLAIN, ["--machine-compliance", "1.0"], "must be less than that of machine and specimen"),
    "machine negative": (PLAIN, ["--machine-compliance", "-1e-4"], "must be >= 0"),
    "linear upside down": (PLAIN, ["--linear", "0.5,0.2"], "must be two parts of the largest load"),
    "linear beyond": (PLAIN, ["--linear", "0.5,2"], "must be two parts of the largest load"),
    "one of linear": (PLAIN, ["--linear", "0.5"], "must be two parts of the largest load"),
    "begin after end": (PLAIN, ["--begin", "5", "--end", "2"], "must be less than --end"),
    "block": (PLAIN, ["--block", "3"], "--block: must be two lengths"),
    "calibration": (PLAIN, ["--calibration", "20,1e-3,30"], "--calibration: must be crack lengths"),
    "zero scale": (PLAIN, ["--crack-scale", "0"], "other than 0"),
    "rotations of three": (PLAIN, ["--rotations", "1,2,3"], "must be one column or two"),
    "stiffer than shear": (PLAIN, ["--opening-scale", "1e-3"], "moduli, lengths, units"),
    "fit of no bond": (PLAIN, ["--fit"], r"needs the table \[interface\]"),
}


@pytest.mark.parametrize("name", BAD)
def test_what_cannot_be_reduced(name: str, folder: Path, capsys: pytest.CaptureFixture) -> None:
    text, words, sentence = BAD[name]
    if text is not None:
        Path("bad.csv").write_text(text)
    assert code("bad.csv", "--scene", "mine.toml", *words) == 2
    said = capsys.readouterr().err
    assert any(part in said.replace("\n", " ") for part in sentence.replace("\\", "").split("|")), said
    assert "Traceback" not in said


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["test.csv"], "--scene: must name the specimen"),
        (["test.csv", "--scene", "nosuch"], "neither a packaged scene nor a file"),
        (["test.csv", "--scene", "peel-60"], "specimen.kind: must be"),
        (["test.csv", "--scene", "moments"], "specimen.kind: must be"),
        (["test.csv", "--scene", "enf-as4peek", "--large"], "factors of a dcb"),
        (["test.csv", "--scene", "enf-as4peek", "--rotations", "3"], "must be of a dcb or adcb"),
        (["test.csv", "--scene", "enf-as4peek", "--set", "specimen.arm_thickness=[1.5, 2.0]"], "arms must be alike"),
        (["test.csv", "--scene", "mmb50-as4peek", "--fit"], "--fit: must be for dcb"),
        (["test.csv", "--scene", "mine.toml", "--calibration", "1,1,2,2"], "whose CC has none"),
        ([".", "--scene", "mine.toml"], "must be a file with a curve"),
        (["test.csv", "--scene", "mine.toml", "--set", "specimen.width=-1"], "specimen.width: must be > 0"),
    ],
)
def test_specimens_that_cannot_be(words: list, sentence: str, folder: Path, capsys: pytest.CaptureFixture) -> None:
    assert code(*words) == 2
    said = capsys.readouterr().err
    assert sentence in said and "Traceback" not in said


def code(*words: str) -> int:
    """Exit code of the command."""
    try:
        return main(["reduce", *words])
    except SystemExit as error:
        return int(error.code or 0)
