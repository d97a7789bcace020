"""Files as laboratories have them: units in headers, growth, sheets of readings, workbooks, coupons of one plate."""

import csv
import json
from pathlib import Path

import numpy as np
import openpyxl
import pytest
from made_up_tests import TESTS, Rig, recorded, text_of

from tests.verify.studies.reduce.test_command import SCENE
from verify.cli import main
from verify.curves.units import Unit, unit, unit_of_column, units_of

TRUE, PRECRACK = TESTS["dcb"][1], 32.9
READ = recorded("dcb", Rig(rows=600))


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("mine.toml").write_text('units = "N, mm, MPa"\n' + SCENE)
    return tmp_path


def reduced(*words: str) -> dict[str, float]:
    """Scheme -> its propagation value."""
    assert main(["reduce", *words, "--scene", "mine.toml", "--out", "out"]) == 0
    schemes = json.loads(Path("out/reduce.json").read_text())["schemes"]
    return {name: one["propagation"]["value"] for name, one in schemes.items() if "propagation" in one}


@pytest.mark.parametrize(
    ("opening", "load", "d", "P"),
    [
        ("Opening (mm)", "Load (kN)", 1.0, 1e-3),
        ("opening [in]", "load [lbf]", 1 / 25.4, 1 / 4.4482216152605),
        ("Opening_(µm)", "Load_(N)", 1e3, 1.0),
        ("opening_mm", "load_kN", 1.0, 1e-3),
        ("opening;mm", "load;kN", 1.0, 1e-3),  # units in a line of their own
        ("opening", "load", 1.0, 1.0),
        ("opening (kN)", "load (in)", 1.0, 1.0),  # neither is a unit of what it stands behind
        ("opening_M", "load_n", 1.0, 1.0),  # nor are these
    ],
)
def test_units_of_the_header_are_used(opening, load, d, P, folder, capsys):
    heads = list(zip(opening.split(";"), load.split(";"), strict=True))
    rows = [f"{a * d:.9g},{b * P:.9g}" for a, b in zip(READ.opening, READ.load, strict=True)]
    Path("test.csv").write_text("\n".join([*map(",".join, heads), *rows]))
    names = [] if heads[0] == ("opening", "load") else ["--opening", heads[0][0], "--load", heads[0][1]]
    assert reduced("test.csv", *names)["CBBM"] == pytest.approx(TRUE, rel=2e-3)
    said = capsys.readouterr().err
    assert said.count("by its header") == (d != 1.0) + (P != 1.0)


def test_a_scale_that_is_given_stands_for_the_unit(folder, capsys):
    rows = [f"{a:.9g},{b:.9g}" for a, b in zip(READ.opening, READ.load, strict=True)]
    Path("test.csv").write_text("\n".join(["opening (mm),load (kN)", *rows]))  # wrong, and known to be
    assert reduced("test.csv", "--load-scale", "1.000001")["CBBM"] == pytest.approx(TRUE, rel=2e-3)
    assert "by its header" not in capsys.readouterr().err


def test_words_that_are_units_and_words_that_are_not():
    assert unit_of_column("Load, kN") == Unit("kN", 1e3, False) and unit_of_column("crack length [in]").name == "in"
    for name in ("load", "time (s)", "m", "load cell 1", "displacement (channel 2)"):
        assert unit_of_column(name) is None
    assert unit("mN").size == 1e-3 and unit("MN").size == 1e6 and unit("KN").size == 1e3 and unit("mn") is None
    assert units_of("kN, m, kPa").force.size == 1e3 and units_of("consistent units").length is None


def test_growth_is_no_crack_length(folder, capsys):
    growth = READ.crack - PRECRACK
    rows = zip(READ.opening, READ.load, growth, strict=True)
    lines = [f"{d:.9g},{P:.9g},{'' if a != a else f'{a:.9g}'}" for d, P, a in rows]
    Path("test.csv").write_text("\n".join(["opening,load,da", *lines]))
    assert main(["reduce", "test.csv", "--scene", "mine.toml", "--crack", "da"]) == 2
    assert f"its growth (--crack-offset {PRECRACK:g})?" in capsys.readouterr().err
    found = reduced("test.csv", "--crack", "da", "--crack-offset", str(PRECRACK))
    assert found["MBT"] == pytest.approx(TRUE, rel=0.01)


