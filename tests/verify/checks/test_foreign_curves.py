"""`debond verify SCENE --with FILE`: a curve from elsewhere is a method of the report, and its checks count."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from recorded_runs import recorded

from verify import verification
from verify.checks.foreign_curves import Curve, checks_of, joined, read_curves
from verify.checks.orders import ARMS, ARMS_SECOND
from verify.checks.table import overview
from verify.cli import main
from verify.curves.read import Reading, read_curve
from verify.methods.names import METHODS
from verify.result import Result
from verify.runs.store import STORE_FOLDER
from verify.scene.load import load_scene
from verify.studies.one_scene import planned
from verify.verdict import Check, Run, SceneReport

LINEAR = "dcb-czm1-linear"


@pytest.fixture
def beam():
    return recorded("beam")


@pytest.fixture
def folder(beam, tmp_path, monkeypatch):
    """A beam's curve as another code hands it over: half the opening downwards, in kilonewtons; and with errors."""
    monkeypatch.chdir(tmp_path)
    for name, factor, end in (("mycode", 1.0, 3.0), ("off", 1.02, 3.0), ("short", 1.0, 2.0)):
        kept = beam.opening <= end
        rows = zip(-beam.opening[kept] / 2, -1e-3 * factor * beam.load[kept], strict=True)
        lines = ["X, U2, RF2", *(f"0, {d:.9g}, {P:.9g}" for d, P in rows)]
        (tmp_path / f"{name}.csv").write_text("\n".join(lines) + "\n")
    (tmp_path / "empty.csv").write_text("")
    return tmp_path


AS = ("--opening", "U2", "--load", "RF2", "--opening-scale", "-2", "--load-scale", "-1e3")


def only(monkeypatch: pytest.MonkeyPatch, *methods: str) -> None:
    monkeypatch.setattr(
        verification, "planned", lambda *given: (job for job in planned(*given) if job.method in methods)
    )


def test_a_file_becomes_a_method_of_the_report(folder, monkeypatch, capsys):
    pytest.importorskip("matplotlib")
    pytest.importorskip("jinja2")
    only(monkeypatch, "beam", "lefm")
    assert main(["verify", LINEAR, "--no-ladder", "--out", "out", "--jobs", "1", "--with", "mycode.csv", *AS]) == 0
    said = capsys.readouterr().out
    assert re.search(r"beam-curve +analytical +\d\.\de-\d\d", said) and "mycode" in said.splitlines()[0]
    page = (folder / "out" / "report.html").read_text()
    (row,) = (row for row in re.findall("<tr>.*?</tr>", page, re.DOTALL) if "mycode</a></th>" in row)
    assert re.search(r"</th><td>0\.0\d+\s%</td>", row), "its distance to the beam"
    assert re.search(r"mycode(</a>)? / (<a[^>]*>)?beam", page) and "stroke: var(--ink)" in page

    assert "its code knows" in page, "what is behind a file nobody tells"

    before = sorted(path for path in (folder / "out" / STORE_FOLDER).iterdir() if path.is_dir())
    times = [path.stat().st_mtime_ns for path in before]
    assert main(["verify", LINEAR, "--no-ladder", "--out", "out", "--jobs", "1", "--with", "off.csv", *AS]) == 1
    said = capsys.readouterr()
    assert "4 of 4 runs are at hand" in said.err
    assert re.search(rf"broken +{LINEAR} +analytical +beam-curve +off / beam +2\.0\de-02", said.out)
    assert sorted(path for path in (folder / "out" / STORE_FOLDER).iterdir() if path.is_dir()) == before
    assert [path.stat().st_mtime_ns for path in before] == times, "nothing was computed anew"


def test_a_curve_that_ends_early_is_judged_as_far_as_it_goes(folder, beam, monkeypatch, capsys):
    monkeypatch.setattr(verification, "write_page", lambda *what: None)
    only(monkeypatch, "lefm")
    last = beam.opening[beam.opening <= 2.0].max()
    assert main(["verify", LINEAR, "--no-ladder", "--out", "out", "--jobs", "1", "--with", "mine=short.csv", *AS]) == 0
    said = capsys.readouterr().out
    assert re.search(rf"not covered .* cross-code +end +mine +{1 - last / 3:.2e}", said)
    assert f"mine: judged from the opening 0 to {last:.4g}, {100 * last / 3:.3g} % of the programme" in said
    assert "not covered: end, certified" in said
    assert main(
        ["verify", LINEAR, "--no-ladder", "--strict", "--out", "out", "--jobs", "1", "--with", "mine=short.csv", *AS]
    )


