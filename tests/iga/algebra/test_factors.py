"""Solutions with a factorised tangent against differences of the forces, whatever factors it."""

from dataclasses import replace

import numpy as np
import pytest
from specimens import PAPER

from iga.algebra.banded import Band, BandCholesky, BandLU, Skew, number
from iga.algebra.dense import Dense, DenseCholesky, DenseLU
from iga.algebra.factors import Inverse, condition, inverse
from iga.dcb import build
from iga.path.follow import follow
from iga.path.point import Point
from iga.path.solver import Solver
from iga.system.system import factorise, respond, untimed

CZM1 = replace(PAPER, opening=(1.5,), dofs=400)


def growing(state):
    """The same state a little beyond its history: what softens goes on, and stands on no kink."""
    return replace(state, k_q=state.k_q * (1.0 - 1e-3))


def dense_tangent(system, response) -> np.ndarray:
    """The tangent (n_dof, n_dof) that is factorised, entry by entry."""
    pattern = system.pattern(response)
    band, (half, skew) = pattern.band, pattern.tangent(system.interface, response)
    i, j = np.indices((system.n_dof, system.n_dof))
    near = (np.abs(band.place_d[i] - band.place_d[j]) <= band.k) & (band.place_d[i] >= 0) & (band.place_d[j] >= 0)
    K = np.where(near, half[np.where(near, band.positions(i, j), 0)], 0.0)
    if skew is not None:
        np.add.at(K, (skew.row, skew.column), skew.value)
    return K


def solved(system, state, rng) -> tuple[object, float]:
    """The inverse of the tangent at a state, and how wrong that is against differences of the forces and LAPACK's LU.

    Each in parts of what is added up.
    """
    response = respond(system, state, decide=False)
    K, inverse = dense_tangent(system, response), factorise(system, response, system.pattern(response), untimed)
    v_d = np.where(system.free_d, rng.standard_normal(system.n_dof), 0.0)
    h = 1e-4 * system.interface.law.g_max / np.abs(v_d).max()
    ahead, behind = (
        respond(system, replace(state, u_d=state.u_d + s * h * v_d), decide=False).internal_d for s in (1, -1)
    )
    wrong = np.abs((ahead - behind) / (2 * h) - K @ v_d)[system.free_d].max() / (np.abs(K) @ np.abs(v_d)).max()
    b_d, free = rng.standard_normal(system.n_dof), np.flatnonzero(system.free_d)
    expected = np.linalg.solve(K[np.ix_(free, free)], np.stack([b_d, system.load_d], -1)[free]).T
    for x_d, exact in zip((inverse.solve(b_d[:, None])[:, 0], inverse.under_load_d), expected, strict=True):
        wrong = max(wrong, 1e-3 * np.abs(x_d[free] - exact).max() / np.abs(exact).max())
    return inverse, wrong


