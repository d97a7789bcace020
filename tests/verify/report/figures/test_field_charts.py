"""Charts of fields, tractions and frames: what is drawn is what was found, where it was found."""

from __future__ import annotations

import re
from dataclasses import replace
from html import unescape
from itertools import combinations

import numpy as np
import pytest

pytest.importorskip("matplotlib")
pytest.importorskip("jinja2")

from figures import Drawn  # noqa: E402
from made_up_runs import scene_report  # noqa: E402
from matplotlib.figure import Figure  # noqa: E402
from matplotlib.textpath import TextPath  # noqa: E402

from verify.pages import paint, style  # noqa: E402
from verify.pages.style import STRESS_MAP, colour  # noqa: E402
from verify.pages.text import Units  # noqa: E402
from verify.report.figures import fields, meshes, opening, undeformed
from verify.report.figures.entry import entries  # noqa: E402
from verify.report.figures.fields import process_zone, shared_snapshots, traction  # noqa: E402
from verify.report.figures.opening import frames  # noqa: E402
from verify.result import Snapshot  # noqa: E402


@pytest.fixture(scope="module")
def found() -> list:
    return [entry for entry in entries(scene_report()) if entry.agreement is not None]


def a_snapshot(opening: float, damage_q: np.ndarray, **more) -> Snapshot:
    s_q = np.linspace(4.0, 14.0, damage_q.size)
    grids = {"X_euvi": np.zeros((0, 1, 1, 2)), "u_euvi": np.zeros((0, 1, 1, 2)), "stress_euv": np.zeros((0, 1, 1))}
    return Snapshot(opening, 0.2, s_q, 0 * s_q, **{"traction_q": 0 * s_q, "damage_q": damage_q, **grids, **more})


def test_the_process_zone_is_what_is_damaged_and_not_broken() -> None:
    assert process_zone(a_snapshot(1.0, np.array([1.0, 1.0, 0.5, 0.25, 0.0, 0.0]))) == (8.0, 10.0)
    assert process_zone(a_snapshot(1.0, np.array([0.75, 0.0, 0.0]))) == (4.0, 4.0)
    assert process_zone(a_snapshot(1.0, np.array([1.0, 1.0, 0.0]))) is None
    assert process_zone(a_snapshot(1.0, np.zeros(3))) is None


def with_openings(entry, *openings: float):
    kept = tuple(a_snapshot(at, np.linspace(1.0, 0.0, 11)) for at in openings)
    return replace(entry, run=replace(entry.run, result=replace(entry.result, snapshots=kept)))


def test_snapshots_stand_together_where_their_openings_are_near(found: list) -> None:
    dolfinx, nurbs, lagrange = (next(e for e in found if e.method == m) for m in ("dolfinx", "nurbs", "lagrange"))
    runs = [with_openings(nurbs, 0.5, 1.0, 3.0), with_openings(lagrange, 0.55, 2.0), with_openings(dolfinx, 1.1, 2.9)]
    groups = shared_snapshots(runs)
    together = [{(entry.method, snapshot.opening) for entry, snapshot in group} for group in groups]
    assert together == [
        {("nurbs", 0.5), ("lagrange", 0.55)},
        {("nurbs", 1.0), ("dolfinx", 1.1)},
        {("nurbs", 3.0), ("dolfinx", 2.9)},
    ]
    assert shared_snapshots([with_openings(nurbs)]) == []
    (alone,) = shared_snapshots([with_openings(nurbs, 1.0), with_openings(lagrange, 1.3)])
    assert len(alone) == 1


def test_tractions_are_drawn_around_the_zone(found: list, monkeypatch: pytest.MonkeyPatch) -> None:
    drawn, scene = Drawn(monkeypatch, fields), scene_report().scene
    group = shared_snapshots(found)[1]
    caption = traction(scene, group, "key", small=False).caption
    axes = drawn.axes("Normal traction along the interface at opening 1")
    for entry, snapshot in group:
        options = entry.line.options()
        (line,) = [
            o for o in axes.lines if o.get_color() == options["color"] and len(o.get_xdata()) == snapshot.s_q.size
        ]
        assert np.array_equal(line.get_xdata(), snapshot.s_q) and np.array_equal(line.get_ydata(), snapshot.traction_q)
    zones = [process_zone(snapshot) for _, snapshot in group]
    (left, right), (low, high) = axes.get_xlim(), axes.get_ylim()
    assert (
        all(left < start and end < right for start, end in zones)
        and low < 0.0
        and high > 1.1 * scene.interface.strength
    )
    (band,) = axes.patches
    ends = band.get_window_extent().transformed(axes.transData.inverted())
    assert (ends.x0, ends.x1) == pytest.approx(zones[0])
    strength = [o for o in axes.lines if o.get_color() == colour("muted")]
    assert [set(o.get_ydata()) for o in strength] == [{scene.interface.strength}]
    assert f"{zones[0][1] - zones[0][0]:.3g}" in caption and "(at" not in caption
    later = replace(group[1][1], opening=1.1 * group[1][1].opening)
    assert caption.count("(at") + 1 == traction(scene, [group[0], (group[1][0], later)], "key", True).caption.count(
        "(at"
    )


