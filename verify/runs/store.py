"""A folder of results by hash: whole or absent, whoever is killed; and readable names that lead to them."""

from __future__ import annotations

import fcntl
import os
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from verify.support.refusal import Refusal

#: No scene and no case can be called so.
STORE_FOLDER = "_runs"


@dataclass(frozen=True)
class Store:
    """``root``/KEY holds a whole result, ``root``/KEY.failed what a run that failed has left to read."""

    root: Path

    def whole(self, key: str) -> bool:
        return self.folder(key).is_dir()

    def folder(self, key: str) -> Path:
        return self.root / key

    def failed(self, key: str) -> Path:
        return self.root / f"{key}.failed"

    def set_aside(self, key: str) -> None:
        """Keep a result that turns out to be damaged for reading, and not as a result."""
        shutil.rmtree(self.failed(key), ignore_errors=True)
        self.folder(key).rename(self.failed(key))

    def begin(self, key: str) -> Path:
        """A new folder to work in; nobody takes it for a result."""
        return Path(tempfile.mkdtemp(prefix=f".{key}.", dir=self.root))

    def keep(self, work: Path, key: str) -> None:
        """Make the work in a folder the result; where another has been faster, its result stays."""
        work.chmod(0o755)
        try:
            work.rename(self.folder(key))
        except OSError:
            if not self.whole(key):
                raise
            shutil.rmtree(work)
        shutil.rmtree(self.failed(key), ignore_errors=True)

    def give_up(self, work: Path, key: str) -> None:
        """Keep what there is for reading, and not as a result."""
        work.chmod(0o755)
        shutil.rmtree(self.failed(key), ignore_errors=True)
        work.rename(self.failed(key))


@contextmanager
def alone_in(folder: Path) -> Iterator[None]:
    """Keep other runs out of a folder; the lock is on the folder itself and leaves no file.

    Raises
    ------
    Refusal : another run is at work there.
    """
    place = os.open(folder, os.O_RDONLY)
    try:
        fcntl.flock(place, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        os.close(place)
        raise Refusal(f"--out: must be a folder that no other debond is at work in, got {str(folder)!r}") from None
    except OSError:  # a file system without locks, as some of a network are
        pass
    try:
        yield
    finally:
        os.close(place)


@contextmanager
def opened(out: Path) -> Iterator[Store]:
    """The store in an output folder, for one process at a time; what a killed one has left half done is removed.

    Raises
    ------
    Refusal : another process is at work there.
    """
    root = out / STORE_FOLDER
    root.mkdir(parents=True, exist_ok=True)
    with (root / ".lock").open("w") as lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)  # given back by the system, however a process ends
        except OSError:
            raise Refusal(f"--out: must be a folder that no other debond is at work in, got {str(out)!r}") from None
        for half in root.glob(".*.*"):
            shutil.rmtree(half, ignore_errors=True)
        yield Store(root)


def link(out: Path, place: str, target: Path) -> None:
    """Let ``out``/``place`` lead to a folder in the same ``out``: a relative link, so that ``out`` can be moved.

    A folder of that name is moved aside to NAME.earlier; where there are no links it becomes a copy.
    """
    name = out / place
    name.parent.mkdir(parents=True, exist_ok=True)
    if name.is_dir() and not name.is_symlink():
        shutil.rmtree(f"{name}.earlier", ignore_errors=True)
        name.rename(f"{name}.earlier")
    beside = name.with_name(f".{name.name}.{os.getpid()}")
    beside.unlink(missing_ok=True)
    try:
        beside.symlink_to(os.path.relpath(target, name.parent), target_is_directory=True)
    except OSError:
        shutil.copytree(target, beside)
        name.unlink(missing_ok=True)
    beside.replace(name)
