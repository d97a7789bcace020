"""Programs on one rank and on more, for the tests that hold them against each other."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

#: More ranks than cores, and as root, as in a container.
SETTINGS = {
    "OMPI_ALLOW_RUN_AS_ROOT": "1",
    "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
    "OMPI_MCA_rmaps_base_oversubscribe": "1",
    "OMPI_MCA_mpi_yield_when_idle": "1",
    "PRTE_MCA_rmaps_default_mapping_policy": ":oversubscribe",
    "OMP_NUM_THREADS": "1",
}


def on_ranks(ranks: int, *words: str) -> str:
    """What Python with these arguments prints under mpirun; the test is skipped where that is not installed."""
    if (mpirun := shutil.which("mpirun")) is None:
        pytest.skip("mpirun is not installed")
    # Ranks that wait spin: on a busy core each message costs a slice of time, and the run takes a hundred times as
    # long, unless they go first. Without the right to that, nice says so and runs them all the same.
    paths = os.pathsep.join((str(Path(__file__).parent), *filter(None, sys.path)))
    done = subprocess.run(
        ["nice", "-n", "-20", mpirun, "-n", str(ranks), sys.executable, *words],
        capture_output=True,
        text=True,
        timeout=600,
        env=os.environ | SETTINGS | {"PYTHONPATH": paths},
        cwd=Path(__file__).parents[2],
    )
    assert done.returncode == 0, done.stderr[-2000:]
    return done.stdout
