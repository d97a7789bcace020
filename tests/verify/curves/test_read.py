"""Curves in files: what is read, and what is said of what cannot be."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from verify.curves.read import CurveError, Reading, read_curve
from verify.curves.text_table import Dialect, read_table

OPENING, LOAD = [0.0, 1.5, 3.0], [0.0, 2.5, 1.25]

#: What files look like that hold 0 1.5 3 and 0 2.5 1.25 in mm and N.
LAYOUTS = {
    "commas": "opening,load\n0,0\n1.5,2.5\n3,1.25\n",
    "other order, more columns": "step,load,iterations,opening\n0,0,1,0\n1,2.5,4,1.5\n2,1.25,3,3\n",
    "capitals, blanks, quotes": '"Opening" , "LOAD"\n 0 , 0 \n 1.5 , 2.5 \n 3 , 1.25 \n',
    "units behind underscores": "Opening_(mm),Load_(N)\n0,0\n1.5,2.5\n3,1.25\n",
    "no header": "0,0\n1.5,2.5\n3,1.25\n",
    "tabs": "opening\tload\n0\t0\n1.5\t2.5\n3\t1.25\n",
    "blanks": "  opening     load\n  0.   0.\n  1.5  2.5\n  3.   1.25\n",
    "semicolons and decimal commas": "opening;load\n0;0\n1,5;2,5\n3;1,25\n",
    "tabs and decimal commas": "opening\tload\n0\t0\n1,5\t2,5\n3\t1,25\n",
    "blanks and decimal commas": "0 0\n1,5 2,5\n3 1,25\n",
    "decimal commas in every cell": "0,0 0,0\n1,5 2,5\n3,0 1,25\n",
    "separators at the end of rows": "opening,load\n0,0,\n1.5,2.5,\n3,1.25,,\n",
    "semicolons and points": "opening;load\n0;0\n1.5;2.5\n3;1.25\n",
    "byte order mark": "\ufeffopening,load\n0,0\n1.5,2.5\n3,1.25\n",
    "carriage returns": "opening,load\r\n0,0\r\n1.5,2.5\r\n3,1.25\r\n",
    "old Macintosh": "opening,load\r0,0\r1.5,2.5\r3,1.25\r",
    "comments": "# mine\n% too\n! and\n// this\n** also\nopening,load\n0,0\n# between\n1.5,2.5\n3,1.25\n",
    "header in a comment": "# load, opening\n0 0\n2.5 1.5\n1.25 3\n",
    "units below the header": "opening;load\nmm;N\n\n0;0\n1.5;2.5\n3;1.25\n",
    "a title above the header": "Peel test 7 of Monday\nopening,load\n0,0\n1.5,2.5\n3,1.25\n",
    "a column of words": "increment,opening,load\nfirst,0,0\nsecond,1.5,2.5\nthird,3,1.25\n",
    "an empty column": "opening,note,load,\n0,,0,\n1.5,,2.5,\n3,,1.25,\n",
    "results of a machine above its names": '"Width","25.00","mm"\n"Label","A1"\n\n"Time","Extension","Load"\n'
    '"(s)","(mm)","(N)"\n"0","0","0"\n"1","1.5","2.5"\n"2","3","1.25"\n',
    "two results above its names": '"Width","Thickness"\n25,3\n"Displacement (mm)","Force (N)"\n0,0\n1.5,2.5\n3,1.25\n',
    "Fortran": "opening load\n0.0D0 0.0D+00\n1.5D0 0.25D+01\n3.0d0 1.25d0\n",
}


@pytest.fixture
def file(tmp_path):
    def write(content: str | bytes) -> Path:
        path = tmp_path / "curve.txt"
        path.write_bytes(content.encode() if isinstance(content, str) else content)
        return path

    return write


@pytest.mark.parametrize("layout", LAYOUTS)
def test_layouts(layout, file):
    np.testing.assert_array_equal(read_curve(file(LAYOUTS[layout])), [OPENING, LOAD])


@pytest.mark.parametrize("encoding", ["utf-16", "latin-1"])
def test_encodings(encoding, file):
    text = "# über Öffnung\nopening;load\n0;0\n1,5;2,5\n3;1,25\n"
    np.testing.assert_array_equal(read_curve(file(text.encode(encoding))), [OPENING, LOAD])


#: Tables in other columns, or units: the history of an Abaqus node in m and mN, with the reaction against the motion.
HISTORY = "\n\nX, U2, RF2\n0., 0., 0.\n0.5, 1.5E-03, -2500.\n1., 3.E-03, -1250.\n \n"
READINGS = [
    *((HISTORY, Reading(*columns, 1e3, -1e-3)) for columns in (("U2", "RF2"), ("u2", "rf2"), (2, 3), ("U2", 3))),
    (HISTORY.replace(", ", ";"), Reading("U2", "RF2", 1e3, -1e-3)),
    (HISTORY.replace(", ", "   "), Reading("U2", "RF2", 1e3, -1e-3)),
    ("9 0 7 0\n9 2.5 7 1.5\n9 1.25 7 3\n", Reading(4, 2)),
    ("opening,load,gap,force\n9,9,0,0\n9,9,1.5,2.5\n9,9,3,1.25\n", Reading("gap", "force")),
    ("Count,Load step,FrameDisp_(mm),Load-1 (N),CrackExt\n0,0,0,0,9\n1,1,1.5,2.5,9\n2,2,3,1.25,9\n", Reading()),
    ("Test,3\nDisp,DispRate,Load\nmm,mm/s,N\n0,1,0\n1.5,1,2.5\n3,1,1.25\n", Reading(load="Load")),
]


@pytest.mark.parametrize(("text", "reading"), READINGS)
def test_columns_by_name_and_number_in_other_units(text, reading, file):
    np.testing.assert_allclose(read_curve(file(text), reading), [OPENING, LOAD], rtol=1e-15)


#: text, reading, and what must be said after the name of the file
REFUSED = [
    ("", Reading(), ": must hold a curve of at least 2 points, got an empty file"),
    ("# only\n", Reading(), ": must hold a curve of at least 2 points, got remarks alone"),
    ("opening,load\n", Reading(), ": must hold at least 2 points of different opening, got 0"),
    ("opening,load\n0,0\n", Reading(), ": must hold at least 2 points of different opening, got 1"),
    ("opening,load\n1,0\n1,2\n", Reading(), ": must hold at least 2 points of different opening, got 2, all at 1"),
    ("opening,load\n0,5,1,5\n1,5,2,5\n", Reading(), ":2: must have 2 columns as above, got 4; decimal commas?"),
    ("opening,load\n0,5\n1,5,2\n", Reading(), ":3: must have 2 columns as above, got 3"),
    (
        "Specimen,3\nTravel,Force N\nmm,N\n0,0\n1,2\n",
        Reading(),
        ":2: the header must name opening and load, got Travel",
    ),
    ("Disp A,Disp B,Load\n0,0,0\n1,1,1\n", Reading(), ":1: the header must name opening, got Disp A, Disp B, Load"),
    ("Test,3,x\nTravel,Axial\n0,0\n1,2\n", Reading(), ":2: the header must name opening and load, got Travel, Axial"),
    (
        "opening,load\n0,0\n-1,2\n",
        Reading(),
        ": the openings must go above 0, got at most 0; an opening scale of -1 turns signs",
    ),
    (
        "opening,load\n0,0\n1,2\n",
        Reading(opening_scale=-1.0),
        ": the openings must go above 0, got at most 0; an opening scale",
    ),
    ("opening,load\n3,1\n1,2\n0,0\n", Reading(), ": the opening must grow from the first point on, got the largest, 3"),
    ("X,U2,RF2\n0,0,0\n1,1,1\n", Reading(), ":1: the header must name opening and load, got X, U2, RF2;"),
    (
        '"Width","25.0","mm"\n"Time","Gauge","Load"\n0,0,0\n1,1,1\n',
        Reading(),
        ":2: the header must name opening, got Time, Gauge, Load;",
    ),
    ("\nX,U2,RF2\n0,0,0\n", Reading("U2", "RF3"), ":2: the header must name RF3, got X, U2, RF2;"),
    ("X,U2,U2\n0,0,0\n", Reading("X", "U2"), ":1: must have one column 'U2', got X, U2, U2;"),
    ("X,U2\n0,0\n", Reading("X", 3), ":1: has 2 columns, got column number 3"),
    ("X,U2\n0,0\n", Reading("X", 1), ":1: opening and load must be different columns, got column 1 for both"),
    ("0,0\n1,1\n", Reading("U2"), ":1: has no header, so columns go by number, got U2 and load"),
    ("0\n1\n", Reading(), ":1: must have two columns, opening and load, got 1"),
    ("words\nand more\n", Reading(1, 2), ": must hold at least 2 points of different opening, got no number"),
    ("opening,load\n0,0\n1,x\n", Reading(), ":3: column 'load' must be a finite number, got 'x'"),
    ("opening,load\n0,O\n1,1\n2,2\n", Reading(), ":2: column 'load' must be a finite number, got 'O'"),
    ("opening,load\n0,0\n\n1,nan\n", Reading(), ":4: column 'load' must be a finite number, got 'nan'"),
    ("0,0\ninf,1\n", Reading(), ":2: column 1 must be a finite number, got 'inf'"),
    ("0;0\n1;1_0\n2;1\n", Reading(), ":2: column 2 must be a finite number, got '1_0'"),
    ("opening,load\n0,0\n1\n", Reading(), ":3: column 'load' must be a finite number, got ''"),
    ("opening,load\n0,0\n1,5,2,5\n", Reading(), ":3: must have 2 columns as above, got 4"),
    ("X (s) U2 RF2\n0 1 2\n1 2 3\n", Reading("X", "U2"), ":2: must have 4 columns as above, got 3"),
    ("opening,load\n0,0\n1,1e200\n", Reading(load_scale=1e200), ": must hold finite numbers, got 1 and inf in point 2"),
    (b"\0\1\2", Reading(), ": must be a file with a curve, got: not a text"),
]


@pytest.mark.parametrize(("content", "reading", "words"), REFUSED)
def test_what_is_wrong_is_named_with_line_and_column(content, reading, words, file):
    path = file(content)
    with pytest.raises(CurveError) as refusal:
        read_curve(path, reading)
    assert str(refusal.value).startswith(f"{path}{words}")


def test_a_file_that_is_not_there(tmp_path):
    with pytest.raises(CurveError, match="no.csv: must be a file with a curve, got: No such file"):
        read_curve(tmp_path / "no.csv")
    with pytest.raises(CurveError, match=r"curve.csv: must be a file with a curve, got: No such file"):
        read_curve(tmp_path)


@pytest.mark.parametrize("keys", [{"opening": 0}, {"load": -1}, {"load_scale": 0.0}, {"opening_scale": np.inf}])
def test_readings_that_make_no_sense(keys):
    with pytest.raises(CurveError, match=next(iter(keys))):
        Reading(**keys)


@pytest.mark.parametrize(
    ("text", "separator", "comma"),
    [
        *(("opening;load\n".replace(";", mark or " "), mark, False) for mark in (";", "\t", ",", "")),  # by the header
        ("", "", False),
        ("1,5\n2,6\n", ",", False),  # where a comma could be either it separates
        ("1;5\n2;6\n", ";", False),
        ("\n".join([f"{i}.5,{i}.25" for i in range(40)] + [f"{i},5\t{i},25" for i in range(10_000)]), "\t", True),
    ],
)
def test_dialects(text, separator, comma):
    """Most rows decide wherever they stand."""
    assert read_table(text).dialect == Dialect(separator, comma)


def test_only_comments_above_the_first_row_are_remarks():
    table = read_table("# opening, load\n//// second\n0,0\n# third\n1,1\n")
    assert table.remarks == [(1, ["opening", "load"]), (2, ["second"])] and len(table.body) == 2


@pytest.mark.parametrize(
    ("cell", "value"),
    [("1.5", 1.5), ("-1.5D-3", -1.5e-3), ("2d2", 200.0), ("inf", np.inf), ("1_0", None), ("", None), ("d", None)],
)
def test_numbers_of_a_cell(cell, value):
    assert Dialect(",", False).value(cell) == value
    assert Dialect(";", True).value(cell.replace(".", ",")) == value


NUMBER = st.floats(-1e6, 1e6, allow_subnormal=False).map(lambda x: x + 0.0)


@given(
    points=st.lists(st.tuples(NUMBER, NUMBER, NUMBER), min_size=2, max_size=20),
    separator=st.sampled_from([",", ";", "\t", " "]),
    comma=st.booleans(),
    header=st.booleans(),
)
@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_what_is_written_is_read(points, separator, comma, header, file):
    """Whatever the separator and the decimal mark, to the last digit."""
    points = [(0.0, 0.25, 0.0), *points, (1e7, 0.0, 0.5)]
    comma = comma and separator != ","
    lines = [separator.join(map(repr, point)) for point in points]
    text = "\n".join(line.replace(".", ",") if comma else line for line in lines)
    d, P = read_curve(
        file((separator.join("abc") + "\n" if header else "") + text), Reading("a", "c") if header else Reading(1, 3)
    )
    np.testing.assert_array_equal(d, [point[0] for point in points])
    np.testing.assert_array_equal(P, [point[2] for point in points])


@pytest.mark.parametrize("end", ["End of test", "\nEnd of test;;\n;\n", "Prüfung um 12:30 beendet"])
def test_words_below_the_last_row_are_no_rows(end, file):
    for separator in (";", " "):
        rows = "opening;load\n0;0\n1;2\n".replace(";", separator)
        assert read_curve(file(rows + end))[1].tolist() == [0.0, 2.0]


def test_a_cell_longer_than_any_is_a_cell():
    """Of more than 128 kB, which is more than a reader of CSV takes."""
    long = 200_000 * "9"
    assert Dialect(";", False).cells(f"1;{long};2;") == ["1", long, "2"]
