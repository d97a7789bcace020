"""The commands: each checks its options, does its work, and returns an exit code."""

from __future__ import annotations

import argparse
import subprocess
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from shutil import get_terminal_size
from typing import TYPE_CHECKING

from verify.support.refusal import Refusal
from verify.support.say import say

if TYPE_CHECKING:
    from verify.checks.foreign_curves import Curve
    from verify.methods.method import NotRun, Prepared
    from verify.result import Result
    from verify.runs.run import Keep
    from verify.scene.schema import Scene
    from verify.studies.plane.study import Plate
    from verify.verdict import Check

FAILED = 1


def solve(options: argparse.Namespace) -> int:
    from verify.methods.method import NotRun
    from verify.methods.solve import prepare, require
    from verify.runs.environment import mpi_rank, mpi_size
    from verify.scene.load import load_scene

    if options.accuracy is not None:
        return _accurate(options)
    name = options.method or "nurbs"
    _known_method(name, options.dofs)
    dofs = [f"discretization.dofs={options.dofs}"] if options.dofs else []
    prepared = prepare(load_scene(options.scene, [*dofs, *options.overrides]), name)
    if mpi_size() > 1 and not prepared.method.ranks:
        raise Refusal(f"--method: must be dolfinx under mpirun, the others run in one process, got {name!r}")
    out = options.out = options.out or Path("debond-out") / f"{prepared.scene.name}-{name}"
    try:
        require(prepared)
    except NotRun as error:
        return _not_run(error)
    _folder(out)
    quiet = mpi_rank() > 0
    if not quiet:
        _say_before(prepared, options.fields and options.frames > 0)
    result, checks = _with_progress(prepared, out, _kept(options), quiet)
    if not quiet:
        _print_result(result, checks, out)
        _say_after(prepared, result, checks)
    return 0 if result.complete and not _broken(checks) else FAILED


def _accurate(options: argparse.Namespace) -> int:
    """Solve to an accuracy: choose method and mesh, announce them with the expected time, verify the solution."""
    from verify.methods import zone_resolution
    from verify.methods.solve import prepare
    from verify.runs.environment import mpi_size
    from verify.runs.run import NO_FIELDS
    from verify.scene.load import load_scene
    from verify.scene.parse import parse_scene
    from verify.studies.cost.accuracy import choose
    from verify.studies.cost.verified import percent, planned, verified

    given = {"--method": options.method, "--dofs": options.dofs}
    for name, value in given.items():
        if value is not None:
            raise Refusal(f"{name}: must be left out with --accuracy, which chooses it, got {value!r}")
    if mpi_size() > 1:
        raise Refusal(f"--accuracy: must be asked for in 1 process, without mpirun, got {mpi_size()}")
    scene = load_scene(options.scene, options.overrides)
    first = choose(scene, options.accuracy, Path("debond-cost") / "cost.json")
    say(planned(scene, first))
    out = options.out or Path("debond-out") / f"{scene.name}-{first.method}"
    _folder(out)
    for decision in prepare(parse_scene(scene.model_dump(), first.overrides), first.method).decisions:
        say(str(decision))

    def solved(level: Scene, method: str, folder: Path, delivers: bool) -> tuple[Result, tuple[Check, ...]]:
        return _with_progress(prepare(level, method), folder, _kept(options) if delivers else NO_FIELDS, False)

    found = verified(scene, first, options.accuracy, out, solved)
    last = found.delivered
    prepared = prepare(last.scene, last.method)
    _print_result(last.result, last.checks, out)
    print(found.sentence)
    for remark in zone_resolution.warnings(prepared):
        say(remark)
    _say_after(prepared, last.result, last.checks)
    if not found.close:
        remedy = "ask for less, or refine with --dofs and discretization.steps"
        say(f"--accuracy: {percent(found.asked)} has not been reached: {found.why}; {found.sentence}; {remedy}")
    return 0 if found.holds else FAILED


