"""Codes of others in environments of their own: one folder of ``examples/peers`` each, found, installed and run.

A folder holds ``peer.toml`` and a plug-in ``debond_NAME.py`` (a solver as `verify.methods.plugins` takes them), which
runs its code by `run` in a process of its own. `peer.toml` has

    name = "moose"
    version = "MOOSE 975c9a1c (rabbit-fem 2026.10.1)"
    can = "dcb, enf and slb, plane stress and strain, ..."
    pip = ["rabbit-fem==2026.10.1"]
    debs = ["libtirpc3t64"]             # Debian packages whose libraries it needs
    python = "3.11"                     # where its wheels are for one version of Python alone
"""

from __future__ import annotations

import hashlib
import os
import shutil
import subprocess
import sys
import threading
import tomllib
from collections import deque
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from importlib.metadata import EntryPoint
from pathlib import Path
from time import monotonic

from verify.scene.schema import Scene
from verify.support.refusal import Refusal
from verify.support.say import say

FOLDERS = Path(__file__).resolve().parents[2] / "examples" / "peers"
#: Seconds after which a run is ended; DEBOND_PEER_SECONDS is another number.
LIMIT = 1800.0
#: The Debian release whose Python serves wheels of an older one.
PYTHONS: Mapping[str, str] = {"3.11": "bookworm"}
LIBRARIES = Path("usr/lib/x86_64-linux-gnu")
#: What a program may print once its packages are imported.
READY = "ready"
#: Every peer runs on one thread.
ONE_THREAD = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")


@dataclass(frozen=True)
class Peer:
    """The content of ``peer.toml``, and the folder it was read from."""

    name: str
    version: str
    can: str
    folder: Path
    pip: tuple[str, ...]
    debs: tuple[str, ...] = ()
    python: str = ""

    @property
    def home(self) -> Path:
        """Where it is installed: another recipe is another folder."""
        recipe = "\0".join([*self.pip, *self.debs, self.python, sys.version.split()[0]])
        return cache_folder() / "peers" / f"{self.name}-{hashlib.sha256(recipe.encode()).hexdigest()[:10]}"

    @property
    def site(self) -> Path:
        """Its Python packages."""
        return self.home / "site"

    @property
    def installed(self) -> bool:
        return self.home.is_dir()

    def missing(self) -> str:
        """Why it cannot be run, and the remedy; empty where it is installed."""
        return "" if self.installed else f"{self.name} is not installed: debond peers install {self.name}"

    def entry(self, group: str) -> EntryPoint:
        """Its plug-in, which can be imported from now on, with its packages where they are for this Python."""
        places = [self.folder, *([] if self._foreign else [self.site])]
        sys.path += [str(place) for place in places if str(place) not in sys.path]
        return EntryPoint(self.name, f"debond_{self.folder.name}:solve", group)

    @property
    def interpreter(self) -> Path:
        """The Python that sees its packages and none of debond's."""
        version = self.python if self._foreign else "{}.{}".format(*sys.version_info)
        return (self.home / "usr" if self._foreign else Path(sys.base_prefix)) / f"bin/python{version}"

    @property
    def _foreign(self) -> bool:
        return bool(self.python) and self.python != "{}.{}".format(*sys.version_info)


def cache_folder() -> Path:
    """Where environments are kept, those of ``./debond`` as well."""
    home = Path(os.environ.get("XDG_CACHE_HOME") or "~/.cache")
    return Path(os.environ.get("DEBOND_CACHE") or home / "debond").expanduser().absolute()


@cache
def known() -> Mapping[str, Peer]:
    """All peers by their names; none where debond is installed without its examples."""
    found = []
    for path in sorted(FOLDERS.glob("*/peer.toml")):
        words = tomllib.loads(path.read_text())
        lists = {key: tuple(value) for key, value in words.items() if isinstance(value, list)}
        found.append(Peer(**{**words, **lists}, folder=path.parent))
    return {peer.name: peer for peer in found}


def named(name: str) -> Peer:
    """Raises Refusal where there is none of this name."""
    if not known():
        raise Refusal(f"peers: come with a copy of the repository, and there is no folder {FOLDERS} here")
    if name not in known():
        raise Refusal(f"peers: must be one of {', '.join(known())}, got {name!r}")
    return known()[name]


def install(peer: Peer) -> None:
    """Build its environment beside its place, and move it there when it is whole.

    Raises
    ------
    Refusal : with the last line of what pip or apt-get said.
    """
    part = peer.home.with_name(peer.home.name + ".part")
    shutil.rmtree(part, ignore_errors=True)
    (part / "site").mkdir(parents=True)
    debs, suite = list(peer.debs), ""
    if peer._foreign:
        suite, v = PYTHONS[peer.python], peer.python
        debs += [f"python{v}-minimal", f"libpython{v}-minimal", f"libpython{v}-stdlib"]
    say(f"installing {peer.version} in {peer.home}: once, up to a few minutes")
    if debs:
        _unpack_debs(debs, suite, part)
    pip = [sys.executable, "-m", "pip", "install", "--quiet", "--disable-pip-version-check", "--target", part / "site"]
    if peer._foreign:
        pip += ["--python-version", peer.python, "--only-binary=:all:"]
    _call([*pip, *peer.pip], part)
    part.rename(peer.home)
    say(f"{peer.name} is installed: debond verify SCENE --peers {peer.name}")


