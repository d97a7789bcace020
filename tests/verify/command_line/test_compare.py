"""Two files of curves against each other: the command, its tolerances, what it refuses, and its page."""

from __future__ import annotations

import json
import sys
from html.parser import HTMLParser
from pathlib import Path

import pytest
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st

from verify.cli import main

EXAMPLE = Path(__file__).parents[3] / "examples" / "regression_test"
MAPPED = ["--opening-a", "U2", "--load-a", "RF2", "--opening-scale-a", "-2", "--load-scale-a", "-1e3"]


def command(folder: Path, *arguments: str) -> int:
    try:
        return main(["compare", *arguments])
    except SystemExit as end:  # argparse
        return int(end.code or 0)


@pytest.fixture
def files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    for name in ("abaqus.csv", "expected.csv"):
        (tmp_path / name).write_bytes((EXAMPLE / name).read_bytes())
    return tmp_path


def test_other_columns_and_units_are_mapped(files: Path, capsys: pytest.CaptureFixture) -> None:
    tolerances = ["--curve-tol", "0.001", "--peak-tol", "0.001", "--energy-tol", "0.001"]
    assert command(files, "abaqus.csv", "expected.csv", *MAPPED, *tolerances) == 0
    assert capsys.readouterr().out.count("holds") == 5
    by_number = ["--opening-b", "2", "--load-b", "3", "--opening-scale-b", "-2", "--load-scale-b=-1000"]
    assert command(files, "expected.csv", "abaqus.csv", *by_number, *tolerances) == 0


def test_the_beginning_of_the_command(files: Path, capsys: pytest.CaptureFixture) -> None:
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
def test_each_tolerance_judges(tolerance, words, files: Path, capsys: pytest.CaptureFixture) -> None:
    assert command(files, "abaqus.csv", "expected.csv", *MAPPED) == 0
    assert command(files, "abaqus.csv", "expected.csv", *MAPPED, *tolerance) == 1
    assert words in capsys.readouterr().err


REFUSED = {
    "abaqus.csv expected.csv": "abaqus.csv:3: the header must name opening and load, got X, U2, RF2",
    "abaqus.csv expected.csv --opening-a U3 --load-a RF2": "abaqus.csv:3: the header must name U3, got X, U2, RF2",
    "abaqus.csv expected.csv --opening-a U2 --load-a RF2": "the openings must go above 0, got at most 0; a scale of -1",
    "expected.csv abaqus.csv --opening-b 2 --load-b 4": "abaqus.csv:4: has 3 columns, got column number 4",
    "expected.csv expected.csv --end 3.5": "end: must be > 0 and <= 3, the last opening of B, got 3.5",
    "expected.csv expected.csv --begin 3": "begin: must be < 3, the end of the comparison, got 3",
    "expected.csv expected.csv --begin 1 --end 1": "begin: must be < 1, the end of the comparison, got 1",
    "expected.csv expected.csv --begin -1": "begin: must be >= 0, got -1",
    "expected.csv expected.csv --begin x": "argument --begin: must be a finite number, got 'x'",
    "expected.csv expected.csv --begin 1 --at 0.5": "at: must be > 1 and <= 3, the end of the comparison, got 0.5",
    "expected.csv expected.csv --at 1,4": "at: must be > 0 and <= 3, the end of the comparison, got 4",
    "expected.csv expected.csv --at 1,x": "argument --at: must be a finite number, got 'x'",
    "expected.csv expected.csv --load-scale-a 0": "--load-scale-a: must be a finite number other than 0, got '0'",
    "expected.csv expected.csv --load-scale-b nan": "argument --load-scale-b: must be a finite number, got 'nan'",
    "expected.csv expected.csv --peak-tol -1": "argument --peak-tol: must be a number >= 0, got '-1'",
    "expected.csv expected.csv --out expected.csv": "--out: must be a folder that can be written to",
    "expected.csv . --curve-tol 1": "curve.csv: must be a file with a curve, got: No such file or directory",
}


@pytest.mark.parametrize("line", REFUSED)
def test_bad_input(line: str, files: Path, capsys: pytest.CaptureFixture) -> None:
    before = sorted(files.rglob("*"))
    assert command(files, *line.split()) == 2
    said = capsys.readouterr()
    assert REFUSED[line] in said.err and said.out == "" and sorted(files.rglob("*")) == before


class Page(HTMLParser):
    """Counts elements and checks that they are closed in order."""

    EMPTY = ("meta", "br", "link")

    def __init__(self, text: str) -> None:
        super().__init__()
        self.open, self.count = [], {}
        self.feed(text)
        assert self.open == []

    def handle_starttag(self, tag, attrs):
        self.count[tag] = self.count.get(tag, 0) + 1
        if tag not in self.EMPTY:
            self.open.append(tag)

    def handle_startendtag(self, tag, attrs):
        self.count[tag] = self.count.get(tag, 0) + 1

    def handle_endtag(self, tag):
        assert self.open.pop() == tag