def _kept(options: argparse.Namespace) -> Keep:
    from verify.runs.run import Keep

    return Keep(options.fields, options.frames if options.fields else 0)


def _say_before(prepared: Prepared, frames: bool) -> None:
    """Messages before a run: automatic decisions, keys without effect, and warnings of coarse meshes."""
    from verify.methods import sliding, through_thickness, zone_resolution
    from verify.scene.schema import DEFAULT_STEPS

    coarse = (*zone_resolution.warnings(prepared), *through_thickness.warnings(prepared))
    for remark in (*prepared.decisions, *sliding.remarks(prepared.scene), *coarse):
        say(str(remark))
    if prepared.counted:
        say(f"discretization.steps: {DEFAULT_STEPS}, as {prepared.counted}")
    if frames and not prepared.method.has_mesh:
        say(f"--fields: the method {prepared.method.name} has no bodies to draw: no frames for ParaView")


def _say_after(prepared: Prepared, result: Result, checks: Sequence[Check]) -> None:
    from verify.checks import neglected
    from verify.scene.schema import DEFAULT_STEPS

    for remark in neglected.warnings(prepared, result):
        say(remark)
    if result.counted_steps:
        say(f"discretization.steps: {DEFAULT_STEPS} {result.counted_steps}")
    broken = _broken(checks)
    if result.complete and broken:
        say(f"{result.method}: broken: {', '.join(broken)}; the run or the solver is at fault, not the mesh")


def _broken(checks: Sequence[Check]) -> list[str]:
    return [check.name for check in checks if check.state == "broken"]


def _with_progress(prepared: Prepared, folder: Path, keep: Keep, quiet: bool) -> tuple[Result, tuple[Check, ...]]:
    """Run with a progress bar over the programme."""
    from verify.runs.run import run
    from verify.support.progress import Progress

    scene = prepared.scene
    legs = [abs(b - a) for a, b in zip((0.0, *scene.load.opening), scene.load.opening, strict=False)]
    gone = before = 0.0
    with Progress(f"{scene.name} {prepared.method.name}", sum(legs), quiet) as progress:

        def advance(row: Mapping[str, float]) -> None:
            nonlocal gone, before
            gone, before = gone + abs(row["opening"] - before), row["opening"]
            progress.advance(gone, f"opening {row['opening']:.4g} load {row['load']:.4g}")

        return run(prepared, folder, keep, advance)


def _print_result(result: Result, checks: Sequence[Check], folder: Path) -> None:
    from verify.checks.table import check_table

    peak = result.load.argmax() if result.load.size else None
    if peak is not None:
        print(f"peak load {result.load[peak]:.6g} at opening {result.opening[peak]:.6g}, {result.load.size - 1} steps")
    if result.seconds:
        print("seconds: " + ", ".join(f"{name} {value:.2f}" for name, value in result.seconds.items()))
    print("\n".join(check_table(checks)))
    if not result.complete:
        say(f"{result.method} {result.status}")
    print(f"{', '.join(filter(None, (result.status, result.ending)))}: {folder}")


def verify(options: argparse.Namespace) -> int:
    from verify.checks.judgement import Demands
    from verify.methods import sliding
    from verify.scene.toml import keep_scene
    from verify.studies.found import named
    from verify.verification import Subjects, verify, would_run

    _refuse_ranks("verify")
    scenes, plates = _scenes_and_plates(options)
    curves = _curves(options, len(scenes), len(plates))
    demands = Demands(options.strict, tuple(options.require))
    for method in demands.required:
        _known_method(method, None, "--require")
    ladders = _ladders(options, scenes)
    subjects = Subjects(scenes, options.full, plates, curves, named(options.include), ladders)
    if options.dry_run:
        return _listed(would_run(subjects, options.out, options.jobs))
    _folder(options.out)
    for path, scene in scenes if _set_for_all(options) else ():
        keep_scene(scene, Path(path))
    for remark in {remark for _, scene in scenes for remark in sliding.remarks(scene)}:
        say(remark)
    _writable_file(options.junit, "--junit")
    text = options.format == "md"
    passed = verify(subjects, options.out, options.jobs, options.scheduler, text, demands, options.junit)
    return 0 if passed else FAILED


