"""A table: rows, columns, and how their values read. It writes itself as HTML, Markdown, CSV and records for JSON."""

from __future__ import annotations

import csv
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from markupsafe import Markup

from verify.pages.template import rendered
from verify.pages.text import number, plain

if TYPE_CHECKING:
    from verify.pages.style import Line


@dataclass(frozen=True)
class Cell:
    """What stands in a cell: a text, and ``below`` it another one in small letters.

    link : ``#id`` of the page or a path from its folder; tone : a class of the style sheet, as good, bad, absent;
    line : the line style of a run, drawn before its name; id : what links lead to
    """

    text: str
    below: str = ""
    link: str = ""
    tone: str = ""
    line: Line | None = None
    id: str = ""

    def markdown(self) -> str:
        """On one line; links into the page lead nowhere there and are left out."""
        text = plain(self.text)
        text = f"**{text}**" if self.tone == "bad" else text
        text = f"[{text}](<{self.link}>)" if self.link.startswith("./") else text
        return ", ".join(filter(None, (text, plain(self.below))))


#: Sign and class of the state of a check.
_SIGNS = {"holds": ("✓", "good"), "broken": ("✗", "bad"), "unresolved": ("?", "open"), "not covered": ("–", "open")}


def of_state(state: str, why: str = "", link: str = "") -> Cell:
    """The state of a check as a cell."""
    sign, tone = _SIGNS[state]
    return Cell(f"{sign} {state}", why, link, tone)


def shown(value: Any) -> str | Cell:
    """A value as text: numbers in three digits, whole ones in full, – where there is none."""
    if isinstance(value, Cell | str):
        return value
    if value is None or value != value:
        return "–"
    if isinstance(value, bool):
        return "yes" if value else "no"
    return number(value) if isinstance(value, float) else str(value)


def _cell(shown: str | Cell) -> Cell:
    return Cell(shown) if isinstance(shown, str) else shown


def _plain_row(row: Any) -> str:
    """The class of a row without one; no lambda, as tables go to other processes."""
    return ""


def _value(row: Any, key: str) -> Any:
    return row.get(key) if isinstance(row, Mapping) else getattr(row, key)


@dataclass(frozen=True)
class Column:
    """A column: the ``key`` of its values in the rows, its title, and what ``show`` makes of a value.

    once : equal cells that follow each other are one
    """

    key: str
    title: str | Cell
    show: Callable[[Any], str | Cell] = shown
    once: bool = False


@dataclass(frozen=True)
class Table:
    """Columns and rows; a row is a mapping or an object with the keys as its attributes.

    Where a mapping ends before the last columns, its last cell reaches to the end of the line. ``state`` names the
    class of a row in the style sheet, ``kind`` that of the table.
    """

    columns: Sequence[Column]
    rows: Sequence[Any]
    caption: str
    state: Callable[[Any], str] = _plain_row
    kind: str = "methods"

    @staticmethod
    def of(
        titles: Sequence[str | Cell], rows: Iterable[Sequence[Any]], caption: str, kind: str = "methods", once: int = 0
    ) -> Table:
        """A table of values by their place; the first ``once`` columns say once what follows each other."""
        columns = [Column(str(i), title, once=i < once) for i, title in enumerate(titles)]
        return Table(
            columns, [dict(zip(map(str, range(len(row))), row, strict=True)) for row in rows], caption, kind=kind
        )

    def cells(self) -> list[list[Cell]]:
        """The cells of every row, without those that the last one covers."""
        return [[_cell(one.show(_value(row, one.key))) for one in self._columns_of(row)] for row in self.rows]

    def records(self) -> list[dict[str, Any]]:
        """The values of every row by their keys."""
        return [{one.key: _value(row, one.key) for one in self._columns_of(row)} for row in self.rows]

    def csv(self, path: Path) -> None:
        """Write the values, a line per row below the keys."""
        with path.open("w", newline="", encoding="utf-8") as stream:
            writer = csv.DictWriter(stream, [one.key for one in self.columns])
            writer.writeheader()
            writer.writerows(self.records())

    def html(self) -> Markup:
        """In a frame that scrolls sideways, by the template ``pages/table.html.j2``."""
        cells, last = self.cells(), len(self.columns) - 1
        down = [[self._down(i, j, cells) for j in range(len(row))] for i, row in enumerate(cells)]
        across = [[last - j + 1 if j + 1 == len(row) else 1 for j in range(len(row))] for row in cells]
        titles = [_cell(one.title) for one in self.columns]
        content = {"table": self, "titles": titles, "cells": cells, "down": down, "across": across}
        return Markup(rendered("verify.pages", "table.html.j2", {}, **content))

    def markdown(self) -> str:
        """With aligned columns; cells that are one are written once."""
        head = [_cell(one.title).markdown() for one in self.columns]
        cells, width = self.cells(), len(self.columns)
        body = [
            ["" if self._same(i, j, cells) else one.markdown() for j, one in enumerate(row)] + [""] * (width - len(row))
            for i, row in enumerate(cells)
        ]
        widths = [max(3, *(len(row[j]) for row in (head, *body))) for j in range(width)]
        lines = (head, ["-" * one for one in widths], *body)
        return "\n".join(f"| {' | '.join(map(str.ljust, line, widths))} |" for line in lines)

    def _columns_of(self, row: Any) -> Sequence[Column]:
        known = [i for i, one in enumerate(self.columns) if not isinstance(row, Mapping) or one.key in row]
        return self.columns[: known[-1] + 1] if known else ()

    def _same(self, i: int, j: int, cells: Sequence[Sequence[Cell]]) -> bool:
        """Whether a cell is one with that above it."""
        return i > 0 and self.columns[j].once and cells[i][: j + 1] == cells[i - 1][: j + 1]

    def _down(self, i: int, j: int, cells: Sequence[Sequence[Cell]]) -> int:
        """How many rows a cell covers; 0 where it is covered by that above it."""
        if self._same(i, j, cells):
            return 0
        return next((n for n in range(i + 1, len(cells)) if not self._same(n, j, cells)), len(cells)) - i
