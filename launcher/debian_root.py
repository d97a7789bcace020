"""A private Debian root with DOLFINx, built once by mmdebstrap."""

from __future__ import annotations

import os
import shlex
import shutil
import subprocess
import time
from pathlib import Path

from building import Trouble, digest, need_space, only_one, remove_tree, run_logged, say

#: DOLFINx compiles forms with gcc; OpenBLAS takes the place of the slow reference BLAS.
PACKAGES = (
    "python3-dolfinx-real",
    "python3-scipy",
    "python3-venv",
    "libopenblas0-pthread",
    "openmpi-bin",
    "gcc",
    "libc6-dev",
    "ca-certificates",
)
#: For tests alone: the browser of the pages, the shells whose words are completed, OpenGL without a screen for VTK.
FOR_TESTS = ("chromium", "fish", "libegl1", "zsh")
TOOLS = ("mmdebstrap", "bwrap")
RETRY_AFTER = 3600.0  # seconds before a failed build is tried again by itself


def suite() -> str:
    """The Debian suite of the root."""
    return os.environ.get("DEBOND_SUITE") or "trixie"


def packages(tests: bool) -> tuple[str, ...]:
    """The Debian packages of the root, with those of the tests or without."""
    return (*PACKAGES, *(FOR_TESTS if tests else ()))


def root_folder(cache: Path, tests: bool = False) -> Path:
    """Where the root of the present suite is or will be; another recipe is another folder."""
    return cache / f"root-{suite()}-{digest(*packages(tests))}"


def provide(cache: Path, tests: bool = False) -> Path:
    """The whole root, built first if it is not there; a root for tests serves all else, too.

    Raises Trouble when that cannot be done.
    """
    tests = tests or root_folder(cache, tests=True).is_dir()
    root = root_folder(cache, tests)
    if root.is_dir():
        if shutil.which("bwrap") is None:
            raise Trouble("bubblewrap is missing; as root: apt-get install bubblewrap")
        return root
    failed = root.with_name(root.name + ".failed")
    if failed.exists() and time.time() - failed.stat().st_mtime < RETRY_AFTER:
        again = f"tried less than an hour ago; to try again now: rm {shlex.quote(str(failed))}"
        raise Trouble(f"{failed.read_text().strip()} [{again}]")
    with only_one(cache):
        if not root.is_dir():
            try:
                failed.unlink(missing_ok=True)
                build(root, tests)
            except Trouble as trouble:
                failed.write_text(f"{trouble}\n")
                raise
    return root


def build(root: Path, tests: bool = False) -> None:
    """Build the root beside its place and rename it when it is whole."""
    get_tools()
    can_enter()
    need_space(root.parent, 4.0 if tests else 3.0)
    log = root.with_name(root.name + ".log")
    log.unlink(missing_ok=True)
    part = root.with_name(root.name + ".part")
    if part.exists():
        say(f"removing a half-built root, {part}")
        remove_tree(part)
    holds, size = ("DOLFINx and what the tests need", 3) if tests else ("DOLFINx", 2)
    say(f"building a private Debian {suite()} with {holds} in {root}: once, about 3 minutes and {size} GB")
    start = time.monotonic()
    try:
        run_logged(recipe(part, tests), log, "building the private Debian root")
    except Trouble:
        remove_tree(part)
        raise
    part.rename(root)
    say(f"the root is ready after {time.monotonic() - start:.0f} s")


def own_mounts() -> list[str]:
    """Words that give a command mounts of its own, which go when it goes, even when it is killed in the middle."""
    words = ["unshare", "--mount"]
    works = shutil.which(words[0]) and subprocess.run([*words, "true"], capture_output=True).returncode == 0
    return words if works else []


def recipe(part: Path, tests: bool = False) -> list[str]:
    """The mmdebstrap command; an ordinary user unpacks a tar file, so that all files are his own to remove."""
    words = ["mmdebstrap", "--variant=apt", "--include=" + ",".join(packages(tests))]
    words.append('--aptopt=APT::Install-Recommends "false"')
    if suite() in ("sid", "unstable"):
        words.append('--aptopt=Acquire::Check-Valid-Until "false"')  # a mirror's copy may be older than its validity
    mirror = [os.environ["DEBOND_MIRROR"]] if os.environ.get("DEBOND_MIRROR") else []
    if os.geteuid() == 0:
        return [*own_mounts(), *words, suite(), str(part), *mirror]
    part.mkdir()
    make = shlex.join([*words, "--mode=unshare", "--format=tar", suite(), "-", *mirror])
    unpack = shlex.join(["tar", "--extract", "--no-same-owner", "--exclude=./dev/*", f"--directory={part}"])
    return ["bash", "-c", f"set -o pipefail; {make} | {unpack}"]


def get_tools() -> None:
    """Install what is missing of mmdebstrap and bubblewrap, if this is root on Debian or Ubuntu."""
    missing = [tool for tool in TOOLS if shutil.which(tool) is None]
    if not missing:
        return
    if shutil.which("apt-get") is None:
        raise Trouble(f"a private Debian root needs {' and '.join(missing)}, and this is neither Debian nor Ubuntu")
    packages = ["mmdebstrap", "bubblewrap", "debian-archive-keyring", "ca-certificates"]
    if os.geteuid() != 0:
        raise Trouble(f"{' and '.join(missing)} are missing; as root: apt-get install {' '.join(packages)} uidmap")
    say("installing mmdebstrap and bubblewrap with apt-get")
    env = {**os.environ, "DEBIAN_FRONTEND": "noninteractive"}
    quiet = {"stdin": subprocess.DEVNULL, "stdout": subprocess.PIPE, "stderr": subprocess.STDOUT, "text": True}
    subprocess.run(["apt-get", "update"], check=False, env=env, **quiet)
    install = ["apt-get", "install", "-y", "--no-install-recommends", *packages]
    done = subprocess.run(install, check=False, env=env, **quiet)
    if done.returncode != 0:
        raise Trouble(f"apt-get install {' '.join(packages)} failed: {done.stdout.strip().splitlines()[-1]}")


def can_enter() -> None:
    """Raise Trouble unless bubblewrap works here; a container often forbids it."""
    probe = ["bwrap", "--ro-bind", "/", "/", "--dev-bind", "/dev", "/dev", "--proc", "/proc", "true"]
    done = subprocess.run(probe, check=False, stdin=subprocess.DEVNULL, capture_output=True, text=True)
    if done.returncode != 0:
        raise Trouble(
            f"bubblewrap may not run here ({done.stderr.strip()}); in a container, start it with --privileged"
        )
