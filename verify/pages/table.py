"""A table: rows, columns, and how their values read. It writes itself as HTML, Markdown, CSV and records for JSON."""

from __future__ import annotations

import csv
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from markupsafe import Markup

from verify.pages.text import number, symbols

if TYPE_CHECKING:
    from verify.pages.style import Line

#: Characters that are markup in Markdown; an angle bracket before a space or a digit is not.
_SPECIAL = re.compile(r"[\\`*\[\]|]|<(?=[A-Za-z/!?])|&(?=#?\w+;)|~(?=~)|^[>#+-]|(?<!\w)_|_(?!\w)")


def plain(text: object) -> str:
    """Text of Markdown on one line, with its markup characters escaped."""
    return _SPECIAL.sub(r"\\\g<0>", re.sub(r"\s*[\r\n]+\s*", " ", str(text)))


def sample(line: Line) -> Markup:
    """A short piece of the line of a run."""
    return Markup(
        '<svg class="sample" viewBox="0 0 30 8" aria-hidden="true"><line x1="0" x2="30" y1="4" y2="4" style="stroke: '
        'var(--{}); stroke-width: {}; stroke-opacity: {}; stroke-dasharray: {}"/></svg>'
    ).format(line.colour, line.width, line.alpha, " ".join(map(str, line.dashes)) or "none")


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

    def html(self) -> Markup:
        text = symbols(self.text)
        text = Markup('<a href="{}">{}</a>').format(self.link, text) if self.link else text
        text = Markup('<span class="mark {}">{}</span>').format(self.tone, text) if self.tone else text
        text = Markup('<span id="{}">{}</span>').format(self.id, text) if self.id else text
        below = Markup("<small>{}</small>").format(symbols(self.below)) if self.below else ""
        return (sample(self.line) if self.line else Markup()) + text + below

    def markdown(self) -> str:
        """On one line; links into the page lead nowhere there and are left out."""
        text = plain(self.text)
        text = f"**{text}**" if self.tone == "bad" else text
        text = f"[{text}](<{self.link}>)" if self.link.startswith("./") else text
        return ", ".join(filter(None, (text, plain(self.below))))


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
    state: Callable[[Any], str] = lambda row: ""
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
        """In a frame that scrolls sideways; the caption is read out, and seen where the style sheet shows it."""
        titles = [_cell(one.title) for one in self.columns]
        head = Markup().join(Markup('<th scope="col">{}</th>').format(title.html()) for title in titles)
        cells = self.cells()
        lines = (self._line(i, cells) for i in range(len(cells)))
        return Markup(
            '<div class="scroll" role="region" aria-label="{0}" tabindex="0">\n<table class="{1}">'
            "<caption>{0}</caption>\n{2}<tbody>\n{3}\n</tbody>\n</table>\n</div>"
        ).format(
            self.caption,
            self.kind,
            Markup("<thead><tr>{}</tr></thead>\n").format(head) if any(title.text for title in titles) else "",
            Markup("\n").join(lines),
        )

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

    def _line(self, i: int, cells: Sequence[Sequence[Cell]]) -> Markup:
        made = []
        for j, cell in enumerate(cells[i]):
            if not self._same(i, j, cells):
                down = next((n for n in range(i + 1, len(cells)) if not self._same(n, j, cells)), len(cells)) - i
                across = len(self.columns) - j if j + 1 == len(cells[i]) else 1
                spans = Markup(f' rowspan="{down}"' * (down > 1) + f' colspan="{across}"' * (across > 1))
                tag, scope = ("td", "") if j else ("th", Markup(' scope="rowgroup"' if down > 1 else ' scope="row"'))
                made.append(Markup("<{0}{1}{2}>{3}</{0}>").format(tag, scope, spans, cell.html()))
        return Markup('<tr class="{}">{}</tr>').format(self.state(self.rows[i]), Markup().join(made))
