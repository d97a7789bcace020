"""The helper for other projects' tests: what it takes, what it lets pass, and what it says."""

from __future__ import annotations

import doctest
import os
import re
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from made_up_point_laws import BONDS, law_of

import verify.testing
from verify.curves.read import Reading
from verify.scene.bond.mixed import mixed_bond
from verify.support.refusal import Refusal
from verify.testing import assert_curves_close, assert_law

PROJECT = Path(__file__).parents[2]
EXAMPLE = PROJECT / "examples" / "regression_test"
D = np.linspace(0.0, 3.0, 301)
P = D / (0.1 + D**2)


@dataclass
class Frame:
    """As much of a data frame as matters."""

    data: dict

    @property
    def columns(self) -> np.ndarray:
        return np.array(list(self.data))

    def __getitem__(self, name: str) -> list:
        return self.data[name]


@dataclass
class Run:
    opening: np.ndarray
    load: np.ndarray


def table(**columns: np.ndarray) -> np.ndarray:
    out = np.zeros(len(D), dtype=[(name, float) for name in columns])
    for name, values in columns.items():
        out[name] = values
    return out


@pytest.fixture
def file(tmp_path):
    np.savetxt(tmp_path / "curve.csv", np.stack((D, P), axis=1), delimiter=",", header="opening,load", comments="")
    return tmp_path / "curve.csv"


FORMS = {
    "pair of arrays": (D, P),
    "pair of lists": [D.tolist(), P.tolist()],
    "array (2, n)": np.stack((D, P)),
    "mapping": {"load": P, "opening": D},
    "capitals": {"LOAD": P, "Opening": D},
    "structured array": table(other=0 * D, load=P, opening=D),
    "record array": table(other=0 * D, load=P, opening=D).view(np.recarray),
    "data frame": Frame({"load": P.tolist(), "opening": D.tolist()}),
    "result": Run(D, P),
    "objects": (D.astype(object), P.astype(object)),
}


@pytest.mark.parametrize("form", FORMS)
def test_forms_of_a_curve(form, file):
    for other in ((D, P), file, str(file), file.parent):
        assert_curves_close(FORMS[form], other, curve=1e-12, peak=1e-12, energy=1e-12)
        assert_curves_close(other, FORMS[form], curve=1e-12, peak=1e-12, energy=1e-12)
    with pytest.raises(AssertionError):
        assert_curves_close(FORMS[form], (D, 1.01 * P), curve=0.009)


@pytest.mark.parametrize(
    "reading", [Reading("U2", "RF2", -1e3, 0.5), Reading("u2", 3, -1e3, 0.5), Reading(2, 3, -1e3, 0.5)]
)
def test_columns_and_units(reading, tmp_path):
    columns = {"X": 0 * D, "U2": -D / 1e3, "RF2": 2 * P}
    path = tmp_path / "abaqus.csv"
    np.savetxt(path, np.stack(list(columns.values()), axis=1), delimiter=", ", header="X, U2, RF2", comments="")
    for foreign in (columns, table(**columns), Frame(columns), path):
        assert_curves_close(foreign, (D, P), actual_as=reading, curve=1e-12)
        assert_curves_close((D, P), foreign, expected_as=reading, curve=1e-12)
        with pytest.raises(ValueError, match="opening"):
            assert_curves_close(foreign, (D, P), curve=1.0)


def test_integers_do_not_overflow():
    d = np.array([0, 100, 200], dtype=np.int16)
    load = np.array([0, 30000, 15000], dtype=np.int16)
    assert_curves_close((d, load), (d.astype(float), 1e6 * load), actual_as=Reading(load_scale=1e6), curve=1e-12)


@pytest.mark.parametrize(
    ("name", "words"), [("curve", "curve error"), ("peak", "peak load differs by"), ("energy", "energy differs by")]
)
def test_every_tolerance_has_two_sides(name, words):
    for factor in (1.005, 0.995):
        assert_curves_close((D, factor * P), (D, P), **{name: 0.0051})
        with pytest.raises(AssertionError, match=f"{words} 0.5 %, more than 0.49 %"):
            assert_curves_close((D, factor * P), (D, P), **{name: 0.0049})


