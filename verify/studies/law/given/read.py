"""Tractions on the paths from a text file of another program."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from verify.curves.read import text_of
from verify.curves.text_table import Row, Table, read_table
from verify.studies.law.given.answer import Answer
from verify.studies.law.ways.legs import JumpPath
from verify.support.refusal import Refusal

PLACE_COLUMNS = ("path", "step")
JUMP_COLUMNS = ("g", "s")
TRACTION_COLUMNS = ("p", "t")
TANGENT_COLUMNS = ("dp_dg", "dp_ds", "dt_dg", "dt_ds")
FILE_COLUMNS = (*PLACE_COLUMNS, *JUMP_COLUMNS, *TRACTION_COLUMNS, *TANGENT_COLUMNS)

#: Tolerance of a jump in the file, relative to the largest jump of its path: numbers of six digits pass.
SAME_JUMP = 1e-5


class PathsError(Refusal):
    """A file that does not hold tractions on the paths."""


@dataclass(frozen=True)
class PathColumns:
    """Names of the columns of a file, where they differ from `FILE_COLUMNS`, and factors on their numbers.

    Raises
    ------
    PathsError : a column that no file has here, two of one name, a scale that is 0 or not finite.
    """

    names: Mapping[str, str] = field(default_factory=dict)
    scales: Mapping[str, float] = field(default_factory=dict)

    def __post_init__(self) -> None:
        for option, keys, known in (("columns", self.names, FILE_COLUMNS), ("scales", self.scales, FILE_COLUMNS[2:])):
            for key in keys:
                if key not in known:
                    raise PathsError(f"{option}: must be of {', '.join(known)}, got {key!r}")
        for key, scale in self.scales.items():
            if not math.isfinite(scale) or scale == 0.0:
                raise PathsError(f"scales: {key} must be a finite number other than 0, got {scale:g}")
        called = [self.called(key).casefold() for key in FILE_COLUMNS]
        twice = [name for name in called if called.count(name) > 1]
        if twice:
            raise PathsError(f"columns: must be different ones, got {twice[0]!r} more than once")

    def called(self, key: str) -> str:
        """The name of a column in the file."""
        return self.names.get(key, key)


def read_paths(
    path: Path, ways: Sequence[JumpPath], columns: PathColumns | None = None
) -> tuple[tuple[JumpPath, ...], dict[str, Answer]]:
    """The paths with the jumps as they stand in the file, and the tractions there.

    The file has one row for every step of every path, in any order, with a header: ``path,step,g,s,p,t``, and the four
    of the tangent or none. Separators, comments and decimal marks are those of `verify.curves.read`.

    Raises
    ------
    PathsError : naming the file, and the line or the path.
    """
    columns = columns or PathColumns()
    if path.is_dir():
        raise PathsError(f"{path}: must be a file with tractions, got a folder")
    table = read_table(text_of(path, "tractions"))
    if not (table.lead or table.body):
        raise PathsError(f"{path}: must hold tractions, got an empty file")
    at, width, body = _header(path, table, columns)
    rows = _rows(path, table, body, at, width, {way.name: way for way in ways})
    _all_there(path, rows, ways)
    found = [_one(path, way, rows[way.name], columns, at) for way in ways]
    return tuple(way for way, _ in found), {way.name: answer for way, answer in found}


def _header(path: Path, table: Table, columns: PathColumns) -> tuple[dict[str, int], int, list[Row]]:
    """Where the columns stand, how many there are, and the rows below."""
    wanted = {key: columns.called(key).casefold() for key in FILE_COLUMNS}
    needed = [key for key in FILE_COLUMNS if key not in TANGENT_COLUMNS]
    for line, cells in (*table.lead, *table.remarks):
        names = [cell.strip(" ,;").casefold() for cell in cells]
        if all(wanted[key] in names for key in needed):
            return _places(f"{path}:{line}", names, wanted), len(cells), _below(table, line)
    heads = [row for row in (*table.lead, *table.remarks) if len(row[1]) > 1]
    if not heads:
        raise PathsError(
            f"{path}: must have a header with the columns {', '.join(map(columns.called, needed))}, got none"
        )
    line, cells = max(heads, key=lambda row: len({name.casefold() for name in row[1]} & set(wanted.values())))
    known = {cell.strip(" ,;").casefold() for cell in cells}
    missing = [columns.called(key) for key in needed if wanted[key] not in known]
    text = ", ".join(cells)
    raise PathsError(f"{path}:{line}: the header must name {' and '.join(missing)}, got {text[:200]}; see --columns")


def _places(place: str, names: Sequence[str], wanted: Mapping[str, str]) -> dict[str, int]:
    twice = [name for name in wanted.values() if names.count(name) > 1]
    if twice:
        raise PathsError(f"{place}: must have one column {twice[0]!r}, got {names.count(twice[0])}")
    at = {key: names.index(name) for key, name in wanted.items() if name in names}
    given = [key for key in TANGENT_COLUMNS if key in at]
    if given and len(given) < len(TANGENT_COLUMNS):
        missing = " and ".join(wanted[key] for key in TANGENT_COLUMNS if key not in at)
        raise PathsError(f"{place}: must have all four columns of the tangent or none, got none named {missing}")
    return at


def _below(table: Table, line: int) -> list[Row]:
    """The rows below a line, without a row of units (a row without any number) right below it."""
    rows = [row for row in (*table.lead, *table.body) if row[0] > line]
    start = next((i for i, (_, cells) in enumerate(rows) if table.dialect.numbers(cells)), len(rows))
    return rows[start:]


def _rows(
    path: Path, table: Table, body: Sequence[Row], at: Mapping[str, int], width: int, ways: Mapping[str, JumpPath]
) -> dict[str, dict[int, tuple[int, list[float]]]]:
    """Path -> step -> line and numbers, those of the columns behind `PLACE_COLUMNS`."""
    found: dict[str, dict[int, tuple[int, list[float]]]] = {}
    keys = [key for key in at if key not in PLACE_COLUMNS]
    for line, cells in body:
        place = f"{path}:{line}"
        if len(cells) != width and (len(cells) > width or not table.dialect.separator):
            raise PathsError(f"{place}: must have {width} columns as the header, got {len(cells)}")
        cells = [*cells, *[""] * (width - len(cells))]
        name = cells[at["path"]]
        if name not in ways:
            raise PathsError(f"{place}: must be one of the paths that were written, got {name[:60]!r}")
        step = _step(place, cells[at["step"]], table, ways[name])
        if step in found.setdefault(name, {}):
            raise PathsError(f"{place}: path {name}, step {step} is there already, in line {found[name][step][0]}")
        found[name][step] = line, [_value(place, key, cells[at[key]], table) for key in keys]
    return found


def _step(place: str, cell: str, table: Table, way: JumpPath) -> int:
    value = table.dialect.value(cell)
    if value is None or not math.isfinite(value) or value != int(value) or not 0 <= value < way.g.size:
        raise PathsError(
            f"{place}: step must be an integer from 0 to {way.g.size - 1} on path {way.name}, got {cell[:30]!r}"
        )
    return int(value)


def _value(place: str, key: str, cell: str, table: Table) -> float:
    value = table.dialect.value(cell)
    if value is None or not math.isfinite(value):
        raise PathsError(f"{place}: {key} must be a finite number, got {cell[:30]!r}")
    if doubt := table.dialect.doubt(cell):
        raise PathsError(f"{place}: {key} must be a number of one meaning, got {cell[:30]!r}, which {doubt}")
    return value


def _all_there(path: Path, rows: Mapping[str, Mapping[int, object]], ways: Sequence[JumpPath]) -> None:
    missing = [way.name for way in ways if way.name not in rows]
    if missing:
        named = ", ".join(missing[:5]) + (f" and {len(missing) - 5} more" if len(missing) > 5 else "")
        raise PathsError(f"{path}: must hold every path that was written, got none of {named}")
    for way in ways:
        lacking = sorted(set(range(way.g.size)) - set(rows[way.name]))
        if lacking:
            n = len(rows[way.name])
            raise PathsError(
                f"{path}: path {way.name} must have {way.g.size} steps, got {n}; step {lacking[0]} is missing"
            )


def _one(
    path: Path,
    way: JumpPath,
    rows: Mapping[int, tuple[int, list[float]]],
    columns: PathColumns,
    at: Mapping[str, int],
) -> tuple[JumpPath, Answer]:
    """One path as it stands in the file."""
    keys = [key for key in at if key not in PLACE_COLUMNS]
    table = np.array([rows[step][1] for step in range(way.g.size)])
    with np.errstate(over="ignore"):
        value = {key: table[:, i] * columns.scales.get(key, 1.0) for i, key in enumerate(keys)}
    largest = max(np.abs(way.g).max(), np.abs(way.s).max())
    for key, written in zip(JUMP_COLUMNS, (way.g, way.s), strict=True):
        off = np.abs(value[key] - written) > SAME_JUMP * largest
        if off.any():
            i = int(np.argmax(off))
            text = f"{key} must be {written[i]:.9g} as written, got {value[key][i]:.9g}"
            raise PathsError(f"{path}:{rows[i][0]}: path {way.name}, step {i}: {text}; see --scales")
    if not all(np.isfinite(one).all() for one in value.values()):
        raise PathsError(f"{path}: path {way.name} must hold finite numbers after scaling, got infinity")
    tangent = None
    if TANGENT_COLUMNS[0] in at:
        tangent = np.stack([value[key] for key in TANGENT_COLUMNS], axis=1).reshape(-1, 2, 2)
    return replace(way, g=value["g"], s=value["s"]), Answer(value["p"], value["t"], tangent)


def lines(ways: Sequence[JumpPath]) -> Iterator[str]:
    """The content of ``paths.csv``, every number in full."""
    yield ",".join((*PLACE_COLUMNS, *JUMP_COLUMNS))
    for way in ways:
        for step, (g, s) in enumerate(zip(way.g.tolist(), way.s.tolist(), strict=True)):
            yield f"{way.name},{step},{g!r},{s!r}"
