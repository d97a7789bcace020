"""Files of testing machines, tables of coupons and decks at random, with command lines that may not fit them.

Every answer has an exit code of 0, 1 or 2 and a sentence, within a bounded time.
"""

from __future__ import annotations

import signal
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest
from odd_inputs import COMMANDS, DECK, LOWER, answered

pytestmark = pytest.mark.filterwarnings("error")

#: Seconds in which a command line must be answered; the longest take a few.
BOUND = 60
#: Options that write elsewhere, that solve, or that end a command at once.
DROPPED = ("help", "out", "method", "fit", "bridging")
#: Of so many cases each; with ``--slow`` as many seeds as `CHUNKS`.
CASES, CHUNKS = 25, 16

HEADS = [
    "opening,load,crack",
    "Extension [mm],Load [N],a (mm)",
    "Disp_(in),Load_(lbf),CrackExt",
    "Weg / mm;Kraft / kN;Riss",
    "Time,Opening,Force",
    "d\tP\ta",
    "a,P,d",
    "mm,N,mm",
    "Extension,Extension,Load",
    "",
    "U2,RF2,a",
    "position (µm),load (MN),a [m]",
]
ODD_CELLS = [
    "",
    "nan",
    "inf",
    "-inf",
    "1e999",
    "-1",
    "0",
    "x",
    "#N/A",
    "2,5",
    "1.234,5",
    "1e31",
    "--",
    '"',
    "End of test",
    "\ufeff",
    "\0",
    "1e-320",
    "=A1",
    "0x10",
    "12:30:05",
]
VALUES = [
    "0",
    "1",
    "2",
    "-1",
    "1e3",
    "25.4",
    "nan",
    "inf",
    "1e999",
    "x",
    "",
    "0.2,0.5",
    "0.5,0.2",
    "8,6",
    "20,1e-3,30,2e-3",
    "opening",
    "load",
    "crack",
    "a",
    "Load [N]",
    "specimen.precrack=30",
    "specimen.width=0",
    "material.E1=1",
    "enf-as4peek",
    "dcb-as4peek",
    "peel-60",
    "mine.csv",
    "coupons.csv",
    "missing",
    ".",
    "/dev/null",
    "out",
]


def table(random: np.random.Generator) -> bytes:
    """A curve with growth in a layout of some machine, of which rows, cells and bytes may be others."""
    n = int(random.choice([0, 2, 10, 80, 80, 80, 80]))
    d = np.linspace(0.0, 10.0, n)
    P = np.where(d < 3.0, 20.0 * d, 60.0 * np.sqrt(3.0 / np.maximum(d, 3.0))) + 0.1 * random.standard_normal(n)
    P, d = P * random.choice([1.0, 1.0, 1.0, -1.0, 1e-3, 0.0]), d * random.choice([1.0, 1.0, 1.0, -1.0])
    a = np.where(np.abs(d) < 3.0, 35.0, 35.0 * np.sqrt(np.maximum(np.abs(d), 3.0) / 3.0))
    cells = [[f"{x:.6g}" for x in row] for row in np.stack([d, P, a], axis=1)]
    head = str(random.choice(HEADS if random.random() < 0.5 else HEADS[:3]))
    rows = [*[["text above", "3"]] * int(random.integers(0, 3)), head.split(","), *cells]
    for _ in range(int(random.choice([0, 0, 1, 2, 4]))):
        row = rows[int(random.integers(0, len(rows)))]
        at = int(random.integers(0, max(1, len(row))))
        match int(random.integers(0, 5)):
            case 0:
                row[at : at + 1] = [str(random.choice(ODD_CELLS))] * int(random.integers(0, 3))
            case 1:
                row[at:] = [str(random.choice(ODD_CELLS)), *row[at + 1 :]]
            case 2:
                rows.insert(int(random.integers(0, len(rows))), [str(random.choice(ODD_CELLS))])
            case 3:
                rows.append([str(random.choice(ODD_CELLS))])
            case _:
                rows[:] = rows[::-1] if random.random() < 0.3 else [*rows, *rows]
    separator = str(random.choice([",", ",", ";", "\t", " ", ", "]))
    text = "\n".join(separator.join(row) for row in rows)
    content = bytearray(
        text.encode(str(random.choice(["utf-8", "utf-8", "utf-8", "utf-16", "cp1252"])), errors="replace")
    )
    for _ in range(int(random.integers(0, 3)) if content and random.random() < 0.2 else 0):
        content[int(random.integers(0, len(content)))] = int(random.integers(0, 256))
    return bytes(content)