def test_out_holds_the_numbers_and_the_page(files: Path, capsys: pytest.CaptureFixture) -> None:
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
    page = Page(text)
    assert page.count["svg"] == 2 and "<b>&" not in text and "&lt;b&gt;&amp;.csv" in text
    assert "A is not within the tolerances." in text and "+0.06162 %" in text
    assert "http" not in text.replace("http://www.w3.org", "")  # self-contained


def test_numbers_are_written_without_matplotlib(files: Path, monkeypatch, capsys: pytest.CaptureFixture) -> None:
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    for name in [name for name in sys.modules if name.startswith(("verify.report", "verify.pages", "matplotlib."))]:
        monkeypatch.delitem(sys.modules, name)
    assert command(files, "expected.csv", "expected.csv", "--out", "here") == 0
    assert [path.name for path in (files / "here").iterdir()] == ["comparison.json"]
    assert "no page without matplotlib" in capsys.readouterr().err


CELL = st.one_of(
    st.sampled_from(
        [
            "",
            "0",
            "1",
            "2,5",
            "-1",
            "nan",
            "inf",
            "1e308",
            "-1e308",
            "5e-324",
            "1e-300",
            "x",
            '"',
            "opening",
            "load",
            "#",
        ]
    ),
    st.floats().map(repr),
    st.text(max_size=5),
)
TABLES = st.lists(st.lists(CELL, max_size=4), max_size=8).flatmap(
    lambda rows: st.sampled_from([",", ";", "\t", " ", ", "]).map(
        lambda separator: "\n".join(separator.join(row) for row in rows)
    )
)
NUMBERS = st.lists(st.tuples(st.floats(), st.floats()), max_size=6).map(
    lambda points: "opening,load\n0,0\n" + "\n".join(f"{d!r},{P!r}" for d, P in points)
)
CONTENTS = st.one_of(TABLES, NUMBERS, st.text()).map(lambda text: text.encode("utf-8", "surrogatepass")) | st.binary()


@given(a=CONTENTS, b=CONTENTS | st.just(b"opening,load\n0,0\n1,2\n3,1\n"))
@example(a=b"opening,load\n0,0\n1,1e308\n2,-1e308\n", b=b"opening,load\n0,0\n5e-324,5e-324\n")
@example(a=b"opening,load\n0,0\n1,1e308\n2,1e308\n", b=b"opening,load\n0,0\n1,1e-308\n2,1e-308\n")
@example(a=b"opening,load\n0,0\n1e200,1e200\n", b=b"opening,load\n0,0\n1e200,1e200\n")
@example(a=b"opening,load\n-1e308,0\n1e308,1e308\n", b=b"opening,load\n0,0\n1,1\n")
@settings(max_examples=150, suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow])
@pytest.mark.filterwarnings("error")
def test_no_content_of_a_file_ends_in_a_traceback(a: bytes, b: bytes, files: Path, capsys) -> None:
    (files / "a.csv").write_bytes(a)
    (files / "b.csv").write_bytes(b)
    code = command(files, "a.csv", "b.csv", "--curve-tol", "0.1", "--peak-tol", "0.1", "--energy-tol", "0.1")
    said = capsys.readouterr()
    assert code in (0, 1, 2)
    assert (code == 2) == (said.out == "") and (code == 0 or said.err.startswith("debond: "))


def test_a_page_that_cannot_be_made_for_want_of_something_else_is_an_error(tmp_path: Path, monkeypatch) -> None:
    """What is missing is named; only what is optional may be."""
    pytest.importorskip("jinja2")
    monkeypatch.setitem(sys.modules, "verify.report.comparison", None)
    words = [str(EXAMPLE / "abaqus.csv"), str(EXAMPLE / "abaqus.csv"), "--opening-a", "U2", "--load-a", "RF2"]
    words += ["--opening-b", "U2", "--load-b", "RF2", "--opening-scale-a", "-2", "--opening-scale-b", "-2"]
    words += ["--load-scale-a", "-1e3", "--load-scale-b", "-1e3", "--out", str(tmp_path)]
    with pytest.raises(ModuleNotFoundError, match="verify.report.comparison"):
        main(["compare", *words])


def test_it_says_where_it_has_written(tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    (tmp_path / "a.csv").write_text("opening,load\n0,0\n1,2\n3,1\n")
    words = ["compare", str(tmp_path / "a.csv"), str(tmp_path / "a.csv")]
    assert main(words) == 0 and "written" not in capsys.readouterr().out
    assert main([*words, "--out", str(tmp_path / "out")]) == 0
    assert f"written: {tmp_path / 'out'}\n" in capsys.readouterr().out
    assert (tmp_path / "out" / "comparison.json").exists()


def test_a_place_to_write_to_is_made_or_refused(tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    (tmp_path / "a.csv").write_text("opening,load\n0,0\n1,2\n3,1\n")
    words = ["compare", str(tmp_path / "a.csv"), str(tmp_path / "a.csv"), "--out"]
    assert main([*words, str(tmp_path / "some" / "where")]) == 0
    assert (tmp_path / "some" / "where" / "comparison.json").exists()
    assert main([*words, str(tmp_path / "a.csv")]) == 2
    assert "--out: must be a folder that can be written to" in capsys.readouterr().err
