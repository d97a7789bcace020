"""Scenes, curves and command lines of all kinds for hypothesis, and what is asked of an answer to them."""

from __future__ import annotations

import argparse
import json
from collections.abc import Callable

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from verify.cli import main, parser

DCB = {
    "name": "own",
    "units": "N, mm, MPa",
    "specimen": {"kind": "dcb", "length": 14.0, "arm_thickness": 0.2, "precrack": 4.0, "width": 1.0},
    "material": {"young": 120e3, "poisson": 0.2},
    "interface": {"strength": 4.0, "toughness": 0.1, "ductility": 12.5, "penalty": 1e5},
    "load": {"opening": [3.0]},
    "effects": {"kinematics": "finite", "contact": True, "irreversible": True, "symmetry": False},
    "pose": {"angle": 0.0, "mirror": False, "shift": [0.0, 0.0]},
    "discretization": {"degree": 3, "dofs": 280, "interface_rule": "gauss", "interface_points": 2, "steps": 5},
    "dolfinx": {"degree": 2, "elements": 112},
    "published": [{"quantity": "load_at", "opening": 1.0, "value": [4.3, 4.5], "tolerance": 0.05, "source": "there"}],
    "uncertainty": {"material": {"young": 0.02}, "interface": {"toughness": 0.05}, "data": {"load": 0.01}},
}
PEEL = {
    **{key: DCB[key] for key in ("name", "units", "interface", "load", "discretization", "dolfinx")},
    "specimen": {
        "kind": "peel", "strip_length": 150.0, "strip_thickness": 2.0, "substrate_length": 120.0,
        "substrate_thickness": 10.0, "bond_length": 60.0, "width": 1.0, "plane": "strain",
    },
    "strip": {"E1": 135e3, "E2": 9e3, "G12": 5e3, "nu12": 0.3},
    "substrate": {"young": 70e3, "poisson": 0.3},
}  # fmt: skip
SLIDING = {
    **DCB,
    "interface": {
        "law": "trapezoidal", "plateau": 0.3, "strength": 4.0, "toughness": 0.1, "stiffness": 1e3, "penalty": 1e5,
        "shear_strength": 5.0, "shear_toughness": 0.2, "criterion": "bk", "exponent": 2.284, "onset": "turon",
        "shear_stiffness": 1e3, "friction": 0.3, "viscosity": 0.01, "pressure_strength": 0.5,
    },
}  # fmt: skip
METHODS = ("tspline", "nurbs", "lagrange", "dolfinx", "beam", "lefm")


#: What is given to hypothesis with how many cases: some in every run of the tests, many in the slow ones.
QUIET = [HealthCheck.function_scoped_fixture, HealthCheck.too_slow, HealthCheck.data_too_large]
SOME = settings(max_examples=16, suppress_health_check=QUIET)


def few_and_many(check: Callable, few: int = 16, many: int = 10_000, **of: st.SearchStrategy) -> tuple[Callable, ...]:
    """Two tests of one property: some cases in every run, many in the slow ones."""
    fast, slow = (settings(max_examples=n, suppress_health_check=QUIET)(given(**of)(check)) for n in (few, many))
    return fast, pytest.mark.slow(slow)


ODD_NUMBERS = [
    0, 1, -1, 0.5, 1e-30, 1e30, 1e31, 1e-31, 1e308, -1e308, 5e-324, 1.0000000000000002, 0.49999999999999994,
    float("inf"), float("-inf"), float("nan"), 10**9, 10**40, 10**310, -(10**400), 3.999999999999999, 14, 2, 1e15,
]  # fmt: skip
TEXTS = st.text(st.characters(exclude_categories=("Cs",)), max_size=12) | st.sampled_from(
    ["auto", "linear", "../up", "/etc/passwd", "a/b", "", "dcb", "peel", "stress", "nan", "{}", "__import__('os')"]
)
SCALARS = st.one_of(st.sampled_from(ODD_NUMBERS), st.floats(), st.integers(), st.booleans(), TEXTS)
VALUES = st.recursive(
    SCALARS, lambda inner: st.lists(inner, max_size=4) | st.dictionaries(TEXTS, inner, max_size=3), max_leaves=6
)


def paths_of(table: dict, before: tuple = ()) -> list[tuple]:
    return [
        path
        for key, value in table.items()
        for path in [(*before, key), *(paths_of(value, (*before, key)) if isinstance(value, dict) else [])]
    ]


KEYS = sorted({".".join(path) for path in [path for scene in (DCB, PEEL, SLIDING) for path in paths_of(scene)]})


