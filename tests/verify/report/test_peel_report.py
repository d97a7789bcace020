"""The section of a peel test: two bodies, distances counted from the right."""

from __future__ import annotations

import pytest

pytest.importorskip("matplotlib")
pytest.importorskip("jinja2")

from figures import Drawn  # noqa: E402

from verify.methods.solve import solve  # noqa: E402
from verify.report import cost
from verify.report.figures import curves, drawing, fields, meshes
from verify.report.figures.layout import zoom  # noqa: E402
from verify.report.section import section  # noqa: E402
from verify.scene.load import load_scene  # noqa: E402
from verify.verdict import Run, SceneReport  # noqa: E402


def test_strip_and_substrate_are_told_and_drawn(monkeypatch: pytest.MonkeyPatch) -> None:
    """Distances are counted from the loaded end at X = 150, coordinates from the flush end; the bond ends at 80."""
    scene = load_scene("peel-80", ("discretization.dofs=1100", "load.opening=2.0", "discretization.steps=10"))
    drawn = Drawn(monkeypatch, cost, curves, drawing, fields, meshes, filled=0.35)  # ten steps do not go far
    runs = tuple(Run(method, method, solve(scene, method)) for method in ("nurbs", "beam"))
    found = section(SceneReport(scene, runs, ()), "peel")
    assert len(drawn) > 8
    last = runs[0].result.snapshots[-1]
    zone = meshes.zone_at(scene, last)
    assert zone is not None and zone[0] < zone[1] < 80.0 and zone[1] > 75.0
    (left, right), _ = zoom(scene, [last], 1.0)
    assert left < zone[0] < zone[1] < right
    assert "A strip of 150\u00a0mm by 2\u00a0mm, bonded over 80\u00a0mm to a clamped substrate" in found.sentence
    assert "The base of the substrate is clamped" in found.specimen.caption
    bodies = {table.caption: [cell.text for cell in table.cells()[0]] for table in found.inputs}
    assert (
        bodies["substrate"] == ["Young's modulus", "5000\u00a0MPa"] and "both bodies" in found.runs.cells()[0][1].text
    )
