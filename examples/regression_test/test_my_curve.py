"""The curve of a code is held to the one that it drew before; `pytest --update-curves` wrote that beside this file.

The fixture comes with debond, once it is installed with pip. Run it with `pytest examples/regression_test`.
"""

from pathlib import Path

from verify.curves.read import Reading

LOWER_FACE = Reading(opening="U2", load="RF2", opening_scale=-2, load_scale=-1e3)


def test_it_has_not_changed(curve_regression):
    curve_regression(Path(__file__).with_name("abaqus.csv"), reading=LOWER_FACE, rel=1e-4)
