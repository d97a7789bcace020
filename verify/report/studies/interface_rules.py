"""The study of the interface quadrature on the page: a table and the tractions of one opening."""

from __future__ import annotations

from typing import Any

from verify.pages.style import HALF, METHOD_NAMES, Panel, colour, drawing, panel
from verify.pages.table import Table
from verify.pages.text import Units, axis, number, percent, quantity
from verify.studies.interface_rules import Study, finding

#: Rules that are drawn: (rule, points, colour of the palette).
DRAWN = (("gauss", 2, "bad"), ("lobatto", 4, "lagrange"), ("lumped", None, "nurbs"))


def section(study: Study, anchor: str) -> dict[str, Any]:
    """The content of the template, after the sections of the scenes."""
    methods = tuple(dict.fromkeys(trial.method for trial in study.trials))
    ductilities = tuple(dict.fromkeys(trial.ductility for trial in study.trials))
    rules = tuple(dict.fromkeys((trial.rule, trial.points) for trial in study.trials))
    heads = [(method, ductility) for method in methods for ductility in ductilities]
    return {
        "anchor": anchor,
        "finding": finding(study),
        "legend": (),
        "table": Table.of(
            ("Rule", *(f"{METHOD_NAMES[method]}, ductility {number(ductility)}" for method, ductility in heads)),
            [(_name(*rule), *(percent(study.of(one, *rule, d).oscillation) for one, d in heads)) for rule in rules],
            "Oscillation of the traction by interface rule",
        ),
        "notes": [
            f"{METHOD_NAMES[t.method]}, {_name(t.rule, t.points)}, ductility {number(t.ductility)}: {t.status}"
            for t in study.trials
            if t.status != "complete"
        ],
        "panels": [_tractions(study, method, max(ductilities), f"{anchor}-{method}") for method in methods],
    }


def _name(rule: str, points: int | None) -> str:
    return f"{rule}, {points} points" if points else rule


def _tractions(study: Study, method: str, ductility: float, key: str) -> Panel:
    """Traction ahead of the crack with three rules, and that of the beam."""
    units, strength = Units.of(study.scene.units), study.scene.interface.strength
    beam = dict(study.beams)[ductility]
    with drawing():
        figure, axes = panel(HALF, 2.65)
        axes.plot(beam.s_q, beam.traction_q / strength, color=colour("muted"), linewidth=3, alpha=0.5, label="beam")
        for rule, points, ink in DRAWN:
            profile = study.of(method, rule, points, ductility).profile
            if profile is not None:
                (drawn,) = axes.plot(profile.s_q, profile.traction_q / strength, ".-", label=_name(rule, points))
                drawn.set(color=colour(ink), linewidth=0.9, markersize=3)
        start = study.scene.specimen.free_length
        axes.set(
            xlabel=axis("position along the specimen", units.length),
            ylabel="traction / strength",
            xlim=(start, start + 2.5),
        )
        axes.legend(loc="lower right")
        where = quantity(beam.opening, units.length, 3)
        caption = f"{METHOD_NAMES[method]}, ductility {number(ductility)}, opening {where}."
        title = f"Traction ahead of the crack by interface rule, {METHOD_NAMES[method]}"
        return Panel.of(figure, key, title, caption)