def deck(random: np.random.Generator, text: str) -> str:
    """A deck of which some lines are twice, exchanged, cut or gone."""
    lines = text.splitlines()
    for _ in range(int(random.integers(0, 3))):
        at, other = (int(random.integers(0, len(lines))) for _ in range(2))
        lines[at] = [
            lines[other],
            lines[at][: int(random.integers(0, 9))],
            str(random.choice(ODD_CELLS)),
            "*INCLUDE, INPUT=mine.inp",
        ][int(random.integers(0, 4))]
    return "\n".join(lines) + "\n"


def line(random: np.random.Generator) -> list[str]:
    """A command that reads such files."""
    scene = str(random.choice(["dcb-as4peek", "dcb-as4peek", "enf-as4peek", "peel-60", "mmb50-as4peek"]))
    kinds = [
        ["reduce", "mine.csv", "--scene", scene],
        ["reduce", "mine.csv", "--scene", scene, "--set", "specimen.precrack=30"],
        ["reduce", "mine.csv", "--scene", "dcb-as4peek", "--set", "specimen.precrack=30", "--crack", "3"],
        ["reduce", "--coupons", "coupons.csv", "--scene", scene],
        ["compare", "mine.csv", "other.csv"],
        ["compare", "mine.csv", "other.csv", "--curve-tol", "0.1"],
        ["verify", scene, "--with", "mine.csv", "--dry-run"],
        ["validate", scene, "--with", "mine.csv", "--dry-run"],
        ["law", scene, "--with", "mine.csv"],
        ["mesh", "mine.inp"],
        ["export", "dcb-czm1-linear", "--format", "abaqus", "--set", "specimen.mesh='mine.inp'", "--out", "deck"],
    ]
    words = kinds[int(random.integers(0, len(kinds)))]
    known = [one for one in COMMANDS[words[0]] if one.option_strings and one.dest not in DROPPED]
    for _ in range(int(random.choice([0, 0, 1, 2]))):
        option = known[int(random.integers(0, len(known)))]
        words += [option.option_strings[-1], *[str(random.choice(VALUES))] * (option.nargs != 0)]
    return words


@contextmanager
def in_time(words: list[str]) -> Iterator[None]:
    def late(*_: object) -> None:
        raise TimeoutError(f"{BOUND} s: {words}")

    before = signal.signal(signal.SIGALRM, late)
    signal.alarm(BOUND)
    try:
        yield
    finally:
        signal.alarm(0)
        signal.signal(signal.SIGALRM, before)


@pytest.mark.parametrize("chunk", [pytest.param(i, marks=[pytest.mark.slow] * (i > 0)) for i in range(CHUNKS)])
def test_anything_is_answered(chunk, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    for case in range(CASES):
        random = np.random.default_rng([chunk, case])
        for name in ("mine.csv", "other.csv"):
            Path(name).write_bytes(table(random))
        Path("coupons.csv").write_bytes(
            b"file,precrack,width\nmine.csv,30,25\nother.csv,31,25\n" if random.random() < 0.5 else table(random)
        )
        Path("mine.inp").write_text(deck(random, DECK))
        Path("lower.inp").write_text(deck(random, LOWER))
        words = line(random)
        try:
            with in_time(words):
                answered(capsys, *words)
        except BaseException as error:
            raise AssertionError(f"chunk {chunk}, case {case}: {words}: {error!r}") from error
