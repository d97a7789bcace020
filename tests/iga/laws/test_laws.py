"""The traction laws: their shape, their history, their energies and their tangent; what holds of every one of them."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from made_up_laws import MADE_UP, answer, energies

from iga.laws.law import Law
from iga.laws.laws import LAWS, ExponentialLaw, ShapedLaw

LAW = ShapedLaw.opening(strength=4.0, toughness=0.1, ductility=12.5, penalty=1e5)
#: A table takes its numbers from itself; `BridgedLaw` stands for it.
EVERY = {name: law for name, law in {**LAWS, **MADE_UP}.items() if name != "tabular"}

#: Gauss points on a piece of a branch: exact for polynomials up to degree 39.
POINTS = np.polynomial.legendre.leggauss(20)


@st.composite
def laws(draw, **fixed):
    law = draw(st.sampled_from(list(EVERY.values())))
    size = {"strength": draw(st.floats(0.1, 100.0)), "toughness": draw(st.floats(1e-3, 10.0))}
    return law.opening(**size, ductility=draw(st.floats(1.01, 1e3)), penalty=draw(st.floats(1.0, 1e8)), **fixed)


def walk(law: Law, gaps: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Tractions along a path of gaps and the history after each, committed as it goes."""
    p, k = np.zeros_like(gaps), np.zeros_like(gaps)
    now = np.zeros(1)
    for i, g in enumerate(gaps):
        p[i : i + 1], _, now = answer(law, np.array([g]), now)
        k[i] = now[0]
    return p, k


def integral(function, start: float, end: float) -> float:
    """Of a function of gaps (n,) over a piece without kinks."""
    s, w = POINTS
    return float(0.5 * (end - start) * (w @ function(0.5 * (start + end) + 0.5 * (end - start) * s)))


@given(laws())
def test_an_envelope_rises_along_a_line_to_the_strength_and_falls_to_nothing(law):
    k = np.linspace(0.0, 1.5 * law.g_u, 301)
    p = law.envelope(k)
    assert np.all(p >= 0.0) and np.all(p <= law.pure_modes[0][0] * (1.0 + 1e-12))
    assert np.allclose(p[k <= law.g_max], law.stiffness[0] * k[k <= law.g_max], rtol=1e-12)
    assert np.all(np.abs(p[k >= law.g_u]) < 1e-12 * law.pure_modes[0][0])
    if not isinstance(law, ExponentialLaw):
        assert np.isclose(law.envelope(np.array(law.g_max)), law.pure_modes[0][0], rtol=1e-12)


@given(laws())
def test_the_work_is_the_area_of_the_envelope_and_in_the_end_the_toughness(law):
    spent, corners = 0.0, (0.0, *law.kinks, 1.5 * law.g_u)
    for start, end in zip(corners[:-1], corners[1:], strict=True):
        spent += integral(law.envelope, start, end)
        assert np.isclose(law.work(np.array(end)), spent, rtol=1e-9)
    assert np.isclose(law.work(np.array(3.0 * law.g_u)), law.pure_modes[0][1], rtol=1e-12)


@given(laws(), st.floats(0.01, 0.99))
def test_kinks_divide_the_envelope_into_smooth_branches(law, part):
    kinks = law.kinks
    assert kinks[0] == law.g_max and kinks[-1] == law.g_u and np.all(np.diff(kinks) > 0.0)
    for start, end in zip(kinks[:-1], kinks[1:], strict=True):
        k, h = np.array(start + part * (end - start)), 1e-4 * min(part, 1.0 - part) * (end - start)
        difference = (law.envelope(k + h) - law.envelope(k - h)) / (2.0 * h)
        ((p, _),), (_, (slope,), _) = law.pure_modes, answer(law, k[None], np.zeros(1))
        assert np.isclose(slope, difference, rtol=1e-6, atol=1e-6 * p / (law.g_u - law.g_max))


@given(laws(), st.lists(st.floats(-0.5, 1.5), min_size=1, max_size=12))
def test_work_done_is_stored_or_dissipated(law, path):
    """Whatever the path of gaps: the integral of p dg is the energy kept plus the energy lost, which never falls."""
    stops = np.concatenate([[0.0], np.array(path) * law.g_u])
    spent, lost_before, k = 0.0, 0.0, np.zeros(1)
    for start, end in zip(stops[:-1], stops[1:], strict=True):
        inner = [c for c in (0.0, *law.kinks, k[0]) if min(start, end) < c < max(start, end)]
        legs = np.array(sorted([start, *inner, end], reverse=bool(end < start)))
        for a, b in zip(legs[:-1], legs[1:], strict=True):
            spent += integral(lambda g, k=k: answer(law, g, np.broadcast_to(k, g.shape))[0], a, b)
            k = np.maximum(k, b)
    cohesive, contact, lost = (float(e[0]) for e in energies(law, stops[-1:], k))
    scale = law.pure_modes[0][1] + 0.5 * law.penalty * np.max(stops**2)
    assert abs(spent - cohesive - contact - lost) < 1e-9 * scale
    assert lost >= lost_before - 1e-12 * law.pure_modes[0][1] and lost <= law.pure_modes[0][1] * (1 + 1e-12)


