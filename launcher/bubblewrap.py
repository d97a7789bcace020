"""Run a program in the private root as if it were the host: same paths, exit code and signals pass."""

from __future__ import annotations

import contextlib
import json
import os
import signal
import subprocess
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

#: Top-level folders that belong to the operating system; the root has its own.
SYSTEM = frozenset("bin boot dev etc lib lib32 lib64 libx32 lost+found proc run sbin sys usr var".split())
#: What the programs inside must know of the host: names, accounts, certificates, pip's settings.
FROM_THE_HOST = (
    "/etc/resolv.conf",
    "/etc/hosts",
    "/etc/passwd",
    "/etc/group",
    "/etc/pip.conf",
    "/etc/ssl/certs",
    "/usr/share/ca-certificates",
    "/usr/local/share/ca-certificates",
    "/var/tmp",
)
#: Signals that the launcher and bubblewrap hand on to the program instead of dying of them.
PASSED_ON = (signal.SIGINT, signal.SIGQUIT, signal.SIGTERM, signal.SIGHUP)


def run_in_root(
    root: Path,
    program: Sequence[str],
    env: Mapping[str, str],
    folder: Path,
    extra: Iterable[Path],
    held: Iterable[signal.Signals] = (),
) -> int:
    """Run ``program`` inside ``root`` in ``folder``; its exit code, 128 + n if signal n ended it.

    ``extra`` are folders that must be seen inside even where they lie in a system folder. The program begins with the
    signals ``held`` blocked.
    """
    reader, writer = os.pipe()
    watched = {*PASSED_ON, signal.SIGCHLD}
    before = signal.pthread_sigmask(signal.SIG_BLOCK, watched)

    def prepare() -> None:
        for number in PASSED_ON:
            signal.signal(number, signal.SIG_IGN)
        signal.pthread_sigmask(signal.SIG_SETMASK, before | set(held))

    restore = ["env", "--default-signal=" + ",".join(number.name[3:] for number in PASSED_ON)]
    restore += [f"--block-signal={number.name[3:]}" for number in held]  # bubblewrap lets them in
    words = ["bwrap", "--die-with-parent", "--info-fd", str(writer), *mounts(root, folder, extra)]
    words += ["--chdir", str(folder), *restore, *program]
    bwrap = subprocess.Popen(words, env=env, pass_fds=[writer], preexec_fn=prepare)
    os.close(writer)
    with os.fdopen(reader) as file:
        info = file.read()
    inner = json.loads(info)["child-pid"] if info.strip() else bwrap.pid
    early = signal.sigpending()  # sent before there was a program
    while bwrap.poll() is None:
        got = signal.sigwaitinfo(watched)
        # What the terminal sends (code > 0) reaches the program by itself; what `kill` sends is handed on.
        handed_on = got.si_code <= 0 or got.si_signo in early
        if got.si_signo != signal.SIGCHLD and handed_on and bwrap.poll() is None:
            with contextlib.suppress(ProcessLookupError):  # it has just ended
                os.kill(inner, got.si_signo)
        early.discard(got.si_signo)
    signal.pthread_sigmask(signal.SIG_SETMASK, before)
    return bwrap.returncode if bwrap.returncode >= 0 else 128 - bwrap.returncode


def mounts(root: Path, folder: Path, extra: Iterable[Path]) -> list[str]:
    """The bubblewrap options that put the host's own folders over a read-only root."""
    words = ["--ro-bind", str(root), "/", "--dev-bind", "/dev", "/dev", "--proc", "/proc", "--ro-bind", "/sys", "/sys"]
    words += ["--tmpfs", "/run"]
    for name in sorted(os.listdir("/")):
        path = Path("/", name)
        if name in SYSTEM or name.startswith(".") or not path.is_dir():
            continue
        if path.is_symlink():
            place_link(root, path)
        elif place(root, path):
            words += ["--bind", str(path), str(path)]
    for text in FROM_THE_HOST:
        if os.path.exists(text) and place(root, Path(text)):
            words += ["--bind" if text == "/var/tmp" else "--ro-bind", os.path.realpath(text), text]
    for path in dict.fromkeys([folder, *extra]):
        if path.resolve().parts[1:2] and path.resolve().parts[1] in SYSTEM and is_free(root, path):
            place(root, path)
            words += ["--bind", str(path), str(path)]
    return words


def place(root: Path, path: Path) -> bool:
    """Make the spot in ``root`` on which ``path`` is mounted; whether it is there."""
    spot = root / path.relative_to("/")
    try:
        if path.is_dir():
            spot.mkdir(parents=True, exist_ok=True)
        elif not spot.exists():
            spot.touch()
    except OSError:
        return spot.exists()
    return True


def place_link(root: Path, path: Path) -> None:
    """Repeat a top-level link of the host in ``root``."""
    spot = root / path.name
    if not os.path.lexists(spot) and os.access(root, os.W_OK):
        spot.symlink_to(os.readlink(path))


def is_free(root: Path, path: Path) -> bool:
    """Whether the root has nothing of its own at ``path``."""
    spot = root / path.relative_to("/")
    return not spot.exists() or (spot.is_dir() and not any(spot.iterdir()))