def as_toml(value: object) -> str:
    """A TOML value, tables inline."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str):
        short = {"\\": "\\\\", '"': '\\"'}
        return '"' + "".join(short.get(c, c if c.isprintable() else f"\\U{ord(c):08x}") for c in value) + '"'
    if isinstance(value, dict):
        return "{" + ", ".join(f"{as_toml(key)} = {as_toml(inner)}" for key, inner in value.items()) + "}"
    return "[" + ", ".join(map(as_toml, value)) + "]" if isinstance(value, list) else repr(value)


@st.composite
def scene_texts(draw: st.DrawFn) -> str:
    """A scene of which some keys are something else, more, or gone."""
    table = json.loads(json.dumps(draw(st.sampled_from([DCB, PEEL, SLIDING]))))
    for _ in range(draw(st.integers(0, 3))):
        *way, last = draw(st.sampled_from(paths_of(table) or [("x",)]))
        inner = table
        for key in way:
            inner = inner[key]
        match draw(st.integers(0, 4)):
            case 0:
                del inner[last]
            case 1:
                inner[draw(TEXTS)] = draw(VALUES)
            case _:
                inner[last] = draw(VALUES)
    return "\n".join(f"{as_toml(key)} = {as_toml(value)}" for key, value in table.items())


ANY_TEXT = st.binary(max_size=200) | st.text(max_size=200).map(lambda text: text.encode("utf-8", "surrogatepass"))
SCENES = st.one_of(*3 * [scene_texts().map(str.encode)], ANY_TEXT)
OVERRIDES = st.lists(
    st.tuples(st.sampled_from(KEYS) | TEXTS, VALUES.map(as_toml) | TEXTS).map("=".join) | TEXTS, max_size=3
)

#: Words of command lines. What they name is there, or not.
WORDS = st.one_of(
    st.sampled_from(
        "verify solve cost effects validate certify scaling hard export compare mesh scenes doctor nosuch".split()
    ),
    st.sampled_from("dcb-czm1 peel-60 own.toml broken.toml curve.csv other.csv body.iga /dev/null . missing".split()),
    st.sampled_from(
        "--out --method --dofs --set --jobs --full --dry-run --fields --frames --accuracy --end --begin --at "
        "--tolerance --curve-tol --load-scale-a --opening-a --with --opening --format --json --elements --layers "
        "--include --help --scheduler -- -x".split()
    ),
    st.sampled_from("nurbs dolfinx beam lefm 0 1 -1 1e-3 80 1e999 nan 0.3% 1,2 abaqus csv md here here/x".split()),
    st.text(st.characters(exclude_characters="\0", exclude_categories=("Cs",)), max_size=8),
)
FIRST = st.sampled_from("verify solve cost effects validate certify scaling hard export compare mesh".split())


@st.composite
def likely_lines(draw: st.DrawFn) -> list[str]:
    """A command with options that it has; what they are given is what they may have, more often than not."""
    name = draw(st.sampled_from(sorted(COMMANDS)))
    words = []
    for action in draw(st.lists(st.sampled_from(COMMANDS[name]), max_size=4)):
        if action.dest not in ("help", "rest"):
            words += action.option_strings[-1:]
            words += [] if action.nargs == 0 else [draw(VALUES_OF.get(action.dest, WORDS) | WORDS)]
    return [name, *words]


#: What there is for arguments by where they go.
VALUES_OF = {
    **dict.fromkeys(("scene", "scenes"), st.sampled_from(["dcb-czm1", "peel-60", "own.toml", "body.iga"])),
    **dict.fromkeys(("a", "b", "curves"), st.sampled_from(["curve.csv", "own=curve.csv", "two.csv", "run"])),
    **dict.fromkeys(("jobs", "dofs", "elements", "layers", "frames"), st.integers(0, 3000).map(str)),
    **dict.fromkeys(("opening", "load"), st.sampled_from(["1", "2", "3", "U2", "load", "opening", "force"])),
    "file": st.sampled_from(["body.iga", "plate.iga"]),
    "include": st.sampled_from(["here", ".", "cost"]),
    "kind": st.sampled_from(["dcb", "peel"]),
    "shell": st.sampled_from(["bash", "zsh", "fish"]),
    "names": st.sampled_from(["coarse-czm2", "all"]),
    "method": st.sampled_from(METHODS),
    "accuracy": st.sampled_from(["0.3%", "0.01", "1e-9"]),
    "overrides": st.tuples(st.sampled_from(KEYS), VALUES.map(as_toml)).map("=".join),
    "out": st.sampled_from(["here", "deep/er", "curve.csv", "x.svg", "x.vtu", "x.iga"]),
}
COMMANDS = {
    name: sub._actions
    for action in parser()._actions
    if isinstance(action, argparse._SubParsersAction)
    for name, sub in action.choices.items()
    if name not in ("test", "doctor")
}
LINES = st.one_of(
    st.lists(WORDS, max_size=6),
    st.tuples(FIRST, st.lists(WORDS, max_size=6)).map(lambda x: [x[0], *x[1]]),
    likely_lines(),
)

CELLS = st.one_of(
    st.sampled_from([*map(repr, ODD_NUMBERS[:16]), "", "2,5", "x", '"', "opening", "load", "#", "1e", "--", "\ufeff"]),
    st.floats().map(repr),
    st.text(max_size=5),
)
TABLES = st.tuples(
    st.lists(st.lists(CELLS, max_size=4), max_size=8), st.sampled_from([",", ";", "\t", " ", ", "]), st.booleans()
).map(lambda x: "opening,load\n0,0\n" * x[2] + "\n".join(x[1].join(row) for row in x[0]))
LOADS = st.floats() | st.floats(-10, 10)
POINTS = st.lists(st.tuples(st.floats(-1, 10), LOADS), max_size=8).map(
    lambda points: "opening,load\n0,0\n" + "".join(f"{d!r},{P!r}\n" for d, P in points)
)
#: Curves that can be drawn, with loads up to the largest that count.
DRAWN = st.lists(
    st.tuples(st.floats(-1, 10), LOADS.filter(lambda load: abs(load) <= 1e30)), min_size=1, max_size=8
).map(lambda points: ("opening,load\n0,0\n" + "".join(f"{d!r},{P!r}\n" for d, P in points)).encode())
CURVES = (TABLES | POINTS).map(lambda text: text.encode("utf-8", "surrogatepass")) | ANY_TEXT


#: Both arms of `DCB`, of six elements each, written in every way that is read.
DECK = """*HEADING
 two arms
