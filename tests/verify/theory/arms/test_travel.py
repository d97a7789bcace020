"""The way of jumps on a step: with a crack that runs on, or straight."""

import numpy as np
import pytest

from verify.theory.arms.interface import way

X = np.linspace(0.0, 10.0, 401)


def jumps(front: float) -> tuple[np.ndarray, np.ndarray]:
    """Progress (q,), 0 at onset, and jumps (q, 2) behind the front of a crack."""
    behind = np.maximum(front - X, 0.0)
    return behind - 0.2, np.stack([behind**1.5, 2.0 * behind], axis=1)


@pytest.mark.parametrize("loaded", ["left", "right"])
def test_points_have_the_jumps_of_those_behind_them_one_after_the_other(loaded):
    turned = slice(None) if loaded == "left" else slice(None, None, -1)
    order = np.random.default_rng(3).permutation(X.size)
    (r0, v0), (r1, v1), (_, middle) = (jumps(front) for front in (4.0, 5.0, 4.5))
    found = way(X[turned][order], (r0[order], r1[order]), (v0[order], v1[order]))
    assert found(0.0) == pytest.approx(v0[order], abs=1e-12) and found(1.0) == pytest.approx(v1[order], abs=1e-12)
    within = X[order] > 1.0  # the profile ends at X = 0
    assert np.abs(found(0.5) - middle[order])[within].max() < 5e-3 < np.abs(0.5 * (v0 + v1) - middle).max()


def test_jumps_without_a_front_that_has_run_change_evenly():
    (r0, v0), (r1, v1) = (jumps(0.05), jumps(0.15))
    for reached, ends in (((r0, r1), (v0, v1)), ((r0 + 9.0, r1 + 9.0), (v0, 2.0 * v1))):
        assert way(X, reached, ends)(0.25) == pytest.approx(0.75 * ends[0] + 0.25 * ends[1], abs=1e-12)
