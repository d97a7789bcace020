"""Values of options: the least that is taken, and what is not."""

import argparse

import pytest

from verify.arguments import count, positive


def test_the_least_whole_numbers_are_taken() -> None:
    assert [positive("1"), positive("12"), count("0"), count("1")] == [1, 12, 0, 1]


@pytest.mark.parametrize(
    ("kind", "text"), [(positive, "0"), (positive, "-1"), (count, "-1"), (count, "1.5"), (count, "")]
)
def test_what_is_no_such_number_is_refused(kind, text: str) -> None:
    with pytest.raises(argparse.ArgumentTypeError, match="must be an integer >= "):
        kind(text)