@pytest.mark.parametrize("shape", EVERY)
@pytest.mark.parametrize("irreversible", [True, False])
@pytest.mark.parametrize("contact", [True, False])
def test_tangent_is_the_derivative_of_the_traction(contact, irreversible, shape):
    law = EVERY[shape].opening(4.0, 0.1, 12.5, 1e5, contact, irreversible)
    gaps, held = np.array([-0.7, 0.3, 2.0, 2.9, 3.1, 5.0, 13.0]), np.array([0.0, 0.5, 3.0, 20.0])
    g, k, h = np.repeat(gaps, 4) * law.g_max, np.tile(held, 7) * law.g_max, 1e-6 * law.g_max
    _, slope, _ = answer(law, g, k)
    difference = (answer(law, g + h, k)[0] - answer(law, g - h, k)[0]) / (2 * h)
    assert np.allclose(slope, difference, rtol=1e-6, atol=1e-6 * law.stiffness[0])


@pytest.mark.parametrize("shape", EVERY)
def test_a_reversible_law_dissipates_nothing(shape):
    law = EVERY[shape].opening(4.0, 0.1, 12.5, 1e5, irreversible=False)
    p, k = walk(law, np.array([2 * law.g_u, 0.5 * law.g_u]))
    assert p[0] == 0.0 and p[1] == pytest.approx(float(law.envelope(np.array(0.5 * law.g_u))))
    cohesive, contact, lost = energies(law, np.array([0.5 * law.g_u]), k[1:])
    assert (
        lost[0] == 0.0 and contact[0] == 0.0 and cohesive[0] == pytest.approx(float(law.work(np.array(0.5 * law.g_u))))
    )


@pytest.mark.parametrize("shape", EVERY)
@pytest.mark.parametrize("irreversible", [True, False])
@pytest.mark.parametrize("contact", [True, False])
def test_the_traction_is_the_slope_of_what_is_stored(contact, irreversible, shape):
    """Open and closed, where nothing more is damaged: by central differences of cohesion and contact together."""
    law = EVERY[shape].opening(4.0, 0.1, 12.5, 1e3, contact, irreversible)
    g, h = law.g_u * np.array([-0.9, -0.3, -1e-3, 1e-3, 0.03, 0.3, 0.6]), 1e-7 * law.g_u

    def stored(g):
        k = np.full_like(g, 0.7 * law.g_u) if irreversible else np.maximum(g, 0.0)
        return sum(energies(law, g, k)[:2])

    p = answer(law, g, np.full_like(g, 0.7 * law.g_u))[0]
    assert (stored(g + h) - stored(g - h)) / (2.0 * h) == pytest.approx(p, rel=1e-5, abs=1e-6 * law.pure_modes[0][0])
    assert np.all(stored(g) > 0.0) and np.all(p[:3] < 0.0)


NUMBERS = {"strength": 4.0, "toughness": 0.1, "ductility": 12.5, "penalty": 1e5}


@pytest.mark.parametrize("law", [ShapedLaw, LAWS["exponential-softening"], ExponentialLaw])
@pytest.mark.parametrize(("key", "value"), [*zip(NUMBERS, (-4.0, 0.0, 0.5, -1.0), strict=True), ("penalty", np.nan)])
def test_numbers_out_of_their_ranges_are_refused(law, key, value):
    with pytest.raises(ValueError, match=f"{key}: must be > . and finite, got {value}"):
        law.opening(**NUMBERS | {key: value})


def test_a_table_is_the_law_of_its_corners():
    bridged = MADE_UP["bridged"].opening(4.0, 0.1, 12.5, 1e5)
    kinks = np.array(bridged.kinks)
    law, g, k = (
        LAWS["tabular"].opening(1.0, 1.0, 2.0, 1e5, table=tuple(zip(kinks, bridged.envelope(kinks), strict=True))),
        np.linspace(-0.1, 0.2, 99),
        0.03,
    )
    assert law.pure_modes == (pytest.approx((4.0, 0.1)),) and law.g_max == pytest.approx(0.004)
    for ours, theirs in zip(answer(law, g, np.full(99, k)), answer(bridged, g, np.full(99, k)), strict=True):
        assert np.allclose(ours, theirs, rtol=1e-12)


@pytest.mark.parametrize(
    ("table", "words"),
    [
        ((), "two or more pairs"),
        (((0.1, 1.0),), "two or more pairs"),
        (((0.1, 1.0), (float("nan"), 0.0)), "two or more pairs"),
        (((0.0, 1.0), (0.1, 0.0)), "must rise from above zero"),
        (((0.2, 1.0), (0.1, 0.0)), "must rise from above zero"),
        (((0.1, 1.0), (0.2, 0.5)), "the last one 0"),
        (((0.1, 1.0), (0.2, 2.5), (0.4, 0.0)), "must fall from corner to corner"),
    ],
)
def test_a_table_that_is_no_law_is_refused(table, words):
    with pytest.raises(ValueError, match=words):
        LAWS["tabular"].opening(1.0, 1.0, 2.0, 1e5, table=table)
