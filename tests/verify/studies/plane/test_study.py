"""Plane problems on mesh files: which one is posed, what is checked, and how a file is refused."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from doctored_meshes import SMOOTH, arch, function_halved, function_scaled, point_unused
from iga_files import from_mesh

from iga.files.iga_format import write_iga
from iga.tsplines.unstructured import polygon_mesh
from tests.iga.elements.test_plane_elasticity import ring, square_mesh
from verify.cli import REFUSED, main
from verify.command_line.answers import FAILED
from verify.studies.plane import study as plane_study
from verify.studies.plane.errors import Errors
from verify.studies.plane.study import Level, _checks, lines, load_plate, settled, study
from verify.support.refusal import Refusal

FILES = Path(__file__).parents[5] / "shared" / "iga"


@pytest.fixture
def written(tmp_path, monkeypatch):
    """A function that writes a mesh as a file and returns its path; refinement ends early."""
    monkeypatch.setattr(plane_study, "PLANE_LIMITS", plane_study.Limits(unknowns=3000))

    def write(mesh, name="body"):
        path = tmp_path / f"{name}.iga"
        write_iga(from_mesh(mesh), path)
        return str(path)

    return write


@pytest.mark.parametrize(
    ("mesh", "hole"),
    [
        (lambda: ring(2, 0.7, 2.0), 0.7),
        (lambda: moved(ring(2, 0.7, 2.0), [0.1, 0.0]), None),
        (lambda: square_mesh(2), None),
        (lambda: moved(square_mesh(2), [1.0, -0.5]), None),
        (lambda: polygon_mesh(6, 2), None),
    ],
    ids=["ring", "ring elsewhere", "corner at the origin", "beside the origin", "around the origin"],
)
def test_a_mesh_around_a_circle_is_a_plate_with_a_hole(mesh, hole, written):
    plate = load_plate(written(mesh()))
    assert plate.hole == (None if hole is None else pytest.approx(hole, rel=1e-12))
    assert plate.name == "body" and len(plate.boundary) == 1


def moved(mesh, by):
    return replace(mesh, P_AI=mesh.P_AI + by)


@pytest.mark.parametrize(
    ("mesh", "problem"), [(lambda: ring(3), "Kirsch"), (lambda: polygon_mesh(5, 2), "smooth")], ids=["ring", "pentagon"]
)
def test_what_is_checked_holds(mesh, problem, written):
    found = study(load_plate(written(mesh())))
    assert problem in found.problem and found.order == 4
    assert {check.name for check in found.checks} >= {"patch-test", "nested-energy", "exact-field"}
    assert all(check.passed for check in found.checks)
    assert [level.name for level in found.levels][:3] == ["the file", "Bezier elements", "each cut into 4"]
    assert np.isnan(found.levels[1].rate) and found.levels[2].rate == pytest.approx(4.0, abs=0.7)
    assert np.max(np.abs(found.found_euv - found.exact_euv)) < 0.2 * np.max(np.abs(found.exact_euv))
    assert len(lines(found)) == 1 + len(found.levels)


@pytest.mark.parametrize("name", ["plate_with_hole", "square_unstructured"])
def test_real_files(name, monkeypatch):
    path = FILES / f"{name}.iga"
    if not path.exists():
        pytest.skip(f"the file {path.name} is not at hand")
    monkeypatch.setattr(plane_study, "PLANE_LIMITS", plane_study.Limits(unknowns=20_000))
    plate = load_plate(str(path))
    found = study(plate)
    assert (plate.hole is None) == (name == "square_unstructured")
    assert all(check.passed for check in found.checks) and len(found.levels) == 3
    assert found.levels[-1].errors.displacement < 2e-5


def test_a_rate_is_judged_once_it_has_settled():
    def levels(*rates):
        return tuple(Level("", 1, 1, Errors(1.0, 1.0, 1.0), rate, rate) for rate in rates)

    nan = float("nan")
    assert settled(levels(nan, nan, 3.9, 4.0)) and not settled(levels(nan, nan, 3.3, 3.7))
    assert not settled(levels(nan, nan, 4.0)) and not settled(levels(nan))


def test_files_that_are_refused(written, tmp_path):
    folded = square_mesh(2)
    path = written(replace(folded, P_AI=folded.P_AI * np.where(np.arange(25) == 12, -3.0, 1.0)[:, None]), "folded")
    broken = tmp_path / "broken.iga"
    broken.write_text("type plane\nnodeN 3\n")
    for source in (path, str(broken), str(tmp_path / "absent.iga")):
        with pytest.raises(Refusal, match=Path(source).name):
            load_plate(source)
        assert main(["verify", source, "--out", str(tmp_path / "out")]) == REFUSED


def test_meshes_that_are_no_body_are_refused(written):
    for doctor, words in (SMOOTH[kind] for kind in ("an element twice", "two halves", "ids of one element exchanged")):
        with pytest.raises(Refusal, match=f"body.iga: .*{words}"):
            load_plate(written(doctor(replace(arch(), chains={}))))
    for doctor in (function_halved, point_unused):
        with pytest.raises(Refusal, match=r"body.iga: the functions are dependent: rank 49 of 50"):
            load_plate(written(doctor(arch())))


def test_functions_that_miss_one_fail_a_check(written):
    """The rational functions divide by their sum: all else holds."""
    found = study(load_plate(written(function_scaled(replace(arch(), chains={})))))
    (missed,) = [check for check in found.checks if not check.passed]
    assert (missed.name, missed.kind) == ("sum-of-functions", "exact")
    assert missed.value == pytest.approx(4.4e-9, rel=0.1) and missed.tolerance == 1e-10


def test_verify_takes_files_and_counts_their_checks(written, tmp_path, monkeypatch, capsys):
    pytest.importorskip("matplotlib")
    pytest.importorskip("jinja2")
    path, out = written(polygon_mesh(3, 2), "triangle"), tmp_path / "out"
    assert main(["verify", path, "--out", str(out)]) == 0
    said, page = capsys.readouterr().out, (out / "report.html").read_text()
    assert "triangle: smooth field" in said and "patch-test" in said
    assert "on 1 plane problem" in page and 'id="plane-1-stress-t"' in page and "each cut into 4" in page
    assert page.count("✓ holds") >= 3 and "dcb-czm1" not in page
    monkeypatch.setattr(plane_study, "PLANE_LIMITS", plane_study.Limits(unknowns=3000, patch=0.0))
    assert main(["verify", path, "--out", str(out)]) == FAILED
    assert re.search("broken +triangle", capsys.readouterr().out)
    assert 'href="#plane-1-checks">triangle</a>' in (out / "report.html").read_text()


def test_two_files_of_one_name_are_refused(written, tmp_path, capsys):
    path = written(square_mesh(2))
    assert main(["verify", path, path, "--out", str(tmp_path)]) == REFUSED
    assert "different names, got 'body' more than once" in capsys.readouterr().err


#: Check, the part that decides it, and what that may be at the most.
ALLOWED = [
    ("patch-test", 1e-10), ("nested-energy", 1e-6), ("exact-field", 1e-3), ("rate", 0.25),
]  # fmt: skip


@pytest.mark.parametrize(("name", "most"), ALLOWED, ids=[name for name, _ in ALLOWED])
@pytest.mark.parametrize("part", [0.99, 1.01])
def test_what_a_plane_problem_may_be_off_by(name, most, part):
    """Everything else is as it should be: three meshes, each an eighth as wrong as the one before."""
    off = {key: part * most if key == name else 0.0 for key, _ in ALLOWED}
    energies = np.array([1.0, 0.5, 0.5 * (1.0 + off["nested-energy"]) if name == "nested-energy" else 0.25])
    finest = off["exact-field"] or 1e-5
    found = tuple(Level("", 1, 1, Errors(finest, energy, energy), 4.0 + off["rate"], 4.0) for energy in energies)
    checks = {check.name: check for check in _checks("x", Errors(off["patch-test"], 0.0, 0.0), found, 4)}
    assert set(checks) == {key for key, _ in ALLOWED}
    assert {key for key, check in checks.items() if not check.passed} == ({name} if part > 1.0 else set())
    below = {check.name: check for check in _checks("x", Errors(0.0, 0.0, off["patch-test"]), found, 4)}
    assert below["patch-test"].value == off["patch-test"], "stress counts as displacement does"


@pytest.mark.parametrize(("apart", "judged"), [(0.249, True), (-0.249, True), (0.251, False), (-0.251, False)])
def test_a_rate_has_settled_where_the_last_two_agree_to_a_quarter(apart, judged):
    found = [Level("", 1, 1, Errors(1e-5, 0.1, 0.1), rate, 4.0) for rate in (float("nan"), 4.0, 4.0 + apart)]
    assert ("rate" in {check.name for check in _checks("x", Errors(0.0, 0.0, 0.0), tuple(found), 4)}) == judged
