"""Random scenes: a family that stays in its ranges; the campaign on it tells every kind of fault from none."""

from __future__ import annotations

import csv
from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from verify.checks.between_codes import cross_checks
from verify.checks.odd_one_out import odd_one_out
from verify.checks.proof import MATCHED, REFERENCE, SECOND
from verify.cli import REFUSED, main
from verify.command_line.answers import FAILED
from verify.methods.zone_resolution import expected
from verify.result import Result
from verify.runs.jobs import Job, Outcome
from verify.scene.by_seed.random_scenes import ZONES, random_scene
from verify.scene.load import load_scene
from verify.scene.materials import Orthotropic
from verify.scene.parse import SceneError
from verify.scene.schema import Scene
from verify.studies import campaign, frame
from verify.studies.campaign import LARGEST_DISTANCE, Row, row, table
from verify.verdict import Check, Run, SceneReport

pytestmark = pytest.mark.usefixtures("nothing_certified")

FINITE, LINEAR = load_scene("dcb-czm1"), load_scene("dcb-czm1-linear")


# --- the scenes


@pytest.fixture(scope="module")
def family():
    return [random_scene(seed) for seed in range(200)]


def slenderness(scene: Scene) -> float:
    return scene.specimen.free_length / scene.specimen.arm_thickness


def zone(scene: Scene) -> float:
    """Length of the process zone; the beam has no mesh to be made for it."""
    return expected(scene, "beam").length


def test_a_seed_gives_the_scene_that_it_gave_elsewhere(family):
    scene = family[7]
    assert (scene.specimen.plane, scene.effects.kinematics) == ("stress", "linear")
    found = slenderness(scene), scene.specimen.arm_thickness, scene.interface.strength, scene.load.opening[-1]
    assert found == pytest.approx((27.0262658054, 45.0935203962, 1.59025806771e-7, 57.653493031), rel=1e-8)


def test_slenderness_and_zone_stay_in_their_ranges_and_fill_them(family):
    """And every kind of specimen is among them."""
    one = 1.0 + 1e-9
    slender, zones, along, growth = np.array([
        (slenderness(scene), size / scene.specimen.arm_thickness, scene.specimen.length / size,
         (scene.specimen.length - scene.specimen.free_length) / size)
        for scene in family for size in [zone(scene)]
    ]).T  # fmt: skip
    assert 4.0 <= slender.min() * one < 5.0 and 70.0 < slender.max() / one <= 85.0
    assert 0.3 <= zones.min() * one < 0.4 and 8.0 < zones.max() / one <= 10.0
    assert along.max() <= ZONES * one and growth.min() * one >= 6.0
    kinds = {(isinstance(s.material, Orthotropic), s.specimen.plane, s.effects.kinematics) for s in family}
    ductility = [scene.interface.ductility for scene in family]
    assert len(kinds) == 8 and min(ductility) < 2.0 and 40.0 < max(ductility) <= 50.0


def test_a_random_scene_is_named_like_a_packaged_one_and_takes_overrides():
    assert load_scene("random-7") == random_scene(7)
    other = load_scene("random-7", ["discretization.dofs=900", "specimen.width=2.0"])
    assert (other.discretization.dofs, other.specimen.width, other.name) == (900, 2.0, "random-7")
    assert other.interface == random_scene(7).interface
    with pytest.raises(SceneError, match="interface.strength"):
        load_scene("random-7", ["interface.strength=-1"])
    for name in ("random-", "random--1", "random-x", "random-1234567890"):
        with pytest.raises(SceneError):
            load_scene(name)


# --- the command


