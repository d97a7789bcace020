"""What the page says of a matched interface: its bound, and where it is no longer valid."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

pytest.importorskip("matplotlib")
pytest.importorskip("jinja2")

from tests.verify.checks.made_up import peel as made_up  # noqa: E402
from verify.checks.matched import of_run  # noqa: E402
from verify.checks.mechanics.columns import law_of  # noqa: E402
from verify.methods.solve import prepare
from verify.report.figures.entry import entries  # noqa: E402
from verify.report.tables import matched_interfaces as sentences  # noqa: E402
from verify.result import Result, Snapshot  # noqa: E402
from verify.scene.effects import NEGLIGIBLE
from verify.scene.load import load_scene  # noqa: E402
from verify.scene.schema import Scene
from verify.verdict import Run, SceneReport  # noqa: E402

LABEL = "DOLFINx p=2, 150 elements"


def tilted(scene: Scene, tilt: float) -> Snapshot:
    """Half a process zone open on a substrate that has turned by ``tilt``, under a strip that has not slid."""
    body, law, t = scene.specimen, law_of(scene), np.linspace(0.0, 1.0, 3)
    X_e = np.linspace(0.0, body.substrate_length, 13)
    X = np.broadcast_to((X_e[:-1, None] + np.diff(X_e)[:, None] * t)[:, :, None], (12, 3, 3))
    layers = []
    for low, high, slope in ((0.0, body.strip_thickness, 0.0), (-body.substrate_thickness, 0.0, np.tan(tilt))):
        Y = np.broadcast_to(low + (high - low) * t, X.shape)
        layers.append((np.stack([X, Y], -1), np.stack([0.0 * X, slope * X], -1)))
    X_euvi, u_euvi = (np.concatenate(parts) for parts in zip(*layers, strict=True))
    s_q = np.linspace(body.free_length, body.strip_length, 400)
    gap_q = np.where(s_q < body.free_length + 4.0, 0.5 * law.g_open, 0.0)
    traction_q = np.where(gap_q > 0.0, 0.5 * law.strength, 0.0)
    load = scene.specimen.width * 0.5 * law.strength * 4.0  # all of it carried by the zone
    return Snapshot(3.0, load, s_q, gap_q, traction_q, gap_q / law.g_open, X_euvi, u_euvi, np.zeros(X_euvi.shape[:3]))


def peel(scene: Scene, *tilts: float) -> Result:
    return replace(made_up(scene, "dolfinx"), snapshots=tuple(tilted(scene, tilt) for tilt in tilts))


def said(scene: Scene, result: Result) -> str:
    (text,) = sentences(scene, entries(SceneReport(scene, (Run(LABEL, result.method, result),), ()))) or ("",)
    return text.replace("\u00a0", " ")


@pytest.fixture(scope="module")
def scene():
    return load_scene("peel-60")


def test_the_bound_is_that_of_gap_and_pull_and_stands_next_to_the_run(scene):
    """A tilt of 0.12 degrees: the tractions pull lengthwise with its sine, 0.21 % of the load. Where the gap is off by
    delta, 2 delta / g_u of G_Ic: no traction is above 2 G_Ic / g_u."""
    tilt, law = np.radians(0.12), law_of(scene)
    found = of_run(prepare(scene, "dolfinx"), peel(scene, tilt))
    assert found.bound == found.pull == pytest.approx(np.sin(tilt), rel=0.01) and found.valid
    delta = found.gap * law.g_open
    assert replace(found, pull=0.0).bound * scene.interface.toughness == pytest.approx(law.strength * delta)
    assert not any(replace(found, **{key: 1.01 * NEGLIGIBLE}).valid for key in ("gap", "pull"))
    assert replace(found, pull=np.nan).valid is False
    text = said(scene, peel(scene, 0.5 * tilt, tilt))
    assert f"{LABEL} keeps its pairs of points" in text and "tilts by at most 0.12° where it is pulled" in text
    assert "This changes G_Ic and load by at most 0.21 %" in text and "Not valid here" not in text


@pytest.mark.parametrize(
    ("keys", "method", "tilts", "words"),
    [
        ([], "dolfinx", (0.12, 2.0), "Not valid here: this may change G_Ic and load by 3.5 %, more than 0.50 %"),
        ([], "dolfinx", (), "undeformed normal; the error of that is unknown, as the run kept no fields"),
        (["effects.kinematics=linear"], "dolfinx", (3.0,), ""),
        ([], "nurbs", (3.0,), ""),
    ],
)
def test_what_is_said_where_it_is_not_valid_or_not_known(keys, method, tilts, words):
    scene = load_scene("peel-60", keys)
    text = said(scene, replace(peel(scene, *np.radians(tilts)), method=method))
    assert words in text and bool(words) == bool(text)
