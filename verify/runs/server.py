"""Runs in processes that a server forks: it has imported the package once (`verify.runs.child`)."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from collections.abc import Mapping
from concurrent.futures import Future
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from threading import Timer

#: Whether processes may be copied: elsewhere every run is a process of its own.
POSSIBLE = sys.platform == "linux"

CHILD = [sys.executable, "-P", "-m", "verify.runs.child"]


@dataclass(frozen=True, eq=False)
class Run:
    """One run, as much of `subprocess.Popen` as is needed; ``code`` is its exit code when it has ended."""

    pid: int
    code: Future[int] = field(default_factory=Future)

    def send(self, number: int) -> None:
        """Send a signal, if it has not ended."""
        if not self.code.done():
            with suppress(ProcessLookupError):
                os.kill(self.pid, number)

    def terminate(self) -> None:
        self.send(signal.SIGTERM)

    def kill(self) -> None:
        self.send(signal.SIGKILL)

    def wait(self, timeout: float | None = None) -> int:
        """The exit code; raises subprocess.TimeoutExpired."""
        try:
            return self.code.result(timeout)
        except TimeoutError:
            raise subprocess.TimeoutExpired(str(self.pid), timeout or 0.0) from None


class Server:
    """A process that does one run after the other, with the environment that it was begun with."""

    def __init__(self, environment: Mapping[str, str]) -> None:
        self.environment = dict(environment)
        self._process = subprocess.Popen(
            CHILD,
            env=self.environment,
            bufsize=0,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
        )

    def kill(self) -> None:
        """End it at once, and with it its run."""
        self._process.kill()
        with self._process:  # waits, and closes its pipes
            pass

    def begin(self, words: list[str], log: Path, cwd: Path) -> Run:
        """Begin a run; raises OSError where the server has died."""
        asked = json.dumps({"words": words, "log": str(log), "cwd": str(cwd)})
        assert self._process.stdin is not None
        self._process.stdin.write(asked.encode() + b"\n")
        return Run(self._answer())

    def end(self, run: Run, timeout: float) -> int:
        """Wait for the end of the run, or kill it after the timeout; returns the exit code, -n after signal n."""
        timer = Timer(timeout, run.kill)
        timer.daemon = True
        timer.start()
        try:
            run.code.set_result(self._answer())
        finally:
            timer.cancel()
        return run.wait()

    def _answer(self) -> int:
        assert self._process.stdout is not None
        try:
            line = self._process.stdout.readline()
        except ValueError:  # closed by another thread that ends all servers
            line = b""
        if not line:
            raise OSError(f"the process that begins runs has ended with exit code {self._process.wait()}")
        return int(line)


#: All servers, and those that wait for a run.
_begun: list[Server] = []
_idle: list[Server] = []


def call(words: list[str], log: Path, cwd: Path, timeout: float, environment: Mapping[str, str], running: set) -> int:
    """Do a run through a server with an environment; ``running`` contains it meanwhile."""
    server = _waiting(environment) or _new(environment)
    run = server.begin(words, log, cwd)
    running.add(run)
    try:
        code = server.end(run, timeout)
    finally:
        running.discard(run)
    if server in _begun:
        _idle.append(server)
    return code


def end_all() -> None:
    """End all servers, those that are just beginning as well."""
    _idle.clear()
    while _begun:
        _begun.pop().kill()


def _new(environment: Mapping[str, str]) -> Server:
    server = Server(environment)
    _begun.append(server)
    return server


def _waiting(environment: Mapping[str, str]) -> Server | None:
    """An idle server with this environment; others are of no more use."""
    with suppress(IndexError):
        while True:
            server = _idle.pop()  # one operation: no two threads get the same
            if server.environment == environment:
                return server
            server.kill()
            with suppress(ValueError):
                _begun.remove(server)
    return None
