"""A table of numbers in a text of unknown format: separator, decimal mark, comments, header."""

from __future__ import annotations

import csv
import re
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import takewhile

from verify.curves.listings import Row, listing

#: Beginnings of comment lines; the last one is Abaqus's.
COMMENTS = ("#", "%", "!", "//", "**")

#: Numbers with a mark between thousands, without and with a decimal comma.
_THOUSANDS = (
    re.compile(r"[+-]?\d{1,3}(?:,\d{3})+(?:\.\d*)?"),
    re.compile(r"[+-]?\d{1,3}(?:\.\d{3})+,\d*|[+-]?\d{1,3}(?:\.\d{3}){2,}"),
)

_SAMPLE = 400  # lines from which the separator is found, spread over the file


@dataclass(frozen=True)
class Dialect:
    """Separator (empty: blanks) and decimal mark."""

    separator: str
    decimal_comma: bool

    def cells(self, line: str) -> list[str]:
        """The cells of a line without quotes and outer blanks; empty ones at the end are dropped."""
        if self.separator:
            try:
                cells = next(csv.reader([line], delimiter=self.separator, skipinitialspace=True), [])
            except csv.Error:  # a cell of more than 128 kB
                cells = line.split(self.separator)
        else:
            cells = [cell.strip('"') for cell in re.findall(r'"[^"]*"|\S+', line)]
        cells = [cell.strip() for cell in cells]
        while cells and not cells[-1]:
            cells.pop()
        return cells

    def value(self, cell: str) -> float | None:
        """The number in a cell, NaN and infinity too, or None. Fortran's 1.0D-3 is one, and 1,234.5 or 1.234,5.

        Between thousands stands what is not the decimal mark; a comma that may be either is the decimal mark.
        """
        either = cell.count(",") == 1 and "." not in cell and self.separator != ","
        if _THOUSANDS[self.decimal_comma].fullmatch(cell) and (self.decimal_comma or not either):
            cell = cell.replace("." if self.decimal_comma else ",", "")
        text = cell.replace(",", ".") if self.decimal_comma else cell
        try:
            return None if "_" in text else float(re.sub("[dD]", "e", text) if text[-1:].isdigit() else text)
        except ValueError:
            return None

    def numbers(self, cells: Sequence[str]) -> int:
        """How many cells hold a number."""
        return sum(self.value(cell) is not None for cell in cells)


#: In order of preference. A comma cannot separate and be the decimal mark.
_DIALECTS = (
    Dialect(";", False),
    Dialect(";", True),
    Dialect("\t", False),
    Dialect("\t", True),
    Dialect(",", False),
    Dialect("", False),
    Dialect("", True),
)


@dataclass(frozen=True)
class Table:
    """The lines of a text that are not empty, taken apart.

    ``lead`` is what comes before the first row of two numbers, ``body`` the rest, ``remarks`` the comments above that
    row, taken apart as if they were rows.
    """

    dialect: Dialect
    remarks: list[Row]
    lead: list[Row]
    body: list[Row]


def read_table(text: str) -> Table:
    """Take a text apart by the dialect in which most of its cells are numbers, two or more a line."""
    split = re.split("\r\n|\n|\r", text)
    lines = [(i, line.strip(" \r\f\v")) for i, line in enumerate(split, 1) if line.strip()]
    printed = listing([(i, line) for i, line in lines if i < len(split)])  # a last line without an end may be cut
    if printed is not None:
        return Table(Dialect("", False), [], printed[:1], printed[1:])
    comments = [(i, line) for i, line in lines if line.startswith(COMMENTS)]
    data = [(i, line) for i, line in lines if not line.startswith(COMMENTS)]
    dialect = _dialect([line for _, line in data])
    rows = [(i, dialect.cells(line)) for i, line in data]
    lead = list(takewhile(lambda row: dialect.numbers(row[1]) < 2, rows))
    first = rows[len(lead)][0] if len(lead) < len(rows) else len(text)
    remarks = [(i, dialect.cells(line.lstrip("#%!/* "))) for i, line in comments if i < first]
    return Table(dialect, remarks, lead, rows[len(lead) :])


def _dialect(lines: Sequence[str]) -> Dialect:
    """The reading that finds the most numbers; where two find as many, the one without a decimal comma."""
    sample = lines[:: max(1, len(lines) // _SAMPLE)]
    votes = [sum(_share_of_numbers(dialect, line) for line in sample) for dialect in _DIALECTS]
    if max(votes, default=0) > 0:
        return _DIALECTS[votes.index(max(votes))]
    present = (dialect for dialect in _DIALECTS if lines and dialect.separator in lines[0])
    return next(present, Dialect("", False))


def _share_of_numbers(dialect: Dialect, line: str) -> float:
    cells = dialect.cells(line)
    count = dialect.numbers(cells)
    return count / len(cells) if count >= 2 else 0.0
