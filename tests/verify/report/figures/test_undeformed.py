"""Undeformed meshes on the page: every mesh once, T-junctions where they are, the process zone counted in elements."""

from dataclasses import replace

import numpy as np
import pytest

pytest.importorskip("matplotlib")

from matplotlib.figure import Figure  # noqa: E402

from verify.pages.style import drawing, line  # noqa: E402
from verify.report.figures.entry import Entry  # noqa: E402
from verify.report.figures.undeformed import (
    _changes,
    _distinct,
    _last,
    _names,
    bond_element,
    draw,
    followed,
    undeformed,
    zone_at,
)
from verify.result import Result, Snapshot  # noqa: E402
from verify.scene.load import load_scene  # noqa: E402
from verify.verdict import Run  # noqa: E402

SCENE, LENGTH, ARM = load_scene("dcb-czm1"), 14.0, 0.2
FRAME = (-0.1, LENGTH + 0.1), (-0.21, 0.21)


def snapshot(zone=(9.0, 10.0), breaks=None, junctions=(), opening=3.0) -> Snapshot:
    """Two arms of elements between ``breaks``; ``junctions`` lie on the bond, one on each arm."""
    breaks = np.linspace(0.0, LENGTH, 29) if breaks is None else np.asarray(breaks)
    k = np.linspace(0.0, 1.0, 3)
    x = breaks[:-1, None] + np.diff(breaks)[:, None] * k
    arms = [np.stack(np.broadcast_arrays(x[:, :, None], sign * ARM * k), -1) for sign in (1.0, -1.0)]
    X = np.concatenate(arms)
    s = np.linspace(4.0, LENGTH, 1001)
    damage = np.where(s < zone[0], 1.0, np.where(s <= zone[1], 0.5, 0.0))
    at = np.array([[x, 0.0] for x in junctions]).reshape(-1, 2)
    full = [[[x, 0.0], [x, sign * ARM]] for sign in (1.0, -1.0) for x in breaks if x not in junctions]
    bond = [[[0.0, 0.0], [LENGTH, 0.0]]] * 2
    lines = np.array([*full, *bond]) if junctions else np.zeros((0, 2, 2))
    return Snapshot(
        opening, 0.3, s, 0 * s, 0 * s, damage, X, 0 * X, 0 * X[..., 0], lines, np.concatenate([at, at])
    )  # fmt: skip


def entry(*snapshots: Snapshot, method: str = "nurbs", label: str = "NURBS, 280 unknowns", repeat: int = 0) -> Entry:
    steps = {"opening": np.array([0.0, 1.0]), "load": np.array([0.0, 1.0])}
    return Entry(Run(label, method, Result(method, steps, snapshots=snapshots)), repeat, line(method), None, False)


def drawn(given: Snapshot, frame=FRAME):
    """Points of all that was drawn, by name."""
    with drawing():
        axes = Figure(figsize=(6, 1)).add_subplot()
        draw(axes, given, "black", frame, zone_at(SCENE, given))
    parts: dict[str, list[np.ndarray]] = {}
    for artist in axes.lines:
        parts.setdefault(artist.get_label(), []).append(artist.get_xydata())
    return axes, {name: np.concatenate(found) for name, found in parts.items()}


def test_each_arm_has_its_own_junctions_on_its_own_side():
    _, parts = drawn(snapshot(junctions=(8.5, 9.5, 10.5)))
    assert len(parts["T-mesh"]) == 3 * 2 * (29 - 3 + 1)  # of each arm the lines across and the bond, and a gap each
    marks = parts["T-junctions"]
    assert sorted(marks[:, 0]) == [8.5, 8.5, 9.5, 9.5, 10.5, 10.5]
    for side in (1, -1):
        assert sorted(marks[marks[:, 1] * side > 0][:, 0]) == [8.5, 9.5, 10.5]
    assert np.abs(marks[:, 1]) == pytest.approx(abs(marks[0, 1])) and abs(marks[0, 1]) < 0.2 * ARM


def test_only_what_the_frame_shows_is_drawn():
    _, parts = drawn(snapshot(junctions=(8.5, 9.5, 10.5)), ((9.0, 10.2), (-0.2, 0.2)))
    assert sorted(parts["T-junctions"][:, 0]) == [9.5, 9.5]
    assert np.nanmin(parts["elements"][:, 0]) == pytest.approx(8.5)  # the element that ends at 9.0


def test_sides_of_elements_are_drawn_once_and_the_zone_is_where_the_damage_is():
    _, parts = drawn(snapshot())
    steps = np.diff(parts["elements"], axis=0)
    inked = np.nansum(np.abs(steps), axis=0)
    assert inked == pytest.approx([4 * LENGTH, 2 * 29 * ARM])  # two faces and 29 lines across each arm
    assert parts["zone"][:, 0] == pytest.approx([9.0, 10.0]) and "T-junctions" not in parts and "T-mesh" not in parts


