"""`debond reduce`: data reduction of a test, with a table on the screen, JSON, R-curve and page."""

from __future__ import annotations

import argparse
from pathlib import Path

from verify.curves.read import Reading
from verify.reduction.data import Columns
from verify.reduction.reduce import Reduction, reduce
from verify.reduction.scheme import Settings
from verify.runs.folder import write_csv, write_json
from verify.scene.schema import Scene
from verify.studies.reduce import record
from verify.studies.reduce.bias import Bias, biases
from verify.studies.reduce.fit import Fit, fitted
from verify.studies.reduce.source import Given, given
from verify.studies.reduce.wording import facts, lines, remarks
from verify.support.refusal import Refusal
from verify.support.say import say, write_page


def columns_of_options(options: argparse.Namespace) -> Columns:
    """Which columns are read, and their scales."""
    reading = Reading(options.opening, options.load, options.opening_scale, options.load_scale)
    return Columns(reading, options.crack, options.crack_scale, options.rotations, options.rotation_scale)


def settings_of_options(options: argparse.Namespace) -> Settings:
    """The settings of the command line.

    Raises
    ------
    Refusal : parts, lengths or a compliance that cannot be.
    """
    window, block = options.linear, tuple(options.block)
    if window is not None and not (len(window) == 2 and 0.0 <= window[0] < window[1] <= 1.0):
        raise Refusal(f"--linear: must be two parts of the largest load like 0.2,0.5, got {_listed(window)}")
    if len(block) != 2 or min(block) < 0.0:
        raise Refusal(f"--block: must be two lengths >= 0 like 8,6, got {_listed(options.block)}")
    begin, end = options.begin, options.end
    if begin is not None and end is not None and begin >= end:
        raise Refusal(f"--begin: must be less than --end = {end:g}, got {begin:g}")
    if options.machine_compliance < 0.0:
        raise Refusal(f"--machine-compliance: must be >= 0, got {options.machine_compliance:g}")
    return Settings(
        toe=not options.no_toe,
        machine=options.machine_compliance,
        large=options.large,
        block=(block[0], block[1]),
        begin=begin,
        end=end,
        calibration=_calibration(options.calibration),
    )


def _calibration(values: list[float]) -> tuple[tuple[float, float], ...]:
    pairs = tuple(zip(values[::2], values[1::2], strict=False))
    if len(values) % 2 or (pairs and len({a for a, _ in pairs}) < 2) or any(min(pair) <= 0.0 for pair in pairs):
        text = "must be crack lengths, each with its compliance, of two precracks or more, all > 0"
        raise Refusal(f"--calibration: {text}, like 20,1.9e-3,30,2.1e-3,40,2.7e-3, got {_listed(values)}")
    return pairs


def _listed(values: list[float]) -> str:
    return ",".join(f"{value:g}" for value in values) or "nothing"


def reduced(options: argparse.Namespace) -> tuple[Given, Reduction, tuple[Bias, ...], Fit | None]:
    """The test with its reduction, what is known of it, and the fit where one is asked for."""
    asked = settings_of_options(options)
    test = given(options.file, options.scene, options.overrides, columns_of_options(options))
    window = None if options.linear is None else (options.linear[0], options.linear[1])
    found = reduce(test.measured, test.coupon, test.settings(asked, window))
    if options.fit and not test.bonded:
        raise Refusal("--fit: needs the table [interface] of the scene to start from, got none")
    fit = fitted(found, test.scene) if options.fit else None
    return test, found, biases(found, test.scene) if test.bonded else (), fit


def report(found: Reduction, known: tuple[Bias, ...], fit: Fit | None) -> None:
    """Print the table, the facts behind it, and the fit; remarks go to stderr."""
    for name, value in facts(found):
        print(f"{name}: {value}")
    print("\n".join(lines(found, known)))
    for text in fit.sentences if fit else ():
        print(f"fit: {text}")
    for text in remarks(found):
        say(text)


def write(folder: Path, source: str, scene: Scene, found: Reduction, known: tuple[Bias, ...], fit: Fit | None) -> None:
    """Write reduce.json and reduce.csv, and the page where matplotlib and Jinja are installed."""
    write_json(folder / record.NUMBERS_FILE, record.content(found, known, scene.name, source, fit))
    write_csv(folder / record.CURVE_FILE, record.RCurveRow, record.curve(found))
    write_page("verify.studies.reduce.page", found, known, scene, source, folder / record.REDUCTION_PAGE, fit)
    print(f"written: {folder}")
