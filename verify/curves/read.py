"""Load-opening curves in files, of runs, other codes or testing machines, and their columns."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from verify.curves.curve import envelope
from verify.curves.text_table import Dialect, Row, Table, read_table
from verify.support.checked_files import read_at_most
from verify.support.refusal import Refusal

Column = str | int

#: Name of the load where a table has none of that name.
BESIDES_LOAD = "force"


class CurveError(Refusal):
    """A file, table or pair of arrays that holds no curve."""


class NoSuchColumn(CurveError):
    """A table without a column of that name."""


@dataclass(frozen=True)
class Reading:
    """Which columns of a table are opening and load, and what they are multiplied by.

    A column is a name, in capitals or not, with the unit in brackets behind it or without, or a number from 1. Without
    either the columns are those named opening and load, or force, in a table without a header the first two. A negative
    scale turns a sign. Of ``more`` columns cells may be empty, and the values are as they stand.

    Raises
    ------
    CurveError : a column number below 1, a scale that is 0 or not finite.
    """

    opening: Column | None = None
    load: Column | None = None
    opening_scale: float = 1.0
    load_scale: float = 1.0
    more: tuple[Column, ...] = ()

    def __post_init__(self) -> None:
        for name in ("opening", "load"):
            column = getattr(self, name)
            if isinstance(column, int) and column < 1:
                raise CurveError(f"{name}: must be the name or the number of a column, 1 or more, got {column}")
            scale = getattr(self, f"{name}_scale")
            if scale == 0 or not math.isfinite(scale):
                raise CurveError(f"{name}_scale: must be a finite number other than 0, got {scale:g}")
        if any(isinstance(column, int) and column < 1 for column in self.more):
            raise CurveError(f"columns: must be names or numbers of columns, 1 or more, got {self.more}")

    @property
    def columns(self) -> tuple[Column, ...]:
        """Opening and load, and what else is read."""
        return self.opening or "opening", self.load or "load", *self.more


def read_curve(path: Path | str, reading: Reading | None = None) -> tuple[np.ndarray, np.ndarray]:
    """Opening (n,) and load (n,) of a text file or of the folder of a run, scaled.

    Semicolons, tabs, commas or blanks separate; the decimal mark is a point or a comma, by all numbers of the file.
    The header is the first line, comments included, that has the names. What stands above it, and lines without any
    number right below it (units), do not count. Printed results of other programs are read as tables
    (`verify.curves.listings`).

    Raises
    ------
    CurveError
        Naming the file, the line and the column.
    """
    d, P, _ = read_with_more(path, reading or Reading())
    return d, P


def read_with_more(path: Path | str, reading: Reading) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Opening (n,) and load (n,) as `read_curve` reads them, and the columns ``reading.more`` (k, n), NaN where empty.

    Raises
    ------
    CurveError
        Naming the file, the line and the column.
    """
    path = Path(path)
    path = path / "curve.csv" if path.is_dir() else path
    table = read_table(text_of(path, "a curve"))
    if not (table.lead or table.body):
        raise CurveError(f"{path}: must hold a curve of at least 2 points, got an empty file")
    header, body = _header(path, table, reading)
    points = np.array(
        [
            [_value(f"{path}:{line}", table.dialect, cells, header, i) for i in range(len(header.chosen))]
            for line, cells in _of_one_width(path, table.dialect, body, header)
        ]
    ).reshape(-1, len(header.chosen))
    return *sound(str(path), points[:, 0], points[:, 1], reading), points[:, 2:].T


