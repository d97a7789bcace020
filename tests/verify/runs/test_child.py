"""What the process that forks runs has imported."""

import json
import subprocess
import sys

import pytest

from verify.runs.child import IMPORTED

SOLVED = f"""
import importlib, json, os, sys
for name in {IMPORTED!r}:
    importlib.import_module(name)
before = set(sys.modules)
from verify.cli import main
assert main(["solve", "dcb-czm1-linear", "--method", sys.argv[1], "--out", sys.argv[2]]) == 0
print(json.dumps(sorted(set(sys.modules) - before)))
"""


@pytest.mark.parametrize("method", ["nurbs", "beam", "lefm"])
def test_a_run_imports_next_to_nothing(method: str, tmp_path) -> None:
    words = [sys.executable, "-P", "-c", SOLVED, method, str(tmp_path)]
    done = subprocess.run(words, capture_output=True, text=True, check=True, timeout=120)
    imported = json.loads(done.stdout.splitlines()[-1])
    assert len(imported) < 5, imported


def test_what_is_imported_leaves_mpi_alone() -> None:
    code = f"import importlib, sys; [importlib.import_module(name) for name in {IMPORTED!r}]; print(*sys.modules)"
    done = subprocess.run([sys.executable, "-P", "-c", code], capture_output=True, text=True, check=True)
    assert "mpi4py" not in done.stdout.split()
