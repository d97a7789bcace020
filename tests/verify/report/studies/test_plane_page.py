"""The page of a plane problem: its table, its pictures and its convergence are the numbers of the study."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

pytest.importorskip("matplotlib")
pytest.importorskip("jinja2")

from figures import Drawn  # noqa: E402

from verify.pages.style import colour  # noqa: E402
from verify.report.studies import plane  # noqa: E402
from verify.studies.plane.errors import Errors  # noqa: E402
from verify.studies.plane.study import Level, PlaneStudy  # noqa: E402
from verify.verdict import Check  # noqa: E402

NAN = float("nan")


def level(name: str, cuts: int, rate: float, energy_rate: float) -> Level:
    """Errors that fall with the fourth and the third power of halved elements."""
    found = Errors(1e-3 / 16**cuts, 1e-2 / 8**cuts, 2e-2 / 8**cuts)
    return Level(name, 4 * 4**cuts, 100 * 4**cuts, found, rate, energy_rate)


def made_up() -> PlaneStudy:
    """A ring whose stress is off at its ends, with a patch test that holds and a rate that does not."""
    u, v = np.meshgrid(np.linspace(0.0, 3.0, 5), np.linspace(0.0, 2.0, 5), indexing="ij")
    X = np.stack([u, v], axis=-1)[None]
    exact = np.full((1, 5, 5), 2.0)
    levels = (
        level("the file", 0, NAN, NAN),
        level("Bezier elements", 1, NAN, NAN),
        level("each cut into 4", 2, 4.0, 3.0),
        level("each cut into 16", 3, 4.0, 3.0),
    )
    patch = Errors(1e-13, 1e-12, 3e-12)
    checks = (
        Check("patch-test", "ring", 3e-12, 1e-9, "exact", "A constant stress is found exactly."),
        Check("rate", "ring", 0.9, 0.2, "analytical", "The rate in L2 under refinement is p + 1."),
    )
    return PlaneStudy("ring", "a ring in tension", 4, patch, levels, X, exact + 0.25 * (u - 1.5)[None], exact, checks)


@pytest.fixture
def study() -> PlaneStudy:
    return made_up()


def test_the_table_has_errors_and_rates_of_every_mesh(study: PlaneStudy, monkeypatch: pytest.MonkeyPatch) -> None:
    Drawn(monkeypatch, plane)
    section = plane.section(study, "plane-1")
    assert [row.name for row in section.rows] == [one.name for one in study.levels] and section.counts.broken == 1
    for row, one in zip(section.rows, study.levels, strict=True):
        elements, unknowns, displacement, rate, energy, energy_rate, stress = row.cells
        assert (int(elements), int(unknowns)) == (one.elements, one.unknowns)
        assert rate == ("–" if np.isnan(one.rate) else "4.00") and energy_rate == (
            "–" if np.isnan(one.rate) else "3.00"
        )
        for text, value in (
            (displacement, one.errors.displacement),
            (energy, one.errors.energy),
            (stress, one.errors.stress),
        ):
            mantissa, _, power = text.replace("−", "-").partition("\u00a0×\u00a010")
            digits = str.maketrans("⁰¹²³⁴⁵⁶⁷⁸⁹⁻", "0123456789-")
            found = float(mantissa) * 10.0 ** (int(power.translate(digits)) if power else 0)
            assert found == pytest.approx(value, rel=5e-3)
    assert section.problem == "A ring in tension" and len(section.panels) == 3


def test_a_sentence_tells_patch_test_errors_and_rate(study: PlaneStudy, monkeypatch: pytest.MonkeyPatch) -> None:
    Drawn(monkeypatch, plane)
    whole = plane.section(study, "plane-1")
    assert whole.sentence.startswith(
        "ring: patch test to 3\u00a0×\u00a010⁻¹²; displacement within 0.001 of the exact field"
    )
    assert (
        whole.sentence.endswith("refined, rate 4.00.")
        and "it is judged" in whole.note
        and "rates 4 and 3" in whole.note
    )
    moving = replace(study, levels=(*study.levels[:3], replace(study.levels[3], rate=2.5)))
    found = plane.section(moving, "plane-1")
    assert found.sentence.endswith("rate 2.50, not settled.") and "it is still changing, and not judged" in found.note


def test_a_file_that_is_too_large_to_refine_has_a_page(study: PlaneStudy, monkeypatch: pytest.MonkeyPatch) -> None:
    """It is the only mesh, and there is no rate."""
    drawn = Drawn(monkeypatch, plane)
    alone = plane.section(replace(study, levels=study.levels[:1]), "plane-1")
    assert "rate" not in alone.sentence and len(alone.rows) == 1
    axes = drawn.axes("Convergence on ring")
    assert [len(one.get_xdata()) for one in axes.lines] == [1, 1] and not axes.texts


def test_errors_are_drawn_over_the_unknowns_a_direction(study: PlaneStudy, monkeypatch: pytest.MonkeyPatch) -> None:
    drawn = Drawn(monkeypatch, plane)
    plane.section(study, "plane-1")
    axes = drawn.axes("Convergence on ring")
    n = np.sqrt([one.unknowns for one in study.levels])
    for ink, name, order in (("nurbs", "displacement", 4), ("lagrange", "energy", 3)):
        (line,) = [one for one in axes.lines if one.get_color() == colour(ink)]
        values = np.array([getattr(one.errors, name) for one in study.levels])
        assert line.get_xdata() == pytest.approx(n) and line.get_ydata() == pytest.approx(values)
        slopes = [one for one in axes.lines if one.get_color() == colour("muted")]
        slope = slopes[0] if order == 4 else slopes[1]
        assert slope.get_xdata() == pytest.approx(n[1:]) and slope.get_ydata() == pytest.approx(values[1:])
    assert [t.get_text() for t in axes.texts] == ["4", "3"]
    for text, name, order in zip(axes.texts, ("displacement", "energy"), (4, 3), strict=True):
        assert text.xy == pytest.approx((n[1], getattr(study.levels[-1].errors, name) * (n[-1] / n[1]) ** order))
    assert axes.get_xscale() == axes.get_yscale() == "log"
    assert not [*axes.xaxis.get_minorticklocs(), *axes.yaxis.get_minorticklocs()], "every tick has its number"


def test_stress_and_its_error_are_painted_to_scale(study: PlaneStudy, monkeypatch: pytest.MonkeyPatch) -> None:
    drawn, painted = Drawn(monkeypatch, plane), []
    monkeypatch.setattr(
        plane, "paint", lambda axes, X, value, limit, frame: painted.append((axes, X, value, limit, *frame))
    )
    panels = plane.section(study, "plane-1").panels
    assert [title for title, _ in drawn][:2] == ["Stress on the elements of ring", "Error of the stress of ring"]
    (_, X, stress, limit, x, y), (_, _, miss, reach, _, _) = painted
    assert X is study.X_euvi and stress is study.found_euv and np.array_equal(miss, study.found_euv - study.exact_euv)
    assert limit == pytest.approx(2.375, rel=1e-2) and reach == pytest.approx(0.375, rel=1e-2)
    assert "to ± 0.3" in panels[1].caption
    assert (x[0] < 0.0 and x[1] > 3.0 and y[0] < 0.0 and y[1] > 2.0) and x[1] - x[0] == pytest.approx(3.06)
    for axes, *_ in painted:
        box = axes.get_window_extent()
        assert box.width / box.height == pytest.approx((x[1] - x[0]) / (y[1] - y[0]))
        sheet = axes.figure.bbox
        assert sheet.x0 < box.x0 and box.x1 < sheet.x1 and box.y1 < sheet.y1, "nothing of it is cut off"
        assert box.x0 - sheet.x0 == pytest.approx(sheet.x1 - box.x1), "in the middle"
    bars = [figure.axes[1] for title, figure in drawn if title.startswith(("Stress", "Error"))]
    assert [bar.get_xlim() for bar in bars] == [pytest.approx((-limit, limit)), pytest.approx((-reach, reach))]
    assert [bar.get_xlabel() for bar in bars] == ["stress xx", "stress xx less the exact one"]
