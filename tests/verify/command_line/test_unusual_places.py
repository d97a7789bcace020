"""Names and files that no work can be done with are refused in a sentence, and nothing of others is overwritten."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from iga.files import iga_reader
from verify.cli import REFUSED, main
from verify.support import checked_files

LEFM = ["solve", "dcb-czm1", "--method", "lefm"]
LONG_KEY = ".".join(["a"] * 50_000)


def refused(words: list[str], capsys: pytest.CaptureFixture) -> str:
    """The sentence of a refusal, also one of argparse."""
    try:
        assert main(words) == REFUSED
    except SystemExit as end:
        assert end.code == REFUSED
    return capsys.readouterr().err


def test_files_of_others_stay(tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    own = tmp_path / "curve.csv"
    own.write_text("opening,load\n0,0\n")
    assert "curve.csv" in refused([*LEFM, "--out", str(tmp_path)], capsys)
    assert own.read_text() == "opening,load\n0,0\n"
    for _ in range(2):  # those of a run are replaced
        assert main([*LEFM, "--out", str(tmp_path / "run")]) == 0


@pytest.mark.parametrize("words", [[*LEFM, "--out", ""], ["verify", "dcb-czm1", "--dry-run", "--with", "a="]])
def test_an_empty_name_is_not_the_working_folder(words: list[str], capsys: pytest.CaptureFixture) -> None:
    assert f"{words[-2]}: must be" in refused(words, capsys)


def test_a_scene_is_not_named_like_a_file_of_the_report(capsys: pytest.CaptureFixture) -> None:
    assert "name: must be a name that is not one of a file" in refused([*LEFM, "--set", 'name="report.html"'], capsys)


def test_keys_without_end_are_refused(tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    scene = tmp_path / "scene.toml"
    for text in (f"{LONG_KEY} = 1", f"[{LONG_KEY}]", "x = {" + LONG_KEY[:99] + " = 1}"):
        scene.write_text(text)
        assert "keys of at most 20 parts" in refused(["solve", str(scene)], capsys)
    assert "at most 20 parts, got 50000" in refused([*LEFM, "--set", f"{LONG_KEY}=1"], capsys)


@pytest.mark.parametrize(
    "words",
    [["solve", "/dev/zero"], ["compare", "/dev/zero", "/dev/zero"], ["mesh", "/dev/zero"],
     ["law", "dcb-czm1", "--with", "/dev/zero"], ["verify", "dcb-czm1", "--dry-run", "--with", "/dev/zero"]],
)  # fmt: skip
def test_a_file_without_end_is_refused(
    words: list[str], capsys: pytest.CaptureFixture, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(checked_files.read_at_most, "__defaults__", (10**6,))
    monkeypatch.setattr(iga_reader, "FILE_LIMITS", iga_reader.FileLimits(size=10**6))
    assert "it has more than 1 MB" in refused(words, capsys)


def test_a_deleted_working_folder_is_named(tmp_path: Path) -> None:
    here = Path(__file__).resolve().parents[3]
    script = f"import os; os.rmdir('{tmp_path}'); os.execv({sys.executable!r}, 'python -P -m verify scenes'.split())"
    environment = os.environ | {"PYTHONPATH": str(here)}
    done = subprocess.run([sys.executable, "-P", "-c", script], cwd=tmp_path, env=environment, capture_output=True)
    assert done.returncode == REFUSED and b"has been deleted" in done.stderr and b"Traceback" not in done.stderr


def test_a_large_number_is_not_called_too_small(capsys: pytest.CaptureFixture) -> None:
    assert "must be an integer >= 1 and < 1000000000" in refused(["verify", "--jobs", "1000000000"], capsys)
