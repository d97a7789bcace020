"""Values of options: the least that is taken, and what is not."""

import argparse

import pytest

from verify.command_line.arguments import accuracy, column, count, fraction, number, numbers, positive, scale


def test_the_least_whole_numbers_are_taken() -> None:
    assert [positive("1"), positive("12"), count("0"), count("1")] == [1, 12, 0, 1]
    assert [positive("123456789"), count("123456789")] == [123456789] * 2


@pytest.mark.parametrize(
    ("kind", "text"),
    [
        *[(positive, text) for text in ("0", "-1", "1.5", "", "1234567890", "²")],
        *[(count, text) for text in ("-1", "1.5", "", "1234567890", "²")],
    ],
)
def test_what_is_no_such_number_is_refused(kind, text: str) -> None:
    with pytest.raises(
        argparse.ArgumentTypeError, match=f"must be an integer >= {int(kind is positive)}( and < 1000000000)?, got "
    ):
        kind(text)


def test_shares_are_numbers_or_per_cent() -> None:
    assert [accuracy(text) for text in ("0.5%", "0.5 %", "0.005", "0", "100%")] == [0.005, 0.005, 0.005, 0.0, 1.0]
    assert [fraction(text) for text in ("0", "0.25", "3")] == [0.0, 0.25, 3.0]


@pytest.mark.parametrize("text", ["-0.1", "inf", "nan", "half", ""])
def test_shares_that_are_none_are_refused(text: str) -> None:
    for kind in (fraction, accuracy):
        with pytest.raises(argparse.ArgumentTypeError, match=f"must be a number >= 0, got '{text}'"):
            kind(text)


def test_factors_and_lists_of_numbers() -> None:
    assert [scale(text) for text in ("-1", "1e-3")] == [-1.0, 1e-3] and numbers("1,-2.5,0") == [1.0, -2.5, 0.0]
    for kind, text, words in (
        (scale, "0", "a finite number other than 0, got '0'"),
        (scale, "inf", "a finite number, got 'inf'"),
        (number, "nan", "a finite number, got 'nan'"),
        (number, "one", "a finite number, got 'one'"),
        (numbers, "1,", "a finite number, got ''"),
    ):
        with pytest.raises(argparse.ArgumentTypeError, match=f"must be {words}"):
            kind(text)


def test_a_column_is_a_number_or_a_name() -> None:
    assert [column(text) for text in ("0", "12", "load", "-1", "²")] == [0, 12, "load", "-1", "²"]
    assert [column(text) for text in ("123456789", "1234567890")] == [123456789, "1234567890"]
