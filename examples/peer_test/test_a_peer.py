"""A code of others in a test of its own repository: its curve against that of an independent code.

The peer is installed by `debond peers install`; where its working copy has been laid over that, as in
`.github/workflows/peer.yml` here, this is what is tested. Run it with `pytest examples/peer_test`.
"""

import subprocess
import sys
from pathlib import Path

import pytest

from verify.testing import assert_curves_close

SCENE, PEER = "dcb-czm1-linear", "fedoo"
#: A closed gap of this code has the stiffness of its bond, and 60 steps are enough for a curve.
SETTINGS = ("interface.penalty=1e3", "discretization.steps=60")


def debond(*words: object) -> None:
    """The command, which must end well."""
    run = subprocess.run([sys.executable, "-P", "-m", "verify", *map(str, words)], capture_output=True, text=True)
    assert run.returncode == 0, run.stderr


def curve(method: str, out: Path) -> Path:
    """The folder of a run of the scene."""
    debond("solve", SCENE, "--method", method, *(word for one in SETTINGS for word in ("--set", one)), "--out", out)
    return out


@pytest.fixture(scope="session")
def peer() -> str:
    debond("peers", "install", PEER)
    return PEER


def test_its_curve_is_that_of_an_independent_code(peer: str, tmp_path: Path) -> None:
    """A failure names the cause as well, as in "the toughness is 2 % higher"."""
    mine, nurbs = curve(peer, tmp_path / peer), curve("nurbs", tmp_path / "nurbs")
    assert_curves_close(mine, nurbs, curve=0.005, peak=0.005, scene=SCENE)