def test_every_code_that_is_there_judges(beam):
    """Within half a percent of the codes and of the published values it holds, beyond it does not; each of its kind."""
    scene = load_scene("compdam-dcb")
    opening = np.linspace(0.0, max(scene.load.opening), 200)
    load = 7.96 * np.minimum(opening / 1.2, (1.2 / np.maximum(opening, 0.1)) ** 0.457)
    others = {method: Result(method, {"opening": opening, "load": load}) for method in (*METHODS, "dolfinx-second")}
    for factor, holds in ((1.004, True), (1.006, False)):
        found = checks_of(scene, "mine", Result("mine", {"opening": opening, "load": factor * load}), others)
        judged = {(check.name, check.subject.partition(" / ")[2]): check for check in found}
        for code in ("tspline", "nurbs", "dolfinx"):
            for name in ("curve", "peak"):
                check = judged[name, code]
                assert check.passed == holds and check.kind == "cross-code"
                assert check.value == pytest.approx(factor - 1)
        assert ("curve", "lagrange") not in judged and ("curve", "lefm") not in judged
        assert judged["published-peak", ""].value == pytest.approx(
            0.0 if factor < 1 else factor * 7.96 / 8.0 - 1, abs=2e-2
        )
        assert {check.kind for check in found} <= {"cross-code", "analytical"}
    beams = [check for check in found if check.name == "beam-curve"]
    assert [(check.kind, check.tolerance) for check in beams] in ([("analytical", 0.005)], [("analytical", 0.002)], [])


def test_the_curve_is_kept_as_it_was_read_and_never_in_the_folder_of_a_run(folder, beam):
    (curve,) = read_curves(["mycode.csv"], Reading("U2", "RF2", -2.0, -1e3))
    (folder / "out" / LINEAR).mkdir(parents=True)
    (folder / "out" / "of-a-run").mkdir()
    (folder / "out" / LINEAR / "mycode").symlink_to(folder / "out" / "of-a-run")
    for _ in range(2):
        found = joined(SceneReport(load_scene(LINEAR), (), ()), [curve], Path("out"))
    kept = read_curve(folder / "out" / found.runs[-1].folder)
    assert np.array_equal(kept, (curve.result.opening, curve.result.load)) and np.allclose(kept[1], beam.load)
    assert not list((folder / "out" / "of-a-run").iterdir())


def test_the_report_says_how_to_compare_it(folder, beam):
    (curve,) = read_curves(["mycode.csv"], Reading("U2", "RF2", -2.0, -1e3))
    report = SceneReport(load_scene(LINEAR), (Run("NURBS", "nurbs", beam, folder=f"{LINEAR}/nurbs"),), ())
    found = joined(report, [curve], Path("out"))
    words = f"debond compare mycode.csv out/{LINEAR}/nurbs --opening-a U2 --load-a RF2 "
    assert found.runs[-1].command == words + "--opening-scale-a -2.0 --load-scale-a -1000.0"
    assert np.allclose(found.runs[-1].result.load, beam.load) and found.runs[-1].method == "mycode"
    assert joined(report, [], Path("out")) == report


@pytest.mark.parametrize("order", [1, -1])
def test_of_several_codes_the_overview_shows_the_worst(order):
    found = [
        Check("curve", "mine / nurbs", 0.004, 0.005, "cross-code", ""),
        Check("curve", "mine / tspline", 0.009, 0.005, "cross-code", ""),
        Check("curve", "mine / dolfinx", 0.001, 0.005, "cross-code", ""),
    ]
    (row,) = [
        line for line in overview([SceneReport(load_scene(LINEAR), (), tuple(found[::order]))]) if "curve" in line
    ]
    assert "9.0e-03!" in row


def test_names_come_from_files_or_are_given(folder):
    (folder / "run").mkdir()
    (folder / "run" / "curve.csv").write_text("opening,load\n0,0\n1,1\n2,1\n")
    (folder / "a=b.csv").write_text("0 0\n1 1\n")
    (folder / "my code (2).txt").write_text("0 0\n1 1\n")
    words = ["run", "other=run/curve.csv", "a=b.csv", "my code (2).txt"]
    assert [curve.name for curve in read_curves(words, Reading())] == ["run", "other", "a-b", "my-code-2-"]


