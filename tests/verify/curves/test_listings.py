"""Printed results of other programs, as they print them."""

import numpy as np
import pytest

from verify.curves.read import CurveError, Reading, read_curve

ABAQUS = """\
1  Abaqus 2023                  Date 01-Jan-2026   Time 10:00:00

                            INCREMENT     1 SUMMARY

 TIME INCREMENT COMPLETED  0.500    ,  FRACTION OF STEP COMPLETED  0.500

   THE FOLLOWING TABLE IS PRINTED FOR NODES BELONGING TO NODE SET UPPER

       NODE FOOT-   U2             RF2
            NOTE

        1235         1.0000E-02      2.000
        1236     SN  3.0000E-02      2.500

 MAXIMUM             3.0000E-02      2.500
 AT NODE               1236           1236

   THE FOLLOWING TABLE IS PRINTED FOR NODES BELONGING TO NODE SET LOWER

       NODE FOOT-   U2
            NOTE

          12        -2.0000E-02

                            INCREMENT     2 SUMMARY

   THE FOLLOWING TABLE IS PRINTED FOR NODES BELONGING TO NODE SET UPPER

       NODE FOOT-   U2             RF2
            NOTE

        1235         2.0000E-02      4.000
        1236         6.0000E-02      4.500

 MAXIMUM             6.0000E-02      4.500

   THE FOLLOWING TABLE IS PRINTED FOR NODES BELONGING TO NODE SET LOWER

       NODE FOOT-   U2
            NOTE

          12        -4.0000E-02

                            INCREMENT     3 SUMMARY

   THE FOLLOWING TABLE IS PRINTED FOR NODES BELONGING TO NODE SET UPPER

       NODE FOOT-   U2             RF2
            NOTE

        1235         3.0000E-02      5.000
"""
CALCULIX = """\

                        S T E P       1

                                INCREMENT     1

 displacements (vx,vy,vz) for set TIP and time  0.5000000E+00

         5  0.000000E+00  1.000000E-01  0.000000E+00
         6  0.000000E+00  3.000000E-01  0.000000E+00

 forces (fx,fy,fz) for set TIP and time  0.5000000E+00

         5  0.000000E+00  1.500000E+00  0.000000E+00
         6  0.000000E+00  2.500000E+00  0.000000E+00

 total force (fx,fy,fz) for set TIP and time  0.5000000E+00

         0.000000E+00  4.000000E+00  0.000000E+00

 displacements (vx,vy,vz) for set TIP and time  0.1000000E+01

         5  0.000000E+00  2.000000E-01  0.000000E+00
         6  0.000000E+00  6.000000E-01  0.000000E+00

 forces (fx,fy,fz) for set TIP and time  0.1000000E+01

         5  0.000000E+00  3.000000E+00  0.000000E+00
         6  0.000000E+00  5.000000E+00  0.000000E+00

 total force (fx,fy,fz) for set TIP and time  0.1000000E+01

         0.000000E+00  8.000000E+00  0.000000E+00
"""
POST26 = """\
 ***** ANSYS POST26 VARIABLE LISTING *****

     TIME            2 UY           3 FY
                     tip            pull
  0.10000E-01    0.20000        4.00000
  0.20000E-01    0.40000        8.00000

 ***** ANSYS POST26 VARIABLE LISTING *****

     TIME            2 UY           3 FY
                     tip            pull
  0.30000E-01    0.60000       -0.12000-102
"""
NODOUT = """\
 n o d a l   p r i n t   o u t   f o r   t i m e  s t e p       1                              ( at time 0.1000000E+00 )

 nodal point  x-disp     y-disp      z-disp      x-vel       y-vel       z-vel
        12  0.0000E+00  1.0000E-01 0.0000E+00-1.0000E+00 0.0000E+00 0.0000E+00
        13  0.0000E+00  3.0000E-01 0.0000E+00-1.0000E+00 0.0000E+00 0.0000E+00

 n o d a l   p r i n t   o u t   f o r   t i m e  s t e p       2                              ( at time 0.2000000E+00 )

 nodal point  x-disp     y-disp      z-disp      x-vel       y-vel       z-vel
        12  0.0000E+00  2.0000E-01 0.0000E+00-1.0000E+00 0.0000E+00 0.0000E+00
        13  0.0000E+00  6.0000E-01 0.0000E+00-1.0000E+00 0.0000E+00 0.0000E+00
"""
LISTINGS = {
    "abaqus": (ABAQUS, "U2 UPPER", "RF2", [0.02, 0.04], [4.5, 8.5]),
    "abaqus-lower": (ABAQUS, "u2 lower", "RF2", [0.02, 0.04], [4.5, 8.5]),
    "calculix": (CALCULIX, "vy", "fy", [0.2, 0.4], [4.0, 8.0]),
    "calculix-total": (CALCULIX, "time", "total fy", [0.5, 1.0], [4.0, 8.0]),
    "post26": (POST26, "tip", "pull", [0.2, 0.4, 0.6], [4.0, 8.0, -0.12e-102]),
    "nodout": (NODOUT, "time", "y-disp", [0.1, 0.2], [0.2, 0.4]),
}


