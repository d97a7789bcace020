"""Two files of curves against each other: the command, its tolerances, what it refuses, and its page."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import pytest

from verify.cli import main

EXAMPLE = Path(__file__).parents[3] / "examples" / "regression_test"
MAPPED = ["--opening-a", "U2", "--load-a", "RF2", "--opening-scale-a", "-2", "--load-scale-a", "-1e3"]


def command(folder: Path, *arguments: str) -> int:
    try:
        return main(["compare", *arguments])
    except SystemExit as end:  # argparse
        return int(end.code or 0)


@pytest.fixture
def files(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for name in ("abaqus.csv", "expected.csv"):
        (tmp_path / name).write_bytes((EXAMPLE / name).read_bytes())
    return tmp_path


def test_other_columns_and_units_are_mapped(files, capsys):
    tolerances = ["--curve-tol", "0.001", "--peak-tol", "0.001", "--energy-tol", "0.001"]
    assert command(files, "abaqus.csv", "expected.csv", *MAPPED, *tolerances) == 0
    assert capsys.readouterr().out.count("holds") == 5
    by_number = ["--opening-b", "2", "--load-b", "3", "--opening-scale-b", "-2", "--load-scale-b=-1000"]
    assert command(files, "expected.csv", "abaqus.csv", *by_number, *tolerances) == 0


def test_the_beginning_of_the_command(files, capsys):
    """A load that is off up to 1.5 does not count from 1.6 on."""
    rows = [line.split(",") for line in (files / "expected.csv").read_text().splitlines() if line[:1].isdigit()]
    off = [f"{d},{float(P) * (2 if float(d) < 1.5 else 1)}" for d, P, *_ in rows]
    (files / "off.csv").write_text("\n".join(["opening,load", *off]))
    assert command(files, "off.csv", "expected.csv", "--curve-tol", "0.01") == 1
    ours = ["off.csv", "expected.csv", "--begin", "1.6", "--curve-tol", "1e-9", "--out", "it"]
    assert command(files, *ours, "--peak-tol", "1e-9", "--energy-tol", "1e-9") == 0
    assert json.loads((files / "it" / "comparison.json").read_text())["begin"] == 1.6


@pytest.mark.parametrize(
    ("tolerance", "words"),
    [
        (["--curve-tol", "1e-4"], "curve error 0.04968 %, more than 0.01 %"),
        (["--tolerance", "1e-4"], "curve error 0.04968 %, more than 0.01 %"),
        (["--peak-tol", "5e-4"], "peak load differs by 0.06162 %, more than 0.05 %"),
        (["--energy-tol", "1e-4"], "energy differs by 0.01319 %, more than 0.01 %"),
    ],
)
def test_each_tolerance_judges(tolerance, words, files, capsys):
    assert command(files, "abaqus.csv", "expected.csv", *MAPPED) == 0
    assert command(files, "abaqus.csv", "expected.csv", *MAPPED, *tolerance) == 1
    assert words in capsys.readouterr().err


def test_out_holds_the_numbers_and_the_page(files, capsys):
    pytest.importorskip("matplotlib")
    pytest.importorskip("jinja2")
    (files / "<b>&.csv").write_bytes((files / "expected.csv").read_bytes())
    arguments = ["abaqus.csv", "<b>&.csv", *MAPPED, "--peak-tol", "1e-4", "--at", "0.5,1", "--out", "here"]
    assert command(files, *arguments) == 1
    found = json.loads((files / "here" / "comparison.json").read_text())
    assert found["curve_error"] == pytest.approx(4.968e-4, rel=1e-3)
    assert found["a"]["columns"] == {"opening": "U2", "load": "RF2"} and found["a"]["scales"]["load"] == -1e3
    assert not found["passed"] and not found["checks"]["peak-load"]["passed"] and found["checks"]["end"]["passed"]
    assert [load["opening"] for load in found["loads"]] == [0.5, 1.0]
    text = (files / "here" / "comparison.html").read_text(encoding="utf-8")
    assert text.count("<svg") == 2 and "<b>&" not in text and "&lt;b&gt;&amp;.csv" in text
    assert "A is not within the tolerances." in text and "+0.06162 %" in text
    assert "http" not in text.replace("http://www.w3.org", "")  # self-contained


def test_numbers_are_written_without_matplotlib(files, monkeypatch, capsys):
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    for name in [name for name in sys.modules if name.startswith(("verify.report", "verify.pages", "matplotlib."))]:
        monkeypatch.delitem(sys.modules, name)
    assert command(files, "expected.csv", "expected.csv", "--out", "here") == 0
    assert [path.name for path in (files / "here").iterdir()] == ["comparison.json"]
    assert "no page without matplotlib" in capsys.readouterr().err


def test_it_says_where_it_has_written(files, monkeypatch, capsys):
    """A page that cannot be made for want of something else than what is optional is an error."""
    assert command(files, "expected.csv", "expected.csv") == 0 and "written" not in capsys.readouterr().out
    assert command(files, "expected.csv", "expected.csv", "--out", "some/where") == 0
    assert "written: some/where\n" in capsys.readouterr().out and Path("some/where/comparison.json").exists()
    pytest.importorskip("jinja2")
    monkeypatch.setitem(sys.modules, "verify.report.comparison", None)
    with pytest.raises(ModuleNotFoundError, match="verify.report.comparison"):
        command(files, "expected.csv", "expected.csv", "--out", "here")


@pytest.mark.parametrize(("header", "d", "P"), [("opening [in],load (kN)", 25.4, 1e3), ("opening_mm;load_N", 1.0, 1.0)])
def test_units_of_headers_are_those_of_the_other_curve(header, d, P, tmp_path, capsys):
    comma = ";" if ";" in header else ","
    for name, first, length, force in (("a.csv", header, d, P), ("b.csv", "opening (mm),load (N)", 1.0, 1.0)):
        rows = [(0.0, 0.0), (1.0 / length, 2.0 / force), (2.0 / length, 1.0 / force)]
        by = comma if name == "a.csv" else ","
        (tmp_path / name).write_text("\n".join([first, *(f"{x!r}{by}{y!r}" for x, y in rows)]) + "\n")
    assert main(["compare", str(tmp_path / "a.csv"), str(tmp_path / "b.csv"), "--curve-tol", "1e-9"]) == 0
    assert capsys.readouterr().err.count("by its header") == 2 * (d != 1.0)


@pytest.mark.parametrize("turned", [False, True])
def test_a_file_is_converted_to_the_units_of_a_run(turned, tmp_path, capsys):
    folder = tmp_path / "run"
    settings = ("discretization.steps=20", "load.opening=0.4")
    words = [word for one in settings for word in ("--set", one)]
    assert main(["solve", "dcb-czm1-linear", "--method", "lefm", *words, "--out", str(folder)]) == 0
    lines = [line.split(",") for line in (folder / "curve.csv").read_text().splitlines()[1:]]
    rows = [f"{float(d) / 25.4!r},{float(P) / 1e3!r}" for d, P, *_ in lines]
    (tmp_path / "a.csv").write_text("\n".join(["opening (in),load (kN)", *rows]) + "\n")
    sides = [str(tmp_path / "a.csv"), str(folder)]
    assert main(["compare", *(sides[::-1] if turned else sides), "--curve-tol", "1e-9"]) == 0
