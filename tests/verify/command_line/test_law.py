"""`debond law`: files, exit codes, the last line, and the sentence for each malformed input."""

from __future__ import annotations

import json
from collections.abc import Callable

import pytest
from made_up_point_laws import law_of

from verify.cli import main
from verify.scene.load import load_scene
from verify.studies.law import laws
from verify.studies.law.laws import of_function
from verify.studies.law.study import subject
from verify.support.refusal import Refusal

SCENE = "dcb-as4peek"
HEADER = "path,step,g,s,p,t"
SPECIMEN = """
load = { opening = 1.0 }
specimen = { kind = "dcb", length = 14.0, arm_thickness = 0.2, precrack = 4.0, width = 1.0, plane = "strain" }
material = { young = 120e3, poisson = 0.2 }
"""


@pytest.fixture(scope="module")
def right(tmp_path_factory):
    """Lines of a file with the tractions of a right law."""
    of = subject(load_scene(SCENE))
    lines = [HEADER]
    for way in of.ways:
        found = of_function(law_of(of.bond), way)
        columns = zip(way.g.tolist(), way.s.tolist(), found.p.tolist(), found.t.tolist(), strict=True)
        lines += [f"{way.name},{i},{g!r},{s!r},{p!r},{t!r}" for i, (g, s, p, t) in enumerate(columns)]
    return lines


def law(*words: str) -> int:
    try:
        return main(["law", SCENE, *words])
    except SystemExit as end:  # argparse
        return int(end.code or 0)


