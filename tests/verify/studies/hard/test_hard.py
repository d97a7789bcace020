"""The hard cases: a framework that no crash and no NaN gets past, and the cases themselves."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from iga.bases.names import BASES
from iga.laws.opening import LAWS, BilinearLaw
from verify.cli import main
from verify.methods.solve import solve
from verify.result import Result, steps_from_rows
from verify.scene.load import load_scene
from verify.scene.parse import parse_scene
from verify.scene.schema import Scene
from verify.studies.hard import suite
from verify.studies.hard.case import Case, Number, Trial, Trials, Variant, variant
from verify.studies.hard.cases import CASES, chosen
from verify.studies.hard.criteria import common, difference, distance, ledger, missing
from verify.studies.hard.invariance import NOISE, every_number, in_units
from verify.studies.hard.one import read_verdict, run_case
from verify.studies.hard.programmes import legs
from verify.studies.hard.strength import broken_area
from verify.studies.hard.suite import Cell, hard, matrix
from verify.verdict import Check

ROWS = (
    "coarse-czm2", "under-resolved", "toward-lefm", "brittle-ratio", "penalty-sweep", "points-sweep", "slender",
    "incompressible", "big-steps", "unload-reload", "full-separation", "peel-as-printed", "large-rotation", "mismatch",
    "units", "pose", "noise", "stiffness-contrast",
)  # fmt: skip

#: Some of the cases, fast ones; --slow runs all of them.
FAST = ("coarse-czm2", "short-ligament")


def fake_rows(opening: float, n: int = 30) -> list[dict[str, float]]:
    """A curve that rises and falls, its ledger closed by construction: what is not dissipated is stored."""
    d = np.linspace(0.0, opening, n + 1)
    P, slope = 2.0 * d * np.exp(-d), 2.0 * (1.0 - d) * np.exp(-d)
    work = 2.0 - 2.0 * (1.0 + d) * np.exp(-d)
    columns = {
        "opening": d, "load": P, "load_slope": slope, "heading": np.ones(n + 1), "crack_length": np.full(n + 1, 4.0),
        "stored_energy": 0.5 * d * P, "dissipated_energy": work - 0.5 * d * P, "external_work": work,
        "newton_iterations": np.full(n + 1, 3.0),
    }  # fmt: skip
    return [{name: float(column[i]) for name, column in columns.items()} for i in range(n + 1)]


def stub(scene: Scene, method: str, on_step) -> Result:
    """A solver that needs no time."""
    rows = fake_rows(scene.load.opening[-1])
    for row in rows:
        on_step(row)
    return Result(method, steps_from_rows(rows), rejected_steps=2, condition=1e6, seconds={"total": 0.5})


def good() -> list[Variant]:
    return [variant("a", "dcb-czm1-linear"), variant("b", "dcb-czm1-linear", "load.opening=2.0")]


def judge(trials: Trials) -> Iterator[Check | Number]:
    yield Check("loads", "a / b", trials["a"].result.load[-1] - 0.298, 0.01, "exact", "The load.")
    yield Number("more", "a", 7.0, "A number.")


FAKE = Case("fake", "Nothing is <b>hard</b> & it holds.", good, judge)


def faulty(**changes):
    """The stub with some of its columns shifted."""

    def solver(scene: Scene, method: str, on_step) -> Result:
        result = stub(scene, method, on_step)
        return replace(result, steps={**result.steps, **{k: result.steps[k] + v for k, v in changes.items()}})

    return solver


def failed(case: Case, folder: Path, solver=stub) -> set[str]:
    return {check.name for check in run_case(case, "nurbs", folder, solver).checks if not check.passed}


def test_every_row_is_a_case_with_a_sentence() -> None:
    assert set(ROWS) < set(CASES)
    assert all(case.hard.endswith(".") and len(case.hard) > 30 for case in CASES.values())


@pytest.mark.parametrize("name", CASES)
def test_no_case_sets_its_own_steps(name: str) -> None:
    variants = CASES[name].variants()
    steps = {v.scene.discretization.steps for v in variants}
    assert steps == ({5, 5000} if name == "big-steps" else {"auto"})
    assert len({v.name for v in variants}) == len(variants)


def test_a_case_leaves_curves_and_a_verdict(tmp_path: Path) -> None:
    verdict = run_case(FAKE, "nurbs", tmp_path, stub)
    assert verdict.passed and verdict.completed == 2
    assert {check.name for check in verdict.checks} == {"completed", "finite", "ledger", "loads"}
    assert [(number.name, number.value) for number in verdict.numbers] == [("more", 7.0)]
    assert read_verdict(tmp_path) == verdict
    for name in ("a", "b"):
        folder = tmp_path / name
        assert {"curve.csv", "evidence.csv", "result.json"} <= {path.name for path in folder.iterdir()}


@pytest.mark.parametrize(
    ("changes", "broken"),
    [
        ({"external_work": 0.1}, {"ledger", "judged"}),
        ({"opening": -0.1}, {"completed", "judged"}),
        ({"load": 0.1}, {"loads"}),
        ({"crack_length": np.nan}, {"finite", "judged"}),
        ({"stored_energy": np.nan}, {"finite", "ledger", "judged"}),
    ],
)
def test_a_wrong_column_fails_its_criterion(changes: dict, broken: set[str], tmp_path: Path) -> None:
    assert failed(FAKE, tmp_path, faulty(**changes)) == broken


def test_a_crash_of_the_solver_is_a_run_that_fails(tmp_path: Path) -> None:
    def solver(scene: Scene, method: str, on_step) -> Result:
        raise RuntimeError("no luck")

    assert {"completed", "judged"} <= failed(FAKE, tmp_path, solver)
    assert "no luck" in read_verdict(tmp_path).runs[0].status


def test_a_criterion_that_cannot_be_computed_fails(tmp_path: Path) -> None:
    def broken(trials: Trials) -> Iterator[Check]:
        yield Check("x", "a", trials["no such run"].result.load[0], 1.0, "exact", "x")

    assert failed(replace(FAKE, judge=broken), tmp_path) == {"judged"}


def test_a_case_may_stop_only_where_it_says_so(tmp_path: Path) -> None:
    def solver(scene: Scene, method: str, on_step) -> Result:
        return replace(stub(scene, method, on_step), status="stopped: process zone 0.1 < element 1")

    assert failed(FAKE, tmp_path, solver) == {"completed", "judged"}
    assert failed(replace(FAKE, may_stop=True), tmp_path, solver) == set()


def test_a_separated_run_is_complete() -> None:
    short = Trial(variant("x", "dcb-czm1-linear"), Result("nurbs", steps_from_rows(fake_rows(2.0))))
    assert missing(short) == pytest.approx(1 / 3)
    assert missing(replace(short, result=replace(short.result, ending="separated at opening 2"))) == 0.0


def test_the_ledger_is_measured_by_what_is_dissipated() -> None:
    steps = steps_from_rows(fake_rows(3.0))
    lost = steps["dissipated_energy"][-1]
    wrong = {**steps, "external_work": steps["external_work"] + 0.02 * lost * (steps["opening"] == 1.5)}
    assert ledger(Result("nurbs", wrong)) == pytest.approx(0.02)
    assert ledger(Result("nurbs", steps)) < 1e-14


def test_j_is_a_check_only_where_the_zone_is_resolved() -> None:
    """The cohesive beam has an exact J; the front of its damage is made up."""
    scene = load_scene("dcb-czm1-linear", ["discretization.steps=60"])
    beam = replace(solve(scene, "beam"), method="nurbs")
    for ahead, name in ((0.9, "j-integral"), (0.1, "j-deviation")):
        result = replace(beam, steps={**beam.steps, "damage_front": beam.steps["crack_length"] + ahead})
        found = {f.name: f for f in common(Trial(Variant("x", scene), result))}
        assert name in found and found[name].value < 1e-3
        assert ("j-integral" in found) == (name == "j-integral")


def test_paths_are_compared_step_by_step_or_by_their_envelopes() -> None:
    a, b = (Result("nurbs", steps_from_rows(fake_rows(3.0, n))) for n in (30, 40))
    assert difference(a, a) == 0.0
    moved = replace(a, steps={**a.steps, "load": a.load + 1e-6 * a.load.max() * (a.opening == 1.5)})
    assert difference(moved, a) == pytest.approx(1e-6)
    assert 1e-7 < difference(b, a) < 1e-4
    scaled = {**b.steps, "opening": 1e-3 * b.opening, "load": 1e3 * b.load, "load_slope": 1e6 * b.steps["load_slope"]}
    assert difference(Result("nurbs", scaled), a, 1e3, 1e-3) == pytest.approx(difference(b, a))
    assert distance(b, a) == pytest.approx(difference(b, a))


def test_units_change_the_numbers_and_nothing_else() -> None:
    scene = load_scene("dcb-czm1")
    inches = in_units(scene, 1e-3, 1 / 25.4, "kN, in, kN/in2")
    law, material = inches.interface, inches.material
    assert inches.specimen.length == pytest.approx(14 / 25.4) and inches.load.opening == pytest.approx((3 / 25.4,))
    assert law.toughness == pytest.approx(0.1 * 25.4 * 1e-3)
    for ratio in (lambda s: s.material.young / s.interface.strength, lambda s: s.interface.ductility,
                  lambda s: s.interface.toughness / s.interface.strength / s.specimen.length,
                  lambda s: s.interface.penalty * s.specimen.length / s.material.young):  # fmt: skip
        assert ratio(inches) == pytest.approx(ratio(scene), rel=1e-14)
    assert material.poisson == 0.2 and inches.discretization == scene.discretization
    back = in_units(inches, 1e3, 25.4, scene.units)
    assert back.interface.penalty == pytest.approx(scene.interface.penalty, rel=1e-14) and back.units == scene.units


def test_corners_of_a_table_are_openings_and_tractions(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(LAWS, "tabular", BilinearLaw)
    scene = load_scene("dcb-czm1").model_dump() | {"interface": {"law": "tabular", "table": [[0.1, 2.0], [0.5, 0.0]]}}
    found = in_units(parse_scene(scene), 1e-3, 1 / 25.4, "kN, in, kN/in2").interface.table
    assert found == (pytest.approx((0.1 / 25.4, 2e-3 * 25.4**2)), pytest.approx((0.5 / 25.4, 0.0)))


def runs_of(name: str, change=lambda name, columns: columns) -> Trials:
    """One made-up curve for every variant of a case, in units of the variant's own, with changes."""
    sizes = {"n-m": (1.0, 1e-3), "kn-in": (1e-3, 1 / 25.4)}
    trials = {}
    for v in CASES[name].variants():
        force, length = sizes.get(v.name, (1.0, 1.0))
        columns = steps_from_rows(fake_rows(3.0))
        columns = {**columns, "opening": columns["opening"] * length, "load": columns["load"] * force}
        columns["load_slope"] = columns["load_slope"] * force / length
        trials[v.name] = Trial(v, Result("nurbs", change(v.name, columns)))
    return trials