def test_an_intact_bond_is_shown_from_its_tip_on(found: list, monkeypatch: pytest.MonkeyPatch) -> None:
    drawn, scene = Drawn(monkeypatch, fields), scene_report().scene
    intact = a_snapshot(0.125, np.zeros(41), traction_q=np.linspace(-1.0, 2.0, 41))
    caption = traction(scene, [(found[0], intact)], "key", small=True).caption
    axes = drawn.axes("at opening 0.125")
    assert axes.get_xlim() == pytest.approx((4.0, 4.0 + 0.15 * 10.0)) and not axes.patches
    assert caption.endswith("The interface is still intact everywhere.")


def test_frames_have_one_scale_and_hold_all_that_moves(found: list, monkeypatch: pytest.MonkeyPatch) -> None:
    drawn, scene = Drawn(monkeypatch, opening), scene_report().scene
    shown = frames(scene, shared_snapshots(found), found, "key")
    nurbs = next(entry for entry in found if entry.method == "nurbs")
    assert len(shown) == len(drawn) == 3
    limits = {tuple((ax.get_xlim(), ax.get_ylim()) for ax in figure.axes) for _, figure in drawn}
    assert len(limits) == 1
    for (title, figure), frame, snapshot in zip(drawn, shown, nurbs.result.snapshots, strict=True):
        arms, tractions, load = figure.axes
        x_ni = (np.asarray(snapshot.X_euvi) + np.asarray(snapshot.u_euvi)).reshape(-1, 2)
        low, high = np.transpose([arms.get_xlim(), arms.get_ylim()])
        assert np.all(x_ni > low) and np.all(x_ni < high) and arms.get_ylim()[0] == -arms.get_ylim()[1]
        assert arms.get_xlim() == tractions.get_xlim() and nurbs.label in arms.get_title(loc="left")
        (dot,) = [one for one in load.lines if len(one.get_xdata()) == 1]
        assert (dot.get_xdata()[0], dot.get_ydata()[0]) == (snapshot.opening, snapshot.load)
        zone = process_zone(snapshot)
        assert frame.opening == f"{snapshot.opening:.3g}\u00a0mm" and frame.text in title
        assert f"process zone {zone[0]:.3g} to {zone[1]:.3g}" in frame.text
        box = arms.get_window_extent()
        assert box.width / box.height == pytest.approx(np.ptp(arms.get_xlim()) / np.ptp(arms.get_ylim()), rel=1e-6)
    assert frames(scene, shared_snapshots(found)[:1], found, "key") == ()


def written(svg: str) -> tuple[np.ndarray, list[tuple[str, np.ndarray]]]:
    """Width and height of a drawing, and each of its texts with its box (least, most), in points of the drawing.

    From the shapes of the letters and where the drawing puts them, whatever the layout of the figure took them for.
    """
    size = np.array(re.search(r'viewBox="0 0 (\S+) (\S+)"', svg).groups(), float)
    texts = []
    for head, words in re.findall(r"<text ([^>]*)>([^<]*)</text>", svg):
        said = dict(re.findall(r'([\w-]+)(?:="|: )([^;"]*)', head.replace('style="', "")))
        outline = TextPath((0, 0), unescape(words), size=float(said["font-size"].removesuffix("px"))).get_extents()
        corners = outline.corners() * (1.0, -1.0)  # down is positive
        corners[:, 0] -= {"middle": 0.5, "end": 1.0}.get(said.get("text-anchor", ""), 0.0) * outline.x1
        at = (said["x"], said["y"]) if "x" in said else re.search(r"translate\((\S+) (\S+)\)", head).groups()
        if "rotate(-90" in head:
            corners = corners[:, ::-1] * (1.0, -1.0)
        corners += np.array(at, float)
        texts.append((unescape(words), np.array([corners.min(axis=0), corners.max(axis=0)])))
    return size, texts


