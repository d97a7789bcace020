"""Numbers of runs on the page by another route: distances, zones, what is enlarged, colours of a field."""

from __future__ import annotations

from dataclasses import replace
from math import isnan
from types import SimpleNamespace

import numpy as np
import pytest

pytest.importorskip("matplotlib")
pytest.importorskip("jinja2")

from figures import Drawn  # noqa: E402
from made_up_runs import scene_report  # noqa: E402
from matplotlib.figure import Figure  # noqa: E402

from verify.curves.curve import PROPAGATION  # noqa: E402
from verify.pages import paint  # noqa: E402
from verify.pages.style import STRESS_MAP, line  # noqa: E402
from verify.report.figures import curves, fields, meshes  # noqa: E402
from verify.report.figures.entry import Entry, entries  # noqa: E402
from verify.report.figures.fields import process_zone, shared_snapshots  # noqa: E402
from verify.report.page import _sentences  # noqa: E402
from verify.report.section import checks  # noqa: E402
from verify.result import Result, Snapshot  # noqa: E402
from verify.scene.load import load_scene  # noqa: E402
from verify.verdict import Check, Run, SceneReport  # noqa: E402

SCENE = load_scene("dcb-czm1")


def run(method: str, factor: float = 1.0, dofs: int = 100, n: int = 300, end: float = 3.0, **about: object) -> Run:
    """Load ``factor`` d exp(1 - d), whose peak is ``factor`` at 1."""
    d = np.linspace(0.0, end, n + 1)
    steps = {"opening": d, "load": factor * d * np.exp(1.0 - d)}
    return Run(f"{method} {dofs}", method, Result(method, steps, dofs=dofs, **about))


def beside(*runs: Run, **load: object) -> tuple[Entry, ...]:
    scene = SCENE.model_copy(update={"load": SCENE.load.model_copy(update=load)})
    return entries(SceneReport(scene, runs, ()))


def test_the_reference_is_the_finest_whole_run_of_the_first_code_that_has_one():
    stopped, few = run("dolfinx", dofs=900, status="stopped: here"), run("dolfinx", dofs=200)
    many, beam = run("dolfinx", dofs=800), run("beam", dofs=0)
    none = replace(many, result=None)
    single = replace(many, result=replace(many.result, steps={k: c[:1] for k, c in many.result.steps.items()}))
    chosen = [
        (many, (run("nurbs"), few, stopped, many, beam, run("lefm"))),
        (beam, (run("nurbs"), stopped, none, single, beam)),
        (None, (run("nurbs"), stopped, run("lefm"))),
    ]
    for expected, runs in chosen:
        found = beside(*runs)
        assert [one.run for one in found if one.is_reference] == [expected] * (expected is not None)
        assert all((one.agreement is None) == any(one.run is other for other in (none, single)) for one in found)


@pytest.mark.parametrize(("mine", "theirs", "end"), [(2.0, 3.0, 2.0), (3.0, 2.0, 2.0), (2.5, 2.5, 2.5)])
def test_a_factor_is_an_error_and_no_oscillation_as_far_as_both_came(mine, theirs, end):
    base, one, limit = beside(run("nurbs", 1.02, end=mine), run("dolfinx", end=theirs), run("lefm"))
    found = one.agreement
    assert (found.error, found.peak_load, found.peak_opening) == pytest.approx((0.02, 1.02, 1.0), rel=1e-2)
    assert found.end == end and found.oscillation == pytest.approx(0.0, abs=1e-4)
    assert all(isnan(other.agreement.error) and not other.compared for other in (base, limit))


def test_the_error_of_a_programme_that_turns_is_that_of_its_worst_leg():
    """Both draw one envelope; the other curve heals: it unloads to twice the load of the secant at opening 0.2."""
    up, down, on = np.linspace(0.0, 1.5, 151), np.linspace(1.5, 0.2, 51)[1:], np.linspace(0.2, 1.5, 51)[1:]
    beyond = np.linspace(1.5, 3.0, 151)[1:]
    opening = np.concatenate([up, down, on, beyond])

    def unloads_to(method: str, low: float) -> Run:
        inside = 1.5 * np.exp(-1.5) * np.interp(np.concatenate([down, on]), [0.2, 1.5], [low, 1.0])
        load = np.concatenate([up * np.exp(-up), inside, beyond * np.exp(-beyond)])
        return Run(method, method, Result(method, {"opening": opening, "load": load}, dofs=100))

    both = unloads_to("dolfinx", 0.2 / 1.5), unloads_to("nurbs", 0.4 / 1.5)
    alone, legs = (beside(*both, opening=programme)[1].agreement.error for programme in ((3.0,), (1.5, 0.2, 3.0)))
    assert alone < 1e-12, "the envelope does not tell"
    assert legs > 0.05


