"""Runs against the reference of their page: which one that is, how far the others are, and how they are named."""

from __future__ import annotations

from dataclasses import replace
from math import isnan

import numpy as np
import pytest

pytest.importorskip("matplotlib")
pytest.importorskip("jinja2")

from verify.methods import zone_resolution  # noqa: E402
from verify.pages.style import IN_TABLES, line  # noqa: E402
from verify.pages.text import number  # noqa: E402
from verify.report import tables  # noqa: E402
from verify.report.figures.curves import branch, path  # noqa: E402
from verify.report.figures.entry import agreement, entries, rank, reference_run, short_names, usable  # noqa: E402
from verify.report.figures.layout import CLOSE_UP, zoom  # noqa: E402
from verify.result import Result, Snapshot  # noqa: E402
from verify.scene.load import load_scene  # noqa: E402
from verify.scene.schema import Scene
from verify.verdict import Run, SceneReport  # noqa: E402

SCENE = load_scene("dcb-czm1")


def run(method: str, factor: float = 1.0, dofs: int = 100, n: int = 300, end: float = 3.0, **about) -> Run:
    """Load ``factor`` d exp(1 - d), whose peak is ``factor`` at 1."""
    d = np.linspace(0.0, end, n + 1)
    load = factor * d * np.exp(1.0 - d)
    return Run(f"{method} {dofs}", method, Result(method, {"opening": d, "load": load}, dofs=dofs, **about))


def test_the_reference_is_the_finest_whole_run_of_the_first_code_that_has_one() -> None:
    stopped, few = run("dolfinx", dofs=900, status="stopped: here"), run("dolfinx", dofs=200)
    many, beam = run("dolfinx", dofs=800), run("beam", dofs=0)
    none = replace(many, result=None)
    single = replace(many, result=replace(many.result, steps={k: c[:1] for k, c in many.result.steps.items()}))
    chosen = [
        (many, (run("nurbs"), few, stopped, many, beam, run("lefm"))),
        (beam, (run("nurbs"), stopped, none, single, beam)),
        (None, (run("nurbs"), stopped, run("lefm"))),
        (None, ()),
    ]
    for expected, runs in chosen:
        assert reference_run(SceneReport(SCENE, runs, ())) is expected
    assert [usable(one) for one in (many, none, single)] == [True, False, False]


def test_a_factor_of_the_load_is_an_error_and_no_oscillation() -> None:
    base = run("dolfinx")
    found = agreement(run("nurbs", 1.02), base, (3.0,))
    assert found.error == pytest.approx(0.02, rel=1e-9) and found.oscillation == pytest.approx(0.0, abs=1e-9)
    assert (found.peak_load, found.peak_opening, found.end) == pytest.approx((1.02, 1.0, 3.0), rel=1e-6)
    for one, against in ((base, base), (run("lefm"), base), (run("nurbs"), None)):
        alone = agreement(one, against, (3.0,))
        assert isnan(alone.error) and isnan(alone.oscillation) and (alone.peak_load, alone.end) == (1.0, 3.0)


@pytest.mark.parametrize(("mine", "theirs", "end"), [(2.0, 3.0, 2.0), (3.0, 2.0, 2.0), (2.5, 2.5, 2.5)])
def test_curves_are_compared_as_far_as_both_came(mine: float, theirs: float, end: float) -> None:
    found = agreement(run("nurbs", 1.01, end=mine), run("dolfinx", end=theirs), (3.0,))
    assert found.end == end and found.error == pytest.approx(0.01, rel=1e-2)
    openings, ratio = branch(run("nurbs", 1.01, end=mine).result, run("dolfinx", end=theirs).result)
    assert openings[0] == pytest.approx(1.3, rel=1e-2) and openings[-1] == end and len(openings) == 400
    assert ratio == pytest.approx(0.01, abs=1e-4)