@pytest.mark.parametrize("name", LISTINGS)
def test_a_listing_is_a_curve_by_the_names_that_it_prints(name, tmp_path):
    text, opening, load, d, P = LISTINGS[name]
    (tmp_path / "job.dat").write_text(text)
    scale = -1.0 if "lower" in opening else 1.0
    found = read_curve(tmp_path / "job.dat", Reading(opening, load, opening_scale=scale))
    assert np.allclose(found, [d, P], rtol=1e-12, atol=0.0)


@pytest.mark.parametrize("name", LISTINGS)
def test_what_a_job_still_writes_is_read_up_to_the_last_whole_increment(name, tmp_path):
    """Cut at every third letter: in a header, in a number, between the nodes of a set."""
    text, opening, load, d, P = LISTINGS[name]
    reading = Reading(opening, load, opening_scale=-1.0 if "lower" in opening else 1.0)
    for end in range(len(text) // 3, len(text), 3):
        (tmp_path / "job.dat").write_text(text[:end])
        try:
            found = read_curve(tmp_path / "job.dat", reading)
        except CurveError:
            continue
        n = len(found[0])
        assert np.allclose(found, [d[:n], P[:n]], rtol=1e-12, atol=0.0), text[:end][-80:]


@pytest.mark.parametrize(
    ("text", "opening"),
    [
        (f"{CALCULIX}\n displacements (vx,vy,vz) for set TIP and time  0.1500000E\n", "vy"),
        (f" nodal point  x-disp     y-disp\n        12  0.0000E+00  1.0000E-01\n{NODOUT}", "time"),
    ],
)
def test_a_header_in_part_begins_no_increment(text, opening, tmp_path):
    (tmp_path / "job.dat").write_text(text)
    known = LISTINGS["calculix" if opening == "vy" else "nodout"]
    assert np.allclose(read_curve(tmp_path / "job.dat", Reading(*known[1:3])), known[3:], rtol=1e-12, atol=0.0)


def test_the_refusal_names_what_is_printed(tmp_path):
    (tmp_path / "job.dat").write_text(ABAQUS)
    with pytest.raises(CurveError, match="the header must name opening and load, got U2 UPPER, RF2, U2 LOWER"):
        read_curve(tmp_path / "job.dat")


INSTRON = """\
"Specimen","A-7",""
"Width","25.40","mm"
"Rate","1.0","0.5","mm/min"
"Results Table 1"
"Time","Extension","Load"
"(s)","(mm)","(N)"
"0.0","0.000","0.0"
"1.0","0.500","999.5"
"2.0","1.000","1,234.5"
"3.0","1.500","1,300"
"""


def test_tables_of_testing_machines(tmp_path):
    """Rows of two numbers above the header, units below it, and marks between thousands."""
    file = tmp_path / "a.csv"
    file.write_text(INSTRON)
    d, P = read_curve(file, Reading("Extension"))
    assert d.tolist() == [0.0, 0.5, 1.0, 1.5] and P.tolist() == [0.0, 999.5, 1234.5, 1300.0]
    file.write_text("Opening [mm];Force [N]\n0,0;0,0\n0,5;1.234,5\n1,0;12.345,0\n")
    assert read_curve(file)[1].tolist() == [0.0, 1234.5, 12345.0]


#: rows of opening and load, where each comma may be either but for those of other cells, and the last load
MARKS = {
    "commas in quotes, none before a group of zeros": (['"0,054","0,492"', '"1,500","1,234"'], 1.234),
    "semicolons": (["0,000;0,000", "0,500;1,234"], 1.234),
    "decimal points in the other column": (["0.6\t900", "0.8\t1,200"], 1200.0),
    "decimal points in quotes": (['"0.000","0"', '"0.500","1,200"'], 1200.0),
    "two commas in another row": (["1;1,234,567", "2;1,200"], 1200.0),
    "points between thousands": (["0,5;0", "0,7;1.234"], 1234.0),
    "points alone": (["1.5 0", "2.5 1.234"], 1.234),
}


@pytest.mark.parametrize("case", MARKS)
def test_the_file_tells_decimal_marks_from_those_between_thousands(case, tmp_path):
    rows, load = MARKS[case]
    (tmp_path / "a.txt").write_text("\n".join(rows))
    assert read_curve(tmp_path / "a.txt")[1][-1] == load


@pytest.mark.parametrize("rows", [['"1","1,200"', '"2","1,500"'], ["0.5\t0,75", "1.0\t1,200"]])
def test_a_comma_that_may_be_either_is_refused(rows, tmp_path):
    """In no number the mark is clear, or in some it is a point and in others a comma."""
    (tmp_path / "a.txt").write_text("\n".join(rows))
    with pytest.raises(
        CurveError, match=r"column 2 must be .* of one meaning, got '1,200', which may be 1200 or 1\.200"
    ):
        read_curve(tmp_path / "a.txt")
