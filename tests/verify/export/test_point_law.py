"""What `debond law --write` writes for other codes."""

import ast
import csv
import re
from dataclasses import replace

import numpy as np
import pytest
from made_up_point_laws import BONDS

from verify.export.point_law import write_paths
from verify.studies.law.paths import paths

BOND = BONDS["as4-peek"]


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    out = tmp_path_factory.mktemp("paths")
    write_paths(BOND, paths(BOND), "my-scene", out)
    return out


def test_the_table_holds_every_number_in_full(folder):
    rows = list(csv.DictReader((folder / "paths.csv").open()))
    for way in paths(BOND):
        mine = [row for row in rows if row["path"] == way.name]
        assert [int(row["step"]) for row in mine] == list(range(way.g.size))
        assert np.array_equal([float(row["g"]) for row in mine], way.g)
        assert np.array_equal([float(row["s"]) for row in mine], way.s)
        columns = np.loadtxt(folder / "columns" / f"{way.name}.csv", delimiter=",", skiprows=1)
        assert np.array_equal(columns, np.stack([np.arange(way.g.size), way.g, way.s], axis=1))


def test_the_deck_moves_one_element_along_each_path(folder):
    deck = (folder / "paths.inp").read_text()
    ways = paths(BOND)
    assert deck.count("TYPE=COH2D4") == len(ways) and max(map(len, deck.splitlines())) < 256
    assert f"*STATIC, DIRECT\n1., {max(way.g.size for way in ways) - 1}.\n" in deck
    for i, way in enumerate(ways, 1):
        for key, value in (("g", way.g), ("s", way.s)):
            block = re.search(rf"NAME={key}{i}, TIME=TOTAL TIME\n((?:[^*].*\n)+)", deck)
            assert block is not None
            numbers = np.array([float(one) for one in block[1].replace("\n", ",").split(",") if one.strip()]).reshape(
                -1, 2
            )
            assert np.array_equal(numbers[:, 0], np.arange(way.g.size))
            assert numbers[:, 1] == pytest.approx(value, rel=1e-14, abs=1e-300)
            assert f"*BOUNDARY, AMPLITUDE={key}{i}\nupper{i}, {1 if key == 's' else 2}, " in deck
    assert "MIXED MODE BEHAVIOR=BK, POWER=2.284" in deck and "0.969, 1.719, 1.719" in deck


def test_the_deck_says_what_abaqus_has_not(folder):
    deck = (folder / "paths.inp").read_text()
    assert "--set interface.onset=quadratic" in deck and "--set interface.penalty=100000" in deck
    assert "friction" not in deck and "viscosity" not in deck


def test_of_another_bond_more_is_said(tmp_path):
    other = replace(BOND, law="trapezoidal", friction=0.1, viscosity=0.1, criterion="power", penalty=BOND.stiffness[0])
    write_paths(other, paths(other), "other", tmp_path)
    deck = (tmp_path / "paths.inp").read_text()
    assert all(word in deck for word in ("friction", "viscosity", "trapezoidal", "MIXED MODE BEHAVIOR=POWER LAW"))
    assert "onset=quadratic" not in deck and "penalty" not in deck


def test_the_script_for_abaqus_reads_in_any_python(folder):
    source = (folder / "abaqus_to_csv.py").read_text()
    ast.parse(source)
    assert f"PATHS = {[way.name for way in paths(BOND)]!r}" in source and 'f"' not in source and "f'" not in source


def test_the_notes_say_how_to_come_back(folder):
    notes = (folder / "README.txt").read_text()
    assert "debond law my-scene --with tractions.csv" in notes and "path,step,g,s,p,t" in notes
    assert "toughness: 0.969 in opening, 1.719 in sliding" in notes
    assert "data_file = columns/mode-I.csv" in (folder / "moose.i").read_text()
    assert "xy_in_file_only = false" in (folder / "moose.i").read_text()  # or MOOSE refuses a file of three columns
