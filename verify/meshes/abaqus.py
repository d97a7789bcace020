"""Decks of Abaqus as a mesh: blocks of nodes, elements and sets, generated ones, and files that are included."""

from __future__ import annotations

import ast
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from operator import add, mul, sub, truediv
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from meshio import Mesh

#: Elements of a plane body: name in `meshio` -> number of nodes; and what groups of nodes may consist of.
PLANE_TYPES = {"triangle": 3, "quad": 4, "triangle6": 6, "quad8": 8, "quad9": 9}
LINE_TYPES = ("vertex", "line", "line3")

#: Elements of a plane body, also shells and axisymmetric ones, by their number of nodes; those that are no body, like a
#: truss or a mass; those of a user, which may be cohesive.
_SOLID = re.compile(r"(?:CP[ES]G?|CAX|STRI|S|M2D)(3|4|6|8)[A-Z]*5?", re.IGNORECASE)
_NO_BODY = re.compile(r"(T2D|T3D|B2|B3)[123]H?|MASS|ROTARYI|(SPRING|DASHPOT|CONN)\w*", re.IGNORECASE)
_OF_A_USER = re.compile(r"U\d+", re.IGNORECASE)

#: Key of what a deck numbers its nodes and the elements of each block, in the ``info`` of its mesh.
DECK_NUMBERS = "debond:numbers"
#: Cohesive elements: lines on their lower face, and a group of that name.
COHESIVE = "COH2D4"
#: Files that may include each other, and the bytes of all that a deck includes; each file counts as many at least.
DEPTH, MOST_INCLUDED, LEAST_INCLUDED = 5, 100_000_000, 100_000
#: Keywords that define nodes and elements in a way that is not read.
UNREAD = ("NCOPY", "ELCOPY", "NMAP", "ELEMENT COPY", "SYSTEM")
#: Options by which nodes do not lie on straight lines in equal distances, or where their numbers say.
UNREAD_OPTIONS = ("LINE", "BIAS", "SINGULAR", "TWO STEP", "SYSTEM")
#: Numbers in one row of a generator or of a set, at most.
MOST_NUMBERS = 10_000_000
#: Keywords whose rows may stand in a file beside the deck; nodes and elements of an assembly are not those of its part.
_NUMBERED = ("NODE", "ELEMENT", "NGEN", "NFILL", "ELGEN")
_ON_FILES = ("INCLUDE", "NSET", "ELSET", *_NUMBERED)
#: By what a parameter may be computed.
ARITHMETIC: dict[type, Any] = {ast.Add: add, ast.Sub: sub, ast.Mult: mul, ast.Div: truediv, ast.Pow: pow}


class NotRead(ValueError):
    """A file that is whole, but has what is not read here."""


@dataclass(frozen=True)
class Block:
    """A keyword with its options and its rows of data, each with where it is."""

    at: str
    keyword: str
    options: Mapping[str, str]
    rows: list[tuple[str, list[str]]] = field(default_factory=list)

    @property
    def numbers(self) -> Iterator[tuple[str, list[int]]]:
        """The whole numbers of each row."""
        return ((at, _numbers(at, filter(None, row))) for at, row in self.rows)


@dataclass(frozen=True)
class _Deck:
    """What has been read of a deck: nodes, elements by number, and sets by kind and name."""

    node_n: dict[int, list[float]] = field(default_factory=dict)
    element_e: dict[int, tuple[str, list[int], str]] = field(default_factory=dict)  # type, nodes, where
    sets: dict[str, dict[str, list[int]]] = field(default_factory=lambda: {"NSET": {}, "ELSET": {}})

    def collect(self, kind: str, name: str | None, numbers: Sequence[int]) -> None:
        if name and numbers:
            self.sets[kind].setdefault(self._spelt(kind, name), []).extend(numbers)

    def _spelt(self, kind: str, name: str) -> str:
        return next((known for known in self.sets[kind] if known.upper() == name.upper()), name)

    def members(self, kind: str, name: str, at: str) -> list[int]:
        """The members of a set, or the one whose number stands for it."""
        if name.isdecimal():
            return [int(name)]
        if (spelt := self._spelt(kind, name)) not in self.sets[kind]:
            raise NotRead(f"{at}: set {name} must be defined before it")
        return self.sets[kind][spelt]