def _set_for_all(options: argparse.Namespace) -> list[str]:
    """Overrides of every scene of a verification."""
    return [*options.overrides, *([f"load.opening={options.end!r}"] if options.end is not None else [])]


def _scenes_and_plates(options: argparse.Namespace) -> tuple[list[tuple[str, Scene]], list[Plate]]:
    """What is verified, scenes with what repeats their runs: the name or file, or the file of a scene with overrides.

    Raises
    ------
    Refusal : with a sentence for everything that is wrong.
    """
    from verify.methods.given_meshes import given_meshes
    from verify.scene.load import load_scene, verified_scenes
    from verify.studies.plane.study import load_plate

    given = _set_for_all(options)
    scenes: list[tuple[str, Scene]] = []
    plates: list[Plate] = []
    wrong = []
    for source in options.scenes or verified_scenes(options.full):
        try:
            if source.lower().endswith(".iga"):
                plates.append(load_plate(source))
                wrong += [f"--set: is for scenes, got {given[0]} for {source}"] if given else []
                continue
            scene = load_scene(source, given)
            given_meshes(scene)
            kept = options.out / scene.name / "scene.toml"
            if given and kept.exists() and Path(source).exists() and kept.samefile(source):
                wrong.append(f"--out: must be another folder than that of {source}, where the changed scene is kept")
            scenes.append((str(kept) if given else source, scene))
        except Refusal as error:
            wrong.append(str(error))
    names = [*(scene.name for _, scene in scenes), *(plate.name for plate in plates)]
    twice = sorted({name for name in names if names.count(name) > 1})
    wrong += [f"SCENE: must have different names, got {name!r} more than once" for name in twice]
    if wrong:
        raise Refusal("\n".join(wrong))
    return scenes, plates


def _ladders(options: argparse.Namespace, scenes: Sequence[tuple[str, Scene]]) -> Sequence[tuple[str, Scene]]:
    """The scenes of quick ladders: those that are named, else one of the scenes that are verified, or none."""
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


def _curves(options: argparse.Namespace, scenes: int, plates: int) -> tuple[Curve, ...]:
    """The curves of other codes, read with the options for their columns."""
    from verify.checks.foreign_curves import read_curves
    from verify.curves.read import Reading

    keys = ("opening", "load", "opening_scale", "load_scale")
    reading = Reading(**{key: getattr(options, key) for key in keys})
    if options.curves and (scenes, plates) != (1, 0):
        raise Refusal(f"--with: needs one SCENE, which its curve is of, got {scenes + plates}")
    if not options.curves and reading != Reading():
        raise Refusal("--with: is missing, its FILE is what --opening, --load and their scales are about")
    curves = read_curves(options.curves, reading)
    _say_changed(*(curve.path for curve in curves))
    for curve in curves:
        if not max(curve.result.load) > 0.0:
            say(f"--with: no load of {curve.name} is above 0: --load-scale -1 turns its sign")
    return curves


def cost(options: argparse.Namespace) -> int:
    from verify.studies.cost.study import cost, would_run

    scene = _studied(options, "cost")
    if options.dry_run:
        return _listed(would_run(options.scene, scene, options.overrides, options.out, options.jobs))
    _folder(options.out)
    study = cost(options.scene, scene, options.overrides, options.out, options.jobs)
    return 0 if study is not None else FAILED


def _studied(options: argparse.Namespace, command: str) -> Scene:
    """The scene of a study that generates its own meshes."""
    from verify.methods.given_meshes import refuse_files
    from verify.scene.load import load_scene

    _refuse_ranks(command)
    scene = load_scene(options.scene, options.overrides)
    refuse_files(scene, f"debond {command}")
    return scene


