"""Specimens as the page draws them: bodies that meet, lengths that add up, everything on the paper."""

from __future__ import annotations

import re

import numpy as np
import pytest

pytest.importorskip("matplotlib")

from matplotlib.axes import Axes  # noqa: E402
from matplotlib.patches import Polygon, Rectangle  # noqa: E402

from verify.pages.style import colour  # noqa: E402
from verify.report.figures import drawing  # noqa: E402
from verify.scene.load import load_scene  # noqa: E402
from verify.scene.schema import Scene

NUMBER = r"([\d.]+)"


@pytest.fixture
def drawn(monkeypatch: pytest.MonkeyPatch):
    """The axes that a drawing was made on and its caption."""

    def draw(scene: Scene, zone=None) -> tuple[Axes, str]:
        figures = []
        monkeypatch.setattr(drawing, "to_svg", lambda figure, *words: figures.append(figure) or "")
        caption = drawing.specimen(scene, "key", zone).caption
        return figures[0].axes[0], caption

    return draw


def bodies(axes: Axes) -> list[tuple[float, float, float, float]]:
    """Left, bottom, length and thickness of every body: each has a filled and a framed rectangle, and they agree."""
    kinds = [[p for p in axes.patches if isinstance(p, Rectangle) and p.get_fill() == filled] for filled in (1, 0)]
    filled, framed = ([(*p.get_xy(), p.get_width(), p.get_height()) for p in kind] for kind in kinds)
    assert len(filled) == 2 and filled == framed
    return filled


def lengths_of(axes: Axes, ink: str) -> list[tuple[float, float]]:
    """Begin and end of the lines along the interface in one colour."""
    return [
        tuple(line.get_xdata())
        for line in axes.lines
        if line.get_color() == colour(ink) and not np.any(line.get_ydata())
    ]


def dimensions(axes: Axes) -> dict[str, tuple[float, float]]:
    """Label of a measured length -> where its arrow begins and ends."""
    arrows = [t for t in axes.texts if getattr(t, "arrow_patch", None) and t.arrowprops["arrowstyle"] == "<->"]
    spans = {(a.xyann[1], tuple(sorted((a.xyann[0], a.xy[0])))) for a in arrows}
    labels = {}
    for y, span in spans:
        (label,) = [
            t.get_text()
            for t in axes.texts
            if t.get_text()
            and t.get_position()[0] == pytest.approx(sum(span) / 2)
            and 0 < y - t.get_position()[1] < 0.1
        ]
        labels[label.replace("\u00a0", " ")] = span
    return labels


def inside(axes: Axes) -> bool:
    """Every line, body and foot of a text is on the paper, of which no more than half an inch is empty at any edge."""
    points = [np.column_stack(line.get_data()) for line in axes.lines]
    points += [p.get_path().transformed(p.get_patch_transform()).vertices for p in axes.patches]
    points += [np.array([t.get_position()]) for t in axes.texts]
    low, high = np.transpose([axes.get_xlim(), axes.get_ylim()])
    edges, (width, height) = axes.figure.get_tightbbox(), axes.figure.get_size_inches()
    empty = max(edges.x0, edges.y0, width - edges.x1, height - edges.y1)
    within = np.concatenate(points)
    within = within[np.isfinite(within).all(axis=1)]  # one line may be many strokes
    return bool(np.all((within >= low) & (within <= high))) and empty < 0.5


@pytest.mark.parametrize("overrides", [(), ("specimen.arm_thickness=1.5",), ("specimen.precrack=9.0",)])
def test_two_arms_meet_on_the_interface_and_their_lengths_add_up(drawn, overrides: tuple[str, ...]) -> None:
    scene = load_scene("dcb-czm1", ["load.opening=1.0", *overrides])
    axes, caption = drawn(scene)
    specimen, ((x, y, length, thick), lower) = scene.specimen, bodies(axes)
    assert (x, y) == (0, 0) and lower == (0, -thick, length, thick)
    scale = length / specimen.length
    (crack,), (bond,) = lengths_of(axes, "paper"), lengths_of(axes, "accent")
    assert crack == pytest.approx((0.0, specimen.precrack * scale)) and bond == pytest.approx((crack[1], length))
    times = thick / (specimen.arm_thickness * scale)
    told = re.search(rf"arms {NUMBER} times too thick", caption)
    assert times >= 1.0 and (times == pytest.approx(float(told[1]), rel=0.05) if told else times == pytest.approx(1.0))
    assert ("to scale." in caption) == (told is None)
    spans = dimensions(axes)
    for words, share in (("precrack", specimen.precrack), ("interface", specimen.length - specimen.precrack)):
        ((label, (start, end)),) = [(k, v) for k, v in spans.items() if k.startswith(words)]
        assert end - start == pytest.approx(share * scale) and f"{share:g} mm" in label
    ((whole, span),) = [(k, v) for k, v in spans.items() if k.startswith("length")]
    assert span == pytest.approx((0.0, length)) and "14 mm" in whole and len(spans) == 3
    assert inside(axes)