def test_deviations_are_from_the_reference_and_between_steps_those_of_the_cubics(
    monkeypatch,
):
    """P = x (6 - x) and P (1 ± x / 50): off by ±2 x per cent. Chords of these steps would be off by 0.3 % more."""
    P, share = np.polynomial.Polynomial([0.0, 6.0, -1.0]), np.polynomial.Polynomial([0.0, 0.02])
    runs = []
    for method, load, end, steps in (("dolfinx", P, 5.0, 13), ("nurbs", P * (1 + share), 4.5, 18)):
        x = np.linspace(0.0, end, steps + 1)
        columns = {"opening": x, "load": load(x), "load_slope": load.deriv()(x), "heading": np.ones_like(x)}
        runs.append(Run(method, method, Result(method, columns)))
    figures, found = Drawn(monkeypatch, curves), beside(*runs)
    curves.oscillation(SCENE, found, found[0], "deviation")
    (x, per_cent) = figures.axes("Oscillation of the load").lines[-1].get_data()
    assert per_cent == pytest.approx(2.0 * x, abs=0.03)
    assert (x[0], x[-1]) == pytest.approx((3.0 * PROPAGATION, 4.5), rel=0.01)
    assert curves.oscillation(SCENE, found[:1], found[0], "key") is None


@pytest.mark.parametrize(
    ("value", "tolerance", "used"),
    [(0.5, 1.0, "50 %"), (-0.5, 1.0, "50 %"), (3.0, 1.0, "all"), (0.0, 0.0, "0 %"), (1e-9, 0.0, "all")],
)
def test_a_check_shows_how_much_of_its_tolerance_it_uses(value, tolerance, used):
    given = replace(scene_report(), checks=(Check("j-integral", "nurbs", value, tolerance, "exact", "It holds."),))
    held = abs(value) <= tolerance
    (row,) = checks(given, "one", held).cells()
    assert row[5].text.replace("\u00a0", " ") == used and checks(given, "one", not held).cells() == []


# --- fields


def snapshot(opening: float = 1.0, damage_q: object = (), **more: np.ndarray) -> Snapshot:
    damage = np.asarray(damage_q, float)
    s_q = np.linspace(4.0, 14.0, damage.size)
    grids = {"X_euvi": np.zeros((0, 1, 1, 2)), "u_euvi": np.zeros((0, 1, 1, 2)), "stress_euv": np.zeros((0, 1, 1))}
    return Snapshot(opening, 0.2, s_q, 0 * s_q, **{"traction_q": 0 * s_q, "damage_q": damage, **grids, **more})


@pytest.mark.parametrize(
    ("damage", "zone"),
    [([1, 1, 0.5, 0.25, 0, 0], (8.0, 10.0)), ([0.75, 0, 0], (4.0, 4.0)), ([1, 1, 0], None), ([0, 0, 0], None)],
)
def test_the_process_zone_is_what_is_damaged_and_not_broken(damage, zone):
    assert process_zone(snapshot(1.0, damage)) == zone


def test_snapshots_stand_together_where_their_openings_are_near():
    at = {"nurbs": (0.5, 1.0, 3.0), "lagrange": (0.55, 2.0), "dolfinx": (1.1, 2.9)}
    runs = [
        Entry(Run(name, name, Result(name, {}, snapshots=tuple(map(snapshot, kept)))), 0, line(name), None, False)
        for name, kept in at.items()
    ]
    together = [{(entry.method, one.opening) for entry, one in group} for group in shared_snapshots(runs)]
    pairs = [("nurbs", 0.5, "lagrange", 0.55), ("nurbs", 1.0, "dolfinx", 1.1), ("nurbs", 3.0, "dolfinx", 2.9)]
    assert together == [{pair[:2], pair[2:]} for pair in pairs]


def test_fronts_are_drawn_from_edge_to_edge(monkeypatch):
    """A front of a solid, which is modelled from the middle on; nothing is drawn of a plane."""
    drawn, entry = Drawn(monkeypatch, fields), beside(run("nurbs"))[0]
    across = {"front_z": np.array([0.1, 0.4]), "front_s": np.array([6.0, 5.0]), "front_G": np.array([0.1, 0.05])}
    assert fields.fronts(SCENE, [[(entry, snapshot())]], "key") == []
    assert len(fields.fronts(SCENE, [[(entry, snapshot())], [(entry, snapshot(**across))]], "key")) == 2
    (front, G) = (drawn.axes(title).lines[0].get_data() for title in ("Front of the crack", "Energy that the bond"))
    assert [*front[0]] == [5.0, 6.0, 6.0, 5.0] and [*front[1]] == [-0.4, -0.1, 0.1, 0.4]
    assert [*G[0]] == [*front[1]] and [*G[1]] == [0.05, 0.1, 0.1, 0.05]
    area = drawn.axes("Front of the crack").collections[0].get_datalim(drawn.axes("Front of the crack").transData)
    assert area.x0 == pytest.approx(SCENE.specimen.precrack) and area.x1 == pytest.approx(6.0)