def sound(source: str, d: np.ndarray, P: np.ndarray, reading: Reading) -> tuple[np.ndarray, np.ndarray]:
    """The curve, scaled, if it can be compared with another one: finite, of growing opening.

    Raises
    ------
    CurveError : beginning with ``source``.
    """
    with np.errstate(over="ignore", invalid="ignore"):
        d, P = d * reading.opening_scale, P * reading.load_scale
    if not (np.isfinite(d).all() and np.isfinite(P).all()):
        row = int(np.flatnonzero(~(np.isfinite(d) & np.isfinite(P)))[0])
        raise CurveError(f"{source}: must hold finite numbers, got {d[row]:g} and {P[row]:g} in point {row + 1}")
    if d.size < 2 or not d.max() > d.min():
        raise CurveError(f"{source}: must hold at least 2 points of different opening, got {d.size}")
    if d.max() <= 0:
        raise CurveError(
            f"{source}: the openings must go above 0, got at most {d.max() + 0.0:g}; a scale of -1 turns signs"
        )
    with np.errstate(all="ignore"):
        monotone = envelope(d, P)[0]
    if monotone.size < 2:
        raise CurveError(f"{source}: the opening must grow from the first point on, got the largest, {d[0]:g}, first")
    return d, P


@dataclass(frozen=True)
class _Header:
    """The chosen columns, counted from 0, opening and load first, and how many there are; names where there is a
    header."""

    chosen: tuple[int, ...]
    width: int
    names: Sequence[str] = ()

    def name(self, column: int) -> str:
        return f"column {self.names[column]!r}" if self.names else f"column {column + 1}"


def text_of(path: Path, what: str) -> str:
    """The text of a file that should hold ``what``, in UTF-8, UTF-16 or Latin-1.

    Raises
    ------
    CurveError : no file, or no text.
    """
    try:
        raw = read_at_most(path)
    except (OSError, ValueError) as error:
        why = getattr(error, "strerror", None) or "a name that no file can have"
        raise CurveError(f"{path}: must be a file with {what}, got: {why}") from None
    wide = raw.startswith((b"\xff\xfe", b"\xfe\xff"))
    for encoding in ("utf-16",) if wide else ("utf-8-sig", "latin-1"):
        try:
            text = raw.decode(encoding)
        except ValueError:
            continue
        if "\0" not in text:
            return text
    raise CurveError(f"{path}: must be a file with {what}, got: not a text")


def _header(path: Path, table: Table, reading: Reading) -> tuple[_Header, list[Row]]:
    """Where opening and load stand, and the rows below the header."""
    wanted = [column for column in reading.columns if isinstance(column, str)]
    rows = [*table.lead, *table.body]
    for tried in (reading, *([replace(reading, load=BESIDES_LOAD)] if reading.load is None else [])):
        if found := _named(path, table, tried):
            return found
    below = _below_units(table.dialect, rows)
    titles = rows[: len(rows) - len(below)]
    if wanted and (titles or any(isinstance(one, str) for one in (reading.opening, reading.load, *reading.more))):
        raise _no_such_column(path, table, wanted)
    if not below:
        raise CurveError(f"{path}: must hold at least 2 points of different opening, got no number")
    line, first = below[0]
    width = len(first)
    if width < 2:
        raise CurveError(f"{path}:{line}: must have two columns, opening and load, got {width}")
    return _counted(f"{path}:{line}", reading, width), below


def _named(path: Path, table: Table, reading: Reading) -> tuple[_Header, list[Row]] | None:
    """The first line that has the names, wherever it stands, and the rows below; None without names."""
    wanted = {_bare(column) for column in reading.columns if isinstance(column, str)}
    rows = [*table.lead, *table.body]
    width = len(table.body[0][1]) if table.body else 0
    remarks = [row for row in table.remarks if len(row[1]) == width]
    for line, cells in [*table.lead, *remarks, *table.body] if wanted else []:
        if wanted <= {_bare(cell) for cell in cells}:
            below = _below_units(table.dialect, [row for row in rows if row[0] > line])
            return _Header(_chosen(f"{path}:{line}", cells, reading), len(cells), cells), below
    return None


def _below_units(dialect: Dialect, rows: list[Row]) -> list[Row]:
    """Without the rows at the top that hold no number."""
    start = next((i for i, (_, cells) in enumerate(rows) if dialect.numbers(cells)), len(rows))
    return rows[start:]


def columns_of(place: str, names: Sequence[Any], reading: Reading) -> tuple[int, int]:
    """Where opening and load stand among named columns: by their very names, by number, by names in other capitals.

    Raises
    ------
    CurveError : no such column, several, or one for both, beginning with ``place``.
    """
    opening, load, *_ = _chosen(place, names, reading)
    return opening, load


