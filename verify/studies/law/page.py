"""The verdict on a law as a page: one self-contained HTML file with a figure for every path."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator

from verify.pages.style import HALF, THIRD, Line, Panel, colour, drawing, panel
from verify.pages.text import Units, axis
from verify.scene.schema import Scene
from verify.studies.law.judge import Judgement, worst_first
from verify.studies.law.laws import Answer, Case, of_bond
from verify.studies.page import write_template
from verify.verdict import counted

#: Kind of evidence -> what stands behind it.
STANDS_BEHIND = {
    "exact": "holds of any law of this kind",
    "analytical": "the definition, in closed form",
    "cross-code": "the law of another code",
}
#: Colours of the normal and the shear traction.
_INKS = ("nurbs", "lagrange")
_WIDE, _THIN, _DASHED = (3.2, (), 0.4, 2.0), (1.1, (), 1.0, 4.0), (1.1, (3.0, 1.5), 1.0, 5.0)


def write(found: Judgement, scene: Scene, law: str, path: Path) -> None:
    """Write the page on a law of some name."""
    names = dict.fromkeys(check.name for check in found.checks)
    groups = [[check for check in found.checks if check.name == name] for name in names]
    rows = [(worst_first(group)[0], counted(group)) for group in groups]
    write_template(
        "verify.studies.law",
        path,
        scene=scene.name,
        law=law,
        found=found,
        total=counted(found.checks),
        kinds=[
            (kind, counted(c for c in found.checks if c.kind == kind), text) for kind, text in STANDS_BEHIND.items()
        ],
        rows=sorted(rows, key=lambda row: row[1].broken == 0),
        overview=[*_overview(found, Units.of(scene.units))],
        panels=[(case.way.name, *_path(found, case, Units.of(scene.units).stress)) for case in found.cases],
    )


def _drawn(key: str, title: str, caption: str, draw: Callable[[Axes], object], third: bool = False) -> Panel:
    with drawing():
        figure, axes = panel(THIRD, 2.3) if third else panel(HALF, 2.8)
        draw(axes)
        return Panel.of(figure, key, title, caption, "third" if third else "half")


def _path(found: Judgement, case: Case, stress: str) -> tuple[str, Panel]:
    """Whether all checks of a path hold, and its tractions: wide pale lines for the definition, thin for the law."""
    name, worst = case.way.name, case.apart(case.given, case.known)[1]
    state = "broken" if any(check.subject == name for check in found.broken) else "holds"
    distance = f" Largest distance: {f'{worst:.1e} of the strengths' if worst else 'none'}." * found.compared
    caption = f"{case.way.what}{distance}"
    draw = partial(_tractions, case, stress)
    return state, _drawn(f"path-{name}", f"Tractions on the path {name}", caption, draw, third=True)


def _tractions(case: Case, stress: str, axes: Axes, other: Answer | None = None) -> None:
    """Both tractions over the steps of a path, those of an ``other`` law dashed."""
    for answer, style in ((case.known, _WIDE), (case.given, _THIN), (other, _DASHED)):
        for ink, values in zip(_INKS, answer.tractions if answer else (), strict=False):
            axes.plot(values, **Line("ink" if answer is other else ink, *style).options())
    axes.axhline(0.0, color=colour("rule"), linewidth=0.6)
    axes.xaxis.set_major_locator(MaxNLocator(5, integer=True))
    axes.set(xlabel="step", ylabel=axis("traction", stress))


def _overview(found: Judgement, units: Units) -> Iterator[Panel]:
    """Work to failure over the mode ratio, and the best defect where it shows most."""
    if len(found.toughness) > 1:
        caption = "Work to failure at constant mode ratios" + ", and the toughness of the bond" * found.compared
        values = ", ".join(f"{G:.4g} at B = {B:g}" for B, G in found.toughness.items())
        caption, draw = f"{caption}: {values}.", partial(_toughness, found, units.toughness)
        yield _drawn("toughness", "Work to failure over the mode ratio", caption, draw)
    for best, trial in [(one, one.trial) for one in found.defects if one.trial][:1]:
        case = next(case for case in found.cases if case.way.name == best.path)
        caption = f"{best.name} on {best.path}: the law, and the definition without and with the defect."
        draw = partial(_tractions, case, units.stress, other=of_bond(trial.bond, case.way))
        yield _drawn("defect", f"The defect {best.name} on the path {best.path}", caption, draw)


def _toughness(found: Judgement, unit: str, axes: Axes) -> None:
    """Against the definition, and the criterion where that is another."""
    B = np.linspace(0.0, 1.0, 101)
    known, said = found.bond.critical(B), found.bond.by_criterion(B)
    if found.compared:
        axes.plot(B, known, **Line("accent", *_WIDE).options(), label="definition")
        if not np.allclose(known, said):
            axes.plot(B, said, **Line("ink", *_DASHED).options(), label="criterion")
    ratio, work = zip(*found.toughness.items(), strict=True)
    axes.plot(ratio, work, "o", color=colour("ink"), markersize=4, label="law", clip_on=False)
    axes.set(xlabel="mode ratio by energy, B", ylabel=axis("work to failure", unit), ylim=(0, None))
    axes.legend(loc="best")