def effects(options: argparse.Namespace) -> int:
    from verify.methods.method import NotRun
    from verify.scene.load import load_scene
    from verify.studies.effects.plan import planned
    from verify.studies.effects.study import effects, would_run

    _known_method(options.method, None)
    _refuse_ranks("effects")
    scene = load_scene(options.scene, options.overrides)
    try:
        plan = planned(options.scene, scene, options.method, options.overrides)
    except NotRun as error:
        return _not_run(error)
    if options.dry_run:
        return _listed(would_run(plan, options.out))
    _folder(options.out)
    return 0 if effects(plan, options.out, options.jobs, options.scheduler).complete else FAILED


def viscosity(options: argparse.Namespace) -> int:
    from verify.methods.method import NotRun
    from verify.studies.viscosity.plan import planned
    from verify.studies.viscosity.study import viscosity, would_run

    _known_method(options.method, None)
    scene = _studied(options, "viscosity")
    try:
        plan = planned(options.scene, scene, options.method, options.overrides)
    except NotRun as error:
        return _not_run(error)
    if options.dry_run:
        return _listed(would_run(plan, options.out))
    _folder(options.out)
    return 0 if viscosity(plan, options.out, options.jobs, options.scheduler).complete else FAILED


def validate(options: argparse.Namespace) -> int:
    from verify.methods.method import NotRun
    from verify.studies.validation.plan import planned
    from verify.studies.validation.study import validate, would_run

    _known_method(options.method, None)
    scene = _studied(options, "validate")
    curves = _curves(options, 1, 0)
    if len(curves) != 1:
        raise Refusal(f"--with: must name one curve that the scene is held against, got {len(curves)}")
    try:
        plan = planned(options.scene, scene, options.method, options.overrides)
    except NotRun as error:
        return _not_run(error)
    if options.dry_run:
        return _listed(would_run(plan, options.out, options.jobs))
    _folder(options.out)
    study = validate(plan, curves[0], options.out, options.at, options.jobs, options.scheduler)
    return 0 if study.complete else FAILED


def certify(options: argparse.Namespace) -> int:
    from verify.methods.method import NotRun
    from verify.studies.certified.keeping import keep, require_checkout
    from verify.studies.certified.plan import planned
    from verify.studies.certified.study import certify, would_run

    scene = _studied(options, "certify")
    if options.keep:
        require_checkout()
    try:
        plan = planned(options.scene, scene, options.at, options.overrides)
    except NotRun as error:
        return _not_run(error)
    if options.dry_run:
        return _listed(would_run(plan, options.out, options.jobs))
    _folder(options.out)
    study = certify(plan, options.out, options.jobs, options.scheduler)
    if options.keep and not study.failures:
        keep(study)
    elif study.kept:
        print("--keep, in a checkout, keeps them: debond verify then holds every run of this problem to them")
    return 0 if study.complete else FAILED


def scaling(options: argparse.Namespace) -> int:
    from verify.studies.scaling.study import scaling, would_run

    scene = _studied(options, "scaling")
    if options.dry_run:
        return _listed(would_run(options.scene, scene, options.overrides, options.out))
    _folder(options.out)
    return 0 if scaling(options.scene, scene, options.overrides, options.out).complete else FAILED


def hard(options: argparse.Namespace) -> int:
    from verify.studies.hard.cases import chosen
    from verify.studies.hard.suite import dry_run, hard

    if "random" in options.names:
        return _random(options)
    if options.seeds is not None:
        raise Refusal("--seeds: is for random scenes; debond hard random --seeds 40")
    cases = chosen(options.names)
    if options.dry_run:
        return _listed(dry_run(cases, options.out, options.jobs))
    _folder(options.out)
    return 0 if hard(cases, options.out, options.jobs, options.scheduler) else FAILED


