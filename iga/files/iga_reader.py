"""Reading `.iga` files: every line is checked as it is read, and an error names the first wrong line."""

from __future__ import annotations

import errno
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import isfinite
from pathlib import Path
from typing import cast

import numpy as np

from iga.files.iga_format import FILE_KINDS, Domain, IgaFile, NamedSet
from iga.mesh.extraction import SIDES, ElementBlock


@dataclass(frozen=True)
class FileLimits:
    """Values beyond which a file is refused.

    size : bytes.
    degree : highest degree of an element.
    magnitude : largest magnitude of a number, so that Jacobians stay finite.
    weight : least Bezier weight of an element, relative to the largest weight of its control points.
    """

    size: int = 2**28
    degree: int = 20
    magnitude: float = 1e30
    weight: float = 1e-12


FILE_LIMITS = FileLimits()

_NUMBER = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?", re.ASCII).fullmatch


class IgaError(ValueError):
    """A file that is not a complete `.iga` file; ``line`` counts from 1."""

    def __init__(self, path: Path, line: int, text: str) -> None:
        super().__init__(f"{path}: line {line}: {text}")
        self.line = line


@dataclass(frozen=True)
class _Line:
    """The words of one line without its comment; no words at the end of the file.

    ``plain`` lines are ASCII without underscores: in them, every word that ``float`` accepts is a number of the format.
    """

    path: Path
    number: int
    words: tuple[str, ...]
    plain: bool = False

    def refusal(self, expected: str, got: object = None) -> IgaError:
        found = got if got is not None else repr(_short(self.words[0])) if self.words else "the end of the file"
        return IgaError(self.path, self.number, f"expected {expected}, got {found}")

    def counted(self, words: Sequence[str], count: int, what: str) -> Sequence[str]:
        if len(words) != count:
            raise self.refusal(f"{count} {what}", len(words) if self.words else None)
        return words

    def integer(self, word: str, low: int, high: int, what: str) -> int:
        value = int(word) if word.isascii() and word.isdigit() and len(word) < 10 else -1
        if not low <= value <= high:
            raise self.refusal(f"{what} from {low} to {high}", repr(_short(word)))
        return value

    def ids(self, words: Sequence[str], count: int, limit: int, what: str) -> np.ndarray:
        """Different integers from 0 to limit - 1."""
        ids = [self.integer(word, 0, limit - 1, f"{what} ids") for word in words]
        self.counted(words, count, f"{what} ids")
        self.different(ids, f"{what} ids")
        return np.array(ids, dtype=int)

    def different(self, entries: Sequence, what: str) -> None:
        if len(set(entries)) != len(entries):
            twice = next(entry for i, entry in enumerate(entries) if entry in entries[:i])
            raise self.refusal(f"different {what}", f"{twice} twice")

    def numbers(self, words: Sequence[str], count: int, what: str) -> list[float]:
        """``count`` finite numbers."""
        if self.plain and len(words) == count:  # the usual case is fast: files have thousands of such lines
            try:
                values = list(map(float, words))
            except ValueError:
                values = [np.nan]
            within = max(values) <= FILE_LIMITS.magnitude and min(values) >= -FILE_LIMITS.magnitude
            if within and isfinite(sum(values)):  # NaN can pass the comparisons
                return values
        if wrong := [word for word in words if not _NUMBER(word)]:
            raise self.refusal(f"{count} {what}, all finite numbers", repr(_short(wrong[0])))
        values = list(map(float, self.counted(words, count, what)))
        if max(values) > FILE_LIMITS.magnitude or min(values) < -FILE_LIMITS.magnitude:
            raise self.refusal(f"numbers up to {FILE_LIMITS.magnitude:g} in magnitude", f"{max(values, key=abs):g}")
        return values


def read_iga(path: Path | str) -> IgaFile:
    """Read an `.iga` file.

    Raises
    ------
    IgaError : the file is incomplete or not of the format; the message names the line and what was expected there.
    OSError : the file does not exist or cannot be read.
    """
    lines = _lines(Path(path))
    kind, nodes, elements = _header(lines)
    xyzw = np.array([_node(next(lines), i, nodes) for i in range(nodes)])
    read = [_element(lines, i, elements, nodes, kind) for i in range(elements)]
    blocks, block_e, place_e = _grouped(read, xyzw[:, 3])
    sets, domains = _rest(lines, nodes, [element.conn_a for element in read])
    return IgaFile(kind, xyzw[:, :3], xyzw[:, 3], blocks, block_e, place_e, sets, domains)


