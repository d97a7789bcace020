"""What debond doctor finds, and what it says of what is not there."""

from __future__ import annotations

from types import SimpleNamespace

import pytest

from verify.cli import main
from verify.command_line import doctor
from verify.support.refusal import NotRun


def said(capsys: pytest.CaptureFixture) -> dict[str, str]:
    """The rows by their first word; it always ends well."""
    assert main(["doctor"]) == 0
    lines = capsys.readouterr().out.splitlines()
    return {line.split()[0].rstrip(":,"): line for line in lines if line.strip()}


def test_machine_packages_and_what_works(capsys):
    rows = said(capsys)
    for name in ("python", "cores", "memory", "threads", "cache", "dolfinx", "mpi4py", "mpirun", "report", "tspline"):
        assert name in rows
    assert set(doctor.PACKAGES) <= set(rows)
    import numpy

    assert numpy.__version__ in rows["numpy"]


def test_what_is_missing_comes_with_the_way_to_get_it(capsys, monkeypatch):
    gone = ("jinja2", "pyvista", "mpi4py")
    monkeypatch.setattr(doctor, "find_spec", lambda module: None if module in gone else object())
    monkeypatch.setattr(doctor, "dolfinx_installed", lambda: False)
    rows = said(capsys)
    assert "missing" in rows["jinja2"] and "pip install 'debond[report]'" in rows["jinja2"]
    assert rows["report"] == "report: does not work" and "missing" in rows["mpi4py"]
    assert "debond[fields,report]" in rows["The"]
    assert "conda" in rows and "Docker" in rows


def test_the_cache_folder_is_looked_at(capsys, monkeypatch, tmp_path):
    monkeypatch.setenv("DEBOND_CACHE", str(tmp_path / "not" / "there"))
    assert "GB free" in said(capsys)["cache"]
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("DEBOND_CACHE", str(tmp_path / "file" / "below"))
    assert "read-only" in said(capsys)["cache"]


def test_a_plugin_that_does_not_load_says_why():
    def missing() -> None:
        raise NotRun("not run: no module named bem")

    for load, words in ((missing, "does not work, no module named bem"), (lambda: None, "works (bem 1.0)")):
        assert doctor._state(SimpleNamespace(name="bem", package="bem 1.0", load=load)) == f"bem: {words}"


@pytest.mark.parametrize("found, known", [("0.9.0", True), ("0.11.0.post1", True), ("0.8.0", False), ("0.12.0", False)])
def test_the_window_of_dolfinx_is_told(found, known, capsys, monkeypatch):
    monkeypatch.setattr(doctor, "dolfinx_installed", lambda: True)
    monkeypatch.setattr(doctor, "package_version", lambda name: found)
    assert ("not tried" in next(doctor._dolfinx())) is not known
