"""Envelope, curve error, oscillation and Hermite resampling."""

import importlib.util
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from verify.curves.curve import curve_error, dense, envelope, hermite, load_at, oscillation, peak
from verify.curves.of_run import onward

CHECKS = Path(__file__).parents[3] / "../shared/accept/checks.py"


def smooth(d):
    return d / (0.1 + d**2)


def smooth_slope(d):
    return (0.1 - d**2) / (0.1 + d**2) ** 2


def test_envelope_drops_vertically_at_a_snap_back():
    d, P = envelope([0.0, 1.0, 0.5, 1.5], [0.0, 2.0, 1.0, 1.5])
    np.testing.assert_allclose(d, [0.0, 1.0, 1.0, 1.5])
    np.testing.assert_allclose(P, [0.0, 2.0, 1.25, 1.5])


def test_envelope_keeps_a_vertical_drop():
    """The limit of a snap-back that goes back ever less, and what a test under displacement control records."""
    d, P = envelope([0.0, 1.0, 1.0, 1.5], [0.0, 2.0, 1.25, 1.5])
    np.testing.assert_array_equal([d, P], [[0.0, 1.0, 1.0, 1.5], [0.0, 2.0, 1.25, 1.5]])
    near = envelope([0.0, 1.0, 1.0 - 1e-9, 1.5], [0.0, 2.0, 1.25, 1.5])
    np.testing.assert_allclose([d, P], near, rtol=1e-8)


def test_envelope_forgets_unloading():
    d = [0.0, 1.0, 2.0, 1.0, 0.0, 1.0, 2.0, 3.0]
    P = [0.0, 3.0, 2.0, 1.0, 0.0, 1.0, 2.0, 1.0]
    found = envelope(d, P)
    np.testing.assert_allclose(found[0], [0.0, 1.0, 2.0, 3.0])
    np.testing.assert_allclose(found[1], [0.0, 3.0, 2.0, 1.0])


@given(st.lists(st.tuples(st.floats(-1, 5), st.floats(-2, 2)), min_size=1, max_size=30))
def test_envelope_never_goes_back_and_starts_where_the_path_does(points):
    d, P = (np.array(column) for column in zip(*points, strict=True))
    x, y = envelope(d, P)
    assert np.all(np.diff(x) >= 0.0) and x[0] == d[0] and y[0] == P[0]
    assert x[-1] == d.max() and set(d[d >= d[0]]) >= set(x[1:])
    at = np.linspace(x[0], x[-1], 50)
    np.testing.assert_array_equal(load_at(envelope(x, y), at), load_at((x, y), at))


def _checks():
    if not CHECKS.exists():
        pytest.skip(f"{CHECKS.name}, the definition that is compared with, is not there")
    spec = importlib.util.spec_from_file_location("checks", CHECKS)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.mark.parametrize("seed", range(20))
@pytest.mark.parametrize("end", [None, 1.7])
def test_curve_error_is_the_accepted_one(seed, end):
    """A second implementation in plain Python, on paths that go back and forth."""
    checks, rng = _checks(), np.random.default_rng(seed)
    curves = []
    for n in (40, 60):
        d = np.concatenate(([0.0], np.cumsum(rng.normal(0.08, 0.12, n)), [3.0]))
        curves.append((d, 1.0 + rng.random(n + 2)))
    curves[1][0][-1] = 2.9
    expected = checks.curve_error(*(list(zip(*c, strict=True)) for c in curves), end)
    assert curve_error(*curves, end) == pytest.approx(expected, rel=1e-12, nan_ok=True)
    for curve in curves:
        points = [np.array(list(zip(*curve, strict=True)))]
        theirs = np.array(checks.envelope([tuple(p) for p in points[0]]))
        np.testing.assert_allclose(np.stack(envelope(*curve), axis=1), theirs, rtol=1e-12)


def test_curve_error_of_a_scaled_curve_is_the_scale():
    d = np.linspace(0.0, 3.0, 200)
    assert curve_error((d, 1.01 * smooth(d)), (d, smooth(d))) == pytest.approx(0.01, rel=1e-10)


def test_curve_error_needs_the_whole_range():
    d = np.linspace(0.0, 3.0, 50)
    assert np.isnan(curve_error((d[:40], smooth(d[:40])), (d, smooth(d))))
    assert curve_error((d[:40], smooth(d[:40])), (d, smooth(d)), end=2.0) == pytest.approx(0.0, abs=1e-14)


@given(st.floats(1e-3, 1e3))
def test_curves_are_compared_to_their_very_end(end):
    """Rounding must not push the last sample beyond it, where there is no load."""
    d = np.linspace(0.0, 1.0, 40) * end
    assert curve_error((d, 1.01 * smooth(d / end)), (d, smooth(d / end))) == pytest.approx(0.01, rel=1e-9)
    assert oscillation((d, smooth(d / end)), (d, smooth(d / end)))["rms"] == pytest.approx(0.0, abs=1e-12)