def test_the_message_says_where_and_by_how_much():
    bump = P - 0.3 * np.exp(-(((D - 1.2) / 0.05) ** 2))
    with pytest.raises(AssertionError) as failure:
        assert_curves_close((1.02 * D, bump), (D, P), curve=0.01, peak=0.01, energy=0.5)
    said = str(failure.value)
    assert said.startswith("actual is not close to expected: curve error ") and " %, more than 1 %; " in said
    assert "distance of the farthest point of actual, at opening 1.224, from expected: " in said
    at, a, b = (float(word) for word in re.search(r"largest deviation, at (\S+) +(\S+) +(\S+)", said).groups())
    assert abs(at - 1.02 * 1.2) < 0.01 and b == pytest.approx(at / (0.1 + at**2), rel=1e-4) and 0.25 < b - a < 0.32
    assert re.search(r"opening at peak .* \+2 %\n", said) and re.search(r"curve error .* FAILS\n", said)


def test_a_run_that_stops_early_is_no_success():
    half = D <= 1.5
    with pytest.raises(
        AssertionError, match="actual ends at the opening 1.5, before 3; an end of 1.5 judges the common"
    ):
        assert_curves_close((D[half], P[half]), (D, P), curve=0.01)
    assert_curves_close((D[half], P[half]), (D, P), curve=0.01, end=1.5)
    assert_curves_close((D, P), (D[half], P[half]), curve=0.01)


def test_a_code_that_finds_no_load_is_wrong_and_not_invalid():
    with pytest.raises(AssertionError, match="curve error 100 %"):
        assert_curves_close((D, 0 * P), (D, P), curve=0.5)
    with pytest.raises(AssertionError, match="a load scale of -1 turns its sign"):
        assert_curves_close((D, -P), (D, P), curve=0.5)


def test_a_programme_that_unloads():
    """Its legs count; a path that snaps back shows no programme, which can be given."""
    d = np.concatenate((np.linspace(0, 1.5, 100), np.linspace(1.5, 0.2, 50)[1:], np.linspace(0.2, 3, 200)[1:]))
    grown = np.maximum.accumulate(d)
    load = d / (0.1 + grown**2)
    assert_curves_close((d, load), (d, load), curve=1e-12)
    healed = np.where(np.arange(d.size) < 149, load, d / (0.1 + d**2))
    with pytest.raises(AssertionError, match="along leg 3, reloading from 0.2 to 3"):
        assert_curves_close((d, healed), (d, load), curve=0.01)
    with pytest.raises(ValueError, match="programme: expected must turn, and end, at 1, 0.2, 3"):
        assert_curves_close((d, load), (d, load), curve=0.01, programme=(1.0, 0.2, 3.0))


GOOD = (D, P)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({}, "needs a tolerance: curve, peak or energy"),
        ({"peak": -0.1}, "peak: must be >= 0 and finite, got -0.1"),
        ({"curve": "1 %"}, "curve: must be a number, got '1 %'"),
        ({"energy": True}, "energy: must be a number, got True"),
        ({"curve": 1, "end": 4}, "end: must be > 0 and <= 3, the last opening of expected"),
        ({"curve": 1, "end": "3"}, "end: must be a number, got '3'"),
        ({"curve": 1, "programme": "3"}, "programme: must be openings, got '3'"),
        ({"curve": 1, "actual_as": ("U2", "RF2")}, "actual_as: must be a Reading, got tuple"),
        ({"curve": 1, "expected_as": Reading("U2")}, "expected_as: columns are chosen in a file or a table, got tuple"),
    ],
)
def test_what_is_no_tolerance_is_no_mere_failure(options, words):
    with pytest.raises((TypeError, ValueError), match=words):
        assert_curves_close(GOOD, GOOD, **options)


@pytest.mark.parametrize(
    ("curve", "words"),
    [
        (np.stack(GOOD, 1), r"must be .* an array of shape \(301, 2\)"),
        (None, "must be .* got NoneType"),
        ((D, P[:-1]), "opening and load must be of one length, got 301 and"),
        ((D, P[:, None]), "load: must be of one dimension"),
        ((D, P + 1j), "load: must be real numbers, got complex128"),
        ((D, [{}] * 301), "load: must be numbers"),
        ((D, np.where(D == 3, np.nan, P)), "must hold finite numbers, got 3 and nan"),
        (([1], [1]), "must hold at least 2 points of different opening"),
        ({"opening": D}, "must have a column 'load', got opening"),
        ({"opening": D, "Load": P, "LOAD": P}, "must have one column 'load', got opening, Load, LOAD"),
        ("no.csv", "no.csv: must be a file with a curve, got: No such file"),
        ((D + 5, P), "actual and expected: must have openings in common"),
    ],
)
def test_what_is_no_curve_is_no_mere_failure(curve, words):
    with pytest.raises((TypeError, ValueError), match=words):
        assert_curves_close(curve, GOOD, curve=1)