def test_a_sheet_of_readings_has_the_schemes_that_need_no_linear_part(folder):
    sheet = READ.at(np.isfinite(READ.crack))
    Path("sheet.csv").write_text(text_of(sheet, "opening [mm],load [N],crack_length [mm]"))
    found = reduced("sheet.csv")
    a, d, P = sheet.crack, sheet.opening, sheet.load
    slope, at_zero = np.polyfit(a, np.cbrt(d / P), 1)
    assert found["MBT"] == pytest.approx(float(np.mean(1.5 * P * d / (25.4 * (a + at_zero / slope)))), rel=1e-9)
    assert {"MBT", "CC", "MCC", "CBT"} == set(found) and Path("out/reduce.html").is_file()
    missing = json.loads(Path("out/reduce.json").read_text())["schemes"]["CBBM"]["missing"]
    assert "needs a linear part" in missing


def test_the_opening_is_large_beside_the_crack_that_it_has(folder, capsys):
    """Without readings the precrack stood for the crack: every test whose crack grew far was called large."""
    for name, rig in (("with", Rig(rows=600)), ("without", Rig(rows=600, readings=20))):
        test = recorded("dcb", rig)
        text = text_of(test) if name == "with" else "\n".join(line.rpartition(",")[0] for line in text_of(test).split())
        Path(f"{name}.csv").write_text(text)
        reduced(f"{name}.csv", *(["--crack", "a"] if name == "with" else []))
    largest = float(np.nanmax(READ.opening / np.where(np.isfinite(READ.crack), READ.crack, np.nan)))
    assert largest < 0.4 < READ.opening.max() / PRECRACK and "--large" not in capsys.readouterr().err


def test_a_workbook_is_read(folder, capsys):
    book = openpyxl.Workbook()
    book.active.append(["about this test"])
    sheet = book.create_sheet("data")
    sheet.append(["opening (mm)", "load (kN)"])
    for d, P in zip(READ.opening, READ.load, strict=True):
        sheet.append([float(d), float(P) / 1e3])
    book.save("test.xlsx")
    Path("called.csv").write_bytes(Path("test.xlsx").read_bytes())
    assert reduced("called.csv") == reduced("test.xlsx")
    assert reduced("test.xlsx")["CBBM"] == pytest.approx(TRUE, rel=2e-3)
    for name, raw, said in (
        ("old.xls", b"\xd0\xcf\x11\xe0", "save its table as .xlsx or as CSV"),
        ("cut.xlsx", b"PK\x03\x04", "is cut off or broken; save its table"),
    ):
        Path(name).write_bytes(raw + bytes(40))
        assert main(["reduce", name, "--scene", "mine.toml"]) == 2
        assert said in capsys.readouterr().err


def test_coupons_of_a_plate_have_mean_deviation_and_variation(folder, capsys):
    """G goes with the inverse of the width: three coupons of one curve with widths of their own."""
    widths = (25.4, 25.4 / 1.1, 25.4 / 0.9)
    for i in range(3):
        Path(f"c{i}.csv").write_text(text_of(READ, "opening,load,crack_length"))
    rows = ["file;width", *(f"c{i}.csv;{w}".replace(f"{w}", f"{w}".replace(".", ",")) for i, w in enumerate(widths))]
    Path("coupons.csv").write_text("\n".join(rows))
    assert main(["reduce", "--coupons", "coupons.csv", "--scene", "mine.toml", "--out", "out"]) == 0
    with open("out/coupons.csv", newline="") as stream:
        rows = {(row["scheme"], row["value"]): row for row in csv.DictReader(stream)}
    mbt = rows["MBT", "propagation"]
    assert float(mbt["mean"]) == pytest.approx(TRUE, rel=0.01) and mbt["count"] == "3"
    assert float(mbt["deviation"]) / float(mbt["mean"]) == pytest.approx(0.1, rel=1e-6)
    assert "10.0%" in capsys.readouterr().out and Path("out/c1/reduce.json").is_file()
    assert Path("out/coupons.html").read_text().count("<svg") == 5
    for text, said in (
        ("name,width\nc0.csv,2", "the columns must be file and some of"),
        ("file,width", "a row for every coupon"),
        ("file,width\nc0.csv", "must have 2 columns as above, got 1"),
        ("file,width\nc0.csv,wide", "specimen.width"),
    ):
        Path("coupons.csv").write_text(text)
        assert main(["reduce", "--coupons", "coupons.csv", "--scene", "mine.toml"]) == 2
        assert said in capsys.readouterr().err
