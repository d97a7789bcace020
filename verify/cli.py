"""The command line. Invalid input is refused before any work, with exit code 2."""

from __future__ import annotations

import os
import sys

from verify.runs.environment import THREADS

for _name in THREADS:
    os.environ.setdefault(_name, "1")  # before NumPy is imported, for comparable times

import argparse  # noqa: E402
import errno  # noqa: E402
import re  # noqa: E402
from collections.abc import Callable, Sequence  # noqa: E402
from pathlib import Path  # noqa: E402
from typing import Any  # noqa: E402

from verify.command_line import commands  # noqa: E402
from verify.command_line.arguments import (  # noqa: E402
    accuracy,
    column,
    columns,
    count,
    fraction,
    names_of,
    number,
    numbers,
    place,
    positive,
    scale,
    scales_of,
    seeds,
)
from verify.command_line.spelling import Help, parsed  # noqa: E402
from verify.support import interrupts  # noqa: E402
from verify.support.refusal import Refusal  # noqa: E402
from verify.support.say import say  # noqa: E402
from verify.version import __version__  # noqa: E402

#: Other exit codes than 0 and `FAILED`; 3 is that of an environment that cannot be set up.
REFUSED, NOT_WRITTEN = 2, 4

#: The beginning of a negative number: argparse takes -1 and -0.5 for numbers, but -1e-3 for an option.
NEGATIVE = re.compile(r"-\.?\d")