def _random(options: argparse.Namespace) -> int:
    """The campaign on random scenes."""
    from verify.studies.campaign import campaign, would_run

    if options.names != ["random"]:
        raise Refusal("random: must be the only NAME, it is a campaign of its own")
    first, last = options.seeds or (0, 39)
    seeds = range(first, last + 1)
    if options.dry_run:
        return _listed(would_run(seeds, options.out, options.jobs))
    _folder(options.out)
    return 0 if campaign(seeds, options.out, options.jobs, options.scheduler) else FAILED


def compare(options: argparse.Namespace) -> int:
    from verify.command_line import compare as work
    from verify.curves.compare import checks
    from verify.curves.read import Reading
    from verify.curves.wording import complaints, remarks, table

    keys = ("opening", "load", "opening_scale", "load_scale")
    a, b = (
        work.Source(getattr(options, side), Reading(**{key: getattr(options, f"{key}_{side}") for key in keys}))
        for side in "ab"
    )
    _say_changed(options.a, options.b)
    comparison, loads = work.held_against(a, b, options.end, options.at, options.begin, options.programme)
    if options.out is not None:
        _folder(options.out)
    found = checks(comparison, options.curve_tol, options.peak_tol, options.energy_tol)
    print("\n".join(table(comparison, loads, found)), flush=True)
    for remark in remarks(comparison):
        say(remark)
    if options.out is not None:
        work.write(options.out, (a, b), comparison, loads, found)
        print(f"written: {options.out}")
    for complaint in complaints(comparison, found):
        say(complaint)
    if not all(check.passed for check in found):
        work.explain((a, b), options.curve_tol)
        return FAILED
    return 0


def _say_changed(*paths: Path) -> None:
    """A remark on every folder of a run whose curve is not the one that the run wrote."""
    from verify.runs.folder import changed

    for path in filter(Path.is_dir, paths):
        if said := changed(path):
            say(said)


def reduce(options: argparse.Namespace) -> int:
    from verify.studies.reduce import command as work

    test, found, known, fit = work.reduced(options)
    if options.out is not None:
        _folder(options.out)
    work.report(found, known, fit)
    if options.out is not None:
        work.write(options.out, str(options.file), test.scene, found, known, fit)
    return 0


def law(options: argparse.Namespace) -> int:
    from verify.command_line import law as work
    from verify.export.point_law import write_paths
    from verify.scene.load import load_scene
    from verify.studies.law.given.read import PathColumns
    from verify.studies.law.study import subject

    scene = load_scene(options.scene, options.overrides)
    of, columns = subject(scene), PathColumns(dict(options.columns), dict(options.scales))
    if options.write is not None:
        _folder(options.write, "--write")
        print("\n".join(f"written: {path}" for path in write_paths(of.bond, of.ways, scene.name, options.write)))
        if options.given is None and options.out is None:
            return 0
    found, name = work.judged(of, options.given, columns, options.tolerance)
    if options.out is not None:
        _folder(options.out)
        work.write(found, scene, name, options.out)
    work.report(found, scene, name)
    return 0 if found.passed else FAILED


def export(options: argparse.Namespace) -> int:
    from verify.export.command import FORMATS, export
    from verify.methods.given_meshes import refuse_files
    from verify.scene.load import load_scene
    from verify.scene.tables import one_of

    if options.format not in FORMATS:
        raise Refusal(f"--format: must be {one_of(FORMATS)}, got {options.format!r}")
    elements = [f"dolfinx.elements={options.elements}"] if options.elements else []
    scene = load_scene(options.scene, [*elements, *options.overrides])
    refuse_files(scene, "debond export")
    folder = options.out or Path("debond-export") / f"{scene.name}-{options.format}"
    return _listed(export(scene, options.format, folder, options.layers, options.merged))


def mesh(options: argparse.Namespace) -> int:
    from verify.command_line.mesh import examine

    return 0 if examine(options.file, options.out, options.json, options.control) else FAILED