@pytest.mark.parametrize("name", ["units", "pose", "noise"])
def test_what_must_not_matter_is_judged_for_every_variant_and_to_rounding(name: str) -> None:
    first, *others = (v.name for v in CASES[name].variants())
    found = list(CASES[name].judge(runs_of(name)))
    assert [check.subject for check in found] == others and all(check.kind == "exact" for check in found)
    assert all(check.passed and check.tolerance <= 1e-8 for check in found)
    for column in ("opening", "load"):
        for wrong in others[:3]:

            def off(name: str, columns: dict, wrong: str = wrong, column: str = column) -> dict:
                return {**columns, column: columns[column] * (1.0 + 1e-7 * (name == wrong))}

            assert [check.subject for check in CASES[name].judge(runs_of(name, off)) if not check.passed] == [wrong]


@pytest.mark.parametrize("name", ["units", "pose"])
def test_a_run_with_other_steps_is_judged_by_its_curve(name: str) -> None:
    """One that stops early has not the same curve."""
    *_, last = (v.name for v in CASES[name].variants())

    def early(name: str, columns: dict) -> dict:
        return {key: column[: 20 if name == last else None] for key, column in columns.items()}

    assert [check.subject for check in CASES[name].judge(runs_of(name, early)) if not check.passed] == [last]