def read_deck(text: str, folder: Path) -> Mesh:
    """The mesh of a deck in a folder, read here: of several blocks of nodes or of one set `meshio` would keep the last,
    and it knows neither plane strain nor cohesive elements.

    Raises
    ------
    NotRead : elements of another kind of body, more than one part, whose nodes have the same numbers, a keyword or a
        file that is not read; the message names file and line.
    """
    blocks, deck = list(_blocks(_lines(text, folder, "", DEPTH, [MOST_INCLUDED]))), _Deck()
    if parts := [block.at for block in blocks if block.keyword == "PART"][1:]:
        raise NotRead(f"{parts[0]}: must be written without parts and assemblies, or with both arms in one part")
    of_assembly = False
    for block in blocks:
        keyword, options = block.keyword, block.options
        of_assembly = (of_assembly or keyword == "ASSEMBLY") and keyword != "END ASSEMBLY"
        if of_assembly and deck.element_e and (keyword in _NUMBERED or "INSTANCE" not in options):
            continue
        if keyword in UNREAD:
            raise NotRead(f"{block.at}: *{keyword} is not read; write nodes and elements out")
        if keyword in _NUMBERED and (odd := [option for option in UNREAD_OPTIONS if option in options]):
            raise NotRead(f"{block.at}: *{keyword}: {odd[0]} is not read; write nodes out, in the axes of the deck")
        if keyword == "NODE":
            numbers = [_numbers(at, row[:1])[0] for at, row in block.rows]
            X = [_numbers(at, (cell or "0" for cell in (*row, "", "")[1:4]), float) for at, row in block.rows]
            deck.node_n.update(zip(numbers, X, strict=True))
            deck.collect("NSET", options.get("NSET"), numbers)
        elif keyword in _GENERATE:
            deck.collect("NSET", options.get("NSET"), _GENERATE[keyword](block, deck))
        elif keyword == "ELEMENT" and block.rows:
            _elements(block, deck)
        elif keyword == "ELGEN":
            deck.collect("ELSET", options.get("ELSET"), _generate_elements(block, deck))
        elif keyword in deck.sets:
            deck.collect(keyword, options.get(keyword), _members(block, deck))
    if not deck.node_n or not deck.element_e:
        there = ", ".join(f"*{one}" for one in dict.fromkeys(block.keyword for block in blocks) if one)[:200] or "none"
        raise NotRead(f"must have rows below the keywords *NODE and *ELEMENT of Abaqus, got the keywords {there}")
    return _mesh(deck)


def _numbers(at: str, cells: Iterable[str], kind: Callable[[str], Any] = int) -> list[Any]:
    """Numbers of a row."""
    try:
        return [kind(cell) for cell in cells]
    except ValueError as error:
        what = "whole numbers" if kind is int else "numbers"
        raise NotRead(f"{at}: must have {what}, got {str(error).rpartition(': ')[2][:40]}") from None


def _lines(text: str, folder: Path, file: str, depth: int, left: list[int]) -> Iterator[tuple[str, str]]:
    """Where each line is, and the line: without comments, keywords whole, and with the files that are included, of
    which so many bytes are ``left``."""
    begun = ""
    for number, line in enumerate(text.splitlines(), 1):
        if line.startswith("**") or not line.strip():
            continue
        at, begun = f"{file}line {number}", f"{begun}{line.strip()}"
        if not begun.startswith("*"):
            yield at, begun
        elif begun.endswith(","):  # goes on in the next line
            continue
        else:
            keyword = begun[1:].partition(",")[0].strip().upper()
            given = re.search(r",\s*INPUT\s*=\s*([^,]*)", begun, re.IGNORECASE)
            if keyword != "INCLUDE":
                yield at, begun
            if keyword == "INCLUDE" or (given and keyword in _ON_FILES):
                name = given[1].strip(" \"'") if given else ""
                more = _included(name, f"{at}: *{keyword}", folder, depth, left)
                yield from _lines(more, folder, f"{name}: ", depth - 1, left)
        begun = ""


def _included(name: str, at: str, folder: Path, depth: int, left: list[int]) -> str:
    """The text of a file beside the deck or below."""
    path = folder / name
    if not name or Path(name).is_absolute() or ".." in Path(name).parts:
        raise NotRead(f"{at} must name a file beside the deck or below, got {name or 'none'!r}")
    if depth == 0:
        raise NotRead(f"{at}: files must include each other at most {DEPTH} deep")
    if not path.is_file():  # no device and no pipe, which may never end
        raise NotRead(f"{at}: there is no file {name} beside the deck")
    left[0] -= max(path.stat().st_size, LEAST_INCLUDED)
    if left[0] < 0:
        raise NotRead(f"{at}: what a deck includes must have at most {MOST_INCLUDED / 1e6:g} MB in all, got more")
    return path.read_text(errors="replace")


