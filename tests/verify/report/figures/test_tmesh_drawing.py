"""Drawings of T-meshes: what is drawn is what is there, where it is."""

import numpy as np
import pytest

pytest.importorskip("matplotlib")

from matplotlib.figure import Figure  # noqa: E402
from tmeshes import initial  # noqa: E402

from iga.tsplines.lines import tensor_grid, with_line  # noqa: E402
from iga.tsplines.tspline import greville, tspline_mesh  # noqa: E402
from verify.pages.style import drawing, to_svg  # noqa: E402
from verify.report.figures.tmesh_drawing import Zone, draw_tmesh, legend_entries  # noqa: E402

GRID = tensor_grid(np.arange(5.0), np.arange(4.0))


def drawn(tmesh, *given, **options):
    """Axes with the drawing, and its parts by name."""
    with drawing():
        axes = Figure(figsize=(4, 3)).add_subplot()
        draw_tmesh(axes, tmesh, *given, **options)
        assert not any(line.get_visible() for line in (*axes.get_xgridlines(), *axes.get_ygridlines())), (
            "no other lines"
        )
    parts = {c.get_label(): c.get_segments() for c in axes.collections}
    return axes, parts | {line.get_label(): line.get_xydata() for line in axes.lines}


def test_a_grid_is_its_inner_lines_and_an_outline():
    _, parts = drawn(GRID)
    assert len(parts["T-mesh"]) == 3 + 2 and len(parts["outline"]) == 4
    assert len(parts["extensions"]) == len(parts["T-junctions"]) == 0
    assert len(parts["anchors"]) == len(GRID.anchors) and "zone" not in parts


def test_a_line_that_ends_has_its_junctions_marked_and_its_extensions_dashed():
    tmesh = with_line(tensor_grid(np.arange(5.0), np.arange(6.0)), "vertical", 1.5, (2.0, 3.0))
    _, parts = drawn(tmesh)
    assert len(parts["T-mesh"]) == 3 + 4 + 1
    assert sorted(map(tuple, parts["T-junctions"])) == [(1.5, 2.0), (1.5, 3.0)]
    ends = sorted(np.sort(line[:, 1]).tolist() for line in parts["extensions"])
    assert ends == [[0.0, 2.0], [3.0, 5.0]] and all(np.all(line[:, 0] == 1.5) for line in parts["extensions"])


def test_double_lines_are_drawn_once_and_dots_may_be_left_out():
    _, parts = drawn(with_line(GRID, "vertical", 2.0, times=2), dots=False)
    assert len(parts["T-mesh"]) == 5 and "anchors" not in parts


def test_a_drawing_on_the_body_is_where_the_body_is():
    mesh = initial(np.arange(4.0), np.arange(4.0)).refined([4]).tmesh
    P_AI = greville(mesh) @ [[0.0, 2.0], [-1.0, 0.0]] + [5.0, 1.0]  # turned, stretched and moved
    _, flat = drawn(mesh)
    _, placed = drawn(mesh, tspline_mesh(mesh, P_AI))
    for name in ("anchors", "T-junctions"):
        assert len(flat[name]) and np.allclose(placed[name], flat[name] @ [[0.0, 2.0], [-1.0, 0.0]] + [5.0, 1.0])
    for name in ("T-mesh", "extensions", "outline"):
        assert len(placed[name]) == len(flat[name]) > 0
        for curve, line in zip(placed[name], flat[name], strict=True):
            assert np.allclose(curve[[0, -1]], line @ [[0.0, 2.0], [-1.0, 0.0]] + [5.0, 1.0])


def test_curved_lines_are_drawn_curved():
    P_AI = greville(GRID)
    bent = tspline_mesh(GRID, P_AI + np.stack([0 * P_AI[:, 0], P_AI[:, 0] ** 2], -1))
    _, parts = drawn(GRID, bent)
    longest = max(parts["T-mesh"], key=lambda curve: np.ptp(curve[:, 0]))
    chord = np.diff(longest, axis=0)
    assert len(longest) == 4 * 8 + 1 and np.max(np.abs(np.diff(chord[:, 1] / chord[:, 0]))) < 0.6


def test_a_zone_is_as_long_as_it_is_on_the_body():
    P_AI = greville(GRID) * 0.5
    _, parts = drawn(GRID, tspline_mesh(GRID, P_AI), Zone("TOP", 0.3, 1.7))
    (zone,) = parts["zone"]
    assert np.allclose(zone[[0, -1]], [[0.3, 1.5], [1.7, 1.5]])
    _, parts = drawn(GRID, None, Zone("RIGHT", 0.0, 3.0))
    assert np.allclose(parts["zone"][0][[0, -1]], [[4.0, 0.0], [4.0, 3.0]])


@pytest.mark.parametrize(("start", "end"), [(-0.1, 1.0), (1.0, 4.2), (2.0, 1.0)])
def test_a_zone_beyond_its_side_is_refused(start, end):
    with pytest.raises(ValueError, match="a zone on BOTTOM must lie within 0 to 4, got"):
        drawn(GRID, None, Zone("BOTTOM", start, end))


def test_true_aspect_or_stretched():
    assert drawn(GRID)[0].get_aspect() == 1.0
    assert drawn(GRID, stretched=True)[0].get_aspect() == "auto"


def test_legends_speak_of_what_is_there_and_the_page_can_follow_the_colours():
    tmesh = with_line(GRID, "vertical", 1.5, (1.0, 2.0))
    assert len(legend_entries(GRID)) == 2 and len(legend_entries(tmesh, "process zone")) == 5
    axes, _ = drawn(tmesh, None, Zone("BOTTOM", 0.5, 1.0))
    with drawing():
        axes.legend(handles=legend_entries(tmesh, "process zone"))
        svg = to_svg(axes.figure, "mesh", "A T-mesh")
    assert all(f"var(--{name})" in svg for name in ("ink", "bad", "tspline", "accent", "zone"))