*PARAMETER
L = 14.0
a = L - 10
last = 3*2 + 1
*NODE, NSET=low
1, 0.0, 0.0
3, <a>, 0.0
<last>, <L>, 0.0
*NGEN, NSET=low
1, 3
3, <last>, 1
*NODE, NSET=high
21, 0.0, 0.2
23, 4.0, 0.2
27, 14.0, 0.2
*NGEN, NSET=high
21, 23, 1
23, 27
*NFILL
low, high, 1, 20
*INCLUDE, INPUT=lower.inp
*ELEMENT, TYPE=CPS4, ELSET=upper
1, 1, 2, 22, 21
*ELGEN, ELSET=upper
1, 6, 1, 1
*NSET, NSET=bond, GENERATE
3, 7, 1
*NSET, NSET=both
bond, 103
*ELEMENT, TYPE=COH2D4
91, 103, 107, 7, 3
"""
LOWER = """*NODE
101, 0.0, 0.0
103, 4.0, 0.0
107, 14.0, 0.0
121, 0.0, -0.2
123, 4.0, -0.2
127, 14.0, -0.2
*NGEN
101, 103
103, 107
121, 123
123, 127
*ELEMENT, TYPE=CPE4, ELSET=lower
11, 121, 122, 102, 101
*ELGEN, ELSET=lower
11, 6
"""


@st.composite
def deck_texts(draw: st.DrawFn) -> tuple[str, str]:
    """A deck and the file that it includes, of which some lines or cells are others, twice, exchanged or gone."""
    texts = [DECK.splitlines(), LOWER.splitlines()]
    words = st.sampled_from([word for text in texts for line in text for word in line.split(", ")])
    for _ in range(draw(st.integers(0, 3))):
        lines = draw(st.sampled_from(texts))
        at = draw(st.integers(0, max(0, len(lines) - 1)))
        new = draw(words | CELLS | TEXTS)
        match draw(st.integers(0, 5)) if lines else -1:
            case 0:
                del lines[at]
            case 1:
                lines.insert(at, lines[draw(st.integers(0, len(lines) - 1))])
            case 2:
                lines.insert(at, new)
            case 3 | 4:
                cells = lines[at].split(",")
                cells[draw(st.integers(0, len(cells) - 1))] = new
                lines[at] = ",".join(cells)
            case 5:
                del lines[at:]
    return "\n".join(texts[0]) + "\n", "\n".join(texts[1]) + "\n"


def answered(capsys: pytest.CaptureFixture, *words: str) -> tuple[int, str]:
    """Exit code and complaint of a command line; an exception of any other kind is a traceback, and a failure."""
    try:
        code = main(list(words))
    except SystemExit as end:  # argparse
        code = int(end.code or 0)
    said = capsys.readouterr()
    assert code in (0, 1, 2), words
    assert code != 2 or said.err.startswith(("debond: ", "usage: ")), words
    assert "Traceback" not in said.err
    return code, said.err
