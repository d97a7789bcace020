"""Hard cases as they are run: what is tried, how their processes end, which verdicts count."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from unittest.mock import ANY

import made_up_studies
import pytest

from tests.verify.studies.hard.test_hard import FAKE, stub
from verify.methods.names import Unsuitable
from verify.runs.sweep import Done
from verify.scene.load import load_scene
from verify.studies.hard import one, suite
from verify.studies.hard.cases import CASES
from verify.support.checked_files import Damaged


def test_what_is_tried_is_what_the_page_tells() -> None:
    """Penalties over eight decades, strengths, the way of a programme that closes the crack."""
    names = [f"penalty-1e{n}" for n in range(2, 11)] + [f"finite-1e{n}" for n in (2, 6, 8, 10)]
    tried = CASES["penalty-sweep"].variants()
    assert [one.name for one in tried] == names
    assert [one.scene.interface.penalty for one in tried] == [float(name[name.index("1e") :]) for name in names]
    assert [one.scene.effects.kinematics for one in tried] == ["linear"] * 9 + ["finite"] * 4
    strengths = [one.scene.interface.strength for one in CASES["under-resolved"].variants()]
    assert strengths == [10.0, 20.0, 40.0]
    ways = {one.name: one.scene.load.opening for one in CASES["unload-reload"].variants()}
    assert ways["closing-linear"] == ways["closing-finite"] == (1.5, -0.1, 1.5, 3.0)
    assert ways["to-zero-finite"] == (1.5, 0.0, 1.5, 3.0) and ways["monotone-linear"] == (3.0,)


def test_no_other_run_may_stop() -> None:
    assert [case.name for case in CASES.values() if case.may_stop] == ["peel-as-printed"]


def test_the_process_of_a_case_ends_with_its_verdict(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[tuple] = []
    for passed in (True, False):
        monkeypatch.setattr(one, "run_case", lambda *what, p=passed: asked.append(what) or SimpleNamespace(passed=p))
        assert one.main(["units", "nurbs", str(tmp_path)]) == (0 if passed else 1)
    assert asked == [(CASES["units"], "nurbs", tmp_path)] * 2


def test_a_verdict_counts_with_the_runs_that_it_is_about(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
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


def test_what_a_process_leaves_is_its_verdict_or_why_there_is_none(tmp_path: Path) -> None:
    case = CASES["coarse-czm2"]
    lost = suite._cell(case, "nurbs", Done(suite.task(case, "nurbs"), tmp_path, "failed: signal 9"))
    assert (lost.verdict, lost.why, lost.passed) == (None, "failed: signal 9", False)
    made_up_studies.hard(tmp_path)
    found = suite._cell(case, "nurbs", Done(suite.task(case, "nurbs"), tmp_path / "coarse-czm2" / "nurbs"))
    assert found.passed and (found.verdict.case, found.verdict.basis) == ("coarse-czm2", "nurbs")
    bad = suite._cell(case, "tspline", Done(suite.task(case, "tspline"), tmp_path / "coarse-czm2" / "tspline"))
    assert bad.verdict is not None and not bad.passed


def test_units_of_a_case_are_those_that_it_names() -> None:
    """One specimen in newtons and millimetres, as it is, in newtons and metres, in kilonewtons and inches."""
    plain, metres, inches = (case.scene for case in CASES["units"].variants())
    assert plain == load_scene("dcb-czm1", ["discretization.dofs=280"]).model_copy(update={"units": plain.units})
    assert [case.units for case in (plain, metres, inches)] == ["N, mm, MPa", "N, m, Pa", "kN, in, kN/in2"]
    for case, force, length in ((metres, 1.0, 1e-3), (inches, 1e-3, 1.0 / 25.4)):
        found = (case.specimen.precrack, case.specimen.width, case.load.opening[0], case.material.poisson)
        assert found == pytest.approx((4.0 * length, length, 3.0 * length, plain.material.poisson))
        assert case.material.young == pytest.approx(plain.material.young * force / length**2)
        assert case.interface.strength == pytest.approx(4.0 * force / length**2)
        assert case.interface.toughness == pytest.approx(0.1 * force / length)
        assert case.interface.penalty == pytest.approx(plain.interface.penalty * force / length**3)
        assert case.interface.ductility == plain.interface.ductility


def test_a_case_is_moved_turned_and_mirrored_one_by_one_and_all_at_once() -> None:
    poses = {case.name: case.scene.pose for case in CASES["pose"].variants()}
    told = {name: (pose.angle, pose.mirror, tuple(pose.shift)) for name, pose in poses.items()}
    far = (1e4, 1e4)
    assert told == {
        "plain": (0.0, False, (0.0, 0.0)),
        "rotated": (37.0, False, (0.0, 0.0)),
        "mirrored": (0.0, True, (0.0, 0.0)),
        "moved": (0.0, False, far),
        "all": (37.0, True, far),
    }


def test_noise_is_a_little_of_every_number_and_never_the_same() -> None:
    plain, *noisy = (case.scene for case in CASES["noise"].variants())
    youngs = [case.material.young / plain.material.young - 1.0 for case in noisy]
    assert len(noisy) == 20 and len(set(youngs)) > 10 and 0.0 < max(map(abs, youngs)) < 1.3e-14
    assert all(case.interface.strength == pytest.approx(4.0, rel=1.1e-14) for case in noisy)
    assert {case.discretization.degree for case in noisy} == {plain.discretization.degree}
