"""Zones of the arm and the mesh on them: they cover it from end to end, and their ends are where the field says."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from verify.theory.beam.arm import Arm, V
from verify.theory.beam.collocation import Field
from verify.theory.beam.zones import (
    BARE,
    CONTACT,
    ELASTIC,
    FREE,
    OPEN,
    SMALLEST_WAVE,
    SOFTENING,
    Ends,
    Foundation,
    Zones,
    _graded,
    _last_above,
    _root,
    _waves,
    find,
    mesh,
)
from verify.theory.law import Bilinear

ARM = Arm(0.3, 0.1, finite=False)
LAW = Bilinear(strength=2.0, toughness=0.5, ductility=5.0, penalty=1e3, contact=True)
BASE = Foundation.of(LAW, width=3.0, h=0.2, bending=80.0, arms=2)


def test_what_is_untouched_is_bare_free_and_elastic() -> None:
    zones = Ends(4.0, 14.0, edge=1.0).untouched()
    assert zones.bound.tolist() == [0.0, 1.0, 4.0, 14.0] and zones.kind.tolist() == [BARE, FREE, ELASTIC]
    zones = Ends(4.0, 14.0).untouched()
    assert zones.bound.tolist() == [0.0, 4.0, 14.0] and zones.kind.tolist() == [FREE, ELASTIC], "no edge, nothing bare"


def test_a_foundation_is_the_law_in_units_of_the_arm() -> None:
    """The force of a zone, c + k v, is the traction of the gap 2 h v over h / EI and w h^2."""
    g = {FREE: 0.3, OPEN: 0.9, SOFTENING: 0.25, ELASTIC: 0.05, CONTACT: -0.01, BARE: 0.3}
    for kind, gap in g.items():
        v = gap / (2 * 0.2)
        k, c, beneath = BASE.on[kind]
        traction = 0.0 if kind in (FREE, OPEN, BARE) else float(LAW.traction(np.array(gap)))
        assert c + k * v == pytest.approx(traction * 3.0 * 0.2**3 / 80.0, rel=1e-12, abs=1e-18), kind
        assert beneath == (kind != BARE)
    assert (BASE.v_peak, BASE.v_open) == pytest.approx((LAW.g_peak / 0.4, LAW.g_open / 0.4))
    soft = Foundation.of(Bilinear(2.0, 0.5, 5.0, 1e3, contact=False), 3.0, 0.2, 80.0, 2)
    assert soft.k[CONTACT] == soft.k[ELASTIC] == BASE.k[ELASTIC] < BASE.k[CONTACT]
    assert BASE.closing(7.0).k[CONTACT] == 7.0 and np.array_equal(np.delete(BASE.closing(7.0).k, CONTACT),
                                                                  np.delete(BASE.k, CONTACT))  # fmt: skip


@given(st.floats(1e-4, 10.0), st.floats(1e-3, 1e3))
def test_elements_of_a_zone_fill_it_and_at_most_double(first: float, length: float) -> None:
    right = _graded(first, length)
    sizes = np.diff(right, prepend=0.0) * length
    assert right[-1] == pytest.approx(1.0) and np.all(sizes > 0.0)
    assert sizes == pytest.approx(sizes[::-1]), "both ends are alike"
    assert sizes[0] <= first * (1.0 + 1e-9) and np.all(sizes[1:] / sizes[:-1] <= 2.0 + 1e-9)
    assert sizes[0] >= 0.25 * min(first, length), "nor are there many more than are needed"


@given(st.lists(st.floats(0.01, 5.0), min_size=2, max_size=6), st.floats(0.0, 10.0))
def test_a_mesh_has_the_ends_of_the_zones_as_its_nodes(lengths: list[float], force: float) -> None:
    bound = np.append(0.0, np.cumsum(lengths))
    zones = Zones(bound, np.resize([FREE, SOFTENING, ELASTIC, CONTACT], len(lengths)))
    x, kind = mesh(ARM, BASE, zones, force)
    assert x[0] == 0.0 and x[-1] == bound[-1] and np.all(np.diff(x) > 0.0) and len(kind) == len(x) - 1
    assert set(bound) <= set(x)
    middle = 0.5 * (x[1:] + x[:-1])
    assert np.array_equal(kind, zones.kind[np.searchsorted(bound, middle) - 1])


def field(v, x: np.ndarray) -> Field:
    """A field with the deflection v(x); rotation and forces such that v' is what the arm makes of them."""
    made = Field.zero(x, 4)
    for at, into in ((x, made.node), (made.stage_x, made.stage)):
        into[..., V], into[..., 1] = v(at), (v(at + 1e-7) - v(at - 1e-7)) / 2e-7
    return made