def test_poses_are_turned_mirrored_and_moved() -> None:
    poses = {v.name: v.scene.pose for v in CASES["pose"].variants()}
    here = poses.pop("plain")
    assert (here.angle, here.mirror, here.shift) == (0.0, False, (0.0, 0.0))
    moved = {name: (pose.angle != 0.0, pose.mirror, pose.shift != (0.0, 0.0)) for name, pose in poses.items()}
    expected = {"rotated": (True, False, False), "mirrored": (False, True, False), "moved": (False, False, True)}
    assert moved == {**expected, "all": (True, True, True)}
    assert poses["rotated"].angle % 90 != 0 and min(poses["moved"].shift) > 100 * 14.0


@pytest.mark.parametrize("name", ["dcb-czm1", "peel-120"])
def test_every_number_of_a_scene_is_reached(name: str) -> None:
    scene = load_scene(name)
    halved = every_number(scene, lambda key, value: 0.5 * value if key != "ductility" else value)
    assert halved.interface.strength == 0.5 * scene.interface.strength
    assert halved.load.opening == tuple(0.5 * d for d in scene.load.opening)
    assert halved.specimen.width == 0.5 and halved.discretization.dofs == scene.discretization.dofs


def test_noise_is_as_small_as_said_and_never_the_same() -> None:
    plain, *noisy = (v.scene for v in CASES["noise"].variants())
    assert len(noisy) == 20 and len({scene.interface.strength for scene in noisy}) > 5
    assert all(0 < abs(s.interface.penalty / plain.interface.penalty - 1) < 1.1 * NOISE for s in noisy)


