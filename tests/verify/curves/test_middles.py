"""The middles of steps: on the cubic of a step, with its ledger, and good for straight lines."""

from __future__ import annotations

import numpy as np
import pytest

from verify.curves.middles import Middles
from verify.result import CURVE_COLUMNS


def path(openings: np.ndarray) -> list[dict[str, float]]:
    """Rows of load = 3 d - d^3, whose work is 1.5 d^2 - d^4 / 4, half of it dissipated."""
    load, slope, work = 3 * openings - openings**3, 3 - 3 * openings**2, 1.5 * openings**2 - openings**4 / 4
    return [
        {
            "opening": d, "load": P, "crack_length": 4.0 + d, "stored_energy": 0.5 * W + 0.01,
            "dissipated_energy": 0.5 * W, "external_work": W, "newton_iterations": 3.0, "load_slope": s, "heading": 1.0,
        }
        for d, P, s, W in zip(openings, load, slope, work, strict=True)
    ]  # fmt: skip


def drawn(rows: list[dict[str, float]]) -> list[dict[str, float]]:
    between, found = Middles(), []
    for row in rows:
        middle = between(row)
        found += [middle, row] if middle is not None else [row]
    return found


def test_a_middle_is_on_the_curve_with_its_work_and_its_ledger() -> None:
    """A cubic in the plane of load and opening is of fourth order, and so is the work along it."""
    errors = []
    for steps in (10, 20):
        rows = drawn(path(np.linspace(0.0, 1.5, steps + 1)))
        middles = rows[1::2]
        assert len(rows) == 2 * steps + 1 and all(row["newton_iterations"] == 0.0 for row in middles)
        assert all(set(row) == set(CURVE_COLUMNS) for row in middles)
        d = np.array([row["opening"] for row in middles])
        assert np.allclose(d[2:], 1.5 * (np.arange(steps) + 0.5)[2:] / steps, atol=0.1 * 1.5 / steps)
        off = [np.array([row["load"] for row in middles]) - (3 * d - d**3)]
        off += [np.array([row["external_work"] for row in middles]) - (1.5 * d**2 - d**4 / 4)]
        errors.append([np.abs(one).max() for one in off])
        for row in middles:
            ledger = row["stored_energy"] + row["dissipated_energy"] - row["external_work"]
            assert ledger == pytest.approx(0.01, abs=1e-12)
    print(f"load and work off by {errors}")
    assert np.all(np.array(errors[0]) < (1e-3, 1e-5)) and np.all(np.array(errors[1]) < np.array(errors[0]) / 8)


def test_straight_lines_through_the_middles_are_a_quarter_as_far_off() -> None:
    at = np.linspace(0.0, 1.5, 1001)
    rows = path(np.linspace(0.0, 1.5, 11))
    with_, without = (
        np.abs(np.interp(at, [row["opening"] for row in one], [row["load"] for row in one]) - (3 * at - at**3)).max()
        for one in (drawn(rows), rows)
    )
    assert with_ < 0.3 * without


def test_a_middle_goes_back_with_the_path() -> None:
    """Unloading along a straight line, whose first row has the slope of its arrival."""
    top = {**path(np.array([1.0]))[0], "load_slope": -1.0}
    back = {**top, "opening": 0.5, "load": 1.0, "load_slope": 2.0, "heading": -1.0}
    between = Middles()
    assert between(top) is None
    middle = between(back)
    assert middle is not None and (middle["opening"], middle["load"]) == pytest.approx((0.75, 1.5), rel=1e-12)


def test_there_are_none_without_slopes() -> None:
    rows = [{name: value for name, value in row.items() if name != "load_slope"} for row in path(np.arange(3.0))]
    assert drawn(rows) == rows