def test_zones_are_found_where_the_gap_passes_its_levels() -> None:
    """A gap that falls through g_u at 5, through g_max at 8, and alternates beyond: there zones end."""
    ends, x = Ends(4.0, 20.0, edge=1.0), np.linspace(0.0, 20.0, 81)
    high, low = BASE.v_open, BASE.v_peak

    def v(at: np.ndarray) -> np.ndarray:
        falling = high + (low - high) * (at - 5.0) / 3.0
        return np.where(at < 8.0, falling, low * np.exp((8.0 - at) / 8.0) * np.cos(np.pi * (at - 8.0) / 6.0))

    kind = np.where(x[1:] <= 4.0, FREE, ELASTIC)
    zones = find(ARM, BASE, field(v, x), kind, ends, None)
    assert zones.kind.tolist() == [BARE, FREE, OPEN, SOFTENING, ELASTIC, CONTACT, ELASTIC]
    assert zones.bound == pytest.approx([0.0, 1.0, 4.0, 5.0, 8.0, 11.0, 17.0, 20.0], abs=1e-3)
    held = find(ARM, BASE, field(v, x), kind, ends, 9.0)
    assert held.bound == pytest.approx([0.0, 1.0, 4.0, 5.0, 9.0, 11.0, 17.0, 20.0], abs=1e-3), "a front that is told"
    plain = find(ARM, replace(BASE, contact=False), field(v, x), kind, ends, None)
    assert plain.kind.tolist() == [BARE, FREE, OPEN, SOFTENING, ELASTIC], "without contact signs do not matter"


def test_a_root_is_that_of_the_cubic() -> None:
    for root in (0.1, 0.5, 0.93):
        x = np.array([2.0, 4.0])
        at = 2.0 + 2.0 * root

        def cubic(t: np.ndarray, at: float = at) -> np.ndarray:
            return (at - t) * (1.0 + 0.2 * (t - 3.0) ** 2)

        slope = np.array([(cubic(t + 1e-6) - cubic(t - 1e-6)) / 2e-6 for t in x])
        assert _root(x, cubic(x), slope) == pytest.approx(at, abs=1e-8)
    assert _root(np.array([0.0, 1.0]), np.array([1.0, 0.0]), np.array([0.0, -4.0])) == pytest.approx(1.0, abs=1e-12)


def test_the_last_place_above_a_level_stays_between_its_ends() -> None:
    x = np.linspace(0.0, 10.0, 11)
    v, slope = 5.0 - x, np.full(11, -1.0)
    assert _last_above(x, v, slope, 2.5, 1.0, 9.0) == pytest.approx(2.5)
    assert _last_above(x, v, slope, 2.5, 3.0, 9.0) == 3.0 and _last_above(x, v, slope, 2.5, 1.0, 2.2) == 2.2
    assert _last_above(x, v, slope, -9.0, 1.0, 10.0) == 10.0 and _last_above(x, v, slope, 7.0, 1.0, 9.0) == 1.0
    assert _last_above(x, v, slope, 3.0, 0.0, 9.0) == pytest.approx(2.0), "a level that is met at a sample"


def test_waves_are_sought_behind_the_front_alone() -> None:
    """Ends of contact are where the gap changes its sign; of waves that are too small none is kept."""
    x = np.linspace(0.0, 10.0, 41)
    v, slope = np.cos(x), -np.sin(x)
    strong = np.ones(41)
    roots = np.pi * np.array([0.5, 1.5, 2.5])
    assert _waves(x, v, slope, 0.0, 0, strong) == pytest.approx(roots, abs=1e-4)
    assert _waves(x, v, slope, 2.0, 0, strong) == pytest.approx(roots[1:], abs=1e-4)
    assert _waves(x, v, slope, 9.75, 0, strong) == _waves(x, v, slope, 10.0, 0, strong) == []
    new, followed = SMALLEST_WAVE
    assert followed < new
    for part, number in ((1.01 * new, 3), (0.99 * new, 0)):
        assert len(_waves(x, v, slope, 0.0, 0, part * strong)) == number
    for part, number in ((1.01 * followed, 2), (0.99 * followed, 0)):
        assert len(_waves(x, v, slope, 0.0, 2, part * strong)) == number
    fading = np.where(x < 6.0, 1.0, 0.5 * followed)
    assert _waves(x, v, slope, 0.0, 3, fading) == pytest.approx(roots[:2], abs=1e-4), "nothing is left behind the third"
