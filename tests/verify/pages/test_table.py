"""A table is the same in HTML, Markdown and CSV, whatever its texts contain."""

from __future__ import annotations

import csv
import re
from html.parser import HTMLParser
from math import nan
from types import SimpleNamespace

import pytest

pytest.importorskip("markupsafe")

from verify.pages.table import Cell, Column, Table, shown  # noqa: E402

HOSTILE = "<script>alert('x')</script> & `a|b` [c](d) *e*\nf"
COLUMNS = (
    Column("name", "Run", lambda name: Cell(name, link="./a run/"), once=True),
    Column("error", "Error"),
    Column("state", "", lambda state: Cell(f"✗ {state}", "a <b>reason", tone="bad") if state == "broken" else state),
)
ROWS = (
    {"name": HOSTILE, "error": 0.012345, "state": "broken"},
    {"name": HOSTILE, "error": nan, "state": "holds"},
    {"name": HOSTILE, "error": nan, "state": "holds"},
    {"name": "other", "error": "not run"},
)


class Read(HTMLParser):
    """Rows of texts; a cell that covers several stands in each of them. Fails on a tag that is none of ours."""

    def __init__(self, html: str, columns: int) -> None:
        super().__init__()
        self.rows: list[list[str | None]] = []
        self.columns, self.spans = columns, {}
        self.feed(str(html))

    def handle_starttag(self, tag: str, attrs: list) -> None:
        assert tag in "div table caption thead tbody tr th td a span small svg line".split()
        found = dict(attrs)
        if tag == "tr":
            left = self.spans.pop(len(self.rows), {})
            self.rows.append([left.get(j) for j in range(self.columns)])
        if tag in ("th", "td"):
            row = self.rows[-1]
            self.at, self.inside = row.index(None), True
            row[self.at : self.at + int(found.get("colspan", 1))] = [""] * int(found.get("colspan", 1))
            self.down = int(found.get("rowspan", 1))
        if tag == "small":
            self.handle_data(", ")

    def handle_data(self, data: str) -> None:
        if getattr(self, "inside", False):
            self.rows[-1][self.at] += data

    def handle_endtag(self, tag: str) -> None:
        if tag in ("th", "td"):
            self.inside = False
            for n in range(1, self.down):
                self.spans.setdefault(len(self.rows) - 1 + n, {})[self.at] = ""


def of_markdown(text: str) -> list[list[str]]:
    lines = [re.split(r"(?<!\\)\|", line)[1:-1] for line in text.splitlines()]
    cells = [[re.sub(r"\[(.*)\]\(<.*>\)", r"\1", cell.strip()).replace("**", "") for cell in line] for line in lines]
    return [[re.sub(r"\\(.)", r"\1", cell) for cell in line] for line in (cells[0], *cells[2:])]


def test_html_and_markdown_have_the_same_cells():
    table = Table(COLUMNS, ROWS, "A caption & more")
    expected = [
        ["Run", "Error", ""],
        [HOSTILE.replace("\n", " "), "0.0123", "✗ broken, a <b>reason"],
        ["", "–", "holds"],
        ["", "–", "holds"],
        ["other", "not run", ""],
    ]
    assert of_markdown(table.markdown()) == expected
    html = Read(table.html(), 3).rows
    assert [[cell.replace("\n", " ") for cell in row] for row in html] == expected
    assert "<caption>A caption &amp; more</caption>" in table.html() and "[other](<./a run/>)" in table.markdown()


def test_rows_may_be_objects_and_have_a_state():
    rows = [SimpleNamespace(error=value) for value in (7, 2.0, None, True)]
    table = Table((Column("error", "Error"),), rows, "", state=lambda row: "broken" if row.error == 7 else "")
    assert [[cell.text for cell in row] for row in table.cells()] == [["7"], ["2"], ["–"], ["yes"]]
    assert table.html().count('<tr class="broken">') == 1


def test_files_have_the_values_and_not_their_texts(tmp_path):
    table = Table(COLUMNS, ROWS, "")
    table.csv(tmp_path / "table.csv")
    with (tmp_path / "table.csv").open(newline="") as stream:
        header, first, *_, last = csv.reader(stream)
    assert header == ["name", "error", "state"] and first == [HOSTILE, "0.012345", "broken"]
    assert last == ["other", "not run", ""] and table.records()[-1] == ROWS[-1]


def test_numbers_have_three_digits_and_what_is_none_a_dash():
    assert [shown(one) for one in (0.0123456, 12345, nan, None, "as it is", False)] == [
        "0.0123", "12345", "–", "–", "as it is", "no",
    ]  # fmt: skip
