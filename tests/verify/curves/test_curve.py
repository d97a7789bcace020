"""Envelope, curve error, oscillation, peaks, cubics of steps and their midpoints."""

import importlib.util

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from skips import SHARED

from verify.curves.curve import curve_error, dense, envelope, load_at, oscillation, peak
from verify.curves.of_run import Midpoints, onward
from verify.result import CURVE_COLUMNS

CHECKS = SHARED / "accept/checks.py"


def smooth(d):
    return d / (0.1 + d**2)


def smooth_slope(d):
    return (0.1 - d**2) / (0.1 + d**2) ** 2


@pytest.mark.parametrize(
    ("d", "P", "shown"),
    [
        ([0, 1, 0.5, 1.5], [0, 2, 1, 1.5], ([0, 1, 1, 1.5], [0, 2, 1.25, 1.5])),  # a snap-back drops vertically
        ([0, 1, 1, 1.5], [0, 2, 1.25, 1.5], ([0, 1, 1, 1.5], [0, 2, 1.25, 1.5])),  # as displacement control records it
        ([0, 1, 2, 1, 0, 1, 2, 3], [0, 3, 2, 1, 0, 1, 2, 1], ([0, 1, 2, 3], [0, 3, 2, 1])),  # unloading
    ],
)
def test_envelopes(d, P, shown):
    np.testing.assert_allclose(envelope(d, P), shown)


@given(st.lists(st.tuples(st.floats(-1, 5), st.floats(-2, 2)), min_size=1, max_size=30))
def test_envelope_never_goes_back_and_starts_where_the_path_does(points):
    d, P = (np.array(column) for column in zip(*points, strict=True))
    x, y = envelope(d, P)
    assert np.all(np.diff(x) >= 0.0) and x[0] == d[0] and y[0] == P[0]
    assert x[-1] == d.max() and set(d[d >= d[0]]) >= set(x[1:])
    at = np.linspace(x[0], x[-1], 50)
    np.testing.assert_array_equal(load_at(envelope(x, y), at), load_at((x, y), at))


@pytest.mark.skipif(not CHECKS.exists(), reason=f"{CHECKS.name}, the definition that is compared with, is not there")
@pytest.mark.parametrize("end", [None, 1.7])
def test_curve_error_is_the_accepted_one(end):
    """A second implementation in plain Python, on paths that go back and forth."""
    spec = importlib.util.spec_from_file_location("checks", CHECKS)
    checks = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(checks)
    for seed in range(20):
        rng = np.random.default_rng(seed)
        curves = []
        for n, last in ((40, 3.0), (60, 2.9)):
            d = np.concatenate(([0.0], np.cumsum(rng.normal(0.08, 0.12, n)), [last]))
            curves.append((d, 1.0 + rng.random(n + 2)))
        points = [list(zip(*c, strict=True)) for c in curves]
        assert curve_error(*curves, end) == pytest.approx(checks.curve_error(*points, end), rel=1e-12, nan_ok=True)
        np.testing.assert_allclose(np.transpose(envelope(*curves[0])), checks.envelope(points[0]), rtol=1e-12)


@given(st.floats(1e-3, 1e3), st.booleans())
def test_curves_are_compared_to_their_very_end(end, drops):
    """Rounding must not push the last sample beyond it, where there is no load."""
    d = np.linspace(0.0, 1.0, 40) * end
    exact = d, smooth(d / end)
    assert curve_error((d, 1.01 * exact[1]), exact, drops=drops) == pytest.approx(0.01, rel=1e-9)
    assert oscillation(exact, exact)["rms"] == pytest.approx(0.0, abs=1e-12)
    half = d[:20], exact[1][:20]
    assert np.isnan(curve_error(half, exact)) and curve_error(half, exact, end=d[19]) == pytest.approx(0.0, abs=1e-14)


def test_a_drop_that_comes_a_little_later_counts_with_its_delay():
    drop, later = (([0.0, at, at, 2.0], [0.0, 1.0, 0.2, 0.2]) for at in (1.0, 1.02))
    assert curve_error(later, drop) > 0.1 > 0.02 > curve_error(later, drop, drops=True)
    assert curve_error(([0.0, 1.0, 1.0, 2.0], [0.0, 1.0, 0.3, 0.3]), drop, drops=True) > 0.1, "its height is wrong"


def test_load_at_a_jump_is_the_load_before_it():
    found = load_at(([0, 1, 0.5, 1.5], [0, 2, 1, 2]), [1.0, 1.25, 1.6])
    assert found == pytest.approx([2.0, 1.75, np.nan], nan_ok=True)