def _chosen(place: str, names: Sequence[Any], reading: Reading) -> tuple[int, ...]:
    return _different(place, [_column(place, names, column) for column in reading.columns])


def _column(place: str, names: Sequence[Any], wanted: Column) -> int:
    found = [i for i, name in enumerate(names) if name == wanted]
    if isinstance(wanted, int):
        return found[0] if found else _position(place, wanted, len(names))
    for same in (_key, _bare):
        found = found or [i for i, name in enumerate(names) if same(str(name)) == same(wanted)]
    if len(found) != 1:
        which = "one" if found else "a"
        text = f"must have {which} column {wanted!r}, got {_listed(names)}; numbers choose columns as well"
        raise CurveError(f"{place}: {text}")
    return found[0]


def _counted(place: str, reading: Reading, width: int) -> _Header:
    places = zip(reading.columns, (1, 2, *reading.more), strict=True)
    columns = (column if isinstance(column, int) else int(at) for column, at in places)
    return _Header(_different(place, [_position(place, column, width) for column in columns]), width)


def _position(place: str, column: int, width: int) -> int:
    if column > width:
        raise CurveError(f"{place}: has {width} columns, got column number {column}")
    return column - 1


def _different(place: str, chosen: Sequence[int]) -> tuple[int, ...]:
    opening, load, *more = chosen
    if opening == load:
        raise CurveError(f"{place}: opening and load must be different columns, got column {opening + 1} for both")
    twice = [column for column in more if chosen.count(column) > 1]
    if twice:
        raise CurveError(f"{place}: every column must be another one, got column {twice[0] + 1} twice")
    return tuple(chosen)


def _no_such_column(path: Path, table: Table, wanted: list[str]) -> NoSuchColumn:
    heads = [row for row in table.lead if len(row[1]) > 1] or table.lead
    if not heads:
        line = table.body[0][0]
        return NoSuchColumn(f"{path}:{line}: has no header, so columns go by number, got {' and '.join(wanted)}")
    line, names = heads[0]
    known = {_key(name) for name in names}
    missing = [name for name in wanted if _key(name) not in known] or wanted
    return NoSuchColumn(
        f"{path}:{line}: the header must name {' and '.join(missing)}, got {_listed(names)}; "
        "other columns are chosen by name or number"
    )


def _key(name: str) -> str:
    """Names are the same whatever their capitals, and whatever stood between them where blanks separate the numbers."""
    return name.strip(" ,;").casefold()


def _bare(name: str) -> str:
    """A name without the unit in brackets behind it."""
    return _key(re.sub(r"\s*(\([^()]*\)|\[[^][]*\])\s*$", "", name)) or _key(name)


def _listed(names: Sequence[Any]) -> str:
    text = ", ".join(map(str, names)) or "none"
    return text if len(text) <= 300 else f"{text[:300]}..."


def _of_one_width(path: Path, dialect: Dialect, body: list[Row], header: _Header) -> list[Row]:
    """The rows, if no number stands under a wrong name. A row must not have more cells than columns, nor fewer where
    blanks separate, as these leave no cell empty."""
    for line, cells in body:
        if len(cells) > header.width or (len(cells) < header.width and not dialect.separator):
            raise CurveError(f"{path}:{line}: must have {header.width} columns as above, got {len(cells)}")
    return body


def _value(place: str, dialect: Dialect, cells: list[str], header: _Header, i: int) -> float:
    """In the ``i``-th chosen column; beyond opening and load an empty cell and NaN are no reading."""
    column = header.chosen[i]
    cell = cells[column] if column < len(cells) else ""
    value = math.nan if i > 1 and not cell else dialect.value(cell)
    if i > 1 and value is not None and math.isnan(value):
        return value
    if value is None or not math.isfinite(value):
        raise CurveError(f"{place}: {header.name(column)} must be a finite number, got {cell[:30]!r}")
    if doubt := dialect.doubt(cell):
        raise CurveError(
            f"{place}: {header.name(column)} must be a number of one meaning, got {cell[:30]!r}, which {doubt}"
        )
    return value
