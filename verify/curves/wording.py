"""A comparison of two curves in words: the lines of its table, and a sentence for whatever is wrong."""

from __future__ import annotations

import math
from collections.abc import Sequence

from verify.curves.compare import Comparison, ratio
from verify.support.say import aligned
from verify.verdict import Check

Loads = Sequence[tuple[float, float, float]]

#: Check -> its name in the table; of a leg, the difference with it.
_OF_PATHS = {"farthest-point": "farthest point, in parts of its own", "legs": "turns"}
_OF_LEGS = {"slope": "secant stiffness", "residual": "residual opening", "loop": "work lost there and back"}


def table(comparison: Comparison, loads: Loads, found: Sequence[Check]) -> list[str]:
    """Lines of a table: quantity, A, B, A against B, tolerance and verdict."""
    a, b = comparison.names
    limits = {check.name: f"<= {_percent(check.tolerance)}, " for check in found if check.name != "end"}
    verdicts = {check.name: limits.get(check.name, "") + ("holds" if check.passed else "FAILS") for check in found}
    cells = rows(comparison, loads, found)
    lines = [(name, of_a, of_b, off, verdicts.get(key, "")) for name, key, of_a, of_b, off in cells]
    return aligned([("", a, b, "difference", ""), *lines], left=(0, 4))


def rows(comparison: Comparison, loads: Loads, found: Sequence[Check] = ()) -> list[tuple[str, str, str, str, str]]:
    """Name, name of its check, value of A, of B, and relative difference."""
    a, b = comparison.a, comparison.b
    at, worst_a, worst_b = comparison.worst
    pairs = [(f"load at {at:.6g}", P_a, P_b) for at, P_a, P_b in loads]
    pairs.append((f"largest deviation, at {at:.6g}", worst_a, worst_b))
    cells = [
        ("curve error", "curve-error", "", "", _percent(comparison.curve_error)),
        ("peak load", "peak-load", *_both(a.peak_load, b.peak_load), _change(comparison.peak_difference)),
        ("opening at peak", "", *_both(a.peak_opening, b.peak_opening), _change(comparison.peak_shift)),
        ("energy", "energy", *_both(a.work, b.work), _change(comparison.energy_difference)),
        ("oscillation, RMS", "", "", "", _percent(comparison.oscillation_rms)),
        ("oscillation, excess variation", "", "", "", _percent(comparison.excess_variation)),
        *((name, "", *_both(P_a, P_b), _change(ratio(P_a - P_b, abs(P_b)))) for name, P_a, P_b in pairs),
        *((_OF_PATHS[c.name], c.name, "", "", _percent(c.value)) for c in found if c.name in _OF_PATHS),
    ]
    for leg in comparison.legs:
        cells.append((f"leg {leg.number}, {leg.words}", f"curve-leg-{leg.number}", "", "", _percent(leg.error)))
        told = {key: getattr(leg, key) for key in _OF_LEGS if not math.isnan(getattr(leg, key))}
        cells += [(f"  {_OF_LEGS[key]}", f"{key}-leg-{leg.number}", "", "", _change(v)) for key, v in told.items()]
    return [*cells, ("last opening", "end", *_both(a.last, b.last), "")]


def remarks(comparison: Comparison) -> list[str]:
    """What a reader should know before trusting the numbers."""
    a, b = comparison.names
    said = [
        f"{name} begins at the opening {part.first:.6g} and is joined to the origin by a straight line"
        for name, part in ((a, comparison.a), (b, comparison.b))
        if part.first > max(comparison.begin, comparison.end / 100)
    ]
    if not comparison.a.peak_load > 0.0:
        way = ": a load scale of -1 turns its sign" if comparison.load_a_n.min() < 0.0 else ""
        said.append(f"no load of {a} is above 0{way}")
    if comparison.reaches:
        return said
    last, asked = comparison.a.last, comparison.asked_end
    digits = next((n for n in (6, 9, 12) if f"{last:.{n}g}" != f"{asked:.{n}g}"), 17)
    common = f"{last:.6g}" if float(f"{last:.6g}") <= last else f"{last * (1 - 5e-6):.6g}"  # which the curve reaches
    text = f"{a} ends at the opening {last:.{digits}g}, before {asked:.{digits}g}; an end of {common} judges"
    return [*said, f"{text} the common part"]


def complaints(comparison: Comparison, found: Sequence[Check]) -> list[str]:
    """One sentence for every tolerance that is broken."""
    words = {"curve-error": "curve error", "peak-load": "peak load differs by", "energy": "energy differs by"}
    return [
        f"{words.get(check.name, check.meaning.rstrip('.') + ':')} {_percent(abs(check.value))}, "
        f"more than {_percent(check.tolerance)}"
        for check in found
        if not check.passed and check.name != "end"
    ]


def _both(a: float, b: float) -> tuple[str, str]:
    return f"{a:.6g}", f"{b:.6g}"


def _percent(value: float) -> str:
    return f"{100 * value:.4g} %" if math.isfinite(value) else "cannot be told"


def _change(value: float) -> str:
    return f"{100 * value:+.4g} %" if math.isfinite(value) else "cannot be told"
