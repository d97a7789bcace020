"""The study as a page, with both curves and a band."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from verify.curves.curve import envelope, from_origin
from verify.pages.style import WIDE, Line, Panel, colour, drawing, panel
from verify.pages.text import Units, axis
from verify.studies import uncertainty_page
from verify.studies.validation.quantities import WINDOWS, mean_load
from verify.studies.validation.statement import ESTIMATES, statement
from verify.studies.validation.study import Study

#: Points of the band.
BAND_POINTS = 200


def write(study: Study, path: Path) -> None:
    """Write the page."""
    uncertainty_page.write(study, path, curves=[drawn(study)] if study.curves else [], coverage=ESTIMATES.coverage)


def drawn(study: Study) -> Panel:
    """Both curves, and the band of the expanded uncertainty around that of the simulation.

    The mesh is left out: its index describes single quantities, and not a steep drop that moves a little.
    """
    curve, data, units = study.curves["mesh"][0], study.data.result, Units.of(study.scene.units)
    simulated, stated = envelope(*curve), study.scene.uncertainty
    grid = np.linspace(0.0, WINDOWS.whole * float(np.max(simulated[0])), BAND_POINTS)
    each = [statement(mean_load(np.array([x])), study.curves, (), curve, stated) for x in grid]
    load, u = np.array([(one.S, ESTIMATES.coverage * one.u_val) for one in each]).T
    with drawing():
        figure, axes = panel(WIDE, 3.4)
        axes.fill_between(grid, load - u, load + u, color=colour("accent"), alpha=0.25, linewidth=0)
        axes.plot(*simulated, color=colour("accent"), linewidth=1.2, label=f"S: {study.method}")
        of_data = Line("ink", 1.0, (3.0, 1.5), 1.0, 4.0)
        axes.plot(*from_origin(data.opening, data.load), **of_data.options(), label=f"D: {study.data.name}")
        axes.set(xlabel=axis("opening", units.length), ylabel=axis("load", units.force), xlim=(0, None), ylim=(0, None))
        axes.legend(loc="best")
        caption = (
            f"The simulation S with {ESTIMATES.coverage:g} times the standard uncertainty of inputs, introduction of "
            "the load and data at each opening, without that of the mesh; and the data D."
        )
        title = "Load against opening of the simulation and of the data"
        return Panel.of(figure, "curves", title, caption, "wide")
