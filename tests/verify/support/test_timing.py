"""How much memory a process took."""

from __future__ import annotations

import resource
import subprocess
import sys

import numpy as np
import pytest

from verify.support import timing
from verify.support.timing import peak_memory_mb

#: Size of an array that is held here, in megabytes.
HELD = 200.0
ASKED = f"""
from verify.support.timing import peak_memory_mb
print(peak_memory_mb())
bytearray(b"1" * {HELD * 1e6:.0f})
print(peak_memory_mb())
"""


def test_the_peak_is_this_process_s_own():
    """Not that of the one that started it, which a process inherits in ru_maxrss."""
    held = np.ones(int(HELD * 1e6) // 8)
    asked = [sys.executable, "-c", ASKED]
    said = subprocess.run(asked, capture_output=True, text=True, check=True).stdout
    before, after = map(float, said.split())
    assert 1.0 < before < HELD < held.nbytes / 1e6 + 1.0 <= peak_memory_mb() + 1.0
    assert after >= HELD, "it stays when memory is freed"


def test_without_proc_the_peak_is_that_of_getrusage(monkeypatch):
    def missing(_path: object) -> str:
        raise FileNotFoundError

    monkeypatch.setattr(timing.Path, "read_text", missing)
    known = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    for platform, unit in (("linux", 1024), ("darwin", 1)):
        monkeypatch.setattr(timing.sys, "platform", platform)
        assert peak_memory_mb() == pytest.approx(known * unit / 1e6, rel=0.01)