def _blocks(lines: Iterable[tuple[str, str]]) -> Iterator[Block]:
    """Keywords with their rows, in which parameters have values."""
    last, parameters = Block("", "", {}), dict[str, float]()
    for at, raw in lines:
        line = re.sub(r"<\s*(\w+)\s*>", lambda found: _computed(found[1], parameters, at), raw)  # noqa: B023
        words = [word.strip() for word in line.split(",")]
        if line.startswith("*"):
            yield last
            options = (word.partition("=") for word in words[1:])
            known = {key.strip().upper(): value.strip() for key, _, value in options}
            last = Block(at, words[0][1:].strip().upper(), known)
        elif last.keyword == "PARAMETER":
            name, _, formula = line.partition("#")[0].partition("=")
            if name.strip():
                parameters[name.strip()] = float(_computed(formula, parameters, at))
        else:
            last.rows.append((at, words))
    yield last


def _computed(formula: str, parameters: Mapping[str, float], at: str) -> str:
    """The number that is a formula of parameters."""

    def value(node: ast.expr) -> float:
        match node:
            case ast.Constant(int() | float() as number):
                return float(number)
            case ast.Name(name):
                return parameters[name]
            case ast.UnaryOp(ast.USub(), one):
                return -value(one)
            case ast.BinOp(one, op, other):
                return ARITHMETIC[type(op)](value(one), value(other))
        raise ValueError

    try:
        found = float(value(ast.parse(formula.strip(), mode="eval").body))
        return repr(int(found) if found.is_integer() else found)
    except (ValueError, TypeError, LookupError, SyntaxError, ArithmeticError, RecursionError, MemoryError):
        what = "must be numbers and parameters that are defined before, with + - * / **"
        raise NotRead(f"{at}: *PARAMETER {what}, got {formula.strip()[:40]!r}; write its value") from None


def _elements(block: Block, deck: _Deck) -> None:
    name = block.options.get("TYPE", "")
    first = sum(map(bool, block.rows[0][1])) - 1
    if _OF_A_USER.fullmatch(name):  # cohesive elements of a user: the scene describes the bond
        return
    kind, size = _element(name, first, block.at)
    table = [row for _, row in block.numbers]
    numbers = [number for row in table for number in row]
    if len(numbers) % (size + 1) or (len({*map(len, table)}) == 1 and (size + 1) % len(table[0])):
        alike = len(table[0]) - 1 if len(table) > 1 and len({*map(len, table)}) == 1 else 0
        got = f"rows of {alike}" if alike else f"{len(numbers)} numbers in all; cut off?"
        raise NotRead(f"{block.at}: elements {name} must have {size} nodes each, got {got}")
    rows = [numbers[i : i + size + 1] for i in range(0, len(numbers), size + 1)]
    for number, *nodes in rows:
        if number in deck.element_e:
            there = deck.element_e[number][2]
            raise NotRead(f"{block.at}: element {number} must be defined once, got it at {there} as well")
        deck.element_e[number] = kind, nodes[:2] if name.upper() == COHESIVE else nodes, block.at
    deck.collect("ELSET", block.options.get("ELSET"), [row[0] for row in rows])
    if name.upper() == COHESIVE:
        deck.collect("ELSET", COHESIVE, [row[0] for row in rows])


def _element(name: str, size: int, at: str) -> tuple[str, int]:
    """Type in `meshio` and number of nodes of an element."""
    if match := _SOLID.fullmatch(name):
        size = int(match[1])
        return {size: kind for kind, size in PLANE_TYPES.items()}[size], size
    if name.upper() == COHESIVE:
        return "line", 4
    if not _NO_BODY.fullmatch(name) or size > len(LINE_TYPES):
        kinds = "plane ones (CPS, CPE, CPEG), shells (S) or CAX with 3, 4, 6 or 8 nodes, or COH2D4"
        raise NotRead(f"{at}: elements must be {kinds}, got {name or 'no TYPE'}")
    return LINE_TYPES[size - 1], size


def _generate_nodes(block: Block, deck: _Deck) -> list[int]:
    """Nodes on the lines between two, in equal distances: first, last, increment of their numbers."""
    made = []
    for at, row in block.numbers:
        numbers = _span(row, f"{at}: *NGEN")
        if numbers[0] not in deck.node_n or numbers[-1] not in deck.node_n:
            raise NotRead(f"{at}: *NGEN: nodes {numbers[0]} and {numbers[-1]} must be defined before it")
        made += _between(numbers, deck)
    return made


