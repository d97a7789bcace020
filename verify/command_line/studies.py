"""Commands of many runs or of none: what accuracy, effects and keys cost, statements, laws, data reduction."""

from __future__ import annotations

import argparse
from functools import partial
from pathlib import Path

from verify.command_line.answers import FAILED, ended, known_method, output_folder, peer_names, refuse_ranks, studied
from verify.command_line.arguments import (
    column,
    columns,
    fraction,
    names_of,
    number,
    numbers,
    place,
    positives,
    scale,
    scales_of,
    seeds,
)  # fmt: skip
from verify.command_line.curves import CURVES, column_options, foreign_curves
from verify.command_line.options import (
    BY_METHOD,
    DRY_RUN,
    PEERS,
    SCENE,
    SET,
    SWEEP,
    command,
    flag,
    folder,
    jobs,
    several,
    value,
)
from verify.support.refusal import Refusal
from verify.support.say import say, write_page

#: Families of scenes that are made by their seeds.
OF_SEEDS = ("random", "plain")

#: Broken checks of a law that are printed.
BROKEN_LINES = 12


@command(
    "What accuracy costs in time: every method on ever finer meshes, one chart.",
    "cost dcb-czm1 --out cost",
    "read cost/report.html",
    *(SCENE, SET, PEERS, folder("debond-cost")),
    jobs("runs of the reference at a time; what is timed runs alone"),
    DRY_RUN,
)
def cost(options: argparse.Namespace) -> int:
    from verify.studies.cost.plan import plan_of
    from verify.studies.cost.study import cost, would_run

    scene = studied(options, "cost")
    plan = plan_of(scene, tuple(peer_names(options.peers)))
    what = options.scene, scene, options.overrides, options.out, options.jobs, plan

    def work() -> bool:
        study = cost(*what)
        return study is not None and study.complete

    return ended(options, lambda: would_run(*what), work)


@command(
    "What each effect changes and costs: on and off, everything else as the scene says.",
    "effects dcb-czm1 --out effects",
    "read effects/report.html",
    *(SCENE, BY_METHOD, SET, folder("debond-effects"), *SWEEP),
)
def effects(options: argparse.Namespace) -> int:
    from verify.scene.load import load_scene
    from verify.studies.effects import Study, planned
    from verify.studies.pairs import compared, would_run

    known_method(options.method, None)
    refuse_ranks("effects")
    scene = load_scene(options.scene, options.overrides)
    plan = planned(options.scene, scene, options.method, options.overrides)
    return ended(
        options,
        lambda: would_run(plan, options.out),
        lambda: compared(Study, plan, options.out, options.jobs, options.scheduler).complete,
    )


@command(
    "What any key changes and costs: the scene with each of its values, held against the first.",
    "vary enf-as4peek --set interface.viscosity=0,0.001,0.01,0.1 --out vary",
    "read vary/report.html",
    *(SCENE, BY_METHOD),
    several(
        "--set", "KEY=A,B,C", "a key and its values, each in turn; several keys: every combination", dest="overrides"
    ),
    value("--ranks", "1,2,4", "MPI ranks of DOLFINx, each in turn", positives, [1]),
    *(folder("debond-vary"), *SWEEP),
)
def vary(options: argparse.Namespace) -> int:
    from verify.studies.pairs import compared, would_run
    from verify.studies.vary import Study, planned

    known_method(options.method, None)
    refuse_ranks("vary")
    plan = planned(options.scene, options.overrides, options.method, options.ranks)
    return ended(
        options,
        lambda: would_run(plan, options.out),
        lambda: compared(Study, plan, options.out, options.jobs, options.scheduler).complete,
    )


@command(
    "A statement of ASME V&V 20 on the error of the model: a measured curve against a scene, with uncertainties.",
    "validate dcb-czm1 --with lab.csv --out validation",
    "read validation/report.html; exit 0: a statement could be made",
    *(SCENE, *CURVES),
    value("--at", "D,D,...", "the loads at these openings as well", numbers, []),
    *(BY_METHOD, SET, folder("debond-validation"), *SWEEP),
)
def validate(options: argparse.Namespace) -> int:
    from verify.studies.frame import would_run
    from verify.studies.uncertainty import run_study
    from verify.studies.validation.study import judged, planned

    known_method(options.method, None)
    scene = studied(options, "validate")
    curves = foreign_curves(options, [scene])
    if len(curves) != 1:
        raise Refusal(f"--with: must name one curve that the scene is held against, got {len(curves)}")
    plan = planned(options.scene, scene, options.method, options.overrides, options.at)
    judge = partial(judged, plan, curves[0])
    return ended(
        options,
        lambda: would_run(plan.jobs, plan.left_out, options.out, options.jobs),
        lambda: run_study(plan, judge, options.out, options.jobs, options.scheduler).complete,
    )