@pytest.mark.parametrize(
    ("words", "asked"),
    [([], range(40)), (["--seeds", "3"], range(3)), (["--seeds", "40-79"], range(40, 80))],
)
def test_the_command_takes_the_seeds(words, asked, monkeypatch):
    seen: list[list[str]] = []
    monkeypatch.setattr(campaign, "would_run", lambda names, out, jobs: seen.append(names) or [])
    for family in ("random", "plain"):
        assert main(["hard", family, "--dry-run", *words]) == 0
    assert seen == [[f"{family}-{seed}" for seed in asked] for family in ("random", "plain")]


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        *[
            (["random", "--seeds", text], f"--seeds: must be a number >= 1, or two like 40-79, got '{text}'")
            for text in ("0", "9-3", "3-")
        ],
        (["--seeds", "3"], "--seeds: is for random and plain scenes; debond hard random --seeds 40"),
        (["big-steps", "random", "--seeds", "3"], "random: must be the only NAME, it is a campaign of its own"),
    ],
)
def test_what_the_command_refuses(words, sentence, tmp_path, capsys):
    out = tmp_path / "out"
    try:
        assert main(["hard", *words, "--out", str(out)]) == REFUSED
    except SystemExit as end:  # the parser itself refuses
        assert end.code == REFUSED
    said = capsys.readouterr()
    assert sentence in said.err and said.out == "" and not out.exists()


# --- the rows


def curve(scene: Scene, method: str, factor: float = 1.0) -> Result:
    """A load that rises, and falls along an unloaded crack."""
    end = max(scene.load.opening)
    opening = np.linspace(0.0, end, 300)
    load = np.minimum(opening, (end / 3.0) ** 1.5 * np.maximum(opening, 0.01 * end) ** -0.5)
    return Result(method.partition("-")[0], {"opening": opening, "load": factor * load})


def report(scene: Scene, results: dict[str, Result | None], *more: Check) -> SceneReport:
    """Runs with all checks between them, judged as a verification judges."""
    runs = tuple(Run(name, name.partition("-")[0], one, folder=f"{scene.name}/{name}") for name, one in results.items())
    there = {name: result for name, result in results.items() if result is not None}
    checks = (*cross_checks(scene, there), *more)
    return SceneReport(scene, runs, checks, odd_one_out(scene, checks, there))


def runs(scene: Scene, **factors: float) -> dict[str, Result | None]:
    """Runs of plane codes; names with dashes are written with underscores."""
    return {(name := key.replace("_", "-")): curve(scene, name, part) for key, part in factors.items()}


RIGHT = {"tspline": 1.0, "nurbs": 1.0, "nurbs_matched": 1.0, "dolfinx": 1.0, "dolfinx_second": 1.0002}


def row_of(scene: Scene, *more: Check, **factors: float) -> Row:
    made = runs(scene, **{**RIGHT, **factors})
    if scene.effects.kinematics == "linear":
        del made[MATCHED]  # there is no search that could be left out
    return row(report(scene, made, *more))


def broken_j(unresolved: str = "") -> Check:
    return Check("j-integral", "nurbs", 0.02, 0.005, "exact", "", unresolved=unresolved)


def test_a_right_scene_has_no_fault():
    found = row_of(FINITE, beam=1.001)
    assert (found.fault, found.names, found.odd, found.broken, found.unresolved) == ("", "", "", 0, 0)
    assert found.checks > 0 and found.apart == 0.0 and found.beam == pytest.approx(0.001, rel=0.01)
    assert (found.scene, found.plane, found.kinematics) == ("dcb-czm1", "stress", "finite") and not found.orthotropic
    assert found.slenderness == pytest.approx(slenderness(FINITE))
    assert found.zone == pytest.approx(zone(FINITE) / FINITE.specimen.arm_thickness)


