"""Lines of a mesh on the page: every side once, in as few strokes as go straight on."""

from __future__ import annotations

import numpy as np
import pytest

pytest.importorskip("matplotlib")

from verify.pages.strokes import sides, strokes  # noqa: E402


def grid(n: int, m: int, samples: int = 4) -> np.ndarray:
    """Sampling grids of n x m elements on [0, n] x [0, m]."""
    k = np.linspace(0.0, 1.0, samples)
    i, j = (one.ravel() for one in np.meshgrid(np.arange(n), np.arange(m), indexing="ij"))
    x, y = np.broadcast_arrays(i[:, None, None] + k[:, None], j[:, None, None] + k)
    return np.stack([x, y], axis=-1)


def bent(x_euvi: np.ndarray) -> np.ndarray:
    """The grid around a quarter of a circle, so that sides meet at round-off and are curved."""
    angle, radius = 0.1 * x_euvi[..., 0], 20.0 + x_euvi[..., 1]
    return np.stack([radius * np.sin(angle), radius * np.cos(angle)], axis=-1)


def parts(points: np.ndarray) -> list[np.ndarray]:
    """The strokes, each without what follows it."""
    cuts = np.flatnonzero(np.isnan(points[:, 0]))
    return [part[~np.isnan(part[:, 0])] for part in np.split(points, cuts) if len(part) > 1]


@pytest.mark.parametrize("shape", [lambda x: x, bent])
def test_each_side_is_drawn_once_and_lines_go_from_edge_to_edge(shape) -> None:
    found = sides(shape(grid(7, 3)))
    assert found.shape == (7 * 4 + 3 * 8, 4, 2)
    drawn = parts(strokes(found))
    assert sorted(len(line) for line in drawn) == 8 * [3 * 3 + 1] + 4 * [7 * 3 + 1]
    length = sum(np.linalg.norm(np.diff(line, axis=0), axis=1).sum() for line in drawn)
    assert length == pytest.approx(np.linalg.norm(np.diff(found, axis=1), axis=2).sum(), rel=1e-12)


def test_no_point_is_lost_whatever_the_order_and_the_direction_of_the_lines() -> None:
    rng = np.random.default_rng(3)
    found = sides(bent(grid(6, 4)))
    mixed = rng.permutation(found)
    mixed[::2] = mixed[::2, ::-1]
    expected, got = (np.unique(np.round(np.reshape(x, (-1, 2)), 9), axis=0) for x in (found, parts_joined(mixed)))
    assert np.array_equal(expected, got) and len(parts(strokes(mixed))) == 7 + 5


def parts_joined(lines_nki: np.ndarray) -> np.ndarray:
    return np.concatenate(parts(strokes(lines_nki)))


def test_a_line_stops_at_a_corner_and_a_ring_closes() -> None:
    corner = np.array([[[0.0, 0.0], [1.0, 0.0]], [[1.0, 0.0], [1.0, 1.0]]])
    assert len(parts(strokes(corner))) == 2
    angle = np.linspace(0.0, 2.0 * np.pi, 25)
    ring = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    (drawn,) = parts(strokes(np.stack([ring[:-1], ring[1:]], axis=1)))
    assert len(drawn) == 25 and np.allclose(drawn[0], drawn[-1])


def test_at_a_t_junction_the_long_side_and_both_short_ones_are_drawn() -> None:
    long = np.array([[0.0, 0.0], [2.0, 0.0]])
    short = np.array([[[0.0, 0.0], [1.0, 0.0]], [[1.0, 0.0], [2.0, 0.0]], [[1.0, 0.0], [1.0, 1.0]]])
    drawn = parts(strokes(np.concatenate([long[None], short])))
    assert sorted(np.linalg.norm(line[-1] - line[0]) for line in drawn) == [1.0, 2.0, 2.0]


def test_nothing_is_drawn_of_nothing() -> None:
    assert strokes(np.zeros((0, 2, 2))).shape == (0, 2)


def test_sides_are_the_same_whichever_way_elements_go() -> None:
    """Three upright sides and four level ones of two elements, one of them turned by half."""
    k = np.linspace(0.0, 1.0, 3)
    x, y = np.meshgrid(k, k, indexing="ij")
    left = np.stack([x, y], axis=-1)
    right = left[::-1, ::-1] + [1.0, 0.0]
    found = sides(np.stack([left, right]))
    ends = {tuple(sorted((tuple(side[0]), tuple(side[-1])))) for side in found.tolist()}
    upright = {((float(x), 0.0), (float(x), 1.0)) for x in range(3)}
    level = {((float(x), float(y)), (x + 1.0, float(y))) for x in range(2) for y in range(2)}
    assert ends == upright | level and len(found) == 7
