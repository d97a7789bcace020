"""Decks of Abaqus as a mesh: blocks of nodes, elements and sets, generated ones, and files that are included."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

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
NUMBERS = "debond:numbers"
#: Cohesive elements: lines on their lower face, and a group of that name.
COHESIVE = "COH2D4"
#: Files that may include each other.
DEPTH = 5
#: Keywords that define nodes and elements in a way that is not read.
UNREAD = ("PARAMETER", "NFILL", "NCOPY", "ELCOPY", "NMAP", "ELEMENT COPY")


class NotRead(ValueError):
    """A file that is whole, but has what is not read here."""


@dataclass(frozen=True)
class Block:
    """A keyword with its options and rows of data; ``at`` says where."""

    at: str
    keyword: str
    options: Mapping[str, str]
    rows: list[list[str]]


@dataclass(frozen=True)
class _Deck:
    """What has been read of a deck: nodes, elements by number, and sets by kind and name."""

    node_n: dict[int, list[float]] = field(default_factory=dict)
    element_e: dict[int, tuple[str, list[int]]] = field(default_factory=dict)
    sets: dict[str, dict[str, list[int]]] = field(default_factory=lambda: {"NSET": {}, "ELSET": {}})

    def collect(self, kind: str, name: str | None, numbers: Sequence[int]) -> None:
        if name:
            self.sets[kind].setdefault(name, []).extend(numbers)


def read_deck(text: str, folder: Path) -> Mesh:
    """The mesh of a deck in a folder, read here: of several blocks of nodes or of one set `meshio` would keep the last,
    and it knows neither plane strain nor cohesive elements.

    Raises
    ------
    NotRead : elements of another kind of body, more than one part, whose nodes have the same numbers, a keyword or a
        file that is not read; the message names file and line.
    """
    blocks, deck = list(_blocks(text, folder, "", DEPTH)), _Deck()
    if sum(block.keyword == "PART" for block in blocks) > 1:
        raise NotRead("must be written without parts and assemblies, or with both arms in one part")
    for block in blocks:
        options, rows = block.options, block.rows
        if block.keyword in UNREAD:
            raise NotRead(f"{block.at}: *{block.keyword} is not read; write nodes and elements out")
        if block.keyword == "NODE":
            deck.node_n.update({int(n): [float(x or 0.0) for x in (*X, "", "")[:3]] for n, *X in rows})
            deck.collect("NSET", options.get("NSET"), [int(row[0]) for row in rows])
        elif block.keyword == "NGEN":
            deck.collect("NSET", options.get("NSET"), _generate_nodes(block, deck.node_n))
        elif block.keyword == "ELEMENT" and rows:
            _elements(block, deck)
        elif block.keyword == "ELGEN":
            deck.collect("ELSET", options.get("ELSET"), _generate_elements(block, deck))
        elif block.keyword in deck.sets:
            members = _members(rows, "GENERATE" in options, deck.sets[block.keyword])
            deck.collect(block.keyword, options.get(block.keyword), members)
    return _mesh(deck)


def _blocks(text: str, folder: Path, file: str, depth: int) -> Iterator[Block]:
    """The blocks of a deck and of the files that it includes, which lie beside it or below."""
    last: Block | None = None
    for number, line in enumerate(text.splitlines(), 1):
        words = [word.strip() for word in line.split(",")]
        if line.startswith("*") and not line.startswith("**"):
            options = (word.partition("=") for word in words[1:])
            known = {key.strip().upper(): value.strip() for key, _, value in options}
            at, keyword = f"{file}line {number}", words[0][1:].upper()
            if last is not None:
                yield last
            last = Block(at, keyword, known, [])
            if keyword == "INCLUDE":
                last = None
                yield from _included(known.get("INPUT", ""), at, folder, depth)
        elif last is not None and line.strip() and not line.startswith("**"):
            last.rows.append(words)
    if last is not None:
        yield last


def _included(name: str, at: str, folder: Path, depth: int) -> Iterator[Block]:
    name = name.strip("\"'")
    path = folder / name
    if not name or Path(name).is_absolute() or ".." in Path(name).parts:
        raise NotRead(f"{at}: *INCLUDE must name a file beside the deck or below, got {name or 'none'!r}")
    if depth == 0:
        raise NotRead(f"{at}: *INCLUDE: files must include each other at most {DEPTH} deep")
    if not path.is_file():  # no device and no pipe, which may never end
        raise NotRead(f"{at}: *INCLUDE: there is no file {name} beside the deck")
    yield from _blocks(path.read_text(errors="replace"), folder, f"{name}: ", depth - 1)


def _elements(block: Block, deck: _Deck) -> None:
    name = block.options.get("TYPE", "")
    first = sum(map(bool, block.rows[0])) - 1
    if _OF_A_USER.fullmatch(name):  # cohesive elements of a user: the scene describes the bond
        return
    kind, size = _element(name, first, block.at)
    numbers = [int(cell) for row in block.rows for cell in row if cell]
    if len(numbers) % (size + 1):
        raise NotRead(
            f"{block.at}: elements {name} must have {size} nodes each, got {len(numbers)} numbers in all; cut off?"
        )
    rows = [numbers[i : i + size + 1] for i in range(0, len(numbers), size + 1)]
    for number, *nodes in rows:
        deck.element_e[number] = kind, nodes[:2] if name.upper() == COHESIVE else nodes
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


def _generate_nodes(block: Block, node_n: dict[int, list[float]]) -> list[int]:
    """Nodes on the lines between two, in equal distances: first, last, increment of their numbers."""
    made = []
    for first, last, *step in ([int(cell) for cell in row if cell] for row in block.rows):
        numbers = range(first, last + 1, *step)
        if first not in node_n or last not in node_n:
            raise NotRead(f"{block.at}: *NGEN: nodes {first} and {last} must be defined before it")
        X = np.linspace(node_n[first], node_n[last], len(numbers))
        node_n.update({n: X_I.tolist() for n, X_I in zip(numbers, X, strict=True)})
        made += list(numbers)
    return made


def _generate_elements(block: Block, deck: _Deck) -> list[int]:
    """Copies of an element: up to three times a count, and the steps of the numbers of nodes and elements."""
    made = []
    for master, *numbers in ([int(cell) for cell in row if cell] for row in block.rows):
        if master not in deck.element_e:
            raise NotRead(f"{block.at}: *ELGEN: element {master} must be defined before it")
        kind, nodes = deck.element_e[master]
        steps = [(0, 0)]
        for i in range(0, len(numbers), 3):
            count, of_nodes, of_elements = (*numbers[i : i + 3], 1, 1)[:3]
            steps = [(n + k * of_nodes, e + k * of_elements) for k in range(count) for n, e in steps]
        for n, e in steps:
            deck.element_e[master + e] = kind, [node + n for node in nodes]
            made.append(master + e)
    return made


def _members(rows: Sequence[Sequence[str]], generated: bool, known: Mapping[str, Sequence[int]]) -> list[int]:
    """Numbers of a set, told one by one, by first, last and step, or by the names of sets."""
    if generated:
        spans = ([int(cell) for cell in row if cell] for row in rows)
        return [n for first, last, *step in spans for n in range(first, last + 1, *step)]
    cells = [cell for row in rows for cell in row if cell]
    return [n for cell in cells for n in ([int(cell)] if cell.isdigit() else known[cell])]


def _mesh(deck: _Deck) -> Mesh:
    from meshio import Mesh

    place = {n: i for i, n in enumerate(deck.node_n)}
    kinds = dict.fromkeys((kind, len(nodes)) for kind, nodes in deck.element_e.values())
    cells, number_be = [], []
    for kind, size in kinds:
        members = {e: nodes for e, (one, nodes) in deck.element_e.items() if (one, len(nodes)) == (kind, size)}
        if missing := next((n for nodes in members.values() for n in nodes if n not in place), None):
            raise NotRead(f"elements must have nodes of the file, got node {missing}, which is not there")
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
        info={NUMBERS: (np.array(list(deck.node_n)), number_be)},
    )