def test_legs_of_a_programme() -> None:
    opening = np.array([0.0, 0.5, 1.0, 1.5, 1.0, 0.5, 0.0, 0.5, 1.0, 1.5, 2.0, 3.0])
    steps = {"opening": opening, "load": opening}
    trial = Trial(variant("x", "dcb-czm1", "load.opening=[1.5, 0.0, 1.5, 3.0]"), Result("nurbs", steps))
    down, up = legs(trial)
    assert opening[down].tolist() == [1.5, 1.0, 0.5, 0.0] and opening[up].tolist() == [0.0, 0.5, 1.0, 1.5]
    unfinished = Result("nurbs", {name: column[:8] for name, column in steps.items()})
    assert all(leg.size == 0 for leg in legs(replace(trial, result=unfinished)))


#: Two Gauss points of the element from -1 to 1.
GAUSS = np.array([-1.0, 1.0]) / np.sqrt(3.0)


def test_the_area_of_a_crack_is_that_of_its_points() -> None:
    """Two points in each of two elements, 4 and 6 long: the first has broken, one of the other is half way there."""
    from verify.checks.mechanics.columns import law_of
    from verify.result import Snapshot

    scene = load_scene("dcb-czm1", ["specimen.width=2.0"])
    law = law_of(scene)
    half = 0.5 * (law.g_peak + law.g_open)
    damage_q = np.array([1.0, 1.0, float(law.damage(half)), 0.0])
    grids = {"X_euvi": np.zeros((0, 1, 1, 2)), "u_euvi": np.zeros((0, 1, 1, 2)), "stress_euv": np.zeros((0, 1, 1))}
    s_q = np.concatenate([6.0 + 2.0 * GAUSS, 11.0 + 3.0 * GAUSS])
    snapshot = Snapshot(3.0, 0.2, s_q, np.zeros(4), np.zeros(4), damage_q, **grids)
    trial = Trial(Variant("x", scene), Result("nurbs", {}, snapshots=(snapshot,)))
    area, cost = broken_area(trial)
    assert area == pytest.approx(2.0 * 4.0)
    assert cost == pytest.approx(0.1 * 8.0 + 2.0 * 3.0 * float(law.dissipated(half)), rel=1e-12)