@command(
    "Values that two codes agree on, with their uncertainties, to hold other codes against.",
    "certify dcb-czm1 --out certified",
    "read certified/report.html; exit 0: every value is certified",
    SCENE,
    value("--at", "D,D,...", "the loads at these openings; default: at every quarter of the programme", numbers, []),
    *(SET, folder("debond-certified")),
    flag("--keep", "in a checkout: keep the values for debond verify, in place of those that are there"),
    *SWEEP,
)
def certify(options: argparse.Namespace) -> int:
    from verify.studies.certified.keeping import keep, require_checkout
    from verify.studies.certified.study import judged, planned
    from verify.studies.frame import would_run
    from verify.studies.uncertainty import run_study

    scene = studied(options, "certify")
    if options.keep:
        require_checkout()
    plan = planned(options.scene, scene, options.at, options.overrides)

    def work() -> bool:
        study = run_study(plan, partial(judged, plan), options.out, options.jobs, options.scheduler)
        if options.keep and not study.failures:
            keep(study)
        elif not all(one.doubt for one in study.found):
            print("--keep, in a checkout, keeps them: debond verify then holds every run of this problem to them")
        return study.complete

    return ended(options, lambda: would_run(plan.jobs, plan.left_out, options.out, options.jobs), work)


@command(
    "The cases on which cohesive codes stop or go wrong.",
    "hard coarse-czm2 --jobs 2",
    "read debond-hard/report.html",
    value("names", "NAME", "hard cases, or random or plain for scenes by seed; default: all", nargs="*"),
    value(
        "--seeds",
        "N",
        "of random and plain: how many scenes, or the first and the last like 40-79; default: 40",
        seeds,
    ),
    *(folder("debond-hard"), *SWEEP),
)
def hard(options: argparse.Namespace) -> int:
    from verify.studies.campaign import campaign
    from verify.studies.campaign import would_run as would_try
    from verify.studies.hard.cases import chosen
    from verify.studies.hard.suite import dry_run, hard

    how = options.out, options.jobs
    family = next((name for name in options.names if name in OF_SEEDS), None)
    if family is None:
        if options.seeds is not None:
            raise Refusal("--seeds: is for random and plain scenes; debond hard random --seeds 40")
        cases = chosen(options.names)
        return ended(options, lambda: dry_run(cases, *how), lambda: hard(cases, *how, options.scheduler))
    if options.names != [family]:
        raise Refusal(f"{family}: must be the only NAME, it is a campaign of its own")
    first, last = options.seeds or (0, 39)
    names = [f"{family}-{seed}" for seed in range(first, last + 1)]
    return ended(options, lambda: would_try(names, *how), lambda: campaign(family, names, *how, options.scheduler))


@command(
    "A traction law at one point, of the solvers or of anybody's code: judged on displacement paths.",
    "law dcb-czm1 --out law",
    "read law/law.html; exit 0: all checks hold",
    *(SCENE, SET),
    value("--write", "DIR", "write the paths there, paths.csv, with input for Abaqus and MOOSE", place),
    value(
        "--with",
        "LAW",
        "judge this law: tractions on the paths in a file, or module:function; default: that of the solvers",
        dest="given",
    ),
    value(
        "--columns",
        "K=NAME,...",
        "names of columns of the file, like p=S22,t=S12; of path, step, g, s, p, t, dp_dg, dp_ds, dt_dg, dt_ds",
        names_of,
    ),
    value("--scales", "K=X,...", "what multiplies columns of the file: units, and signs, like g=1e3,t=-1", scales_of),
    value(
        "--tolerance",
        "T",
        "largest deviation of tractions, in parts of the strengths, and of energies; default: 1e-4",
        fraction,
    ),
    value(
        "--definition",
        "NAME",
        "judge against this law in place of that of the scene, with its numbers; none: by what any law keeps alone",
    ),
    value("--out", "DIR", "write law.json and law.html", place),
)
def law(options: argparse.Namespace) -> int:
    from verify.checks.table import check_table
    from verify.export.point_law import write_paths
    from verify.runs.folder import write_json
    from verify.scene.load import load_scene
    from verify.studies.law.study import BUILT_IN, judge_built_in, judge_given, subject
    from verify.verdict import counted

    scene = load_scene(options.scene, options.overrides)
    of, name = subject(scene, options.definition), Path(options.given or BUILT_IN).name
    if options.write is not None:
        output_folder(options.write, "--write")
        print("\n".join(f"written: {path}" for path in write_paths(of.bond, of.ways, scene.name, options.write)))
        if options.given is None and options.out is None:
            return 0
    if options.given is not None:
        found = judge_given(of, options.given, options.columns or {}, options.scales or {}, options.tolerance)
    else:
        for option in ("columns", "scales", "tolerance", "definition"):
            if getattr(options, option) is not None:
                raise Refusal(f"--{option}: is only for a law that --with names, got no --with")
        if options.out is not None:  # before the work; a file that is refused leaves no folder
            output_folder(options.out)
        found = judge_built_in(of)
    if options.out is not None:
        output_folder(options.out)
        write_json(options.out / "law.json", found.record(scene.name, name))
        write_page("verify.studies.law.page", found, scene, name, options.out / "law.html")
        print(f"written: {options.out}")
    more = len(found.broken) - BROKEN_LINES
    lines = [*check_table(found.broken[:BROKEN_LINES]), *([f"and {more} more"] if more > 0 else [])]
    lines += [f"defect: {defect.sentence}" for defect in found.defects]
    lines += [] if found.compared else [f"toughness at B = {B:<4g} {G:.6g}" for B, G in found.toughness.items()]
    for remark in found.remarks:
        say(remark)
    total = counted(found.checks)
    counts = f"{total.total} checks on {len(of.ways)} paths, {total.held} hold, {total.broken} broken"
    print("\n".join([*lines, f"{name} on {scene.name}: {counts}"]))
    return 0 if found.passed else FAILED


