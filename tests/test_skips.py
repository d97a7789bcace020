"""What may be skipped: under ``./debond test`` a test or a file is skipped for a listed reason or has failed."""

import os
import runpy
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
import skips

HERE = Path(__file__).parent
TESTS = """
import pytest
def test_listed():
    pytest.skip("no right to mount")
@pytest.mark.skipif(True, reason="somebody switched it off")
def test_unlisted():
    pass
@pytest.mark.xfail
def test_that_may_fail():
    assert False
"""


def outcome(folder: Path, set_up: str) -> str:
    """The last line of pytest on a test that is skipped for a listed reason, one for another, and a whole file."""
    for name in ("conftest.py", "skips.py"):
        shutil.copy(HERE / name, folder)
    (folder / "pytest.ini").write_text("[pytest]\npythonpath = .\n")
    (folder / "test_some.py").write_text(TESTS)
    (folder / "test_whole.py").write_text("import pytest\npytest.importorskip('no_such_package')\n")
    words = [sys.executable, "-m", "pytest", "-q", "--continue-on-collection-errors", "-p", "no:cacheprovider"]
    environment = os.environ | {"DEBOND_TESTS_IN": set_up}
    ran = subprocess.run(words, cwd=folder, env=environment, capture_output=True, text=True, timeout=60)
    assert not set_up or "does not allow here: Skipped: somebody switched it off" in ran.stdout
    assert not set_up or "could not import 'no_such_package'" in ran.stdout
    return ran.stdout.strip().splitlines()[-1].partition(" in ")[0]


def test_what_is_not_listed_has_failed(tmp_path):
    assert outcome(tmp_path, "root") == "1 skipped, 1 xfailed, 2 errors"


def test_without_the_launcher_everything_may_be_skipped(tmp_path):
    assert outcome(tmp_path, "") == "3 skipped, 1 xfailed"


@pytest.mark.parametrize(
    ("reason", "root", "venv"),
    [
        ("Skipped: DOLFINx is not installed", False, True),
        ("Skipped: there is no Chromium", False, True),
        ("Skipped: needs fish", False, True),
        ("Skipped: could not import 'pyvista': libX11.so.6: cannot open shared object file", False, True),
        ("Skipped: could not import 'vtk': No module named 'vtk'", False, False),
        ("Skipped: no right to mount", True, True),
        ("Skipped: got empty parameter set for (name)", False, False),
    ],
)
def test_reasons_that_hold_without_a_root_do_not_hold_in_one(reason, root, venv, monkeypatch):
    for set_up, allowed in (("root", root), ("venv", venv)):
        monkeypatch.setenv("DEBOND_TESTS_IN", set_up)
        complaint = runpy.run_path(skips.__file__)["complaint"]
        assert bool(complaint(reason)) is not allowed, set_up


def test_files_that_belong_to_no_clone_are_missed_where_their_folder_is(monkeypatch):
    monkeypatch.setattr(skips, "SET_UP", "root")
    said = skips.complaint("Skipped: the file ring.iga is not at hand")
    assert bool(said) == skips.SHARED.is_dir()