def test_oscillation_sees_the_wave_and_not_the_offset():
    d = np.linspace(0.0, 3.0, 2000)
    begin = 1.3 * np.sqrt(0.1)
    k = 2 * np.pi * 40 / (3.0 - begin)
    found = oscillation((d, 1.05 * smooth(d) * (1 + 0.02 * np.sin(k * (d - begin)))), (d, smooth(d)))
    assert found["rms"] == pytest.approx(1.05 * 0.02 / np.sqrt(2), rel=0.01) and found["excess_variation"] > 0.1
    assert list(oscillation((d, 0.9 * smooth(d)), (d, smooth(d))).values()) == pytest.approx([0.0, 0.0], abs=1e-12)


def test_peak_between_points():
    d = np.linspace(0.0, 3.0, 41)
    exact = np.sqrt(0.1), smooth(np.sqrt(0.1))
    found = peak((d, smooth(d)), smooth_slope(d))
    assert found[0] == pytest.approx(exact[0], rel=1e-3) and found[1] == pytest.approx(exact[1], rel=1e-4)
    assert abs(peak((d, smooth(d)))[0] - exact[0]) > 1e-2


def test_slopes_of_a_ripple_make_no_peak_between_steps():
    """Both steps to the left and the right spend what the straight line does, or what the cubic does."""
    d, P, slope = np.array([0.0, 1.0, 2.0]), np.array([0.0, 1.0, 1.0]), np.array([1.0, 3.0, -3.0])
    below_lines, below_cubics = np.array([0.0, 0.5, 1.5]), np.array([0.0, 0.5, 1.5 + 6.0 / 12.0])
    assert peak((d, P), slope) == peak((d, P), slope, below_cubics) == pytest.approx((1.5, 1.75))
    assert peak((d, P), slope, below_lines) == (1.0, 1.0)


def snapping(n):
    """A path that snaps back twice: opening, load, slope d load / d opening, heading, (n,)."""
    t = np.linspace(0.0, 4.0, n)
    d, dd = t + 0.6 * np.sin(3 * t), 1.0 + 1.8 * np.cos(3 * t)
    P, dP = 40.0 * np.sin(0.8 * t), 32.0 * np.cos(0.8 * t)
    return d, P, dP / dd, np.sign(dd)


def test_dense_curve_follows_snap_backs_to_fourth_order():
    """By the largest distance of its points from a fine polyline, each axis over its largest size."""
    exact = np.array(snapping(10001)[:2])
    size = np.abs(exact).max(axis=1)
    start, along = (exact.T / size)[:-1], np.diff(exact.T / size, axis=0)
    errors = []
    for n in (51, 101, 201):
        off = (np.transpose(dense(*snapping(n), per_step=4)) / size)[:, None] - start
        share = np.clip(np.sum(off * along, axis=2) / np.sum(along**2, axis=1), 0.0, 1.0)
        errors.append(np.sqrt(np.sum((off - share[..., None] * along) ** 2, axis=2).min(axis=1)).max())
    assert np.all(np.log2(np.divide(errors[:-1], errors[1:])) > 3.8) and errors[-1] < 1e-6
    few = snapping(41)
    assert curve_error(few[:2], exact) > 20 * curve_error(dense(*few), exact)


def test_dense_curve_passes_through_its_points_at_any_scale():
    path = snapping(21)
    d, P = dense(*path, per_step=7)
    np.testing.assert_allclose([d[::7], P[::7]], path[:2], rtol=1e-13, atol=1e-13)
    scaled = dense(1e-6 * path[0], 1e9 * path[1], 1e15 * path[2], path[3], per_step=7)
    np.testing.assert_allclose([1e6 * scaled[0], 1e-9 * scaled[1]], [d, P], rtol=1e-12, atol=1e-12)
    assert np.array_equal(dense([0.0], [0.0], [1.0], [1.0]), [[0.0], [0.0]])


def test_a_step_over_a_ripple_is_straight_and_one_along_a_smooth_path_is_not():
    """The area of the path, from its energies, tells which of both it is."""
    path, fine = snapping(81), snapping(80_001)
    energy = np.append(0.0, np.cumsum(0.5 * np.diff(fine[0]) * (fine[1][1:] + fine[1][:-1])))[::1000]
    np.testing.assert_array_equal(dense(*path, energy=energy), dense(*path))
    d = np.array([0.0, 1.0, 2.0])  # the load falls along a line with a fine ripple, of flanks of slope 5 and -6
    rippled = d, 10.0 - d, np.array([5.0, -6.0, 5.0]), np.ones(3)
    straight, cubic = dense(*rippled, energy=10.0 * d - 0.5 * d**2), dense(*rippled)
    np.testing.assert_allclose(straight[1], 10.0 - straight[0], rtol=1e-14)
    assert np.abs(cubic[1] - 10.0 + cubic[0]).max() > 0.1


