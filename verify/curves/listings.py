"""Results that other programs print, as a table: `.dat` of Abaqus and CalculiX, POST26 of Ansys, nodout of LS-DYNA.

What is printed for the nodes of a set in one increment becomes one row: forces are added up, all else is averaged. A
column has the name that the program prints, and behind it that of the set where several sets print the same.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

Row = tuple[int, list[str]]  # line number, from 1, and cells
#: What is printed in one increment: its first line, and (name, set) -> values at nodes.
Increment = tuple[int, dict[tuple[str, str], list[float]]]

_PRINTED = r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[EeDd]?[+-]\d+|[EeDd]\d+)?"
#: What is left of a row of numbers without them: nothing, or the footnote of a node in Abaqus.
_FOOTNOTE = re.compile(r"\s*(?:[A-Z]{1,2})?\s*")
_POST26 = "POST26 VARIABLE LISTING"
_CALCULIX = (
    r"\s*(?P<total>total )?.+? \((?P<names>\w+(?:,\s*\w+)*)\) for set (?P<set>\S+) "
    rf"and time\s+(?P<time>{_PRINTED})(?!\S)"
)
#: Formats of tables of nodes: the line that begins one, with its set and time, and that with the names of its columns.
_FORMATS = {
    "Abaqus": (
        r".*THE FOLLOWING TABLE IS PRINTED(?:.*(?:NODE|ELEMENT) SET\s+(?P<set>\S+))?",
        r"\s*(?:NODE|ELEMENT)\s.*FOOT-(?P<names>.*)",
    ),
    "CalculiX": (_CALCULIX, _CALCULIX),
    "LS-DYNA": (
        rf".*n o d a l   p r i n t   o u t.*at time\s*(?P<time>{_PRINTED})\s*\)",
        r"\s*nodal\s+point(?P<names>.*)",
    ),
}
#: Beginnings of names of forces, whose values at nodes are added up.
_FORCES = ("RF", "CF", "TF", "NFORC", "fx", "fy", "fz")


def listing(lines: Sequence[tuple[int, str]]) -> list[Row] | None:
    """Header and rows of a printed result, given its lines that are not empty; None for any other text.

    Numbers without the letter of their exponent, as Fortran prints small ones, are read.
    """
    for patterns in _FORMATS.values():
        begins, titles = map(re.compile, patterns)
        if any(begins.match(line) for _, line in lines):
            return _table(_increments(lines, begins, titles))
    return _post26(lines) if any(_POST26 in line for _, line in lines) else None


def _increments(lines: Sequence[tuple[int, str]], begins: re.Pattern[str], titles: re.Pattern[str]) -> list[Increment]:
    """A new increment begins with another time, or where no time is printed with a column that is there already."""
    done: list[Increment] = []
    names: list[str] = []
    of, time = "", None
    for i, line in lines:
        head, titled = begins.match(line), titles.match(line)
        if head:
            given = head.groupdict()
            names, of = [], given.get("set") or ""
            if "time" in given and (given["time"] != time or not done):
                time = given["time"]
                done.append((i, {("time", ""): [_float(str(time))]}))
        if titled:
            total = titled.groupdict().get("total") or ""
            names = [total + name for name in re.split(r"[,\s]+", titled["names"].strip())]
            if time is None and (not done or any((name, of) in done[-1][1] for name in names)):
                done.append((i, {}))
        elif not head and done and names:
            numbers = re.findall(_PRINTED, line) if _FOOTNOTE.fullmatch(re.sub(_PRINTED, "", line)) else []
            if len(numbers) == len(names) + (not names[0].startswith("total ")):  # the number of the node
                for name, number in zip(names, numbers[-len(names) :], strict=True):
                    done[-1][1].setdefault((name, of), []).append(_float(number))
            elif not line.strip().startswith("NOTE"):
                names = []  # MAXIMUM, TOTAL: the table is over
    return done


def _table(done: list[Increment]) -> list[Row]:
    """A header and a row an increment; one that lacks a column, as a run that was killed leaves it, is dropped, and so
    is the last one if it has fewer nodes of a column than the one before."""
    if len(done) > 1 and any(len(done[-1][1].get(key, ())) < len(values) for key, values in done[-2][1].items()):
        done = done[:-1]
    keys = list(dict.fromkeys(key for _, values in done for key in values))
    printed = [name for name, _ in keys]
    header = [f"{name} {of}" if printed.count(name) > 1 else name for name, of in keys]
    rows = [
        (line, [repr(sum(values[key]) / (1 if key[0].startswith(_FORCES) else len(values[key]))) for key in keys])
        for line, values in done
        if values.keys() >= set(keys)
    ]
    return [(done[0][0] - 1 if done else 0, header), *rows]


def _post26(lines: Sequence[tuple[int, str]]) -> list[Row]:
    """One table, whose header is repeated on every page: numbers of the variables above their names."""
    rows: list[Row] = []
    heads: list[list[str]] = []
    for i, line in lines:
        if re.fullmatch(rf"(?:\s+{_PRINTED})+\s*", f" {line}"):
            rows.append((i, [repr(_float(number)) for number in line.split()]))
        elif not rows and _POST26 not in line:
            heads.append(re.split(r"\s{2,}", line.strip()))
    width = len(rows[0][1]) if rows else 0
    first = next((head for head in heads if len(head) == width), [])
    second = next((head for head in heads if len(head) == width - 1), None)
    names = [first[0], *second] if first and second else [re.sub(r"^\d+\s+", "", name) for name in first]
    return [(rows[0][0] - 1 if rows else 0, names), *(row for row in rows if len(row[1]) == width)]


def _float(text: str) -> float:
    """A number as Fortran prints it: 1.0D-03, and 1.0-103."""
    text = re.sub("[dD]", "e", text)
    return float(re.sub(r"(?<=[\d.])([+-]\d+)$", r"e\1", text) if "e" not in text.lower() else text)