#: Labels, and how many times larger loads and tractions are in them than in the first.
UNITS = {
    "N, mm, MPa": 1.0,
    "lbf, in, psi": 2500.0,
    "kilonewton, millimetre, kilonewton per square millimetre": 1e-3,
    "f, l, NEWTONPERSQUAREMILLIMETREOFTHEINTERFACE": 1.0,
}


@pytest.mark.parametrize("units", UNITS)
def test_no_word_of_a_frame_is_cut_or_written_over_another_whatever_the_units(found: list, units: str) -> None:
    """Larger numbers take more room, and so do longer units; all frames stay alike, so that nothing jumps."""
    factor, scene = UNITS[units], scene_report().scene
    interface = scene.interface.model_copy(update={"strength": factor * scene.interface.strength})
    scene = scene.model_copy(update={"units": units, "interface": interface})

    def scaled(one: Snapshot) -> Snapshot:
        return replace(one, load=factor * one.load, traction_q=factor * one.traction_q)

    runs = []
    for entry in found:
        result = entry.result
        steps = {n: factor * c if n in ("load", "load_slope") else c for n, c in result.steps.items()}
        result = replace(result, steps=steps, snapshots=tuple(map(scaled, result.snapshots)))
        runs.append(replace(entry, run=replace(entry.run, result=result)))
    shown = frames(scene, shared_snapshots(runs)[:2], runs, "key")
    sizes = set()
    for frame in shown:
        size, texts = written(frame.panel.svg)
        sizes.add(tuple(size))
        for words, (least, most) in texts:
            assert np.all(least >= 0.0) and np.all(most <= size), words
        for (one, a), (other, b) in combinations(texts, 2):
            assert np.any(a[1] < b[0]) or np.any(b[1] < a[0]), (one, other)
        label = f"traction ({Units.of(units).stress})".replace(" ", "")
        assert label in "".join(words for words, _ in texts).replace(" ", "")
    assert len(shown) == 2 and len(sizes) == 1


def test_a_sheet_grows_by_what_is_written_beside_it_and_not_otherwise() -> None:
    with style.drawing():
        figure, axes = style.panel(style.HALF, 3.0)
        axes.plot([0.0, 1.0], [0.0, 1.0])
        assert np.array_equal(style.sheet_of(figure).extents, (0.0, 0.0, style.HALF, 3.0))
        axes.annotate("a name at the edge", (1.0, 0.5))
        axes.set(ylabel="energy (pound-force inch)", ylim=(-90000.0, 90000.0))
        size, texts = written(style.to_svg(figure, "key", "title"))
    assert size[0] > 72.0 * style.HALF and size[1] == 216.0
    assert {"a name at the edge", "energy (pound-force inch)"} <= {words for words, _ in texts}
    for words, (least, most) in texts:
        assert np.all(least >= 0.0) and np.all(most <= size), words


@pytest.mark.parametrize(
    ("box", "meets"),
    [((0.5, 0.5), True), ((1.0, 0.5), True), ((1.5, 0.5), False), ((0.5, -1.5), False), ((-0.5, -0.5), True)],
)
def test_what_does_not_meet_the_frame_is_not_drawn(box: tuple[float, float], meets: bool) -> None:
    line = np.array(box) + np.array([[[0.0, 0.0], [1.0, 1.0]]])
    assert paint.seen(line, ((0.0, 1.0), (0.0, 1.0))).tolist() == [meets]


