"""The command line. Everything that a user can get wrong is refused here, before any work, with exit code 2."""

from __future__ import annotations

import os
import sys

for _name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(_name, "1")  # before NumPy is imported; timings would mean little otherwise

import argparse  # noqa: E402
import math  # noqa: E402
import re  # noqa: E402
import subprocess  # noqa: E402
from collections.abc import Sequence  # noqa: E402
from pathlib import Path  # noqa: E402

from verify.refusal import Refusal  # noqa: E402

FAILED, REFUSED, INTERRUPTED = 1, 2, 130


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command; its exit code: 0 fine, 1 something failed, 2 bad input, 130 interrupted."""
    options = parser().parse_args(arguments)
    try:
        return options.command(options)
    except Refusal as error:
        _say(f"debond: {error}")
        return REFUSED
    except KeyboardInterrupt:
        where = f"; what is in {options.out} is valid" if getattr(options, "out", None) else ""
        _say(f"debond: interrupted{where}")
        return INTERRUPTED
    except BrokenPipeError:  # the reader of our output has left: no more of it, and no complaint at exit
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return FAILED


def parser() -> argparse.ArgumentParser:
    """Every command with its options and one example."""
    text = "Verify codes for interface debonding."
    top = argparse.ArgumentParser(prog="debond", description=text, epilog="example: debond verify", allow_abbrev=False)
    commands = top.add_subparsers(title="commands", required=True, metavar="COMMAND")

    def command(name: str, function, text: str, example: str) -> argparse.ArgumentParser:
        texts = {"help": text, "description": text, "epilog": f"example: debond {example}"}
        sub = commands.add_parser(name, **texts, allow_abbrev=False)
        sub.set_defaults(command=function)
        return sub

    sub = command("verify", _verify, "Every method on every scene, all checks, one report.", "verify dcb-czm1 --jobs 2")
    what = "packaged name, scene file, or .iga mesh for a plane problem; default: those of the paper"
    sub.add_argument("scenes", nargs="*", metavar="SCENE", help=what)
    sub.add_argument("--out", type=Path, default=Path("debond-report"), metavar="DIR", help="default: debond-report")
    finer = (
        "finer meshes as well, with observed order and uncertainty, T-splines that follow the process zone, interface "
        "rules, and the figures of the paper"
    )
    sub.add_argument("--full", action="store_true", help=finer)
    _sweep_options(sub)

    text = "One scene by one method: T-splines, NURBS, Lagrange or DOLFINx elements, a beam, LEFM."
    example = "solve dcb-czm1 --method tspline --set discretization.adaptive=true"
    sub = command("solve", _solve, text, example)
    sub.add_argument("scene", metavar="SCENE", help="a packaged name or a file")
    sub.add_argument("--method", metavar="M", help="tspline, nurbs (default), lagrange, dolfinx, ...")
    sub.add_argument("--dofs", type=_positive, metavar="N", help="unknowns to aim at, for tspline, nurbs and lagrange")
    what = "choose method and mesh for this error of the curve, like 0.3%%, and say how long it takes"
    sub.add_argument("--accuracy", type=_accuracy, metavar="A", help=what)
    sub.add_argument("--set", dest="overrides", action="append", default=[], metavar="KEY=VALUE", help="replace a key")
    sub.add_argument("--out", type=Path, metavar="DIR", help="default: debond-out/SCENE-METHOD")
    sub.add_argument("--fields", action="store_true", help="keep fields of a few steps in fields.npz")

    text = "What accuracy costs in time: every method on ever finer meshes, one chart."
    sub = command("cost", _cost, text, "cost dcb-czm1 --out cost")
    sub.add_argument("scene", metavar="SCENE", help="a packaged name or a file")
    sub.add_argument("--set", dest="overrides", action="append", default=[], metavar="KEY=VALUE", help="replace a key")
    sub.add_argument("--out", type=Path, default=Path("debond-cost"), metavar="DIR", help="default: debond-cost")
    alone = "runs of the reference at a time; what is timed runs alone"
    sub.add_argument("--jobs", type=_positive, default=os.cpu_count() or 1, metavar="N", help=alone)
    sub.add_argument("--dry-run", action="store_true", help="print the runs and the time that they would take")

    text = "What each effect changes and costs: on and off, everything else as the scene says."
    sub = command("effects", _effects, text, "effects dcb-czm1 --out effects")
    sub.add_argument("scene", metavar="SCENE", help="a packaged name or a file")
    sub.add_argument("--method", default="nurbs", metavar="M", help="tspline, nurbs (default), lagrange, dolfinx, ...")
    sub.add_argument("--set", dest="overrides", action="append", default=[], metavar="KEY=VALUE", help="replace a key")
    sub.add_argument("--out", type=Path, default=Path("debond-effects"), metavar="DIR", help="default: debond-effects")
    _sweep_options(sub)

    text = "How time and memory grow up to 100,000 unknowns, what more ranks gain, what to expect of many."
    sub = command("scaling", _scaling, text, "scaling dcb-czm1 --out scaling")
    sub.add_argument("scene", metavar="SCENE", help="a packaged name or a file")
    sub.add_argument("--set", dest="overrides", action="append", default=[], metavar="KEY=VALUE", help="replace a key")
    sub.add_argument("--out", type=Path, default=Path("debond-scaling"), metavar="DIR", help="default: debond-scaling")
    sub.add_argument("--dry-run", action="store_true", help="print the runs and the time that they would take")

    sub = command("hard", _hard, "The cases on which cohesive codes stop or go wrong.", "hard coarse-czm2 --jobs 2")
    sub.add_argument("names", nargs="*", metavar="NAME", help="hard cases; default: all")
    sub.add_argument("--out", type=Path, default=Path("debond-hard"), metavar="DIR", help="default: debond-hard")
    _sweep_options(sub)

    text = "Two load-opening curves: error, peak, energy; of runs, or of anybody's code."
    example = "compare my.csv run --opening-a U2 --load-a RF2 --curve-tol 0.01"
    _compare_options(command("compare", _compare, text, example))

    sub = command("mesh", _mesh, "What a mesh file holds, and its picture.", "mesh arch.iga --out arch.vtu")
    sub.add_argument("file", metavar="FILE", type=Path, help=".iga file of the Rhino T-spline plug-in")
    formats = ".svg, .png, .pdf: picture; .vtu: Bezier cells; .iga; default: debond-mesh/FILE.svg"
    sub.add_argument("--out", type=Path, metavar="FILE", help=formats)
    sub.add_argument("--json", action="store_true", help="print the facts as JSON")
    sub.add_argument("--control", action="store_true", help="draw the control points too")

    command("scenes", _scenes, "List the packaged scenes.", "scenes")
    command("doctor", _doctor, "What is installed, what works, how to get the rest.", "doctor")
    sub = command("test", _test, "Run the tests; arguments go to pytest.", "test -k curve")
    sub.add_argument("rest", nargs=argparse.REMAINDER, metavar="ARG")
    return top


def _sweep_options(sub: argparse.ArgumentParser) -> None:
    sub.add_argument("--jobs", type=_positive, default=os.cpu_count() or 1, metavar="N", help="runs at a time")
    where = "let the workers of a dask cluster do the runs; they must see the same files"
    sub.add_argument("--scheduler", metavar="ADDRESS", help=where)
    sub.add_argument("--dry-run", action="store_true", help="print the runs and the time that they would take")


def _compare_options(sub: argparse.ArgumentParser) -> None:
    # argparse takes -1 and -0.5 for numbers, but -1e-3 for an option
    sub._negative_number_matcher = re.compile(r"-\.?\d")
    sub.add_argument("a", metavar="A", type=Path, help="CSV file or folder of a run")
    sub.add_argument("b", metavar="B", type=Path, help="what A is held against")
    for side in "ab":
        own = f"of {side.upper()}"
        sub.add_argument(f"--opening-{side}", type=_column, metavar="COLUMN", help=f"name or number {own}'s opening")
        sub.add_argument(f"--load-{side}", type=_column, metavar="COLUMN", help=f"name or number {own}'s load")
        for key in ("opening", "load"):
            what = f"multiplies the {key} {own}: units, and signs"
            sub.add_argument(f"--{key}-scale-{side}", type=_scale, default=1.0, metavar="X", help=what)
    sub.add_argument("--end", type=_number, metavar="D", help="compare up to this opening; default: the last of B")
    sub.add_argument("--begin", type=_number, metavar="D", help="compare from this opening on; default: 0")
    sub.add_argument("--at", type=_numbers, default=[], metavar="D,D,...", help="print the loads at these openings")
    limit = "fail where the curve error is larger, e.g. 0.01"
    sub.add_argument("--curve-tol", "--tolerance", type=_fraction, metavar="T", help=limit)
    sub.add_argument("--peak-tol", type=_fraction, metavar="T", help="and where the peak loads differ by more")
    sub.add_argument("--energy-tol", type=_fraction, metavar="T", help="and where the works differ by more")
    sub.add_argument("--out", type=Path, metavar="DIR", help="write comparison.json and comparison.html")


def _solve(options: argparse.Namespace) -> int:
    from verify import neglected
    from verify.effects import decided
    from verify.methods import NotRun, require
    from verify.process_zone import warnings
    from verify.run import mpi_rank, mpi_size, run
    from verify.scene import load_scene

    if options.accuracy is not None:
        _chosen(options)
    options.method = options.method or "nurbs"
    _known_method(options.method, options.dofs)
    dofs = [f"discretization.dofs={options.dofs}"] if options.dofs else []
    scene = load_scene(options.scene, [*dofs, *options.overrides])
    if mpi_size() > 1 and options.method != "dolfinx":
        raise Refusal(f"--method: must be dolfinx under mpirun, the others run in one process, got {options.method!r}")
    options.out = options.out or Path("debond-out") / f"{scene.name}-{options.method}"
    quiet = mpi_rank() > 0
    try:
        require(scene, options.method)
    except NotRun as error:
        return _not_run(error)
    _folder(options.out)
    if not quiet:
        for remark in (*decided(scene, options.method), *warnings(scene, options.method)):
            _say(f"debond: {remark}")
    result, checks = _watched(run, scene, options, quiet)
    if not quiet:
        _print_result(result, checks, options.out)
        for remark in neglected.warnings(scene, result):
            _say(f"debond: {remark}")
    return 0 if result.complete else FAILED


def _chosen(options: argparse.Namespace) -> None:
    """Put the method and the mesh for an accuracy into the options, and say what and for how long."""
    from verify.cost.accuracy import choose
    from verify.run import mpi_size
    from verify.scene import load_scene

    given = {"--method": options.method, "--dofs": options.dofs}
    for name, value in given.items():
        if value is not None:
            raise Refusal(f"{name}: must be left out with --accuracy, which chooses it, got {value!r}")
    if mpi_size() > 1:
        raise Refusal(f"--accuracy: must be asked for in 1 process, without mpirun, got {mpi_size()}")
    choice = choose(load_scene(options.scene, options.overrides), options.accuracy, Path("debond-cost") / "cost.json")
    _say(f"debond: {choice.why}")
    options.method, options.overrides = choice.method, [*options.overrides, *choice.overrides]


def _watched(run, scene, options: argparse.Namespace, quiet: bool):
    """The run with its progress along the programme."""
    from verify.progress import Progress

    legs = [abs(b - a) for a, b in zip((0.0, *scene.load.opening), scene.load.opening, strict=False)]
    with Progress(f"{scene.name} {options.method}", sum(legs), quiet) as progress:
        travelled = _Travelled()
        return run(
            scene,
            options.method,
            options.out,
            options.fields,
            lambda row: progress.advance(travelled(row), f"opening {row['opening']:.4g} load {row['load']:.4g}"),
        )


class _Travelled:
    """How far the opening has gone, back and forth added up."""

    def __init__(self) -> None:
        self._opening, self._way = 0.0, 0.0

    def __call__(self, row) -> float:
        self._way += abs(row["opening"] - self._opening)
        self._opening = row["opening"]
        return self._way


def _print_result(result, checks, folder: Path) -> None:
    from verify.table import check_table

    peak = result.load.argmax() if result.load.size else None
    if peak is not None:
        print(f"peak load {result.load[peak]:.6g} at opening {result.opening[peak]:.6g}, {result.load.size - 1} steps")
    if result.seconds:
        print("seconds: " + ", ".join(f"{name} {value:.2f}" for name, value in result.seconds.items()))
    print("\n".join(check_table(checks)))
    if not result.complete:
        _say(f"debond: {result.method} {result.status}")
    print(f"{', '.join(filter(None, (result.status, result.ending)))}: {folder}")


def _verify(options: argparse.Namespace) -> int:
    from verify.plane_study import load_plate
    from verify.run import mpi_size
    from verify.scene import load_scene, verified_scenes
    from verify.verification import verify, would_run

    if mpi_size() > 1:
        raise Refusal(f"verify: must be started in 1 process, without mpirun, got {mpi_size()}")
    scenes, plates, wrong = [], [], []
    for source in options.scenes or verified_scenes(options.full):
        try:
            if source.lower().endswith(".iga"):
                plates.append(load_plate(source))
            else:
                scenes.append((source, load_scene(source)))
        except Refusal as error:
            wrong.append(str(error))
    names = [*(scene.name for _, scene in scenes), *(plate.name for plate in plates)]
    twice = sorted({name for name in names if names.count(name) > 1})
    wrong += [f"SCENE: must have different names, got {name!r} more than once" for name in twice]
    if wrong:
        raise Refusal("\n".join(wrong))
    if options.dry_run:
        return _listed(would_run(scenes, options.out, options.jobs, options.full))
    _folder(options.out)
    return 0 if verify(scenes, options.out, options.jobs, options.full, plates, options.scheduler) else FAILED


def _cost(options: argparse.Namespace) -> int:
    from verify.cost.study import cost, would_run
    from verify.run import mpi_size
    from verify.scene import load_scene

    if mpi_size() > 1:
        raise Refusal(f"cost: must be started in 1 process, without mpirun, got {mpi_size()}")
    scene = load_scene(options.scene, options.overrides)
    what = (options.scene, scene, options.overrides, options.out, options.jobs)
    if options.dry_run:
        return _listed(would_run(*what))
    _folder(options.out)
    return 0 if cost(*what) is not None else FAILED


def _effects(options: argparse.Namespace) -> int:
    from verify.methods import NotRun, require
    from verify.run import mpi_size
    from verify.scene import load_scene
    from verify.switches.study import effects, would_run

    _known_method(options.method, None)
    if mpi_size() > 1:
        raise Refusal(f"effects: must be started in 1 process, without mpirun, got {mpi_size()}")
    scene = load_scene(options.scene, options.overrides)
    what = (options.scene, scene, options.method, options.overrides, options.out)
    try:
        if options.dry_run:
            return _listed(would_run(*what))
        require(scene, options.method)
        _folder(options.out)
        return 0 if effects(*what, options.jobs, options.scheduler).complete else FAILED
    except NotRun as error:
        return _not_run(error)


def _scaling(options: argparse.Namespace) -> int:
    from verify.run import mpi_size
    from verify.scaling.study import scaling, would_run
    from verify.scene import load_scene

    if mpi_size() > 1:
        raise Refusal(f"scaling: must be started in 1 process, without mpirun, got {mpi_size()}")
    what = (options.scene, load_scene(options.scene, options.overrides), options.overrides, options.out)
    if options.dry_run:
        return _listed(would_run(*what))
    _folder(options.out)
    return 0 if scaling(*what).complete else FAILED


def _hard(options: argparse.Namespace) -> int:
    from verify.hard.cases import chosen
    from verify.hard.suite import dry_run, hard

    cases = chosen(options.names)
    if options.dry_run:
        return _listed(dry_run(cases, options.out, options.jobs))
    _folder(options.out)
    return 0 if hard(cases, options.out, options.jobs, options.scheduler) else FAILED


def _listed(lines: Sequence[str]) -> int:
    print("\n".join(lines))
    return 0


def _compare(options: argparse.Namespace) -> int:
    from verify import compare_command as work
    from verify.compare import checks
    from verify.compare_words import complaints, remarks, table
    from verify.curve_file import Reading

    keys = ("opening", "load", "opening_scale", "load_scale")
    a, b = (
        work.Source(getattr(options, side), Reading(**{key: getattr(options, f"{key}_{side}") for key in keys}))
        for side in "ab"
    )
    comparison, loads = work.held_against(a, b, options.end, options.at, options.begin)
    if options.out is not None:
        _folder(options.out)
    found = checks(comparison, options.curve_tol, options.peak_tol, options.energy_tol)
    print("\n".join(table(comparison, loads, found)), flush=True)
    for remark in remarks(comparison):
        _say(f"debond: {remark}")
    if options.out is not None:
        work.write(options.out, (a, b), comparison, loads, found, _say)
        print(f"written: {options.out}")
    for complaint in complaints(comparison, found):
        _say(f"debond: {complaint}")
    return 0 if all(check.passed for check in found) else FAILED


def _mesh(options: argparse.Namespace) -> int:
    from verify.mesh_command import examine

    return 0 if examine(options.file, options.out, options.json, options.control, _say) else FAILED


def _scenes(options: argparse.Namespace) -> int:
    from verify.scene import load_scene, packaged_scenes

    for name in packaged_scenes():
        scene = load_scene(name)
        law, specimen, opening = scene.interface, scene.specimen, max(scene.load.opening)
        print(
            f"{name:24} {specimen.kind}, {scene.effects.kinematics} kinematics, strength {law.strength:g}, "
            f"toughness {law.toughness:g}, opened to {opening:g} ({scene.units})"
        )
    return 0


def _doctor(options: argparse.Namespace) -> int:
    from verify.doctor import examine

    lines, works = examine()
    print("\n".join(lines))
    return 0 if works else FAILED


def _test(options: argparse.Namespace) -> int:
    tests = Path(__file__).resolve().parent.parent / "tests"
    if not tests.is_dir():
        raise Refusal("test: the tests are not installed; run it in a copy of the repository")
    return subprocess.call([sys.executable, "-m", "pytest", *options.rest], cwd=tests.parent)


def _known_method(method: str, dofs: int | None) -> None:
    from verify.complaints import one_of, suggestion
    from verify.methods import METHODS, WITH_DOFS

    if method not in METHODS:
        later = f"; {suggestion(method, METHODS)}".rstrip("; ")
        raise Refusal(f"--method: must be {one_of(METHODS)}, got {method!r}{later}")
    if dofs and method not in WITH_DOFS:
        other = "; --set dolfinx.elements=N sets its mesh" if method == "dolfinx" else ""
        raise Refusal(f"--dofs: is only for --method {one_of(WITH_DOFS)}, got {dofs} for {method}{other}")


def _folder(path: Path) -> None:
    """Make the output folder now, so that hours of work do not end at a closed door."""
    try:
        path.mkdir(parents=True, exist_ok=True)
        (path / ".writable").touch()
        (path / ".writable").unlink(missing_ok=True)
    except OSError as error:
        raise Refusal(f"--out: must be a folder that can be written to, got {str(path)!r}: {error.strerror}") from None


def _not_run(error: Exception) -> int:
    from verify.methods import DOLFINX_WAYS

    _say("\n".join([f"debond: {error}. Ways to get it:", *(f"  {way}" for way in DOLFINX_WAYS)]))
    return FAILED


def _positive(text: str) -> int:
    value = int(text) if text.isascii() and text.isdigit() and len(text) < 10 else 0
    if value < 1:
        raise argparse.ArgumentTypeError(f"must be an integer >= 1, got {text!r}")
    return value


def _accuracy(text: str) -> float:
    share = text.removesuffix("%").strip()
    return _fraction(share) / (100.0 if text.endswith("%") else 1.0)


def _fraction(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = -1.0
    if not 0 <= value < float("inf"):
        raise argparse.ArgumentTypeError(f"must be a number >= 0, got {text!r}")
    return value


def _column(text: str) -> str | int:
    return int(text) if text.isascii() and text.isdigit() and len(text) < 10 else text


def _scale(text: str) -> float:
    value = _number(text)
    if value == 0.0:
        raise argparse.ArgumentTypeError(f"must be a finite number other than 0, got {text!r}")
    return value


def _numbers(text: str) -> list[float]:
    return [_number(part) for part in text.split(",")]


def _number(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise argparse.ArgumentTypeError(f"must be a finite number, got {text!r}")
    return value


def _say(text: str) -> None:
    print(text, file=sys.stderr, flush=True)


if __name__ == "__main__":
    raise SystemExit(main())