@pytest.mark.parametrize(
    ("scene", "factors", "more", "fault", "apart", "named"),
    [
        # both are within the tolerance of the reference, one above and one below it
        (FINITE, {"tspline": 0.997, "nurbs": 1.0031}, [], "silent", 0.0061, ""),
        (FINITE, {"tspline": 0.998, "nurbs": 1.002}, [], "", 0.004, ""),
        # a check says so, or that it cannot judge
        (FINITE, {"nurbs": 1.03, "nurbs_matched": 1.03}, [], "", 0.03, "odd one out: nurbs"),
        # the reference keeps its pairs of points, and so does one of the NURBS runs; linear kinematics is one model
        (FINITE, {"tspline": 1.01, "nurbs": 1.01, "nurbs_matched": 1.0005}, [], "", 0.0005, ""),
        (LINEAR, {"tspline": 1.01, "nurbs": 1.01}, [], "", 0.01, ""),
        # a fault of no pair names nobody
        (FINITE, {}, [broken_j()], "unnamed", 0.0, ""),
        (FINITE, {}, [broken_j("the process zone spans 2 elements")], "", 0.0, ""),
    ],
)
def test_a_difference_of_codes_is_named_or_a_fault(scene, factors, more, fault, apart, named):
    found = row_of(scene, *more, **factors)
    assert found.fault == fault and found.apart == pytest.approx(apart, rel=0.03, abs=1e-9)
    assert named in found.odd and (named != "odd one out: nurbs" or "curve:nurbs/dolfinx" in found.names)
    assert (fault == "silent") == (found.apart > LARGEST_DISTANCE and not found.broken and not found.unresolved)


@pytest.mark.parametrize("name", ["nurbs", REFERENCE, SECOND])
def test_a_run_that_stopped_is_a_fault_but_for_the_second_mesh(name):
    made = runs(FINITE, **RIGHT)
    for gone in (None, replace(made[name], status="stopped")):
        found = row(report(FINITE, {**made, name: gone}))
        assert found.fault == ("" if name == SECOND else f"stopped {name}")


def test_a_pair_that_is_not_there_does_not_hide_the_others_and_no_pair_is_not_right():
    made = runs(FINITE, **{**RIGHT, "nurbs_matched": 1.02})
    del made["tspline"]
    assert row(report(FINITE, made)).apart == pytest.approx(0.02, rel=0.01)
    found = row(report(FINITE, runs(FINITE, nurbs=1.0)))
    assert found.fault == "silent" and np.isnan(found.apart)


def test_the_table_has_a_line_for_every_scene():
    lines = table([row_of(FINITE), row_of(FINITE, broken_j()), row_of(LINEAR, nurbs=1.03)])
    assert len(lines) == 4 and lines[1].rstrip().endswith("12/12")
    assert "unnamed; j-integral:nurbs" in lines[2] and "odd one out: nurbs" in lines[3] and "stress linear" in lines[3]


# --- the campaign


def solved_with(**factors: float) -> Callable[..., Iterator[Outcome]]:
    """In place of the solvers: curves of every run that differ by factors."""

    def run_all(plan: Iterable[Job], out: Path, jobs: int, scheduler: str | None = None) -> Iterator[Outcome]:
        for job in plan:
            factor = factors.get(job.variant.replace("-", "_"), 1.0) if job.scene.name == "random-8" else 1.0
            yield Outcome(job, curve(job.scene, job.variant, factor))

    return run_all


@pytest.mark.parametrize(("off", "code"), [({}, 0), ({"tspline": 0.997, "nurbs": 1.003}, FAILED)])
def test_the_campaign_writes_its_rows_and_fails_for_a_fault(off, code, tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(frame, "run_all", solved_with(**off))
    monkeypatch.setattr("verify.checks.orders.judges", lambda *_: ())  # the beam judges nobody
    assert main(["hard", "random", "--seeds", "7-8", "--out", str(tmp_path)]) == code
    said = capsys.readouterr().out
    with (tmp_path / "random.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert [one["scene"] for one in rows] == ["random-7", "random-8"]
    assert [one["fault"] for one in rows] == ["", "silent" if code else ""]
    assert f"{2 - bool(code)} of 2 random scenes without a fault" in said


@pytest.mark.slow
def test_two_random_scenes_by_every_code(tmp_path, capsys):
    pytest.importorskip("dolfinx", reason="DOLFINx is not installed")
    assert main(["hard", "random", "--seeds", "11-12", "--jobs", "1", "--out", str(tmp_path)]) == 0
    with (tmp_path / "random.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert [one["scene"] for one in rows] == ["random-11", "random-12"]
    assert all(one["fault"] == "" and float(one["apart"]) <= LARGEST_DISTANCE for one in rows), capsys.readouterr().out
