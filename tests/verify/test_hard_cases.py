"""Hard cases as they are run: what is tried, how their processes end, which verdicts count."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from unittest.mock import ANY

import made_up_studies
import pytest
from test_hard import FAKE, stub

from verify.hard import one, suite
from verify.hard.cases import CASES
from verify.methods import Unsuitable
from verify.plain import Damaged
from verify.schema import Scene
from verify.sweep import Done


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

    def refusing(scene: Scene, *words, **options) -> tuple:
        if scene.load.opening[-1] == 2.0:
            raise Unsuitable("too coarse")
        return run(scene, *words, **options)

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
