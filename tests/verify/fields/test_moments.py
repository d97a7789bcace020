"""More openings for the slider of the report: the same fields as in a snapshot, and nothing that a run pays for."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from made_up_runs import scene_report, snapshot

from verify.fields.moments import FRACTIONS, Moments
from verify.fields.moments import snapshot as drawn
from verify.methods.solve import prepare, solve
from verify.runs.folder import read_result
from verify.runs.run import Keep, run
from verify.scene.load import load_scene

SMALL = ("discretization.dofs=600", "discretization.steps=60")


@pytest.mark.parametrize("name", ["dcb-czm1-linear", "dcb-czm1", "peel-soft"])
def test_a_moment_is_a_snapshot_at_fewer_points(name: str) -> None:
    """At the corners of the elements: bodies, stress, and everything on the interface."""
    kept = []
    result = solve(load_scene(name, SMALL), "nurbs", on_frame=lambda opening, make: kept.append(make))
    whole, coarse = result.snapshots[-1], drawn(kept[-1]())
    assert (coarse.opening, coarse.load) == (whole.opening, whole.load)
    for key in ("s_q", "gap_q", "traction_q", "damage_q"):
        assert np.array_equal(getattr(coarse, key), getattr(whole, key))
    for key, tolerance in (("X_euvi", 1e-6), ("u_euvi", 1e-6), ("stress_euv", 0.02)):
        a, b = getattr(coarse, key)[:, ::2, ::2], getattr(whole, key)[:, ::3, ::3]
        assert a.shape == b.shape and np.abs(a - b).max() <= tolerance * np.abs(b).max(), key


def test_moments_lie_between_the_snapshots_and_leave_the_path_as_it_is(tmp_path: Path) -> None:
    scene = load_scene("dcb-czm1-linear", SMALL)
    run(prepare(scene, "nurbs"), tmp_path / "plain")
    run(prepare(scene, "nurbs"), tmp_path / "with", keep=Keep(fields=True))
    plain, kept = ((tmp_path / name / "curve.csv").read_text() for name in ("plain", "with"))
    assert plain == kept and not (tmp_path / "plain" / "moments.npz").exists()
    found = read_result(tmp_path / "with")
    assert len(found.snapshots) == 4 and len(found.between) == len(FRACTIONS)
    step = np.diff(found.opening).max()
    for moment, part in zip(found.between, FRACTIONS, strict=True):
        assert 0.0 <= moment.opening - 3.0 * part <= step
    run(prepare(scene, "lefm"), tmp_path / "with")
    assert not (tmp_path / "with" / "moments.npz").exists(), "nothing of an earlier run is left"


def test_frames_are_made_when_the_run_is_over() -> None:
    moments = Moments(load_scene("dcb-czm1"))

    def make() -> dict:
        raise AssertionError("not to be called")

    for opening in np.linspace(0.0, 3.0, 50):
        moments(opening, make)
    assert len(moments._makes) == len(FRACTIONS)


def test_a_specimen_in_another_place_has_none() -> None:
    moments = Moments(load_scene("dcb-czm1", ["pose.angle=30"]))
    moments(3.0, lambda: {})
    assert moments.snapshots() == ()


def test_the_slider_has_them_between_the_others(tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    pytest.importorskip("jinja2")
    from verify import report

    given = scene_report()
    lead, *others = given.runs
    between = tuple(snapshot(opening, 5.0 + opening, 112, 0.0) for opening in (0.8, 1.7, 2.4))
    runs = (replace(lead, result=replace(lead.result, between=between)), *others)
    report.write(report.Findings((replace(given, runs=runs),), {}), tmp_path / "report.html")
    page = (tmp_path / "report.html").read_text()
    assert re.findall(r'data-opening="([\d.]+)', page) == ["0.62", "0.8", "1", "1.7", "2.4", "3"]
    assert 'max="5"' in page
    assert page.count(f"normal traction of {lead.label} along") == 3
    assert page.count("normal traction of all runs with fields along") == 3
    from verify.report.section import section

    bare = section(replace(given, runs=runs), "scene", between=False)
    assert [frame.opening for frame in bare.frames] == [frame.opening for frame in section(given, "scene").frames]
    assert len(bare.frames) == 3


def test_pages_of_few_scenes_have_them(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("matplotlib")
    pytest.importorskip("jinja2")
    from verify.report import Findings, page

    asked: list[tuple[str, bool]] = []
    monkeypatch.setattr(page, "at_once", lambda work, items: tuple(map(work, items)))  # in this process
    monkeypatch.setattr(page, "still", lambda report, anchor: SimpleNamespace(frames=()))
    monkeypatch.setattr(page, "moving", lambda report, anchor, between: asked.append((anchor, between)))
    monkeypatch.setattr(page, "replace", lambda scene, frames: scene)
    monkeypatch.setattr(page, "summarise", lambda sections, planes, prices: SimpleNamespace(prices=()))
    monkeypatch.setattr(page, "_scripts", lambda sections, studies: ())
    monkeypatch.setattr(page, "rendered", lambda *words, **parts: "page")
    for number, between in ((1, True), (5, True), (6, False)):
        asked.clear()
        page.write(Findings((scene_report(),) * number, {}), tmp_path / "of" / "all" / "report.html")
        assert asked == [(f"scene-{i + 1}", between) for i in range(number)]
        assert [path.name for path in (tmp_path / "of" / "all").iterdir()] == ["report.html"], (
            "Markdown only if asked for"
        )
