"""What every builder needs: a voice, a lock, a log, and one sentence for what went wrong."""

from __future__ import annotations

import fcntl
import hashlib
import re
import shutil
import subprocess
import sys
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path

HEADLINES = tuple(f"I: {word}" for word in ("running", "downloading", "extracting", "installing"))
ANOTHER_CACHE = "set DEBOND_CACHE to a folder"
#: What a log says, and the sentence a user can act on.
CAUSES = (
    (
        r"No space left on device|Disk quota exceeded",
        f"the disk is full; free some space or {ANOTHER_CACHE} on another disk",
    ),
    (
        r"resolving|[Cc]ould not (resolve|connect|handshake)|Connection (refused|timed out|failed)"
        r"|Network is unreachable|NewConnectionError|Failed to establish|Temporary failure|No matching distribution",
        "the package server cannot be reached; check the network, http_proxy, DEBOND_MIRROR or pip's settings",
    ),
    (r"NO_PUBKEY|is not signed|Missing key", "the Debian archive keys are missing; install debian-archive-keyring"),
    (r"does not have a Release file", "the Debian mirror has no such suite; check DEBOND_SUITE and DEBOND_MIRROR"),
    (r"ensurepip|No module named (venv|pip)", "this Python cannot make virtual environments; install python3-venv"),
    (
        r"newuidmap|subuid|unshare",
        "user namespaces need uidmap (as root: apt-get install uidmap) and a line for this account in /etc/subuid",
    ),
    (r"Read-only file system|Permission denied", f"the cache folder cannot be written; {ANOTHER_CACHE} of your own"),
)


class Trouble(Exception):
    """A sentence that names what failed, why, and what to do."""


def say(text: str) -> None:
    """One plain line on stderr."""
    print(f"debond: {text}", file=sys.stderr, flush=True)


def digest(*parts: str) -> str:
    """Short name for everything that an environment depends on."""
    return hashlib.sha256("\0".join(parts).encode()).hexdigest()[:10]


def cause(log: str) -> str | None:
    """The sentence for the first known cause in a log, or None."""
    return next((sentence for pattern, sentence in CAUSES if re.search(pattern, log)), None)


def run_logged(command: Sequence[str], log: Path, what: str, env: Mapping[str, str] | None = None) -> None:
    """Run a builder with its output in ``log``; the headlines of mmdebstrap are said aloud.

    Raises Trouble with the cause when it fails.
    """
    lines = []
    with open(log, "a", encoding="utf-8") as file:
        streams = {"stdin": subprocess.DEVNULL, "stdout": subprocess.PIPE, "stderr": subprocess.STDOUT}
        process = subprocess.Popen(command, env=env, text=True, errors="replace", **streams)
        for line in process.stdout:
            file.write(line)
            file.flush()
            lines.append(line)
            if line.startswith(HEADLINES):
                say("  " + line[3:].strip())
    if process.wait() != 0:
        known = cause("".join(lines))
        reason = f"failed: {known} (log: {log})" if known else f"failed; the reason is at the end of {log}"
        raise Trouble(f"{what} {reason}")


@contextmanager
def only_one(cache: Path) -> Iterator[None]:
    """Hold the lock of the cache folder: two starts never build at the same time.

    Raises Trouble when the folder cannot be written.
    """
    try:
        cache.mkdir(parents=True, exist_ok=True)
        file = open(cache / "lock", "a")  # noqa: SIM115
    except OSError as error:
        raise Trouble(
            f"the cache folder {cache} cannot be written ({error.strerror}); {ANOTHER_CACHE} of your own"
        ) from None
    with file:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            say("another start is setting up the environment; waiting for it")
            fcntl.flock(file, fcntl.LOCK_EX)
        yield


def remove_tree(folder: Path) -> None:
    """Remove a half-built folder, unless something is still mounted in it."""
    mounts = Path("/proc/self/mounts")
    if mounts.exists() and f" {folder}/" in mounts.read_text():
        raise Trouble(f"something is mounted inside {folder}; unmount it (see /proc/self/mounts) and start again")
    shutil.rmtree(folder, ignore_errors=True)


def need_space(folder: Path, gigabytes: float) -> None:
    """Raise Trouble unless the disk of ``folder`` has so much room."""
    free = shutil.disk_usage(folder).free / 1e9
    if free < gigabytes:
        raise Trouble(
            f"{folder} has {free:.1f} GB free and {gigabytes:g} GB are needed; "
            f"free some space or {ANOTHER_CACHE} on another disk"
        )