def scenes(options: argparse.Namespace) -> int:
    from verify.command_line import scene_list
    from verify.methods.plugins import plugins
    from verify.scene.load import load_scene, packaged_scenes

    width = get_terminal_size((200, 24)).columns  # one line a scene for programs
    if options.scenes:
        return _listed(["\n\n".join([scene_list.page(load_scene(name), width) for name in options.scenes])])
    for name in packaged_scenes():
        print(scene_list.line(name, load_scene(name), width))
    for plugin in plugins().values():
        print(f"method of another package: {plugin.name} ({plugin.package})")
    return 0


def new(options: argparse.Namespace) -> int:
    from verify.command_line.new_scene import from_scene, new_scene
    from verify.scene.load import load_scene

    if (options.kind is None) == (options.scene is None):
        raise Refusal("new: must be given either a KIND of specimen or --from SCENE")
    if options.scene is None and options.overrides:
        raise Refusal("--set: is for a scene that is there; debond new --from SCENE --set KEY=VALUE")
    text = (
        new_scene(options.kind) if options.scene is None else from_scene(load_scene(options.scene, options.overrides))
    )
    print(text, end="")
    return 0


def completion(options: argparse.Namespace) -> int:
    from verify.command_line.completion import SHELLS, script
    from verify.scene.tables import one_of

    if options.shell not in SHELLS:
        raise Refusal(f"SHELL: must be {one_of(SHELLS)}, got {options.shell!r}")
    print(script(options.parser, options.shell), end="")
    return 0


def doctor(options: argparse.Namespace) -> int:
    from verify.command_line.doctor import examine

    lines, works = examine()
    print("\n".join(lines))
    return 0 if works else FAILED


def test(options: argparse.Namespace) -> int:
    tests = Path(__file__).resolve().parents[2] / "tests"
    if not tests.is_dir():
        raise Refusal("test: the tests are not installed; run it in a copy of the repository")
    return subprocess.call([sys.executable, "-m", "pytest", *options.rest], cwd=tests.parent)


def _listed(lines: Sequence[str]) -> int:
    print("\n".join(lines))
    return 0


def _refuse_ranks(command: str) -> None:
    from verify.runs.environment import mpi_size

    if mpi_size() > 1:
        raise Refusal(f"{command}: must be started in 1 process, without mpirun, got {mpi_size()}")


def _known_method(method: str, dofs: int | None, option: str = "--method") -> None:
    from verify.methods.names import WITH_DOFS
    from verify.methods.plugins import find, known_methods
    from verify.scene.complaints import suggestion
    from verify.scene.tables import one_of

    known = known_methods()
    if method not in known:
        later = f"; {suggestion(method, known)}".rstrip("; ")
        raise Refusal(f"{option}: must be {one_of(known)}, got {method!r}{later}")
    if dofs and method not in WITH_DOFS:
        other = "; --set dolfinx.elements=N sets its mesh" if find(method).has_mesh else ""
        raise Refusal(f"--dofs: is only for --method {one_of(WITH_DOFS)}, got {dofs} for {method}{other}")


def _folder(path: Path, option: str = "--out") -> None:
    """Create the output folder now, so that a folder without write permission is refused before the work."""
    try:
        path.mkdir(parents=True, exist_ok=True)
        (path / ".writable").touch()
        (path / ".writable").unlink(missing_ok=True)
    except OSError as error:
        text = f"must be a folder that can be written to, got {str(path)!r}: {error.strerror}"
        raise Refusal(f"{option}: {text}") from None


def _writable_file(path: Path | None, option: str) -> None:
    """A file that cannot be written is refused before the work; one that is there keeps its content."""
    if path is None:
        return
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.open("ab").close()
    except OSError as error:
        raise Refusal(f"{option}: must be a file that can be written, got {str(path)!r}: {error.strerror}") from None


def _not_run(error: NotRun) -> int:
    ways = [". Ways to get it:", *(f"\n  {way}" for way in error.ways)] if error.ways else []
    say("".join([str(error), *ways]))
    return FAILED