def test_the_error_of_a_programme_that_turns_is_that_of_its_worst_leg() -> None:
    """Both draw one envelope; the other curve heals: it unloads to twice the load of the secant at opening 0.2."""
    up, down, on = np.linspace(0.0, 1.5, 151), np.linspace(1.5, 0.2, 51)[1:], np.linspace(0.2, 1.5, 51)[1:]
    beyond = np.linspace(1.5, 3.0, 151)[1:]
    opening = np.concatenate([up, down, on, beyond])

    def unloads_to(low: float) -> Run:
        inside = 1.5 * np.exp(-1.5) * np.interp(np.concatenate([down, on]), [0.2, 1.5], [low, 1.0])
        load = np.concatenate([up * np.exp(-up), inside, beyond * np.exp(-beyond)])
        return Run("nurbs", "nurbs", Result("nurbs", {"opening": opening, "load": load}, dofs=100))

    secant = 0.2 / 1.5
    base, healed = unloads_to(secant), unloads_to(2.0 * secant)
    assert agreement(healed, base, (3.0,)).error < 1e-12, "the envelope alone does not tell"
    assert agreement(healed, base, (1.5, 0.2, 3.0)).error > 0.05


def test_between_steps_the_path_is_a_cubic_and_a_limit_is_a_polygon() -> None:
    d = np.linspace(0.0, 1.0, 21)
    steps = {"opening": d, "load": d + 4.0 * d * (1.0 - d), "load_slope": 5.0 - 8.0 * d, "heading": np.ones_like(d)}
    x, y = path(Result("nurbs", steps))
    assert len(x) > 100 and y == pytest.approx(x + 4.0 * x * (1.0 - x), abs=1e-4)
    for polygon in (Result("lefm", steps), Result("mine", {k: steps[k] for k in ("opening", "load")})):
        assert all(np.array_equal(a, b) for a, b in zip(path(polygon), (d, steps["load"]), strict=True))


def test_runs_stand_in_the_order_of_methods_and_fade_where_they_repeat() -> None:
    runs = (run("lefm"), run("nurbs", dofs=1), run("mine"), run("dolfinx"), run("nurbs", dofs=2), run("yours"))
    found = entries(SceneReport(SCENE, runs, ()))
    assert [one.method for one in found] == ["dolfinx", "nurbs", "nurbs", "lefm", "mine", "yours"]
    assert [one.repeat for one in found] == [0, 0, 1, 0, 0, 1] and [one.is_reference for one in found] == [True] + [
        False
    ] * 5
    assert [rank(method) for method in IN_TABLES] == list(range(len(IN_TABLES))) and rank("mine") == len(IN_TABLES)
    first, second = found[1].line, found[2].line
    assert (second.width, second.alpha, second.order) == pytest.approx((0.6 * first.width, 0.6, first.order - 0.1))
    assert line("nurbs", 9).width == 0.6 and line("nurbs", 9).alpha == pytest.approx(0.4) and first.colour == "nurbs"
    names = short_names(found)
    assert [names[one] for one in found[:4]] == ["DOLFINx", "nurbs 1", "nurbs 2", "LEFM limit"]
    assert [one.legend for one in found[2:5]] == ["nurbs 2", "lefm 100 (limit)", "mine 100"]
    gone = entries(SceneReport(SCENE, (Run("x", "nurbs", None, "not run"),), ()))[0]
    assert gone.agreement is None and not gone.complete and not gone.is_reference


def test_published_values_stand_beside_what_runs_found() -> None:
    known = [
        {"quantity": "peak", "value": 1.0, "tolerance": 0.05, "kind": "cross-code", "source": "a book"},
        {"quantity": "load_at", "opening": 2.0, "value": [0.6, 0.7], "tolerance": 0.02, "kind": "cross-code",
         "source": "another"},
    ]  # fmt: skip
    from verify.scene.parse import parse_scene

    scene = parse_scene({**{k: v for k, v in SCENE.model_dump().items() if v is not None}, "published": known})
    found = entries(SceneReport(scene, (run("nurbs", 1.1), Run("x", "beam", None, "not run")), ()))
    peak, load = tables.published_values(scene, found, "one").cells()
    assert [len(row) for row in (peak, load)] == [4, 4], "no column for a run without a curve"
    texts = [[cell.text.replace("\u00a0", " ") for cell in row] for row in (peak, load)]
    assert texts[0] == ["peak load", "1 N", "5.0 %", "1.1 N"] and peak[3].below == "+10\u00a0%"
    at_two = f"{1.1 * 2.0 * np.exp(-1.0):.4f} N"
    assert texts[1] == ["load at 2 mm", "0.6 to 0.7 N", "2.0 %", at_two] and load[3].below.startswith("+1")
    assert (peak[0].below, load[0].below) == ("a book", "another")


