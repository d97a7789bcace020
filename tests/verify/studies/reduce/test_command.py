"""`debond reduce` on files: what it prints and writes, and the sentence for whatever is wrong."""

import csv
import json
from collections.abc import Callable
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
def folder(tmp_path, monkeypatch):
    """A folder to stand in, with a test in N and mm and its specimen."""
    monkeypatch.chdir(tmp_path)
    Path("test.csv").write_text(text_of(recorded("dcb", Rig(rows=400))))
    Path("mine.toml").write_text(SCENE)
    return tmp_path


def test_a_laboratory_file_from_units_to_page(folder, capsys):
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


def test_units_by_scales_and_columns_by_number(folder):
    test = recorded("dcb", Rig(rows=400))
    np.savetxt("plain.txt", np.stack([test.load / 1e3, -test.opening / 1e3], axis=1))
    words = ["--opening", "2", "--load", "1", "--opening-scale", "-1e3", "--load-scale", "1e3", "--out", "out"]
    assert main(["reduce", "plain.txt", "--scene", "mine.toml", *words]) == 0
    found = json.loads(Path("out/reduce.json").read_text())
    assert found["schemes"]["CBBM"]["propagation"]["value"] == pytest.approx(TESTS["dcb"][1], rel=1e-3)


def test_rotations_in_degrees_give_j(folder):
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


def test_calibration_of_an_enf(folder):
    Path("enf.csv").write_text(text_of(recorded("enf", Rig(rows=400, readings=2))))
    words = ["--calibration", "20,3.4e-3,30,3.9e-3,40,5.2e-3", "--out", "out"]
    assert main(["reduce", "enf.csv", "--scene", "enf-as4peek", *words]) == 0
    found = json.loads(Path("out/reduce.json").read_text())["schemes"]
    assert found["CC"]["constants"]["m"]["value"] == pytest.approx(3.2e-8, rel=0.05)
    assert found["CBBM"]["bias"] == pytest.approx(0.0, abs=1e-3) and found["CBBM"]["input"] == 1.719


PLAIN = text_of(recorded("dcb", Rig(rows=400)))
ROWS, TOP = PLAIN.splitlines()[1:], int(np.argmax(recorded("dcb", Rig(rows=400)).load))


def changed(change: Callable[[int, list[str]], list[str] | None]) -> str:
    """The test with the cells that ``change`` makes of the row of a number; without the row where it is None."""
    rows = [change(i, row.split(",")) for i, row in enumerate(ROWS)]
    return "\n".join(["opening,load,a", *(",".join(row) for row in rows if row is not None)])


def only(keep: Callable[[int], bool]) -> str:
    return changed(lambda i, row: row if keep(i) else None)


def cracks(*values: str) -> str:
    """The test with these crack lengths in its last rows alone."""
    lengths = ["", *values]
    return changed(lambda i, row: [*row[:2], lengths[max(i - len(ROWS) + len(lengths), 0)]])


DASH = changed(lambda i, row: [*row[:2], "-" if i == 0 else row[2]]).replace("load,a\n", "load,crack_length\n")
#: Content of the file, options, and what the sentence must say.
BAD = [
    ("", [], "got an empty file"),
    (PLAIN, ["--crack", "length"], "length"),
    (PLAIN, ["--crack", "9"], "has 3 columns"),
    (cracks("long"), ["--crack", "a"], "must be a finite number, got 'long'"),
    (DASH, [], "must be a finite number, got '-'"),
    (PLAIN, ["--load-scale", "-1"], "a load scale of -1 turns signs"),
    (changed(lambda i, row: [row[0], "0", row[2]]), [], "loads must go above 0, got at most 0 "),
    (only(lambda i: i == 0 or i > TOP), ["--linear", "0.2,0.5"], "at least 3 points"),
    (only(lambda i: i < TOP - 2), [], "until the crack grows"),
    (cracks("60", "50", "55"), ["--crack", "a"], "must not decrease, got 50"),
    (cracks("1.4", "2"), ["--crack", "a"], "in another unit (--crack-scale 25.4) or its growth (--crack-offset 32.9)?"),
    (
        cracks("30", "50"),
        ["--crack", "a"],
        "; told from another place than the load (--crack-offset), or of another specimen?",
    ),
    (cracks("60", "150"), ["--crack", "a"], "<= specimen.length = 102, got 150; told from another place"),
    (PLAIN, ["--machine-compliance", "1.0"], "must be less than that of machine and specimen"),
    (PLAIN, ["--linear", "0.5,0.2"], "must be two parts of the largest load"),
    (PLAIN, ["--begin", "5", "--end", "2"], "must be less than --end"),
    (PLAIN, ["--block", "3"], "--block: must be two lengths"),
    (PLAIN, ["--calibration", "20,1e-3,30"], "--calibration: must be crack lengths"),
    (PLAIN, ["--rotations", "1,2,3"], "must be up to two of a dcb or adcb"),
    (PLAIN, ["--opening-scale", "1e-3"], "moduli, lengths, units"),
    (PLAIN, ["--fit"], "needs the table [interface]"),
    (PLAIN, ["--calibration", "1,1,2,2"], "whose CC has none"),
    (PLAIN, ["--scene", "moments"], "specimen.kind: must be"),
    (PLAIN, ["--scene", "mmb50-as4peek", "--bridging"], "--bridging: must be for dcb"),
    (PLAIN, ["--scene", "enf-as4peek", "--large"], "factors of a dcb"),
    (PLAIN, ["--scene", "enf-as4peek", "--set", "specimen.arm_thickness=[1.5, 2.0]"], "arms must be alike"),
    (PLAIN, ["--scene", "mmb50-as4peek", "--fit"], "--fit: must be for dcb"),
]


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--load-scale", "1e-3"], "loads in kN (--load-scale 1000)"),
        (["--load-scale", str(1 / 4.4482)], "loads in lbf (--load-scale 4.4482)"),
        (["--load-scale", str(1 / 25.4)], "loads over the width (--load-scale 25.4)"),
        (["--opening-scale", "0.5"], "half openings (--opening-scale 2)"),
        (["--load-scale", str(1 / 60)], "units of loads, openings or moduli? A wrong specimen?"),
        (["--set", "specimen.precrack=35"], "a wrong modulus, precrack or machine compliance"),
    ],
)
def test_a_flexural_modulus_that_is_far_off_is_a_unit(words, said, folder, capsys):
    """And a little off something else."""
    Path("plain.csv").write_text(PLAIN)
    assert main(["reduce", "plain.csv", "--scene", "mine.toml", *words]) == 0
    assert said in capsys.readouterr().err


@pytest.mark.parametrize(("text", "words", "sentence"), BAD)
def test_what_cannot_be_reduced(text, words, sentence, folder, capsys):
    Path("bad.csv").write_text(text)
    assert code("bad.csv", "--scene", "mine.toml", *words) == 2
    said = capsys.readouterr().err
    assert sentence in said.replace("\n", " ") and "Traceback" not in said


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["test.csv"], "--scene: must name the specimen"),
        (["no.csv", "--scene", "mine.toml"], "must be a file with a curve"),
        ([".", "--scene", "mine.toml"], "must be a file with a curve"),
    ],
)
def test_files_that_cannot_be(words, sentence, folder, capsys):
    assert code(*words) == 2
    assert sentence in capsys.readouterr().err


def code(*words: str) -> int:
    """Exit code of the command."""
    try:
        return main(["reduce", *words])
    except SystemExit as error:
        return int(error.code or 0)
