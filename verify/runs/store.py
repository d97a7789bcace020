"""A store of results by hash, each complete or absent also after a kill, and links to them by readable names."""

from __future__ import annotations

import os
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path

from verify.support.refusal import Refusal

#: Name of the store in an output folder; no scene or case can have it.
STORE_FOLDER = "_runs"


@dataclass(frozen=True)
class Store:
    """``root``/KEY is a complete result, ``root``/KEY.failed the files of a run that failed."""

    root: Path

    def whole(self, key: str) -> bool:
        return self.folder(key).is_dir()

    def folder(self, key: str) -> Path:
        return self.root / key

    def failed(self, key: str) -> Path:
        return self.root / f"{key}.failed"

    def set_aside(self, key: str) -> None:
        """Mark a damaged result as failed."""
        shutil.rmtree(self.failed(key), ignore_errors=True)
        self.folder(key).rename(self.failed(key))

    def begin(self, key: str) -> Path:
        """A new temporary folder for a run."""
        return Path(tempfile.mkdtemp(prefix=f".{key}.", dir=self.root))

    def keep(self, work: Path, key: str) -> None:
        """Rename the temporary folder to the result; an existing result of another process stays."""
        work.chmod(0o755)
        try:
            work.rename(self.folder(key))
        except OSError:
            if not self.whole(key):
                raise
            shutil.rmtree(work)
        shutil.rmtree(self.failed(key), ignore_errors=True)

    def give_up(self, work: Path, key: str) -> None:
        """Rename the temporary folder of a failed run."""
        work.chmod(0o755)
        shutil.rmtree(self.failed(key), ignore_errors=True)
        work.rename(self.failed(key))


def has_locks() -> bool:
    """Whether the system has flock(2); on Windows nothing keeps two processes out of one folder."""
    return find_spec("fcntl") is not None


@contextmanager
def alone_in(folder: Path, out: Path | None = None) -> Iterator[None]:
    """Lock a folder against other runs; the lock is on the folder itself, and ends with the process.

    Parameters
    ----------
    out : the folder as the user knows it, if it is another

    Raises
    ------
    Refusal : another run uses the folder.
    """
    if not has_locks():
        yield
        return
    import fcntl

    place = os.open(folder, os.O_RDONLY)
    try:
        with suppress(OSError):  # some network file systems have no locks
            try:
                fcntl.flock(place, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError:
                told = str(out or folder)
                raise Refusal(f"--out: must be a folder that no other debond is at work in, got {told!r}") from None
        yield
    finally:
        os.close(place)


@contextmanager
def opened(out: Path) -> Iterator[Store]:
    """The store in an output folder, locked for this process; temporary folders of killed processes are removed.

    Raises
    ------
    Refusal : another process uses the folder.
    """
    root = out / STORE_FOLDER
    root.mkdir(parents=True, exist_ok=True)
    with alone_in(root, out):
        for half in root.glob(".*.*"):
            shutil.rmtree(half, ignore_errors=True)
        yield Store(root)


def link(out: Path, place: str, target: Path) -> None:
    """Link ``out``/``place`` to a folder in ``out``, relatively, so that ``out`` can be moved.

    An existing folder of that name is renamed to NAME.earlier. File systems without links get a copy.
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