def test_the_longest_element_that_the_zone_meets_counts():
    breaks = np.concatenate([np.linspace(0, 8, 5), np.linspace(8, 9.5, 16)[1:], np.linspace(9.5, LENGTH, 10)[1:]])
    assert bond_element(snapshot(breaks=breaks), (8.55, 9.45)) == pytest.approx(0.1)
    assert bond_element(snapshot(breaks=breaks), (8.55, 9.65)) == pytest.approx(0.5)
    assert bond_element(snapshot(breaks=breaks), (8.0, 9.5)) == pytest.approx(0.1)  # neighbours that end there
    assert np.isnan(bond_element(snapshot(breaks=breaks), (15.0, 16.0)))


def test_every_mesh_is_drawn_once_with_the_names_of_its_runs():
    other = snapshot(breaks=np.linspace(0.0, LENGTH, 15))
    runs = [
        entry(snapshot(), label="one"),
        entry(snapshot(), label="two"),
        entry(other, label="three"),
        entry(snapshot(junctions=(9.25,)), method="tspline", label="four"),
        entry(label="five"),
    ]
    panel = undeformed(SCENE, runs, "key")
    assert "one and two: 56 elements; 2 of 0.5" in panel.svg and "three: 28 elements; 1 of 1" in panel.svg
    assert "four: 56 elements, 2 T-junctions; 2 of 0.5" in panel.svg and "five" not in panel.svg
    assert "T-junction" in panel.caption
    assert "T-junction" not in undeformed(SCENE, runs[:3], "key").caption
    assert undeformed(SCENE, runs[4:], "key") is None


def test_of_a_mesh_that_moves_the_last_three_places_are_drawn():
    at = [snapshot((x, x + 1), junctions=(x + 0.5,), opening=x) for x in (4.0, 5.0, 7.0, 9.0)]
    still = entry(at[0], replace(at[0], opening=6.0), method="tspline")
    assert followed(SCENE, [entry(snapshot()), still], "key") is None
    panel = followed(SCENE, [still, entry(*at, method="tspline", label="moving")], "key")
    assert "moving" in panel.caption and "Opening 4" not in panel.svg
    assert all(f"Opening {x}" in panel.svg for x in (5, 7, 9))


@pytest.mark.parametrize("change", [{"arm_thickness": 3.0}, {"precrack": 12.0}])
def test_stocky_and_short_bonds_are_drawn_too(change):
    body = SCENE.specimen.model_copy(update=change)
    given = snapshot((12.5, 13.5))
    thick = replace(given, X_euvi=given.X_euvi * [1.0, body.arm_thickness / ARM])
    panel = undeformed(SCENE.model_copy(update={"specimen": body}), [entry(thick)], "key")
    assert ("too thick" in panel.caption) == (body.arm_thickness == ARM)


def test_the_last_mesh_with_a_zone_is_shown():
    """Or the last one, where nothing is damaged; a moment without fields is none."""
    early, late = snapshot((5.0, 6.0), opening=1.0), snapshot((9.0, 10.0), opening=2.0)
    intact, gone = snapshot((0.0, 0.0), opening=3.0), snapshot((20.0, 21.0), opening=4.0)
    bare = replace(late, X_euvi=np.zeros((0, 3, 3, 2)), opening=5.0)
    assert _last(entry(early, late, intact, gone, bare)) is late and _last(entry(early, intact)) is early
    assert _last(entry(intact, gone, bare)) is gone and _last(entry(bare)) is None and _last(entry()) is None


def test_a_mesh_that_changes_is_shown_before_every_change_and_at_last():
    meshes = [snapshot(junctions=at, opening=i) for i, at in enumerate([(8.5,), (8.5,), (9.5,), (10.5,), (10.5,)])]
    assert [one.opening for one in _changes(entry(*meshes))] == [1, 2, 4]
    assert [one.opening for one in _changes(entry(*meshes[:2]))] == [1] and _changes(entry(snapshot())) == []


def test_runs_on_the_same_mesh_are_one_picture():
    """To rounding; where the zone is does not matter, T-junctions do."""
    here, there, other = (
        entry(snapshot()),
        entry(snapshot((5.0, 6.0)), label="another"),
        entry(snapshot(junctions=(9.5,))),
    )
    shifted = replace(snapshot(), X_euvi=snapshot().X_euvi + 1e-12)
    finer = snapshot(breaks=np.linspace(0.0, LENGTH, 57))
    shown = [(here, snapshot()), (there, shifted), (other, snapshot(junctions=(9.5,))), (other, finer)]
    groups = _distinct(shown)
    assert [runs for runs, _ in groups] == [[here, there], [other], [other]]
    assert _names(groups[0][0]) == "NURBS, 280 unknowns and another" and groups[0][1] is shown[0][1]
