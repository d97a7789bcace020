"""The study of interface rules: its measure, its finding, and that it finds what the literature says."""

from dataclasses import replace

import numpy as np
import pytest

from verify.quadrature_study import Study, Trial, excess_variation, finding, study
from verify.result import Snapshot


def profile(traction: np.ndarray) -> Snapshot:
    nothing = np.zeros_like(traction)
    grid = np.zeros((1, 2, 2))
    return Snapshot(0.4, 0.5, np.arange(traction.size) * 1.0, nothing, traction, nothing, grid, grid, grid)


def test_a_rise_and_a_dip_are_no_oscillation():
    x = np.linspace(0, 1, 200)
    smooth = np.where(x < 0.5, np.sin(2 * np.pi * x), 0.4 * np.sin(2 * np.pi * x))
    assert excess_variation(profile(4.0 * smooth), 4.0) == pytest.approx(0.0, abs=1e-12)
    assert excess_variation(profile(4.0 * smooth[100:]), 4.0) == pytest.approx(0.0, abs=1e-12), "from its peak on"
    saw = smooth + 0.1 * (-1.0) ** np.arange(200)
    assert 30.0 < excess_variation(profile(4.0 * saw), 4.0) < 40.0


@pytest.fixture(scope="module")
def found() -> Study:
    return study(rules=(("gauss", 2), ("lobatto", 4), ("lumped", None)), ductilities=(12.5, 50_000.0))


def test_lumping_cures_splines_on_a_stiff_interface_and_nothing_is_ill_on_a_soft_one(found):
    assert all(trial.status == "complete" for trial in found.trials) and len(found.trials) == 12
    assert all(trial.oscillation < 0.02 for trial in found.trials if trial.ductility == 12.5)
    stiff = {rule: found.of("nurbs", rule, n, 50_000.0) for rule, n in (("gauss", 2), ("lobatto", 4), ("lumped", None))}
    assert stiff["gauss"].oscillation > 1.0 and stiff["lobatto"].oscillation > 1.0
    assert stiff["lumped"].oscillation < 0.05 * stiff["gauss"].oscillation
    assert "with NURBS" in finding(found) and "lumping cures it" in finding(found).split(";")[0]


def test_a_rule_that_fails_is_told_and_costs_no_other(found, tmp_path):
    pytest.importorskip("matplotlib")
    from verify import report

    lost = Trial("nurbs", "gauss", 2, 50_000.0, float("nan"), None, "failed: ValueError: no mesh")
    trials = tuple(lost if (t.method, t.rule, t.ductility) == ("nurbs", "gauss", 50_000.0) else t for t in found.trials)
    report.write((), tmp_path / "report.html", {}, replace(found, trials=trials))
    text = (tmp_path / "report.html").read_text()
    assert "failed: ValueError: no mesh" in text and "NURBS, gauss, 2 points" in text
    assert text.count('id="quadrature-nurbs-t"') == 1 and 'href="#quadrature"' in text