def test_an_unknown_case_is_refused_with_a_suggestion(tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    out = tmp_path / "out"
    assert main(["hard", "coarse-czm1", "zzz", "--out", str(out)]) == 2
    said = capsys.readouterr().err
    assert 'coarse-czm1: is no hard case; did you mean "coarse-czm2"?' in said
    assert "zzz: is no hard case; the hard cases are coarse-czm2," in said
    assert not out.exists()
    assert [case.name for case in chosen(["units", "units"])] == ["units"] and len(chosen([])) == len(CASES)


@pytest.fixture
def in_process(monkeypatch: pytest.MonkeyPatch) -> None:
    """Cells without processes, solved by the stub; the Lagrange one dies."""

    def run_all(cases: list[Case], out: Path, *how) -> Iterator[Cell]:
        for one, basis in ((case, basis) for case in cases for basis in case.bases):
            dies = basis == "lagrange"
            verdict = None if dies else run_case(one, basis, out / one.name / basis, stub)
            yield Cell(one, basis, verdict, "signal 9" if dies else "")

    monkeypatch.setattr(suite, "run_all", run_all)


def test_a_crash_costs_one_cell(in_process: None, tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    assert not hard([FAKE], tmp_path, jobs=2)
    said = capsys.readouterr().out.splitlines()
    assert any(line.split()[:4] == ["fake", "nurbs", "ok", "2"] for line in said)
    assert any(line.split()[:3] == ["fake", "lagrange", "FAIL"] and "signal 9" in line for line in said)
    assert said[-1].startswith("0 of 1 hard cases hold")


def test_all_cells_hold_and_what_fails_is_said_in_full(tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    cells = [Cell(FAKE, basis, run_case(FAKE, basis, tmp_path / basis, stub)) for basis in BASES]
    assert suite.failures(cells) == []
    first = matrix(cells)[1].split()
    assert first[:8] == ["fake", next(iter(BASES)), "ok", "2", "of", "2", "60", "4"] and first[9] == "1.0e+06"
    bad = Cell(FAKE, "nurbs", run_case(FAKE, "nurbs", tmp_path / "nurbs", faulty(external_work=0.1)))
    lines = suite.failures([bad])
    assert len(lines) == 3 and all("ledger" in line and "(<= 1.0e-02)" in line for line in lines[:2])
    assert bad.verdict is not None and bad.verdict.fault in matrix([bad])[1]
    assert re.search(r"Not judged: a broken: ledger 0.0\d+ of 0.01; b broken: ledger 0.\d+ of 0.01", bad.verdict.fault)
    assert bad.verdict.numbers == ()


def test_a_process_that_dies_leaves_its_last_words(tmp_path: Path) -> None:
    (cell,) = suite.run_all([replace(FAKE, name="no-such-case", bases=("nurbs",))], tmp_path, 1)
    assert cell.verdict is None and not cell.passed
    assert cell.why == "failed: KeyError: 'no-such-case'"
    assert "KeyError" in (tmp_path / "no-such-case" / "nurbs" / "log.txt").read_text()


def test_the_page_links_figures_and_curves_and_escapes_texts(in_process: None, tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    pytest.importorskip("jinja2")
    hard([FAKE], tmp_path, jobs=1)
    page = (tmp_path / "report.html").read_text()
    assert "Nothing is &lt;b&gt;hard&lt;/b&gt; &amp; it holds." in page and "<b>hard</b>" not in page
    assert 'href="#fake"' in page and 'id="fake"' in page and "Load against opening, fake" in page
    assert 'href="./fake/nurbs/a/curve.csv"' in page and (tmp_path / "fake/nurbs/a/curve.csv").exists()
    assert "signal 9" in page and "<svg" in page and "0 of 1 hold" in page


def test_a_single_path_is_drawn_with_its_envelope(in_process: None, tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    pytest.importorskip("jinja2")
    hard([Case("single", "One run alone is drawn with its envelope.", lambda: good()[:1])], tmp_path, jobs=1)
    assert "displacement control" in (tmp_path / "report.html").read_text()


def test_a_verdict_with_nan_is_read_back_as_a_failure(tmp_path: Path) -> None:
    run_case(FAKE, "nurbs", tmp_path / "nurbs", faulty(stored_energy=np.nan))
    json.loads((tmp_path / "nurbs" / "verdict.json").read_text())
    read = read_verdict(tmp_path / "nurbs")
    assert not read.passed and np.isnan(next(c.value for c in read.checks if c.name == "ledger"))


def test_a_case_may_leave_a_basis_out(in_process: None, tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    pytest.importorskip("matplotlib")
    pytest.importorskip("jinja2")
    assert hard([replace(FAKE, bases=("nurbs",))], tmp_path, jobs=1)
    said = capsys.readouterr().out.splitlines()
    assert [line.split()[1] for line in said if line.split()[2:3] == ["ok"]] == ["nurbs"]
    matrix_table = (tmp_path / "report.html").read_text().partition("</table>")[0]
    assert matrix_table.count("<td>–</td>") == len(BASES) - 1


@pytest.mark.parametrize(
    ("name", "basis"),
    [
        pytest.param(name, basis, marks=() if name in FAST else pytest.mark.slow)
        for name, case in CASES.items()
        for basis in case.bases
    ],
)
def test_a_hard_case_holds(name: str, basis: str, tmp_path: Path) -> None:
    verdict = run_case(CASES[name], basis, tmp_path)
    broken = [f"{c.name} of {c.subject}: {c.value:.3g} > {c.tolerance:.3g}" for c in verdict.checks if not c.passed]
    assert not broken