def pulls(axes: Axes) -> list[tuple[float, float, float]]:
    """Where the arrows of loads begin, and how far up they go."""
    arrows = [t for t in axes.texts if getattr(t, "arrow_patch", None) and t.arrowprops["arrowstyle"] == "-|>"]
    assert all(a.xyann[0] == a.xy[0] for a in arrows)
    return [(*a.xyann, a.xy[1] - a.xyann[1]) for a in arrows]


def test_the_loads_pull_the_arms_apart_and_the_supports_are_at_the_other_end(drawn) -> None:
    axes, _ = drawn(load_scene("dcb-czm1"))
    (_, _, length, thick), _ = bodies(axes)
    down, up = sorted(pulls(axes), key=lambda pull: pull[2])
    assert down == pytest.approx((0.0, -thick / 2, -up[2])) and up[:2] == pytest.approx((0.0, thick / 2))
    assert up[1] + up[2] > thick, "the arrow ends in the arm"
    heights = {t.get_text(): t.get_position()[1] for t in axes.texts if t.get_text().startswith("P,")}
    assert heights["P, +Δ/2"] == -heights["P, −Δ/2"] > thick
    (support,) = [p for p in axes.patches if isinstance(p, Polygon)]
    corners = support.get_xy()
    assert corners[:, 0].min() == pytest.approx(length) and np.ptp(corners[:, 0]) > 0.05
    assert corners[:, 1].max() == -corners[:, 1].min() > 0.0


@pytest.mark.parametrize("name", ["dcb-czm1", "peel-80"])
def test_the_zone_is_marked_on_the_interface_and_named(drawn, name: str) -> None:
    scene = load_scene(name)
    specimen = scene.specimen
    zone = (specimen.free_length, specimen.free_length + 1.5, 0.75)
    axes, _ = drawn(scene, zone)
    (marked,) = lengths_of(axes, "zone")
    scale = bodies(axes)[0][2] / specimen.extent
    assert abs(marked[1] - marked[0]) == pytest.approx(1.5 * scale)
    tip = {"dcb": zone[0], "peel": getattr(specimen, "bond_length", 0.0)}[specimen.kind] * scale
    assert min(abs(np.array(marked) - tip)) < 1e-9
    (bond,) = lengths_of(axes, "accent")
    assert bond[0] - 1e-9 <= min(marked) and max(marked) <= bond[1] + 1e-9
    (label,) = [t for t in axes.texts if t.get_text().startswith("process zone")]
    text = label.get_text().replace("\u00a0", " ")
    assert "at opening 0.75 mm" in text and text.endswith("1.5 mm long")
    assert label.get_position()[0] == pytest.approx(sum(marked) / 2)
    for nothing in (None, (4.5, 4.5, 0.75)):
        assert lengths_of(drawn(scene, nothing)[0], "zone") == []


@pytest.mark.parametrize("name", ["peel-60", "peel-120"])
def test_a_strip_lies_on_its_substrate_from_the_flush_end_on(drawn, name: str) -> None:
    scene = load_scene(name)
    specimen, (axes, _) = scene.specimen, drawn(scene)
    (x, y, strip, thick), (left, base, substrate, depth) = bodies(axes)
    scale = strip / specimen.strip_length
    assert (x, y, left) == (0, 0, 0) and base == -depth
    parts = (specimen.strip_thickness, specimen.substrate_length, specimen.substrate_thickness)
    assert (thick, substrate, depth) == pytest.approx(tuple(scale * part for part in parts))
    assert lengths_of(axes, "accent") == [pytest.approx((0.0, specimen.bond_length * scale))]
    spans = dimensions(axes)
    expected = {"bond": (0.0, specimen.bond_length), "free": (specimen.bond_length, specimen.strip_length)}
    for words, ends in {**expected, "strip": (0.0, specimen.strip_length)}.items():
        ((label, span),) = [(k, v) for k, v in spans.items() if k.startswith(words)]
        assert np.divide(span, scale) == pytest.approx(ends) and f"{ends[1] - ends[0]:g} mm" in label
    ((foot, middle, rise),) = pulls(axes)
    assert foot == pytest.approx(strip) and middle == pytest.approx(thick / 2) and middle + rise > thick
    (hatching,) = [line for line in axes.lines if line.get_color() == colour("muted")]
    strokes = np.column_stack(hatching.get_data()).reshape(-1, 3, 2)
    assert strokes[0, 0, 0] == 0.0 and strokes[-1, 0, 0] == pytest.approx(substrate)
    assert np.all(strokes[:, 0, 1] == base) and np.all(strokes[:, 1, 1] < base)
    assert inside(axes)
