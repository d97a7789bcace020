"""`debond verify`."""

from __future__ import annotations

import argparse
import shlex
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from verify.command_line.answers import ended, known_method, peer_names, refuse_ranks, writable_file
from verify.command_line.arguments import number, place, positive
from verify.command_line.curves import CURVES, foreign_curves
from verify.command_line.options import PEERS, SET, SWEEP, command, flag, folder, several, value
from verify.support.refusal import Refusal
from verify.support.say import say

if TYPE_CHECKING:
    from verify.scene.schema import Scene


@command(
    "Every method on the scenes of the paper or those named, all checks, one report.",
    "verify dcb-czm1 --jobs 2",
    "read debond-report/report.html; exit 0: all checks hold",
    value("scenes", "SCENE", "packaged name or scene file; default: those of the paper", nargs="*"),
    *(SET, folder("debond-report")),
    flag(
        "--full",
        "finer meshes as well, with observed order and uncertainty, and T-splines that follow the process zone",
    ),
    *CURVES,
    PEERS,
    value("--end", "D", "judge up to this opening, where a curve ends early", number),
    several(
        "--require",
        "METHOD",
        "exit 1 unless this method has run on every scene, for instance where DOLFINx may be missing; repeatable",
    ),
    flag("--strict", "exit 1 where anything could not be judged"),
    value(
        "--format",
        None,
        "md writes report.md beside report.html: its numbers, for a terminal or a forge",
        default="html",
        choices=("html", "md"),
    ),
    value("--junit", "FILE", "write every check as a test case in JUnit XML there, which CI systems show", Path),
    several(
        "--ladder",
        "SCENE",
        "what accuracy costs there, by few runs of every method; default: dcb-czm1 if it is verified; repeatable",
    ),
    flag("--no-ladder", "do not ask what accuracy costs"),
    several(
        "--include",
        "DIR",
        "show what debond cost, effects, vary or hard wrote there; folders in --out are found without it",
        place,
    ),
    value("--budget", "MIN", "say before the runs that they take more than these minutes; default: 5", positive, 5),
    *SWEEP,
)
def verify(options: argparse.Namespace) -> int:
    from verify.checks.judgement import Demands
    from verify.methods import bonds
    from verify.scene.toml import keep_scene
    from verify.studies.found import named
    from verify.verification import Subjects, verify, would_run

    refuse_ranks("verify")
    scenes = _scenes(options)
    curves = foreign_curves(options, [scene for _, scene in scenes])
    for method in options.require:
        known_method(method, None, "--require")
    demands = Demands(options.strict, tuple(options.require))
    subjects = Subjects(
        scenes, options.full, curves, named(options.include), _ladders(options, scenes), peer_names(options.peers)
    )

    def work() -> bool:
        for path, scene in scenes if _set_for_all(options) else ():
            keep_scene(scene, Path(path))
        for remark in {remark for _, scene in scenes for remark in bonds.remarks(scene)}:
            say(remark)
        writable_file(options.junit, "--junit")
        how = options.format == "md", demands, options.junit, 60.0 * options.budget
        return verify(subjects, options.out, options.jobs, options.scheduler, *how)

    return ended(options, lambda: would_run(subjects, options.out, options.jobs), work)


def _set_for_all(options: argparse.Namespace) -> list[str]:
    """Overrides of every scene of a verification."""
    return [*options.overrides, *([f"load.opening={options.end!r}"] if options.end is not None else [])]


def _scenes(options: argparse.Namespace) -> list[tuple[str, Scene]]:
    """What is verified, scenes with what repeats their runs: the name or file, or the file of a scene with overrides.

    Raises
    ------
    Refusal : with a sentence for everything that is wrong.
    """
    from verify.methods.given_meshes import given_meshes
    from verify.scene.load import load_scene, verified_scenes

    given = _set_for_all(options)
    scenes: list[tuple[str, Scene]] = []
    wrong = []
    for source in options.scenes or verified_scenes(options.full):
        try:
            if source.lower().endswith(".iga"):
                raise Refusal(
                    f"SCENE: must be a scene, got the mesh {source!r}: debond mesh {shlex.quote(source)} examines it, "
                    "and specimen.mesh of a scene takes the meshes of its arms"
                )
            scene = load_scene(source, given)
            given_meshes(scene)
            kept = options.out / scene.name / "scene.toml"
            if given and kept.exists() and Path(source).exists() and kept.samefile(source):
                wrong.append(f"--out: must be another folder than that of {source}, where the changed scene is kept")
            scenes.append((str(kept) if given else source, scene))
        except Refusal as error:
            wrong.append(str(error))
    names = [scene.name for _, scene in scenes]
    twice = sorted({name for name in names if names.count(name) > 1})
    wrong += [f"SCENE: must have different names, got {name!r} more than once" for name in twice]
    if wrong:
        raise Refusal("\n".join(wrong))
    return scenes


def _ladders(options: argparse.Namespace, scenes: Sequence[tuple[str, Scene]]) -> Sequence[tuple[str, Scene]]:
    """The scenes of quick searches: those that are named, else the one that `laddered` finds among the scenes."""
    from verify.methods.given_meshes import refuse_files
    from verify.scene.load import load_scene
    from verify.verification import laddered

    if options.no_ladder and options.ladder:
        raise Refusal(f"--no-ladder: must be left out with --ladder {options.ladder[0]}")
    if options.no_ladder:
        return ()
    chosen = [(source, load_scene(source)) for source in dict.fromkeys(options.ladder)]
    for _, scene in chosen:
        refuse_files(scene, "--ladder")
    return chosen or laddered(scenes)
