"""Every example runs from top to bottom and its assertions hold."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

PROJECT = Path(__file__).parents[1]


@pytest.mark.parametrize("script", sorted((PROJECT / "examples").glob("*.py")), ids=lambda path: path.stem)
def test_example(script, tmp_path):
    copy = shutil.copy(script, tmp_path)  # pictures are written beside the script
    environment = {**os.environ, "MPLBACKEND": "Agg", "PYTHONPATH": str(PROJECT)}
    run = subprocess.run([sys.executable, copy], capture_output=True, text=True, env=environment, timeout=300)
    assert run.returncode == 0, run.stderr
    assert (tmp_path / script.name).with_suffix(".png").stat().st_size > 10_000
