"""`debond compare`: comparison of two curves on the screen, as a page, and as JSON."""

from __future__ import annotations

import argparse
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from verify.command_line.answers import FAILED, output_folder
from verify.command_line.arguments import fraction, number, numbers, place
from verify.command_line.curves import column_options, reading, say_changed
from verify.command_line.options import command, value
from verify.support.programme import only_opens
from verify.support.say import say
from verify.version import __version__

if TYPE_CHECKING:
    from verify.curves.compare import Comparison, Part
    from verify.curves.read import Reading
    from verify.curves.units import Units
    from verify.curves.wording import Loads
    from verify.verdict import Check

PAGE, NUMBERS = "comparison.html", "comparison.json"


class Source(NamedTuple):
    """A curve of the command line."""

    path: Path
    reading: Reading

    @property
    def label(self) -> str:
        """File name with folder, as many curves have the same file name."""
        return "/".join(self.path.parts[-2:]) or str(self.path)


@command(
    "Two load-opening curves: error, peak, energy; of runs, or of anybody's code.",
    "compare my.csv run --opening-a U2 --load-a RF2 --curve-tol 0.01",
    "a table; exit 1: my.csv is more than 1 % off the run",
    value("a", "A", "CSV file or folder of a run", place),
    value("b", "B", "what A is held against", place),
    *column_options("-a", "the {} of A"),
    *column_options("-b", "the {} of B"),
    value("--end", "D", "compare up to this opening; default: the last of B", number),
    value("--begin", "D", "compare from this opening on; default: 0", number),
    value("--programme", "D,D,...", "the load programme, where B does not show its turns: 1.5,0.2,3", numbers),
    value("--at", "D,D,...", "print the loads at these openings", numbers, ()),
    value("--curve-tol --tolerance", "T", "fail where the curve error is larger, e.g. 0.01", fraction),
    value("--peak-tol", "T", "and where the peak loads differ by more", fraction),
    value("--energy-tol", "T", "and where the works differ by more", fraction),
    value("--out", "DIR", "write comparison.json and comparison.html", place),
)
def compare(options: argparse.Namespace) -> int:
    from verify.curves.compare import checks
    from verify.curves.compare import compare as compared
    from verify.curves.read import read_curve
    from verify.curves.wording import complaints, remarks, table

    a, b = (Source(getattr(options, side), reading(options, f"_{side}")) for side in "ab")
    say_changed(a.path, b.path)
    runs_first = sorted((b, a), key=lambda one: not one.path.is_dir())  # whose columns name no units
    units = next((one for source in runs_first if (one := _units(source)) != type(one)()), None)
    a, b = (one if units is None else one._replace(reading=replace(one.reading, units=units)) for one in (a, b))
    curves = read_curve(a.path, a.reading), read_curve(b.path, b.reading)
    comparison = compared(*curves, options.end, begin=options.begin, programme=options.programme)
    loads = comparison.loads_at(options.at)
    if options.out is not None:
        output_folder(options.out)
    found = checks(comparison, options.curve_tol, options.peak_tol, options.energy_tol)
    print("\n".join(table(comparison, loads, found)), flush=True)
    for remark in remarks(comparison):
        say(remark)
    if options.out is not None:
        write(options.out, (a, b), comparison, loads, found)
        print(f"written: {options.out}")
    for complaint in complaints(comparison, found):
        say(complaint)
    if all(check.passed for check in found):
        return 0
    explain(a.label, b.path, curves, options.curve_tol)
    return FAILED


def _units(source: Source) -> Units:
    """The units of a run, or those that the header of a file names."""
    from verify.curves.read import units_in
    from verify.curves.units import units_of
    from verify.studies.reduce.source import scene_of_run

    about = source.path / "result.json"
    if about.is_file():
        return units_of(scene_of_run(about, ()).units)
    return units_in(source.path / "curve.csv" if source.path.is_dir() else source.path, source.reading)


def explain(name: str, path: Path, curves: tuple[Any, Any], tolerance: float | None) -> None:
    """Say what explains the deviation of A from B best; where B is a run, with causes in its scene, too."""
    from verify.checks.between_codes import CODE_TOLERANCE
    from verify.diagnosis.classify import diagnose
    from verify.studies.reduce.source import scene_of_run

    about = path / "result.json"
    scene = scene_of_run(about, ()) if about.is_file() else None
    if scene is None or only_opens(scene.load.opening):
        found = diagnose(name, *curves, scene, CODE_TOLERANCE if tolerance is None else tolerance)
        if found is not None:
            say(found.sentence)


def write(
    folder: Path,
    sources: tuple[Source, Source],
    comparison: Comparison,
    loads: Loads,
    found: Sequence[Check],
) -> None:
    """Write comparison.json, and comparison.html where matplotlib and Jinja are installed."""
    from verify.curves.wording import remarks, rows
    from verify.runs.folder import write_json

    write_json(folder / NUMBERS, content(sources, comparison, loads, found))
    try:
        from verify.report.comparison import page
    except ModuleNotFoundError as error:
        if (error.name or "").partition(".")[0] not in ("matplotlib", "jinja2", "markupsafe"):
            raise
        say("no page without matplotlib and jinja2: pip install 'debond[report]'")
        return
    labels, cells = (sources[0].label, sources[1].label), rows(comparison, loads, found)
    (folder / PAGE).write_text(page(comparison, labels, cells, found, remarks(comparison)), encoding="utf-8")


def content(
    sources: tuple[Source, Source],
    comparison: Comparison,
    loads: Loads,
    found: Sequence[Check],
) -> dict[str, object]:
    """What stands in comparison.json; undefined values become null."""
    from dataclasses import asdict

    plain = "begin end asked_end curve_error peak_difference peak_shift energy_difference".split()
    columns, of_a_check = ("opening", "load_a", "load_b"), ("value", "tolerance", "kind", "passed")
    return {
        "a": _side(sources[0], comparison.a),
        "b": _side(sources[1], comparison.b),
        **{name: getattr(comparison, name) for name in plain},
        "oscillation": {"rms": comparison.oscillation_rms, "excess_variation": comparison.excess_variation},
        "largest_deviation": dict(zip(columns, comparison.worst, strict=True)),
        "legs": [asdict(leg) for leg in comparison.legs],
        "loads": [dict(zip(columns, row, strict=True)) for row in loads],
        "checks": {check.name: {key: getattr(check, key) for key in of_a_check} for check in found},
        "passed": all(check.passed for check in found),
        "version": __version__,
    }


def _side(source: Source, part: Part) -> Mapping[str, object]:
    opening, load, *_ = source.reading.columns
    return {
        "file": str(source.path),
        "columns": {"opening": opening, "load": load},
        "scales": {"opening": source.reading.opening_scale, "load": source.reading.load_scale},
        "first_opening": part.first,
        "last_opening": part.last,
        "points": part.opening.size,
        **{name: getattr(part, name) for name in ("peak_load", "peak_opening", "work")},
    }