def test_the_law_of_the_solvers_holds(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(laws, "PROBED", 2)
    assert law("--out", str(tmp_path)) == 0
    said = capsys.readouterr().out.splitlines()
    assert said[-1].startswith(f"the law of the solvers on {SCENE}: ") and said[-1].endswith(" hold, 0 broken")
    found = json.loads((tmp_path / "law.json").read_text())
    assert found["passed"] is True and found["defects"] == [] and found["scene"] == SCENE
    assert {"exact", "analytical", "cross-code"} == {check["kind"] for check in found["checks"]}
    assert found["counts"]["total"] == len(found["checks"])
    assert (tmp_path / "law.html").stat().st_size > 50_000


def test_paths_are_written_and_nothing_is_judged(tmp_path, capsys):
    assert law("--write", str(tmp_path / "paths")) == 0
    said = capsys.readouterr().out
    assert "checks" not in said and all(line.startswith("written: ") for line in said.splitlines())
    assert (tmp_path / "paths" / "paths.csv").read_text().startswith("path,step,g,s\nmode-I,0,0.0,0.0\n")


def test_a_right_file_holds_and_a_wrong_one_is_named(right, tmp_path, capsys):
    file = tmp_path / "mine.csv"
    file.write_text("\n".join(right))
    assert law("--with", str(file)) == 0
    assert capsys.readouterr().out.splitlines()[-1].startswith(f"mine.csv on {SCENE}: ")
    (tmp_path / "mine.py").write_text(
        "from made_up_point_laws import law_of\n"
        "from verify.scene.load import load_scene\nfrom verify.scene.bond.mixed import mixed_bond\n"
        f'law = law_of(mixed_bond(load_scene("{SCENE}")), "sqrt2-compressed-shear")\n'
    )
    assert law("--with", f"{tmp_path}/mine.py:law", "--out", str(tmp_path / "out")) == 1
    assert "defect: sqrt2-compressed-shear: where g <= 0" in capsys.readouterr().out
    found = json.loads((tmp_path / "out" / "law.json").read_text())
    assert found["passed"] is False and found["defects"][0]["name"] == "sqrt2-compressed-shear"
    assert "sqrt2-compressed-shear" in (tmp_path / "out" / "law.html").read_text()


def test_columns_units_order_and_separators_are_the_users(right, tmp_path):
    """Blanks, capitals, another order of rows and columns, kilo and minus signs, a comment, a row of units."""
    lines = ["# exported", "t12 STEP path x S s22", "kPa - - um mm MPa"]
    for row in reversed(right[1:]):
        path, step, g, s, p, t = row.split(",")
        lines.append(f"{-1e3 * float(t)!r} {step} {path} {1e3 * float(g)!r} {s} {p}")
    file = tmp_path / "mine.txt"
    file.write_text("\n".join(lines))
    columns = ("--columns", "g=x,p=S22,t=T12", "--scales", "g=1e-3,t=-1e-3")
    assert law("--with", str(file), *columns) == 0
    assert law("--with", str(file), *columns[:3], "g=1e-3,t=1e-3") == 1
    assert law("--with", str(file), *columns, "--tolerance", "1e-18") == 1


Change = Callable[[list[str]], str | bytes]


def edited(row: int, column: int, text: str) -> Change:
    """The file with another cell; row 0 is the header."""

    def change(lines: list[str]) -> str:
        cells = lines[row].split(",")
        cells[column] = text
        return "\n".join([*lines[:row], ",".join(cells), *lines[row + 1 :]])

    return change


def without(text: str) -> Change:
    return lambda lines: "\n".join(line for line in lines if not line.startswith(text))


def tangents(names: str, rest: str) -> Change:
    return lambda lines: "\n".join([f"{HEADER},{names}", *(f"{line},{rest}" for line in lines[1:])])


def times(g: float, s: float) -> Change:
    def change(lines: list[str]) -> str:
        rows = [line.split(",") for line in lines[1:]]
        scaled = [[*row[:2], repr(g * float(row[2])), repr(s * float(row[3])), *row[4:]] for row in rows]
        return "\n".join([lines[0], *map(",".join, scaled)])

    return change


def exchanged(lines: list[str]) -> str:
    return "\n".join([lines[0].replace(",g,s,", ",s,g,"), *lines[1:]])


#: What is wrong with a file -> how it gets so, and what the sentence says.
MALFORMED: dict[str, tuple[Change, str]] = {
    "empty": (lambda lines: "\n \n", "the header must name path and step and g and s and p and t once, got no names"),
    "header alone": (lambda lines: HEADER, "every step that was written, got none of path alternating, step 0"),
    "no header": (lambda lines: "\n".join(lines[1:]), "the header must name path and step and g and s and p and t"),
    "words": (lambda lines: "what a nice day", "the header must name"),
    "binary": (lambda lines: b"\0\1\2\3" * 99, "not a text"),
    "no column p": (edited(0, 4, "q"), "the header must name p once, got path, step, g, s, q, t; see --columns"),
    "no column path": (edited(0, 0, "name"), "the header must name path once"),
    "two of p": (lambda lines: "\n".join([f"{HEADER},p", *(f"{x},0" for x in lines[1:])]), "must name p once"),
    "part of a tangent": (tangents("dp_dg,dp_ds", "1,0"), "the header must name dt_dg and dt_ds once"),
    "tangent of words": (tangents("dp_dg,dp_ds,dt_dg,dt_ds", "1,0,x,1"), "dt_dg must be a finite number, got 'x'"),
    "path missing": (without("mixed-50,"), "got none of path mixed-50, step 0 and 42 more"),
    "unknown path": (edited(1, 0, "mode-IV"), ":2: path 'mode-IV', step '0' is none that was written"),
    "step missing": (without("mode-I,7,"), "must hold every step that was written, got none of path mode-I, step 7"),
    "step twice": (edited(3, 1, "1"), ":4: path 'mode-I', step '1' is there already, in line 3"),
    "step too many": (edited(2, 1, "43"), "path 'mode-I', step '43' is none that was written"),
    "step and a half": (edited(2, 1, "1.5"), "is none that was written"),
    "step of words": (edited(2, 1, "one"), "is none that was written"),
    "nan": (edited(5, 4, "nan"), ":6: p must be a finite number, got 'nan'"),
    "hole": (edited(5, 4, ""), "p must be a finite number, got ''"),
    "row too short": (edited(5, 5, ""), "t must be a finite number, got ''"),
    "row too long": (edited(5, 5, "1,2"), ":6: must have 6 columns as the header, got 7"),
    "other opening": (edited(5, 2, "0.5"), "got 0.5; are these the paths of this scene?"),
    "metres": (times(1e-3, 1e-3), "; --scales g=1000"),
    "sign of a slip": (times(1.0, -1.0), "; --scales s=-1"),
    "exchanged": (exchanged, "g and s are exchanged: --columns g=s,s=g"),
    "other slip": (edited(5, 3, "1e-3"), "path mode-I, step 4: s must be 0 as written, got 0.001"),
    "overflow": (edited(5, 4, "1e999"), "p must be a finite number, got '1e999'"),
}  # fmt: skip


@pytest.mark.parametrize("name", MALFORMED)
def test_malformed_files_are_refused_with_one_sentence(name, right, tmp_path, capsys):
    change, sentence = MALFORMED[name]
    content = change(right)
    file = tmp_path / "mine.csv"
    file.write_bytes(content if isinstance(content, bytes) else content.encode())
    assert law("--with", str(file), "--out", str(tmp_path / "out")) == 2
    said = capsys.readouterr()
    assert sentence in said.err and str(file) in said.err
    assert said.out == "" and said.err.count("\n") == 1 and not (tmp_path / "out").exists()


OWN = {
    "exponential": "",
    "tabular": "table = [[0.001, 4.0], [0.02, 1.0], [0.08, 0.0]]",
    "trapezoidal": "plateau = 0.3\nductility = 12.5",
}


@pytest.mark.parametrize("name", OWN)
def test_every_law_that_only_opens_is_judged(name, tmp_path, capsys):
    numbers = "" if name == "tabular" else "strength = 4.0\ntoughness = 0.0795"
    bond = f'[interface]\nlaw = "{name}"\n{numbers}\n{OWN[name]}\n'
    (tmp_path / "mine.toml").write_text(SPECIMEN + bond)
    assert main(["law", str(tmp_path / "mine.toml")]) == 0
    assert "20 checks on 5 paths, 20 hold" in capsys.readouterr().out


def test_a_law_without_a_definition_is_refused():
    scene = load_scene("dcb-czm1")
    other = scene.interface.model_copy(update={"law": "my-own"})
    with pytest.raises(Refusal, match="interface.law: must be .* for debond law, got 'my-own'"):
        subject(scene.model_copy(update={"interface": other}))