def boxes(x: np.ndarray, low: float, high: float) -> np.ndarray:
    """Sampling grids (n, 2, 2, 2) of elements side by side."""
    corners = [[[a, low], [a, high]] for a in x]
    return np.array([[a, b] for a, b in zip(corners, corners[1:], strict=False)])


def test_the_longest_side_on_the_bond_in_the_zone_counts():
    """Short elements from 4 to 8 on the upper arm, long ones elsewhere; those of the lower arm are of length 2."""
    upper = boxes(np.array([0.0, 4.0, 4.5, 5.0, 6.0, 8.0, 14.0]), 0.0, 0.2)
    lower, apart = boxes(np.linspace(0.0, 14.0, 8), -0.2, 0.0), boxes(np.linspace(0.0, 14.0, 8), 0.1, 0.2)
    for X, zone, longest in (
        (upper, (4.1, 4.9), 0.5),
        (upper, (4.1, 5.5), 1.0),
        (upper, (4.5, 5.0), 0.5),  # sides that only touch the zone are not in it
        (np.concatenate([upper, lower]), (4.1, 4.9), 2.0),
        (apart, (4.1, 4.9), np.nan),
    ):
        found = meshes.bond_element(snapshot(1.0, np.zeros(5), X_euvi=X), zone)
        assert found == pytest.approx(longest, nan_ok=True)


@pytest.mark.parametrize("reach", [0.1, 1.0, 3.0, 20.0])
def test_however_far_arms_open_their_picture_is_neither_too_low_nor_too_high(reach):
    """And to scale: what is too tall gets room on the right, what is too flat above and below."""
    X_euvi = np.array([[[[0.0, -reach], [0.0, reach]], [[14.0, 0.0], [14.0, 0.0]]]])
    (left, right), (low, high) = meshes.frame(SCENE, [snapshot(X_euvi=X_euvi, u_euvi=0.0 * X_euvi)])
    assert left < 0.0 and right > 14.0 and low < -reach and high > reach
    inches = meshes.WHOLE * (high - low) / (right - left)
    assert meshes.LEAST_HEIGHT * (1.0 - 1e-9) <= inches <= meshes.MOST_HEIGHT * (1.0 + 1e-9)
    assert (right == pytest.approx(14.14)) == (reach < 2.5), "no more room than it takes"


def painted(value_euv: np.ndarray, width: float, limit: float) -> np.ndarray:
    """Pixels of one element from 0 to ``width`` in a frame of 1 by 1."""
    axes = Figure(figsize=(2.0, 2.0)).add_axes((0.0, 0.0, 1.0, 1.0))
    x_euvi = np.stack(np.meshgrid(np.linspace(0.0, width, 4), np.linspace(0.0, 1.0, 4), indexing="ij"), axis=-1)[None]
    paint.paint(axes, x_euvi, value_euv, limit, ((0.0, 1.0), (0.0, 1.0)))
    return np.asarray(axes.images[0].get_array())


def test_a_field_has_the_colours_of_its_values_and_nothing_is_painted_beside_it():
    pixels = painted(2.0 * np.repeat(np.linspace(-1.0, 1.0, 4)[None, :, None], 4, axis=2), 0.5, 2.0)
    middle, columns = pixels[len(pixels) // 2], pixels.shape[1]
    for share in (0.1, 0.5, 0.9):
        assert middle[int(0.5 * share * columns)] == pytest.approx(STRESS_MAP(share), abs=0.08)
    assert middle[3 * columns // 4][3] == 0.0


def test_each_side_is_drawn_once_whichever_way_elements_go_and_only_where_it_is_seen():
    row = boxes(np.linspace(0.0, 3.0, 4), 0.0, 1.0)
    turned = np.concatenate([row[:1], row[1:2, ::-1], row[2:].swapaxes(1, 2)])
    assert len(paint.sides(row)) == len(paint.sides(turned)) == 10
    assert len(paint.seen(paint.sides(row), ((0.2, 0.8), (0.2, 2.0)))) == 1, "the upper side of the first"


def test_a_curve_is_off_where_it_is_not_near():
    """Within 324 % of the reference is nowhere near it."""
    found = beside(run("dolfinx", dofs=900), run("nurbs", 1.02), run("mine", 4.24, dofs=0))
    page = SimpleNamespace(entries=found, reference=found[0], anchor="a", report=SimpleNamespace(scene=SCENE))
    told = [str(cell.text) for cell in _sentences([page])]
    assert any("NURBS: load within 2.0 % of DOLFINx" in one.replace("\u00a0", " ") for one in told), told
    assert any("mine: load off by 324 % from DOLFINx" in one.replace("\u00a0", " ") for one in told), told
