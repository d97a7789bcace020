"""Comparisons and reports of results at hand, without a command."""

from dataclasses import replace

import numpy as np
import pytest
from made_up_runs import made_up

import verify
from verify import face
from verify.curves.read import CurveError, Reading

RUN = verify.Result("nurbs", {"opening": np.linspace(0.0, 3.0, 31), "load": np.linspace(0.0, 3.0, 31) ** 0.5})


def test_results_pairs_and_tables_are_compared_by_their_names():
    higher = replace(RUN, method="mine", steps={**RUN.steps, "load": 1.01 * RUN.load})
    found = verify.compare(higher, RUN)
    assert found.names == ("mine", "nurbs") and found.curve_error == pytest.approx(0.01)
    assert verify.compare((RUN.opening, RUN.load), RUN).names == ("A", "nurbs")
    assert verify.compare(RUN, RUN).names == ("A", "B")
    twice = {"u": 2 * RUN.opening, "load": RUN.load}
    assert verify.compare(twice, RUN, readings=(Reading(opening="u", opening_scale=0.5), None)).curve_error < 1e-12
    with pytest.raises(CurveError, match="mine: opening and load must be of one length"):
        verify.compare(replace(RUN, method="mine", steps={"opening": [0, 1], "load": [0]}), RUN)


def test_a_comparison_says_whether_curves_agree():
    found = verify.compare((RUN.opening, 1.01 * RUN.load), RUN)
    assert found.agrees(curve=0.011) and found.agrees(peak=0.011, energy=0.011) and not found.agrees(curve=0.009)
    with pytest.raises(TypeError, match="needs a tolerance"):
        found.agrees()
    assert repr(found).startswith("<Comparison: A against nurbs, curve error 1 %, peak load +1 %, energy +1 %, largest")


def test_a_report_of_results_at_hand_has_their_folders_and_checks(tmp_path):
    pytest.importorskip("matplotlib")
    pytest.importorskip("jinja2")
    scene = verify.load_scene("dcb-czm1", ["discretization.dofs=700"])
    runs = {"nurbs": made_up("nurbs", 0.0, 1.0, 700, 40), "nurbs-350": made_up("nurbs", 3e-3, 1.0, 350, 20)}
    page = verify.write_report(scene, runs, tmp_path / "out")
    text = page.read_text()
    for name, result in runs.items():
        folder = page.parent / "dcb-czm1" / name
        assert f'href="./dcb-czm1/{name}/"' in text and (folder / "result.json").exists()
        assert np.allclose(verify.read_curve(folder)[1], result.load, rtol=1e-9)
    assert "energy-ledger" in text and "debond solve" not in text


def test_scenes_are_loaded_and_verified(monkeypatch, tmp_path):
    asked = []
    monkeypatch.setattr(face, "verify", lambda *what: bool(asked.append(what)) or True)
    assert verify.verify_scenes(["dcb-czm1", "peel-60"], tmp_path, jobs=2) is True
    ((subjects, out, jobs),) = asked
    assert [(source, scene.name) for source, scene in subjects.scenes] == [("dcb-czm1",) * 2, ("peel-60",) * 2]
    assert (out, jobs, subjects.full) == (tmp_path, 2, False)
    with pytest.raises(ValueError, match="no-such-scene"):
        verify.verify_scenes(["no-such-scene"], tmp_path)
