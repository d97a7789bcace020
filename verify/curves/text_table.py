"""A table of numbers in a text of unknown format: separator, decimal mark, comments, header."""

from __future__ import annotations

import csv
import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import takewhile

from verify.curves.listings import Row, listing

#: Beginnings of comment lines; the last one is Abaqus's.
COMMENTS = ("#", "%", "!", "//", "**")

#: Numbers with commas between thousands, none of which begins with a group of zeros, and those without.
_GROUPED = r"[+-]?[1-9]\d{0,2}(?:,\d{3})+(?:\.\d*)?"
_ONE_NUMBER = re.compile(rf"[+-]?(?:\d+(?:\.\d*)?|\.\d+)(?:[eEdD][+-]?\d+)?|{_GROUPED}")
#: Turns numbers with a decimal comma into such.
_SWAPPED = str.maketrans(",.", ".,")

_SAMPLE = 400  # lines from which the separator is found, spread over the file


@dataclass(frozen=True)
class Dialect:
    """Separator (empty: blanks) and decimal mark.

    ``doubtful`` : whether the table does not tell a decimal mark from one between thousands
    """

    separator: str
    decimal_comma: bool
    doubtful: bool = False

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

        Between thousands stands what is not the decimal mark.
        """
        pointed = cell.translate(_SWAPPED) if self.decimal_comma else cell
        if re.fullmatch(_GROUPED, pointed):
            text = pointed.replace(",", "")
        else:
            text = cell.replace(",", ".") if self.decimal_comma else cell
        try:
            return None if "_" in text else float(re.sub("[dD]", "e", text) if text[-1:].isdigit() else text)
        except ValueError:
            return None

    def doubt(self, cell: str) -> str:
        """Why a cell may be two numbers, in words; empty where it is one or none."""
        if not self.doubtful or not re.search("[,.]", cell) or _marks(cell) != ".,":
            return ""
        grouped, pointed = re.sub("[,.]", "", cell), cell.replace(",", ".")
        return f"may be {grouped} or {pointed} in this file; write decimal points, and nothing between thousands"

    def numbers(self, cells: Sequence[str]) -> int:
        """How many cells hold a number."""
        return sum(self.value(cell) is not None for cell in cells)


#: In order of preference. A comma that separates is the decimal mark in quotes alone.
_DIALECTS = [Dialect(separator, comma) for separator in (";", "\t", ",", "") for comma in (False, True)]


@dataclass(frozen=True)
class Table:
    """The lines of a text that are not empty, taken apart.

    ``lead`` is what comes before the first row of two numbers, ``body`` what follows up to the last row with a number
    ("End of test" is none), ``remarks`` the comments above that row, taken apart as if they were rows.
    """

    dialect: Dialect
    remarks: list[Row]
    lead: list[Row]
    body: list[Row]


def read_table(text: str) -> Table:
    """Take a text apart by the dialect in which most of its cells are numbers, two or more a line.

    The decimal mark is that of all numbers that can be read in one way alone: 0,5 and 1.234,5 or 0.5 and 1,234.5.
    """
    split = re.split("\r\n|\n|\r", text)
    lines = [(i, line.strip(" \r\f\v")) for i, line in enumerate(split, 1) if line.strip()]
    printed = listing([(i, line) for i, line in lines if i < len(split)])  # a last line without an end may be cut
    if printed is not None:
        return Table(Dialect("", False), [], printed[:1], printed[1:])
    data = [(i, line) for i, line in lines if not line.startswith(COMMENTS)]
    dialect = _dialect([line for _, line in data])
    rows = [(i, dialect.cells(line)) for i, line in data]
    dialect = _with_the_marks_of([cells for _, cells in rows], dialect)
    lead = list(takewhile(lambda row: dialect.numbers(row[1]) < 2, rows))
    while len(rows) > len(lead) and not dialect.numbers(rows[-1][1]):
        rows.pop()
    first = rows[len(lead)][0] if len(lead) < len(rows) else len(text)
    above = [(i, line) for i, line in lines if line.startswith(COMMENTS) and i < first]
    return Table(dialect, [(i, dialect.cells(line.lstrip("#%!/* "))) for i, line in above], lead, rows[len(lead) :])


def _dialect(lines: Sequence[str]) -> Dialect:
    """The reading that finds the most numbers; where two find as many, the one without a decimal comma."""

    def votes(dialect: Dialect) -> float:
        counts = [(dialect.numbers(cells), len(cells)) for cells in map(dialect.cells, sample)]
        return sum(count / width for count, width in counts if count >= 2)

    sample = lines[:: max(1, len(lines) // _SAMPLE)]
    best = max(_DIALECTS, key=votes)
    if sample and votes(best) > 0.0:
        return best
    present = (dialect for dialect in _DIALECTS if lines and dialect.separator in lines[0])
    return next(present, Dialect("", False))


def _marks(cell: str) -> str:
    """The decimal marks by which a cell is a number; one without any, like 12, is one by both."""
    return "".join(mark for mark, text in ((".", cell), (",", cell.translate(_SWAPPED))) if _ONE_NUMBER.fullmatch(text))


def _with_the_marks_of(rows: Sequence[Sequence[str]], dialect: Dialect) -> Dialect:
    """The dialect with the decimal mark that the numbers allow, of all rows of two or more.

    Points alone are decimal. Where numbers of both marks stand, or every comma may be either, the table is doubtful.
    """
    rows = rows if any("," in cell for cells in rows for cell in cells) else []
    numbers = [[cell for cell in cells if _marks(cell)] for cells in rows]
    marked = [cell for cells in numbers if len(cells) > 1 for cell in cells if re.search("[,.]", cell)]
    if not any("," in cell for cell in marked):
        return replace(dialect, decimal_comma=False)
    found = {_marks(cell) for cell in marked}
    if ("." in found) != ("," in found):
        return replace(dialect, decimal_comma="," in found)
    return replace(dialect, doubtful=True)
