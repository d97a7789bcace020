"""`import debond`: the public names in one place, and what a user meets who has another `iga` or `verify`."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import debond
import pytest

import iga
import verify

FRONT = Path(debond.__file__).parents[1]


def ran(program: str, *paths: Path) -> subprocess.CompletedProcess[str]:
    """A program with these folders first on its path."""
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(map(str, (*paths, FRONT, FRONT.parents[1])))}
    return subprocess.run([sys.executable, "-P", "-c", program], env=environment, capture_output=True, text=True)


def test_it_has_the_names_of_verify_and_both_packages():
    assert debond.verify is verify and debond.iga is iga
    assert set(debond.__all__) == {"iga", "verify", *verify.__all__} <= set(dir(debond))
    assert all(getattr(debond, name) is getattr(verify, name) for name in verify.__all__)
    with pytest.raises(AttributeError, match="no attribute 'scenes'"):
        debond.scenes  # noqa: B018


def test_the_import_brings_nothing_along():
    done = ran("import debond, sys; print({'numpy', 'pydantic', 'iga', 'verify', 'typing'} & set(sys.modules))")
    assert done.stdout.strip() == "set()", done.stderr


@pytest.mark.parametrize("name", ["iga", "verify"])
def test_another_package_of_the_name_is_named_by_its_file(tmp_path, name):
    other = tmp_path / f"{name}.py"
    other.write_text("")
    said = f"{name}: must be the package of debond, got {other}, which shadows it; "
    for program, code in ((f"import debond; debond.{name}", 1), ("import debond; raise SystemExit(debond.main())", 3)):
        done = ran(program, tmp_path)
        assert done.returncode == code and said in done.stderr
    (tmp_path / "elsewhere" / name).mkdir(parents=True)  # a folder without code shadows nothing
    assert ran(f"import debond; debond.{name}.solve", tmp_path / "elsewhere").returncode == 0


def test_nothing_that_windows_lacks_is_needed(tmp_path):
    """Every module of both packages is imported, and a run made."""
    masked = "import sys; sys.modules |= dict.fromkeys(('fcntl', 'resource', 'termios', 'pwd', 'grp', 'pty', 'tty'))"
    every = (
        "import importlib, iga, verify; from pkgutil import walk_packages\n"
        "names = [name for p in (iga, verify) for _, name, _ in walk_packages(p.__path__, p.__name__ + '.')]\n"
        "assert len([importlib.import_module(name) for name in names]) > 300, names"
    )
    words = ["solve", "dcb-czm1-linear", "--method", "beam", "--out", str(tmp_path / "run")]
    store = (
        f"from pathlib import Path; from verify.runs.store import opened\nwith opened(Path({str(tmp_path)!r})): pass"
    )
    run = f"import debond; sys.argv[1:] = {words}; raise SystemExit(debond.main())"
    done = ran("\n".join([masked, every, store, run]))
    assert done.returncode == 0 and (tmp_path / "run" / "result.json").exists(), done.stderr