REFUSED = {
    f"verify {LINEAR} --with missing.csv": "missing.csv: must be a file with a curve",
    f"verify {LINEAR} --with empty.csv": "empty.csv: must hold a curve of at least 2 points, got an empty file",
    f"verify {LINEAR} --with mycode.csv": "the header must name opening and load, got X, U2, RF2",
    f"verify {LINEAR} --with nurbs=mycode.csv {' '.join(AS)}": "a name must not be a method's, got 'nurbs'",
    f"verify {LINEAR} --with dolfinx-p3=mycode.csv {' '.join(AS)}": "a name must not be a method's, got 'dolfinx-p3'",
    f"verify {LINEAR} --with a=mycode.csv --with a=off.csv {' '.join(AS)}": "must not be another curve's, got 'a'",
    f"verify {LINEAR} --with a/b=mycode.csv {' '.join(AS)}": "a name must be of letters, digits",
    f"verify {LINEAR} dcb-czm2 --with mycode.csv {' '.join(AS)}": "needs one SCENE, which its curve is of, got 2",
    f"verify --with mycode.csv {' '.join(AS)}": "--with: needs one SCENE",
    f"verify {LINEAR} --load RF2": "--with: is missing, its FILE is what --opening, --load and their scales are about",
    f"verify {LINEAR} --with mycode.csv --load-scale 0": "--load-scale: must be a finite number other than 0",
}


@pytest.mark.parametrize("line", REFUSED)
def test_what_is_no_curve_is_refused_before_any_run(line, folder, capsys):
    before = sorted(folder.rglob("*"))
    try:
        code = main(line.split())
    except SystemExit as end:
        code = end.code
    said = capsys.readouterr()
    assert code == 2 and REFUSED[line] in said.err and "Traceback" not in said.err
    assert sorted(folder.rglob("*")) == before


@pytest.mark.parametrize(("first", "said"), [(0.0067, 0), (0.1, 1)])
def test_a_curve_need_not_begin_at_zero(folder, beam, first, said):
    """Where it begins late, that is said."""
    kept = beam.opening >= first
    d, P = np.append(first, beam.opening[kept]), np.append(np.interp(first, beam.opening, beam.load), beam.load[kept])
    curve = Curve("mine", Path("mine.csv"), Reading(), Result("mine", {"opening": d, "load": P}))
    runs = tuple(Run(name, "beam", beam, folder=f"{LINEAR}/{name}") for name in ("beam", ARMS, ARMS_SECOND))
    report = SceneReport(load_scene(LINEAR), runs, ())
    found = joined(report, [curve], Path("out"))
    assert [check.name for check in found.checks if not check.passed] == []
    assert len([check for check in found.checks if check.kind != "certified"]) == 5
    *late, load = found.remarks
    assert len(late) == said and all(
        "judged from the opening 0.1 to 3, 96.7 % of the programme" in text for text in late
    )
    assert "the load is spread evenly" in load and "the peak load by less than 0.01 %" in load


def test_a_curve_may_end_where_the_specimen_comes_apart():
    """With the run that has separated, or earlier where it bears nothing any more, but not while it bears a load."""
    scene = load_scene(LINEAR, ["load.opening=[1.0, 0.2, 6.0]"])
    d = np.concatenate((np.linspace(0.0, 1.0, 51), np.linspace(1.0, 0.2, 41)[1:], np.linspace(0.2, 5.0, 241)[1:]))
    grown = np.maximum.accumulate(d)
    load = d / (0.1 + grown**2) * np.clip(4.0 - grown, 1e-4, 1.0)
    run = Result("nurbs", {"opening": d, "load": load}, ending="separated at opening 5")
    for end, broken in ((5.0, set()), (4.5, set()), (3.5, {"end"})):
        kept = (d <= end) | (np.arange(d.size) < 100)
        mine = Result("mine", {"opening": d[kept], "load": load[kept]})
        assert {check.name for check in checks_of(scene, "mine", mine, {"nurbs": run}) if not check.passed} == broken
    whole = replace(run, ending="")
    assert "end" in {check.name for check in checks_of(scene, "mine", run, {"nurbs": whole}) if not check.passed}


def test_what_pressed_faces_bear_makes_no_load_vanish():
    """A curve that ends where it bears half its peak has not come apart, whatever it bore when it was pressed."""
    scene = load_scene(LINEAR, ["load.opening=[-0.01, 6.0]"])
    d = np.concatenate((np.linspace(0.0, -0.01, 11), np.linspace(-0.01, 0.0, 11)[1:], np.linspace(0.0, 5.0, 251)[1:]))
    load = np.where(d < 0.0, 1e4 * d, np.clip(5.0 - d, 0.0, np.minimum(d, 1.0)))
    run = Result("nurbs", {"opening": d, "load": load}, ending="separated at opening 5")
    mine = Result("mine", {"opening": d[:-25], "load": load[:-25]})
    broken = {check.name for check in checks_of(scene, "mine", mine, {"nurbs": run}) if not check.passed}
    assert mine.load[-1] == pytest.approx(0.5) and broken == {"end"}
    assert all(check.passed for check in checks_of(scene, "mine", run, {"nurbs": run}))