def _unpack_debs(packages: Sequence[str], suite: str, part: Path) -> None:
    """Unpack Debian packages of the release that is there, or of another one, into a folder."""
    if shutil.which("apt-get") is None:
        raise Refusal(f"peers: {', '.join(packages)} must come from Debian, and there is no apt-get here")
    lists, cached = part / "apt/lists", part / "apt/cache"
    for folder in (lists / "partial", cached / "archives/partial"):
        folder.mkdir(parents=True)
    apt = [
        "apt-get",
        "-qq",
        "-o",
        f"Dir::State::lists={lists}",
        "-o",
        f"Dir::Cache={cached}",
        "-o",
        "APT::Sandbox::User=root",
    ]
    if suite:
        sources = part / "apt/sources.list"
        sources.write_text(f"deb {_mirror()} {suite} main\n")
        apt += ["-o", f"Dir::Etc::sourcelist={sources}", "-o", "Dir::Etc::sourceparts=-"]
    _call([*apt, "update"], part)
    _call([*apt, "download", *packages], part)
    for deb in sorted(part.glob("*.deb")):
        _call(["dpkg-deb", "-x", deb, part], part)
        deb.unlink()
    shutil.rmtree(part / "apt")


def _mirror() -> str:
    """The Debian mirror that is in use here."""
    named = os.environ.get("DEBOND_MIRROR")
    files = (Path("/etc/apt/sources.list"), *sorted(Path("/etc/apt/sources.list.d").glob("*")))
    words = [word for path in files if path.is_file() for word in path.read_text().split()]
    return named or next(
        (word for word in words if word.startswith("http") and word.rstrip("/").endswith("debian")), ""
    )


def _call(words: Sequence[object], folder: Path) -> None:
    done = subprocess.run(
        [str(word) for word in words], cwd=folder, stdin=subprocess.DEVNULL, capture_output=True, text=True
    )
    if done.returncode:
        said = [line for line in (done.stderr or done.stdout).splitlines() if line.strip()]
        shutil.rmtree(folder, ignore_errors=True)
        raise Refusal(f"peers: {Path(str(words[0])).name} has ended with {done.returncode}: {said[-1] if said else ''}")


def unless_plain_dcb(scene: Scene) -> str:
    """Why a scene is not the one that most codes take, or nothing: two equal isotropic arms in plane stress, pulled
    apart at their end faces, whose bond opens alone."""
    if scene.specimen.kind != "dcb" or scene.specimen.plane != "stress" or scene.load.at != "face":
        return "only for a dcb in plane stress, pulled at its end faces"
    if scene.interface.slides or not all(hasattr(one, "young") for one in scene.materials):
        return "only for isotropic arms whose bond opens alone"
    if len({str(one) for one in scene.materials}) > 1:
        return "only for arms of one material"
    return "" if scene.dolfinx.degree in ("auto", 1, 2) else "dolfinx.degree: must be 1 or 2"


def run(
    name: str, words: Sequence[object], folder: Path, on_line: Callable[[str], object] = lambda line: None
) -> float:
    """Run a program in the environment of a peer, in ``folder``; ``on_line`` is called with every line that it prints.

    Returns
    -------
    Seconds until it has started: until it has printed `READY`, or else its first line.

    Raises
    ------
    RuntimeError : it has not ended in time, or has failed; with the last line that it printed.
    """
    peer, limit = known()[name], float(os.environ.get("DEBOND_PEER_SECONDS") or LIMIT)
    libraries = os.pathsep.join(str(peer.home / place) for place in (LIBRARIES, "usr/lib"))
    env = {**os.environ, "PYTHONPATH": str(peer.site), "LD_LIBRARY_PATH": libraries, **ONE_THREAD}
    last: deque[str] = deque(maxlen=1)
    late, begin, started = threading.Event(), monotonic(), 0.0
    with subprocess.Popen(
        [str(word) for word in words], cwd=folder, env=env, stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, errors="replace",
    ) as process:  # fmt: skip

        def end() -> None:
            late.set()
            process.kill()

        timer = threading.Timer(limit, end)
        timer.start()
        assert process.stdout is not None
        try:
            for line in process.stdout:
                if not started or line.strip() == READY:
                    started = monotonic() - begin
                if line.strip() not in ("", READY):
                    last.append(line.strip())
                on_line(line)
        except BaseException:
            process.kill()
            raise
        finally:
            timer.cancel()
    if late.is_set():
        raise RuntimeError(f"{name} has not ended within {limit:g} s (DEBOND_PEER_SECONDS is another limit)")
    if process.returncode:
        raise RuntimeError(f"{name} has ended with {process.returncode}: {''.join(last) or 'without a word'}")
    return started
