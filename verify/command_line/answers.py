"""How commands begin and end: what is refused before any work, lists, exit code 1."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from verify.support.refusal import Refusal

if TYPE_CHECKING:
    from verify.scene.schema import Scene

#: The exit code of a command that found something wrong.
FAILED = 1


def listed(lines: Sequence[str]) -> int:
    print("\n".join(lines))
    return 0


def ended(options: argparse.Namespace, would_run: Callable[[], Sequence[str]], work: Callable[[], bool]) -> int:
    """List the runs where only they are asked for, else make the output folder and do the work."""
    if options.dry_run:
        return listed(would_run())
    output_folder(options.out)
    return 0 if work() else FAILED


def known_method(method: str, dofs: int | None, option: str = "--method") -> None:
    from verify.methods import peers
    from verify.methods.names import METHODS, WITH_DOFS
    from verify.methods.plugins import find, known_methods
    from verify.support.refusal import one_of, suggestion

    if method not in METHODS and method not in (known := [*known_methods(), *peers.known()]):
        later = f"; {suggestion(method, known)}".rstrip("; ")
        raise Refusal(f"{option}: must be {one_of(known)}, got {method!r}{later}")
    if dofs and method not in WITH_DOFS:
        other = "; --set dolfinx.elements=N sets its mesh" if find(method).has_mesh else ""
        raise Refusal(f"--dofs: is only for --method {one_of(WITH_DOFS)}, got {dofs} for {method}{other}")


def refuse_ranks(command: str) -> None:
    from verify.runs.environment import mpi_size

    if mpi_size() > 1:
        raise Refusal(f"{command}: must be started in 1 process, without mpirun, got {mpi_size()}")


def studied(options: argparse.Namespace, command: str) -> Scene:
    """The scene of a study that generates its own meshes."""
    from verify.methods.given_meshes import refuse_files
    from verify.scene.load import load_scene

    refuse_ranks(command)
    scene = load_scene(options.scene, options.overrides)
    refuse_files(scene, f"debond {command}")
    return scene


def output_folder(path: Path, option: str = "--out") -> None:
    """Create the output folder now, so that a folder without write permission is refused before the work."""
    try:
        path.mkdir(parents=True, exist_ok=True)
        (path / ".writable").touch()
        (path / ".writable").unlink(missing_ok=True)
    except OSError as error:
        text = f"must be a folder that can be written to, got {str(path)!r}: {error.strerror}"
        raise Refusal(f"{option}: {text}") from None


def writable_file(path: Path | None, option: str) -> None:
    """A file that cannot be written is refused before the work; one that is there keeps its content."""
    if path is None:
        return
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.open("ab").close()
    except OSError as error:
        raise Refusal(f"{option}: must be a file that can be written, got {str(path)!r}: {error.strerror}") from None


def peer_names(words: str) -> Sequence[str]:
    """The names in a list with commas. Raises Refusal for a code that is not known or not installed."""
    from verify.methods.peers import named

    chosen = [named(word.strip()) for word in words.split(",") if word.strip()]
    if lacking := [peer.missing() for peer in chosen if peer.missing()]:
        raise Refusal("\n".join(lacking))
    return [peer.name for peer in chosen]
