"""Tractions on the paths from a text file of another program, and the file of the paths themselves."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import dropwhile
from pathlib import Path

import numpy as np

from verify.curves.read import text_of
from verify.curves.text_table import Table, read_table
from verify.studies.law.laws import Answer
from verify.studies.law.paths import JumpPath
from verify.support.refusal import Refusal

PATHS_FILE = "paths.csv"
PLACE_COLUMNS, TANGENT_COLUMNS = ("path", "step"), ("dp_dg", "dp_ds", "dt_dg", "dt_ds")
#: Columns that a file must have, and all that it may have.
NEEDED_COLUMNS = (*PLACE_COLUMNS, "g", "s", "p", "t")
FILE_COLUMNS = (*NEEDED_COLUMNS, *TANGENT_COLUMNS)

#: Tolerance of a jump in the file, relative to the largest jump of its path: numbers of six digits pass.
SAME_JUMP = 1e-5


def lines(ways: Sequence[JumpPath]) -> Iterator[str]:
    """The content of ``paths.csv``, every number in full."""
    yield "path,step,g,s"
    for way in ways:
        jumps = zip(way.g.tolist(), way.s.tolist(), strict=True)
        yield from (f"{way.name},{step},{g!r},{s!r}" for step, (g, s) in enumerate(jumps))


def read_paths(
    path: Path, ways: Sequence[JumpPath], names: Mapping[str, str], scales: Mapping[str, float]
) -> tuple[list[JumpPath], dict[str, Answer]]:
    """The paths with the jumps as they stand in the file, and the tractions there.

    The file has one row for every step of every path, in any order, with a header: ``path,step,g,s,p,t``, and the four
    of the tangent or none. Separators, comments and decimal marks are those of `verify.curves.read`.

    Parameters
    ----------
    names : of columns, where they differ from `FILE_COLUMNS`
    scales : factors on numbers of columns

    Raises
    ------
    Refusal : naming the file, and the line or the path; a column that no file has here, or two of one name.
    """
    if unknown := sorted({*names} - {*FILE_COLUMNS} | {*scales} - {*FILE_COLUMNS[2:]}):
        known = ", ".join(FILE_COLUMNS)
        raise Refusal(f"columns: must be of {known}, scales of all but the first two, got {unknown[0]!r}")
    called = {key: names.get(key, key).casefold() for key in FILE_COLUMNS}
    if len({*called.values()}) < len(called):
        raise Refusal(f"columns: must be different ones, got {', '.join(called.values())}")
    table = read_table(text_of(path, "tractions"))
    head, columns = _header(path, table, called)
    at = {key: columns.index(name) for key, name in called.items() if name in columns}
    written = {(way.name, float(step)) for way in ways for step in range(way.g.size)}
    found: dict[tuple[str, float | None], tuple[int, list[float]]] = {}
    rows = [row for row in (*table.lead, *table.body) if row[0] > head]
    for line, cells in dropwhile(lambda row: not table.dialect.numbers(row[1]), rows):  # not those of units
        place, missing = f"{path}:{line}", len(columns) - len(cells)
        if missing < 0 or (missing and not table.dialect.separator):
            raise Refusal(f"{place}: must have {len(columns)} columns as the header, got {len(cells)}")
        text = {key: [*cells, *[""] * missing][i] for key, i in at.items()}
        where = text["path"], table.dialect.value(text["step"])
        if where not in written or where in found:
            rule = f"is there already, in line {found[where][0]}" if where in found else "is none that was written"
            raise Refusal(f"{place}: path {text['path'][:60]!r}, step {text['step'][:30]!r} {rule}")
        found[where] = line, [_value(place, key, cell, table) for key, cell in text.items() if key not in PLACE_COLUMNS]
    if lacking := sorted(written - {*found}):
        more = f" and {len(lacking) - 1} more" if len(lacking) > 1 else ""
        name, step = lacking[0]
        raise Refusal(f"{path}: must hold every step that was written, got none of path {name}, step {step:g}{more}")
    read = [_one(path, way, [found[way.name, step] for step in range(way.g.size)], scales) for way in ways]
    return [way for way, _ in read], {way.name: answer for way, answer in read}


def _header(path: Path, table: Table, called: Mapping[str, str]) -> tuple[int, list[str]]:
    """Line and columns of the header: the line that names the most of them."""
    titles = [(line, [cell.strip(" ,;").casefold() for cell in cells]) for line, cells in (*table.lead, *table.remarks)]
    line, columns = max(titles, key=lambda title: len({*title[1]} & {*called.values()}), default=(1, []))
    keys = FILE_COLUMNS if any(called[key] in columns for key in TANGENT_COLUMNS) else NEEDED_COLUMNS
    if wrong := [called[key] for key in keys if columns.count(called[key]) != 1]:
        got = ", ".join(columns)[:200] or "no names"
        raise Refusal(f"{path}:{line}: the header must name {' and '.join(wrong)} once, got {got}; see --columns")
    return line, columns


def _value(place: str, key: str, cell: str, table: Table) -> float:
    value = table.dialect.value(cell)
    if value is None or not math.isfinite(value):
        raise Refusal(f"{place}: {key} must be a finite number, got {cell[:30]!r}")
    if doubt := table.dialect.doubt(cell):
        raise Refusal(f"{place}: {key} must be a number of one meaning, got {cell[:30]!r}, which {doubt}")
    return value


def _why_other(found: np.ndarray, written: np.ndarray) -> str:
    """What to do about jumps (2, n) that are not those written: a factor or a sign, g for s, or other paths."""
    if np.abs(found[::-1] - written).max() <= SAME_JUMP * np.abs(written).max():
        return "g and s are exchanged: --columns g=s,s=g"
    size = (found**2).sum(1)
    ratio = np.divide((found * written).sum(1), size, out=np.ones(2), where=size > 0.0)
    if np.abs(ratio[:, None] * found - written).max() <= SAME_JUMP * np.abs(written).max():
        return "--scales " + ",".join(f"{key}={one:.6g}" for key, one in zip("gs", ratio, strict=True) if one != 1.0)
    return "are these the paths of this scene?"


def _one(
    path: Path, way: JumpPath, rows: Sequence[tuple[int, list[float]]], scales: Mapping[str, float]
) -> tuple[JumpPath, Answer]:
    """One path with the numbers in the file, in the order of its columns."""
    numbers = np.array([row for _, row in rows]).T
    with np.errstate(over="ignore"):
        numbers *= [[scales.get(key, 1.0)] for key in FILE_COLUMNS[2 : 2 + len(numbers)]]
    off = np.abs(numbers[:2] - way.jump)
    if off.max() > SAME_JUMP * np.abs(way.jump).max():
        k, i = divmod(int(np.argmax(off)), way.g.size)
        text = f"{'gs'[k]} must be {way.jump[k, i]:.9g} as written, got {numbers[k, i]:.9g}"
        raise Refusal(f"{path}:{rows[i][0]}: path {way.name}, step {i}: {text}; {_why_other(numbers[:2], way.jump)}")
    if not np.isfinite(numbers).all():
        raise Refusal(f"{path}: path {way.name} must hold finite numbers after scaling, got infinity")
    g, s, p, t, *tangent = numbers
    return replace(way, g=g, s=s), Answer(p, t, np.array(tangent).T.reshape(-1, 2, 2) if tangent else None)
