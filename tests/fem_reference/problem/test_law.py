"""Laws of opening that are refused; all else is held against two codes in `tests/verify/theory/test_three_laws.py`."""

import pytest

from fem_reference.problem.law import MODELLED_LAWS

NUMBERS = {"strength": 4.0, "toughness": 0.1, "ductility": 12.5, "penalty": 1e5}


@pytest.mark.parametrize(
    ("table", "sentence"),
    [
        ((), "two or more pairs"),
        (((0.0, 0.0), (1.0, 1.0), (2.0, 0.0)), "openings that rise from above 0"),
        (((1.0, 1.0), (2.0, 0.5)), "a last one of 0"),
        (((1.0, 1.0), (2.0, 2.5), (3.0, 0.0)), "a falling traction / opening"),
    ],
)
def test_refusals_of_shapes(table, sentence):
    with pytest.raises(ValueError, match=f"table: must .*{sentence}.*, got"):
        MODELLED_LAWS["tabular"](**NUMBERS, table=table)
    with pytest.raises(ValueError, match="plateau: must be in .0, 1., got -0.1"):
        MODELLED_LAWS["trapezoidal"](**NUMBERS, plateau=-0.1)
