"""What a process of a run asks of the system: to keep its memory, and to end with who began it."""

from __future__ import annotations

import ctypes
import signal
from types import SimpleNamespace

import pytest

from verify.runs.child import die_with_parent, keep_freed_memory


@pytest.fixture
def asked(monkeypatch: pytest.MonkeyPatch) -> list[tuple]:
    """What the C library is asked for."""
    calls: list[tuple] = []

    def noted(name: str):
        return lambda *values: calls.append((name, *values))

    library = SimpleNamespace(mallopt=noted("mallopt"), prctl=noted("prctl"))
    monkeypatch.setattr(ctypes, "CDLL", lambda name: library)
    return calls


def test_blocks_up_to_32_mb_come_from_the_heap_and_256_mb_are_kept(asked: list[tuple]) -> None:
    """By the numbers of M_TRIM_THRESHOLD and M_MMAP_THRESHOLD in malloc.h."""
    keep_freed_memory()
    assert asked == [("mallopt", -1, 256 * 1024**2), ("mallopt", -3, 32 * 1024**2)]


def test_a_run_ends_with_its_engine(asked: list[tuple]) -> None:
    """By PR_SET_PDEATHSIG in prctl.h."""
    die_with_parent()
    assert asked == [("prctl", 1, signal.SIGTERM)]


@pytest.mark.parametrize("error", [OSError, TypeError])
def test_where_there_is_no_such_library_nothing_is_asked(error: type, monkeypatch: pytest.MonkeyPatch) -> None:
    def missing(name: None) -> None:
        raise error

    monkeypatch.setattr(ctypes, "CDLL", missing)
    keep_freed_memory()
    die_with_parent()
    monkeypatch.setattr(ctypes, "CDLL", lambda name: SimpleNamespace())
    keep_freed_memory()
    die_with_parent()