def _lines(path: Path) -> Iterator[_Line]:
    """All lines with words, then the end of the file without end."""
    with path.open("rb") as stream:
        data = stream.read(FILE_LIMITS.size + 1)
    if len(data) > FILE_LIMITS.size:
        raise OSError(errno.EFBIG, f"it has more than {FILE_LIMITS.size / 1e6:.0f} MB", str(path))
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        last = len(_split(data[: error.start].decode("utf-8", "replace")))
        raise IgaError(path, last, f"expected UTF-8 text, got the byte 0x{data[error.start]:02x}") from None
    number = 0
    for number, line in enumerate(_split(text), 1):
        words = line.split()
        comment = next((i for i, word in enumerate(words) if word[0] == "#"), None) if "#" in line else None
        if words[:comment]:
            yield _Line(path, number, tuple(words[:comment]), line.isascii() and "_" not in line)
    while True:
        yield _Line(path, number, ())


def _header(lines: Iterator[_Line]) -> tuple[str, int, int]:
    """Type, number of nodes and number of elements, in any order."""
    found: dict[str, str] = {}
    while missing := [key for key in ("type", "nodeN", "elemN") if key not in found]:
        line = next(lines)
        if not line.words or line.words[0] not in missing:
            raise line.refusal(" or ".join(missing))
        key, (word,) = line.words[0], line.counted(line.words[1:], 1, f"word after {line.words[0]}")
        if key != "type":
            line.integer(word, 1, 999_999_999, "a number")
        elif word not in FILE_KINDS:
            raise line.refusal(f"type {', '.join(FILE_KINDS[:-1])} or {FILE_KINDS[-1]}", repr(_short(word)))
        found[key] = word
    return found["type"], int(found["nodeN"]), int(found["elemN"])


def _node(line: _Line, i: int, nodes: int) -> list[float]:
    if line.words[:1] != ("node",):
        raise line.refusal(f"node {i + 1} of {nodes}")
    values = line.numbers(line.words[1:], 4, "numbers x y z w of a node")
    if not values[3] >= 1 / FILE_LIMITS.magnitude:
        raise line.refusal(f"a weight > 0, {1 / FILE_LIMITS.magnitude:g} or more", line.words[4])
    return values


@dataclass(frozen=True)
class _Element:
    """One element: its first line, its degrees, its control points (n_a,) and its extraction operator (n_a, n_b)."""

    line: _Line
    degrees: tuple[int, ...]
    conn_a: np.ndarray
    C_ab: np.ndarray


def _element(lines: Iterator[_Line], i: int, elements: int, nodes: int, kind: str) -> _Element:
    head = next(lines)
    if head.words[:1] != ("belem",):
        raise head.refusal(f"belem {i + 1} of {elements}")
    directions = {"plane": (2,), "surface": (2,), "volume": (3,)}.get(kind, (2, 3))
    if len(head.words) - 2 not in directions:
        raise head.refusal(f"a number of functions and {directions[0]} degrees", f"{len(head.words) - 1} numbers")
    count = head.integer(head.words[1], 1, nodes, "a number of functions")
    degrees = tuple(head.integer(word, 1, FILE_LIMITS.degree, "a degree") for word in head.words[2:])
    line = next(lines)
    conn = line.ids(line.words, count, nodes, "node")
    size = int(np.prod([p + 1 for p in degrees]))
    C_ab = []
    for a in range(count):
        line = next(lines)
        C_ab.append(line.numbers(line.words, size, f"coefficients of function {a + 1} of {count} on element {i}"))
    return _Element(head, degrees, conn, np.array(C_ab))


