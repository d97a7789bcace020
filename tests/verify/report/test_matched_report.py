"""What the page says of a matched interface: its bound, and where it is no longer valid."""

from __future__ import annotations

from dataclasses import replace
from html import unescape
from pathlib import Path
from re import sub

import numpy as np
import pytest

pytest.importorskip("matplotlib")
pytest.importorskip("jinja2")

from tests.verify.checks.test_peel_checks import made_up  # noqa: E402

from verify import report  # noqa: E402
from verify.checks.matched import of_run  # noqa: E402
from verify.checks.mechanics.columns import law_of  # noqa: E402
from verify.methods.solve import prepare
from verify.report.figures.entry import entries  # noqa: E402
from verify.report.matched import sentences  # noqa: E402
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
def scene() -> Scene:
    return load_scene("peel-60")


def test_the_bound_stands_next_to_the_run(scene: Scene) -> None:
    """A tilt of 0.12 degrees: the tractions pull lengthwise with its sine, 0.21 % of the load."""
    tilt = np.radians(0.12)
    found = of_run(prepare(scene, peel(scene, tilt).method), peel(scene, tilt))
    assert found.bound == found.pull == pytest.approx(np.sin(tilt), rel=0.01) and found.valid
    text = said(scene, peel(scene, 0.5 * tilt, tilt))
    assert f"{LABEL} keeps its pairs of points" in text and "tilts by at most 0.12° where it is pulled" in text
    assert "This changes G_Ic and load by at most 0.21 %" in text and "Not valid here" not in text


def test_it_says_where_a_matched_interface_is_not_valid(scene: Scene) -> None:
    text = said(scene, peel(scene, np.radians(0.12), np.radians(2.0)))
    assert "Not valid here: this may change G_Ic and load by 3.5 %, more than 0.50 %" in text
    assert "no more than" not in text


def test_the_bound_is_that_of_gap_and_pull(scene: Scene) -> None:
    """2 delta / g_u of G_Ic where the gap is off by delta: no traction is above 2 G_Ic / g_u."""
    found, law = of_run(prepare(scene, peel(scene, 0.001).method), peel(scene, 0.001)), law_of(scene)
    delta = found.gap * law.g_open
    assert replace(found, pull=0.0).bound * scene.interface.toughness == pytest.approx(law.strength * delta)
    assert replace(found, gap=0.0).bound == found.pull
    assert replace(found, gap=0.51 * NEGLIGIBLE).valid is replace(found, pull=1.01 * NEGLIGIBLE).valid is False
    assert replace(found, pull=np.nan).valid is False


@pytest.mark.parametrize(("keys", "method"), [(["effects.kinematics=linear"], "dolfinx"), ([], "nurbs")])
def test_nothing_is_said_where_nothing_is_left_out(keys, method) -> None:
    scene = load_scene("peel-60", keys)
    assert said(scene, replace(peel(scene, 0.05), method=method)) == ""


def test_it_is_not_known_without_fields(scene: Scene) -> None:
    text = said(scene, made_up(scene, "dolfinx"))
    assert "undeformed normal; the error of that is unknown, as the run kept no fields" in text


def test_the_sentence_is_on_the_page(scene: Scene, tmp_path: Path) -> None:
    result = peel(scene, 0.002)
    report.write(
        report.Findings((SceneReport(scene, (Run(LABEL, "dolfinx", result),), ()),), {}), tmp_path / "report.html"
    )
    text = unescape(sub(r"<[^>]+>", "", (tmp_path / "report.html").read_text())).replace("\u00a0", " ")
    assert said(scene, result).replace("G_Ic", "GIc").replace("g_u", "gu") + "." in text
