"""Load-opening curves in files, of runs, other codes or testing machines, and their columns."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import dropwhile, product
from pathlib import Path
from typing import Any

import numpy as np

from verify.curves.curve import envelope
from verify.curves.text_table import Dialect, Row, Table, read_table
from verify.curves.units import Unit, Units, unit, unit_of_column
from verify.curves.workbook import LOCKED, OLD, ZIPPED, text_of_workbook
from verify.support.limited import read_at_most
from verify.support.refusal import Refusal
from verify.support.say import say

Column = str | int

#: Names of opening and load in tables, those of other programs and of testing machines last.
OPENING_NAMES, LOAD_NAMES = ("opening", "extension", "displacement"), ("load", "force")
#: What the name of one column alone may contain for it to be guessed.
LIKE_OPENING = re.compile(r"opening|extension|disp|stroke|crosshead|deflection", re.IGNORECASE)
LIKE_LOAD = re.compile(r"load|force", re.IGNORECASE)
#: What else such a name may tell of.
NEITHER = re.compile(r"crack|rate|time|count|step|strain", re.IGNORECASE)


class CurveError(Refusal):
    """A file, table or pair of arrays that holds no curve."""


class NoSuchColumn(CurveError):
    """A table without a column of that name."""


@dataclass(frozen=True)
class Reading:
    """Which columns of a table are opening and load, and what they are multiplied by.

    A column is a name, in capitals or not, with the unit in brackets behind it or without, or a number from 1. Without
    either the columns are named as in `OPENING_NAMES` and `LOAD_NAMES`, in a table without a header the first two. A
    negative scale turns a sign. Of ``more`` columns cells may be empty; their scales are ``more_scales``, 1 where left
    out. A column with the scale 1 whose header names its unit is converted to the ``units``, which is said.

    Raises
    ------
    CurveError : a column number below 1, a scale that is 0 or not finite.
    """

    opening: Column | None = None
    load: Column | None = None
    opening_scale: float = 1.0
    load_scale: float = 1.0
    more: tuple[Column, ...] = ()
    more_scales: tuple[float, ...] = ()
    units: Units = Units()

    def __post_init__(self) -> None:
        for name, column in (("opening", self.opening), ("load", self.load), *(("columns", one) for one in self.more)):
            if isinstance(column, int) and column < 1:
                raise CurveError(f"{name}: must be the name or the number of a column, 1 or more, got {column}")
        usable_scales(opening_scale=self.opening_scale, load_scale=self.load_scale)

    @property
    def scales(self) -> tuple[float, ...]:
        """Those of `columns`."""
        missing = len(self.more) - len(self.more_scales)
        return (self.opening_scale, self.load_scale, *self.more_scales, *[1.0] * missing)

    @property
    def columns(self) -> tuple[Column, ...]:
        """Opening and load, and what else is read."""
        return self.opening or "opening", self.load or "load", *self.more


def usable_scales(**scales: float) -> None:
    """Refuse a scale that is 0 or not finite."""
    for name, scale in scales.items():
        if scale == 0 or not math.isfinite(scale):
            raise CurveError(f"{name}: must be a finite number other than 0, got {scale:g}")


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
        got = "remarks alone" if table.remarks else "an empty file"
        raise CurveError(f"{path}: must hold a curve of at least 2 points, got {got}")
    chosen, names, body = _header(path, table, reading)
    reading = _with_units(path, reading, [_unit(table, names, i, body) for i in chosen])
    points = []
    for line, cells in body:  # no number may stand under a wrong name; blanks that separate leave no cell empty
        if len(cells) > len(names) or (len(cells) < len(names) and not table.dialect.separator):
            commas = len(cells) == 2 * len(names) and table.dialect.separator == "," and "." not in "".join(cells)
            why = "; decimal commas? Separate by semicolons, or write points" if commas else ""
            raise CurveError(f"{path}:{line}: must have {len(names)} columns as above, got {len(cells)}{why}")
        cells = [*cells, *[""] * (len(names) - len(cells))]
        pairs = ((cells[i], f"{path}:{line}: column {repr(names[i]) if names[i] else i + 1}") for i in chosen)
        words = not table.dialect.numbers(cells)
        points.append([_value(table.dialect, cell, what, k > 1, words) for k, (cell, what) in enumerate(pairs)])
    columns = np.array(points).reshape(-1, len(chosen)).T
    more = columns[2:] * np.array(reading.scales[2:]).reshape(-1, 1)
    return *sound(str(path), columns[0], columns[1], reading), more


def units_in(path: Path, reading: Reading) -> Units:
    """The units that the header of a file names for opening and load; None where it names none.

    Raises
    ------
    CurveError : as `read_curve`.
    """
    table = read_table(text_of(path, "a curve"))
    if not (table.lead or table.body):
        return Units()
    chosen, names, body = _header(path, table, reading)
    length, force = (_unit(table, names, i, body) for i in chosen[:2])
    return Units(length if length and length.is_length else None, None if force and force.is_length else force)


def _unit(table: Table, names: Sequence[str], column: int, body: list[Row]) -> Unit | None:
    """The unit of a column by its name, or by the lines between the header and the first number."""
    if found := unit_of_column(names[column]):
        return found
    first = body[0][0] if body else 0
    above = [cells for line, cells in [*table.lead, *table.remarks] if line < first and len(cells) == len(names)]
    below_names = (cells[column] for cells in above if not set(cells) & set(filter(None, names)))
    return next((found for cell in below_names if (found := unit(cell.strip("()[] ")))), None)


def _with_units(path: Path, reading: Reading, found: Sequence[Unit | None]) -> Reading:
    """The reading with scales from the units of its columns, opening, load and more; a remark says which."""
    scales, names = list(reading.scales), ("opening", "load", *map(str, reading.more))
    for i, one in enumerate(found):
        own = None if one is None else reading.units.own(one)
        if one is None or own is None or one.is_length == (i == 1):  # the load alone is a force
            continue
        if scales[i] != 1.0 or one.size == own.size:
            continue
        scales[i] = one.size / own.size
        say(f"{path}: {names[i]}: in {one.name} by its header, times {scales[i]:.6g} for {own.name}")
    return replace(reading, opening_scale=scales[0], load_scale=scales[1], more_scales=tuple(scales[2:]))


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
        at = f", all at {d[0]:g}" if d.size > 1 else ""
        raise CurveError(f"{source}: must hold at least 2 points of different opening, got {d.size}{at}")
    if d.max() <= 0:
        turned = 0.0 - d[0] <= 0.5 * np.ptp(d)  # it begins near 0
        way = "an opening scale of -1 turns signs" if turned else f"take off what they begin at, {d[0]:g}"
        raise CurveError(f"{source}: the openings must go above 0, got at most {d.max() + 0.0:g}; {way}")
    with np.errstate(all="ignore"):
        monotone = envelope(d, P)[0]
    if monotone.size < 2:
        raise CurveError(f"{source}: the opening must grow from the first point on, got the largest, {d[0]:g}, first")
    return d, P


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
    if raw.startswith(OLD):
        kind = "a workbook with a password" if LOCKED in raw else "a file of an old office program (.xls?)"
        raise CurveError(f"{path}: is {kind}; save its table as .xlsx or as CSV")
    if raw.startswith(ZIPPED):
        try:
            return text_of_workbook(path)
        except ModuleNotFoundError:
            raise CurveError(f"{path}: is a workbook; save it as CSV, or install debond[sheets]") from None
        except ValueError as error:
            raise CurveError(f"{path}: {error}") from None
    wide = raw.startswith((b"\xff\xfe", b"\xfe\xff"))
    for encoding in ("utf-16",) if wide else ("utf-8-sig", "latin-1"):
        try:
            text = raw.decode(encoding)
        except ValueError:
            continue
        if not ("\0" in text or text.startswith("%PDF-")):
            return text
    raise CurveError(f"{path}: must be a file with {what}, got: not a text, nor a workbook")


def _header(path: Path, table: Table, reading: Reading) -> tuple[tuple[int, ...], Sequence[str], list[Row]]:
    """Which columns are opening, load and more, the names of all columns, and the rows below the header.

    The header is the first line that has the names, wherever it stands. Without one columns go by number, and have
    empty names.
    """
    rows, width = [*table.lead, *table.body], len(table.body[0][1]) if table.body else 0
    remarks = [row for row in table.remarks if len(row[1]) == width]
    wanted = [column for column in reading.columns if isinstance(column, str)]
    pairs = product(
        [reading.opening] if reading.opening else OPENING_NAMES, [reading.load] if reading.load else LOAD_NAMES
    )
    for tried in (replace(reading, opening=opening, load=load) for opening, load in pairs):
        named = {_bare(column) for column in tried.columns if isinstance(column, str)}
        for line, cells in [*table.lead, *remarks, *table.body] if named else []:
            if named <= {_bare(cell) for cell in cells}:
                below = _below_units(table.dialect, [row for row in rows if row[0] > line])
                return columns_of(f"{path}:{line}", cells, tried), cells, below
    for line, cells in reversed([row for row in [*table.lead, *remarks] if len(row[1]) == width]):
        if guess := _guessed(cells, reading):
            said = f"{guess.opening!r} is taken for the opening and {guess.load!r} for the load, by their names"
            say(f"{path}:{line}: {said}; other columns are chosen by name or number")
            return columns_of(f"{path}:{line}", cells, guess), cells, [row for row in table.body if row[0] > line]
    below = table.body or _below_units(table.dialect, rows)
    by_name = any(isinstance(one, str) for one in (reading.opening, reading.load, *reading.more))
    if wanted and (by_name or len(below) < len(rows)):
        raise _no_such_column(path, table, wanted)
    if not below:
        raise CurveError(f"{path}: must hold at least 2 points of different opening, got no number")
    line, first = below[0]
    if len(first) < 2:
        raise CurveError(f"{path}:{line}: must have two columns, opening and load, got {len(first)}")
    numbered = replace(reading, opening=reading.opening or 1, load=reading.load or 2)
    names = [""] * len(first)
    return columns_of(f"{path}:{line}", names, numbered), names, below


def _guessed(names: Sequence[str], reading: Reading) -> Reading | None:
    """The reading with the only column whose name is like that of an opening, or of a load, where it has none."""
    plain = [name for name in names if not NEITHER.search(name)]
    openings = [name for name in plain if LIKE_OPENING.search(name)]
    loads = [name for name in plain if LIKE_LOAD.search(name) and name not in openings]
    opening = reading.opening or (openings[0] if len(openings) == 1 else None)
    load = reading.load or (loads[0] if len(loads) == 1 else None)
    if not (isinstance(opening, str) and isinstance(load, str)):
        return None
    guess = replace(reading, opening=opening, load=load)
    known = {_bare(name) for name in names}
    return guess if all(isinstance(one, int) or _bare(one) in known for one in guess.columns) else None


def _below_units(dialect: Dialect, rows: list[Row]) -> list[Row]:
    """Without the rows at the top that hold no number."""
    return list(dropwhile(lambda row: not dialect.numbers(row[1]), rows))


def columns_of(place: str, names: Sequence[Any], reading: Reading) -> tuple[int, ...]:
    """Where the columns of a reading stand among named ones: by their very names, by number, by names in other
    capitals.

    Raises
    ------
    CurveError : no such column, several, or one for both, beginning with ``place``.
    """
    opening, load, *more = chosen = [_column(place, names, column) for column in reading.columns]
    if opening == load:
        raise CurveError(f"{place}: opening and load must be different columns, got column {opening + 1} for both")
    if twice := [column for column in more if chosen.count(column) > 1]:
        raise CurveError(f"{place}: every column must be another one, got column {twice[0] + 1} twice")
    return tuple(chosen)


def _column(place: str, names: Sequence[Any], wanted: Column) -> int:
    found = [i for i, name in enumerate(names) if name == wanted]
    if isinstance(wanted, int):
        if not found and wanted > len(names):
            raise CurveError(f"{place}: has {len(names)} columns, got column number {wanted}")
        return found[0] if found else wanted - 1
    for same in (_key, _bare):
        found = found or [i for i, name in enumerate(names) if same(str(name)) == same(wanted)]
    if len(found) != 1:
        which = "one" if found else "a"
        text = f"must have {which} column {wanted!r}, got {_listed(names)}; numbers choose columns as well"
        raise CurveError(f"{place}: {text}")
    return found[0]


def _no_such_column(path: Path, table: Table, wanted: list[str]) -> NoSuchColumn:
    width = len(table.body[0][1]) if table.body else 0
    several = [row for row in table.lead if len(row[1]) > 1 and not all(map(unit, filter(None, row[1])))]
    several = several or table.lead
    words = [row for row in several if not table.dialect.numbers(row[1])] or several
    heads = [row for row in words if len(row[1]) == width] or words
    if not heads:
        line = table.body[0][0]
        return NoSuchColumn(f"{path}:{line}: has no header, so columns go by number, got {' and '.join(wanted)}")
    line, names = heads[-1]  # what stands above it is about the test
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
    """A name without the unit behind it."""
    if unit_of_column(name):
        name = re.sub(r"[\s_,/]+[^\s_,/()\[\]]+$", "", name.strip(' ,;"'))
    return _key(re.sub(r"[\s_]*(\([^()]*\)|\[[^][]*\])\s*$", "", name)) or _key(name)


def _listed(names: Sequence[Any]) -> str:
    text = ", ".join(map(str, names)) or "none"
    return text if len(text) <= 300 else f"{text[:300]}..."


def _value(dialect: Dialect, cell: str, what: str, more: bool, words: bool) -> float:
    """The number of a cell; of ``more`` columns an empty cell and NaN are no reading. ``words``: no cell beside it is a
    number."""
    value = math.nan if more and not cell else dialect.value(cell)
    if value is None or not (math.isfinite(value) or (more and math.isnan(value))):
        way = "; lines of words may stand above the header and at the end" if words and cell else ""
        raise CurveError(f"{what} must be a finite number, got {cell[:30]!r}{way}")
    if doubt := dialect.doubt(cell):
        raise CurveError(f"{what} must be a number of one meaning, got {cell[:30]!r}, which {doubt}")
    return value
