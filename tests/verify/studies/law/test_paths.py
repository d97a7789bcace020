"""Displacement paths: where they begin and end, and that their steps are fine enough for exact energies."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from made_up_point_laws import BONDS

from verify.studies.law.laws import of_bond
from verify.studies.law.paths import PRESSURES, paths

each = pytest.mark.parametrize("bond", BONDS.values(), ids=BONDS)


@each
def test_paths_begin_at_rest_with_names_of_their_own(bond):
    ways = paths(bond)
    assert len({way.name for way in ways}) == len(ways) == 27
    for way in ways:
        assert way.g[0] == way.s[0] == 0.0 and np.isfinite([way.g, way.s]).all() and way.g.shape == way.s.shape
        assert way.time[0] == 0.0 and way.time[-1] == 1.0
    assert sum(way.g.size for way in ways) < 2500


@each
@pytest.mark.parametrize("law", ["bilinear", "trapezoidal"])
def test_the_trapezoid_rule_is_exact_where_the_mode_ratio_is_constant(bond, law):
    bond = replace(bond, law=law)
    straight = [way for way in paths(bond) if way.ratio is not None]
    assert [way.ratio for way in straight] == [0.0, 1.0, 0.2, 0.5, 0.8]
    for way in straight:
        found = bond.path(way.g, way.s)
        assert found.d[-1] == 1.0
        assert of_bond(bond, way).work(way) == pytest.approx(bond.critical(way.ratio), rel=1e-9)


@each
def test_pressure_is_as_said_and_slides_to_failure(bond):
    pressed = [way for way in paths(replace(bond, pressure_strength=0.3)) if way.name in PRESSURES]
    assert len(pressed) == 3
    for way in pressed:
        known = bond.path(way.g, way.s)
        assert -known.p[-1] == pytest.approx(PRESSURES[way.name] * bond.strength[1]) and known.d[-1] == 1.0


def test_without_shear_nothing_slides():
    ways = paths(BONDS["moose"], shear=False)
    assert [way.name for way in ways] == ["mode-I", "unload-reload-I", "contact", "far-I", "zero"]
    assert all((way.s == 0.0).all() for way in ways)


def test_either_side_of_closed_is_next_to_it():
    (way,) = [way for way in paths(BONDS["as4-peek"]) if way.name == "closed-either-side"]
    onset = BONDS["as4-peek"].strength[0] / BONDS["as4-peek"].stiffness[0]
    sides = [5e-324, 2.0**-52 * onset, 1e-9 * onset]
    assert np.unique(way.g) == pytest.approx([*(-one for one in sides[::-1]), 0.0, *sides], rel=1e-12, abs=0.0)
    assert (way.g != 0.0).sum() == 6 * (np.unique(way.s).size - 1)


def test_a_turned_frame_is_a_turned_sign_and_no_other_change():
    bond, ways = BONDS["compdam"], {way.name: way for way in paths(BONDS["compdam"])}
    turned, straight = ways["turned-frame"], ways["mixed-50"]
    assert (np.abs(turned.s) == straight.s).all() and (turned.g == straight.g).all() and turned.s.min() < 0.0
    known = [bond.path(way.g, way.s).d for way in (turned, straight)]
    assert np.array_equal(*known)