def _fill_nodes(block: Block, deck: _Deck) -> list[int]:
    """Nodes on the lines between those of two sets: the sets, the number of intervals, increment of the numbers."""
    made = []
    for at, row in block.rows:
        intervals, step = (*_numbers(at, filter(None, row[2:4])), 1, 1)[:2]
        if len(row) < 3 or intervals < 1:
            raise NotRead(f"{at}: *NFILL: must have two sets, a number of intervals and a step, got {', '.join(row)}")
        for first, last in zip(*(sorted({*deck.members("NSET", name, at)}) for name in row[:2]), strict=False):
            between = _span([first, first + (intervals - 1) * step, step], f"{at}: *NFILL")
            made += _between([*between, last], deck)
    return made


def _between(numbers: Sequence[int], deck: _Deck) -> list[int]:
    """Nodes of these numbers in equal distances from the first to the last one, which are there."""
    X_nI = np.linspace(deck.node_n[numbers[0]], deck.node_n[numbers[-1]], len(numbers))
    deck.node_n.update((n, X_I.tolist()) for n, X_I in zip(numbers, X_nI, strict=True))
    return list(numbers)


def _generate_elements(block: Block, deck: _Deck) -> list[int]:
    """Copies of an element: up to three times a count, and the steps of the numbers of nodes and elements."""
    made = []
    for at, (master, *numbers) in block.numbers:
        if master not in deck.element_e:
            raise NotRead(f"{at}: *ELGEN: element {master} must be defined before it")
        kind, nodes, _ = deck.element_e[master]
        steps = [(0, 0)]
        for i in range(0, len(numbers), 3):
            count, of_nodes, of_elements = (*numbers[i : i + 3], 1, 1)[:3]
            if not 1 <= count * len(steps) <= MOST_NUMBERS:
                raise NotRead(f"{at}: *ELGEN: must make 1 to {MOST_NUMBERS} elements, got {count * len(steps)}")
            steps = [(n + k * of_nodes, e + k * of_elements) for k in range(count) for n, e in steps]
        for n, e in steps:
            deck.element_e[master + e] = kind, [node + n for node in nodes], at
            made.append(master + e)
    return made


def _members(block: Block, deck: _Deck) -> list[int]:
    """Numbers of a set, told one by one, by first, last and step, or by the names of sets."""
    if "GENERATE" in block.options:
        return [n for at, row in block.numbers for n in _span(row, at)]
    return [n for at, row in block.rows for cell in filter(None, row) for n in deck.members(block.keyword, cell, at)]


def _span(row: Sequence[int], at: str) -> range:
    """The numbers from the first to the last one in steps."""
    first, last, step = row if len(row) == 3 else (*row, 1) if len(row) == 2 else (0, 0, 0)
    if step < 1 or first > last or (last - first) % step or last - first > MOST_NUMBERS * step:
        raise NotRead(f"{at}: must have first, last and a step >= 1 that leads there, got {', '.join(map(str, row))}")
    return range(first, last + 1, step)


#: Keywords that generate nodes.
_GENERATE = {"NGEN": _generate_nodes, "NFILL": _fill_nodes}


def _mesh(deck: _Deck) -> Mesh:
    from meshio import Mesh

    place = {n: i for i, n in enumerate(deck.node_n)}
    kinds = dict.fromkeys((kind, len(nodes)) for kind, nodes, _ in deck.element_e.values())
    used = [(f"{at}: elements", nodes) for _, nodes, at in deck.element_e.values()]
    used += [(f"set {name}", nodes) for name, nodes in deck.sets["NSET"].items()]
    if missing := next(((who, n) for who, nodes in used for n in nodes if n not in place), None):
        raise NotRead("{} must have nodes of the file, got node {}, which is not there".format(*missing))
    cells, number_be = [], []
    for kind, size in kinds:
        members = {e: nodes for e, (one, nodes, _) in deck.element_e.items() if (one, len(nodes)) == (kind, size)}
        cells.append((kind, np.array([[place[n] for n in nodes] for nodes in members.values()])))
        number_be.append(np.array(list(members)))
    return Mesh(
        np.array(list(deck.node_n.values())).reshape(-1, 3),
        cells,
        point_sets={name: np.array([place[n] for n in members]) for name, members in deck.sets["NSET"].items()},
        cell_sets={
            name: [np.flatnonzero(np.isin(number_e, members)) for number_e in number_be]
            for name, members in deck.sets["ELSET"].items()
        },
        info={DECK_NUMBERS: (np.array(list(deck.node_n)), number_be)},
    )