def test_hermite_is_exact_for_cubics_and_of_fourth_order():
    d = np.array([0.0, 0.4, 1.0, 2.0])
    at = np.linspace(0.0, 2.0, 31)
    np.testing.assert_allclose(hermite(d, d**3 - d, 3 * d**2 - 1, at), at**3 - at, atol=1e-14)
    errors = []
    for n in (20, 40, 80):
        d = np.linspace(0.0, 3.0, n + 1)
        at = np.linspace(0.0, 3.0, 777)
        errors.append(np.abs(hermite(d, smooth(d), smooth_slope(d), at) - smooth(at)).max())
    assert np.all(np.log2(np.divide(errors[:-1], errors[1:])) > 3.6) and errors[-1] < 1e-4


def test_hermite_follows_the_envelope():
    found = hermite([0, 1, 0.5, 1.5], [0, 2, 1, 2], [2, 2, 1, 1], [1.25, 2.0])
    assert found == pytest.approx([1.75, np.nan], nan_ok=True)


def snapping(t):
    """A closed path that snaps back twice: opening, load, slope d load / d opening, heading."""
    d, dd = t + 0.6 * np.sin(3 * t), 1.0 + 1.8 * np.cos(3 * t)
    P, dP = 40.0 * np.sin(0.8 * t), 32.0 * np.cos(0.8 * t)
    return d, P, dP / dd, np.sign(dd)


def distance(curve, exact):
    """Largest distance of points to a polyline, each axis over its largest size."""
    size = np.abs(exact).max(axis=1)
    points, line = (np.transpose(c) / size for c in (curve, exact))
    start, along = line[:-1], np.diff(line, axis=0)
    share = np.sum((points[:, None] - start) * along, axis=2) / np.sum(along**2, axis=1)
    nearest = start + np.clip(share, 0.0, 1.0)[..., None] * along
    return np.sqrt(np.sum((points[:, None] - nearest) ** 2, axis=2).min(axis=1)).max()


def test_dense_curve_follows_snap_backs_to_fourth_order():
    exact = np.array(snapping(np.linspace(0.0, 4.0, 10001))[:2])
    assert np.any(np.diff(exact[0]) < 0.0)
    errors = [distance(dense(*snapping(np.linspace(0.0, 4.0, n + 1))), exact) for n in (50, 100, 200)]
    assert np.all(np.log2(np.divide(errors[:-1], errors[1:])) > 3.8) and errors[-1] < 1e-6


def test_a_dense_curve_gives_envelope_and_curve_error_of_a_snap_back():
    exact = np.array(snapping(np.linspace(0.0, 4.0, 20001))[:2])
    few = snapping(np.linspace(0.0, 4.0, 41))
    assert curve_error(dense(*few), exact) < 2e-4
    assert curve_error(few[:2], exact) > 20 * curve_error(dense(*few), exact)


def test_dense_curve_passes_through_its_points_at_any_scale():
    path = snapping(np.linspace(0.0, 4.0, 21))
    d, P = dense(*path, per_step=7)
    np.testing.assert_allclose([d[::7], P[::7]], path[:2], rtol=1e-13, atol=1e-13)
    scaled = dense(1e-6 * path[0], 1e9 * path[1], 1e15 * path[2], path[3], per_step=7)
    np.testing.assert_allclose([1e6 * scaled[0], 1e-9 * scaled[1]], [d, P], rtol=1e-12, atol=1e-12)


def test_a_step_over_many_teeth_is_straight_and_one_along_a_smooth_path_is_not():
    """The area of the path, from its energies, tells which of both it is."""
    path = snapping(np.linspace(0.0, 4.0, 81))
    fine = np.array(snapping(np.linspace(0.0, 4.0, 80_001))[:2])
    energy = np.concatenate([[0.0], np.cumsum(0.5 * np.diff(fine[0]) * (fine[1][1:] + fine[1][:-1]))])[::1000]
    np.testing.assert_array_equal(dense(*path, energy=energy), dense(*path))
    d = np.array([0.0, 1.0, 2.0])  # the load falls along a line with many small teeth, of flanks of slope 5 and -6
    P, slope = 10.0 - d, np.array([5.0, -6.0, 5.0])
    energy = 10.0 * d - 0.5 * d**2
    found = dense(d, P, slope, np.ones(3), energy=energy)
    np.testing.assert_allclose(found[1], 10.0 - found[0], rtol=1e-14)
    assert np.abs(np.subtract(dense(d, P, slope, np.ones(3))[1], 10.0 - dense(d, P, slope, np.ones(3))[0])).max() > 0.1