@pytest.mark.parametrize("value", [-1.0, -0.5, 0.25, 1.0])
def test_a_field_has_the_colour_of_its_value_and_nothing_is_painted_beside_it(value: float) -> None:
    """One element over the left half of the frame."""
    figure = Figure(figsize=(2.0, 2.0))
    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    u, v = np.meshgrid(np.linspace(0.0, 0.5, 4), np.linspace(0.0, 1.0, 4), indexing="ij")
    paint.paint(axes, np.stack([u, v], axis=-1)[None], np.full((1, 4, 4), 2.0 * value), 2.0, ((0.0, 1.0), (0.0, 1.0)))
    (image,) = axes.images
    pixels = np.asarray(image.get_array())
    rows, columns = pixels.shape[:2]
    inside, outside = pixels[rows // 2, columns // 4], pixels[rows // 2, 3 * columns // 4]
    assert inside == pytest.approx(STRESS_MAP(0.5 + 0.5 * value), abs=0.02) and outside[3] == 0.0
    assert image.get_extent() == [0.0, 1.0, 0.0, 1.0] and (axes.get_xlim(), axes.get_ylim()) == ((0.0, 1.0), (0.0, 1.0))
    (outline,) = axes.lines
    assert np.nanmax(outline.get_xdata()) == 0.5 and np.nanmin(outline.get_ydata()) == 0.0


def test_a_field_varies_over_its_element_as_its_samples_do() -> None:
    figure = Figure(figsize=(2.0, 2.0))
    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    u, v = np.meshgrid(np.linspace(0.0, 1.0, 4), np.linspace(0.0, 1.0, 4), indexing="ij")
    paint.paint(axes, np.stack([u, v], axis=-1)[None], (2.0 * u - 1.0)[None], 1.0, ((0.0, 1.0), (0.0, 1.0)))
    pixels = np.asarray(axes.images[0].get_array())
    for share in (0.1, 0.5, 0.9):
        found = pixels[pixels.shape[0] // 2, int(share * pixels.shape[1])]
        assert found == pytest.approx(STRESS_MAP(share), abs=0.06), share


# --- meshes


def boxes(x: np.ndarray, low: float, high: float) -> np.ndarray:
    """Sampling grids (n, 2, 2, 2) of elements side by side."""
    corners = [[[a, low], [a, high]] for a in x]
    return np.array([[left, right] for left, right in zip(corners, corners[1:], strict=False)])


def test_the_longest_side_on_the_bond_in_the_zone_counts() -> None:
    """Short elements from 4 to 8 on the upper arm, long ones elsewhere; those of the lower arm are of length 2."""
    upper = boxes(np.array([0.0, 4.0, 4.5, 5.0, 6.0, 8.0, 14.0]), 0.0, 0.2)
    lower = boxes(np.linspace(0.0, 14.0, 8), -0.2, 0.0)
    one = replace(a_snapshot(1.0, np.zeros(5)), X_euvi=upper)
    both = replace(one, X_euvi=np.concatenate([upper, lower]))
    assert undeformed.bond_element(one, (4.1, 4.9)) == pytest.approx(0.5)
    assert undeformed.bond_element(one, (4.1, 5.5)) == pytest.approx(1.0)
    assert undeformed.bond_element(one, (4.5, 5.0)) == pytest.approx(0.5), (
        "sides that only touch the zone are not in it"
    )
    assert undeformed.bond_element(both, (4.1, 4.9)) == pytest.approx(2.0)
    apart = replace(one, X_euvi=boxes(np.linspace(0.0, 14.0, 8), 0.1, 0.2))
    assert np.isnan(undeformed.bond_element(apart, (4.1, 4.9)))


def test_deformed_meshes_have_one_scale_that_is_told(found: list, monkeypatch: pytest.MonkeyPatch) -> None:
    drawn, scene = Drawn(monkeypatch, meshes), scene_report().scene
    group = shared_snapshots(found)[1]
    caption = meshes.deformed(scene, group, "key").caption
    (_, figure), painted = drawn[0], [(e, s) for e, s in group if np.size(s.stress_euv)]
    *pairs, bar = figure.axes
    limit = bar.get_xlim()[1]
    largest = max(float(np.abs(s.stress_euv).max()) for _, s in painted)
    assert bar.get_xlim()[0] == -limit and 0.95 * largest < limit <= largest
    assert f"to ± {limit:.3g}\u00a0MPa;" in caption and bar.get_xlabel() == "Cauchy stress along the specimen (MPa)"
    assert len(pairs) == 2 * len(painted) and len({axes.get_xlim() for axes in pairs[::2]}) == 1
    for axes, (entry, snapshot) in zip(pairs[::2], painted, strict=True):
        assert axes.get_title(loc="left") == f"{entry.label}, opening {snapshot.opening:.3g}\u00a0mm"
    assert [axes.get_xlabel() for axes in pairs[-2:]] == ["position (mm)", "position, enlarged (mm)"]
    bare = [(e, replace(s, stress_euv=np.zeros((0, 1, 1)))) for e, s in group]
    assert meshes.deformed(scene, bare, "key") is None
