"""`debond reduce`: data reduction of a test, with a table on the screen, JSON, R-curve and page."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from verify.curves.read import Reading
from verify.reduction.data import Columns
from verify.reduction.reduce import LEVEL, Reduced, Reduction, reduce
from verify.reduction.scheme import Settings
from verify.runs.folder import write_csv, write_json
from verify.scene.schema import Scene
from verify.scene.toml import keep_scene
from verify.studies.reduce.bias import Bias, biases
from verify.studies.reduce.bridging import Bridging, bridged
from verify.studies.reduce.coupons import HEADS, OneCoupon, Statistic, lines_of, of_coupons, statistics
from verify.studies.reduce.fit import Fit, fitted
from verify.studies.reduce.source import Given, given
from verify.studies.reduce.wording import facts, lines, remarks
from verify.support.refusal import Refusal
from verify.support.say import aligned, say, write_page
from verify.version import __version__

#: What a test is explained by, each with its sentences.
Models = tuple[Fit | Bridging, ...]


@dataclass(frozen=True)
class RCurveRow:
    """A point of the R-curve of a scheme: crack growth, G, and G_II / G, NaN where that is not known."""

    scheme: str
    growth: float
    G: float
    sliding: float


def settings_of_options(options: argparse.Namespace) -> Settings:
    """The settings of the command line.

    Raises
    ------
    Refusal : parts, lengths or a compliance that cannot be.
    """
    window, block, begin, end = options.linear, tuple(options.block), options.begin, options.end
    steps = options.calibration
    pairs = tuple(zip(steps[::2], steps[1::2], strict=False))
    machine, different = options.machine_compliance, len({a for a, _ in pairs})
    refused = {
        f"--linear: must be two parts of the largest load like 0.2,0.5, got {_listed(window)}": window is not None
        and not (len(window) == 2 and 0.0 <= window[0] < window[1] <= 1.0),
        f"--block: must be two lengths >= 0 like 8,6, got {_listed(block)}": len(block) != 2 or min(block) < 0.0,
        f"--begin: must be less than --end = {end}, got {begin}": None not in (begin, end) and begin >= end,
        f"--machine-compliance: must be >= 0, got {machine:g}": machine < 0.0,
        "--calibration: must be crack lengths, each with its compliance, of two precracks or more, all > 0, like "
        f"20,1.9e-3,30,2.1e-3,40,2.7e-3, got {_listed(steps)}": bool(steps)
        and (len(steps) % 2 == 1 or different < 2 or min(steps) <= 0.0),
    }
    for sentence, wrong in refused.items():
        if wrong:
            raise Refusal(sentence)
    return Settings(
        toe=not options.no_toe,
        machine=machine,
        large=options.large,
        block=(block[0], block[1]),
        begin=begin,
        end=end,
        calibration=pairs,
    )


def _listed(values: Sequence[float] | None) -> str:
    return ",".join(f"{value:g}" for value in values or ()) or "nothing"


def reduced(
    options: argparse.Namespace, path: Path, own: tuple[str, ...] = ()
) -> tuple[Given, Reduction, tuple[Bias, ...], Models]:
    """A test with its reduction, what is known of it, and the models that are asked for; ``own`` are overrides."""
    asked = settings_of_options(options)
    reading = Reading(options.opening, options.load, options.opening_scale, options.load_scale)
    columns = Columns(
        reading, options.crack, options.crack_scale, options.crack_offset, options.rotations, options.rotation_scale,
        options.end_opening,
    )  # fmt: skip
    test = given(path, options.scene, [*options.overrides, *own], columns, options.peel_angle)
    found = reduce(test.measured, test.coupon, test.settings(asked, options.linear and tuple(options.linear)))
    if options.fit and not test.bonded:
        raise Refusal("--fit: needs the table [interface] of the scene to start from, got none")
    makers: dict[str, Callable[[Reduction, Scene], Fit | Bridging]] = {"--fit": fitted, "--bridging": bridged}
    asked_for = [name for name in makers if getattr(options, name.strip("-"))]
    if asked_for and not found.part.rows.size:
        raise Refusal(f"{asked_for[0]}: needs a curve from its linear part on, got readings of a growing crack alone")
    models = tuple(makers[name](found, test.scene) for name in asked_for)
    return test, found, biases(found, test.scene) if test.bonded else (), models


def of_many(options: argparse.Namespace, coupons: Sequence[OneCoupon]) -> None:
    """Reduce every coupon, print a row for each and the statistics of all, and write both with the R-curves."""
    names = [one.name for one in coupons]
    if twice := [name for name in names if names.count(name) > 1]:
        raise Refusal(f"FILE: coupons have the names of their files, got {twice[0]} twice; rename one")
    found = [reduced(options, one.path, one.overrides) for one in coupons]
    for name, (_, reduction, _, _) in zip(names, found, strict=True):
        for text in remarks(reduction):
            say(f"{name}: {text}")
    reductions = [one[1] for one in found]
    print(
        "\n".join([*aligned(of_coupons(names, reductions)), "", *aligned([HEADS, *lines_of(statistics(reductions))])])
    )
    if options.out is None:
        return
    for name, (test, reduction, known, models) in zip(names, found, strict=True):
        folder = options.out / name
        folder.mkdir(parents=True, exist_ok=True)
        write(folder, str(test.measured.source), test.scene, reduction, known, models)
    write_csv(options.out / "coupons.csv", Statistic, statistics(reductions))
    write_page("verify.studies.reduce.coupons_page", names, reductions, found[0][0].scene, options.out / "coupons.html")
    print(f"written: {options.out}")


def report(found: Reduction, known: tuple[Bias, ...], models: Models) -> None:
    """Print the table, the facts behind it, and the models; remarks go to stderr."""
    said = [f"{name}: {value}" for name, value in facts(found)]
    said += [*lines(found, known), *(f"{one.name}: {text}" for one in models for text in one.sentences)]
    print("\n".join(said))
    for text in remarks(found):
        say(text)


def write(folder: Path, source: str, scene: Scene, found: Reduction, known: tuple[Bias, ...], models: Models) -> None:
    """Write reduce.json, reduce.csv and the scene of a bridging law, and the page where matplotlib and Jinja are
    installed."""
    write_json(folder / "reduce.json", content(found, known, scene.name, source, models))
    for one in models:
        if isinstance(one, Bridging):
            keep_scene(one.scene, folder / "bridging.toml")
    rows = (
        RCurveRow(one.name, *map(float, values))
        for one in found.schemes
        for values in zip(one.growth, one.G, one.sliding, strict=True)
    )
    write_csv(folder / "reduce.csv", RCurveRow, rows)
    write_page("verify.studies.reduce.page", found, known, scene, source, folder / "reduce.html", models)
    print(f"written: {folder}")


def content(found: Reduction, known: Sequence[Bias], scene: str, source: str, models: Models = ()) -> dict[str, Any]:
    """The content of reduce.json; unknown values become null."""
    points = {
        name: {"opening": found.smoothed.opening[i], "load": found.smoothed.load[i], "point": i + 1}
        for name, i in found.points.items()
    }
    return {
        "file": source,
        "scene": scene,
        "specimen": asdict(found.coupon),
        "settings": asdict(found.settings),
        "linear_part": {"compliance": found.part.compliance, "toe": found.toe, "noise": found.part.noise},
        "level": LEVEL,
        "initiation_points": points,
        "rows_of_growth": int(np.count_nonzero(found.grown)),
        **{one.name: {**one.content, "sentences": one.sentences} for one in models},
        **({"r_curve": asdict(curve)} if (curve := found.r_curve) else {}),
        "schemes": {one.name: _scheme(one, known) for one in found.schemes},
        "version": __version__,
    }


def _scheme(one: Reduced, known: Sequence[Bias]) -> dict[str, Any]:
    if one.missing:
        return {"missing": one.missing}
    against = [{"input": bias.known, "bias": bias.propagation} for bias in known if bias.scheme is one]
    return {
        "what": one.what,
        "constants": {name: asdict(value) for name, value in one.constants.items()},
        "initiation": {name: asdict(value) for name, value in one.initiation.items()},
        "propagation": {**asdict(one.propagation), "scatter": one.scatter, "rows": one.count},
        "G_II/G": one.mixture,
        **(against[0] if against else {}),
    }
