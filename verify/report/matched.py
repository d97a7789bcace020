"""The error of a matched interface in a peel test, in a sentence per run."""

from __future__ import annotations

from collections.abc import Sequence
from math import degrees

from verify.checks import matched
from verify.methods.solve import prepare
from verify.pages.text import number, percent
from verify.report.figures.entry import Entry
from verify.scene.effects import simulated
from verify.scene.schema import Scene


def sentences(scene: Scene, found: Sequence[Entry]) -> tuple[str, ...]:
    """A sentence for each DOLFINx run of a peel test with finite kinematics; linear kinematics has no such error."""
    if not scene.specimen.clamped or simulated(scene)["kinematics"] == "linear":
        return ()
    runs = (entry for entry in found if entry.method == "dolfinx" and entry.agreement is not None)
    return tuple(_sentence(scene, entry) for entry in runs)


def _sentence(scene: Scene, entry: Entry) -> str:
    found = matched.of_run(prepare(entry.run.scene or scene, entry.result.method), entry.result)
    how = f"{entry.label} keeps its pairs of points and measures gaps along the undeformed normal"
    if found is None:
        return f"{how}; the error of that is unknown, as the run kept no fields"
    what = (
        f"In the fields that were kept the substrate tilts by at most {number(degrees(found.tilt), 2)}° where it is "
        f"pulled; along its own normal gaps would change by {percent(found.gap)} of g_u in the process zone, and "
        f"tractions would pull lengthwise with {percent(found.pull)} of the load"
    )
    if found.valid:
        return f"{how}. {what}. This changes G_Ic and load by at most {percent(found.bound)}"
    return (
        f"{how}. {what}. Not valid here: this may change G_Ic and load by {percent(found.bound)}, more than "
        f"{percent(matched.NEGLIGIBLE)}, so its distance to a code that follows the surfaces is not meaningful"
    )
