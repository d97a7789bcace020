"""`debond compare`: comparison of two curves on the screen, as a page, and as JSON."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

from verify.curves.compare import Comparison, Part, compare
from verify.curves.read import Reading, read_curve
from verify.curves.wording import remarks, rows
from verify.runs.folder import write_json
from verify.support.programme import only_opens
from verify.support.say import say
from verify.verdict import Check
from verify.version import __version__

PAGE, NUMBERS = "comparison.html", "comparison.json"


@dataclass(frozen=True)
class Source:
    """A curve of the command line."""

    path: Path
    reading: Reading

    @property
    def label(self) -> str:
        """File name with folder, as many curves have the same file name."""
        return "/".join(self.path.parts[-2:]) or str(self.path)


def held_against(
    a: Source,
    b: Source,
    end: float | None,
    at: Sequence[float],
    begin: float | None = None,
    programme: Sequence[float] | None = None,
) -> tuple[Comparison, list]:
    """The comparison and the loads at the openings ``at``.

    Raises
    ------
    CurveError : a file without a curve, no common range, or an opening outside of it.
    """
    curves = read_curve(a.path, a.reading), read_curve(b.path, b.reading)
    comparison = compare(*curves, end, begin=begin, programme=programme)
    return comparison, comparison.loads_at(at)


def explain(sources: tuple[Source, Source], tolerance: float | None) -> None:
    """Say what explains the deviation of A from B best; where B is a run, with causes in its scene, too."""
    from verify.checks.between_codes import CODE_TOLERANCE
    from verify.diagnosis.classify import diagnose
    from verify.studies.reduce.source import scene_of_run

    a, b = sources
    about = b.path / "result.json"
    scene = scene_of_run(about, ()) if about.is_file() else None
    curves = read_curve(a.path, a.reading), read_curve(b.path, b.reading)
    if scene is not None and not only_opens(scene.load.opening):
        return
    found = diagnose(a.label, *curves, scene, CODE_TOLERANCE if tolerance is None else tolerance)
    if found is not None:
        say(found.sentence)


def write(
    folder: Path,
    sources: tuple[Source, Source],
    comparison: Comparison,
    loads: Sequence[tuple[float, float, float]],
    found: Sequence[Check],
) -> None:
    """Write comparison.json, and comparison.html where matplotlib and Jinja are installed."""
    write_json(folder / NUMBERS, numbers(sources, comparison, loads, found))
    try:
        from verify.report.comparison import page
    except ModuleNotFoundError as error:
        if (error.name or "").partition(".")[0] not in ("matplotlib", "jinja2", "markupsafe"):
            raise
        say("no page without matplotlib and jinja2: pip install 'debond[report]'")
        return
    labels = sources[0].label, sources[1].label
    cells = rows(comparison, loads, found)
    (folder / PAGE).write_text(page(comparison, labels, cells, found, remarks(comparison)), encoding="utf-8")


def numbers(
    sources: tuple[Source, Source],
    comparison: Comparison,
    loads: Sequence[tuple[float, float, float]],
    found: Sequence[Check],
) -> dict[str, object]:
    """The content of comparison.json; undefined values become null."""
    worst = dict(zip(("opening", "load_a", "load_b"), comparison.worst, strict=True))
    judged = {
        check.name: {"value": check.value, "tolerance": check.tolerance, "kind": check.kind, "passed": check.passed}
        for check in found
    }
    return {
        "a": _side(sources[0], comparison.a),
        "b": _side(sources[1], comparison.b),
        "begin": comparison.begin,
        "end": comparison.end,
        "asked_end": comparison.asked_end,
        "curve_error": comparison.curve_error,
        "peak_difference": comparison.peak_difference,
        "peak_shift": comparison.peak_shift,
        "energy_difference": comparison.energy_difference,
        "oscillation": {"rms": comparison.oscillation_rms, "excess_variation": comparison.excess_variation},
        "largest_deviation": worst,
        "legs": [asdict(leg) for leg in comparison.legs],
        "loads": [{"opening": at, "load_a": P_a, "load_b": P_b} for at, P_a, P_b in loads],
        "checks": judged,
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
        "peak_load": part.peak_load,
        "peak_opening": part.peak_opening,
        "work": part.work,
    }
