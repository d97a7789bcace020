"""Two curves against each other: identities of the numbers."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from verify.curves.compare import Comparison, checks, compare
from verify.curves.curve import curve_error, load_at
from verify.curves.read import CurveError
from verify.curves.wording import complaints, remarks, table


def bond(d):
    """A rounded peak and a long branch."""
    return d / (0.1 + d**2)


def sampled(n: int, end: float = 3.0):
    d = end * np.linspace(0.0, 1.0, n) ** 1.5
    return d, bond(d)


def broken(found: Comparison, *tolerances: float) -> set[str]:
    return {check.name for check in checks(found, *tolerances) if not check.passed}


@st.composite
def paths(draw):
    """Paths from the origin to the opening 3, with snap-backs, and a load above 0."""
    steps = draw(st.lists(st.tuples(st.floats(-0.4, 1.0), st.floats(0.05, 2.0)), min_size=3, max_size=25))
    d = np.round(np.clip(np.cumsum([step for step, _ in steps]), -1.0, 2.9), 9)
    return np.concatenate(([0.0], d, [3.0])), np.array([0.0, *(P for _, P in steps), 1.0])


@given(paths(), st.floats(-0.9, 3.0))
@example((np.array([0.0, 1.0, 3.0]), np.array([0.0, 2.0, 1.0])), 0.0)
def test_a_scaled_load_is_off_by_its_scale(curve, e):
    """And a curve is itself."""
    d, P = curve
    found, same = compare((d, (1 + e) * P), curve), compare(curve, curve)
    assert not broken(same, 0.0, 0.0, 0.0) and same.curve_error == same.peak_shift == same.energy_difference == 0.0
    assert found.curve_error == pytest.approx(abs(e), abs=1e-12)
    assert found.peak_difference == pytest.approx(e, abs=1e-12) and found.peak_shift == 0.0
    if abs(found.b.work) > 1e-3:
        assert found.energy_difference == pytest.approx(np.sign(found.b.work) * e, abs=1e-9)


@given(paths(), paths(), st.integers(-200, 200), st.integers(-700, 700))
def test_roles_are_symmetric_and_nothing_depends_on_units(a, b, length, force):
    """To the last digit in units of powers of two, which round nothing; the distance is over the size of the other."""
    ab, ba = compare(a, b), compare(b, a)
    sizes = [np.sqrt(np.sum(load**2)) for load in (ab.load_b_n, ab.load_a_n)]
    assert ab.curve_error * sizes[0] == pytest.approx(ba.curve_error * sizes[1], rel=1e-9, abs=1e-12)
    assert ab.curve_error == pytest.approx(curve_error(a, b), rel=1e-9, abs=1e-12)
    assert (1 + ab.peak_difference) * (1 + ba.peak_difference) == pytest.approx(1.0, rel=1e-12)
    assert ab.worst[1:] == ba.worst[:0:-1] and ab.a.work == ba.b.work
    scaled = compare(*((2.0**length * d, 2.0**force * P) for d, P in (a, b)))
    for name in ("curve_error", "peak_difference", "peak_shift", "oscillation_rms", "excess_variation"):
        np.testing.assert_equal(getattr(scaled, name), getattr(ab, name))
    assert scaled.a.work == ab.a.work * 2.0 ** (length + force)


def test_resampling_changes_little_and_with_second_order():
    found = [compare(sampled(n), sampled(20001)) for n in (101, 201, 401)]
    errors = [f.curve_error for f in found]
    assert np.all(np.log2(np.divide(errors[:-1], errors[1:])) > 1.9) and errors[-1] < 3e-5
    assert abs(found[-1].peak_difference) < 1e-4 and abs(found[-1].energy_difference) < 1e-5


def test_a_snap_back_drops_vertically():
    """A stepped curve, as displacement control shows it, is the envelope of the path that snaps back."""
    snap = np.array([0.0, 1.0, 0.5, 1.5, 3.0]), np.array([0.0, 2.0, 1.0, 2.0, 0.5])
    step = np.array([0.0, 1.0, 1.0, 1.5, 3.0]), np.array([0.0, 2.0, 1.5, 2.0, 0.5])
    found = compare(snap, step)
    assert found.curve_error == pytest.approx(0.0, abs=1e-15) and found.peak_difference == 0.0
    # the work differs by what lies between the drop and the loop: 0.5 [(2 + 1) / 2 - (1 + 1.5) / 2]
    assert found.b.work - found.a.work == pytest.approx(0.5 * (1.5 - 1.25))


@pytest.mark.parametrize("reference", ["snap-back", "drop"])
def test_a_snap_back_is_compared_where_the_reference_has_one(reference):
    d, P = np.array([0.0, 1.0, 0.9, 0.6, 1.0, 2.0]), np.array([0.0, 4.0, 3.3, 1.2, 2.0, 4.0])
    known = (d, P) if reference == "snap-back" else (d[[0, 1, 4, 5]] + [0.0, 0.0, 1e-9, 0.0], P[[0, 1, 4, 5]])
    wrong = compare((d, np.where(d == 0.9, 0.1, P)), known)
    assert broken(wrong, 1e-3) & {"farthest-point", "curve-error"} == ({"farthest-point"} if known[0] is d else set())


def test_only_the_part_up_to_the_end_counts():
    d, P = sampled(300)
    off = np.where(d > 1.5, 0.5 * P, P)
    assert compare((d, off), (d, P), 1.2).curve_error == 0.0 < 0.1 < compare((d, off), (d, P)).curve_error
    early = compare((d, P), (d, P), 0.2)
    assert early.b.peak_opening == 0.2 and early.b.work == pytest.approx(0.5 * np.log((0.1 + 0.2**2) / 0.1), rel=1e-3)
    loop = np.array([0.0, 2.0, 0.5, 3.0]), np.array([0.0, 2.0, 0.0, 1.0])
    first = compare(loop, loop, 1.5).a
    assert (first.peak_opening, first.peak_load, first.work) == (1.5, 1.5, 1.125), "until it first comes there"
    assert compare(loop, loop, 2.5).a.work == pytest.approx(2.0 - 1.5 + 0.5 * 2.0 * 0.8)


#: A drop upon which a sample falls, which an opening over the range of the comparison misses by its last digit.
DROP = (
    (np.array([0, 0, 0, 0, 3.0]), np.array([0, 1, 1, 1, 1.0])),
    (np.array([0, 1, 2, 2.9, 2.9, 3.0]), np.array([0, 1, 1, 1, 2, 1.0])),
)


@given(paths(), paths(), st.floats(0.05, 2.5))
@example(*DROP, 2.0)
def test_the_beginning_only_takes_part_of_the_whole(a, b, begin):
    """The loads are those of the whole curves, whatever the paths did before, and so is the wave."""
    found, whole = compare(a, b, begin=begin), compare(a, b, begin=0.0)
    assert whole.curve_error == compare(a, b).curve_error and (whole.begin, found.begin) == (0.0, begin)
    for loads, part in ((found.load_a_n, a), (found.load_b_n, b)):
        assert loads == pytest.approx(load_at(part, found.opening_n), rel=1e-9, abs=1e-9)
    error = np.linalg.norm(found.load_a_n - found.load_b_n) / np.linalg.norm(found.load_b_n)
    assert found.curve_error == pytest.approx(error, rel=1e-9, abs=1e-12)
    np.testing.assert_equal(found.oscillation_rms, whole.oscillation_rms)
    assert found.a.peak_load <= whole.a.peak_load + 1e-12


@given(st.floats(1e-30, 1e30))
def test_a_curve_that_stops_early_is_not_close(last):
    """And the end that is proposed can be used."""
    d, P = sampled(300)
    half = d < 1.5
    part, whole = (last * d[half], P[half]), (last * d, P)
    found = compare(part, whole)
    assert found.curve_error < 1e-5 and found.end == part[0][-1] and checks(found) == []
    assert broken(found, 0.01, 0.01) == {"end"}
    (words,) = remarks(found)
    assert words.startswith(f"A ends at the opening {part[0][-1]:.6g}, before {whole[0][-1]:.6g}; an end of ")
    end = float(words.split("an end of ")[1].split()[0])
    assert not broken(compare(part, whole, end), 0.01)


def test_the_end_may_be_missed_by_a_part_of_the_tolerance():
    d, P = sampled(400)
    early = compare((np.append(d[:-1], 2.9999), np.append(P[:-1], bond(2.9999))), (d, P))
    assert not broken(early, 0.005) and broken(early, 1e-4) == {"end"}


def test_a_beginning_that_is_left_out_is_an_error():
    d, P = sampled(3000)
    first = compare((d[50:], P[50:]), (d, P))
    assert first.curve_error < 1e-4 and remarks(first) == []
    late = compare((d[1000:], P[1000:]), (d, P))
    assert late.curve_error > 0.1 and "A begins at the opening 0.577" in remarks(late)[0]


def test_oscillation_needs_points_to_be_told_by():
    d = np.linspace(0, 3, 600)
    wave = bond(d) * (1 + 0.02 * np.sin(40 * d))
    assert compare((d, wave), (d, bond(d))).oscillation_rms == pytest.approx(0.02 / np.sqrt(2), rel=0.03)
    assert np.isnan(compare((d[::80], bond(d[::80])), (d, bond(d))).oscillation_rms)
    assert np.isnan(compare((d, wave), (d, bond(d)), 0.4).oscillation_rms)


def test_loads_at_openings_and_where_they_differ_most():
    d = np.linspace(0, 3, 601)
    bump = bond(d) - 0.2 * np.exp(-(((d - 1.2) / 0.05) ** 2))
    found = compare((d, bump), (d, bond(d)))
    assert found.worst == pytest.approx((1.2, bond(1.2) - 0.2, bond(1.2)), abs=2e-3)
    assert found.loads_at([0.5, 3.0]) == [(x, load_at((d, bump), x), load_at((d, bond(d)), x)) for x in (0.5, 3.0)]
    with pytest.raises(CurveError, match="at: must be > 0 and <= 3, the end of the comparison, got 3.1"):
        found.loads_at([3.1])


def loop(unloaded: float = 0.2, slope: float = 1.0, n: int = 200):
    """Up to 1.5, along a line towards the origin and back, and on to 3."""
    up, down, back = np.linspace(0, 1.5, n), np.linspace(1.5, unloaded, n)[1:], np.linspace(unloaded, 3.0, 2 * n)[1:]
    secant = bond(1.5) / 1.5
    loads = bond(up), bond(1.5) - slope * secant * (1.5 - down), np.where(back < 1.5, secant * back, bond(back))
    return np.concatenate((up, down, back)), np.concatenate(loads)


RISES = ([0, 1], [0, 1])
SMALL = loop(unloaded=1.47)
MUST_TURN = "programme: B must turn, and end, at 1.5, 0.2, 3; it does not where unloading"


@pytest.mark.parametrize(
    ("a", "b", "options", "words"),
    [
        (RISES, ([2, 3], [1, 1]), {}, "A and B: must have openings in common, got 0 to 1 and 2 to 3"),
        (([2, 3], [1, 1]), ([0, 3], [0, 1]), {"end": 1.5}, "must have openings in common, got 2 to 3 and 0 to 1.5"),
        (RISES, ([0, 1], [0, -1]), {}, "B: the loads up to 1 must go above 0, got at most 0"),
        (RISES, RISES, {"end": 1.1}, "end: must be > 0 and <= 1, the last opening of B, got 1.1"),
        (RISES, RISES, {"end": 0.0}, "end: must be > 0 and <= 1"),
        (SMALL, SMALL, {"programme": (1.5, 0.2, 3.0)}, MUST_TURN),
        (SMALL, SMALL, {"programme": (1.5, 1.5)}, "programme: must be openings, each different from the one before it"),
        (SMALL, SMALL, {"programme": ()}, "programme: must be openings, each different"),
        (SMALL, SMALL, {"programme": (1.5, 1.47, 3.0), "end": 2.0}, "must be left out with a begin or an end"),
    ],
)
def test_what_cannot_be_compared(a, b, options, words):
    a, b = ((np.array(d, float), np.array(P, float)) for d, P in (a, b))
    with pytest.raises(CurveError, match=words):
        compare(a, b, **options)


def test_words_name_every_broken_tolerance():
    d, P = sampled(200)
    found = compare((d, 1.05 * P), (d, P))
    said = checks(found, 0.01, 0.1, 0.02)
    assert complaints(found, said) == [
        "curve error 5 %, more than 1 %",
        "energy differs by 5 %, more than 2 %",
        "distance of the farthest point of A, at opening 1.90466, from B: 4.762 %, more than 4 %",
    ]
    lines = table(found, [(1.0, 1.05, 1.0)], said)
    assert [line.split("  ")[0] for line in lines if "FAILS" in line][:2] == ["curve error", "energy"]
    assert any(line.startswith("load at 1 ") and line.endswith("+5 %") for line in lines)


def test_an_unloading_is_compared_leg_by_leg():
    """Where B is seen to unload; its envelope alone says nothing of it."""
    found = compare(loop(slope=1.1, n=150), loop())
    assert [leg.words[:11] for leg in found.legs] == ["loading fro", "unloading f", "reloading f"]
    assert found.curve_error < 1e-3 and found.legs[1].slope == pytest.approx(0.1, abs=1e-6)
    assert found.legs[1].residual == pytest.approx(1.0 / 11.0, abs=1e-6)  # 1.5 - 1.5 / 1.1, over 1.5
    legs = {"curve-leg-2", "slope-leg-2", "residual-leg-2", "loop-leg-2"}
    assert legs <= broken(found, 0.005) and "curve-error" not in broken(found, 0.005)
    assert not broken(compare(loop(n=150), loop()), 0.005)
    text = "The secant stiffness of leg 2, unloading from 1.5 to 0.2 (relative difference): 10 %, more than 0.5 %"
    assert text in complaints(found, checks(found, 0.005))
    assert any(line.startswith("leg 2, unloading from 1.5 to 0.2 ") for line in table(found, (), []))
    d = np.linspace(0, 3, 400)
    assert broken(compare((d, bond(d)), loop()), 0.005) == {"legs"}
    assert not broken(compare(loop(), (d, bond(d))), 0.005), "B does not ask for it"
    # an unloading of 2 % is too small to be told from the steps of a snap-back
    assert len(compare(loop(), loop(), programme=(1.5, 0.2)).legs) == 2
    assert compare(SMALL, SMALL).legs == () and len(compare(SMALL, SMALL, programme=(1.5, 1.47, 3.0)).legs) == 3


@pytest.mark.parametrize("at", [0.05, 0.3, 1.2, 2.5])
def test_a_single_point_that_is_far_off_fails(at):
    d, P = sampled(400)
    spiked = P * np.where(np.arange(400) == np.argmin(np.abs(d - at)), 1.08, 1.0)
    assert "farthest-point" in broken(compare((d, spiked), (d, P)), 0.01)
    assert not broken(compare((1.005 * d, P), (d, P)), 0.01, 0.01), "all of it a little later is no such point"