Parser = argparse.ArgumentParser


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command; its exit code.

    0: fine; 1: something failed; 2: bad input; 4: the output could not be written; 130: interrupted.
    """
    options = argparse.Namespace(keeps=None, out=None)
    try:
        code = _outcome(options, sys.argv[1:] if arguments is None else arguments)
        if not interrupts.came():
            return code
    except BaseException as error:
        if not interrupts.is_one(error):
            raise
    interrupts.ignore_more()
    say(f"interrupted{_how_to_go_on(options)}")
    return interrupts.INTERRUPTED


def _outcome(options: argparse.Namespace, arguments: Sequence[str]) -> int:
    """The exit code of a command that is not interrupted; its options are put into ``options``."""
    try:
        _refuse_deleted_folder()
        vars(options).update(vars(parsed(parser(), arguments)))
        return options.command(options)
    except Refusal as error:
        if not interrupts.came():
            say(str(error))
        return REFUSED
    except BrokenPipeError:  # the reader of the output has closed it: write no more, and no message at exit
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return NOT_WRITTEN
    except OSError as error:
        from verify.runs.folder import NO_ROOM  # here, as it imports NumPy

        if error.errno not in (*NO_ROOM, errno.EACCES) or interrupts.came():
            raise
        say(f"{error.filename or 'the output'}: cannot be written: {error.strerror}{_how_to_go_on(options)}")
        if error.filename is None:  # possibly standard output itself, which must not be flushed at exit
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return NOT_WRITTEN


def _refuse_deleted_folder() -> None:
    try:
        os.getcwd()
    except FileNotFoundError:
        raise Refusal("the working folder: must exist, it has been deleted; change to another one") from None


def _how_to_go_on(options: argparse.Namespace) -> str:
    """The rest of a sentence: finished work, and how the same command continues."""
    if not options.keeps or options.out is None or getattr(options, "dry_run", False):
        return "; the same command again starts over"
    kept, then = options.keeps
    return f"; {kept} in {options.out}, and the same command again {then}"


def parser() -> Parser:
    """Every command with its options and one example."""
    top = Parser(
        prog="debond",
        description="Verify codes for interface debonding.",
        epilog="example: debond verify\n         # every method, scenes of the paper; read debond-report/report.html",
        formatter_class=Help,
        allow_abbrev=False,
    )
    top.add_argument("--version", action="version", version=f"debond {__version__}")
    subs = top.add_subparsers(title="commands", required=True, metavar="COMMAND")

    def command(function: Callable[[argparse.Namespace], int], text: str, example: str, leaves: str) -> Parser:
        end = f"example: debond {example}\n         # {leaves}"
        options: dict[str, Any] = {"description": text, "epilog": end, "formatter_class": Help, "allow_abbrev": False}
        sub: Parser = subs.add_parser(function.__name__, help=text, **options)
        sub.set_defaults(command=function, keeps=None, parser=top)
        return sub

    _studies(command)
    _tools(command)
    return top


def _studies(command: Callable[..., Parser]) -> None:
    """The commands that solve scenes and compare curves."""
    text = "Every method on the scenes of the paper or those named, all checks, one report."
    leaves = "read debond-report/report.html; exit 0: all checks hold"
    _verify_options(command(commands.verify, text, "verify dcb-czm1 --jobs 2", leaves))
    text = "One scene by one method: T-splines, NURBS, Lagrange or DOLFINx elements, a beam, LEFM."
    example = "solve dcb-czm1 --method tspline --set discretization.adaptive=true"
    leaves = "curve.csv and result.json in debond-out/dcb-czm1-tspline"
    _solve_options(command(commands.solve, text, example, leaves))
    text = "What accuracy costs in time: every method on ever finer meshes, one chart."
    _cost_options(command(commands.cost, text, "cost dcb-czm1 --out cost", "read cost/report.html"))
    text = "What each effect changes and costs: on and off, everything else as the scene says."
    _effects_options(command(commands.effects, text, "effects dcb-czm1 --out effects", "read effects/report.html"))
    text = "What viscosity changes in a bond that slides, and what time it saves."
    example = "viscosity enf-as4peek --out viscosity"
    _viscosity_options(command(commands.viscosity, text, example, "read viscosity/report.html"))
    text = "A statement of ASME V&V 20 on the error of the model: a measured curve against a scene, with uncertainties."
    example = "validate dcb-czm1 --with lab.csv --out validation"
    leaves = "read validation/report.html; exit 0: a statement could be made"
    _validate_options(command(commands.validate, text, example, leaves))
    text = "Values that two codes agree on, with their uncertainties, to hold other codes against."
    example = "certify dcb-czm1 --out certified"
    leaves = "read certified/report.html; exit 0: every value is certified"
    _certify_options(command(commands.certify, text, example, leaves))
    text = "How time and memory grow up to 100,000 unknowns, what more ranks gain, what to expect of many."
    _scaling_options(command(commands.scaling, text, "scaling dcb-czm1 --out scaling", "read scaling/report.html"))
    text = "The cases on which cohesive codes stop or go wrong."
    _hard_options(command(commands.hard, text, "hard coarse-czm2 --jobs 2", "read debond-hard/report.html"))
    text = "A traction law at one point, of the solvers or of anybody's code: judged on displacement paths."
    _law_options(command(commands.law, text, "law dcb-czm1 --out law", "read law/law.html; exit 0: all checks hold"))
    text = "Toughness from a delamination test, or back from a run: every scheme of the standards, with intervals."
    example = "reduce test.csv --scene mine.toml --load-scale 1e3 --crack a --out reduced"
    _reduce_options(command(commands.reduce, text, example, "a table; read reduced/reduce.html"))
    text = "Two load-opening curves: error, peak, energy; of runs, or of anybody's code."
    example = "compare my.csv run --opening-a U2 --load-a RF2 --curve-tol 0.01"
    _compare_options(command(commands.compare, text, example, "a table; exit 1: my.csv is more than 1 % off the run"))


def _tools(command: Callable[..., Parser]) -> None:
    """The commands around them: other formats, scenes, the shell, the installation."""
    text = "One scene for another code: mesh, sets, interface pairs, material, law and steps."
    leaves = "input files in debond-export/dcb-czm1-abaqus"
    _export_options(command(commands.export, text, "export dcb-czm1 --format abaqus", leaves))
    text = "What a mesh file holds, and its picture."
    _mesh_options(command(commands.mesh, text, "mesh arch.iga --out arch.vtu", "facts here, cells for ParaView there"))
    text = "The packaged scenes, a line each; those that are named with a drawing and their numbers."
    sub = command(commands.scenes, text, "scenes dcb-czm1", "the specimen, drawn")
    sub.add_argument("scenes", nargs="*", metavar="SCENE", help="a packaged name or a file; default: the list")
    text = "A scene file to start from: every key with what it is, its unit, its range and its default."
    sub = command(commands.new, text, "new dcb > my.toml", "change it, then: debond solve my.toml")
    sub.add_argument("kind", nargs="?", metavar="KIND", help="of the specimen, like dcb or peel")
    sub.add_argument("--from", dest="scene", metavar="SCENE", help="start from this scene: a packaged name or a file")
    _set_option(sub)
    text = "What completes commands, options, scenes, methods and keys at the tab key of a shell."
    sub = command(commands.completion, text, "completion bash > ~/.debond-completion", "source it in ~/.bashrc")
    sub.add_argument("shell", metavar="SHELL", help="bash, zsh or fish")
    text = "What is installed, what works, how to get the rest."
    command(commands.doctor, text, "doctor", "one line a package, then what works")
    sub = command(commands.test, "Run the tests; arguments go to pytest.", "test -k curve", "the tests of curves")
    sub.add_argument("rest", nargs=argparse.REMAINDER, metavar="ARG")


def _verify_options(sub: Parser) -> None:
    what = "packaged name, scene file, or .iga mesh for a plane problem; default: those of the paper"
    sub.add_argument("scenes", nargs="*", metavar="SCENE", help=what)
    _set_option(sub)
    _out_option(sub, "debond-report")
    finer = (
        "finer meshes as well, with observed order and uncertainty, T-splines that follow the process zone, interface "
        "rules, and the figures of the paper"
    )
    sub.add_argument("--full", action="store_true", help=finer)
    _with_options(sub)
    sub.add_argument("--end", type=number, metavar="D", help="judge up to this opening, where a curve ends early")
    must = "exit 1 unless this method has run on every scene, for instance where DOLFINx may be missing; repeatable"
    sub.add_argument("--require", action="append", default=[], metavar="METHOD", help=must)
    sub.add_argument("--strict", action="store_true", help="exit 1 where anything could not be judged")
    beside = "md writes report.md beside report.html: its numbers, for a terminal or a forge"
    sub.add_argument("--format", choices=("html", "md"), default="html", help=beside)
    what = "write every check as a test case in JUnit XML there, which CI systems show"
    sub.add_argument("--junit", type=Path, metavar="FILE", help=what)
    priced = "what accuracy costs there, by few runs of every method; default: a dcb of the scenes; repeatable"
    sub.add_argument("--ladder", action="append", default=[], metavar="SCENE", help=priced)
    sub.add_argument("--no-ladder", action="store_true", help="do not ask what accuracy costs")
    shown = "show what debond cost, effects, scaling or hard wrote there; folders in --out are found without it"
    sub.add_argument("--include", type=place, action="append", default=[], metavar="DIR", help=shown)
    _sweep_options(sub)


def _with_options(sub: Parser) -> None:
    sub._negative_number_matcher = NEGATIVE
    what = "judge this load-opening curve of another code, a file or NAME=FILE, like one of the methods"
    sub.add_argument("--with", dest="curves", action="append", default=[], metavar="FILE", help=what)
    _curve_options(sub)


def _curve_options(sub: Parser) -> None:
    for key in ("opening", "load"):
        sub.add_argument(f"--{key}", type=column, metavar="COLUMN", help=f"name or number of the curve's {key}")
        what = f"multiplies the curve's {key}: units, and signs"
        sub.add_argument(f"--{key}-scale", type=scale, default=1.0, metavar="X", help=what)


def _solve_options(sub: Parser) -> None:
    _scene_argument(sub)
    sub.add_argument("--method", metavar="M", help="tspline, nurbs (default), lagrange, dolfinx, ...")
    sub.add_argument("--dofs", type=positive, metavar="N", help="unknowns to aim at, for tspline, nurbs and lagrange")
    what = "choose method and mesh for this error of the curve, like 0.3%%, and verify it on finer meshes"
    sub.add_argument("--accuracy", type=accuracy, metavar="A", help=what)
    _set_option(sub)
    sub.add_argument("--out", type=place, metavar="DIR", help="default: debond-out/SCENE-METHOD")
    what = "keep fields: of a few steps in fields.npz, and fields.pvd and interface.pvd for ParaView"
    sub.add_argument("--fields", action="store_true", help=what)
    what = "with --fields, frames for ParaView along the programme; default: 30, 0: none"
    sub.add_argument("--frames", type=count, default=30, metavar="N", help=what)
    sub.set_defaults(keeps=("what is done is valid", "starts over"))


def _cost_options(sub: Parser) -> None:
    _scene_argument(sub)
    _set_option(sub)
    _out_option(sub, "debond-cost")
    _jobs_option(sub, "runs of the reference at a time; what is timed runs alone")
    _dry_run_option(sub)


def _effects_options(sub: Parser) -> None:
    _scene_argument(sub)
    sub.add_argument("--method", default="nurbs", metavar="M", help="tspline, nurbs (default), lagrange, dolfinx, ...")
    _set_option(sub)
    _out_option(sub, "debond-effects")
    _sweep_options(sub)


def _viscosity_options(sub: Parser) -> None:
    _scene_argument(sub)
    sub.add_argument("--method", default="nurbs", metavar="M", help="tspline, nurbs (default), lagrange, dolfinx")
    _set_option(sub)
    _out_option(sub, "debond-viscosity")
    _sweep_options(sub)


def _validate_options(sub: Parser) -> None:
    _scene_argument(sub)
    _with_options(sub)
    sub.add_argument("--at", type=numbers, default=[], metavar="D,D,...", help="the loads at these openings as well")
    sub.add_argument("--method", default="nurbs", metavar="M", help="tspline, nurbs (default), lagrange, dolfinx, ...")
    _set_option(sub)
    _out_option(sub, "debond-validation")
    _sweep_options(sub)


def _certify_options(sub: Parser) -> None:
    _scene_argument(sub)
    what = "the loads at these openings; default: at every quarter of the programme"
    sub.add_argument("--at", type=numbers, default=[], metavar="D,D,...", help=what)
    _set_option(sub)
    _out_option(sub, "debond-certified")
    what = "in a checkout: keep the values for debond verify, in place of those that are there"
    sub.add_argument("--keep", action="store_true", help=what)
    _sweep_options(sub)


def _scaling_options(sub: Parser) -> None:
    _scene_argument(sub)
    _set_option(sub)
    _out_option(sub, "debond-scaling")
    _dry_run_option(sub)


def _hard_options(sub: Parser) -> None:
    sub.add_argument("names", nargs="*", metavar="NAME", help="hard cases, or random for random scenes; default: all")
    what = "of random: how many scenes, or the first and the last like 40-79; default: 40"
    sub.add_argument("--seeds", type=seeds, metavar="N", help=what)
    _out_option(sub, "debond-hard")
    _sweep_options(sub)


def _export_options(sub: Parser) -> None:
    _scene_argument(sub)
    sub.add_argument("--format", required=True, metavar="F", help="abaqus, gmsh, med, exodus, vtu or csv")
    what = "gmsh, med, exodus: one conforming mesh with a group `bond`, for codes that insert interface elements there"
    sub.add_argument("--merged", action="store_true", help=what)
    sub.add_argument("--elements", type=positive, metavar="N", help="elements along the specimen, as dolfinx.elements")
    layers = "elements through each arm or the strip, as dolfinx.layers"
    sub.add_argument("--layers", type=positive, metavar="N", help=layers)
    _set_option(sub)
    sub.add_argument("--out", type=place, metavar="DIR", help="default: debond-export/SCENE-F")


def _mesh_options(sub: Parser) -> None:
    sub.add_argument("file", metavar="FILE", type=place, help=".iga file of the Rhino T-spline plug-in")
    formats = ".svg, .png, .pdf: picture; .vtu: Bezier cells; .iga; default: debond-mesh/FILE.svg"
    sub.add_argument("--out", type=place, metavar="FILE", help=formats)
    sub.add_argument("--json", action="store_true", help="print the facts as JSON")
    sub.add_argument("--control", action="store_true", help="draw the control points too")


def _law_options(sub: Parser) -> None:
    sub._negative_number_matcher = NEGATIVE
    _scene_argument(sub)
    _set_option(sub)
    what = "write the paths there, paths.csv, with input for Abaqus and MOOSE"
    sub.add_argument("--write", type=place, metavar="DIR", help=what)
    what = "judge this law: tractions on the paths in a file, or module:function; default: that of the solvers"
    sub.add_argument("--with", dest="given", metavar="LAW", help=what)
    what = "names of columns of the file, like p=S22,t=S12; of path, step, g, s, p, t, dp_dg, dp_ds, dt_dg, dt_ds"
    sub.add_argument("--columns", type=names_of, default=(), metavar="K=NAME,...", help=what)
    what = "what multiplies columns of the file: units, and signs, like g=1e3,t=-1"
    sub.add_argument("--scales", type=scales_of, default=(), metavar="K=X,...", help=what)
    what = "largest deviation of tractions, in parts of the strengths, and of energies; default: 1e-4"
    sub.add_argument("--tolerance", type=fraction, metavar="T", help=what)
    sub.add_argument("--out", type=place, metavar="DIR", help="write law.json and law.html")


def _reduce_options(sub: Parser) -> None:
    sub._negative_number_matcher = NEGATIVE
    sub.add_argument("file", metavar="FILE", type=place, help="text file of a test, or folder of a run")
    what = "the specimen, a packaged name or a file, whose [interface] and [load] may be missing; of a run: its own"
    sub.add_argument("--scene", metavar="SCENE", help=what)
    _set_option(sub)
    _curve_options(sub)
    what = "name or number of the crack lengths, from the load line or the left support; default: crack_length"
    sub.add_argument("--crack", type=column, metavar="COLUMN", help=what)
    sub.add_argument("--crack-scale", type=scale, default=1.0, metavar="X", help="multiplies the crack lengths")
    what = "one or two columns: rotations of the loaded ends, for J"
    sub.add_argument("--rotations", type=columns, default=(), metavar="COLUMN,...", help=what)
    what = "multiplies the rotations, to radians"
    sub.add_argument("--rotation-scale", type=scale, default=1.0, metavar="X", help=what)
    what = "the curve is linear between these parts of the largest load; default: 0.2,0.5, of a run 0,0.2"
    sub.add_argument("--linear", type=numbers, metavar="LOW,HIGH", help=what)
    sub.add_argument("--no-toe", action="store_true", help="leave the origin where it is")
    what = "compliance of the machine, whose part of the opening is taken off"
    sub.add_argument("--machine-compliance", type=number, default=0.0, metavar="C", help=what)
    what = "dcb: factors F and N of large openings; of runs with finite rotations they always count"
    sub.add_argument("--large", action="store_true", help=what)
    what = "dcb: load blocks, from the pin to the middle of the arm and to the edge of the block"
    sub.add_argument("--block", type=numbers, default=(0.0, 0.0), metavar="L1,L2", help=what)
    what = "compliances of precracks that were not broken, for CC of an enf"
    sub.add_argument("--calibration", type=numbers, default=[], metavar="A,C,A,C,...", help=what)
    sub.add_argument("--begin", type=fraction, metavar="D", help="crack growth from which propagation counts")
    sub.add_argument("--end", type=fraction, metavar="D", help="and up to which it does")
    sub.add_argument("--fit", action="store_true", help="strength and toughness by least squares on a cohesive beam")
    sub.add_argument("--out", type=place, metavar="DIR", help="write reduce.json, reduce.csv and reduce.html")


def _compare_options(sub: Parser) -> None:
    sub._negative_number_matcher = NEGATIVE
    sub.add_argument("a", metavar="A", type=place, help="CSV file or folder of a run")
    sub.add_argument("b", metavar="B", type=place, help="what A is held against")
    for side in "ab":
        own = f"of {side.upper()}"
        sub.add_argument(f"--opening-{side}", type=column, metavar="COLUMN", help=f"name or number {own}'s opening")
        sub.add_argument(f"--load-{side}", type=column, metavar="COLUMN", help=f"name or number {own}'s load")
        for key in ("opening", "load"):
            what = f"multiplies the {key} {own}: units, and signs"
            sub.add_argument(f"--{key}-scale-{side}", type=scale, default=1.0, metavar="X", help=what)
    sub.add_argument("--end", type=number, metavar="D", help="compare up to this opening; default: the last of B")
    sub.add_argument("--begin", type=number, metavar="D", help="compare from this opening on; default: 0")
    what = "the load programme, where B does not show its turns: 1.5,0.2,3"
    sub.add_argument("--programme", type=numbers, metavar="D,D,...", help=what)
    sub.add_argument("--at", type=numbers, default=[], metavar="D,D,...", help="print the loads at these openings")
    limit = "fail where the curve error is larger, e.g. 0.01"
    sub.add_argument("--curve-tol", "--tolerance", type=fraction, metavar="T", help=limit)
    sub.add_argument("--peak-tol", type=fraction, metavar="T", help="and where the peak loads differ by more")
    sub.add_argument("--energy-tol", type=fraction, metavar="T", help="and where the works differ by more")
    sub.add_argument("--out", type=place, metavar="DIR", help="write comparison.json and comparison.html")


def _sweep_options(sub: Parser) -> None:
    _jobs_option(sub, "runs at a time")
    where = "let the workers of a dask cluster do the runs; they must see the same files"
    sub.add_argument("--scheduler", metavar="ADDRESS", help=where)
    _dry_run_option(sub)


def _scene_argument(sub: Parser) -> None:
    sub.add_argument("scene", metavar="SCENE", help="a packaged name or a file")


def _set_option(sub: Parser) -> None:
    sub.add_argument("--set", dest="overrides", action="append", default=[], metavar="KEY=VALUE", help="replace a key")


def _out_option(sub: Parser, default: str) -> None:
    sub.add_argument("--out", type=place, default=Path(default), metavar="DIR", help=f"default: {default}")


def _jobs_option(sub: Parser, what: str) -> None:
    sub.add_argument("--jobs", type=positive, default=os.cpu_count() or 1, metavar="N", help=what)


def _dry_run_option(sub: Parser) -> None:
    sub.add_argument("--dry-run", action="store_true", help="print the runs and the time that they would take")
    sub.set_defaults(keeps=("the runs that are done are kept", "does the rest"))


if __name__ == "__main__":  # also `python -m verify.cli`, as programs of earlier environments start it
    raise SystemExit(main())