def test_dense_curve_takes_a_vertical_tangent():
    t = np.linspace(0.0, np.pi, 41)  # half a circle: the path turns back at the middle point
    slope = np.where(t == t[20], np.inf, np.tan(t))
    d, P = dense(np.sin(t), 1.0 - np.cos(t), slope, np.where(t > t[20], -1.0, 1.0))
    assert np.max(np.abs(np.hypot(d, P - 1.0) - 1.0)) < 5e-6


def test_dense_curve_leaves_the_end_of_a_leg_as_the_next_leg_does():
    """Up to 1 along load = opening - opening^2 / 4, back to the origin along the secant."""
    up = np.linspace(0.0, 1.0, 6)
    d, P = np.append(up, [0.5, 0.0]), np.append(up - up**2 / 4, [0.375, 0.0])
    slope, heading = np.append(1.0 - up / 2, [0.75, 0.75]), np.append(np.ones(6), [-1.0, -1.0])
    x, y = dense(d, P, slope, heading)
    np.testing.assert_allclose(y[50:], 0.75 * x[50:], atol=1e-14)
    assert np.all(np.diff(x[50:]) < 0.0)


def test_dense_curve_of_one_point():
    assert np.array_equal(np.array(dense([0.0], [0.0], [1.0], [1.0])), [[0.0], [0.0]])


def test_peak_between_points():
    d = np.linspace(0.0, 3.0, 41)
    exact = np.sqrt(0.1), smooth(np.sqrt(0.1))
    found = peak((d, smooth(d)), smooth_slope(d))
    assert found[0] == pytest.approx(exact[0], rel=1e-3) and found[1] == pytest.approx(exact[1], rel=1e-4)
    assert abs(peak((d, smooth(d)))[0] - exact[0]) > 1e-2


def test_slopes_of_single_teeth_make_no_peak_between_steps() -> None:
    """Both steps to the left and the right spend what the straight line does, or what the cubic does."""
    d, P, slope = np.array([0.0, 1.0, 2.0]), np.array([0.0, 1.0, 1.0]), np.array([1.0, 3.0, -3.0])
    below_lines, below_cubics = np.array([0.0, 0.5, 1.5]), np.array([0.0, 0.5, 1.5 + 6.0 / 12.0])
    assert peak((d, P), slope) == peak((d, P), slope, below_cubics) == pytest.approx((1.5, 1.75))
    assert peak((d, P), slope, below_lines) == (1.0, 1.0)


def test_load_at_a_jump_is_the_load_before_it():
    found = load_at(([0, 1, 0.5, 1.5], [0, 2, 1, 2]), [1.0, 1.25, 1.6])
    assert found == pytest.approx([2.0, 1.75, np.nan], nan_ok=True)


def test_oscillation_sees_the_wave_and_not_the_offset():
    d = np.linspace(0.0, 3.0, 2000)
    begin = 1.3 * np.sqrt(0.1)
    k = 2 * np.pi * 40 / (3.0 - begin)
    found = oscillation((d, 1.05 * smooth(d) * (1 + 0.02 * np.sin(k * (d - begin)))), (d, smooth(d)))
    assert found["rms"] == pytest.approx(1.05 * 0.02 / np.sqrt(2), rel=0.01)
    assert found["excess_variation"] > 0.1
    flat = oscillation((d, 0.9 * smooth(d)), (d, smooth(d)))
    assert flat["rms"] == pytest.approx(0.0, abs=1e-12) and flat["excess_variation"] == pytest.approx(0.0, abs=1e-12)


def test_dense_curve_leaves_a_kink_along_a_parabola():
    """Third differences of a parabola vanish, and it ends along the tangent that is known; other steps are cubics."""
    d, P, slope, heading = [0.0, 1.0, 0.5], [0.0, 1.0, 0.2], [2.0, 0.5, 1.2], [1.0, 1.0, -1.0]
    x, y = dense(d, P, slope, heading, per_step=50)
    for values in (x, y):
        back, there = values[50:], values[:51]
        assert np.abs(np.diff(back, 3)).max() < 1e-12 < 1e-9 < np.abs(np.diff(there, 3)).max()
    assert (y[-1] - y[-2]) / (x[-1] - x[-2]) == pytest.approx(1.2, rel=0.02)


@pytest.mark.parametrize("end", [1.0, 1.0 + 3e-16])
def test_a_run_that_ends_by_rounding_before_its_goal_has_not_separated(end: float) -> None:
    opening, load = onward((np.array([0.0, 1.0]), np.array([0.0, 2.0])), end)
    assert opening[-1] == end and load[-1] == 2.0
    assert onward((opening, load), 1.5)[1][-1] == 0.0
