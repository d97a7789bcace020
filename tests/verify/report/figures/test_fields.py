"""Fields, tractions and meshes: what is drawn is what was found, where it was found."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

pytest.importorskip("matplotlib")

from figures import Drawn  # noqa: E402
from made_up_runs import scene_report  # noqa: E402
from matplotlib.figure import Figure  # noqa: E402

from verify.pages import paint  # noqa: E402
from verify.pages.style import STRESS_MAP, colour  # noqa: E402
from verify.report.figures import fields, meshes
from verify.report.figures.entry import Entry, entries, line  # noqa: E402
from verify.report.figures.fields import process_zone, shared_snapshots, traction  # noqa: E402
from verify.report.figures.layout import LEAST_HEIGHT, MOST_HEIGHT, WHOLE, frame  # noqa: E402
from verify.result import Result, Snapshot  # noqa: E402
from verify.verdict import Run  # noqa: E402

SCENE = scene_report().scene


@pytest.fixture(scope="module")
def found() -> list[Entry]:
    return [entry for entry in entries(scene_report()) if entry.agreement is not None]


def snapshot(opening: float = 1.0, damage_q: object = (), **more: np.ndarray) -> Snapshot:
    damage = np.asarray(damage_q, float)
    s_q = np.linspace(4.0, 14.0, damage.size)
    grids = {"X_euvi": np.zeros((0, 1, 1, 2)), "u_euvi": np.zeros((0, 1, 1, 2)), "stress_euv": np.zeros((0, 1, 1))}
    return Snapshot(opening, 0.2, s_q, 0 * s_q, **{"traction_q": 0 * s_q, "damage_q": damage, **grids, **more})


def run(method: str, *kept: Snapshot, label: str = "") -> Entry:
    result = Result(method, {"opening": np.array([0.0, 1.0]), "load": np.zeros(2)}, snapshots=kept)
    return Entry(Run(label or method, method, result), 0, line(method), None, False)


@pytest.mark.parametrize(
    ("damage", "zone"),
    [([1, 1, 0.5, 0.25, 0, 0], (8.0, 10.0)), ([0.75, 0, 0], (4.0, 4.0)), ([1, 1, 0], None), ([0, 0, 0], None)],
)
def test_the_process_zone_is_what_is_damaged_and_not_broken(damage: list[float], zone: tuple | None) -> None:
    assert process_zone(snapshot(1.0, damage)) == zone


def test_snapshots_stand_together_where_their_openings_are_near() -> None:
    at = {"nurbs": (0.5, 1.0, 3.0), "lagrange": (0.55, 2.0), "dolfinx": (1.1, 2.9)}
    runs = [run(method, *map(snapshot, openings)) for method, openings in at.items()]
    together = [{(entry.method, one.opening) for entry, one in group} for group in shared_snapshots(runs)]
    assert together == [
        {("nurbs", 0.5), ("lagrange", 0.55)},
        {("nurbs", 1.0), ("dolfinx", 1.1)},
        {("nurbs", 3.0), ("dolfinx", 2.9)},
    ]
    assert shared_snapshots([run("nurbs")]) == []


def test_tractions_are_drawn_around_the_zone(found: list[Entry], monkeypatch: pytest.MonkeyPatch) -> None:
    drawn, group = Drawn(monkeypatch, fields), shared_snapshots(found)[1]
    caption = traction(SCENE, group, "key").caption
    axes = drawn.axes("Normal traction along the interface at opening 1")
    (left, right), (low, high) = axes.get_xlim(), axes.get_ylim()
    for entry, one in group:
        (shown,) = [o for o in axes.lines if o.get_color() == colour(entry.line.colour) and len(o.get_xdata()) > 2]
        inside = (one.s_q >= left) & (one.s_q <= right)
        expected = np.column_stack([one.s_q, one.traction_q])[inside]
        assert {*map(tuple, expected)} <= {*map(tuple, np.column_stack(shown.get_data()))}
    zones = [process_zone(one) for _, one in group]
    assert all(left < start and end < right for start, end in zones)
    assert low < 0.0 and high > 1.1 * SCENE.interface.strength
    ends = axes.patches[0].get_window_extent().transformed(axes.transData.inverted())
    assert (ends.x0, ends.x1) == pytest.approx(zones[0])
    assert f"{zones[0][1] - zones[0][0]:.3g}" in caption and "(at" not in caption
    later = replace(group[1][1], opening=1.1 * group[1][1].opening)
    assert "(at" in traction(SCENE, [group[0], (group[1][0], later)], "key").caption
    intact = snapshot(0.125, np.zeros(41), traction_q=np.linspace(-1.0, 2.0, 41))
    assert traction(SCENE, [(found[0], intact)], "key").caption.endswith("still intact everywhere.")
    axes = drawn.axes("at opening 0.125")
    assert axes.get_xlim() == pytest.approx((4.0, 4.0 + 0.15 * 10.0)) and not axes.patches


# --- a field in colours


def painted(value_euv: np.ndarray, width: float, limit: float) -> tuple[np.ndarray, np.ndarray]:
    """Pixels and outline of one element from 0 to ``width`` in a frame of 1 by 1."""
    axes = Figure(figsize=(2.0, 2.0)).add_axes((0.0, 0.0, 1.0, 1.0))
    x_euvi = np.stack(np.meshgrid(np.linspace(0.0, width, 4), np.linspace(0.0, 1.0, 4), indexing="ij"), axis=-1)[None]
    paint.paint(axes, x_euvi, value_euv, limit, ((0.0, 1.0), (0.0, 1.0)))
    assert axes.images[0].get_extent() == [0.0, 1.0, 0.0, 1.0] and axes.get_xlim() == axes.get_ylim() == (0.0, 1.0)
    return np.asarray(axes.images[0].get_array()), np.column_stack(axes.lines[0].get_data())


@pytest.mark.parametrize("value", [-1.0, -0.5, 0.25, 1.0])
def test_a_field_has_the_colour_of_its_value_and_nothing_is_painted_beside_it(value: float) -> None:
    pixels, outline = painted(np.full((1, 4, 4), 2.0 * value), 0.5, 2.0)
    rows, columns = pixels.shape[:2]
    assert pixels[rows // 2, columns // 4] == pytest.approx(STRESS_MAP(0.5 + 0.5 * value), abs=0.02)
    assert pixels[rows // 2, 3 * columns // 4][3] == 0.0
    assert np.nanmax(outline, axis=0).tolist() == [0.5, 1.0] and np.nanmin(outline) == 0.0


def test_a_field_varies_over_its_element_as_its_samples_do() -> None:
    pixels, _ = painted(np.repeat(np.linspace(-1.0, 1.0, 4)[None, :, None], 4, axis=2), 1.0, 1.0)
    for share in (0.1, 0.5, 0.9):
        assert pixels[len(pixels) // 2, int(share * len(pixels[0]))] == pytest.approx(STRESS_MAP(share), abs=0.06)


def test_each_side_is_drawn_once_whichever_way_elements_go_and_only_where_it_is_seen() -> None:
    row = boxes(np.linspace(0.0, 3.0, 4), 0.0, 1.0)
    turned = np.concatenate([row[:1], row[1:2, ::-1], row[2:].swapaxes(1, 2)])
    assert len(paint.sides(row)) == len(paint.sides(turned)) == 10
    assert len(paint.seen(paint.sides(row), ((0.2, 0.8), (0.2, 2.0)))) == 1, "the upper side of the first"
    path = paint.one_path(paint.sides(row))
    assert len(path) == 30 and np.isnan(path[2::3]).all()


# --- meshes


def boxes(x: np.ndarray, low: float, high: float) -> np.ndarray:
    """Sampling grids (n, 2, 2, 2) of elements side by side."""
    corners = [[[a, low], [a, high]] for a in x]
    return np.array([[left, right] for left, right in zip(corners, corners[1:], strict=False)])


def mesh(elements: int, opening: float = 1.0, junctions: tuple[float, ...] = (), damage: bool = True) -> Snapshot:
    """Two arms, T-junctions on the bond at some X of the upper arm."""
    x = np.linspace(0.0, 14.0, elements + 1)
    X_euvi = np.concatenate([boxes(x, 0.0, 0.2), boxes(x, -0.2, 0.0)])
    lines = np.array([[[at, 0.1], [at, 0.2]] for at in junctions]).reshape(-1, 2, 2)
    grids = {"X_euvi": X_euvi, "u_euvi": 0.0 * X_euvi, "stress_euv": np.zeros((2 * elements, 2, 2))}
    more = {"line_nki": lines, "junction_ni": lines[:, 0]}
    return snapshot(opening, np.interp(np.linspace(4.0, 14.0, 101), (5.5, 7.0), (1.0, 0.0)) * damage, **grids, **more)


def test_the_longest_side_on_the_bond_in_the_zone_counts() -> None:
    """Short elements from 4 to 8 on the upper arm, long ones elsewhere; those of the lower arm are of length 2."""
    upper = boxes(np.array([0.0, 4.0, 4.5, 5.0, 6.0, 8.0, 14.0]), 0.0, 0.2)
    lower = boxes(np.linspace(0.0, 14.0, 8), -0.2, 0.0)
    one, both = (snapshot(1.0, np.zeros(5), X_euvi=X) for X in (upper, np.concatenate([upper, lower])))
    assert meshes.bond_element(one, (4.1, 4.9)) == pytest.approx(0.5)
    assert meshes.bond_element(one, (4.1, 5.5)) == pytest.approx(1.0)
    assert meshes.bond_element(one, (4.5, 5.0)) == pytest.approx(0.5), "sides that only touch the zone are not in it"
    assert meshes.bond_element(both, (4.1, 4.9)) == pytest.approx(2.0)
    apart = snapshot(1.0, np.zeros(5), X_euvi=boxes(np.linspace(0.0, 14.0, 8), 0.1, 0.2))
    assert np.isnan(meshes.bond_element(apart, (4.1, 4.9)))


def test_every_mesh_is_drawn_once_with_its_runs_elements_junctions_and_zone(monkeypatch: pytest.MonkeyPatch) -> None:
    drawn, fine = Drawn(monkeypatch, meshes), mesh(56)
    runs = [run("nurbs", mesh(56, damage=False), fine), run("dolfinx", fine), run("tspline", mesh(28, 1.0, (5.0, 9.0)))]
    panel = meshes.undeformed(SCENE, [*runs, run("beam")], "key")
    figure = drawn[0][1]
    assert len(figure.axes) == 4 and panel.size == "wide" and "T-junction" in panel.caption
    titles = [axes.get_title(loc="left").replace("\u00a0", " ") for axes in figure.axes[::2]]
    assert titles[0].startswith("nurbs and dolfinx: 112 elements; ")
    assert titles[1].startswith("tspline: 56 elements, 2 T-junctions; ")
    whole = figure.axes[2]
    lines = {name: [o for o in whole.lines if o.get_label() == name] for name in ("elements", "T-junctions", "zone")}
    assert len(lines["elements"]) == 2 and len(lines["zone"]) == 1
    (points,) = lines["T-junctions"]
    assert (
        points.get_xdata()[~np.isnan(points.get_xdata())].tolist() == [5.0, 9.0] and np.nanmin(points.get_ydata()) > 0.1
    )
    assert tuple(lines["zone"][0].get_xdata()) == process_zone(fine)
    assert meshes.undeformed(SCENE, [run("beam")], "key") is None


def test_of_a_mesh_that_moves_the_last_three_places_are_drawn(monkeypatch: pytest.MonkeyPatch) -> None:
    drawn = Drawn(monkeypatch, meshes)
    at = [mesh(28, x, (x,)) for x in (4.0, 5.0, 5.0, 7.0, 9.0)]
    at[2] = replace(at[1], opening=6.0)
    assert meshes.followed(SCENE, [run("tspline", *at)], "key").caption.startswith("The T-mesh follows")
    titles = [axes.get_title(loc="left").replace("\u00a0", " ") for axes in drawn[0][1].axes[::2]]
    assert [title.split(":")[0] for title in titles] == ["Opening 6 mm", "Opening 7 mm", "Opening 9 mm"]
    assert meshes.followed(SCENE, [run("tspline", at[0], at[0])], "key") is None


def test_deformed_meshes_have_one_scale_that_is_told(found: list[Entry], monkeypatch: pytest.MonkeyPatch) -> None:
    drawn, group = Drawn(monkeypatch, meshes), shared_snapshots(found)[1]
    caption = meshes.deformed(SCENE, group, "key").caption
    *pairs, bar = drawn[0][1].axes
    limit, shown = bar.get_xlim()[1], [(e, s) for e, s in group if s.stress_euv.size]
    largest = max(float(np.abs(s.stress_euv).max()) for _, s in shown)
    assert bar.get_xlim()[0] == -limit and 0.95 * largest < limit <= largest and f"to ± {limit:.3g}\u00a0MPa" in caption
    assert len(pairs) == 2 * len(shown) and len({axes.get_xlim() for axes in pairs[::2]}) == 1
    for axes, (entry, one) in zip(pairs[::2], shown, strict=True):
        assert axes.get_title(loc="left") == f"{entry.label}, opening {one.opening:.3g}\u00a0mm, load 0.4\u00a0N"
        x_ni = (one.X_euvi + one.u_euvi).reshape(-1, 2)
        low, high = np.transpose([axes.get_xlim(), axes.get_ylim()])
        assert np.all(x_ni > low) and np.all(x_ni < high)
    assert meshes.deformed(SCENE, [(e, replace(s, stress_euv=np.zeros((0, 1, 1)))) for e, s in group], "key") is None


@pytest.mark.parametrize("reach", [0.1, 1.0, 3.0, 20.0])
def test_however_far_arms_open_their_picture_is_neither_too_low_nor_too_high(reach: float) -> None:
    """And to scale: what is too tall gets room on the right, what is too flat above and below."""
    X_euvi = np.array([[[[0.0, -reach], [0.0, reach]], [[14.0, 0.0], [14.0, 0.0]]]])
    (left, right), (low, high) = frame(SCENE, [snapshot(X_euvi=X_euvi, u_euvi=0.0 * X_euvi)])
    assert left < 0.0 and right > 14.0 and low < -reach and high > reach
    inches = WHOLE * (high - low) / (right - left)
    assert LEAST_HEIGHT * (1.0 - 1e-9) <= inches <= MOST_HEIGHT * (1.0 + 1e-9)
    assert (right == pytest.approx(14.14)) == (reach < 2.5), "no more room than it takes"
