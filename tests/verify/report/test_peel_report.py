"""The page about a peel test: two bodies, distances counted from the right, its own drawing and inputs."""

from __future__ import annotations

from pathlib import Path

import pytest

pytest.importorskip("matplotlib")
pytest.importorskip("jinja2")

from verify import report  # noqa: E402
from verify.methods.solve import solve  # noqa: E402
from verify.report.figures.layout import zoom  # noqa: E402
from verify.report.figures.undeformed import zone_at  # noqa: E402
from verify.scene.load import load_scene  # noqa: E402
from verify.scene.schema import Scene
from verify.verdict import Run, SceneReport  # noqa: E402

OVERRIDES = ("discretization.dofs=1100", "load.opening=2.0", "discretization.steps=10")


@pytest.fixture(scope="module")
def scene() -> Scene:
    return load_scene("peel-80", OVERRIDES)


@pytest.fixture(scope="module")
def run(scene: Scene) -> Run:
    return Run("NURBS p=3, 1100 unknowns", "nurbs", solve(scene, "nurbs"))


def test_the_zone_is_marked_where_the_bond_ends(scene: Scene, run: Run) -> None:
    """Distances are counted from the loaded end at X = 150, coordinates from the flush end; the bond ends at 80."""
    last = run.result.snapshots[-1]
    zone = zone_at(scene, last)
    assert zone is not None and zone[0] < zone[1] < 80.0 and zone[1] > 75.0
    (left, right), _ = zoom(scene, [last], 1.0)
    assert left < zone[0] < zone[1] < right


def test_the_page_tells_of_strip_and_substrate(scene: Scene, run: Run, tmp_path: Path) -> None:
    report.write(report.Findings((SceneReport(scene, (run,), ()),), {}), tmp_path / "report.html")
    text = (tmp_path / "report.html").read_text().replace("\u00a0", " ")
    for words in (
        "A strip of 150 mm by 2 mm, bonded over 80 mm to a clamped substrate of 120 mm by 10 mm, is peeled off",
        "both bodies modelled",
        "bond length",
        "strip thickness",
        "The base of the substrate is clamped",
        "<caption>substrate</caption>",
        "5000 MPa",
        "process zone at opening 2 mm",
    ):
        assert words in text, words
    assert "precrack" not in text and "arms" not in text.split("What the checks rest on")[0]
