"""`debond verify`."""

from __future__ import annotations

import argparse
import shlex
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from verify.command_line.answers import FAILED, listed
from verify.command_line.arguments import number, place, positive
from verify.command_line.curves import foreign_curves, with_options
from verify.command_line.options import NewCommand, out_option, set_option, sweep_options
from verify.command_line.refusals import known_method, output_folder, refuse_ranks, writable_file
from verify.support.refusal import Refusal
from verify.support.say import say

if TYPE_CHECKING:
    from verify.scene.schema import Scene


def add(command: NewCommand) -> None:
    sub = command(
        run,
        "Every method on the scenes of the paper or those named, all checks, one report.",
        "verify dcb-czm1 --jobs 2",
        "read debond-report/report.html; exit 0: all checks hold",
    )
    what = "packaged name or scene file; default: those of the paper"
    sub.add_argument("scenes", nargs="*", metavar="SCENE", help=what)
    set_option(sub)
    out_option(sub, "debond-report")
    finer = "finer meshes as well, with observed order and uncertainty, and T-splines that follow the process zone"
    sub.add_argument("--full", action="store_true", help=finer)
    with_options(sub)
    sub.add_argument("--end", type=number, metavar="D", help="judge up to this opening, where a curve ends early")
    must = "exit 1 unless this method has run on every scene, for instance where DOLFINx may be missing; repeatable"
    sub.add_argument("--require", action="append", default=[], metavar="METHOD", help=must)
    sub.add_argument("--strict", action="store_true", help="exit 1 where anything could not be judged")
    beside = "md writes report.md beside report.html: its numbers, for a terminal or a forge"
    sub.add_argument("--format", choices=("html", "md"), default="html", help=beside)
    what = "write every check as a test case in JUnit XML there, which CI systems show"
    sub.add_argument("--junit", type=Path, metavar="FILE", help=what)
    priced = "what accuracy costs there, by few runs of every method; default: dcb-czm1 if it is verified; repeatable"
    sub.add_argument("--ladder", action="append", default=[], metavar="SCENE", help=priced)
    sub.add_argument("--no-ladder", action="store_true", help="do not ask what accuracy costs")
    shown = "show what debond cost, effects, vary or hard wrote there; folders in --out are found without it"
    sub.add_argument("--include", type=place, action="append", default=[], metavar="DIR", help=shown)
    said = "say before the runs that they take more than these minutes; default: 5"
    sub.add_argument("--budget", type=positive, default=5, metavar="MIN", help=said)
    sweep_options(sub)


def run(options: argparse.Namespace) -> int:
    from verify.checks.judgement import Demands
    from verify.methods import sliding
    from verify.scene.toml import keep_scene
    from verify.studies.found import named
    from verify.verification import Subjects, verify, would_run

    refuse_ranks("verify")
    scenes = _scenes(options)
    curves = foreign_curves(options, len(scenes))
    demands = Demands(options.strict, tuple(options.require))
    for method in demands.required:
        known_method(method, None, "--require")
    ladders = _ladders(options, scenes)
    subjects = Subjects(scenes, options.full, curves, named(options.include), ladders)
    if options.dry_run:
        return listed(would_run(subjects, options.out, options.jobs))
    output_folder(options.out)
    for path, scene in scenes if _set_for_all(options) else ():
        keep_scene(scene, Path(path))
    for remark in {remark for _, scene in scenes for remark in sliding.remarks(scene)}:
        say(remark)
    writable_file(options.junit, "--junit")
    text = options.format == "md"
    budget = 60.0 * options.budget
    passed = verify(subjects, options.out, options.jobs, options.scheduler, text, demands, options.junit, budget)
    return 0 if passed else FAILED


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
    """The scenes of quick ladders: those that are named, else the one that `laddered` finds among the scenes."""
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