# --- rows of specimens


def damaged(scene: Scene, start: float, end: float) -> Snapshot:
    s_q = np.linspace(scene.specimen.free_length, scene.specimen.extent, 2001)
    damage = np.where(s_q < start, 1.0, np.where(s_q <= end, 0.5, 0.0))
    grids = {"X_euvi": np.zeros((0, 1, 1, 2)), "u_euvi": np.zeros((0, 1, 1, 2)), "stress_euv": np.zeros((0, 1, 1))}
    return Snapshot(1.0, 1.0, s_q, 0 * s_q, 0 * s_q, damage, **grids)


@pytest.mark.parametrize(("start", "end"), [(6.0, 7.0), (6.0, 8.0), (6.0, 6.1), (4.0, 13.0), (13.0, 13.9)])
def test_what_is_enlarged_is_to_scale_around_the_zone(start: float, end: float) -> None:
    """As wide as 1.7 zones, but no less than five arms and no more than 0.3 of the specimen; never beyond its end."""
    (left, right), (low, high) = zoom(SCENE, [damaged(SCENE, start, end)], 0.7)
    body = SCENE.specimen
    wanted = min(max(1.7 * (end - start), 5 * body.arm_thickness), 0.3 * body.length)
    assert right - left == pytest.approx(wanted, rel=0.02) and low == -high
    assert (high - low) / 0.7 == pytest.approx((right - left) / CLOSE_UP), "an inch is as long both ways"
    assert right <= body.length + 1e-9
    middle = min(0.5 * (start + end), body.length - 0.5 * wanted)
    assert 0.5 * (left + right) == pytest.approx(middle, rel=0.01)
    tip, _ = zoom(SCENE, [damaged(SCENE, 20.0, 21.0)], 0.7)
    assert 0.5 * sum(tip) == pytest.approx(body.precrack), "without a zone the tip"


def test_the_process_zone_is_told_in_lengths_and_in_elements() -> None:
    """Estimated for the mesh, measured as the median while the crack runs; without a mesh there is none to tell of."""
    expected = zone_resolution.expected(SCENE, "nurbs")
    one = run("nurbs")
    crack = np.where(one.result.opening > 1.0, 5.0, 4.0)
    steps = {
        **one.result.steps,
        "crack_length": crack,
        "damage_front": crack + 1.2345 + 0.01 * (one.result.opening == 3),
    }
    measured = replace(one, result=replace(one.result, steps=steps))
    found = entries(SceneReport(SCENE, (measured, run("nurbs", dofs=5), run("beam")), ()))
    full, bare = tables.process_zones(SCENE, found, "one").cells()
    estimate = [f"{number(expected.element, 2)} mm", f"{number(expected.length, 2)} mm", number(expected.elements, 2)]
    texts = [[cell.text.replace("\u00a0", " ") for cell in row[1:]] for row in (full, bare)]
    mesh = "✓ fine enough" if expected.elements >= 3 else "⚠ fewer than 3 elements"
    assert texts[0] == [*estimate, "1.2 mm", number(1.2345 / expected.element, 2), mesh]
    assert texts[1] == [*estimate, "–", "–", mesh]
    coarse = SCENE.model_copy(update={"discretization": SCENE.discretization.model_copy(update={"dofs": 280})})
    (row,) = tables.process_zones(coarse, entries(SceneReport(coarse, (run("nurbs"),), ())), "one").cells()
    assert row[-1].tone == "bad" and row[-1].text == "⚠ fewer than 3 elements"