@pytest.mark.parametrize("kinematics", ["linear", "finite"])
def test_before_and_behind_the_peak_a_held_tangent_is_positive_definite(kinematics, rng):
    """Behind it the load falls: without the spring across the opening Cholesky finds no factor, and LU takes over."""
    system = build(replace(CZM1, kinematics=kinematics)).system
    points = [p for p in follow(Solver(system), (1.5,), 40) if isinstance(p, Point)]
    top = int(np.argmax([p.state.load for p in points]))
    falling = min(points, key=lambda point: point.slope)
    for point in (points[top // 2], points[-1], falling):
        inverse, wrong = solved(system, growing(point.state), rng)
        assert isinstance(inverse.factors, BandCholesky) and wrong < 1e-8
    response = respond(system, growing(falling.state), decide=False)
    pattern = system.pattern(response)
    half, _ = pattern.tangent(system.interface, response)
    free = np.ix_(pattern.band.dof_n, pattern.band.dof_n)
    known = np.linalg.cond(dense_tangent(system, response)[free], 1)
    assert condition(pattern.band, half, None, inverse) == pytest.approx(known, rel=0.5)
    assert pattern.band.cholesky(half.copy()) is None
    system.__dict__["hold"] = 0.0  # kept, as the property would be
    other, wrong = solved(system, growing(falling.state), rng)
    assert isinstance(other.factors, BandLU) and wrong < 1e-8
    assert np.allclose(other.under_load_d, inverse.under_load_d, rtol=0, atol=1e-6 * np.abs(other.under_load_d).max())


def test_points_that_slide_off_make_the_tangent_skew(rng):
    """The lower half alone would not tell it: solutions with it are no solutions."""
    system = build(CZM1).system
    upper = np.unique(system.interface.conn_qa)
    u_Ai = np.zeros((system.n_dof // 2, 2))
    side = 0.2 * np.diff(system.interface.X_qi[:, 0]).max()
    reached = None
    for part in np.linspace(0.5, 6.0, 23):
        u_Ai[:] = 0.0
        u_Ai[upper] = [part * side, 0.2 * system.interface.law.g_max]
        state = replace(system.start(), u_d=u_Ai.ravel())
        if respond(system, state, decide=False).contact.fading_q.any():
            reached = state
            break
    assert reached is not None, "nothing slides off"
    inverse, wrong = solved(system, reached, rng)
    assert isinstance(inverse.factors, BandLU) and wrong < 1e-8


@pytest.mark.parametrize("k", [0, 1, 5])
def test_banded_solvers_are_dense_ones(k, rng):
    n = 12
    places = np.append(rng.permutation(n), -1)
    band = Band(places, n, k)
    i, j = np.tril_indices(n)
    near = i - j <= k
    i, j = i[near], j[near]
    name = np.argsort(places[:n])  # degree of freedom of each equation
    value = rng.standard_normal(i.size) + 6.0 * (i == j)
    half = np.bincount(band.positions(name[j], name[i]), value, band.size)
    dense = np.zeros((n, n))
    dense[i, j] = dense[j, i] = value
    b_d = np.append(rng.standard_normal(n), 3.0)

    def expected(A):
        return np.append(np.linalg.solve(A, b_d[name])[places[:n]], 0.0)

    for factors in (band.cholesky(half.copy()), band.lu(half)):
        assert np.allclose(factors.solve(b_d[:, None])[:, 0], expected(dense), rtol=0, atol=1e-12)
    assert np.allclose(band.columns(half), np.abs(dense).sum(0), rtol=1e-14)
    known = pytest.approx(np.linalg.cond(dense, 1), rel=0.5)
    assert condition(band, half, None, inverse(band, half, None, b_d)) == known
    assert condition(band, half, None, Inverse(band.cholesky(half.copy()), b_d)) == known
    assert band.cholesky(-half) is None
    if k > 0:
        skew = Skew(np.array([name[3], n]), np.array([name[2], 0]), np.array([0.7, 9.0]))
        dense[3, 2] += 0.7
        found = inverse(band, half, skew, b_d)
        assert np.allclose(found.under_load_d, expected(dense), rtol=0, atol=1e-12)
        assert condition(band, half, skew, found) == pytest.approx(np.linalg.cond(dense, 1), rel=0.5)
        assert np.allclose(found.factors.solve(b_d[:, None], transposed=True)[:, 0], expected(dense.T), atol=1e-12)


def test_dense_solvers_read_the_lower_half_alone(rng):
    n = 7
    A = rng.standard_normal((n, n))
    A = A @ A.T + np.eye(n)
    spoilt = np.tril(A) + np.triu(rng.standard_normal((n, n)), 1)
    half, b = spoilt.T.ravel(), rng.standard_normal((n, 2))
    found = Dense(n).cholesky(half.copy()), Dense(n).lu(half)
    assert isinstance(found[0], DenseCholesky) and isinstance(found[1], DenseLU)
    assert all(np.allclose(factors.solve(b), np.linalg.solve(A, b), rtol=0, atol=1e-12) for factors in found)
    found = inverse(Dense(n), half, None, b[:, 0])
    estimated, exact = condition(Dense(n), half, None, found), np.linalg.cond(A, 1)
    assert exact / 2.0 < estimated < (1.0 + 1e-9) * exact and estimated == condition(Dense(n), half, None, found)
    assert Dense(n).cholesky(-half) is None


def farthest(band, groups) -> int:
    """Largest distance of two equations that are coupled."""
    free = [[place for place in band.place_d[d_m] if place >= 0] for d_nm in groups for d_m in d_nm]
    return max((max(places) - min(places) for places in free if places), default=0)


@pytest.mark.parametrize("held", [(), (0, 7, 8, 29)])
@pytest.mark.parametrize("useful", [True, False])
def test_a_chain_has_a_narrow_band_in_whatever_order_it_is_given(held, useful, rng):
    """Pairs one after another and triples beside them: the band that the coordinate gives, or one found without it."""
    n = 30
    name = rng.permutation(n)
    groups = [np.stack([name[:-1], name[1:]], -1), np.stack([name[:-2], name[1:-1], name[2:]], -1)]
    x_d = np.empty(n)
    x_d[name] = np.arange(n) if useful else rng.random(n)
    free_d = ~np.isin(np.arange(n), held)
    band = number(groups, x_d, free_d)
    assert band.n == free_d.sum() and band.k == farthest(band, groups) <= 2
    assert np.all(band.place_d[~free_d] == -1) and sorted(band.place_d[free_d]) == list(range(band.n))


def test_a_singular_matrix_has_no_factors():
    band = Band(np.arange(3), 3, 1)
    half = np.bincount(band.positions(np.array([0, 2]), np.array([0, 2])), [2.0, 3.0], band.size)
    assert band.lu(half) is None and band.cholesky(half.copy()) is None
    flat = np.diag([2.0, 0.0, 3.0]).ravel()
    assert Dense(3).lu(flat) is None and Dense(3).cholesky(flat.copy()) is None
