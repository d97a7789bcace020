"""A regression test of somebody else's code against a curve of this package.

`abaqus.csv` stands for the history output of that code: columns of its own, millimetres and kilonewtons, the lower face
of the specimen, which moves down. Run it with `pytest examples/regression_test`.
"""

from pathlib import Path

from verify.curves.read import Reading
from verify.testing import assert_curves_close

HERE = Path(__file__).parent

# The opening is twice what one face moves, and the load is in newtons.
LOWER_FACE = Reading(opening="U2", load="RF2", opening_scale=-2, load_scale=-1e3)


def test_my_code_agrees_with_an_independent_one():
    expected = HERE / "expected.csv"  # or the folder of a run of `debond solve`
    assert_curves_close(HERE / "abaqus.csv", expected, actual_as=LOWER_FACE, curve=0.002, peak=0.002, energy=0.001)
