"""Pictures of the crack at one opening after the other: one scale for all of them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

pytest.importorskip("matplotlib")

from figures import Drawn  # noqa: E402
from made_up_runs import scene_report  # noqa: E402

from verify.report.figures import opening  # noqa: E402
from verify.report.figures.entry import entries  # noqa: E402
from verify.report.figures.fields import shared_snapshots  # noqa: E402
from verify.report.figures.layout import LEAST_HEIGHT, MOST_HEIGHT, WHOLE, frame  # noqa: E402
from verify.result import Snapshot  # noqa: E402


@pytest.mark.parametrize(("least", "below"), [(0.5, 0.1), (0.0, 0.1), (-0.4, 0.54), (-5.0, 3.4)])
def test_tractions_are_seen_whole_but_for_the_pressure_of_contact(
    least: float, below: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """In parts of the strength: a fifth above it, a tenth below what there is, and three times of pressure at most."""
    drawn, report = Drawn(monkeypatch, opening), scene_report()
    found = [entry for entry in entries(report) if entry.agreement is not None]
    strength = report.scene.interface.strength
    groups = [
        [(entry, replace(one, traction_q=np.linspace(0.5, least, len(one.s_q)) * strength)) for entry, one in group]
        for group in shared_snapshots(found)
    ]
    shown = opening.frames(report.scene, groups, found, "key", between=False)
    assert len(shown) == len(drawn) == len(groups)
    for _, figure in drawn:
        assert figure.axes[1].get_ylim() == pytest.approx((-below * strength, 1.2 * strength))


@pytest.mark.parametrize("reach", [0.1, 1.0, 3.0, 20.0])
def test_however_far_arms_open_their_picture_is_neither_too_low_nor_too_high(reach: float) -> None:
    """And to scale: what is too tall gets room on the right, what is too flat above and below."""
    scene = scene_report().scene
    X_euvi = np.array([[[[0.0, -reach], [0.0, reach]], [[14.0, 0.0], [14.0, 0.0]]]])
    nothing = np.zeros(0)
    shown = Snapshot(1.0, 0.1, nothing, nothing, nothing, nothing, X_euvi, 0.0 * X_euvi, np.zeros((1, 2, 2)))
    (left, right), (low, high) = frame(scene, [shown])
    assert left < 0.0 and right > 14.0 and low < -reach and high > reach
    inches = WHOLE * (high - low) / (right - left)
    assert LEAST_HEIGHT * (1.0 - 1e-9) <= inches <= MOST_HEIGHT * (1.0 + 1e-9)
    assert (right == pytest.approx(14.14)) == (reach < 2.5), "no more room than it takes"
