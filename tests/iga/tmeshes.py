"""T-meshes for tests."""

import numpy as np

from iga.tsplines.tmesh import TMesh


def half_fine(n: int) -> TMesh:
    """The unit square, 2 n columns below the middle and n above it: T-junctions along the middle. ``n`` is even."""
    s = np.linspace(0.0, 1.0, 2 * n + 1)
    t = np.concatenate([np.linspace(0.0, 0.5, n + 1), np.linspace(0.5, 1.0, n // 2 + 1)[1:]])
    knots_s, knots_t = (np.concatenate([[0.0] * 3, x, [1.0] * 3]) for x in (s, t))
    up = np.ones((knots_s.size, knots_t.size - 1), dtype=bool)
    up[4:-4:2, np.searchsorted(knots_t, 0.5) :] = False
    return TMesh(knots_s, knots_t, np.ones((knots_s.size - 1, knots_t.size), dtype=bool), up)