def test_the_example_of_the_docstring():
    found = doctest.testmod(verify.testing, optionflags=doctest.ELLIPSIS)
    assert found.attempted >= 6 and found.failed == 0


def test_the_example_of_the_readme(tmp_path):
    """As it is it passes, and with one wrong digit it fails in the line that calls, not in ours."""
    for folder in ("right", "wrong"):
        (tmp_path / folder).mkdir()
        for file in (EXAMPLE / "test_my_code.py", *EXAMPLE.glob("*.csv")):
            text = file.read_text()
            (tmp_path / folder / file.name).write_text(
                text.replace("e-04\n", "e-03\n", 1) if folder == "wrong" else text
            )
    command = [sys.executable, "-m", "pytest", "-q", "--import-mode=importlib", "-p", "no:cacheprovider"]
    command += ["-c", os.devnull, "--rootdir", str(tmp_path), str(tmp_path)]
    environment = {**os.environ, "PYTHONPATH": str(PROJECT), "PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1"}
    run = subprocess.run(command, capture_output=True, text=True, env=environment, timeout=120)
    assert run.returncode == 1 and "1 failed, 1 passed" in run.stdout, run.stdout
    assert "wrong/test_my_code.py" in run.stdout and "actual is not close to expected: curve error" in run.stdout
    assert "verify/testing.py" not in run.stdout


ALONE = """
import sys

class Numpy:
    def find_spec(self, name, path=None, target=None):
        package = name.partition(".")[0]
        if package not in sys.stdlib_module_names and package not in ("numpy", "verify"):
            raise ModuleNotFoundError(package)

sys.meta_path.insert(0, Numpy())
from verify.testing import Reading, assert_curves_close
assert_curves_close(sys.argv[1], sys.argv[2], actual_as=Reading("U2", "RF2", -2, -1e3), curve=0.002)
try:
    assert_curves_close(sys.argv[1], sys.argv[2], actual_as=Reading("U2", "RF2", -2, -1e3), curve=0.0002)
except AssertionError:
    print("told apart")
"""


def test_it_needs_numpy_alone():
    command = [sys.executable, "-c", ALONE, str(EXAMPLE / "abaqus.csv"), str(EXAMPLE / "expected.csv")]
    run = subprocess.run(command, capture_output=True, text=True, env={**os.environ, "PYTHONPATH": str(PROJECT)})
    assert run.stdout == "told apart\n", run.stderr


def test_a_right_law_passes_and_a_wrong_one_is_named():
    bond = BONDS["moose"]
    assert_law(law_of(bond), bond)
    with pytest.raises(AssertionError) as failed:
        assert_law(law_of(bond, "sqrt2-compressed-shear"), bond)
    first, *rest = str(failed.value).splitlines()
    assert first.startswith("the law is not that of the bond: sqrt2-compressed-shear: where g <= 0")
    assert any(line.startswith("broken") and "compressed-toughness" in line for line in rest)


def test_a_law_is_held_against_a_scene_too():
    scene = verify.load_scene("dcb-as4peek")
    for one in (scene, "dcb-as4peek"):
        with pytest.raises(AssertionError, match="half-area"):
            assert_law(law_of(mixed_bond(scene), "half-area"), one)


def test_tolerances_and_checks_are_chosen(monkeypatch):
    monkeypatch.setattr("verify.studies.law.judge.defects", lambda *_: ())  # which takes a second
    bond = BONDS["moose"]

    def near(g: float, s: float, state: tuple | None, dt: float) -> tuple:
        p, t, state = law_of(bond)(g, s, state, dt)
        return 1.001 * p, t, state

    assert_law(near, bond, tractions=0.01)
    names = ("reference", "toughness", "strength", "contact")
    assert_law(near, bond, ignore=names)
    with pytest.raises(AssertionError, match="contact"):
        assert_law(near, bond, ignore=names[:3])


@pytest.mark.parametrize(
    ("words", "error", "said"),
    [
        ((3, BONDS["moose"]), TypeError, "law: must be a function"),
        ((law_of(BONDS["moose"]), 3), TypeError, "of: must be a scene"),
        ((law_of(BONDS["moose"]), "no-such-scene"), Refusal, "is neither a packaged scene nor a file"),
        ((lambda *a: None, BONDS["moose"]), Refusal, "must return p, t, state"),
    ],
)
def test_what_is_no_test_of_a_law_does_not_fail_as_one(words, error, said):
    with pytest.raises(error, match=said):
        assert_law(*words)
    with pytest.raises(ValueError, match="tractions: must be >= 0"):
        assert_law(law_of(BONDS["moose"]), BONDS["moose"], tractions=-1.0)
