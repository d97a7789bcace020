"""`debond compare`: two curves on the screen, in a page, and as an exit code."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from verify import __version__
from verify.compare import Comparison, Part, compare
from verify.curve_file import Reading, read_curve
from verify.folder import write_json
from verify.verdict import Check

PAGE, NUMBERS = "comparison.html", "comparison.json"


@dataclass(frozen=True)
class Source:
    """One of the curves as the command line names it."""

    path: Path
    reading: Reading

    @property
    def label(self) -> str:
        """Its name with that of its folder, as most curves are called the same."""
        return "/".join(self.path.parts[-2:]) or str(self.path)


def held_against(a: Source, b: Source, end: float | None, at: Sequence[float]) -> tuple[Comparison, list]:
    """The comparison and the loads at the openings ``at``.

    Raises
    ------
    CurveError : a file that holds no curve, nothing in common, an opening outside.
    """
    comparison = compare(read_curve(a.path, a.reading), read_curve(b.path, b.reading), end)
    return comparison, comparison.loads_at(at)


def table(comparison: Comparison, loads: Sequence[tuple[float, float, float]], found: Sequence[Check]) -> list[str]:
    """Lines for people: what, A, B, A against B, tolerance and verdict."""
    verdicts = {check.name: f"<= {check.tolerance:.4g}, {_verdict(check)}" for check in found}
    lines = [("", "A", "B", "A against B", "")]
    lines += [(name, *cells, verdicts.get(key, "")) for name, key, *cells in rows(comparison, loads)]
    widths = [max(len(line[i]) for line in lines) for i in range(4)]
    return [
        "  ".join((line[0].ljust(widths[0]), *(line[i].rjust(widths[i]) for i in (1, 2, 3)), line[4])).rstrip()
        for line in lines
    ]


def rows(comparison: Comparison, loads: Sequence[tuple[float, float, float]]) -> list[tuple[str, str, str, str, str]]:
    """Name, name of its check, value of A, of B, and relative difference; words for the screen and the page."""
    a, b = comparison.a, comparison.b
    worst = comparison.worst
    pairs = [(f"load at {at:.6g}", P_a, P_b) for at, P_a, P_b in loads]
    pairs.append((f"largest deviation, at {worst[0]:.6g}", *worst[1:]))
    wave = comparison.oscillation_rms, comparison.excess_variation
    return [
        ("curve error", "curve-error", "", "", _percent(comparison.curve_error)),
        ("peak load", "peak-load", *_both(a.peak_load, b.peak_load), _change(comparison.peak_difference)),
        ("  at opening", "", *_both(a.peak_opening, b.peak_opening), _change(comparison.peak_shift)),
        ("energy", "energy", *_both(a.work, b.work), _change(comparison.energy_difference)),
        ("oscillation, RMS", "", "", "", _percent(wave[0])),
        ("  excess variation", "", "", "", _percent(wave[1])),
        *((name, "", *_both(P_a, P_b), _change(_over(P_a - P_b, P_b))) for name, P_a, P_b in pairs),
        ("last opening", "end", *_both(a.last, b.last), ""),
    ]


def remarks(comparison: Comparison) -> list[str]:
    """What a reader should know before trusting the numbers."""
    said = [
        f"{name} begins at the opening {part.first:.6g} and is joined to the origin by a straight line"
        for name, part in (("A", comparison.a), ("B", comparison.b))
        if part.first > comparison.end / 100
    ]
    if comparison.missing > 0.0 and comparison.end < comparison.asked_end:
        said.append(f"A ends at the opening {comparison.a.last:.6g}, before {comparison.asked_end:.6g}")
    if not comparison.a.peak_load > 0.0:
        said.append("no load of A is above 0: --load-scale-a -1 turns its sign")
    return said


def complaints(found: Sequence[Check], comparison: Comparison) -> list[str]:
    """One sentence for every tolerance that is broken."""
    words = {"curve-error": "curve error", "peak-load": "peak load differs by", "energy": "energy differs by"}
    said = [
        f"{words[check.name]} {_percent(abs(check.value))}, more than {_percent(check.tolerance)}"
        for check in found
        if not check.passed and check.name in words
    ]
    if any(check.name == "end" and not check.passed for check in found):
        said.append(
            f"A ends at the opening {comparison.a.last:.6g}, before {comparison.asked_end:.6g}; "
            f"--end {_below(comparison.a.last)} judges the common part"
        )
    return said


def write(
    folder: Path,
    sources: tuple[Source, Source],
    comparison: Comparison,
    loads: Sequence[tuple[float, float, float]],
    found: Sequence[Check],
    say: Callable[[str], None],
) -> None:
    """Write comparison.json, and comparison.html where there is what to draw it with."""
    write_json(folder / NUMBERS, numbers(sources, comparison, loads, found))
    try:
        from verify.report.comparison import page
    except ModuleNotFoundError as error:
        if error.name not in ("matplotlib", "jinja2", "markupsafe"):
            raise
        say("debond: no page without matplotlib and jinja2: pip install 'debond[report]'")
        return
    labels = tuple(source.label for source in sources)
    cells = rows(comparison, loads)
    (folder / PAGE).write_text(page(comparison, labels, cells, found, remarks(comparison)), encoding="utf-8")


def numbers(
    sources: tuple[Source, Source],
    comparison: Comparison,
    loads: Sequence[tuple[float, float, float]],
    found: Sequence[Check],
) -> dict[str, object]:
    """Everything as plain numbers and words; what cannot be told is null in the file."""
    worst = dict(zip(("opening", "load_a", "load_b"), comparison.worst, strict=True))
    judged = {
        check.name: {"value": check.value, "tolerance": check.tolerance, "kind": check.kind, "passed": check.passed}
        for check in found
    }
    return {
        "a": _side(sources[0], comparison.a),
        "b": _side(sources[1], comparison.b),
        "end": comparison.end,
        "asked_end": comparison.asked_end,
        "curve_error": comparison.curve_error,
        "peak_difference": comparison.peak_difference,
        "peak_shift": comparison.peak_shift,
        "energy_difference": comparison.energy_difference,
        "oscillation": {"rms": comparison.oscillation_rms, "excess_variation": comparison.excess_variation},
        "largest_deviation": worst,
        "loads": [{"opening": at, "load_a": P_a, "load_b": P_b} for at, P_a, P_b in loads],
        "checks": judged,
        "passed": all(check.passed for check in found),
        "version": __version__,
    }


def _side(source: Source, part: Part) -> Mapping[str, object]:
    opening, load = source.reading.columns
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


def _below(value: float) -> str:
    """Six digits of an opening, rounded so that the curve reaches it."""
    step = 10.0 ** (math.floor(math.log10(value)) - 5)
    return f"{math.floor(value / step) * step:.6g}"


def _verdict(check: Check) -> str:
    return "holds" if check.passed else "FAILS"


def _both(a: float, b: float) -> tuple[str, str]:
    return f"{a:.6g}", f"{b:.6g}"


def _over(value: float, reference: float) -> float:
    return value / abs(reference) if reference else math.nan


def _percent(value: float) -> str:
    return f"{100 * value:.4g} %" if math.isfinite(value) else "cannot be told"


def _change(value: float) -> str:
    return f"{100 * value:+.4g} %" if math.isfinite(value) else "cannot be told"
