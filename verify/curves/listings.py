"""Results that other programs print, as a table: `.dat` of Abaqus and CalculiX, POST26 of Ansys, nodout of LS-DYNA.

What is printed for the nodes of a set in one increment becomes one row: forces are added up, all else is averaged. A
column has the name that the program prints, and behind it that of the set where several sets print the same.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

Row = tuple[int, list[str]]  # line number, from 1, and cells

_PRINTED = r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[EeDd]?[+-]\d+|[EeDd]\d+)?"
_NUMBERS = re.compile(rf"\s*{_PRINTED}(?:\s+{_PRINTED})*\s*$")
_ABAQUS = "THE FOLLOWING TABLE IS PRINTED"
_ABAQUS_SET = re.compile(r"(?:NODE|ELEMENT) SET\s+(\S+)")
_ABAQUS_ROW = re.compile(rf"\s*(\d+)(?:\s+[A-Z]{{1,2}})?((?:\s+{_PRINTED})+)\s*$")
_CALCULIX = re.compile(r"\s*(total )?(.+?) \((\w+(?:,\s*\w+)*)\) for set (\S+) and time\s+" + rf"({_PRINTED})(?!\S)")
_POST26 = re.compile(r"POST26 VARIABLE LISTING")
_NODOUT = re.compile(rf"n o d a l   p r i n t   o u t.*at time\s*({_PRINTED})\s*\)")
#: Beginnings of names of forces, whose values at nodes are added up.
_FORCES = ("RF", "CF", "TF", "NFORC", "fx", "fy", "fz")


@dataclass(frozen=True)
class _Increment:
    """What is printed in one increment: (name, set) -> its values at nodes; ``line`` is the first one."""

    line: int
    values: dict[tuple[str, str], list[float]] = field(default_factory=dict)

    def add(self, names: Sequence[str], of: str, numbers: Sequence[float]) -> None:
        for name, number in zip(names, numbers, strict=True):
            self.values.setdefault((name, of), []).append(number)

    def has(self, names: Sequence[str], of: str) -> bool:
        return any((name, of) in self.values for name in names)


def listing(lines: Sequence[tuple[int, str]]) -> list[Row] | None:
    """Header and rows of a printed result, given its lines that are not empty; None for any other text.

    Numbers without the letter of their exponent, as Fortran prints small ones, are read.
    """
    for mark, read in _READERS:
        if any(mark(line) for _, line in lines):
            return read(lines)
    return None


def _abaqus(lines: Sequence[tuple[int, str]]) -> list[Row]:
    done: list[_Increment] = []
    names: list[str] = []
    of = ""
    for i, line in lines:
        if _ABAQUS in line:
            found = _ABAQUS_SET.search(line)
            names, of = [], found[1] if found else ""
        elif line.split()[:1] in (["NODE"], ["ELEMENT"]) and "FOOT-" in line:
            names = line.split("FOOT-")[1].split()
            if not done or done[-1].has(names, of):
                done.append(_Increment(i))
        elif names and (row := _ABAQUS_ROW.match(line)) and len(numbers := row[2].split()) == len(names):
            done[-1].add(names, of, [_float(number) for number in numbers])
        elif names and line.split()[0] not in ("NOTE",):
            names = []  # MAXIMUM, TOTAL: the table is over
    return _table(done)


def _calculix(lines: Sequence[tuple[int, str]]) -> list[Row]:
    done: list[_Increment] = []
    names: list[str] = []
    of = time = ""
    total = False
    for i, line in lines:
        if head := _CALCULIX.match(line):
            total, of = bool(head[1]), head[4]
            names = [f"{'total ' * total}{name.strip()}" for name in head[3].split(",")]
            if head[5] != time or not done:
                time = head[5]
                done.append(_Increment(i))
                done[-1].add(["time"], "", [_float(time)])
        elif names and _NUMBERS.match(line):
            numbers = [_float(number) for number in line.split()][-len(names) :]
            if len(numbers) == len(names):
                done[-1].add(names, of, numbers)
        else:
            names = []
    return _table(done)


def _post26(lines: Sequence[tuple[int, str]]) -> list[Row]:
    """One table, whose header is repeated on every page: numbers of the variables above their names."""
    rows: list[Row] = []
    heads: list[list[str]] = []
    for i, line in lines:
        if _NUMBERS.match(line):
            rows.append((i, [repr(_float(number)) for number in line.split()]))
        elif not rows and "POST26" not in line:
            heads.append([cell.strip() for cell in re.split(r"\s{2,}", line.strip())])
    width = len(rows[0][1]) if rows else 0
    first = next((head for head in heads if len(head) == width), [])
    second = next((head for head in heads if len(head) == width - 1), None)
    names = [first[0], *second] if first and second else [re.sub(r"^\d+\s+", "", name) for name in first]
    return [(rows[0][0] - 1 if rows else 0, names), *(row for row in rows if len(row[1]) == width)]


def _nodout(lines: Sequence[tuple[int, str]]) -> list[Row]:
    done: list[_Increment] = []
    names: list[str] = []
    time = ""
    for i, line in lines:
        if head := _NODOUT.search(line):
            if head[1] != time or not done:
                time = head[1]
                done.append(_Increment(i))
                done[-1].add(["time"], "", [_float(time)])
            names = []
        elif line.split()[:2] == ["nodal", "point"]:
            names = line.split()[2:]
        elif done and names and len(numbers := re.findall(_PRINTED, line)) == len(names) + 1:
            done[-1].add(names, "", [_float(number) for number in numbers[1:]])
    return _table(done)


def _table(done: Sequence[_Increment]) -> list[Row]:
    """A header and a row an increment; one that lacks a column, as a run that was killed leaves it, is dropped, and so
    is the last one if it has fewer nodes of a column than the one before."""
    done = done[:-1] if _is_cut(done) else done
    keys = list(dict.fromkeys(key for one in done for key in one.values))
    several = {name for name, _ in keys if sum(name == other for other, _ in keys) > 1}
    header = [f"{name} {of}" if name in several else name for name, of in keys]
    whole = [one for one in done if all(key in one.values for key in keys)]
    rows = [(one.line, [repr(_of_set(key[0], one.values[key])) for key in keys]) for one in whole]
    return [(done[0].line - 1 if done else 0, header), *rows]


def _is_cut(done: Sequence[_Increment]) -> bool:
    """Whether the last increment ends before all nodes are printed."""
    if len(done) < 2:
        return False
    before, last = (one.values for one in done[-2:])
    return any(len(last.get(key, ())) < len(values) for key, values in before.items())


def _of_set(name: str, values: Sequence[float]) -> float:
    return sum(values) if name.startswith(_FORCES) else sum(values) / len(values)


def _float(text: str) -> float:
    """A number as Fortran prints it: 1.0D-03, and 1.0-103."""
    text = re.sub("[dD]", "e", text)
    return float(re.sub(r"(?<=[\d.])([+-]\d+)$", r"e\1", text) if "e" not in text.lower() else text)


_Reader = Callable[[Sequence[tuple[int, str]]], list[Row]]
_READERS: tuple[tuple[Callable[[str], object], _Reader], ...] = (
    (lambda line: _ABAQUS in line, _abaqus),
    (_CALCULIX.match, _calculix),
    (_POST26.search, _post26),
    (_NODOUT.search, _nodout),
)
