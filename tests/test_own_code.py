"""The example of an own code: a package with an entry point and a curve in a file, both to their verdict."""

import os
import re
import subprocess
import sys
import tomllib
from pathlib import Path

import numpy as np
import pytest

from verify import verification
from verify.checks.foreign_curves import checks_of
from verify.checks.orders import ARMS, ARMS_SECOND
from verify.cli import main
from verify.curves.read import Reading, read_curve
from verify.methods.solve import solve
from verify.scene.load import load_scene
from verify.studies import one_scene

PROJECT = Path(__file__).resolve().parents[1]
EXAMPLE = PROJECT / "examples" / "own_code"
SCENE = "dcb-czm1-linear"


@pytest.fixture
def installed(tmp_path, monkeypatch):
    """The package of the example, as pip would leave it."""
    about = tomllib.loads((EXAMPLE / "pyproject.toml").read_text())["project"]
    folder = tmp_path / "site" / f"{about['name']}-{about['version']}.dist-info"
    folder.mkdir(parents=True)
    (folder / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {about['name']}\nVersion: {about['version']}\n")
    groups = ((group, entries.items()) for group, entries in about["entry-points"].items())
    lines = [line for group, entries in groups for line in (f"[{group}]", *(f"{k} = {v}" for k, v in entries))]
    (folder / "entry_points.txt").write_text("\n".join(lines) + "\n")
    for place in (folder.parent, EXAMPLE):
        monkeypatch.syspath_prepend(str(place))
    yield os.environ | {"PYTHONPATH": os.pathsep.join(map(str, (folder.parent, EXAMPLE, PROJECT)))}
    sys.modules.pop("springs", None)


def test_the_package_agrees_with_the_beam(installed):
    """Two ways to one curve that share the problem alone: 0.04 % apart, and 2 % more toughness would be seen."""
    scene = load_scene(SCENE)
    alone = solve(scene, "beam")
    beam = {"beam": alone, ARMS: alone, ARMS_SECOND: alone}
    found = {check.name: check for check in checks_of(scene, "springs", solve(scene, "springs"), beam)}
    assert found["end"].passed and found["beam-curve"].value < 0.001 < found["beam-curve"].tolerance
    tougher = solve(load_scene(SCENE, ["interface.toughness=0.102"]), "springs")
    found = {check.name: check for check in checks_of(scene, "springs", tougher, beam)}
    assert not found["beam-curve"].passed


def test_it_unloads_along_the_secant(installed, monkeypatch):
    monkeypatch.setattr("springs.STEPS", 20)
    scene = load_scene(SCENE, ["load.opening=[1.5, 0.5, 1.5]"])
    found = solve(scene, "springs")
    down, up = (np.flatnonzero(found.opening == x) for x in (0.5, 1.5))
    back = found.load[(found.opening < 1.5) & (np.arange(found.opening.size) > up[0])]
    assert found.complete and found.load[up[-1]] == pytest.approx(found.load[up[0]], rel=1e-6)
    assert found.load[down[-1]] == back.min() < 0.5 * found.load[up[0]]


def test_it_says_what_it_is_not_made_for(installed, tmp_path, capsys):
    for scene, why in (("dcb-czm1", 'effects.kinematics: must be "linear"'), ("peel-60", "only for a dcb")):
        assert main(["solve", scene, "--method", "springs", "--out", str(tmp_path / scene)]) == 2
        assert f"springs: {why}" in capsys.readouterr().err


def test_the_commands_of_the_example_find_it(installed, tmp_path):
    command = [sys.executable, "-P", "-m", "verify", "solve", SCENE, "--method", "springs", "--out", str(tmp_path)]
    run = subprocess.run(command, env=installed, capture_output=True, text=True, timeout=300)
    assert run.returncode == 0, run.stderr
    expected = read_curve(EXAMPLE / "history.csv", Reading("U2", "RF2", 2.0))
    assert np.allclose(read_curve(tmp_path), expected, rtol=1e-4, atol=1e-6), "history.csv is what springs.py writes"


def test_the_file_of_the_example_gets_its_verdict(tmp_path, monkeypatch, capsys):
    """By the very options that its page gives."""
    (line,) = re.findall(r"^    ./debond (verify .*--with.*)$", (EXAMPLE / "README.md").read_text(), re.M)
    monkeypatch.chdir(EXAMPLE)
    monkeypatch.setattr(verification, "write_page", lambda *what: None)
    planned = one_scene.planned
    beam_alone = lambda *given: (job for job in planned(*given) if job.method == "beam")  # noqa: E731
    monkeypatch.setattr(one_scene, "planned", beam_alone)
    assert main([*line.split(), "--out", str(tmp_path)]) == 0
    assert "history" in capsys.readouterr().out.splitlines()[0]
