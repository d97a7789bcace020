"""Completion, as the shells themselves do it."""

from __future__ import annotations

import shlex
import shutil
import subprocess
from pathlib import Path

import pytest

from verify.cli import main
from verify.command_line.commands import COMMANDS
from verify.command_line.completion import SHELLS, script
from verify.methods.names import METHODS
from verify.methods.plugins import plugins
from verify.scene.bond.interface import Interface
from verify.scene.keys import dotted_keys
from verify.scene.load import packaged_scenes
from verify.studies.hard.cases import CASES


@pytest.fixture(scope="module")
def bash(tmp_path_factory):
    path = tmp_path_factory.mktemp("completion") / "debond.bash"
    path.write_text(script("bash", COMMANDS))
    return path


def completed(bash: Path, *words: str) -> list[str]:
    """What bash offers for the last of the words of a command line."""
    if shutil.which("bash") is None:
        pytest.skip("needs bash")
    ask = f"""
        source {shlex.quote(str(bash))}
        COMP_WORDS=(debond {shlex.join(words)}) COMP_CWORD={len(words)}
        compopt() {{ :; }}  # there is no command line to set the options of
        $(complete -p debond | sed 's/.*-F \\([^ ]*\\) .*/\\1/')
        printf '%s\\n' "${{COMPREPLY[@]}}"
    """
    ended = subprocess.run(["bash", "-c", ask], capture_output=True, text=True, timeout=60, cwd=bash.parent)
    assert ended.stderr == ""
    return ended.stdout.split()


def test_bash_completes_commands_options_and_words(bash):
    assert completed(bash, "") == ["--help", *(one.name for one in COMMANDS)]
    assert completed(bash, "so") == ["solve"]
    assert completed(bash, "solve", "--m") == ["--method"]
    assert completed(bash, "solve", "dcb-czm1", "--method", "") == [*METHODS, *plugins()]
    assert completed(bash, "effects", "dcb-czm1", "--method", "nu") == ["nurbs"]
    assert completed(bash, "solve", "dcb-czm1", "--set", "interface.") == [
        f"interface.{key}=" for key in sorted(Interface.model_fields)
    ]
    assert completed(bash, "solve", "dcb-czm1", "--set", "")[-1] == f"{dotted_keys()[-1]}="
    assert completed(bash, "solve", "dcb-czm1", "--dofs", "") == []
    assert completed(bash, "hard", "") == list(CASES)
    assert completed(bash, "new", "")[:2] == ["dcb", "peel"] and "enf" in completed(bash, "new", "e")
    assert completed(bash, "completion", "") == list(SHELLS)
    assert completed(bash, "verify", "--format", "") == ["html", "md"]


def test_bash_completes_scenes_and_files(bash):
    (bash.parent / "dcb-own.toml").touch()
    for command in ("solve", "verify", "cost", "scenes"):
        found = completed(bash, command, "dcb-")
        assert set(found) == {name for name in packaged_scenes() if name.startswith("dcb-")} | {"dcb-own.toml"}
    assert completed(bash, "compare", "dcb-") == ["dcb-own.toml"]


@pytest.mark.parametrize("shell", SHELLS)
def test_every_command_and_option_is_in_the_script(shell, capsys):
    assert main(["completion", shell]) == 0
    text = capsys.readouterr().out
    for one in COMMANDS:
        assert one.name in text
        for option in [name for row in one.options for name in row.spellings if name.startswith("-")]:
            assert (f"-l {option[2:]} " if shell == "fish" and option[1] == "-" else option[2:]) in text
    assert all(word in text for word in (*packaged_scenes(), *METHODS, *CASES, *dotted_keys()))


@pytest.mark.parametrize("shell", SHELLS)
def test_the_shell_can_read_its_script(shell, tmp_path):
    if shutil.which(shell) is None:
        pytest.skip(f"needs {shell}")
    (tmp_path / "script").write_text(script(shell, COMMANDS))
    ended = subprocess.run([shell, "-n", str(tmp_path / "script")], capture_output=True, text=True, timeout=60)
    assert (ended.returncode, ended.stderr) == (0, "")