def _grouped(read: Sequence[_Element], w_A: np.ndarray) -> tuple[tuple[ElementBlock, ...], np.ndarray, np.ndarray]:
    """Blocks of elements with the same degrees and number of functions; block of each element and place in it."""
    members: dict[tuple, list[int]] = {}
    for i, element in enumerate(read):
        members.setdefault((element.degrees, len(element.conn_a)), []).append(i)
    blocks, block_e, place_e = [], np.empty(len(read), dtype=int), np.empty(len(read), dtype=int)
    for number, e in enumerate(members.values()):
        degrees = cast(tuple[int, int], read[e[0]].degrees)  # three of a volume, which never becomes a `Mesh`
        block = ElementBlock(degrees, np.array([read[i].C_ab for i in e]), np.array([read[i].conn_a for i in e]))
        w_ea = w_A[block.conn_ea]
        w_eb = np.einsum("ea,eab->eb", w_ea, block.C_eab)
        positive_e = np.all(w_eb > FILE_LIMITS.weight * w_ea.max(1, keepdims=True), axis=1)
        if not np.all(positive_e):
            wrong = int(np.argmin(positive_e))
            text = f"coefficients that give element {e[wrong]} positive Bezier weights"
            raise read[e[wrong]].line.refusal(text, f"{w_eb[wrong].min():.6g}")
        blocks.append(block)
        block_e[e], place_e[e] = number, np.arange(len(e))
    return tuple(blocks), block_e, place_e


def _rest(
    lines: Iterator[_Line], nodes: int, conn_e: Sequence[np.ndarray]
) -> tuple[tuple[NamedSet, ...], tuple[Domain, ...]]:
    sets: dict[tuple[str, str], NamedSet] = {}
    domains = []
    while (line := next(lines)).words:
        if line.words[0] == "set":
            part = _set(line, nodes, len(conn_e))
            if (part.kind, part.name) in sets:
                raise line.refusal(f"different names of {part.kind} sets", f"{_short(part.name)!r} twice")
            sets[part.kind, part.name] = part
        elif line.words[0] == "domain":
            domains.append(_domain(line, lines, nodes, conn_e))
        else:
            raise line.refusal("set, domain or the end of the file")
    return tuple(sets.values()), tuple(domains)


def _set(line: _Line, nodes: int, elements: int) -> NamedSet:
    if len(line.words) < 4:
        raise line.refusal("set, a number of entries, node, side or elem, and a name", f"{len(line.words)} words")
    (_, word, kind, name), entries = line.words[:4], line.words[4:]
    count = line.integer(word, 0, 999_999_999, "a number of entries")
    if kind not in ("node", "side", "elem"):
        raise line.refusal("node, side or elem", repr(_short(kind)))
    if _NUMBER(name):
        raise line.refusal("the name of the set", repr(_short(name)))
    if kind != "side":
        return NamedSet(kind, name, line.ids(entries, count, nodes if kind == "node" else elements, kind))
    line.counted(entries, 2 * count, f"words, an element and a side each, for {count} sides")
    ids = [line.integer(word, 0, elements - 1, "element ids") for word in entries[::2]]
    sides = tuple(entries[1::2])
    if wrong := [side for side in sides if side not in SIDES]:
        raise line.refusal(f"a side {', '.join(SIDES)}", repr(_short(wrong[0])))
    line.different(list(zip(ids, sides, strict=True)), "sides")
    return NamedSet(kind, name, np.array(ids, dtype=int), sides)


def _domain(line: _Line, lines: Iterator[_Line], nodes: int, conn_e: Sequence[np.ndarray]) -> Domain:
    line.counted(line.words[1:], 2, "numbers after domain, of elements and of functions")
    n_e = line.integer(line.words[1], 1, len(conn_e), "a number of elements")
    n_a = line.integer(line.words[2], 1, nodes, "a number of functions")
    line = next(lines)
    elements = line.ids(line.words, n_e, len(conn_e), "element")
    line = next(lines)
    functions = line.ids(line.words, n_a, nodes, "node")
    places = []
    for e in elements:
        line = next(lines)
        places.append(line.ids(line.words, len(conn_e[e]), n_a, "domain"))
    return Domain(elements, functions, tuple(places))


def _split(text: str) -> list[str]:
    """Lines of a text with any line ends."""
    return text.replace("\r\n", "\n").replace("\r", "\n").split("\n")


def _short(word: str) -> str:
    return word if len(word) <= 40 else f"{word[:37]}..."