@command(
    "Toughness from a delamination test, or back from a run: every scheme of the standards, with intervals.",
    "reduce test.csv --scene mine.toml --load-scale 1e3 --crack a --out reduced",
    "a table; read reduced/reduce.html",
    value("files", "FILE", "file of a test, or folder of a run; several are coupons of one plate", place, nargs="*"),
    value(
        "--coupons",
        "TABLE",
        "table (CSV) of coupons: a column file, and columns precrack, width, arm_thickness ... of each",
        place,
    ),
    value(
        "--scene",
        "SCENE",
        "the specimen, a packaged name or a file, whose [interface] and [load] may be missing; of a run: its own",
    ),
    *(SET, *column_options()),
    value(
        "--crack",
        "COLUMN",
        "name or number of the crack lengths, from the load line or the left support; default: crack_length",
        column,
    ),
    value("--crack-scale", "X", "multiplies the crack lengths", scale, 1.0),
    value(
        "--crack-offset",
        "A",
        "is added to the crack lengths: the precrack, where the column holds the growth",
        number,
        0.0,
    ),
    value("--rotations", "COLUMN,...", "one or two columns: rotations of the loaded ends, for J", columns, ()),
    value(
        "--end-opening", "COLUMN", "opening at the end of the precrack, for --bridging; default: by beam theory", column
    ),
    value("--peel-angle", "DEGREES", "peel: angle of the load to the bond; default: 90", number),
    value("--rotation-scale", "X", "multiplies the rotations, to radians", scale, 1.0),
    value(
        "--linear",
        "LOW,HIGH",
        "the curve is linear between these parts of the largest load; default: 0.2,0.5, of a run 0,0.2",
        numbers,
    ),
    flag("--no-toe", "leave the origin where it is"),
    value(
        "--machine-compliance",
        "C",
        "compliance of the machine, whose part of the opening is taken off",
        number,
        0.0,
    ),
    flag("--large", "dcb: factors F and N of large openings; of runs with finite rotations they always count"),
    value(
        "--block",
        "L1,L2",
        "dcb: load blocks, from the pin to the middle of the arm and to the edge of the block",
        numbers,
        (0.0, 0.0),
    ),
    value(
        "--calibration", "A,C,A,C,...", "compliances of precracks that were not broken, for CC of an enf", numbers, []
    ),
    value("--begin", "D", "crack growth from which propagation counts", fraction),
    value("--end", "D", "and up to which it does", fraction),
    flag("--fit", "strength and toughness by least squares on a cohesive beam"),
    flag("--bridging", "dcb: the traction law by which fibres bridge, as a scene that debond solve takes"),
    value("--out", "DIR", "write reduce.json, reduce.csv and reduce.html", place),
)
def reduce(options: argparse.Namespace) -> int:
    from verify.studies.reduce import command as work
    from verify.studies.reduce.coupons import coupons_of

    coupons = coupons_of(options.files, options.coupons)
    if not coupons:
        raise Refusal("FILE: must be the file of a test or the folder of a run, got none")
    if options.coupons or len(coupons) > 1:
        if options.out is not None:
            output_folder(options.out)
        work.of_many(options, coupons)
        return 0
    (one,) = coupons
    test, found, known, models = work.reduced(options, one.path)
    if options.out is not None:
        output_folder(options.out)
    work.report(found, known, models)
    if options.out is not None:
        work.write(options.out, str(one.path), test.scene, found, known, models)
    return 0
