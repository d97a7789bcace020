"""The study as a page: one self-contained HTML file with an interactive chart."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING

from markupsafe import Markup

from verify.pages.style import Panel
from verify.pages.text import percent, seconds
from verify.studies.cost.figures import work_precision
from verify.studies.cost.findings import SHOWN, levels, named, orders, ways
from verify.studies.cost.row import Row
from verify.studies.page import write_study

if TYPE_CHECKING:
    from verify.studies.cost.study import Study

_SCRIPT = Path(__file__).with_name("chart.js")

#: Quantities for the axes of the chart: field of a row, label, factor.
X_AXES = (
    ("seconds", "seconds", 1),
    ("dofs", "unknowns", 1),
    ("newton_iterations", "Newton iterations", 1),
    ("peak_memory_mb", "peak memory (MB)", 1),
)
Y_AXES = (
    ("curve_error", "curve error (%)", 100),
    ("peak_error", "error of the peak load (%)", 100),
    ("energy_error", "error of the dissipated energy (%)", 100),
    ("oscillation", "oscillation (%)", 100),
    ("traction_error", "error of the tractions (%)", 100),
)


@dataclass(frozen=True)
class Chart:
    """Content of the template of the chart; ``data`` for the script, ``static`` for pages without scripts."""

    across: tuple[tuple[str, str, int], ...]
    up: tuple[tuple[str, str, int], ...]
    methods: Mapping[str, tuple[str, str]]
    data: Markup
    static: Panel


def chart(rows: Sequence[Row], key: str) -> Chart:
    """The chart of some runs; ``key`` is unique in the page."""
    methods = {method: SHOWN[method] for method in SHOWN if any(row.method == method for row in rows)}
    data = {
        "rows": [asdict(row) | {"words": _words(row)} for row in rows if row.measured],
        "colours": {method: colour for method, (_, colour) in SHOWN.items()},
    }
    text = json.dumps(data).replace("NaN", "null").replace("<", "\\u003c")  # it cannot end the element it stands in
    return Chart(X_AXES, Y_AXES, methods, Markup(text), work_precision(rows, f"{key}-work-precision"))


def script() -> Markup:
    """The script of the charts."""
    return Markup(_SCRIPT.read_text(encoding="utf-8"))


def write(study: Study, path: Path) -> None:
    """Write the page."""
    rows, of_levels = study.rows, levels(study.rows)
    found = orders(rows, 2.0 * study.against.uncertainty["curve"])
    write_study(
        study,
        path,
        {"percent": percent, "seconds": seconds, "named": named},
        levels=of_levels,
        ways=ways(study.scene.name, rows),
        chart=chart(rows, "chart"),
        orders={name: order for name, order in found.items() if isfinite(order)},
        rows=sorted(rows, key=lambda row: (row.method, row.degree, row.dofs, row.asked)),
        script=script(),
    )


def _words(row: Row) -> str:
    size = f"{row.dofs} unknowns, " if row.dofs else ""
    return (
        f"{named(row)}: {size}{row.steps} steps ({row.asked} asked), {row.newton_iterations} iterations, "
        f"{row.seconds:.2f} s, curve error {row.curve_error:.3%}, peak {row.peak_error:.3%}"
    )
