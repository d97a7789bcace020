"""Curves of other codes, right and wrong ones, written down in many ways: three scenes by recorded runs.

The runs are those of `debond verify` on the scenes below, NURBS and both meshes of DOLFINx; the curves are made of the
finer one of DOLFINx.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from verify.checks.foreign.given import given, remark
from verify.checks.foreign.judged import checks_of
from verify.curves.curve import load_at
from verify.curves.read import read_curve
from verify.curves.scatter import scatter_of
from verify.result import Result
from verify.scene.load import load_scene
from verify.scene.parse import parse_scene
from verify.scene.schema import Scene
from verify.verdict import Check

RECORDED = Path(__file__).parents[1] / "recorded"
COLUMNS = ("opening", "load", "dissipated_energy", "external_work")
SCENES = {
    "dcb": {
        "name": "dcb",
        "specimen": {"kind": "dcb", "length": 30.0, "arm_thickness": 0.8, "precrack": 9.0, "width": 5.0},
        "material": {"young": 70e3, "poisson": 0.3},
        "interface": {"strength": 8.0, "toughness": 0.2},
        "load": {"opening": 2.5},
        "effects": {"kinematics": "linear"},
    },
    "enf": {
        "name": "enf",
        "specimen": {"kind": "enf", "length": 100.0, "arm_thickness": 2.0, "precrack": 35.0, "width": 20.0},
        "material": {"E1": 120e3, "E2": 9e3, "G12": 5e3, "nu12": 0.3},
        "interface": {"strength": 40.0, "toughness": 0.3, "shear_strength": 50.0, "shear_toughness": 1.0},
        "load": {"opening": 7.0},
    },
}

Points = tuple[np.ndarray, np.ndarray]
Change = Callable[[np.ndarray, np.ndarray], Points]


@cache
def scene(name: str) -> Scene:
    return parse_scene(SCENES[name], ()) if name in SCENES else load_scene("peel-100")


@cache
def runs(name: str) -> dict[str, Result]:
    found = {}
    for method in ("nurbs", "dolfinx", "dolfinx-second"):
        table = np.loadtxt(RECORDED / f"{name}-{method}.csv", delimiter=",", skiprows=1)
        found[method] = Result(method, dict(zip(COLUMNS, table.T, strict=True)))
    return found


def right(name: str, rows: int = 250) -> Points:
    run = runs(name)["dolfinx"]
    at = np.linspace(0.0, float(np.max(run.opening)), rows)
    return at, load_at((run.opening, run.load), at)


def judged(name: str, curve: Points) -> tuple[tuple[Check, ...], str]:
    """Its checks and the remark."""
    mine, known = Result("mine", {"opening": curve[0], "load": curve[1]}), runs(name)
    found = checks_of(scene(name), "mine", mine, known)
    return found, "".join(remark(given(scene(name), "mine", mine, known), found))


def broken(name: str, curve: Points) -> set[str]:
    return {check.name for check in judged(name, curve)[0] if check.state == "broken"}


def noise(part: float, seed: int = 0) -> Change:
    return lambda d, P: (d, P + part * np.max(P) * np.random.default_rng(seed).standard_normal(len(P)))


def digits(number: int) -> Change:
    """Loads rounded to a number of digits at the peak."""

    def change(d: np.ndarray, P: np.ndarray) -> Points:
        quantum = 10.0 ** (np.floor(np.log10(np.max(P))) - number + 1)
        return d, quantum * np.round(P / quantum)

    return change


def significant(number: int) -> Change:
    return lambda d, P: (d, np.array([float(f"{load:.{number}g}") for load in P]))


def some_openings(decimals: int) -> Change:
    """At rows by chance, whose openings are printed with a few decimals."""

    def change(d: np.ndarray, P: np.ndarray) -> Points:
        at = np.sort(np.append(np.random.default_rng(5).uniform(0.0, d[-1], 120), d[-1]))
        return np.round(at, decimals), np.interp(at, d, P)

    return change


def between(low: float, high: float) -> Change:
    """Parts of the largest opening."""
    return lambda d, P: (d[kept := (d >= low * d[-1]) & (d <= high * d[-1])], P[kept])


RIGHT: dict[str, tuple[Change, str]] = {
    "as it is": (lambda d, P: (d, P), ""),
    "20 rows": (lambda d, P: (np.linspace(0.0, d[-1], 20), np.interp(np.linspace(0.0, d[-1], 20), d, P)), ""),
    "repeated rows": (lambda d, P: (np.repeat(d, 2), np.repeat(P, 2)), ""),
    **{f"noise of {part:.2%}": (noise(part), "noise of 0.") for part in (0.0005, 0.001, 0.003, 0.005)},
    "three digits": (digits(3), "loads rounded to"),
    "two digits": (digits(2), "loads rounded to"),
    "three significant digits": (significant(3), "loads rounded to"),
    "two significant digits": (significant(2), "loads rounded to"),
    "openings of two decimals": (some_openings(2), "openings rounded to 0.01"),
    "noise, three digits": (lambda d, P: digits(3)(*noise(0.002, 9)(d, P)), "loads rounded to"),
    "late": (between(0.02, 1.0), "judged from"),
    "late and noisy": (lambda d, P: noise(0.002)(*between(0.4, 1.0)(d, P)), "noise of 0."),
    "half": (between(0.0, 0.5), "not covered: end"),
    "a tenth": (between(0.0, 0.1), "% of the programme; not covered: end, peak"),
    "99.6 %": (between(0.0, 0.996), "not covered: end"),
    "the tail": (between(0.7, 1.0), "not covered: "),
    "the middle": (between(0.3, 0.6), "not covered: end, "),
}


def on_scenes(kinds: Iterable[str], parts: Sequence[float]) -> pytest.MarkDecorator:
    """Each kind of curve on one scene with one noise, in turn; --slow takes all."""
    of = [(name, part) for part in parts for name in ("dcb", "enf", "peel")]
    cells = [
        pytest.param(kind, *one, marks=() if one == of[i % len(of)] else pytest.mark.slow)
        for i, kind in enumerate(kinds)
        for one in of
    ]
    return pytest.mark.parametrize(("kind", "name", "part"), cells)


@on_scenes(RIGHT, (0.0,))
def test_no_right_curve_is_broken(kind, name, part):
    change, says = RIGHT[kind]
    found, said = judged(name, noise(part)(*change(*right(name))))
    assert [check for check in found if check.state == "broken"] == []
    assert says in said and (said == "") == (says == "")
    assert any(check.state == "holds" for check in found) or "digits" in kind


def spike(at: float, part: float) -> Change:
    return lambda d, P: (d, np.where(np.arange(len(P)) == int(at * len(P)), (1.0 + part) * P, P))


WRONG: dict[str, tuple[Change, str]] = {
    "spike": (spike(0.6, 0.03), "farthest-point"),
    "dip": (spike(0.75, -0.03), "farthest-point"),
    "load x 1.01": (lambda d, P: (d, 1.01 * P), "curve"),
    "load x 0.97": (lambda d, P: (d, 0.97 * P), "peak"),
    "opening x 1.01": (lambda d, P: (1.01 * d, P), "curve"),
    "opening shifted": (lambda d, P: (d + 0.01 * d[-1], P), "curve"),
    "2 % too stiff": (lambda d, P: (d, P * np.where(d <= d[np.argmax(P)], 1.02, 1.0)), "stiffness"),
    "peak cut off": (lambda d, P: (d, np.minimum(P, 0.97 * np.max(P))), "peak"),
    "tail 3 % off": (lambda d, P: (d, np.where(d > 0.7 * d[-1], 0.97 * P, P)), "curve"),
    "offset": (lambda d, P: (d, P + 0.01 * np.max(P)), "curve"),
}


@on_scenes(WRONG, (0.002, 0.0))
def test_no_wrong_curve_passes(kind, name, part):
    change, says = WRONG[kind]
    assert says in broken(name, noise(part, 1)(*change(*right(name))))


def test_of_a_run_without_damage_all_rows_tell_the_stiffness():
    d = np.linspace(0.0, 2.5, 100)
    judge = Result("nurbs", {"opening": d, "load": 2.0 * d, "dissipated_energy": 0.0 * d, "external_work": d**2})
    mine = Result("mine", {"opening": d, "load": 2.04 * d})
    found = {check.name: check.value for check in checks_of(scene("dcb"), "mine", mine, {"nurbs": judge})}
    assert found["stiffness"] == pytest.approx(0.02)


def test_a_noise_beyond_the_tolerance_is_an_error():
    curve = noise(0.02)(*right("dcb"))
    found, said = judged("dcb", curve)
    assert "a noise of 2" in said and {"curve", "farthest-point"} <= broken("dcb", curve)


def test_teeth_behind_the_peak_are_no_noise():
    """Though a tooth spans three rows alone."""
    d, P = right("dcb")
    tooth = 0.004 * np.max(P) * np.where(P.argmax() < np.arange(len(P)), np.arange(len(P)) % 3 - 1.0, 0.0)
    assert scatter_of((d, P + tooth)).noise < 1e-4 * np.max(P)
    assert scatter_of(noise(0.004)(d, P)).noise == pytest.approx(0.004 * np.max(P), rel=0.25)


def test_what_is_a_straight_line_by_equal_steps_is_not_rounded():
    """Its loads have a common divisor as well."""
    d = np.linspace(0.0, 1.0, 51)
    assert not scatter_of((d, 7.77 * d)).halves.any()
    assert np.allclose(np.max(scatter_of((d, np.round(7.77 * d, 1))).halves, axis=1), [0.0, 0.05])


TRUST_FILES = Path(__file__).parents[4] / "shared" / "trust"


@pytest.mark.skipif(not TRUST_FILES.is_dir(), reason="../shared/trust is not there")
@pytest.mark.parametrize(
    ("file", "says"),
    [("noise", "noise of 0.2"), ("rounded", "loads rounded to 0.1"), ("late", "not covered: stiffness")],
)
def test_curves_that_were_called_broken(file, says):
    found, said = judged("dcb", read_curve(TRUST_FILES / f"{file}.csv"))
    assert not [check for check in found if check.state == "broken"] and says in said
