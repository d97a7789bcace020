"""How figures of the page look, whatever they show: colours, lines, axes, and labels of any length."""

import numpy as np
import pytest

pytest.importorskip("matplotlib")


from verify.pages.style import (
    HALF,
    IN_TABLES,
    STRESS_MAP,
    drawing,
    line,
    panel,
    sheet_of,
)


@pytest.mark.parametrize("method", [*IN_TABLES, "code of another"])
def test_further_runs_of_a_method_are_thinner_and_fainter(method):
    """But never so much that they could not be seen; each lies below the one before."""
    runs = [line(method, repeat) for repeat in range(5)]
    assert len({(run.colour, run.dashes) for run in runs}) == 1
    assert runs[0].colour == (method if method in IN_TABLES else "ink")
    widths, alphas, orders = ([getattr(run, name) for run in runs] for name in ("width", "alpha", "order"))
    assert widths == sorted(widths, reverse=True) and min(widths) >= 0.6
    assert alphas == sorted(alphas, reverse=True) and min(alphas) == pytest.approx(0.4 * alphas[0])
    assert np.all(np.diff(orders) < 0.0)


def test_no_two_methods_look_alike():
    looks = {(one.colour, one.dashes, one.width) for one in map(line, (*IN_TABLES, "other"))}
    assert len(looks) == len(IN_TABLES) + 1


def test_a_stress_of_zero_has_the_colour_of_the_page():
    """The scale goes from one ink to another, ever less transparent, and as strong on both sides."""
    rgba = STRESS_MAP(np.linspace(0.0, 1.0, 201))
    alpha = rgba[:, 3]
    assert alpha.argmin() in (99, 100, 101) and alpha.min() < 0.12 and alpha[[0, -1]].tolist() == [1.0, 1.0]
    assert np.all(np.diff(alpha[101:]) >= -1e-9) and np.allclose(alpha, alpha[::-1], atol=0.02)
    assert rgba[0, 2] > rgba[0, 0] and rgba[-1, 0] > rgba[-1, 2], "blue is pressed, red is pulled"


def test_a_label_longer_than_its_axis_is_broken_into_lines_and_the_sheet_has_room_for_it():
    with drawing():
        figure, axes = panel(HALF, 2.5)
        assert sheet_of(figure).extents == pytest.approx([0.0, 0.0, HALF, 2.5], abs=0.05)
        axes.set_ylabel(whole := "a load in a unit with a name of very many letters and some words more")
        sheet, drawn = sheet_of(figure), figure.get_tightbbox()
        assert "\n" in axes.get_ylabel() and axes.get_ylabel().replace("\n", " ") == whole
        assert axes.yaxis.label.get_window_extent().height <= axes.get_window_extent().height
        assert sheet.x0 <= drawn.x0 and sheet.y1 >= drawn.y1