def test_a_step_that_bends_late_has_the_area_of_its_path():
    """Its slopes make a cubic bulge twice as far as the path does."""
    d, fine = np.array([0.0, 1.0]), np.linspace(0.0, 1.0, 1001)
    ends, slopes, area = d - 0.2 * d**6, np.array([1.0, -0.2]), 0.5 * d**2 - 0.2 * d**7 / 7.0
    drawn, cubic = (dense(d, ends, slopes, np.ones(2), 50, energy=energy) for energy in (area, None))
    assert np.trapezoid(*drawn[::-1]) == pytest.approx(area[1], rel=1e-3)
    off = [np.abs(np.interp(fine, *curve) - fine + 0.2 * fine**6).max() for curve in (drawn, cubic)]
    assert off[0] < 0.5 * off[1]


def test_dense_curve_takes_a_vertical_tangent():
    t = np.linspace(0.0, np.pi, 41)  # half a circle: the path turns back at the middle point
    slope = np.where(t == t[20], np.inf, np.tan(t))
    d, P = dense(np.sin(t), 1.0 - np.cos(t), slope, np.where(t > t[20], -1.0, 1.0))
    assert np.max(np.abs(np.hypot(d, P - 1.0) - 1.0)) < 5e-6


def test_dense_curve_leaves_a_kink_along_a_parabola():
    """Third differences of a parabola vanish, and it ends along the tangent that is known; other steps are cubics."""
    d, P, slope, heading = [0.0, 1.0, 0.5], [0.0, 1.0, 0.2], [2.0, 0.5, 1.2], [1.0, 1.0, -1.0]
    x, y = dense(d, P, slope, heading, per_step=50)
    for values in (x, y):
        assert np.abs(np.diff(values[50:], 3)).max() < 1e-12 < 1e-9 < np.abs(np.diff(values[:51], 3)).max()
    assert (y[-1] - y[-2]) / (x[-1] - x[-2]) == pytest.approx(1.2, rel=0.02)


@pytest.mark.parametrize("end", [1.0, 1.0 + 3e-16])
def test_a_run_that_ends_by_rounding_before_its_goal_has_not_separated(end):
    opening, load = onward((np.array([0.0, 1.0]), np.array([0.0, 2.0])), end)
    assert opening[-1] == end and load[-1] == 2.0
    assert onward((opening, load), 1.5)[1][-1] == 0.0


def stepped(steps: int) -> list[dict[str, float]]:
    """Rows of load = 3 d - d^3, whose work is 1.5 d^2 - d^4 / 4, half of it dissipated."""
    names = ("opening", "load", "crack_length", "stored_energy", "dissipated_energy", "external_work", "load_slope")
    d = np.linspace(0.0, 1.5, steps + 1)
    W = 1.5 * d**2 - d**4 / 4
    rows = np.transpose([d, 3 * d - d**3, 4.0 + d, 0.5 * W + 0.01, 0.5 * W, W, 3 - 3 * d**2])
    return [{**dict(zip(names, row, strict=True)), "newton_iterations": 3.0, "heading": 1.0} for row in rows]


def test_a_midpoint_is_on_the_curve_with_its_work_and_its_ledger():
    """A cubic in the plane of load and opening is of fourth order, and so is the work along it."""
    errors = []
    for steps in (10, 20):
        between = Midpoints()
        found = [between(row) for row in stepped(steps)]
        assert found[0] is None and all(set(row) == set(CURVE_COLUMNS) for row in found[1:])
        columns = {name: np.array([row[name] for row in found[1:]]) for name in CURVE_COLUMNS}
        d, half = columns["opening"], 1.5 * (np.arange(steps) + 0.5) / steps
        assert np.allclose(d[2:], half[2:], atol=0.15 / steps) and not columns["newton_iterations"].any()
        ledger = columns["stored_energy"] + columns["dissipated_energy"] - columns["external_work"]
        assert ledger == pytest.approx(0.01, abs=1e-12)
        exact = {"load": 3 * d - d**3, "external_work": 1.5 * d**2 - d**4 / 4}
        errors.append([np.abs(columns[name] - value).max() for name, value in exact.items()])
    assert np.all(np.array(errors[0]) < (1e-3, 1e-5)) and np.all(np.array(errors[1]) < np.array(errors[0]) / 8)


def test_a_midpoint_goes_back_with_the_path_and_needs_slopes():
    """Unloading along a straight line, whose first row has the slope of its arrival."""
    top = {**stepped(1)[0], "opening": 1.0, "load": 2.0, "load_slope": -1.0}
    down = {**top, "opening": 0.5, "load": 1.0, "load_slope": 2.0, "heading": -1.0}
    between, without = Midpoints(), Midpoints()
    between(top)
    middle = between(down)
    assert middle is not None and (middle["opening"], middle["load"]) == pytest.approx((0.75, 1.5), rel=1e-12)
    bare = [{name: value for name, value in row.items() if name != "load_slope"} for row in (top, down)]
    assert [without(row) for row in bare] == [None, None]
