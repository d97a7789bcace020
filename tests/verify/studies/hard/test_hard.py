"""The hard cases: a framework that no crash and no NaN gets past, what is tried, and the cases themselves."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from unittest.mock import ANY

import made_up_studies
import numpy as np
import pytest
from made_up_costs import made_up

from iga.bases.names import BASES
from iga.laws.laws import LAWS, ShapedLaw
from verify.cli import main
from verify.methods.names import Unsuitable
from verify.methods.solve import solve
from verify.result import Result
from verify.runs.sweep import Done
from verify.scene.load import load_scene
from verify.scene.parse import parse_scene
from verify.scene.schema import Scene
from verify.studies.hard import one, suite
from verify.studies.hard.case import Case, Number, Trial, Trials, runs
from verify.studies.hard.cases import CASES, chosen
from verify.studies.hard.criteria import common
from verify.studies.hard.invariance import NOISE, in_units
from verify.studies.hard.one import NOT_JUDGED, Verdict, read_verdict, run_case
from verify.studies.hard.suite import hard, matrix
from verify.support.checked_files import Damaged
from verify.verdict import Check

#: Some of the cases, fast ones; --slow runs all of them.
FAST = {("coarse-czm2", "lagrange"), ("short-ligament", "nurbs"), ("short-ligament", "tspline")}


def stub(scene: Scene, method: str, on_step) -> Result:
    """A solver that needs no time."""
    found = made_up(2.0, end=scene.load.opening[-1], n=30, rejected_steps=2, condition=1e6, seconds={"total": 0.5})
    found = replace(found, method=method, steps={**found.steps, "crack_length": np.full(31, 4.0)})
    for i in range(31):
        on_step({name: float(column[i]) for name, column in found.steps.items()})
    return found


def faulty(**changes):
    """The stub with some of its columns shifted."""

    def solver(scene: Scene, method: str, on_step) -> Result:
        result = stub(scene, method, on_step)
        return replace(result, steps={**result.steps, **{k: result.steps[k] + v for k, v in changes.items()}})

    return solver


def judge(trials: Trials) -> Iterator[Check | Number]:
    yield Check("loads", "a / b", float(trials["a"].result.load[-1]) - 0.298, 0.01, "exact", "The load.")
    yield Number("more", "a", 7.0, "A number.")


FAKE = Case(
    "fake", "Nothing is <b>hard</b> & it holds.", runs("dcb-czm1-linear", {"a": (), "b": ("load.opening=2.0",)}), judge
)


# --- one case


def test_a_case_leaves_curves_and_a_verdict(tmp_path):
    verdict = run_case(FAKE, "nurbs", tmp_path, stub)
    assert verdict.passed and verdict.total.name == "2 of 2" and read_verdict(tmp_path) == verdict
    assert {check.name for check in verdict.checks} == {"completed", "finite", "ledger", "loads"}
    assert [(number.name, number.value) for number in verdict.numbers] == [("more", 7.0)]
    for name in ("a", "b"):
        folder = tmp_path / name
        assert {"curve.csv", "evidence.csv", "result.json"} <= {path.name for path in folder.iterdir()}


def crash(scene: Scene, method: str, on_step) -> Result:
    raise RuntimeError("no luck")


def stops(scene: Scene, method: str, on_step) -> Result:
    return replace(stub(scene, method, on_step), status="stopped: process zone 0.1 < element 1")


def of_no_run(trials: Trials) -> Iterator[Check]:
    yield Check("x", "a", trials["no such run"].result.load[0], 1.0, "exact", "x")


@pytest.mark.parametrize(
    ("case", "solver", "broken"),
    [
        (FAKE, faulty(external_work=0.1), {"ledger", NOT_JUDGED}),
        (FAKE, faulty(opening=-0.1), {"completed", NOT_JUDGED}),
        (FAKE, faulty(load=0.1), {"loads"}),
        (FAKE, faulty(crack_length=np.nan), {"finite", NOT_JUDGED}),
        (FAKE, faulty(stored_energy=np.nan), {"finite", "ledger", NOT_JUDGED}),
        (FAKE, crash, {"completed", NOT_JUDGED}),
        (FAKE, stops, {"completed", NOT_JUDGED}),
        (replace(FAKE, may_stop=True), stops, set()),
        (replace(FAKE, judge=of_no_run), stub, {NOT_JUDGED}),
    ],
)
def test_a_fault_fails_its_criterion(case, solver, broken, tmp_path):
    """Whatever is written can be read again, NaN as NaN."""
    found = run_case(case, "nurbs", tmp_path, solver)
    assert {check.name for check in found.broken} == broken
    read = read_verdict(tmp_path)
    assert str(read) == str(found) and read.passed is not bool(broken)
    json.loads((tmp_path / "verdict.json").read_text())
    if solver is crash:
        assert "no luck" in read.runs[0].status


def test_a_separated_run_is_complete_and_one_that_stopped_where_its_programme_ends_is_not():
    scene, short = load_scene("dcb-czm1-linear"), made_up(end=2.0)

    def completed(result: Result) -> float:
        return next(check.value for check in common(Trial("x", scene, result)) if check.name == "completed")

    assert completed(short) == pytest.approx(1 / 3)
    assert completed(replace(short, ending="separated at opening 2")) == 0.0 == completed(made_up())
    assert completed(made_up(status="stopped")) == 1.0


def test_a_check_that_its_mesh_does_not_let_judge_breaks_no_case():
    """J of a mesh with 1 element in the process zone is off; the same deviation on a fine mesh is a fault."""
    scenes = {dofs: load_scene("dcb-czm1-linear", [f"discretization.dofs={dofs}"]) for dofs in (280, 5000)}
    beam = replace(solve(scenes[280], "beam"), method="nurbs")
    off = replace(beam, steps={**beam.steps, "load": 1.02 * beam.load})
    states = {}
    for dofs, scene in scenes.items():
        checks = tuple(common(Trial("x", scene, off)))
        states[dofs] = {check.name: check.state for check in checks}["j-integral"]
        assert Verdict("x", "nurbs", checks=[c for c in checks if c.name == "j-integral"]).passed is (dofs == 280)
    assert states == {280: "unresolved", 5000: "broken"}


# --- what is tried


def test_cases_are_the_ones_of_the_guide_and_none_sets_its_own_steps():
    assert len(CASES) == 34 and all(case.hard.endswith(".") and len(case.hard) > 30 for case in CASES.values())
    for name, case in CASES.items():
        steps = {scene.discretization.steps for scene in case.scenes().values()}
        assert steps == ({5, 5000} if name == "big-steps" else {"auto"})
    assert [case.name for case in CASES.values() if case.may_stop] == ["peel-as-printed"]


def test_units_change_the_numbers_and_nothing_else():
    """One specimen in newtons and millimetres, as it is, in newtons and metres, in kilonewtons and inches."""
    plain, metres, inches = CASES["units"].scenes().values()
    assert plain == load_scene("dcb-czm1", ["discretization.dofs=280"]).model_copy(update={"units": plain.units})
    assert [scene.units for scene in (plain, metres, inches)] == ["N, mm, MPa", "N, m, Pa", "kN, in, kN/in2"]

    def numbers(scene: Scene) -> tuple[float, ...]:
        body, solid, bond = scene.specimen, scene.material, scene.interface
        of_lengths = (body.precrack, body.width, scene.load.opening[0])
        return *of_lengths, solid.young, bond.strength, bond.toughness, bond.penalty, solid.poisson, bond.ductility

    for scene, force, length in ((metres, 1.0, 1e-3), (inches, 1e-3, 1.0 / 25.4)):
        stress = force / length**2
        sizes = [length] * 3 + [stress] * 2 + [force / length, stress / length, 1.0, 1.0]
        assert numbers(scene) == pytest.approx(np.multiply(numbers(plain), sizes))
        assert scene.discretization == plain.discretization
    back = in_units(inches, 1e3, 25.4, plain.units)
    assert back.interface.penalty == pytest.approx(plain.interface.penalty, rel=1e-14) and back.units == plain.units


def test_corners_of_a_table_are_openings_and_tractions(monkeypatch):
    monkeypatch.setitem(LAWS, "tabular", ShapedLaw)
    scene = load_scene("dcb-czm1").model_dump() | {"interface": {"law": "tabular", "table": [[0.1, 2.0], [0.5, 0.0]]}}
    found = in_units(parse_scene(scene), 1e-3, 1 / 25.4, "kN, in, kN/in2").interface.table
    assert found == (pytest.approx((0.1 / 25.4, 2e-3 * 25.4**2)), pytest.approx((0.5 / 25.4, 0.0)))


def test_noise_is_as_small_as_said_and_never_the_same():
    plain, *noisy = CASES["noise"].scenes().values()
    assert len(noisy) == 20 and len({scene.interface.strength for scene in noisy}) > 5
    assert all(0 < abs(s.interface.penalty / plain.interface.penalty - 1) < 1.1 * NOISE for s in noisy)


def test_an_unknown_case_is_refused_with_a_suggestion(tmp_path, capsys):
    out = tmp_path / "out"
    assert main(["hard", "coarse-czm1", "zzz", "--out", str(out)]) == 2
    said = capsys.readouterr().err
    assert 'coarse-czm1: is no hard case; did you mean "coarse-czm2"?' in said
    assert "zzz: is no hard case; the hard cases are coarse-czm2," in said and not out.exists()
    assert [case.name for case in chosen(["units", "units"])] == ["units"] and len(chosen([])) == len(CASES)


# --- all cases


@pytest.fixture
def in_process(monkeypatch):
    """Without processes, solved by the stub; the one with Lagrange elements dies."""

    def run_all(cases: list[Case], out: Path, *how) -> Iterator[Verdict]:
        for case, basis in ((case_, basis) for case_ in cases for basis in case_.bases):
            dies = basis == "lagrange"
            yield (
                Verdict(case.name, basis, why="signal 9")
                if dies
                else run_case(case, basis, out / case.name / basis, stub)
            )

    monkeypatch.setattr(suite, "run_all", run_all)


def test_a_crash_costs_one_verdict(in_process, tmp_path, capsys):
    pytest.importorskip("matplotlib")
    assert not hard([FAKE], tmp_path, jobs=2)
    said = capsys.readouterr().out.splitlines()
    assert any(line.split()[:4] == ["fake", "nurbs", "ok", "2"] for line in said)
    assert any(line.split()[:3] == ["fake", "lagrange", "FAIL"] and "signal 9" in line for line in said)
    assert said[-1].startswith("0 of 1 hard cases hold")
    page = (tmp_path / "report.html").read_text()
    assert "Nothing is &lt;b&gt;hard&lt;/b&gt; &amp; it holds." in page and "<b>hard</b>" not in page
    assert 'href="#fake"' in page and 'id="fake"' in page and "Load against opening, fake" in page
    assert 'href="./fake/nurbs/a/curve.csv"' in page and (tmp_path / "fake/nurbs/a/curve.csv").exists()
    assert "signal 9" in page and "<svg" in page and "0 of 1 hold" in page


def test_a_case_may_leave_a_basis_out_and_a_single_path_is_drawn_with_its_envelope(in_process, tmp_path, capsys):
    pytest.importorskip("matplotlib")
    single = Case("single", "One run alone.", runs("dcb-czm1-linear", {"a": ()}), bases=("nurbs",))
    assert hard([single], tmp_path, jobs=1)
    said = capsys.readouterr().out.splitlines()
    assert [line.split()[1] for line in said if line.split()[2:3] == ["ok"]] == ["nurbs"]
    page = (tmp_path / "report.html").read_text()
    assert page.partition("</table>")[0].count("<td>–</td>") == len(BASES) - 1 and "displacement control" in page


def test_all_hold_and_what_fails_is_said_in_full(tmp_path):
    good = {("fake", basis): run_case(FAKE, basis, tmp_path / basis, stub) for basis in BASES}
    assert suite.failures(good) == []
    first = matrix(good)[1].split()
    assert first[:8] == ["fake", next(iter(BASES)), "ok", "2", "of", "2", "60", "4"] and first[9] == "1.0e+06"
    bad = run_case(FAKE, "nurbs", tmp_path / "nurbs", faulty(external_work=0.1))
    lines = suite.failures({("fake", "nurbs"): bad})
    assert sum("ledger" in line and "(<= 1.0e-02)" in line for line in lines) == 2
    assert bad.fault in matrix({("fake", "nurbs"): bad})[1] and bad.numbers == ()
    assert re.search(r"Not judged: a broken: ledger 0.0\d+ of 0.01; b broken: ledger 0.\d+ of 0.01", bad.fault)


def test_a_process_that_dies_leaves_its_last_words(tmp_path):
    (found,) = suite.run_all([replace(FAKE, name="no-such-case", bases=("nurbs",))], tmp_path, 1)
    assert (found.folder, found.passed, found.why) == ("no-such-case/nurbs", False, "failed: KeyError: 'no-such-case'")
    assert "KeyError" in (tmp_path / "no-such-case" / "nurbs" / "log.txt").read_text()


def test_what_a_process_leaves_is_its_verdict_or_why_there_is_none(tmp_path, monkeypatch):
    """And it ends with what the verdict says."""
    case = CASES["coarse-czm2"]
    lost = suite.verdict_of(Done(suite.task(case, "nurbs"), tmp_path, "failed: signal 9"))
    assert (lost.runs, lost.why, lost.passed) == ((), "failed: signal 9", False)
    made_up_studies.hard(tmp_path)
    for basis, passed in (("nurbs", True), ("tspline", False)):
        found = suite.verdict_of(Done(suite.task(case, basis), tmp_path / "coarse-czm2" / basis))
        assert (found.case, found.basis, found.passed, found.why) == ("coarse-czm2", basis, passed, "")
    asked: list[tuple] = []
    for passed in (True, False):
        monkeypatch.setattr(one, "run_case", lambda *what, p=passed: asked.append(what) or SimpleNamespace(passed=p))
        assert one.main(["units", "nurbs", str(tmp_path)]) == (0 if passed else 1)
    assert asked == [(CASES["units"], "nurbs", tmp_path)] * 2


def test_a_verdict_counts_with_the_runs_that_it_is_about(tmp_path, monkeypatch):
    """A run without a step, as one that was refused, has left nothing to read."""
    run = one.run

    def refusing(prepared, *words, **options) -> tuple:
        if prepared.scene.load.opening[-1] == 2.0:
            raise Unsuitable("too coarse")
        return run(prepared, *words, **options)

    monkeypatch.setattr(one, "run", refusing)
    known = one.run_case(FAKE, "nurbs", tmp_path, stub)
    assert [line.status for line in known.runs] == ["complete", "stopped: too coarse"] and known.runs[1].steps == 0
    assert one.read_cell(tmp_path).runs == known.runs[:1] + (replace(known.runs[1], ledger=ANY),)
    (tmp_path / "a" / "evidence.csv").write_text("no curve")
    with pytest.raises(Damaged, match="evidence.csv"):
        one.read_cell(tmp_path)


@pytest.mark.parametrize(
    ("name", "basis"),
    [
        pytest.param(name, basis, marks=() if (name, basis) in FAST else pytest.mark.slow)
        for name, case in CASES.items()
        for basis in case.bases
    ],
)
def test_a_hard_case_holds(name, basis, tmp_path):
    verdict = run_case(CASES[name], basis, tmp_path)
    assert [f"{c.name} of {c.subject}: {c.value:.3g} > {c.tolerance:.3g}" for c in verdict.broken] == []
